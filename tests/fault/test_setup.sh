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

# With a package manager it installs as root only where that is agreed: here nobody can be asked.
cat >"$copy/bin/apt-get" <<'END'
#!/bin/bash
echo "$*" >>"$CALLED"
exit 1
END
printf '#!/bin/bash\necho 0\n' >"$copy/id"
rm "$copy/bin/id"
mv "$copy/id" "$copy/bin/id"
chmod +x "$copy/bin/apt-get" "$copy/bin/id"
calls() {
    rm -f "$copy/called"
    env -i PATH="$copy/bin" CALLED="$copy/called" "$@" bash "$copy/tools/setup.sh" build \
        >"$copy/output" 2>&1 </dev/null
    expect 'missing: a C compiler (cc)'
    [ -e "$copy/called" ]
}
if calls A=b; then
    echo "setup.sh installs without having asked: $(cat "$copy/called")"
    exit 1
fi
for consent in SETUP=yes CI=true; do
    calls $consent && continue
    echo "setup.sh does not install with $consent"
    exit 1
done
if calls SETUP=no CI=true; then
    echo "setup.sh installs with SETUP=no"
    exit 1
fi
