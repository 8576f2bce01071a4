#!/usr/bin/env bash
# The command line: what is printed instead of running, exit statuses, quiet, no colour in a file.
. tests/support/shell.sh
cd "$dir" || exit 1

# Exit status $1 and, on standard error, one line that has $2 in it.
refuses() {
    local status=$1 words=$2
    shift 2
    "$sphfsi" "$@" >out 2>err
    [ $? = "$status" ] || fail "$*: exit status"
    [ "$(wc -l <err)" = 1 ] && grep -qF -- "$words" err || fail "$*: $(cat err)"
}

names=$("$sphfsi" --new) || fail "--new without a name"
[ "$(wc -l <<<"$names")" -ge 4 ] || fail "--new lists '$names'"
for name in $names; do
    "$sphfsi" --new "$name" >"$name.cfg" || fail "--new $name"
    "$sphfsi" --preview "$name.cfg" >/dev/null && [ -s "preview-$name.svg" ] ||
        fail "--preview $name"
done
# A bonded body does not move freely.
cat >bonded.cfg <<'END'
dp = 5 mm
end_time = 1
gravity = 0, 0
[solid base]
shape = box 0, 0, 0.1, 0.02
clamp = box 0, 0, 0.01, 0.02
density = 1000
young = 1e6
poisson = 0.3
[solid cap]
like = base
shape = box 0, 0.02, 0.1, 0.04
joined = base
[solid lump]
like = base
shape = box 0, 0.2, 0.1, 0.22
END
"$sphfsi" --preview bonded.cfg >/dev/null 2>err || fail "--preview of a bond"
grep -q 'solid lump<' preview-bonded.svg || fail "a free body is not drawn"
grep -q 'cap. has no clamp' err && fail "a bonded copy moves freely: $(cat err)"
grep -q 'lump. has no clamp, and .like. does not copy' err || fail "a free copy: $(cat err)"
refuses 1 'did you mean `dam_break`' --new dambreak
refuses 1 "did you mean \`gravity\`" --preview gate.cfg --set gravty=1,2
# All that is wrong with a case is said in one run.
sed 's/^density = .*/density = 1 foot/; s/^young/yuong/' gate.cfg >wrong.cfg
"$sphfsi" wrong.cfg --quiet >out 2>err
[ $? = 1 ] && [ "$(grep -c '^sphfsi: wrong.cfg:' err)" = 3 ] || fail "three mistakes: $(cat err)"
[ ! -e runs/wrong ] || fail "a wrong case leaves a folder"
refuses 1 "unknown option --previw" --previw gate.cfg
refuses 1 "takes no value" --keys=all
refuses 1 "json follows --keys" --json
refuses 1 "extra is not used" --keys extra

"$sphfsi" cantilever.cfg --quiet --until 1e-3 --threads 1 >out 2>&1 || fail "a short run"
[ ! -s out ] || fail "--quiet says: $(cat out)"
[ -s runs/cantilever/summary.json ] || fail "a run does not go to runs/<case name>"
"$sphfsi" cantilever.cfg --until 1e-3 --threads 1 --out loud >out 2>err || fail "a run"
grep -q $'\033' out err && fail "colours or cursor movements in a file"

"$sphfsi" --cite cantilever.cfg >out && grep -q "Ganzenm" out || fail "--cite"
"$sphfsi" --keys --json | grep -q '"exclusiveMaximum": 0.5' || fail "--keys --json gives no range"
"$sphfsi" --keys >keys || fail "--keys"
grep -qF '  end_time: number, s > 0, <= 1e+09, needed: ' keys || fail "--keys gives no needed key"
"$sphfsi" --explain cantilever.cfg --threads 1 >out && grep -q "enabled effects" out ||
    fail "--explain"
"$sphfsi" --explain cantilever.cfg --set "plate.lattice_angle=20 deg" --threads 1 >out 2>err &&
    grep -q "solid plate\] lattice at 20 degrees, cells of .* area off by .* bending stiffness" \
        out ||
    fail "--explain of a turned lattice"
[ "$(grep -c 'lattice at' out)" = 1 ] || fail "--explain: $(grep 'lattice at' out)"
# A report that cannot be written is a failure.
if [ -c /dev/full ]; then
    for report in --new "--new tank" --keys --help --version "--cite cantilever.cfg" \
        "--explain cantilever.cfg" "--effective cantilever.cfg" "--keys --json"; do
        # shellcheck disable=SC2086
        "$sphfsi" $report >/dev/full 2>err
        [ $? = 2 ] && [ "$(wc -l <err)" = 1 ] || fail "$report to a full device: $(cat err)"
    done
    "$sphfsi" cantilever.cfg --until 1e-3 --threads 1 --out unsaid >/dev/full 2>err ||
        fail "a run whose messages cannot be written"
    grep -q "messages of this run are lost" err ||
        fail "messages of a run to a full device: $(cat err)"
fi

# Closed standard streams: no result file takes their numbers, so no message lands in one.
"$sphfsi" cantilever.cfg --until 1e-3 --threads 1 --out plain >/dev/null 2>&1 || fail "a run"
"$sphfsi" cantilever.cfg --until 1e-3 --threads 1 --out closed 0<&- >&- 2>&- ||
    fail "closed streams"
cmp plain/ledger.csv closed/ledger.csv && cmp plain/probes.csv closed/probes.csv ||
    fail "messages in results"

# A terminal that goes away (SIGHUP) leaves a checkpoint; nohup keeps the run going.
"$sphfsi" cantilever.cfg --quiet --threads 1 --out hangup >out & pid=$!
while [ ! -s hangup/ledger.csv ]; do sleep 0.05; done
kill -HUP $pid
wait $pid
[ $? = 129 ] && ls hangup/*.ckpt >/dev/null || fail "SIGHUP leaves no checkpoint"
grep -q 'to go on: .* --restart' out || fail "--quiet hides the command that goes on"

# While a large case is sampled, a stop is immediate and leaves nothing.
cat >large.cfg <<'EOF'
dp = 1 mm
end_time = 1
[fluid w]
shape = box 0, 0, 2, 1
minus = circle 1, 0.5, 0.2
sound_speed = 40
[wall c]
shape = circle 1, 0.5, 0.2
EOF
"$sphfsi" large.cfg --threads 1 --out large >out 2>err & pid=$!
sleep 1
kill -TERM $pid
began=$SECONDS
wait $pid
[ $? = 143 ] && [ $((SECONDS - began)) -le 2 ] && [ ! -e large ] ||
    fail "a stop while a case is sampled waits $((SECONDS - began)) s, or leaves a folder"

# In a file there is a line for each tenth of the run, so none yet.
"$sphfsi" cantilever.cfg --threads 1 --out lines >out 2>err & pid=$!
while [ ! -s lines/ledger.csv ]; do sleep 0.05; done
sleep 0.4
kill -TERM $pid
wait $pid
grep -q "^ *0\.[0-9] %" err && fail "a line before a tenth of the run: $(cat err)"

"$sphfsi" --version >/dev/null && "$sphfsi" --help >/dev/null || fail "--version, --help"
"$sphfsi" >out 2>err
[ $? = 1 ] && grep -q "no case is given" err || fail "no case"

[ $failures = 0 ] || exit 1
