#!/usr/bin/env bash
# What --explain and tools/budget.py say: in the unit that suits, and as it follows from the cost of
# a particle.
. tests/support/shell.sh
export OMP_NUM_THREADS=1
still=(cases/still_water.cfg --set "dp=20 mm" --set "wall=80 mm")
explain() { "$sphfsi" --explain "${still[@]}" "$@" 2>/dev/null >"$dir/said" ||
    fail "--explain $*"; }
says() { grep -q -- "$1" "$dir/said" || fail "no '$1': $(cat "$dir/said")"; }

# Steps of all particles; two rows and snapshots take little.
for row in "5 s 1" "1e4 min 60" "2e5 h 3600"; do
    read -r until unit of <<<"$row"
    explain --until "$until" --set output.probe_interval="$until" \
        --set output.ledger_interval="$until" --set output.snapshot_interval="$until"
    says "cost with 1 thread, measured in 0.3 s"
    cost=$(sed -n 's/^  \([0-9.e+]*\) ns per fluid particle.*/1e-9 * \1/p' "$dir/said")
    particles=$(sed -n 's/^  fluid *\([0-9]*\) particles.*/\1/p' "$dir/said")
    steps=$(sed -n 's/^  about \([0-9.e+]*\) steps.*/\1/p' "$dir/said")
    want=$(awk "BEGIN { print $steps * $particles * $cost / $of }")
    read -r whole got_unit < <(awk '/ on this machine when idle/ { print $1, $2 }' "$dir/said")
    [ "$got_unit" = "$unit" ] && awk -v got="$whole" -v want="$want" 'BEGIN {
        off = got / want - 1; exit !(off > -0.02 && off < 0.1) }' ||
        fail "$want $unit at $cost, not $whole $got_unit"
    awk '/ on this machine when idle/ { whole = $1 * ($2 == "s" ? 1 : $2 == "min" ? 60 : 3600) }
         /nine of ten runs take/ { sub(";", "", $10)
             low = $6 * ($7 == "s" ? 1 : $7 == "min" ? 60 : 3600)
             high = $9 * ($10 == "s" ? 1 : $10 == "min" ? 60 : 3600) }
         END { a = low / whole / 0.8 - 1; b = high / whole / 1.35 - 1; exit a * a > 1e-4 ||
             b * b > 1e-4 }' \
        "$dir/said" || fail "the band is not 0.8 to 1.35 of the time: $(cat "$dir/said")"
done
[ "$(grep -c '% of a step' "$dir/said")" -ge 3 ] || fail "no phases"
grep -q ' 0.0 % of a step  deformation' "$dir/said" && fail "phases that take nothing are listed"
explain --threads 2
says 'cost with up to 2 threads'
explain --until 1e4
says 'disk at most [0-9.]* GB'

# Of two springs, the one whose long arm limits the step.
cat >"$dir/spring.cfg" <<'END'
dp = 10 mm
end_time = 0.01
[rigid r]
shape = box 0, 0, 0.1, 0.1
density = 500
[spring soft]
body = r
to = 0.05, 0.3
stiffness = 1000
[spring far]
body = r
from = 5, 5
to = 0.05, 0.3
stiffness = 1000
END
"$sphfsi" --explain "$dir/spring.cfg" >"$dir/said" 2>/dev/null || fail "--explain of springs"
says 'the step .solid. is that of \[spring far\]'
says 'MOTION .*: \[rigid r\]  ' # which has no key `motion`

# Beams that touch after the trial: contact takes a sixth of the run.
"$sphfsi" --explain cases/beam_on_beam.cfg >"$dir/said" 2>/dev/null || fail "--explain of contact"
awk '$1 == "contact" && /% of a step/ { part = $2 } END { exit !(part > 8 && part < 25) }' \
    "$dir/said" || fail "contact is not a sixth of a step: $(grep '% of a step' "$dir/said")"

# A budget lists round spacings, each once, coarsest first, whose time is from a tenth of it to
# three times.
"${PYTHON:-python3}" -c 'import cffi, numpy' 2>/dev/null ||
    { echo "cffi or numpy is missing"; exit 77; }
budget() { "${PYTHON:-python3}" tools/budget.py "$@" >"$dir/said" 2>/dev/null || fail "budget $*"; }
budget 20s "${still[@]}"
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
    fail "budget: $(cat "$dir/said")"
# All of the round numbers between the first and the last.
awk '/^  dp / && !/own/ { print $2 }' "$dir/said" | "${PYTHON:-python3}" -c '
import sys
got = [float(word) for word in sys.stdin.read().split()]
want = [d * 10.0**p for p in range(-6, 2) for d in (1, 1.25, 2, 2.5, 4, 5, 8)]
want = sorted((w for w in want if got[-1] * 0.999 < w < got[0] * 1.001), reverse=True)
sys.exit(len(got) != len(want) or any(abs(g / w - 1) > 1e-6 for g, w in zip(got, want)))' ||
    fail "the budget leaves spacings out: $(cat "$dir/said")"
budget 1e-6s "${still[@]}"
says "no listed dp both fits"

# A lattice that is not upright is said, of the fluid as of a body.
"$sphfsi" --explain "${still[@]}" --set "numerics.lattice_angle=30 deg" >"$dir/said" 2>/dev/null
says 'fluid and walls are sampled on a lattice at 30 degrees'
[ $failures = 0 ] || exit 1
