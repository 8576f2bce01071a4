#!/usr/bin/env bash
# What is wrong with a case names its file, also where it is found after the case was read.
. tests/support/shell.sh
case=$dir/q.cfg
body='dp = 1 cm
end_time = 0.01
[solid a]
shape = box 0, 0, 0.1, 0.1
young = 1e6
poisson = 0.3
density = 1000'
probe='[probe z]
quantity = displacement
body = a
point = 0.05, 0.05'

# says STATUS WORDS TEXT [OPTION]: the run ends so, and a line begins with the place and these
# words.
says() {
    echo "$3" >"$case"
    "$sphfsi" ${4:+"$4"} "$case" --quiet --threads 1 --out "$dir/run" >"$dir/output" 2>&1
    local got=$?
    rm -rf "$dir/run"
    [ $got = "$1" ] || fail "$2: exit status $got instead of $1"
    grep -q "^\(sphfsi\|warning\): $case$2" "$dir/output" || fail "does not say '$2'"
}

says 1 ':11: \[solid far\] is joined to \[solid a\], but lies more than' "$body
[solid far]
like = a
shape = box 1, 0, 1.1, 0.1
joined = a"
says 1 ':8: \[load l\] contains no particle' "$body
[load l]
body = a
shape = box 3, 3, 4, 4
force = 1, 1"
says 0 ':3: \[solid a\] hourglass_form = printed' "$body
hourglass_form = printed"
says 1 ':9: probe_interval = 1e-15 s gives' "$body
[output]
probe_interval = 1e-15
$probe"
says 1 ':12: interval = 1e-14 s gives' "$body
$probe
interval = 1e-14"
says 1 ': \[domain\] is periodic in x and only 0.04 m wide' 'dp = 1 cm
end_time = 1
[fluid w]
shape = box 0, 0, 0.04, 0.1
sound_speed = 20
[domain]
lower = 0, 0
upper = 0.04, 0.1
periodic = xy'
exit $((failures > 0))
