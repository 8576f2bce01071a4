#!/usr/bin/env bash
# What a checkpoint says of itself, runs that fork from one, and what is refused by name.
. tests/support/shell.sh
case=tests/fault/tiny.cfg

run=$dir/run
expect 0 'simulated' "$case" --threads 1 --out "$run"
ckpt=$(ls "$run"/*.ckpt)

# --- inspect ---
expect 0 'a valid checkpoint' --inspect "$ckpt"
for words in 'time 0.02[0-9]* s, 75 steps' 'fluid *100 particles' 'dp = 0.01 m'; do
    grep -q -- "$words" "$dir/output" || fail "--inspect does not say '$words'"
done
expect 0 'step-0*75.ckpt: a valid checkpoint' --inspect "$run"
mkdir "$dir/empty"
expect 1 'contains no checkpoint' --inspect "$dir/empty"
expect 1 'not a valid checkpoint' --inspect "$case"
expect 1 'nowhere.ckpt' --inspect "$dir/nowhere.ckpt"
expect 1 'needs a value' --inspect

# --- other formats, byte orders, versions: put at their place in the header ---
patched() {
    cp "$ckpt" "$dir/patched.ckpt"
    printf "$2" | dd of="$dir/patched.ckpt" bs=1 seek="$1" conv=notrunc status=none
}
patched 8 '\x02\0\0\0'
expect 1 'has format 2, but this program reads format 14' --inspect "$dir/patched.ckpt"
expect 1 "has format 2" "$case" --out "$run" --restart "$dir/patched.ckpt"
patched 8 '\0\0\0\0'
expect 1 'has format 0' --inspect "$dir/patched.ckpt"
patched 8 '\0\0\0\x01\x01\x02\x03\x04'
expect 1 'byte-order mark is wrong' --inspect "$dir/patched.ckpt"
expect 1 'byte-order mark is wrong' "$case" --out "$run" --restart "$dir/patched.ckpt"
expect 1 "'dp = 0.01 m' is now 'dp = 0.005 m'" "$case" --out "$run" --restart \
    --set dp=5mm
expect 1 'has changed.*integrator' "$case" --out "$run" --restart --set integrator=verlet

# --- a refused fork leaves nothing, and removes nothing that was there ---
mkdir "$dir/mine"
for out in deep/refused/ mine/refused mine; do
    expect 1 'byte-order' "$case" --fork "$dir/patched.ckpt" --out "$dir/$out"
done
[ ! -e "$dir/deep" ] || fail "a refused fork leaves a folder"
[ "$(ls -A "$dir/mine")" = '' ] || fail "a refused fork leaves files"
[ -d "$dir/mine" ] || fail "a refused fork removes a folder that was there"

# --- fork: another material ---
go=(--threads 1 --until 0.03)
expect 0 "fork from $ckpt" "$case" --fork "$ckpt" --out "$dir/stiff" "${go[@]}" --set gate.young=4e6
grep -q "\"forked_from\": \"$ckpt\"" "$dir/stiff/summary.json" || fail "summary: no forked_from"
grep -q '"start_time": 0.02' "$dir/stiff/summary.json" || fail "summary: start_time"
# Rows of the start and of each 0.1 ms.
begin=$(sed -n 's/^  "time": \(.*\),/\1/p' "$run/summary.json")
awk -F, -v t="$begin" 'NR == 2 { exit !($1 == t) }' "$dir/stiff/probes.csv" ||
    fail "the first row of the fork is not of its start, $begin s"
[ "$(wc -l <"$dir/stiff/probes.csv")" = 100 ] || fail "rows of the fork's probes.csv"
# Gradients of the density that the run did not have.
expect 0 "fork from $ckpt" "$case" --fork "$ckpt" --out "$dir/slopes" "${go[@]}" \
    --set water.diffusion_form=antuono
# Places of friction that the run did not have.
(cat "$case"; printf '[contact smooth]\nfriction = 0\n') >"$dir/smooth.cfg"
expect 0 'simulated' "$dir/smooth.cfg" --threads 1 --until 0.01 --out "$dir/smooth"
expect 0 'fork from' "$dir/smooth.cfg" --fork "$dir/smooth" --out "$dir/rough" --threads 1 --until \
    0.011 \
    --set smooth.friction=0.1
# A fork that changes nothing but where it begins goes the same way, by the folder's newest one.
expect 0 'simulated' "$case" --threads 1 --until 0.03 --out "$dir/whole"
expect 0 'fork from' "$case" --fork "$run" --out "$dir/same" "${go[@]}"
tail -n 1 "$dir/whole/probes.csv" "$dir/same/probes.csv" "$dir/stiff/probes.csv" |
    awk -F, '/^0/ { x[n++] = $2 }
             END { a = x[1] / x[0] - 1; b = x[2] / x[0] - 1
                   exit !(a * a < 1e-12 && b * b > 1e-4) }' ||
    fail "the fork with the same physics went another way, or the stiffer one did not"
# It is a run like another: a restart in it changes no bit.
expect 0 'simulated' "$case" --fork "$ckpt" --out "$dir/cut" --threads 1 --until 0.025 \
    --set gate.young=4e6
expect 0 'restart from' "$case" --out "$dir/cut" --restart "${go[@]}" --set gate.young=4e6
[ "$(hash "$dir/cut")" = "$(hash "$dir/stiff")" ] || fail "a restart in a fork changes bits"

# --- fork: the interface impulse is cleared where no sub-steps are taken, and the ledger books it
# ---
cat >"$dir/free.cfg" <<'CASE'
dp = 1 cm
end_time = 0.1
[fluid water]
shape = box 0, 0, 0.24, 0.24
minus = box 0.1, 0.1, 0.14, 0.14
sound_speed = 20
artificial_viscosity = 0.1
density_diffusion = 0.1
[solid block]
shape = box 0.1, 0.1, 0.14, 0.14
density = 100
young = 1e6
poisson = 0.3
velocity = 0.2, 0.1
[domain]
lower = -0.2, -0.2
upper = 0.5, 0.5
CASE
momentum() { # the first of the ledger's rows: of fluid and structure less the interface impulse
    awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) if ($k == "momentum_x_Ns_per_m") at = k }
             NR == 2 { print $at }' "$dir/$1/ledger.csv"
}
expect 0 'simulated' "$dir/free.cfg" --threads 1 --until 0.02 --out "$dir/free"
expect 0 'fork from' "$dir/free.cfg" --fork "$dir/free" --threads 1 --until 0.021 --out \
    "$dir/soft" \
    --set block.young=1e4
expect 0 'fork from' "$dir/free.cfg" --fork "$dir/free" --threads 1 --until 0.021 --out \
    "$dir/single" \
    --set block.young=1e4 --set numerics.multirate=off
expect 0 'fork from' "$dir/free.cfg" --fork "$dir/free" --threads 1 --until 0.021 --out \
    "$dir/impulse"
expect 0 'fork from' "$dir/free.cfg" --fork "$dir/free" --threads 1 --until 0.0205 --out \
    "$dir/short" \
    --set numerics.multirate=on --set numerics.fixed_step=2e-5
expect 0 'fork from' "$dir/free.cfg" --fork "$dir/free" --threads 1 --until 0.0205 --out \
    "$dir/implicit" --set numerics.solid_steps=implicit
expect 0 'fork from' "$dir/free.cfg" --fork "$dir/implicit" --threads 1 --until 0.021 --out \
    "$dir/explicit"
[ -n "$(momentum single)" ] || fail "no momentum in the ledger"
[ "$(momentum implicit)" = "$(momentum impulse)" ] || fail "implicit steps drop the impulse"
[ "$(momentum soft)" = "$(momentum single)" ] || fail "an interface impulse stays"
[ "$(momentum short)" = "$(momentum impulse)" ] || fail "shorter steps drop the interface impulse"
[ "$(momentum impulse)" != "$(momentum single)" ] || fail "no interface impulse, nothing tested"

# --- fork: a wall that begins to move; one that would jump ---
cp "$case" "$dir/moving.cfg"
sed -i 's/^\[solid gate\]/motion = push\n\n[motion push]\nx = 0.1*t\nstart = 21 ms\n\n&/' \
    "$dir/moving.cfg"
expect 0 'fork from' "$dir/moving.cfg" --fork "$ckpt" --out "$dir/moving" "${go[@]}"
expect 1 'particle of .wall .*would jump' "$dir/moving.cfg" --fork "$ckpt" --out "$dir/jump" \
    "${go[@]}" \
    --set push.start=0

# --- fork: a tank that turns goes on where it is; one that would turn by a jump is refused ---
roll=(cases/rolling_tank.cfg --threads 1 --set dp=depth/8 --set 'roll_period=0.1 s')
expect 0 'simulated' "${roll[@]}" --until 0.02 --out "$dir/roll"
expect 0 'fork from' "${roll[@]}" --until 0.022 --fork "$dir/roll" --out "$dir/rolls"
expect 1 'particle of .wall tank. would jump' "${roll[@]}" --until 0.022 --fork "$dir/roll" \
    --out "$dir/turns" --set 'roll=4*pi/180 + 0.1'
expect 1 'particle of .wall tank. would jump' "${roll[@]}" --until 0.022 --fork "$dir/roll" \
    --out "$dir/starts" --set 'roll.start=0.02 s'

# --- fork: a clamp that stops holds where it stands, on any number of threads; one that would jump
# ---
cat >"$dir/still.cfg" <<'CASE'
dp = 1 cm
end_time = 4 ms
[solid bar]
shape = box 0, 0, 1.5, 0.08
clamp = box 0, 0, 0.1, 0.08
density = 1100
young = 2e6
poisson = 0.4
[output]
probe_interval = 1 ms
[probe base]
body = bar
point = 0.05, 0.04
CASE
sed 's/^density/clamp_motion = lift\n&/; $a [motion lift]\ny = t' "$dir/still.cfg" \
    >"$dir/lifted.cfg"
expect 0 'simulated' "$dir/lifted.cfg" --threads 1 --until 0.002 --out "$dir/lifted"
for n in 1 2; do
    expect 0 'fork from' "$dir/still.cfg" --fork "$dir/lifted" --threads $n --out "$dir/still$n"
done
[ "$(hash "$dir/still1")" = "$(hash "$dir/still2")" ] || fail "a fork's bits depend on threads"
[ "$(sed -n 2p "$dir/still1/probes.csv" | cut -d, -f2-)" = \
    "$(tail -n 1 "$dir/still1/probes.csv" | cut -d, -f2-)" ] || fail "the clamp lets go in a fork"
expect 0 'fork from' "$dir/lifted.cfg" --fork "$dir/lifted" --threads 2 --out "$dir/on"
expect 1 'clamp of .solid bar. would jump' "$dir/lifted.cfg" \
    --fork "$dir/lifted" --out "$dir/none" --set 'lift.y=2*t'

# --- fork: what the state is made of may not change ---
for set in dp=5mm integrator=verlet water.sound_speed=30 gate.density=1200 numerics.h_over_dp=1.4 \
    'tank.shape=box -0.05, 0, 0, 0.15'; do
    expect 1 'fork: the' "$case" --fork "$ckpt" --out "$dir/none" --set "$set"
done
expect 1 'choose one' "$case" --fork "$ckpt" --restart --out "$run"
expect 1 'not overwritten' "$case" --fork "$ckpt" --out "$run"
expect 1 'nowhere.ckpt' "$case" --fork "$dir/nowhere.ckpt" --out "$dir/none"

[ $failures = 0 ] || exit 1
