#!/usr/bin/env bash
# Three resolutions: the runs, their resumption, and what does not fit.
. tests/support/shell.sh
refine=("${PYTHON:-python3}" tools/refine.py)
"${PYTHON:-python3}" -c 'import cffi, numpy' 2>/dev/null ||
    { echo "cffi or numpy is missing"; exit 77; }
run() {
    "${refine[@]}" -n 3 --ratio 2 --without kernel,sound,step,repeats "$@" --threads 1 --quiet
}
case=(cases/cantilever.cfg --set ratio=8 --until 0.02 --out "$dir/r")

# Stopped in the middle: the second folder has begun, the third has not.
run "${case[@]}" 2>"$dir/error" >"$dir/table" || fail "first run: $(cat "$dir/error")"
grep -q '^M1_dy_m' "$dir/table" && ! grep -q '^run 1' "$dir/table" ||
    fail "--quiet: the table and nothing else, not $(cat "$dir/table")"
[ "$(find "$dir/r" -name summary.json | wc -l)" = 3 ] || fail "there are not three runs"
grep -q '"M1_dy_m"' "$dir/r/refine.json" || fail "refine.json has no probe"
whole=$(cat "$dir/r/refine.json")
grep -A4 '"references": {' "$dir/r/dp-0.01/summary.json" | grep -q '"points": [1-9]' ||
    fail "a run is not compared with its references"
fine=$dir/r/dp-0.0025 middle=$dir/r/dp-0.005
[ -d "$fine" ] && [ -d "$middle" ] || fail "folders are not named after dp: $(ls "$dir/r")"

# Killed before the first checkpoint (no summary), the finest not begun: both are made up for, the
# finished one is not touched.
rm -r "$fine" "$middle"/*.ckpt "$middle/summary.json" "$dir/r/refine.json"
before=$(cat "$dir/r/dp-0.01/summary.json")
run "${case[@]}" 2>"$dir/error" || fail "resumed: $(cat "$dir/error")"
[ "$(cat "$dir/r/refine.json")" = "$whole" ] || fail "other values after a resumption"
[ "$(cat "$dir/r/dp-0.01/summary.json")" = "$before" ] || fail "a finished run was touched"

# Killed between the first checkpoint and the first summary: it goes on and deletes nothing.
mkdir "$dir/kept" && cp "$middle/case.cfg" "$middle"/*.ckpt "$dir/kept"
rm "$middle/summary.json" "$dir/r/refine.json"
run "${case[@]}" 2>"$dir/error" || fail "resumed without a summary: $(cat "$dir/error")"
[ "$(cat "$dir/r/refine.json")" = "$whole" ] || fail "other values after going on without a summary"
for file in "$dir"/kept/*.ckpt; do
    cmp "$file" "$middle/$(basename "$file")" || fail "a checkpoint was deleted or written anew"
done

# The plan comes with its price, runs nothing, and knows what is finished. By itself it takes the
# largest ratio at which the bodies fit.
"${refine[@]}" "${case[@]}" --threads 1 --plan >"$dir/plan" 2>"$dir/error" ||
    fail "plan: $(cat "$dir/error")"
[ "$(grep -c finished "$dir/plan")" = 3 ] && [ "$(grep -c 'step .* s$' "$dir/plan")" = 2 ] &&
    grep -q 'in all .* s on this machine' "$dir/plan" || fail "plan: $(cat "$dir/plan")"
[ ! -e "$dir/r/step-0.5" ] || fail "the plan was run"
"${refine[@]}" cases/still_water.cfg --set dp=20mm --plan >"$dir/plan" 2>/dev/null
[ "$(grep -c 'spacing\|kernel\|sound\|step\|repeats' "$dir/plan")" = 12 ] &&
    grep -q 'dp 0.045 ' "$dir/plan" || fail "plan with water: $(cat "$dir/plan")"
"${refine[@]}" "${case[@]}" --without spacing 2>"$dir/error"
[ $? = 1 ] && grep -q 'there are kernel, sound, step, repeats' "$dir/error" ||
    fail "$(cat "$dir/error")"

# Water, too: kernels, sound, steps and repeats are run and reported.
"${refine[@]}" cases/still_water.cfg --set dp=20mm --set wall=80mm --until 0.1 --threads 1 \
    --quiet --out "$dir/water" >"$dir/table" 2>"$dir/error" || fail "water: $(cat "$dir/error")"
[ "$(find "$dir/water" -name summary.json | wc -l)" = 12 ] || fail "there are not twelve runs"
grep -q '"sound": {' "$dir/water/refine.json" || fail "no order in the speed of sound"

# Other physics in the same folder is refused.
run "${case[@]}" --set plate.young=1MPa 2>"$dir/error"
[ $? = 1 ] || fail "another case in the folder was accepted"
grep -q young "$dir/error" || fail "the message does not name what differs: $(cat "$dir/error")"

# A resolution in which a body vanishes is named before anything runs.
run cases/cantilever.cfg --set ratio=2 --ratio 4 --out "$dir/none" 2>"$dir/error"
[ $? = 1 ] || fail "a body without particles was accepted"
grep -q 'refine: at dp = 0.16 m, 16 times the case.s: .*use a smaller --ratio' "$dir/error" ||
    fail "$(cat "$dir/error")"
[ ! -e "$dir/none" ] || fail "something was run all the same"

# Probes with a rate of their own; without any the energies are left.
sed 's/^\[probe M1\]/&\ninterval = 5 ms/' cases/cantilever.cfg >"$dir/own.cfg"
sed '/^\[probe/,$d' cases/cantilever.cfg >"$dir/none.cfg"
cp -r cases/reference "$dir"
value='/"M1_dy_m"/,/}/s/.*"values": \[\([^,]*\),.*/\1/p'
run "$dir/own.cfg" --set ratio=8 --until 0.02 --out "$dir/own" \
    2>"$dir/error" || fail "own rate: $(cat "$dir/error")"
[ "$(sed -n "$value" "$dir/own/refine.json")" = "$(sed -n "$value" <<<"$whole")" ] ||
    fail "a probe with its own rate has another final value"
run "$dir/none.cfg" --set ratio=8 --until 0.02 --out "$dir/bare" 2>"$dir/error" ||
    fail "without probes: $(cat "$dir/error")"
grep -q '"ledger"' "$dir/bare/refine.json" || fail "no energies"
grep -q '"why_no_order": "[^"]' "$dir/bare/refine.json" ||
    fail "it does not say why there is no order"

# Two resolutions, a restart.
for n in 2 7; do
    "${refine[@]}" -n $n cases/gate.cfg 2>"$dir/error"
    [ $? = 1 ] || fail "$n resolutions were accepted"
    grep -q 'from 3 to 6' "$dir/error" || fail "$(cat "$dir/error")"
done
for ratio in 9 x 1 1.05 4.5; do
    "${refine[@]}" --ratio "$ratio" cases/gate.cfg 2>"$dir/error"
    [ $? = 1 ] || fail "--ratio $ratio was accepted"
    grep -q 'give a number from 1.1 to 4' "$dir/error" || fail "$(cat "$dir/error")"
done
# Nothing is made of a case that cannot be read.
printf 'dp = 1 cm\nend_time = 1\n[solid a]\nyuong = 1\n' >"$dir/wrong.cfg"
"${refine[@]}" "$dir/wrong.cfg" --out "$dir/refined" 2>"$dir/error"
[ $? = 1 ] || fail "a wrong case was accepted"
grep -q yuong "$dir/error" || fail "$(cat "$dir/error")"
grep -q -- --ratio "$dir/error" && fail "the ratio is blamed: $(cat "$dir/error")"
[ ! -e "$dir/refined" ] || fail "something was made of a wrong case"
# The program names the tools that its old options have become.
for option in --refine --ratio=2 --budget; do
    "$sphfsi" $option 3 cases/gate.cfg 2>"$dir/error"
    [ $? = 1 ] && [ "$(wc -l <"$dir/error")" = 1 ] &&
        grep -q 'is a tool now: tools/' "$dir/error" ||
        fail "$option: $(cat "$dir/error")"
done
run "${case[@]}" --restart 2>"$dir/error" && fail "a restart was accepted"
exit $((failures != 0))
