#!/usr/bin/env bash
# A run with rigid bodies that stops and goes on gives the same bits, with each integrator, beside
# fluid and alone, and on another number of threads; its effective case gives them, too.
. tests/support/shell.sh
cat >"$dir/alone.cfg" <<'END'
dp = 2 cm
end_time = 0.1
gravity = 0, -9.81
[domain]
lower = -1, -1
upper = 2, 2
[rigid box]
shape = box 0.2, 0.2, 0.4, 0.5
density = 300
spin = 2
[probe box]
quantity = pose
body = box
END
cat - "$dir/alone.cfg" >"$dir/beside.cfg" <<'END'
sound_speed_of_water = 20
END
sed -i 1d "$dir/beside.cfg"
cat >>"$dir/beside.cfg" <<'END'
[fluid water]
shape = box 0, 0, 0.6, 0.3
minus = box 0.2, 0.2, 0.4, 0.5
sound_speed = 20
surface = 0.3
[wall tank]
shape = polyline: 0, 0.6; 0, 0; 0.6, 0; 0.6, 0.6
END

for integrator in symplectic verlet leapfrog; do
    for scene in alone beside; do
        restarts "$dir/$scene.cfg" "$dir/$scene-$integrator" 0.05 --set integrator=$integrator
    done
done
[ $failures = 0 ]
