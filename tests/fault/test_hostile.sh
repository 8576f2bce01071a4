#!/usr/bin/env bash
# Files that are none, links that lead out of the folder, names that are none, storms of signals: a
# sentence each time, no waiting, and nothing outside of the folder is written.
set -u
sphfsi=$(realpath "${SPHFSI:-./sphfsi}")
case=$(realpath tests/fault/tiny.cfg)
still=$(realpath tests/fault/still.cfg)
dir=$(mktemp -d -p /dev/shm 2>/dev/null || mktemp -d)
trap 'rm -rf "$dir"' EXIT
failures=0 tried=0

fail() {
    echo "FAILED: $1"
    sed 's/^/    /' "$dir/output" | cut -c1-300
    failures=$((failures + 1))
}

# expect STATUS WORDS ARGUMENTS...: the program ends so, says so, and soon.
expect() {
    local status=$1 words=$2
    shift 2
    timeout 20 "$sphfsi" "$@" --quiet >"$dir/output" 2>&1
    local got=$?
    tried=$((tried + 1))
    [ $got = "$status" ] || fail "${*: -3}: exit status $got instead of $status"
    [ -z "$words" ] || grep -q -- "$words" "$dir/output" || fail "${*: -3}: does not say '$words'"
}

hash() { sed -n 's/.*"state_hash": "\(.*\)".*/\1/p' "$1/summary.json"; }

"$sphfsi" "$case" --quiet --out "$dir/whole" 2>/dev/null

# --- case files that are none ---
mkfifo "$dir/fifo.cfg"
expect 1 'fifo.cfg: is a pipe or a device; a case is a regular file' "$dir/fifo.cfg" --out "$dir/no"
expect 1 '/dev/zero: is a pipe or a device' /dev/zero --out "$dir/no"
expect 1 'is a folder; a case is a regular file' "$dir" --out "$dir/no"
truncate -s 1G "$dir/giant.cfg"
expect 1 'giant.cfg: longer than 4194304 bytes; is it a case file?' "$dir/giant.cfg" --out "$dir/no"
: >"$dir/empty.cfg"
expect 1 'empty.cfg:1: `dp` is missing' "$dir/empty.cfg" --out "$dir/no"
printf 'dp = 1 \0mm\n' >"$dir/nul.cfg"
expect 1 'nul.cfg:1: a byte of value 0; a case file is plain text' "$dir/nul.cfg" --out "$dir/no"
head -c 300000 /dev/urandom >"$dir/noise.cfg"
expect 1 'noise.cfg:[0-9]*: ' "$dir/noise.cfg" --out "$dir/no"
expect 1 'not a valid checkpoint\|byte of value 0' "$(ls "$dir"/whole/*.ckpt)" --out "$dir/no"
ln -s loop.cfg "$dir/loop.cfg"
expect 1 'loop.cfg: cannot be opened' "$dir/loop.cfg" --out "$dir/no"
if [ "$(id -u)" != 0 ]; then
    install -m 000 "$case" "$dir/closed.cfg"
    expect 1 'closed.cfg: cannot be read: Permission denied' "$dir/closed.cfg" --out "$dir/no"
fi
sed 's/^point.*/&\n[table way]\nfile = fifo.cfg/' "$case" >"$dir/table.cfg"
expect 1 'is not a file' "$dir/table.cfg" --out "$dir/no"
sed 's/^point.*/&\n[reference r]\nprobe = M1_dx_m\nfile = fifo.cfg/' "$case" >"$dir/reference.cfg"
expect 1 'is not a file' "$dir/reference.cfg" --out "$dir/no"
[ ! -e "$dir/no" ] || fail "wrong input left a folder"

# --- the same case in other dress ---
(printf '\357\273\277' && sed 's/$/\r/' "$case") >"$dir/windows.cfg"
expect 0 '' "$dir/windows.cfg" --out "$dir/windows"
[ "$(hash "$dir/windows")" = "$(hash "$dir/whole")" ] || fail "a mark and CR LF change the bits"

# --- names ---
cp "$case" "$dir/...cfg"
(cd "$dir" && mkdir -p sub && cd sub &&
    expect 1 "'..' cannot be the name of the folder" ../...cfg &&
    [ -z "$(ls)" ] || fail "a case named by dots: wrote beside itself")
long=$(printf 'x%.0s' {1..300})
expect 1 'File name too long' "$case" --out "$dir/$long"
longer=$(for _ in {1..13}; do printf '%s/' "$long"; done)
expect 1 'characters, but 1 to' "$case" --out "$dir/$longer"
expect 1 'characters, but 1 to' "$case" --out ''
expect 0 '' "$case" --out "$dir/"$'a name\nwith "odd" \\ signs\t%s'
"${PYTHON:-python3}" -c 'import json, sys; json.load(open(sys.argv[1]))' \
    "$dir/"$'a name\nwith "odd" \\ signs\t%s/summary.json' || fail "summary.json of an odd folder"
for key in 'fluid w/../x' 'probe ../x' 'wall /etc' 'solid a b'; do
    sed "s|^\[probe M1\]|[$key]|" "$case" >"$dir/escape.cfg"
    expect 1 'has up to 63 letters, digits' "$dir/escape.cfg" --out "$dir/no"
done

# --- links in the folder: nothing they lead to is written ---
victim() {
    echo precious >"$dir/$1"
    echo "$dir/$1"
}
mkdir "$dir/links"
for name in case.cfg.part summary.json.part fields.vtkhdf.spare fields.vtkhdf.spare.old \
    step-000000200.ckpt.part; do
    ln -s "$(victim "of-$name")" "$dir/links/$name"
done
expect 0 '' "$case" --out "$dir/links"
[ "$(hash "$dir/links")" = "$(hash "$dir/whole")" ] || fail "links in the folder change the bits"
mkdir "$dir/locked"
ln -s "$(victim of-lock)" "$dir/locked/.lock"
expect 1 '.lock: cannot be written: it is a symbolic link' "$case" --out "$dir/locked"
for name in probes.csv ledger.csv; do
    rm -rf "$dir/rows"
    expect 0 '' "$case" --out "$dir/rows" --until 0.01
    mv "$dir/rows/$name" "$dir/of-$name"
    cp "$dir/of-$name" "$dir/kept"
    ln -s "$dir/of-$name" "$dir/rows/$name"
    expect 2 "$name: cannot be written: it is a symbolic link" "$case" --out "$dir/rows" --restart
    cmp -s "$dir/kept" "$dir/of-$name" || fail "$name: written through a link"
    rm "$dir/of-$name"
done
expect 0 '' "$case" --out "$dir/pictures" --until 0.01
mv "$dir/pictures/fields.vtkhdf" "$dir/moved.vtkhdf"
cp "$dir/moved.vtkhdf" "$dir/kept"
ln -s "$dir/moved.vtkhdf" "$dir/pictures/fields.vtkhdf"
expect 0 'restart from\|' "$case" --out "$dir/pictures" --restart
cmp -s "$dir/kept" "$dir/moved.vtkhdf" || fail "fields.vtkhdf: written through a link"
for file in "$dir"/of-*; do
    [ "$(cat "$file")" = precious ] || fail "written through a link: $file"
done

# --- in the place of checkpoints ---
expect 0 '' "$case" --out "$dir/run" --until 0.01
good=$(ls "$dir"/run/step-*.ckpt)
mkdir "$dir/run/step-000000150.ckpt"
mkfifo "$dir/run/step-000000160.ckpt"
: >"$dir/run/step-7.ckpt"
: >"$dir/run/step--00000007.ckpt"
: >"$dir/run/step-99999999999999999999.ckpt"
: >"$dir/run/step-000000170.ckpt"
echo torn >"$dir/run/step-000000180.ckpt.part"
expect 0 'step-000000170.ckpt: is not a valid checkpoint: .*; trying the checkpoint before it' \
    "$case" --out "$dir/run" --restart
[ "$(hash "$dir/run")" = "$(hash "$dir/whole")" ] ||
    fail "strangers beside checkpoints change the bits"
[ ! -e "$dir/run/step-000000180.ckpt.part" ] || fail "an unfinished checkpoint stays for ever"
[ -e "$dir/run/step-7.ckpt" ] || fail "a file of another's was removed"
expect 1 'is not a file' "$case" --out "$dir/run" --restart "$dir/run/step-000000150.ckpt"
expect 1 'is not a file' "$case" --out "$dir/run" --restart "$dir/run/step-000000160.ckpt"
expect 1 'is not a file' --inspect "$dir/run/step-000000160.ckpt"
expect 1 'contains no valid checkpoint\|contains no checkpoint' "$case" --fork "$dir/sub" --out \
    "$dir/no"

# --- from an older one: the later one belongs to a future that is run anew ---
expect 0 '' "$case" --out "$dir/older" --set output.checkpoint_interval=10ms
older=$(cd "$dir/older" && echo step-* | cut -d' ' -f1)
expect 0 '' "$case" --out "$dir/older" --set output.checkpoint_interval=10ms \
    --restart "$dir/older/$older" --until 0.015
last=$(sed -n 's/.*"steps": \([0-9]*\),.*/\1/p' "$dir/older/summary.json" | head -1)
[ "$(cd "$dir/older" && echo step-*)" = "$older step-$(printf %09d "$last").ckpt" ] ||
    fail "from an older checkpoint: $(cd "$dir/older" && echo step-*)"

# --- a finished run, continued again: nothing changes ---
cp "$dir/whole/probes.csv" "$dir/kept"
expect 0 '' "$case" --out "$dir/whole" --restart
cmp -s "$dir/kept" "$dir/whole/probes.csv" || fail "--restart of a finished run changes its rows"
expect 1 'above 0' "$case" --out "$dir/no" --until nan
expect 1 'above 0' "$case" --out "$dir/no" --until 1e400
expect 1 'above 0' "$case" --out "$dir/no" --until '1 m'
expect 1 'above 0' "$case" --out "$dir/no" --until '1 s s'
expect 1 'above 0' "$case" --out "$dir/no" --until '1e10 h'

# --- a folder that may be read only, where permissions count ---
if [ "$(id -u)" != 0 ]; then
    chmod a-w "$dir/whole"
    expect 1 '.lock: cannot be written: Permission denied' "$case" --out "$dir/whole" --restart
    chmod u+w "$dir/whole"
fi

# --- storms ---
start() {
    "$sphfsi" "$still" --quiet --out "$1" >"$dir/output" 2>&1 &
    pid=$!
    for _ in $(seq 200); do
        [ -s "$1/probes.csv" ] && return
        sleep 0.02
    done
    fail "$1 did not start"
}
start "$dir/storm"
for _ in $(seq 200); do kill -USR1 $pid; done
for _ in $(seq 200); do kill -TERM $pid 2>/dev/null || break; done
wait $pid
got=$?
[ $got = 143 ] || fail "200 SIGTERM: exit status $got"
grep -q '"exit_reason": "interrupted"' "$dir/storm/summary.json" || fail "200 SIGTERM: no summary"
compgen -G "$dir/storm/*.part" >/dev/null && fail "200 SIGTERM: an unfinished file"
[ "$(ls "$dir"/storm/step-*.ckpt | wc -l)" -le 2 ] || fail "200 SIGUSR1: more than two checkpoints"
end=$(tail -n 1 "$dir/storm/ledger.csv" | awk -F, '{ print int(100 * $1 + 2) / 100 }')
expect 0 '' "$still" --out "$dir/storm" --restart --until "$end"
awk -F, 'NR > 1 { off = $1 - (NR - 2) * 0.001; if (off * off > 1e-20) bad = 1 } END { exit bad }' \
    "$dir/storm/probes.csv" || fail "200 SIGTERM and continued: a gap or a doubled row"

echo "found: $tried hostile starts, 2 storms of 200 signals; $failures failures"
[ $failures = 0 ] || exit 1
