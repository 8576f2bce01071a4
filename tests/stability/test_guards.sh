#!/usr/bin/env bash
# Runs that go wrong: the guard says in one sentence where, when and why, leaves a checkpoint and a
# snapshot, and the program ends with status 2.
. tests/support/shell.sh

# stopped NAME WARNING SENTENCE: reads a case from the input, runs it, looks for both.
stopped() {
    local name=$1 warning=$2 sentence=$3
    cat >"$dir/$name.cfg"
    "$sphfsi" "$dir/$name.cfg" --out "$dir/$name" --quiet >"$dir/output" 2>&1
    local got=$?
    [ $got = 2 ] || fail "$name: exit status $got instead of 2"
    grep -q -- "$sentence" "$dir/output" || fail "$name: does not say '$sentence'"
    [ "$(grep -c -- "$warning" "$dir/output")" = 1 ] ||
        fail "$name: does not warn once of '$warning'"
    ls "$dir/$name"/*.ckpt >/dev/null 2>&1 || fail "$name: no checkpoint"
    [ -s "$dir/$name/fields.vtkhdf" ] || fail "$name: no snapshot"
    grep -q '"exit_reason": *"guard"' "$dir/$name/summary.json" || fail "$name: summary.json"
}

water='[fluid water]
shape = box 0, 0, 0.2, 0.1
artificial_viscosity = 0.1
density_diffusion = 0.1
surface = 0.1
'
tank='[wall tank]
shape = polyline thickness -0.04: 0, 0.3; 0, 0; 0.2, 0; 0.2, 0.3
'

# Speed: far too low a speed of sound for a fall. The warning comes first.
stopped speed 'not weakly compressible' \
    't = .*fluid particle [0-9]* at (.*) m has \(speed\|rho\)' <<CASE
dp = 1 cm
end_time = 1
gravity = 0, -98.1
$water
sound_speed = 5
shape = box 0, 0.2, 0.05, 0.3
$tank
CASE

# Density: a wall that is driven into water which cannot give way.
stopped density 'density deviates by' \
    'fluid particle [0-9]* at (.*) m has \(rho/rho0 - 1\|speed\)' <<CASE
scheme = paper
dp = 1 cm
end_time = 1
$water
sound_speed = 30
$tank
[wall piston]
shape = box 0, 0.1, 0.2, 0.14
motion = push
[motion push]
y = -3*t
CASE

# det F: a block thrown together faster than its material can hold.
stopped inverted 'is compressed to det F' 'solid particle [0-9]* at (.*) m has det F = ' <<CASE
dp = 1 cm
end_time = 0.1
[solid block]
shape = box 0, 0, 0.1, 0.1
density = 1000
young = 1e5
poisson = 0.3
law = svk
velocity = -200*(x - 0.05), 0
CASE

# Energy: a step that is much too long. The account warns before the density stops the run.
stopped energy 'The results may be invalid' 'is unstable' <<CASE
dp = 1 cm
end_time = 0.5
gravity = 9.81, 0
[numerics]
fixed_step = 0.5 ms
$water
sound_speed = 30
$tank
CASE

# The work of a ram on the second of two bodies supplies that body, before the bodies touch.
"$sphfsi" tests/stability/pressed.cfg --set dp='2.5 mm' --until 0.038 --quiet \
    --out "$dir/pressed" ||
    fail "pressed: a ram's work counts as a gain"

[ $failures = 0 ] && echo "all guards speak"
exit $((failures != 0))
