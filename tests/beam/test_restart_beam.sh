#!/usr/bin/env bash
# A run with beams that stops and goes on gives the same bits, on another number of threads, too,
# and so does its effective case; probes on beams say what they cannot measure.
. tests/support/shell.sh
cat >"$dir/beam.cfg" <<'END'
dp = 5 cm
end_time = 0.5
gravity = 0, -9.81
[beam arch]
shape = arc: 0, 0, 1, 20 deg, 160 deg
thickness = 5 mm
density = 1000
young = 1e8
poisson = 0.3
hinge = 0.93969262, 0.34202014
damping_time = 1 ms
[beam bar]
shape = polyline: 2, 0; 3, 0; 3, 1
thickness = 1 cm
density = 1000
young = 1e8
clamp = 2, 0
motion = shake
[motion shake]
y = 0.1*sin(4*pi*t)
[load push]
body = bar
shape = box 2.95, 0.95, 3.05, 1.05
force = 3*sin(t), 0
moment = t
[probe tip]
quantity = displacement
body = bar
point = 3, 1
[probe root]
quantity = section_force
body = bar
point = 2, 0
[probe foot]
quantity = reaction
body = arch
END

restarts "$dir/beam.cfg" "$dir/all" 0.23
for set in thickness=6mm element=2cm; do
    expect 1 "fork: the case has changed since the checkpoint: .beam bar. .${set%=*} = " \
        "$dir/beam.cfg" --fork "$dir/all" --set "bar.$set" --out "$dir/off"
done

# No row is after the end, which the last step passes.
long=("$dir/beam.cfg" --set numerics.fixed_step=0.04)
expect 0 'long: 0.52 s simulated' "${long[@]}" --out "$dir/long"
for file in probes ledger; do
    [ "$(tail -n 1 "$dir/long/$file.csv" | cut -d, -f1)" = 0.5 ] || fail "rows after the end"
done
expect 0 'simulated' "${long[@]}" --until 0.6 --out "$dir/longer"
expect 0 'simulated' "${long[@]}" --until 0.6 --out "$dir/long" --restart
cmp "$dir/long/probes.csv" "$dir/longer/probes.csv" || fail "rows beyond the end of a run"
expect 1 'fixed_step = 0.04 s is longer than the run, which ends at 0.01 s' "${long[@]}" \
    --until 0.01 --out "$dir/off"

expect 1 '\[probe tip\] point = 3, 2 is 1 m from the line of \[beam bar\]' \
    "$dir/beam.cfg" --set tip.point=3,2 --out "$dir/off"
expect 1 '\[beam bar\] has no such quantity; a beam has displacement' \
    "$dir/beam.cfg" --set tip.quantity=strain --out "$dir/off"

cat >"$dir/wet.cfg" <<'END'
dp = 5 cm
end_time = 0.1
gravity = 0, -9.81
[fluid water]
shape = box 0, 0, 0.6, 0.6
sound_speed = 35
surface = 0.6
[wall tank]
shape = polyline: 0, 1; 0, 0; 1.2, 0; 1.2, 1
[beam baffle]
shape = polyline: 0.6, 0; 0.6, 0.7
thickness = 75 mm
density = 1100
young = 1e10
clamp = 0.6, 0
[probe tip]
quantity = displacement
body = baffle
point = 0.6, 0.7
[probe force]
quantity = force
body = baffle
END
for integrator in symplectic verlet leapfrog; do
    restarts "$dir/wet.cfg" "$dir/wet-$integrator" 0.05 --set integrator=$integrator
done

# A block bounces on a beam. What the beam returns is no gain of energy, which would stop the run.
cat >"$dir/block.cfg" <<'END'
dp = 1 cm
end_time = 0.16
gravity = 0, -9.81
[beam plate]
shape = polyline: 0, 0; 0.3, 0
thickness = 4 mm
density = 1000
young = 1e8
clamp = 0, 0
clamp = 0.3, 0
[rigid block]
shape = box 0.12, 0.05, 0.18, 0.1
density = 500
[probe block]
quantity = pose
body = block
END
restarts "$dir/block.cfg" "$dir/block" 0.12
expect 1 "the case has changed since the checkpoint: .rigid block. .* is now 'inertia = 0.1 kg" \
    "$dir/block.cfg" --fork "$dir/block" --set block.inertia=0.1 --out "$dir/off"
[ $failures = 0 ]
