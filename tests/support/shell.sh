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
