#!/usr/bin/env bash
# Static analysis of src/: cppcheck, clang-tidy (.clang-tidy), gcc -fanalyzer. tools/dev/analyze.sh
# [FILE...] Prints every finding that is not explained in place, by a suppression with its reason
# beside the line; fails if there is one. A tool that is not there is named and passed over.
set -u
cd "$(dirname "$0")/../.."
files=("$@")
[ $# -gt 0 ] || files=(src/*/*.c)
hdf5=$(sed -n 's/^HDF5_CFLAGS[ :]*= *//p' build/hdf5.mk)
flags=(-std=gnu11 -O1 -march="${ARCH:-native}" -fopenmp -Iinclude $hdf5 -DSPHFSI_VERSION='"0"')
findings=$(mktemp)
trap 'rm -f "$findings"' EXIT
total=0

# report TOOL VERSION: of the findings, one a line.
report() {
    local n
    n=$(sort -u "$findings" | grep -c .)
    sort -u "$findings"
    echo "found: $1 $2, ${#files[@]} files, $n findings that are not explained"
    total=$((total + n))
}

if command -v cppcheck >/dev/null; then
    cppcheck --enable=warning,portability,performance --std=c11 --inline-suppr --quiet -Iinclude \
        -Isrc \
        --suppress=missingIncludeSystem --template='{file}:{line}: {message} [{id}]' "${files[@]}" \
        >"$findings" 2>&1
    report cppcheck "$(cppcheck --version | cut -d' ' -f2)"
else
    echo "cppcheck is not there"
fi

tidy=$(command -v clang-tidy-14 || command -v clang-tidy)
if [ -n "$tidy" ]; then
    for file in "${files[@]}"; do
        "$tidy" --quiet "$file" -- "${flags[@]}" 2>/dev/null
    done | sed -n "s|^$PWD/||; /: \(warning\|error\): /p" >"$findings"
    report clang-tidy "$("$tidy" --version | sed -n 's/.*version \([0-9.]*\).*/\1/p')"
else
    echo "clang-tidy is not there"
fi

# Its search for what is not set takes vectors that are filled item by item, and fields that only
# some laws load, for unset; cppcheck and memcheck look for that.
if gcc -fanalyzer -E -x c /dev/null >/dev/null 2>&1; then
    for file in "${files[@]}"; do
        gcc -fanalyzer -Wno-analyzer-use-of-uninitialized-value "${flags[@]}" -c -o /dev/null \
            "$file" 2>&1
    done | grep ': warning: ' >"$findings"
    report "gcc -fanalyzer" "$(gcc -dumpfullversion)"
else
    echo "gcc -fanalyzer is not there"
fi
[ $total = 0 ]
