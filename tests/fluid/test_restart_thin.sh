#!/usr/bin/env bash
# A run with thin walls at rest and moving, in a periodic domain, gives the same bits if it stops
# and goes on, on another number of threads, and as its effective case.
. tests/support/shell.sh

run() { "$sphfsi" "$@" --quiet >"$dir/output" 2>&1 || fail "$*"; }

cat >"$dir/thin.cfg" <<'END'
dp = 20 mm
end_time = 0.1
gravity = 0, -9.81
scheme = standard
[fluid water]
shape = box -0.4, 0, 0.4, 0.3
surface = 0.3
max_speed = 1
max_pressure = 3 kPa
[domain]
lower = -0.4, -0.1
upper = 0.4, 0.8
periodic = x
[wall floor]
shape = polyline: -0.4, 0; 0.4, 0
[wall post]
shape = polyline: -0.2, 0; -0.2, 0.2
shape = polyline thickness 0: -0.2, 0.1; -0.1, 0.1
[wall paddle]
shape = polyline: 0.2, 0.04; 0.2, 0.5
motion = swing
[motion swing]
turn = 0.1*sin(5*pi*t)
centre = 0.2, 0.04
[probe force]
quantity = force
body = post, paddle
[probe pressure]
quantity = pressure
point = -0.19, 0.05
END
for integrator in symplectic verlet leapfrog; do
    at=$dir/$integrator
    set=(--set "integrator=$integrator")
    run "$dir/thin.cfg" "${set[@]}" --out "$at" --threads 1
    run "$dir/thin.cfg" "${set[@]}" --out "$at-cut" --threads 2 --until 0.05
    run "$dir/thin.cfg" "${set[@]}" --out "$at-cut" --restart
    run "$at/case.cfg" --out "$at-effective"
    [ -n "$(hash "$at")" ] || fail "$integrator: no state"
    [ "$(hash "$at")" = "$(hash "$at-cut")" ] || fail "$integrator: restart"
    cmp "$at/probes.csv" "$at-cut/probes.csv" || fail "$integrator: rows"
    [ "$(hash "$at")" = "$(hash "$at-effective")" ] || fail "$integrator: effective case"
done
[ $failures = 0 ]
