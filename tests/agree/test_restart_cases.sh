#!/usr/bin/env bash
# Every shipped case, made coarse and short: cut in the middle and continued, it ends with the bits
# and rows of the run that was not cut; by both integrators, and Verlet at a single rate as well;
# with implicit steps of the solid by all three.
. tests/support/shell.sh

run() { "$sphfsi" "$@" --quiet >"$dir/output" 2>&1 || fail "$*"; }

# CASE END SETTINGS...: ends at END s; snapshots, rows and the cut are on a grid of END/8.
short() {
    local name=$1 end=$2 integrator multirate cut threads
    shift 2
    local eighth set=()
    eighth=$(awk "BEGIN { printf \"%.12g\", $end / 8 }")
    cut=$(awk "BEGIN { printf \"%.12g\", $end / 8 * 3 }")
    for integrator in ${integrators:-symplectic verlet}; do
        for multirate in ${multirates:-auto off}; do
            [ $multirate = auto ] || [ $integrator = verlet ] || continue
            set=(--set integrator=$integrator --set numerics.multirate=$multirate
                --set end_time="$end" --set output.probe_interval="$eighth"
                --set output.ledger_interval="$eighth" --set output.snapshot_interval="$end")
            for value in "$@"; do set+=(--set "$value"); done
            # Once on two threads; test_restart.sh says more of them.
            threads=1
            [ "$name $integrator" != "still_water symplectic" ] || threads=2
            rm -rf "$dir/whole" "$dir/cut"
            run "cases/$name.cfg" "${set[@]}" --out "$dir/whole" --threads 1
            run "cases/$name.cfg" "${set[@]}" --out "$dir/cut" --threads $threads --until "$cut"
            run "cases/$name.cfg" "${set[@]}" --out "$dir/cut" --threads 1 --restart
            local what="$name, $integrator, multirate $multirate"
            [ -n "$(hash "$dir/whole")" ] && [ "$(hash "$dir/whole")" = "$(hash "$dir/cut")" ] ||
                fail "$what: the states differ"
            cmp "$dir/whole/ledger.csv" "$dir/cut/ledger.csv" || fail "$what: ledger.csv"
            [ ! -e "$dir/whole/probes.csv" ] || cmp "$dir/whole/probes.csv" "$dir/cut/probes.csv" ||
                fail "$what: probes.csv"
            steps=$(sed -n 's/^  "steps": \([0-9]*\).*/\1/p' "$dir/whole/summary.json")
            [ "${steps:-0}" -ge 16 ] || fail "$what: only ${steps:-0} steps"
            done=$((done + 1))
        done
    done
}

done=0
short cantilever 1e-3 ratio=4
short gate 0.005 "dp=2.5 mm" gate_thickness=10mm wall=10mm held=10mm gate_length=80mm W=0.1m \
    H=0.14m \
    top=0.16m
short gate 0.005 "dp=2.5 mm" gate_thickness=10mm wall=10mm held=10mm W=0.1m H=0.14m \
    gate.density=110 \
    top=0.16m
short hydrostatic_plate 0.004 "dp=25 mm"
implicit=numerics.solid_steps=implicit
multirates=auto integrators="symplectic verlet leapfrog" short hydrostatic_plate 0.006 \
    "dp=25 mm" $implicit
multirates=auto integrators="symplectic verlet" short cantilever 0.08 ratio=4 plate.law=svk \
    $implicit
short wet_baffle 0.002 "dp=2 mm"
short sluice_gate 0.005 "dp=4 mm"
short two_posts 0.005 "dp=10 mm" "wall=30 mm" "held=20 mm"
short beam_on_beam 0.02 "across=4" "press=10 ms"
short ringing_bar 1e-3 ratio=4
short rotating_patch 0.02 "dp=L/20"
short accelerated_tank 0.02 "dp=20 mm"
short still_water 0.01 "dp=20 mm" wall=60mm
short hinged_flap 0.005 "dp=10 mm"
integrators=symplectic short channel 0.05 "dp=0.1 mm" length=1mm
integrators=symplectic short rolling_tank 0.01
integrators=symplectic short elastic_valve 0.01 "dp=4 mm"
integrators=symplectic short vortices 0.04 "dp=L/20"
integrators="symplectic leapfrog" short turek_hron/fsi2 0.03 across=10 length=0.8 ramp=10ms
ls cases/*.cfg | sed 's|.*/||; s|\.cfg$||' | while read -r name; do
    grep -q "^\(integrators=[a-z]* \)*short $name " "$0" || echo "$name"
done >"$dir/output"
[ ! -s "$dir/output" ] || fail "cases that are not tested here"
echo "found: $done forms of the shipped cases cut and continued, $failures differences"
[ $failures = 0 ] || exit 1
