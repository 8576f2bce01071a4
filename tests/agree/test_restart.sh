#!/usr/bin/env bash
# A run that stops and goes on gives the same bits as one that does not: state, rows, snapshots;
# whatever the scene and the integrator, with checkpoints in between, and with another number of
# threads.
set -u
sphfsi=${SPHFSI:-./sphfsi}
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
# Every kind of probe, two of them with rates of their own, off the grid of the others.
case=$dir/tiny.cfg
cat tests/fault/tiny.cfg - >"$case" <<'END'
[probe slow]
quantity = force
body = tank
interval = 0.37 ms
[probe fast]
quantity = stress
body = gate
point = 0.13, 0.1
interval = 31 us
[probe front]
quantity = front
[probe level]
quantity = level
point = 0.05, 0
[probe body]
quantity = energy
body = gate
[probe flux]
quantity = flux
point = 0.15, 0
to = 0.15, 0.1
[probe flow]
quantity = velocity
point = 0.05, 0.05
END
failures=0

fail() {
    echo "FAILED: $1"
    failures=$((failures + 1))
}

run() {
    "$sphfsi" "$case" --quiet "$@" >"$dir/output" 2>&1 && return
    fail "$*"
    cat "$dir/output"
}

hash() { sed -n 's/.*"state_hash": "\(.*\)".*/\1/p' "$1/summary.json"; }

agree() {
    [ -n "$(hash "$1")" ] && [ "$(hash "$1")" = "$(hash "$2")" ] || fail "$3: the states differ"
    for file in "$1"/probes*.csv; do
        cmp "$file" "$2/${file##*/}" || fail "$3: ${file##*/} differ"
    done
    cmp "$1/ledger.csv" "$2/ledger.csv" || fail "$3: ledger.csv differ"
    cmp "$1/case.cfg" "$2/case.cfg" || fail "$3: case.cfg differ"
}

for integrator in symplectic verlet leapfrog; do
    for precision in mixed double; do
        name=$integrator-$precision
        set=(--set integrator=$integrator --set precision=$precision --threads 1)
        run "${set[@]}" --out "$dir/$name-whole"
        run "${set[@]}" --out "$dir/$name-cut" --until 0.007
        run "${set[@]}" --out "$dir/$name-cut" --restart --until 0.012
        run "${set[@]}" --out "$dir/$name-cut" --restart
        agree "$dir/$name-whole" "$dir/$name-cut" "$name, cut twice"
    done
done

rows() { wc -l <"$dir/symplectic-mixed-whole/probes$1.csv"; }
# A header, and the rows from 0 up to the end.
[ "$(rows '') $(rows _slow) $(rows _fast)" = "202 56 647" ] ||
    fail "rows of the three files: $(rows '') $(rows _slow) $(rows _fast)"

set=(--set integrator=symplectic)
run "${set[@]}" --out "$dir/threads" --threads 3 --until 0.01
run "${set[@]}" --out "$dir/threads" --threads 2 --restart
agree "$dir/symplectic-mixed-whole" "$dir/threads" "another number of threads"

# From the older of two checkpoints, off the grid of every output: later rows are dropped and
# redone.
run "${set[@]}" --out "$dir/older" --set output.checkpoint_interval=0.00333
mapfile -t checkpoints < <(ls "$dir"/older/*.ckpt)
[ ${#checkpoints[@]} = 2 ] || fail "${#checkpoints[@]} checkpoints instead of 2"
run "${set[@]}" --out "$dir/grid" --set output.checkpoint_interval=0.00333
run "${set[@]}" --out "$dir/older" --restart "${checkpoints[0]}" \
    --set output.checkpoint_interval=0.00333
agree "$dir/grid" "$dir/older" "from an older checkpoint"

# Periodic sides: particles go round, and a wall goes through.
case=tests/fault/channel.cfg
for integrator in symplectic verlet leapfrog; do
    set=(--set integrator=$integrator --threads 1)
    run "${set[@]}" --out "$dir/round-$integrator"
    run "${set[@]}" --out "$dir/round-$integrator-cut" --until 0.012
    run "${set[@]}" --out "$dir/round-$integrator-cut" --restart
    agree "$dir/round-$integrator" "$dir/round-$integrator-cut" "periodic sides, $integrator"
done
grep -q '"fluid_left_domain": 0,' "$dir/round-verlet/summary.json" || fail "fluid was lost"

# After all water has left, the solid must not feel the places of the water at the start.
case=tests/fault/dry.cfg
for integrator in symplectic verlet leapfrog; do
    set=(--set integrator=$integrator --threads 1)
    run "${set[@]}" --out "$dir/dry-$integrator"
    run "${set[@]}" --out "$dir/dry-$integrator-cut" --until 0.05
    grep -q '"fluid_left_domain": 25,' "$dir/dry-$integrator-cut/summary.json" || fail "water stays"
    run "${set[@]}" --out "$dir/dry-$integrator-cut" --restart
    agree "$dir/dry-$integrator" "$dir/dry-$integrator-cut" "all water gone, $integrator"
done

[ $failures = 0 ] || exit 1
