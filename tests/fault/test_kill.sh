#!/usr/bin/env bash
# kill -9 at random moments, again and again, until the run is through: the same final bits, rows
# and snapshots as one that was never killed. KILLS=50 for the long form (make faults).
set -u
sphfsi=${SPHFSI:-./sphfsi}
kills=${KILLS:-4}
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
failures=0

# A checkpoint every other step, so that many kills come while one is written.
arguments=(tests/fault/tiny.cfg --threads 1 --until 0.03 --quiet
    --set end_time=0.03 --set output.checkpoint_interval=0.3ms --set output.snapshot_interval=2ms)

fail() {
    echo "FAILED: $1"
    failures=$((failures + 1))
}

hash() { sed -n 's/.*"state_hash": "\(.*\)".*/\1/p' "$1/summary.json"; }

begin=$(date +%s%N)
"$sphfsi" "${arguments[@]}" --out "$dir/whole" >"$dir/output" 2>&1 || fail "the run itself"
span=$((($(date +%s%N) - begin) / 1000000)) # ms

killed=0 in_checkpoint=0 in_snapshot=0 anew=0 chains=0 finished=yes
while [ $killed -lt "$kills" ] || [ $finished = no ]; do
    if [ $finished = yes ]; then
        rm -rf "$dir/run"
        chains=$((chains + 1))
        finished=no
    fi
    restart=--restart
    if ! compgen -G "$dir/run/step-*.ckpt" >/dev/null; then
        rm -rf "$dir/run" # killed before there was anything to go on from
        restart=
    fi
    "$sphfsi" "${arguments[@]}" --out "$dir/run" $restart >"$dir/output" 2>&1 &
    pid=$!
    ms=$((RANDOM * span / 32768))
    sleep "$((ms / 1000)).$(printf %03d $((ms % 1000)))"
    if [ $killed -lt "$kills" ] && kill -KILL $pid 2>/dev/null; then
        wait $pid 2>/dev/null
        status=$?
        [ $status = 137 ] && killed=$((killed + 1))
    else
        wait $pid
        status=$?
    fi
    case $status in
        0)
            finished=yes
            [ "$(hash "$dir/run")" = "$(hash "$dir/whole")" ] || fail "kill $killed: other bits"
            cmp "$dir/run/probes.csv" "$dir/whole/probes.csv" || fail "kill $killed: probes.csv"
            cmp "$dir/run/ledger.csv" "$dir/whole/ledger.csv" || fail "kill $killed: ledger.csv"
            "${PYTHON:-python3}" tests/support/same_snapshots.py "$dir"/{run,whole}/fields.vtkhdf ||
                fail "kill $killed: fields.vtkhdf"
            ;;
        137)
            compgen -G "$dir/run/step-*.part" >/dev/null && in_checkpoint=$((in_checkpoint + 1))
            [ -e "$dir/run/fields.vtkhdf.spare" ] && in_snapshot=$((in_snapshot + 1))
            compgen -G "$dir/run/step-*.ckpt" >/dev/null || anew=$((anew + 1))
            ;;
        *)
            fail "kill $killed: exit status $status"
            cat "$dir/output"
            rm -rf "$dir/run"
            finished=yes
            [ $failures -lt 5 ] || break
            ;;
    esac
done
echo "found: killed $killed times in $chains runs, $in_checkpoint times while a checkpoint" \
    "was being written, $anew times before there was one; $failures differences"
[ $failures = 0 ] || exit 1
