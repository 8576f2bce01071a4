#!/usr/bin/env bash
# A run with rigid bodies that stops and goes on gives the same bits, with each integrator, beside
# fluid and alone, and on another number of threads; its effective case gives them, too.
set -u
sphfsi=${SPHFSI:-./sphfsi}
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
failures=0
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

fail() {
    echo "FAILED: $1"
    failures=$((failures + 1))
}

run() {
    "$sphfsi" "$@" --quiet >"$dir/output" 2>&1 && return
    fail "$*"
    cat "$dir/output"
}

hash() { sed -n 's/.*"state_hash": "\(.*\)".*/\1/p' "$1/summary.json"; }

for integrator in symplectic verlet leapfrog; do
    for scene in alone beside; do
        at=$dir/$scene-$integrator
        run "$dir/$scene.cfg" --set integrator=$integrator --out "$at" --threads 1
        run "$dir/$scene.cfg" --set integrator=$integrator --out "$at-cut" --threads 2 --until 0.05
        run "$dir/$scene.cfg" --set integrator=$integrator --out "$at-cut" --restart
        run "$at/case.cfg" --out "$at-effective"
        [ -n "$(hash "$at")" ] && [ "$(hash "$at")" = "$(hash "$at-cut")" ] || fail "$at: restart"
        cmp "$at/probes.csv" "$at-cut/probes.csv" || fail "$at: rows"
        [ "$(hash "$at")" = "$(hash "$at-effective")" ] || fail "$at: effective case"
    done
done
[ $failures = 0 ]
