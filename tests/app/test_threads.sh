#!/usr/bin/env bash
# How many threads a run takes at most: by its particles and by what is asked for.
. tests/support/shell.sh
large=(cases/still_water.cfg --until 0.002 --set output.snapshot_interval=1)
unset OMP_NUM_THREADS
threads() { sed -n 's/.*"threads": \([0-9]*\).*/\1/p' "$1/summary.json"; }
cores=$(nproc)

# --- few particles ---
expect 0 'simulated' tests/fault/tiny.cfg --out "$dir/tiny"
[ "$(threads "$dir/tiny")" = 1 ] || fail "145 particles have $(threads "$dir/tiny") threads"

# --- a number far too large, by either name, is reduced with a word ---
expect 0 'simulated' "${large[@]}" --threads 1 --out "$dir/one"
expect 0 'threads = 100000 is too many: 6000 particles .* at most' "${large[@]}" --threads 100000 \
    --out "$dir/many"
# A build without OpenMP has one thread, whatever the variable says.
if [ "$(threads "$dir/many")" = 1 ]; then
    [ $failures = 0 ] || exit 1
    exit 0
fi
export OMP_NUM_THREADS=100000
expect 0 'OMP_NUM_THREADS = 100000 is too many' "${large[@]}" --out "$dir/variable"
expect 0 'OMP_NUM_THREADS = 100000 is too many' "${large[@]}" --explain
unset OMP_NUM_THREADS
[ "$(threads "$dir/many")" -le $((4 * cores)) ] ||
    fail "$(threads "$dir/many") threads on $cores cores"
[ "$(threads "$dir/variable")" = "$(threads "$dir/many")" ] ||
    fail "OMP_NUM_THREADS has another limit"
[ "$(hash "$dir/many")" = "$(hash "$dir/one")" ] || fail "bits depend on the number of threads"

# --- on a busy machine the program may choose one thread at any step: the same bits ---
if [ "$cores" -gt 1 ]; then
    busy=()
    for _ in $(seq $((2 * cores))); do
        while :; do :; done &
        busy+=($!)
    done
    "$sphfsi" "${large[@]}" --threads 2 --out "$dir/busy" >"$dir/output" 2>&1 ||
        fail "a busy machine: $(cat "$dir/output")"
    kill "${busy[@]}"
    wait "${busy[@]}" 2>/dev/null
    [ "$(threads "$dir/busy")" = 2 ] || fail "--threads 2: $(threads "$dir/busy") threads"
    [ "$(hash "$dir/busy")" = "$(hash "$dir/one")" ] || fail "a busy machine: other bits"
fi

[ $failures = 0 ] || exit 1
