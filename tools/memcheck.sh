#!/usr/bin/env bash
# Every shipped case, coarse and short (the lines `short NAME END SETTING...` of
# tests/agree/test_restart_cases.sh), and a stop with its restart, under valgrind's memcheck:
# tools/memcheck.sh PROGRAM. Fails on an error or a block that is lost for certain.
set -u
cd "$(dirname "$0")/.."
program=$1
command -v valgrind >/dev/null || { echo "valgrind is not there"; exit 77; }
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
export OMP_NUM_THREADS=1
runs=0 failures=0

check() { # NAME ARGUMENTS...
    local name=$1
    shift
    valgrind --quiet --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite \
        --show-leak-kinds=definite "$program" "$@" --quiet >"$dir/output" 2>&1
    local status=$?
    runs=$((runs + 1))
    [ $status = 0 ] && return
    failures=$((failures + 1))
    echo "FAILED: $name: exit status $status"
    grep -v '^warning' "$dir/output" | head -n 40
}

# A fortieth of the time: a handful of steps, or of batches of a lone solid.
short() {
    local name=$1 end set=()
    end=$(awk "BEGIN { printf \"%.12g\", $2 / 40 }")
    shift 2
    for value in "$@"; do set+=(--set "$value"); done
    check "$name" "cases/$name.cfg" "${set[@]}" --until "$end" --out "$dir/$name"
}

source <(sed -n '/^short /{:a; /\\$/{N; ba}; p}' tests/agree/test_restart_cases.sh)
tiny=(tests/fault/tiny.cfg --out "$dir/tiny" --set output.checkpoint_interval=0.5ms)
check tiny "${tiny[@]}" --until 0.002
check 'tiny, continued' "${tiny[@]}" --until 0.003 --restart
check 'tiny, forked' tests/fault/tiny.cfg --out "$dir/fork" --fork "$dir/tiny" --until 0.004 \
    --set gate.young=2e6
check explain tests/fault/tiny.cfg --explain
check inspect --inspect "$(ls "$dir"/tiny/step-*.ckpt | tail -n 1)"
echo "found: $(valgrind --version), $runs runs, $failures with an error or a definite leak"
[ $failures = 0 ]
