#!/usr/bin/env bash
# Runs the tests: tests/run.sh build/release
#
# Unity programs below BUILD/tests, one for each tests/*/test_*.c, and the scripts
# tests/*/test_*.{py,sh}, which pass with exit status 0 and are skipped with 77.
# Environment: FILTER (part of a test's path), TEST_DIRS (groups to run), TEST_KINDS (c py sh),
# TEST_JOBS (at a time, 2), TEST_TIMEOUT (seconds each, 600), PYTHON, SPHFSI (the program under
# test). The last line is always `N passed, N failed, N skipped`; Unity's test cases count one each.
set -u
cd "$(dirname "$0")/.." || exit 1

# One test: prints its line, and its output if it failed; appends its counts to $RESULTS.
run_one() {
    local test=$1 name=${1#tests/} start=$SECONDS status counts passed=0 failed=0 skipped=0 note=""
    local output=$BUILD/test-logs/${name//\//-}.log command
    case $test in
        *.c) command=("$BUILD/${test%.c}") ;;
        *.py) command=("$PYTHON" "$test") ;;
        *.sh) command=(bash "$test") ;;
    esac
    if command -v timeout >/dev/null; then
        command=(timeout -k 10 "${TEST_TIMEOUT:-600}" "${command[@]}")
    fi
    # In a subshell, whose remark on a crash goes to the log.
    ("${command[@]}"; exit $?) >"$output" 2>&1 </dev/null
    status=$?
    [ $status != 124 ] || note="timed out"

    if [[ $test == *.c ]]; then
        counts=$(sed -n 's/^\([0-9]*\) Tests \([0-9]*\) Failures \([0-9]*\) Ignored.*/\1 \2 \3/p' \
            "$output" | tail -n 1)
        if [ -z "$counts" ]; then
            failed=1 note=${note:-"no summary line, exit status $status"}
        else
            read -r passed failed skipped <<<"$counts"
            passed=$((passed - failed - skipped))
            # All cases passed and yet it failed: a sanitizer's or an exit handler's complaint.
            if [ "$status" != 0 ] && [ "$failed" = 0 ]; then
                failed=1 note=${note:-"exit status $status"}
            fi
        fi
        if [ "$failed" = 0 ] && [ "$skipped" != 0 ]; then
            note="$skipped skipped: $(sed -n 's/.*:IGNORE:* *//p' "$output" | head -n 1)"
        fi
    else
        case $status in
            0) passed=1 ;;
            77) skipped=1 note=$(tail -n 1 "$output") ;;
            *) failed=1 note=${note:-"exit status $status"} ;;
        esac
    fi

    local verdict=pass
    [ "$passed" != 0 ] || verdict=skip
    [ "$failed" = 0 ] || verdict=FAIL
    # One write, so that lines of tests running side by side do not mix.
    printf '%s\n' "$(
        printf '%-4s %4d s  %-36s %3d' $verdict $((SECONDS - start)) "$name" $((passed + failed))
        echo "${note:+  ($note)}"
        [ "$failed" = 0 ] || sed 's/^/     | /' "$output" | tail -n 60
    )"
    echo "$passed $failed $skipped" >>"$RESULTS"
}

if [ "$1" = --one ]; then
    run_one "$2"
    exit
fi

export BUILD=$1 RESULTS=$1/test-results PYTHON=${PYTHON:-python3} SPHFSI=${SPHFSI:-./sphfsi}
# Tests share the cores: a thread that spins while it waits would take them from its neighbour.
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}
export UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1}
mkdir -p "$BUILD/test-logs"
: >"$RESULTS"

for test in tests/*/test_*.{c,py,sh}; do
    [ -e "$test" ] && [[ $test == *"${FILTER:-}"* ]] || continue
    group=${test#tests/} group=${group%%/*}
    [[ " ${TEST_DIRS:-$group} " == *" $group "* ]] || continue
    [[ " ${TEST_KINDS:-${test##*.}} " == *" ${test##*.} "* ]] || continue
    printf '%s\0' "$test"
done | xargs -0 -r -n 1 -P "${TEST_JOBS:-2}" bash tests/run.sh --one

awk '{ p += $1; f += $2; s += $3 }
     END { if (NR == 0) print "no test was run" (ENVIRON["FILTER"] == "" ? "" : \
               ": none matches " ENVIRON["FILTER"])
           printf "%d passed, %d failed, %d skipped\n", p, f, s
           exit !(f == 0 && p + s > 0) }' "$RESULTS"
