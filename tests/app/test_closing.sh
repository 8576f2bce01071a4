#!/usr/bin/env bash
# How a run ends that is stopped: after a guard with a fork with half the step into another folder,
# after a signal with a restart. The options are right to the letter, and they run.
. tests/support/shell.sh
export OMP_NUM_THREADS=1
cp tests/fault/still.cfg "$dir/still water.cfg"
cp "$sphfsi" "$dir/sphfsi"
cd "$dir" || exit 1
cat >thrown.cfg <<'END'
dp = 1 cm
end_time = 0.1
[solid block]
shape = box 0, 0, 0.1, 0.1
velocity = -200*(x - 0.05), 0
density = 1000
young = 1e5
poisson = 0.3
law = svk
END

# command STATUS ARGUMENTS...: what a run that ends so is to be given for going on.
command() {
    local status=$1
    shift
    "$@" >out 2>err
    [ $? = "$status" ] || fail "$*: does not end with $status: $(cat out err)"
    sed -n 's/^to go on: the same command with //p' out
}
is() { [ "$1" = "$2" ] || fail "the options are '$1', not '$2'"; }
newest() { ls "$1"/*.ckpt | tail -n 1; }

got=$(command 2 ./sphfsi "still water.cfg" --quiet --out a --set numerics.fixed_step=5ms)
is "$got" "--fork $(newest a) --set numerics.fixed_step=0.0025 and another --out"
grep -q 'last valid state' out && fail "--quiet hides no note"

mkdir below
still=(../sphfsi "../still water.cfg" --set numerics.cfl=1 --until 0.5 --threads 1)
got=$(cd below && command 2 "${still[@]}" --out "../b c")
last=../$(newest "b c")
is "$got" "--fork $last --set numerics.cfl=0.5 and another --out"
grep -q "^last valid state, for a restart: .*b c/step-.*; state at the stop: .*b c/fields" \
    below/out ||
    fail "where the last states are: $(cat below/out)"
# With steps half as long the water stays at rest.
(cd below && "${still[@]}" --fork "$last" --set numerics.cfl=0.5 --out "../b c-2" --quiet) \
    >out 2>err || fail "$got: $(cat err)"
grep -q '"exit_reason": "finished"' "b c-2/summary.json" || fail "the fork has not finished"

# A lone solid has a key of its own.
got=$(command 2 ./sphfsi thrown.cfg --quiet --out t)
is "$got" "--fork $(newest t) --set numerics.solid_safety=0.45 and another --out"

# Of beams alone it is the fixed step: solid_safety does not act on them.
cat >beam.cfg <<'END'
dp = 1 cm
end_time = 1
[beam b]
shape = polyline: 0, 0; 0.2, 0
thickness = 4 mm
density = 1000
young = 1e7
[load l]
body = b
shape = box 0.1, -1, 0.3, 1
force = 0, 1e20*max(t - 0.1, 0)
END
got=$(command 2 ./sphfsi beam.cfg --quiet --out beam)
[[ $got == *"numerics.fixed_step="* ]] || fail "beams: $got"

# Where shorter steps would stop it again: contact at its limit, a motion that is not finite at a
# time between those that are checked before the run, and a speed that the case gives.
others() { sed -n 's/^change the case, then //p' out; }
cat >met.cfg <<'END'
dp = 1 cm
end_time = 0.1
[solid block]
shape = box 0, 0, 0.1, 0.1
velocity = 0, -500
density = 1000
young = 1e5
poisson = 0.3
[wall floor]
shape = box -0.1, -0.12, 0.2, -0.08
END
command 2 ./sphfsi met.cfg --quiet --out m >/dev/null
is "$(others)" "go on: the same command with --fork $(newest m) and another --out"
cat >moved.cfg <<'END'
dp = 1 cm
end_time = 0.5
[fluid w]
shape = box 0, 0, 0.1, 0.1
sound_speed = 10
[wall side]
shape = box -0.04, 0, 0, 0.1
motion = m
[motion m]
x = -0.01*t*(t - 0.0703125)/(t - 0.0703125)
[numerics]
fixed_step = 0.000244140625 # 2^-12: 288 of them are 0.0703125 exactly
END
command 2 ./sphfsi moved.cfg --quiet --out n >/dev/null
is "$(others)" "go on: the same command with --fork $(newest n) and another --out"
grep -q '^sphfsi: moved.cfg:9: t = 0.0703125 s: \[motion m\] gives \[wall side\]' err ||
    fail "$(cat err)"
sed 's/^x = .*/x = 9*t/
s/^shape = box -0.04.*/&\nshape = box 0.1, 0, 0.14, 0.1\nshape = box -0.04, -0.04, 0.14, 0/' \
    moved.cfg >fast.cfg
command 2 ./sphfsi fast.cfg --quiet --out f >/dev/null
is "$(others)" "start again: the same command with another --out"
grep -q '\[motion m\] .*up to 9 m/s.*sound_speed = 90 or more' err ||
    fail "$(cat err)"

# stop NAME ARGUMENTS...: the options of a run that a signal ends. There is nothing to mend: it
# restarts.
stop() {
    local name=$1
    shift
    "$@" >out 2>err & pid=$!
    for _ in $(seq 400); do [ -s "$name/ledger.csv" ] && break; sleep 0.05; done
    sleep 0.3
    kill -TERM $pid
    wait $pid
    [ $? = 143 ] || fail "$*: SIGTERM does not end it with 143: $(cat err)"
    grep -q 'last valid state' out && fail "a run that is stopped has no other state"
    sed -n 's/^to go on: the same command with //p' out
}
got=$(stop r ./sphfsi "still water.cfg" --out r --set title=a)
is "$got" "--restart"
./sphfsi "still water.cfg" --out r --set title=a --restart --until 0.0001 2>err &&
    fail "the end of a restart lies before its begin"
grep -q 'after the end' err || fail "the restart does not begin: $(cat err)"
got=$(stop g ./sphfsi "still water.cfg" --fork r --set title=b --out g)
is "$got" "--restart instead of --fork"
[ $failures = 0 ] || exit 1
