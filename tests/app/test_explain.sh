#!/usr/bin/env bash
# What --explain and --budget say, from costs that are given: by hand, and in the unit that suits.
. tests/support/shell.sh
export OMP_NUM_THREADS=1 XDG_CACHE_HOME=$dir/cache
still=(cases/still_water.cfg --set "dp=20 mm" --set "wall=80 mm")
explain() { "$sphfsi" --explain "${still[@]}" "$@" 2>/dev/null >"$dir/said" || fail "--explain $*"; }
says() { grep -q -- "$1" "$dir/said" || fail "no '$1': $(cat "$dir/said")"; }

explain
# give SECONDS: a fluid particle and evaluation costs so much, whatever the scene; two phases take it.
count=$(awk '{ print NF }' "$dir/cache/sphfsi/costs" | head -n 1)
give() {
    awk -v c="$1" -v n="$count" '{
        printf "%s %s 0 1 0.75 0.25", $1, c
        for (k = 7; k <= n; k++) printf " 0"
        print "" }' "$dir/cache/sphfsi/costs" >"$dir/new" && cp "$dir/new" "$dir/cache/sphfsi/costs"
}

# Peaks of single instants are not a result; a mean over time has no such line.
cp cases/templates/baffle.cfg "$dir/baffle.cfg"
"$sphfsi" --explain "$dir/baffle.cfg" 2>/dev/null >"$dir/instants" || fail "--explain baffle"
grep -q '^  \[probe load\]: rows are of single instants' "$dir/instants" || fail "no line on single instants"
"$sphfsi" --explain "$dir/baffle.cfg" --set "load.average=1 ms" 2>/dev/null >"$dir/instants" || fail "average"
grep -q 'single instants' "$dir/instants" && fail "a mean is not a single instant"

# The file of snapshots is as large as its points.
size="\([0-9]*\) snapshots of \([0-9]*\) points of \([0-9]*\) bytes: \([^ ]*\) MB"
sed -n "s/^  fields.vtkhdf: $size.*/\1 \2 \3 \4/p" "$dir/said" |
    awk '{ found = 1; off = 1e-6 * $1 * $2 * $3 / $4 - 1 }
         END { exit !(found && off * off < 3e-5) }' || fail "size of the snapshots"

# Steps, and an evaluation for each row of the ledger, of all particles.
for row in "1e-6 s 1" "2e-4 min 60" "0.2 h 3600"; do
    read -r cost unit of <<<"$row"
    give "$cost"
    explain
    says 'from an earlier calibration'
    says " 75.0 % of a step  "
    says " 25.0 % of a step  "
    [ "$(grep -c '% of a step' "$dir/said")" = 2 ] || fail "phases that take nothing are listed"
    particles=$(sed -n 's/^  fluid *\([0-9]*\) particles.*/\1/p' "$dir/said")
    steps=$(sed -n 's/^  about \([0-9.e+]*\) steps.*/\1/p' "$dir/said")
    rows=$("$sphfsi" --effective "${still[@]}" | awk '
        / = / { value[$1] = $3 }
        END { print value["end_time"] / value["ledger_interval"] }')
    want=$(awk "BEGIN { print ($steps + $rows) * $particles * $cost / $of }")
    for factor in 1 0.9 1.4; do
        got=$(awk -v f=$factor '
            f == 1 && / on this machine when idle/ { print $1, $2 }
            f == 0.9 && /nine of ten runs take/ { print $6, $7 }
            f == 1.4 && /nine of ten runs take/ { print $9, $10 }' "$dir/said" | tr -d ';')
        awk -v got="${got% *}" -v want="$want" -v f=$factor 'BEGIN {
            off = got / want / f - 1; exit off * off > 1e-4 }' && [ "${got#* }" = "$unit" ] ||
            fail "$factor of $want $unit at $cost, not $got"
    done
done
give 1e-6
explain --threads 2
says 'cost with 2 threads'
explain --until 1e6
says 'disk at most [0-9.]* GB'

# A budget lists round spacings, each once, coarsest first, whose time is from a tenth of it to three times.
"$sphfsi" --budget 20s "${still[@]}" >"$dir/said" 2>/dev/null || fail "--budget"
awk '
    /^  dp / && !/own/ {
        digits = $2; while (digits < 1) digits *= 10
        digits = sprintf("%.6g", digits)
        if (!((" 1 1.25 2 2.5 4 5 8 ") ~ (" " digits " "))) bad = bad " not round: " $2
        if (n++ && $2 >= last) bad = bad " out of order: " $2
        if ($8 < 2 || $8 > 60) bad = bad " out of range: " $8
        if (/fits$/ && $8 > 20) bad = bad " fits: " $8
        if (/fits$/) best = $2
        last = $2
    }
    /^finest dp within the budget/ { said = $7; sub("dp=", "", said) }
    END { if (bad || n < 3 || said != best) { print n, best, said, bad; exit 1 } }' "$dir/said" ||
    fail "--budget: $(cat "$dir/said")"
# All of the round numbers between the first and the last.
awk '/^  dp / && !/own/ { print $2 }' "$dir/said" | "$PYTHON" -c '
import sys
got = [float(word) for word in sys.stdin.read().split()]
want = [d * 10.0**p for p in range(-6, 2) for d in (1, 1.25, 2, 2.5, 4, 5, 8)]
want = sorted((w for w in want if got[-1] * 0.999 < w < got[0] * 1.001), reverse=True)
sys.exit(len(got) != len(want) or any(abs(g / w - 1) > 1e-6 for g, w in zip(got, want)))' ||
    fail "--budget leaves spacings out: $(cat "$dir/said")"
give 1e3
"$sphfsi" --budget 1s "${still[@]}" >"$dir/said" 2>/dev/null || fail "--budget of too little"
says "no listed dp both fits"

# Without a folder for caches nothing is kept, and the forecast is made all the same.
for home in "$dir/home" nowhere ""; do
    env -u XDG_CACHE_HOME HOME="$home" "$sphfsi" --explain "${still[@]}" >"$dir/said" 2>/dev/null ||
        fail "HOME=$home"
    says 'measured in one second of trial steps'
done
[ ! -e "$dir/home" ] || fail "a home that is missing was made"
mkdir "$dir/home"
for word in 'measured in one second' 'from an earlier calibration'; do
    env -u XDG_CACHE_HOME HOME="$dir/home" "$sphfsi" --explain "${still[@]}" >"$dir/said" 2>/dev/null
    says "$word"
done
[ -s "$dir/home/.cache/sphfsi/costs" ] || fail "nothing is kept in \$HOME/.cache"

# A lattice that is not upright is said, of the fluid as of a body.
"$sphfsi" --explain "${still[@]}" --set "numerics.lattice_angle=30 deg" >"$dir/said" 2>/dev/null
says 'fluid and walls are sampled on a lattice at 30 degrees'
[ $failures = 0 ] || exit 1
