#!/usr/bin/env bash
# The n-th call of the system that makes, writes, syncs, renames or removes a file fails, or kills
# the program before it is done (strace --inject), for n from 1 to the last: a sentence and status
# 2, or no harm; afterwards the run goes on, or is begun anew where there was no checkpoint, to the
# same bits. INJECT_STRIDE=1 tries every n (make faults), 30 every thirtieth.
set -u
# The leak checker of a sanitized program cannot work under another tracer.
export ASAN_OPTIONS=detect_leaks=0
sphfsi=$(realpath "${SPHFSI:-./sphfsi}")
stride=${INJECT_STRIDE:-30}
dir=$(mktemp -d -p /dev/shm 2>/dev/null || mktemp -d)
trap 'rm -rf "$dir"' EXIT
strace -f -qq -o "$dir/trace" -e trace=none -e inject=fsync:error=EIO true 2>/dev/null || {
    echo "strace is not there, or cannot inject"
    exit 77
}
failures=0
arguments=(tests/fault/tiny.cfg --quiet --threads 1 --set end_time=1ms \
    --set output.probe_interval=0.1ms
    --set output.ledger_interval=0.2ms --set output.snapshot_interval=0.4ms
    --set output.checkpoint_interval=0.4ms)
run=$dir/run

fail() {
    echo "FAILED: $1"
    sed 's/^/    /' "$dir/output" | head -n 5
    failures=$((failures + 1))
}

hash() { sed -n 's/.*"state_hash": "\(.*\)".*/\1/p' "$1/summary.json" 2>/dev/null; }

"$sphfsi" "${arguments[@]}" --out "$dir/whole" >"$dir/output" 2>&1 || fail "the run itself"

# inject CALL WHAT N: a run in which the N-th CALL meets WHAT. 1: there are not so many calls.
inject() {
    rm -rf "$run"
    [ -z "$begun" ] || cp -r "$begun" "$run"
    # Calls of the dynamic linker come first; none of those that are looked at here is among them.
    # The shell's remark on a killed program goes with the braces.
    { strace -f -qq -o "$dir/trace" -e trace="$1" -e inject="$1:$2:when=$3" \
        "$sphfsi" "${arguments[@]}" --out "$run" ${begun:+--restart "$run/$older"} \
        >"$dir/output" 2>&1; } 2>/dev/null
    status=$?
    grep -q 'INJECTED\|SIGKILL' "$dir/trace"
}

finish() {
    local what=$1
    if compgen -G "$run/step-*.ckpt" >/dev/null; then
        "$sphfsi" "${arguments[@]}" --out "$run" --restart >"$dir/output" 2>&1 ||
            fail "$what: no restart"
        again=$((again + 1))
    else
        rm -rf "$run"
        "$sphfsi" "${arguments[@]}" --out "$run" >"$dir/output" 2>&1 || fail "$what: no new run"
        anew=$((anew + 1))
    fi
    [ "$(hash "$run")" = "$(hash "$dir/whole")" ] || fail "$what: other bits"
    cmp "$run/probes.csv" "$dir/whole/probes.csv" || fail "$what: probes.csv"
    cmp "$run/ledger.csv" "$dir/whole/ledger.csv" || fail "$what: ledger.csv"
    "${PYTHON:-python3}" tests/support/same_snapshots.py {"$run","$dir/whole"}/fields.vtkhdf ||
        fail "$what: fields.vtkhdf"
    compgen -G "$run/*.part" >/dev/null && fail "$what: an unfinished file stays"
}

begun='' older=$(cd "$dir/whole" && ls step-*.ckpt | head -n 1)
again=0 anew=0 kills=0 errors=0 harmless=0
for call in rename fsync unlink link ftruncate write pwrite64; do
    for ((n = 1 + RANDOM % stride; ; n += stride)); do
        inject $call signal=SIGKILL $n || break
        kills=$((kills + 1))
        [ $status = 137 ] || fail "killed at $call $n: exit status $status"
        finish "killed at $call $n"
    done
done

# A restart from the older of two checkpoints, while it removes the later one and cuts rows and
# snapshots: a kill must not leave the later one beside rows that were cut.
begun=$dir/whole
for call in unlink ftruncate rename; do
    for ((n = 1; n < 20; n += 1 + stride / 10)); do
        inject $call signal=SIGKILL $n || break
        kills=$((kills + 1))
        finish "restart killed at $call $n"
    done
done
begun=''

# HDF5 writes by pwrite64 and cuts by ftruncate; all else is of the program itself.
for call in rename:EIO fsync:EIO unlink:EPERM link:EMLINK ftruncate:EIO write:ENOSPC \
    fallocate:ENOSPC \
    pwrite64:ENOSPC pwrite64:EIO mkdir:EACCES; do
    for ((n = 1 + RANDOM % stride; ; n += stride)); do
        what="${call#*:} at ${call%:*} $n"
        inject "${call%:*}" "error=${call#*:}" $n || break
        errors=$((errors + 1))
        case $status in
            0) harmless=$((harmless + 1)) ;;
            1 | 2) grep -q "^sphfsi: .*$dir" "$dir/output" || fail "$what: no path is named" ;;
            *) fail "$what: exit status $status" ;;
        esac
        [ ! -e "$run/.lock" ] || [ "${call%:*}" = unlink ] || fail "$what: the lock is left"
        finish "$what"
    done
done

# A snapshot that is lost while the run goes on, since the disk takes its time to say so: no
# checkpoint later than it may stay, or a run that goes on would lack it. The times at which it is
# said do not matter.
lose() { # STATUS of a run whose file of snapshots fails to be synced; the arguments that it has \
    beside
    strace -f -qq -o "$dir/trace" -e trace=fsync -P "$run/fields.vtkhdf.spare" \
        -e inject=fsync:error=EIO:delay_exit=300000:when=1 \
        "$sphfsi" "${arguments[@]}" --out "$run" "$@" >"$dir/output" 2>&1
    status=$?
    [ $status = 2 ] && grep -q '"exit_reason": "input_output"' "$run/summary.json" ||
        fail "lost snapshot: exit status $status"
}
arguments=(tests/fault/tiny.cfg --quiet --threads 1 --set end_time=60ms \
    --set output.probe_interval=1ms
    --set output.snapshot_interval=30ms)
rm -rf "$dir/whole" "$run"
"$sphfsi" "${arguments[@]}" --out "$dir/whole" >"$dir/output" 2>&1 || fail "the long run itself"
lose
finish "first snapshot lost"
# The last one: its loss is known after all else has been done.
rm -rf "$run"
"$sphfsi" "${arguments[@]}" --out "$run" --until 0.03 >"$dir/output" 2>&1 ||
    fail "the long run, cut"
lose --restart
finish "last snapshot lost"

[ $kills -gt 3 ] && [ $errors -gt 3 ] || fail "only $kills kills and $errors errors"
echo "found: $kills kills within a call, $errors calls that failed ($harmless of them harmless);" \
    "$again runs gone on and $anew begun anew with the same bits; $failures failures"
[ $failures = 0 ] || exit 1
