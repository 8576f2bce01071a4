#!/usr/bin/env bash
# Every shipped case, coarse and short (the lines `short NAME END SETTING...` of
# tests/agree/test_restart_cases.sh), each with the next integrator, and a stop, a restart and a
# fork: tests/short_runs.sh PROGRAM [COMMAND...], COMMAND being a checker such as valgrind, or a
# program that checks itself. Fails if one of the runs does.
set -u
cd "$(dirname "$0")/.."
program=$1
shift
checker=("$@")
[ $# = 0 ] || command -v "$1" >/dev/null || { echo "$1 is not there"; exit 77; }
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
runs=0 failures=0
mapfile -t integrators < <(sed -n 's/^CHOICE(top, *integrator, *[0-9]*, *"\([^"]*\)".*/\1/p' \
    src/case/params.def | tr '|' '\n')

check() { # NAME ARGUMENTS...
    local name=$1
    shift
    "${checker[@]}" "$program" "$@" --quiet >"$dir/output" 2>&1
    local status=$?
    runs=$((runs + 1))
    [ $status = 0 ] && return
    failures=$((failures + 1))
    echo "FAILED: $name: exit status $status"
    grep -v '^warning' "$dir/output" | head -n 60
}

# A fortieth of the time: a handful of steps, or of batches of a lone solid.
short() {
    local name=$1 end set=()
    end=$(awk "BEGIN { printf \"%.12g\", $2 / 40 }")
    shift 2
    for value in "$@"; do set+=(--set "$value"); done
    set+=(--set "integrator=${integrators[runs % ${#integrators[@]}]}")
    check "$name" "cases/$name.cfg" "${set[@]}" --until "$end" --out "$dir/$name-$runs"
}

source <(sed -n '/^short /{:a; /\\$/{N; ba}; p}' tests/agree/test_restart_cases.sh)
for integrator in "${integrators[@]}"; do
    check "tiny, $integrator" tests/fault/tiny.cfg --out "$dir/tiny-$integrator" --until 0.001 \
        --set "integrator=$integrator" --set numerics.multirate=off --set precision=double
done
tiny=(tests/fault/tiny.cfg --out "$dir/tiny" --set output.checkpoint_interval=0.5ms)
check tiny "${tiny[@]}" --until 0.002
check 'tiny, continued' "${tiny[@]}" --until 0.003 --restart
check 'tiny, forked' tests/fault/tiny.cfg --out "$dir/fork" --fork "$dir/tiny" --until 0.004 \
    --set gate.young=2e6
check explain tests/fault/tiny.cfg --explain
check inspect --inspect "$(ls "$dir"/tiny/step-*.ckpt | tail -n 1)"
echo "found: $runs short runs, $failures with a finding"
[ $failures = 0 ]
