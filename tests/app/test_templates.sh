#!/usr/bin/env bash
# The templates have nothing to warn of when they start. The one with a lifted plate and the one
# with a splash (at half its size) run to their end without a warning, and no water is lost. So
# does one with waves for 2 s, at twice its speed of sound: there dummies hold less energy, and a
# gain shows (T-46).
set -u
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
export OMP_NUM_THREADS=1
failed=0

for name in $("$SPHFSI" --new); do
    "$SPHFSI" --new "$name" >"$work/$name.cfg" || failed=1
    "$SPHFSI" --explain "$work/$name.cfg" >"$work/log" 2>&1 || failed=1
    grep -i warning "$work/log" && failed=1
done

run() {
    local name=$1
    shift
    if ! "$SPHFSI" "$work/$name.cfg" --out "$work/$name" "$@" --quiet >"$work/log" 2>&1; then
        cat "$work/log"
        failed=1
    fi
    grep -i warning "$work/log" && failed=1
    grep -q '"fluid_left_domain": 0,' "$work/$name/summary.json" || failed=1
}
run baffle
run dam_break --set H='0.15 m' --set W='0.1 m' --set length='0.4 m'
run flap --set 'fluid water.sound_speed=50 m/s' --until '2 s'
exit $failed
