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

# That a body has left is said once in a run; a fork is another run.
leave() { "$sphfsi" "$dir/beside.cfg" --quiet "$@" 2>&1 | grep -c 'box\] has left the domain'; }
sed -i 's/^upper = .*/upper = 2, 0.6/; s/^end_time = .*/end_time = 0.3/
        s/^spin = 2/velocity = 0, 8/' "$dir/beside.cfg"
said=$(leave --out "$dir/left" --until 0.08)/$(leave --out "$dir/other" --fork "$dir/left")
said=$said/$(leave --out "$dir/left" --restart)
[ "$said" = 1/1/0 ] || fail "a body that has left is named $said times, not 1/1/0"
[ $failures = 0 ]
