#!/usr/bin/env bash
# A run that seeks rest first: what it says, its times, and that a search which was cut goes on with
# the same bits.
. tests/support/shell.sh
export OMP_NUM_THREADS=1
cat >"$dir/bar.cfg" <<'END'
dp = 10 mm
end_time = 10 ms
gravity = 0, -9.81
[solid bar]
shape = box 0, 0, 0.04, 0.2
clamp = box 0, 0.18, 0.04, 0.2
density = 1000
young = 1e5
poisson = 0
law = svk
[relax]
[output]
ledger_interval = 1 ms
[probe end]
body = bar
point = 0.02, 0
END
expect 0 '^at rest: Newton.s method found' "$dir/bar.cfg" --out "$dir/newton"
# Beside a block that lies on a floor it moves to its rest.
cat >>"$dir/bar.cfg" <<'END'
[solid block]
shape = box 0.2, 0, 0.24, 0.04
density = 1000
young = 1e5
poisson = 0
law = svk
[wall floor]
shape = box 0.18, -0.04, 0.26, 0
END
expect 0 '^seeking a state of rest before t = 0' "$dir/bar.cfg" --out "$dir/whole"
grep -q '^at rest after .* s and [0-9]* peaks of kinetic energy: over the last' "$dir/output" ||
    fail "what was found is not said"
# It hangs by rho g L^2/(2 E), L = 0.18 m, from the first row on.
awk -F, 'NR > 1 { y = $3 / (-1000 * 9.81 * 0.18^2 / 2e5) - 1; if (y * y > 9e-4) bad = $0 }
    NR == 2 && $1 != 0 { bad = $0 } END { if (bad) print bad; exit bad != "" \
        }' "$dir/whole/probes.csv" ||
    fail "the bar does not hang at rest"
# SIGINT in the search, some times, then to the end.
for k in 1 2 3; do
    "$sphfsi" "$dir/bar.cfg" --out "$dir/cut" $([ $k = 1 ] ||
        echo --restart) >"$dir/output" 2>&1 & pid=$!
    sleep "0.0$k"
    kill -INT $pid 2>/dev/null
    wait $pid
    [ -e "$dir/cut/summary.json" ] || break
done
if ls "$dir"/cut/*.ckpt >/dev/null 2>&1; then
    "$sphfsi" "$dir/bar.cfg" --out "$dir/cut" --restart >"$dir/output" 2>&1 ||
        fail "it does not go on"
    [ "$(hash "$dir/cut")" = "$(hash "$dir/whole")" ] || fail "a search that was cut ends elsewhere"
fi
[ $failures = 0 ] || exit 1
