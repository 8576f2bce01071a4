#!/usr/bin/env bash
# The program's door: exit status and sentence for wrong command lines and folders, a full disk, a
# signal, a killed run.
. tests/support/shell.sh
case=tests/fault/tiny.cfg

# --- command line ---
expect 0 'usage:' --help
expect 0 '^[0-9]*\.[0-9]*\.[0-9]' --version
expect 1 'no case is given'
expect 1 'unknown option --thread;' "$case" --thread 2
expect 1 'unknown option -x' "$case" -x
expect 1 '--out needs a value' "$case" --out
expect 1 'from 1 to 2147483647' "$case" --threads 0
expect 1 'from 1 to 2147483647' "$case" --threads many
expect 1 'a whole number from 1 to 2147483647' "$case" --threads 4.5
expect 1 'above 0' "$case" --until -1
expect 1 'key=value' "$case" --set dp
expect 1 'takes no value' "$case" --quiet=yes
expect 1 'only one case can be given' "$case" "$case"
expect 1 'nowhere.cfg' "$dir/nowhere.cfg" --out "$dir/none"
expect 1 'dp' "$case" --set dp=-1 --out "$dir/none"
expect 1 'dpp' "$case" --set dpp=1 --out "$dir/none"
expect 1 'fixed_step = 1e-300 s gives 2e+298 steps until 0.02 s' "$case" --out "$dir/none" \
    --set numerics.fixed_step=1e-300
expect 1 'ledger_interval = 1.9e-09 s gives 1.05e+07 rows' "$case" --out "$dir/none" \
    --set output.ledger_interval=1.9e-9
expect 1 'ledger_interval = 1e-11 s gives 1e+14 rows until 1000 s' "$case" --out "$dir/none" \
    --set output.ledger_interval=1e-11 --until 1000
expect 1 'needs about 3.* steps of .* until end_time = 1e.09 s, more than the limit of 1e.10' \
    "$case" --out "$dir/none" --set end_time=1e9 --set output.ledger_interval=1e3 \
    --set output.probe_interval=1e3 --set output.snapshot_interval=1e6
[ ! -e "$dir/none" ] || fail "wrong input made a folder"

# --- explaining writes nothing ---
expect 0 'limits the step' "$case" --explain --out "$dir/none"
[ ! -e "$dir/none" ] || fail "--explain made a folder"

# --- a run, its files, no overwriting ---
run=$dir/run
expect 0 'simulated' "$case" --out "$run"
for file in summary.json probes.csv ledger.csv fields.vtkhdf case.cfg; do
    [ -s "$run/$file" ] || fail "no $file"
done
[ "$(head -n 1 "$run/probes.csv")" = time_s,M1_dx_m,M1_dy_m ] || fail "columns of probes.csv"
[ "$(wc -l <"$run/probes.csv")" = 202 ] || fail "rows of probes.csv: $(wc -l <"$run/probes.csv")"
[ "$(wc -l <"$run/ledger.csv")" = 22 ] || fail "rows of ledger.csv: $(wc -l <"$run/ledger.csv")"
[ "$(tail -n 1 "$run/probes.csv" | cut -d, -f1)" = 0.02 ] || fail "the last row is not at the end"
[ ! -e "$run/.lock" ] && [ ! -e "$run/fields.vtkhdf.spare" ] || fail "something was left behind"
cp "$run/summary.json" "$dir/summary.json"
expect 1 'not overwritten' "$case" --out "$run"
cmp -s "$run/summary.json" "$dir/summary.json" || fail "a refused run changed its files"

# --- the effective case gives the same bits ---
expect 0 'simulated' "$run/case.cfg" --out "$dir/again"
cmp "$run/probes.csv" "$dir/again/probes.csv" || fail "case.cfg gives other probes"
[ "$(hash "$run")" = "$(hash "$dir/again")" ] || fail "case.cfg gives another state"

# --- restart: what may change and what not ---
expect 1 'no such folder' "$case" --out "$dir/none" --restart
expect 1 'the case has changed.*young' "$case" --out "$run" --restart --set gate.young=2e6
expect 1 'after the end' "$case" --out "$run" --restart --until 0.01
expect 1 'nowhere.ckpt' "$case" --out "$run" --restart "$dir/nowhere.ckpt"
expect 1 'not a valid checkpoint' "$case" --out "$run" --restart "$case"
cmp -s "$run/summary.json" "$dir/summary.json" || fail "a refused restart changed its files"
expect 0 'restart from' "$case" --out "$run" --restart --until 0.03
[ "$(wc -l <"$run/probes.csv")" = 302 ] || fail "a longer run has $(wc -l <"$run/probes.csv") rows"

# --- files of a case: their contents belong to it, their paths do not ---
mkdir "$dir/files" "$dir/elsewhere"
push() { printf 't,g\n0,-9\n0.02,%s\n' "$1" >"$dir/files/push.csv"; }
case=$dir/files/case.cfg
sed 's/^gravity = .*/gravity = 0, push(t)/' tests/fault/tiny.cfg >"$case"
printf '[table push]\nfile = push.csv\n' >>"$case"
push -10
completes "$case" --out "$dir/files/run" --until 0.01
push -11
expect 1 "the case has changed.*\[table push\] '# file of 2 rows, checksum .*' is now '# file" \
    "$case" --out "$dir/files/run" --restart
completes "$case" --out "$dir/files/fork" --fork "$dir/files/run"
push -10.0
mv "$dir/files/run" "$dir/elsewhere/run"
completes "$case" --out "$dir/elsewhere/run" --restart
completes "$dir/elsewhere/run/case.cfg" --out "$dir/files/again"
"$sphfsi" "$case" --effective >"$dir/elsewhere/copy.cfg"
completes "$dir/elsewhere/copy.cfg" --out "$dir/files/copy"
for other in again copy; do
    [ "$(hash "$dir/elsewhere/run")" = "$(hash "$dir/files/$other")" ] || fail "table: $other"
done
case=tests/fault/tiny.cfg

# --- folders that cannot be used ---
: >"$dir/file"
expect 1 "$dir/file" "$case" --out "$dir/file/run"
if [ "$(id -u)" != 0 ]; then
    mkdir "$dir/closed"
    chmod a-w "$dir/closed"
    expect 1 "$dir/closed" "$case" --out "$dir/closed"
    expect 1 "$dir/closed/run" "$case" --out "$dir/closed/run"
fi

# --- a disk that fills up: reported, and what was good stays good ---
for blocks in 1 100 400 480 600; do
    full=$dir/full-$blocks
    (ulimit -f $blocks; exec "$sphfsi" "$case" --out "$full") >"$dir/output" 2>&1
    got=$?
    [ $got = 2 ] || [ $got = 0 ] || fail "limit of $blocks blocks: exit status $got"
    [ $got = 0 ] || grep -q "$full" "$dir/output" || fail "limit of $blocks blocks: no path named"
    [ ! -e "$full/.lock" ] || fail "limit of $blocks blocks: the lock is left"
done
[ "$(ls "$dir"/full-1/*.ckpt 2>/dev/null)" = "" ] || fail "a checkpoint in half a kilobyte"

# --- snapshots that were missed are counted across a restart ---
missed() { sed -n 's/.*"snapshots_missed": \([0-9]*\).*/\1/p' "$1/summary.json"; }
(ulimit -f 120; exec "$sphfsi" "$case" --quiet --out "$dir/missed" --until 0.015 \
    --set output.snapshot_interval=1ms --set output.snapshot_failure=go_on) >"$dir/output" 2>&1 ||
    fail "snapshot_failure = go_on: exit status $?"
before=$(missed "$dir/missed")
[ "$before" -gt 0 ] || fail "no snapshot was missed"
expect 0 'restart from' "$case" --out "$dir/missed" --restart --set output.snapshot_interval=1ms \
    --set output.snapshot_failure=go_on
[ "$(missed "$dir/missed")" = "$before" ] ||
    fail "missed: $before, restarted $(missed "$dir/missed")"

# --- signals ---
still=tests/fault/still.cfg
wait_for() {
    for _ in $(seq 200); do
        compgen -G "$1" >/dev/null && return
        sleep 0.05
    done
    fail "$1 did not appear"
}
"$sphfsi" "$still" --out "$dir/signal" >"$dir/output" 2>&1 &
pid=$!
wait_for "$dir/signal/probes.csv"
kill -USR1 $pid
wait_for "$dir/signal/*.ckpt"
kill -0 $pid 2>/dev/null || fail "SIGUSR1 ended the run"
"$sphfsi" "$still" --out "$dir/signal" --restart >"$dir/second" 2>&1 &&
    fail "a second run went into the same folder"
grep -q "process $pid" "$dir/second" || fail "the second run does not name the first"
kill -INT $pid
wait $pid
got=$?
[ $got = 130 ] || fail "SIGINT: exit status $got"
grep -q '"exit_reason": "interrupted"' "$dir/signal/summary.json" || fail "SIGINT: no summary"
[ ! -e "$dir/signal/.lock" ] || fail "SIGINT: the lock is left"

# --- killed outright: what is there can be read and continued ---
"$sphfsi" "$still" --out "$dir/killed" --set output.checkpoint_interval=0.001 \
    >"$dir/output" 2>&1 &
pid=$!
wait_for "$dir/killed/*.ckpt"
kill -KILL $pid
wait $pid 2>/dev/null
printf '0.5,0.' >>"$dir/killed/probes.csv"
tenths=$(tail -n 1 "$dir/killed/ledger.csv" | awk -F, '{ print int(10 * $1) + 2 }')
expect 0 'restart from' "$still" --out "$dir/killed" --restart \
    --until "$(awk "BEGIN { print $tenths / 10 }")"
awk -F, -v rows=$((tenths * 100 + 2)) '
    NR > 1 { off = $1 - (NR - 2) * 0.001; if (off * off > 1e-20) bad = 1 }
    END { exit bad || NR != rows }' "$dir/killed/probes.csv" ||
    fail "killed and continued: a gap or a doubled row in probes.csv"

# --- fluid that runs out is said when it begins to, and at the end ---
cat >"$dir/leak.cfg" <<'END'
dp = 10 mm
end_time = 0.3
gravity = 0, -9.81
[fluid water]
shape = box 0, 0, 0.1, 0.05
sound_speed = 10
surface = 0.05
artificial_viscosity = 0.02
[wall corner]
shape = box -0.03, 0, 0, 0.1
shape = box -0.03, -0.03, 0.05, 0
END
expect 0 'has left the domain' "$dir/leak.cfg" --out "$dir/leak"
grep -q '^fluid particles lost: [1-9]' "$dir/output" || fail "the end does not count what was lost"
said=$(grep -c 't = 0.* s: fluid particle [0-9]* has left the domain at' \
    "$dir/output")
[ "$said" = 1 ] || fail "the first particle that leaves is said $said times, not once"
# All of it: nothing is left that could have gained energy.
sed -i '/-0.03, -0.03/d' "$dir/leak.cfg"
expect 0 'fluid particles lost: 50' "$dir/leak.cfg" --out "$dir/dry"
grep -q 'that nothing supplied' "$dir/output" && fail "a run without its fluid gained energy"

# --- a guard: the last valid state and the state at the stop are left ---
expect 2 'last valid state, for a restart' "$still" --set numerics.fixed_step=5ms --out "$dir/guard"
compgen -G "$dir/guard/*.ckpt" >/dev/null || fail "guard: no checkpoint"
[ -s "$dir/guard/fields.vtkhdf" ] || fail "guard: no snapshot"
grep -q '"exit_reason": "guard"' "$dir/guard/summary.json" || fail "guard: no summary"

[ $failures = 0 ] || exit 1
