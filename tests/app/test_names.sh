#!/usr/bin/env bash
# What a run, a drawing and the next command are called without a name given, and explanations of
# scenes that lack what others have.
set -u
program=$(realpath "$SPHFSI")
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
fail() { echo "$1"; exit 1; }
export OMP_NUM_THREADS=1
cp tests/fault/tiny.cfg "$work/tiny"
cp tests/fault/tiny.cfg "$work/tank.cfg"
cp "$program" "$work/sphfsi"
cd "$work" || exit 1

# A case with and without its ending.
./sphfsi tiny --quiet --until 1e-4 >said 2>&1 || fail "$(cat said)"
[ -s runs/tiny/summary.json ] || fail "no runs/tiny"
./sphfsi tiny --quiet --set numerics.fixed_step=4ms --set output.probe_interval=20ms \
    --set end_time=1 \
    --out far >said 2>&1 && fail "no guard"
grep -q '^to go on: the same command with --fork far/step-[0-9]*.ckpt ' said || fail "$(cat said)"
./sphfsi tank.cfg --quiet --until 1e-4 >said 2>&1 || fail "$(cat said)"
[ -s runs/tank/summary.json ] || fail "no runs/tank"
./sphfsi tank.cfg --quiet --until 1e-4 --fork runs/tiny --set gate.young=2e6 >said 2>&1 ||
    fail "$(cat said)"
[ -s runs/tank-fork/summary.json ] || fail "no runs/tank-fork"
for case in tiny tank.cfg; do
    ./sphfsi --preview "$case" >said 2>&1 || fail "$(cat said)"
    [ -s "preview-${case%.cfg}.svg" ] || fail "no preview of $case"
done
# A simulated time may have a unit; without one it is in seconds.
for time in 1e-4 1e-4s "0.1 ms" 100us; do
    rm -rf runs/tank
    ./sphfsi tank.cfg --quiet --until "$time" >said 2>&1 || fail "$(cat said)"
    grep -q '^  "end_time": 0.0001,' runs/tank/summary.json || fail "--until $time ends elsewhere"
done
for time in 1mm 0 -1s inf nan 2e9 ms; do
    ./sphfsi tank.cfg --quiet --until "$time" >said 2>&1 && fail "--until $time was accepted"
    grep -q "^sphfsi: --until $time: give a time such as 0.5, 0.5s or 500ms" said ||
        fail "$(cat said)"
done
sed -i '1i source = By hand, 2026' tiny
./sphfsi --cite tiny | grep -q '^The scene: By hand, 2026' || fail "no source"

# Solids in contact, a structure without sub-steps.
cat >solid.cfg <<'END'
dp = 1 cm
end_time = 1e-4
[solid a]
shape = box 0, 0, 0.2, 0.05
density = 1000
young = 1e6
poisson = 0.3
[solid b]
like = a
shape = box 0.22, 0, 0.3, 0.05
[contact all]
END
./sphfsi --explain solid.cfg >said 2>&1 || fail "$(cat said)"
./sphfsi --explain tank.cfg --set numerics.multirate=off --set end_time=1e-4 >said 2>&1 ||
    fail "$(cat said)"
exit 0
