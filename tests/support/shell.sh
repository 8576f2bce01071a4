# What tests in shell begin with: the program, a folder that goes when they end, how they fail.
set -u
sphfsi=$(realpath "${SPHFSI:-./sphfsi}")
# In memory where that is possible: hundreds of synced files say nothing here.
dir=$(realpath "$(mktemp -d -p /dev/shm 2>/dev/null || mktemp -d)")
trap 'chmod -R u+w "$dir"; rm -rf "$dir"' EXIT
failures=0

fail() {
    echo "FAILED: $1"
    [ ! -e "$dir/output" ] || sed 's/^/    /' "$dir/output" | cut -c1-300
    failures=$((failures + 1))
}

hash() { sed -n 's/.*"state_hash": "\(.*\)".*/\1/p' "$1/summary.json"; }

# expect STATUS WORDS ARGUMENTS...: the program ends so, and says so if there are words.
expect() {
    local status=$1 words=$2
    shift 2
    timeout 60 "$sphfsi" "$@" >"$dir/output" 2>&1
    local got=$?
    [ $got = "$status" ] || fail "$*: exit status $got instead of $status"
    [ -z "$words" ] || grep -q -- "$words" "$dir/output" || fail "$*: does not say '$words'"
}

# completes ARGUMENTS...: the program ends well.
completes() { expect 0 "" "$@" --quiet; }

# restarts CASE FOLDER UNTIL ARGUMENTS...: a run that stops and goes on with another number of
# threads gives the bits and rows of one in one go, and so does its effective case.
restarts() {
    local case=$1 at=$2 until=$3
    shift 3
    completes "$case" "$@" --out "$at" --threads 1
    completes "$case" "$@" --out "$at-cut" --threads 2 --until "$until"
    completes "$case" "$@" --out "$at-cut" --restart
    completes "$at/case.cfg" --out "$at-effective"
    [ -n "$(hash "$at")" ] && [ "$(hash "$at")" = "$(hash "$at-cut")" ] || fail "$at: restart"
    cmp "$at/probes.csv" "$at-cut/probes.csv" || fail "$at: rows"
    [ "$(hash "$at")" = "$(hash "$at-effective")" ] || fail "$at: effective case"
}
