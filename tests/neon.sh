#!/usr/bin/env bash
# The tests of the numerics on 128-bit NEON vectors: cross-compiled for AArch64, run under qemu.
#   tests/neon.sh UNITY_SRC [test ...]
# Needs gcc-aarch64-linux-gnu, libc6-dev-arm64-cross and qemu-user-static (Debian's names). What
# writes HDF5 is left out, so that no HDF5 for the other machine is wanted.
set -eu
cd "$(dirname "$0")/.."
unity=$1
shift
tests=${*:-golden/test_golden base/test_simd fluid/test_fluid fluid/test_wall solid/test_solid
time/test_integrators time/test_coupling particles/test_cells agree/test_twin agree/test_twin_solid
agree/test_kernels}
CC=${NEON_CC:-aarch64-linux-gnu-gcc} RUN=${NEON_RUN:-qemu-aarch64-static} out=build/neon
for tool in "$CC" "$RUN"; do
    command -v "$tool" >/dev/null || { echo "$tool is missing" >&2; exit 77; }
done
mkdir -p $out
flags="-std=gnu11 -O2 -DNDEBUG -ffp-contract=off -fno-math-errno -fno-trapping-math -march=armv8-a
-fopenmp-simd -Wall -Wextra -Werror -Wno-psabi -Wno-unknown-pragmas
-Wno-format-truncation -Iinclude -Isrc -Itests/support -isystem $unity
-DUNITY_INCLUDE_DOUBLE -DSPHFSI_VERSION=\"neon\""
rm -f $out/lib.a
sh tools/embed.sh $out/embedded.c cases/templates/*.cfg src/app/data/*
for file in src/*/*.c $out/embedded.c tests/support/*.c; do
    if [ "$file" = src/app/main.c ] ||
        grep -Eq '<hdf5.h>|"output/snapshot' "$file"; then continue; fi
    object=$out/$(echo "${file%.c}" | tr / _).o
    $CC $flags -c "$file" -o "$object"
    ${CC%gcc}ar rcs $out/lib.a "$object"
done
$CC $flags -w -c "$unity"/unity.c -o $out/unity.o
failed=0
for test in $tests; do
    $CC $flags -static -o $out/test tests/"$test".c $out/unity.o $out/lib.a -lm
    line=$($RUN $out/test 2>&1 | grep ' Tests ') || true
    echo "$test: ${line:-no summary}"
    [[ $line == *" 0 Failures"* ]] || failed=1
done
exit $failed
