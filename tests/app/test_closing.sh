#!/usr/bin/env bash
# The command that a run ends with: after a guard a fork with half the step into a folder of its own, after
# a signal a restart. It is right to the letter, and it runs.
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

# command STATUS ARGUMENTS...: the printed command of a run that ends so.
command() {
    local status=$1
    shift
    "$@" >out 2>err
    [ $? = "$status" ] || fail "$*: does not end with $status: $(cat out err)"
    sed -n 's/^to go on: //p' out
}
is() { [ "$1" = "$2" ] || fail "the command is '$1', not '$2'"; }
newest() { ls "$1"/*.ckpt | tail -n 1; }

got=$(command 2 ./sphfsi "still water.cfg" --quiet --out a --set numerics.fixed_step=5ms)
is "$got" "./sphfsi 'still water.cfg' --fork $(newest a) --set numerics.fixed_step=5ms \
--set numerics.fixed_step=0.0025 --out a-2"
grep -q 'last valid state' out && fail "--quiet hides no note"

# In the folder below another program's, beside folders that are taken.
mkdir below "b c-2"
got=$(cd below && command 2 ../sphfsi "../still water.cfg" --out "../b c" --set numerics.cfl=1 --until 0.5 \
    --threads 1)
is "$got" "$dir/sphfsi '../still water.cfg' --fork '../$(newest "b c")' --set numerics.cfl=1 \
--set numerics.cfl=0.5 --until 0.5 --threads 1 --out '../b c-3'"
grep -q "^last valid state, for a restart: .*b c/step-.*; state at the stop: .*b c/fields" below/out ||
    fail "where the last states are: $(cat below/out)"
# With steps half as long the water stays at rest.
(cd below && eval "$got" --quiet) >out 2>err || fail "$got: $(cat err)"
grep -q '"exit_reason": "finished"' "b c-3/summary.json" || fail "the fork has not finished"

# A lone solid has a key of its own.
got=$(command 2 ./sphfsi thrown.cfg --quiet --out t)
is "$got" "./sphfsi thrown.cfg --fork $(newest t) --set numerics.solid_safety=0.45 --out t-2"

# Where shorter steps would stop it again: contact at its limit, a motion that is not finite at a time
# between those that are checked before the run, and a speed that the case gives.
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
is "$(others)" "go on: ./sphfsi met.cfg --fork $(newest m) --out m-2"
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
kind = expression
x = -0.01*t*(t - 0.07003)/(t - 0.07003)
[output]
probe_interval = 0.07003
ledger_interval = 0.07003
END
command 2 ./sphfsi moved.cfg --quiet --out n >/dev/null
is "$(others)" "go on: ./sphfsi moved.cfg --fork $(newest n) --out n-2"
grep -q '^sphfsi: moved.cfg:9: t = 0.07003 s: \[motion m\] gives \[wall side\]' err || fail "$(cat err)"
sed 's/^x = .*/x = 9*t/
s/^shape = box -0.04.*/&\nshape = box 0.1, 0, 0.14, 0.1\nshape = box -0.04, -0.04, 0.14, 0/' \
    moved.cfg >fast.cfg
command 2 ./sphfsi fast.cfg --quiet --out f >/dev/null
is "$(others)" "start again: ./sphfsi fast.cfg --out f-2"
grep -q 'the case gives the fluid up to 9 m/s, but its speed of sound is only 10 m/s' err ||
    fail "$(cat err)"

# stop NAME ARGUMENTS...: the command of a run that a signal ends. There is nothing to mend: it restarts.
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
    sed -n 's/^to go on: //p' out
}
got=$(stop r ./sphfsi "still water.cfg" --out r --set title=a)
is "$got" "./sphfsi 'still water.cfg' --restart --set title=a --out r"
eval "$got" --until 0.0001 2>err && fail "the end of a restart lies before its begin"
grep -q 'after the end' err || fail "the restart does not begin: $(cat err)"
got=$(stop "runs/still water" ./sphfsi "still water.cfg")
is "$got" "./sphfsi 'still water.cfg' --restart"

[ $failures = 0 ] || exit 1
