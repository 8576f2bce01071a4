#!/usr/bin/env bash
# A disk that fills up, at every stage of a run, on a real file system without room: status 2 and a
# sentence with the path; what was good stays good; with room again the run goes on to the same
# bits.
# FULL_STEPS: how many sizes of disk to try (8; make faults tries more).
set -u
sphfsi=$(realpath "${SPHFSI:-./sphfsi}")
if [ "${1:-}" != inside ]; then
    unshare -rm true 2>/dev/null || {
        echo "this system lets nobody mount a file system of one's own (unshare -rm)"
        exit 77
    }
    exec unshare -rm bash "$0" inside
fi
dir=$(mktemp -d)
trap 'umount "$dir/disk" 2>/dev/null; rm -rf "$dir"' EXIT
mkdir "$dir/disk"
failures=0

fail() {
    echo "FAILED: $1"
    sed 's/^/    /' "$dir/output"
    failures=$((failures + 1))
}

hash() { sed -n 's/.*"state_hash": "\(.*\)".*/\1/p' "$1/summary.json"; }
reason() { sed -n 's/.*"exit_reason": "\(.*\)".*/\1/p' "$1/summary.json"; }

run=$dir/disk/run

disk() { # of $1 KB
    umount "$dir/disk" 2>/dev/null
    mount -t tmpfs -o size="$1k" none "$dir/disk"
}

finish() { # WHAT: goes on with room, and ends with the bits of the run that had it always
    mount -o remount,size=64m "$dir/disk"
    "$sphfsi" "${arguments[@]}" --out "$run" --restart >"$dir/output" 2>&1 || fail "$1: no restart"
    [ "$(hash "$run")" = "$(hash "$dir/whole")" ] || fail "$1: other bits"
    cmp "$run/probes.csv" "$dir/whole/probes.csv" || fail "$1: probes.csv"
    cmp "$run/ledger.csv" "$dir/whole/ledger.csv" || fail "$1: ledger.csv"
}

steps=${FULL_STEPS:-8} stopped=0 went_on=0 early=0
declare -A at

# rehearse: one size of disk, in KB, and of what has been begun there.
rehearse() {
    local size=$1 begun=${2:-} got file
    disk "$size"
    [ -z "$begun" ] || cp -r "$begun" "$run" || fail "disk of $size KB: no room for the beginning"
    "$sphfsi" "${arguments[@]}" --out "$run" ${begun:+--restart} >"$dir/output" 2>&1
    got=$?
    [ $got = 0 ] && return
    stopped=$((stopped + 1))
    [ $got = 2 ] || fail "disk of $size KB: exit status $got"
    grep -q "^sphfsi: .*$run.*" "$dir/output" || fail "disk of $size KB: no path named"
    file=$(sed -n 's|^sphfsi: [^:]*/\([a-z]*\)[^/:]*:.*|\1|p' "$dir/output" | head -n 1)
    at[${file:-other}]=$((${at[${file:-other}]:-0} + 1))
    [ ! -e "$run/.lock" ] || fail "disk of $size KB: the lock is left"
    if compgen -G "$run/step-*.ckpt" >/dev/null; then
        finish "disk of $size KB"
        went_on=$((went_on + 1))
    else
        early=$((early + 1))
    fi
}

set_up() { # INTERVAL of snapshots, END
    rm -rf "$dir/whole"
    arguments=(tests/fault/tiny.cfg --threads 1 --quiet --set output.checkpoint_interval=1ms
        --set output.snapshot_interval="$1" --set output.probe_interval=0.02ms --set end_time="$2")
    "$sphfsi" "${arguments[@]}" --out "$dir/whole" >"$dir/output" 2>&1 || fail "the run itself"
}

# With many snapshots they are what the disk has no room for.
set_up 1ms 20ms
need=$(($(du -sk "$dir/whole" | cut -f1) * 2))
for ((k = 0; k < steps; k++)); do rehearse $((16 + need * (k + 1) / steps / 4 * 4)); done

# With the last one written but that of the end, it is checkpoints and rows.
set_up 4ms 7.9ms
"$sphfsi" "${arguments[@]}" --out "$dir/begun" --until 0.004 >"$dir/output" 2>&1 || fail "begun"
for ((k = 0; k < steps; k++)); do
    # Its grid is a part of the probes', so that none but the last one takes the same steps.
    [ $((2 * k)) -lt $steps ] || arguments+=(--set output.checkpoint_interval=0)
    rehearse $(($(du -sk "$dir/begun" | cut -f1) + 200 * k / steps % 100 / 4 * 4)) "$dir/begun"
done
[ $((${at[step]:-0} + ${at[probes]:-0} + ${at[ledger]:-0})) -gt 0 ] ||
    fail "no disk was too small for a checkpoint or a row"
[ $stopped -gt 2 ] || fail "only $stopped disks were too small"

arguments=(tests/fault/tiny.cfg --threads 1 --quiet --set output.snapshot_interval=1ms)
rm -rf "$dir/whole"
"$sphfsi" "${arguments[@]}" --out "$dir/whole" >"$dir/output" 2>&1 || fail "the run itself"

# --- a run that goes on without snapshots, where the user wants it so ---
# Only HDF5's file is too large: a limit on the size of a file stands for a quota.
(
    ulimit -f 120
    exec "$sphfsi" "${arguments[@]}" --out "$dir/rows" --set output.snapshot_failure=go_on
) >"$dir/output" 2>&1 || fail "snapshot_failure = go_on: exit status $?"
grep -q 'warning: the snapshot at .* is missing, the run continues' "$dir/output" ||
    fail "snapshot_failure = go_on: no warning"
grep -q '"snapshots_missed": [1-9]' "$dir/rows/summary.json" || fail "snapshots_missed"
[ "$(hash "$dir/rows")" = "$(hash "$dir/whole")" ] || fail "snapshot_failure = go_on: other bits"
cmp "$dir/rows/probes.csv" "$dir/whole/probes.csv" || fail "snapshot_failure = go_on: probes.csv"
(
    ulimit -f 120
    exec "$sphfsi" "${arguments[@]}" --out "$dir/stop"
) >"$dir/output" 2>&1
[ $? = 2 ] || fail "snapshot_failure = stop: the run did not stop"
[ "$(reason "$dir/stop")" = input_output ] || fail "snapshot_failure = stop: exit_reason"

# --- the folder removed under the run ---
cp tests/fault/still.cfg "$dir/still.cfg"
"$sphfsi" "$dir/still.cfg" --threads 1 --quiet --out "$dir/gone" \
    --set output.checkpoint_interval=5ms >"$dir/output" 2>&1 &
pid=$!
for _ in $(seq 200); do
    compgen -G "$dir/gone/step-*.ckpt" >/dev/null && break
    sleep 0.05
done
mv "$dir/gone" "$dir/moved" && rm -rf "$dir/moved"
wait $pid
got=$?
[ $got = 2 ] || fail "folder removed under the run: exit status $got"
grep -q "$dir/gone" "$dir/output" || fail "folder removed under the run: no path named"
[ ! -e "$dir/gone" ] || fail "folder removed under the run: something was made in its place"

files=$(for f in "${!at[@]}"; do printf '%s %d, ' "$f" "${at[$f]}"; done)
echo "found: $stopped disks too small (${files}by the file named), $went_on runs gone on with the" \
    "same bits, $early stopped before the first checkpoint; $failures failures"
[ $failures = 0 ] || exit 1
