#!/usr/bin/env bash
# Three resolutions: the runs, their resumption, and what does not fit.
set -u
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
fail() { echo "$1"; exit 1; }
run() { "$SPHFSI" --refine 3 "$@" --threads 1 --quiet; }
case=(cases/cantilever.cfg --set ratio=8 --until 0.02 --out "$work/r")

# Stopped in the middle: the second folder has begun, the third has not.
run "${case[@]}" 2>"$work/error" || fail "first run: $(cat "$work/error")"
[ "$(find "$work/r" -name summary.json | wc -l)" = 3 ] || fail "there are not three runs"
grep -q '"M1_dy_m"' "$work/r/refine.json" || fail "refine.json has no probe"
whole=$(cat "$work/r/refine.json")
fine=$work/r/dp-0.0025 middle=$work/r/dp-0.005
[ -d "$fine" ] && [ -d "$middle" ] || fail "folders are not named after dp: $(ls "$work/r")"

# Killed before the first checkpoint (no summary), the finest not begun: both are made up for, the
# finished one is not touched.
rm -r "$fine" "$middle"/*.ckpt "$middle/summary.json" "$work/r/refine.json"
before=$(cat "$work/r/dp-0.01/summary.json")
run "${case[@]}" 2>"$work/error" || fail "resumed: $(cat "$work/error")"
[ "$(cat "$work/r/refine.json")" = "$whole" ] || fail "other values after a resumption"
[ "$(cat "$work/r/dp-0.01/summary.json")" = "$before" ] || fail "a finished run was touched"

# Other physics in the same folder is refused.
run "${case[@]}" --set plate.young=1MPa 2>"$work/error"
[ $? = 1 ] || fail "another case in the folder was accepted"
grep -q young "$work/error" || fail "the message does not name what differs: $(cat "$work/error")"

# A resolution in which a body vanishes is named before anything runs.
run cases/cantilever.cfg --set ratio=2 --ratio 4 --out "$work/none" 2>"$work/error"
[ $? = 1 ] || fail "a body without particles was accepted"
grep -q 'refine: at dp = ' "$work/error" || fail "$(cat "$work/error")"
[ ! -e "$work/none" ] || fail "something was run all the same"

# Probes with a rate of their own; without any the energies are left.
sed 's/^\[probe M1\]/&\ninterval = 5 ms/' cases/cantilever.cfg >"$work/own.cfg"
sed '/^\[probe/,$d' cases/cantilever.cfg >"$work/none.cfg"
cp -r cases/reference "$work"
value='/"M1_dy_m"/,/}/s/.*"values": \[\([^,]*\),.*/\1/p'
run "$work/own.cfg" --set ratio=8 --until 0.02 --out "$work/own" \
    2>"$work/error" || fail "own rate: $(cat "$work/error")"
[ "$(sed -n "$value" "$work/own/refine.json")" = "$(sed -n "$value" <<<"$whole")" ] ||
    fail "a probe with its own rate has another final value"
run "$work/none.cfg" --set ratio=8 --until 0.02 --out "$work/bare" 2>"$work/error" ||
    fail "without probes: $(cat "$work/error")"
grep -q '"ledger"' "$work/bare/refine.json" || fail "no energies"
grep -q '"why_no_order": "' "$work/bare/refine.json" || fail "it does not say why there is no order"

# Two resolutions, a restart.
"$SPHFSI" --refine 2 cases/gate.cfg 2>"$work/error" && fail "two resolutions were accepted"
grep -q 'from 3 to 6' "$work/error" || fail "$(cat "$work/error")"
run "${case[@]}" --restart 2>"$work/error" && fail "a restart was accepted"
exit 0
