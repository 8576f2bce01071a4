#!/usr/bin/env bash
# How many threads a run takes: by its particles, the idle cores, and what is asked for.
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

# --- a number that is asked for is taken on a busy machine, too; the default is fewer there ---
if [ "$cores" -gt 1 ]; then
    busy=()
    for _ in $(seq $((2 * cores))); do
        while :; do :; done &
        busy+=($!)
    done
    "$sphfsi" "${large[@]}" --out "$dir/busy" >"$dir/output" 2>&1 || fail "a busy machine"
    env -u OMP_WAIT_POLICY "$sphfsi" "${large[@]}" --threads 2 --out "$dir/asked" \
        >"$dir/asked.txt" 2>&1 || fail "--threads 2"
    env -u OMP_WAIT_POLICY OMP_NUM_THREADS=2 "$sphfsi" "${large[@]}" --out "$dir/set" \
        >"$dir/set.txt" 2>&1 ||
        fail "OMP_NUM_THREADS=2"
    kill "${busy[@]}"
    wait "${busy[@]}" 2>/dev/null
    grep -q 'busy: 1 of .* cores idle, so the run uses 1 thread; .* give --threads [2-9]' \
        "$dir/output" ||
        fail "a busy machine is not said"
    [ "$(threads "$dir/busy")" = 1 ] || fail "a busy machine: $(threads "$dir/busy") threads"
    [ "$(threads "$dir/asked")" = 2 ] || fail "--threads 2: $(threads "$dir/asked") threads"
    [ "$(threads "$dir/set")" = 2 ] || fail "OMP_NUM_THREADS=2: $(threads "$dir/set") threads"
    for file in asked set; do
        grep -q 'busy: 1 of .* for the 2 threads .*; --threads 1 is no slower' "$dir/$file.txt" ||
            fail "no word of the cost of 2 threads on a busy machine: $(cat "$dir/$file.txt")"
    done
    [ "$(hash "$dir/busy")" = "$(hash "$dir/one")" ] || fail "a busy machine: other bits"
fi

# --- gcc's runtime waits as long as a wake-up takes, unless the user says how long ---
unset OMP_WAIT_POLICY GOMP_SPINCOUNT
rounds() { OMP_DISPLAY_ENV=verbose "$@" 2>&1 | sed -n "s/.*GOMP_SPINCOUNT = '\(.*\)'/\1/p" |
    xargs; }
two=("$sphfsi" cases/still_water.cfg --set "title=two  words" --effective --threads 2)
theirs=$(rounds "${two[@]}" --threads 1)
if [ -n "$theirs" ]; then
    ours=$(rounds "${two[@]}")
    [[ $ours =~ ^$theirs\ [0-9]+$ && ${ours#* } -lt $theirs ]] || fail "rounds of waiting: $ours"
    [ "$(GOMP_SPINCOUNT=777 rounds "${two[@]}")" = 777 ] || fail "the user's GOMP_SPINCOUNT"
    [ "$(OMP_WAIT_POLICY=passive rounds "${two[@]}")" = 0 ] || fail "the user's OMP_WAIT_POLICY"
fi
"${two[@]}" >"$dir/output" 2>&1 && grep -q '^title = two  words$' "$dir/output" ||
    fail "arguments are not the same when the program has started itself again"
loader=$(ldd "$sphfsi" 2>/dev/null | sed -n 's/^[[:space:]]*\(\/[^ ]*ld[-.][^ ]*\) (.*/\1/p')
if [ -x "$loader" ]; then
    "$loader" "${two[@]}" >"$dir/loaded" 2>&1
    cmp -s "$dir/output" "$dir/loaded" || fail "started by $loader: $(head -3 "$dir/loaded")"
fi

[ $failures = 0 ] || exit 1
