#!/usr/bin/env bash
# Settings that lead to a blow-up: refused, or accepted with a sentence that says what will go
# wrong.
. tests/support/shell.sh

# says STATUS WORDS CASE SETTINGS...: explaining the case ends so and says so.
says() {
    local status=$1 words=$2 case=tests/stability/$3 sets=()
    shift 3
    for set in "$@"; do sets+=(--set "$set"); done
    "$sphfsi" "$case" --explain "${sets[@]}" >"$dir/output" 2>&1
    local got=$?
    if [ $got != "$status" ] || ! grep -q -- "$words" "$dir/output"; then
        echo "FAILED: $case $*: exit status $got (not $status) or not '$words'"
        grep -v '^ ' "$dir/output" | head -n 5
        failures=$((failures + 1))
    fi
}

says 1 'solid_safety' beam.cfg numerics.solid_safety=1.2
says 1 'hourglass' beam.cfg beam.hourglass=-1
says 1 'poisson' beam.cfg nu=0.5
says 1 'poisson' beam.cfg nu=0.6
says 1 'is 1 particle thick' gate.cfg 'thickness=5 mm'
says 0 'only 2 particles thick' gate.cfg 'thickness=10 mm'
says 2 'fixed_step = .* s exceeds the solid.s stable step' beam.cfg 'numerics.fixed_step=0.1 ms'
says 0 'fixed_step = 0.00025 s (C_CFL = 0.741) is above 0.6' column.cfg \
    'numerics.fixed_step=0.25 ms'
says 0 'numerics.cfl = 0.5 is above 0.2' column.cfg integrator=verlet numerics.cfl=0.5
says 0 'numerics.cfl = 0.5 is above 0.4' column.cfg integrator=symplectic numerics.cfl=0.5
says 0 'numerics.cfl = 0.7 is above 0.6' column.cfg integrator=leapfrog numerics.cfl=0.7
says 0 'has no clamp, and a .load. acts on it' free.cfg
says 0 'has no clamp, and gravity acts on it' settle.cfg
says 0 'than the kernel.s reach .* numerics.sides = one prevents that' gate.cfg \
    numerics.h_over_dp=2 \
    'thickness=15 mm'
"$sphfsi" tests/stability/gate.cfg --set numerics.h_over_dp=2 --set 'thickness=15 mm' \
    --set numerics.sides=one --explain >"$dir/output" 2>&1
if grep -q 'than the kernel.s reach' "$dir/output"; then
    echo "FAILED: warned of what sides = one has mended"
    failures=$((failures + 1))
fi
says 1 'gap = 0.05 m is more than 4 particle spacings of 0.01 m' settle.cfg bed.gap=5*dp
says 0 'solid gate. is 0.01 m thick, less than the kernel.s reach .* a smaller dp prevents that' \
    gate.cfg numerics.h_over_dp=2 'thickness=10 mm'
says 0 'is above 5' column.cfg water.shifting=10 water.shifting_speed=largest \
    numerics.cfl=0.6
says 0 \
    '.solid plate., 0.3 times as dense .* numerics.fixed_step = 0.00012 s; use at most 0.000101 s' \
    thin.cfg integrator=leapfrog plate.density=300 numerics.fixed_step=1.2e-4
says 0 'added_mass *0.0001013 s .* <- limits the step' thin.cfg integrator=leapfrog \
    plate.density=300
says 1 'particles start in one cell of .* limit of 480' gate.cfg numerics.h_over_dp=2 \
    'thickness=100 mm' gate.dp=dp/4
says 0 'unstable at any time step' beam.cfg beam.hourglass_form=printed beam.gradient=linear
"$sphfsi" tests/stability/gate.cfg --explain >"$dir/output" 2>&1
if grep -q 'warning' "$dir/output"; then
    echo "FAILED: a sound case is warned of"
    failures=$((failures + 1))
fi
[ $failures = 0 ] && echo "all said"
exit $((failures != 0))
