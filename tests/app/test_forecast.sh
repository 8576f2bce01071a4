#!/usr/bin/env bash
# The forecast: its steps against those of the run, and what tools/budget.py makes of it.
set -u
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
fail() { echo "$1"; exit 1; }
export OMP_NUM_THREADS=1
still=(cases/still_water.cfg --set "dp=20 mm" --set "wall=60 mm" --until 0.5)
explain() { "$SPHFSI" --explain "${still[@]}" 2>/dev/null; }

explain | grep -q 'cost with 1 thread, measured in 0.3 s of trial steps' || fail "no measurement"
explain | grep -q 'nine of ten runs take .* s to .* s;' || fail "no band of the time"
explain | grep -q 'without the time that \[relax\] needs' &&
    fail "time of a search for rest that is not asked for"
"$SPHFSI" --explain "${still[@]}" --set relax.tolerance=0.02 2>/dev/null |
    grep -q 'without the time that \[relax\] needs' ||
        fail "the search for rest is counted in silence"
# Water without a floor leaves the domain within the trial steps; a run of 5 s has some thousands.
"$SPHFSI" --explain "${still[@]}" --until 5 --set tank.shape='box -0.1, -0.1, 0, 0.4' \
    >"$work/said" 2>/dev/null
grep -Eq 'about [0-9.e+]+ steps of 0?\.?[0-9.e-]*[1-9]' "$work/said" ||
    fail "$(grep steps "$work/said")"
# Steps: 10 % for a flow, exact but for a step a row for a lone solid.
steps_of() { sed -n 's/^ *about \([0-9.e+]*\) steps of [0-9].*/\1/p' | awk '{printf "%.0f", $1}'; }
near() { awk -v a="$1" -v b="$2" -v e="$3" 'BEGIN { exit !(a > b*(1-e) && a < b*(1+e)) }'; }
want=$(explain | steps_of)
"$SPHFSI" "${still[@]}" --quiet --out "$work/still" 2>/dev/null || fail "still water failed"
got=$(sed -n 's/^  "steps": \([0-9]*\),/\1/p' "$work/still/summary.json")
near "$want" "$got" 0.1 || fail "still water: $want steps foreseen, $got taken"
plate=(cases/cantilever.cfg --set ratio=6 --until 0.05)
want=$("$SPHFSI" --explain "${plate[@]}" 2>/dev/null | steps_of)
"$SPHFSI" "${plate[@]}" --quiet --out "$work/plate" 2>/dev/null || fail "the cantilever failed"
got=$(sed -n 's/^  "steps": \([0-9]*\),/\1/p' "$work/plate/summary.json")
near "$want" "$got" 0.01 || fail "cantilever: $want steps foreseen, $got taken"

# Bodies that touch after the trial: steps in contact are shorter, and a coarse run has seen it.
touch=(cases/beam_on_beam.cfg --until 0.6)
"$SPHFSI" --explain "${touch[@]}" >"$work/touch" 2>/dev/null
grep -q 'trial steps and a run at dp = ' "$work/touch" || fail "no coarse run: $(cat "$work/touch")"
"$SPHFSI" "${touch[@]}" --quiet --out "$work/beams" 2>/dev/null || fail "the beams failed"
got=$(sed -n 's/^  "steps": \([0-9]*\),/\1/p' "$work/beams/summary.json")
near "$(steps_of <"$work/touch")" "$got" 0.07 ||
    fail "beams: $(steps_of <"$work/touch") steps foreseen, $got taken"

# An implicit step of a solid is one step, however many sub-steps it takes the place of.
stiff=(cases/hydrostatic_plate.cfg --set "dp=25 mm" --until 0.01 --explain)
"$SPHFSI" "${stiff[@]}" 2>/dev/null >"$work/stiff"
grep -q 'sub-steps alone: ' "$work/stiff" || fail "the plate takes no implicit steps"
grep -q 'about .* solid sub-steps' "$work/stiff" && fail "$(grep 'solid sub-steps' "$work/stiff")"

# A budget: the finest spacing within it, costs that grow as dp shrinks, and what is no time.
budget() { "${PYTHON:-python3}" tools/budget.py "$@"; }
"${PYTHON:-python3}" -c 'import cffi, numpy' 2>/dev/null ||
    { echo "cffi or numpy is missing"; exit 77; }
budget 20s cases/still_water.cfg --set "wall=80 mm" >"$work/budget" 2>/dev/null || fail "no budget"
grep -q '^finest dp within the budget: --set dp=0\.0' "$work/budget" || fail "$(cat "$work/budget")"
awk '/^  dp .* (fits|too long|bodies)/ { if (n++ && $8 < last) exit 1; last = $8 }' \
    "$work/budget" ||
    fail "costs do not grow: $(cat "$work/budget")"
# A probe with rows closer than steps: no row ends a step.
probe=(cases/templates/dam_break.cfg --until 0.05)
want=$("$SPHFSI" --explain "${probe[@]}" 2>/dev/null | steps_of)
"$SPHFSI" "${probe[@]}" --quiet --out "$work/probe" 2>/dev/null || fail "the dam break failed"
got=$(sed -n "s/^  \"steps\": \([0-9]*\),/\1/p" "$work/probe/summary.json")
near "$want" "$got" 0.1 || fail "probe with an interval: $want steps foreseen, $got taken"

for bad in 10 0s 5days ""; do
    budget "$bad" cases/still_water.cfg 2>"$work/error" && fail "a budget of '$bad' was accepted"
    grep -q 'a time such as' "$work/error" || fail "$(cat "$work/error")"
done

# Presets: a key of the case wins, and the standard is the default.
value() { "$SPHFSI" --effective cases/still_water.cfg --set integrator=leapfrog "$@" |
    sed -n "s/^$key = //p"; }
key=cfl
[ "$(value)" = "$(value --set accuracy=standard)" ] || fail "standard is not the default"
[ "$(value --set accuracy=draft)" != "$(value)" ] || fail "draft changes nothing"
[ "$(value --set accuracy=draft --set numerics.cfl=0.3)" = 0.3 ] || fail "a preset overrides a key"
[ "$(value --set accuracy=draft --set integrator=verlet)" = "$(value --set integrator=verlet)" ] ||
    fail "a step for leapfrog is given to verlet"
"$SPHFSI" "${still[@]}" --until 0.01 --set accuracy=draft --out "$work/draft" >"$work/said" 2>&1 ||
    fail "$(cat "$work/said")"
grep -q '^expected error at accuracy = draft' "$work/said" ||
    fail "a run with a preset does not say what error to expect: $(cat "$work/said")"
grep -Eq '^  water: [0-9]+ particles high: error (unknown|of at most)' "$work/said" ||
    fail "without evidence: $(cat "$work/said")"
"$SPHFSI" --explain cases/gate.cfg 2>&1 |
    grep -q '^expected error with scheme = paper, at accuracy' ||
    fail "no word of the scheme that the error is of"
"$SPHFSI" --explain cases/templates/baffle.cfg >"$work/said" 2>&1
grep -q '^  baffle: 4 particles across: error of at most [0-9.]* % in [0-9]* of 100 cases' \
    "$work/said" ||
    fail "no word of the body's error: $(cat "$work/said")"
grep -q 'Dam break and elastic gate\|warning.*interval' "$work/said" &&
    fail "rows of other cases, or a false warning"
"$SPHFSI" --explain tests/stability/wedge.cfg 2>&1 |
    grep -q '^  wedge: .* error unknown: ' ||
    fail "an error of the tip of a body that moves freely"
"$SPHFSI" --explain cases/templates/baffle.cfg \
    --set baffle.damping_time=0.01 --set numerics.fixed_step=1e-6 >"$work/said" 2>&1
for key in 'damping_time = 0.01' 'fixed_step limits'; do
    grep -q "^warning: --set: .*$key" "$work/said" ||
        fail "no warning of $key: $(grep warning "$work/said")"
done
"$SPHFSI" --effective cases/cantilever.cfg --set accuracy=fine | grep -q '^h_over_dp = 1.8' ||
    fail "fine is not what presets.c says"
"$SPHFSI" --effective cases/still_water.cfg --set accuracy=fast >/dev/null 2>"$work/error" &&
    fail "accuracy=fast"
grep -q 'draft|standard|fine' "$work/error" || fail "$(cat "$work/error")"
exit 0
