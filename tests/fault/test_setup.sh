#!/usr/bin/env bash
# On a machine without compiler and package manager, tools/setup.sh says what is missing and how to
# get it, and does not claim success.
set -u
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
mkdir -p "$copy/tools" "$copy/bin"
cp tools/setup.sh tools/requirements.txt "$copy/tools"

# A PATH with the everyday programs only.
for program in bash env cat mkdir rm sed tr head tail awk dirname id grep; do
    ln -s "$(command -v $program)" "$copy/bin/$program"
done

expect() {
    grep -q "$1" "$copy/output" && return
    echo "setup.sh did not say '$1' but:"
    cat "$copy/output"
    exit 1
}

env -i PATH="$copy/bin" bash "$copy/tools/setup.sh" build >"$copy/output" 2>&1
status=$?
expect 'missing: a C compiler (cc)'
expect 'missing: HDF5'
expect 'apt-get install gcc libc6-dev libhdf5-dev pkg-config'
if [ $status != 1 ]; then
    echo "exit status $status instead of 1"
    exit 1
fi

env -i PATH="$copy/bin" CC=clang HDF5_PREFIX=/nowhere bash "$copy/tools/setup.sh" build \
    >"$copy/output" 2>&1
expect 'missing: a C compiler (clang)'
expect 'missing: HDF5 below /nowhere'

env -i PATH="$copy/bin" bash "$copy/tools/setup.sh" nonsense >"$copy/output" 2>&1
status=$?
expect "unknown need 'nonsense'"
if [ $status != 1 ]; then
    echo "an unknown need gives exit status $status instead of 1"
    exit 1
fi
