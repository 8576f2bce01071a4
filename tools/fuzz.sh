#!/usr/bin/env bash
# Fuzzes the readers with libFuzzer, ASan and UBSan: tools/fuzz.sh [SECONDS for each target] [TARGET...]
# Needs clang with its runtime (Debian: clang libclang-rt-14-dev). Found inputs grow in build/fuzz/;
# the counts of executions are appended to build/fuzz/counts, failing inputs land in build/fuzz/found.
set -eu
cd "$(dirname "$0")/.."
seconds=${1:-60}
shift || true
targets=("$@")
[ $# -gt 0 ] || targets=(case expr motion checkpoint)
build=build/fuzz
mkdir -p $build/found
hdf5=$(sed -n 's/^HDF5_CFLAGS[ :]*= *//p' build/hdf5.mk)
libs=$(sed -n 's/^HDF5_LIBS[ :]*= *//p' build/hdf5.mk)
sanitize=address,undefined
flags=(-std=gnu11 -O1 -g -ffp-contract=off -fno-math-errno -fno-omit-frame-pointer -fopenmp-simd -w
    -march="${ARCH:-native}" -Iinclude -Isrc -Itests/support $hdf5 -DSPHFSI_VERSION='"0"'
    -fno-sanitize-recover=undefined)
objects=()
for file in src/*.c tests/support/fuzz.c; do
    [ $file != src/main.c ] || continue
    object=$build/$(echo "$file" | tr / _).o
    objects+=("$object")
    clang "${flags[@]}" -fsanitize=$sanitize,fuzzer-no-link -c -o "$object" "$file"
done
status=0
for target in "${targets[@]}"; do
    clang "${flags[@]}" -fsanitize=$sanitize,fuzzer -DTARGET="fuzz_$target" \
        -Wl,--wrap=scene_sample -o "$build/fuzz_$target" tests/fuzz/entry.c "${objects[@]}" $libs -lm
    length=4096
    [ "$target" != checkpoint ] || length=8192
    mkdir -p "$build/work-$target"
    "$build/fuzz_$target" -max_total_time="$seconds" -max_len=$length -timeout=20 \
        -rss_limit_mb=2048 -dict=tests/fuzz/case.dict -print_final_stats=1 \
        -artifact_prefix="$build/found/$target-" "$build/work-$target" \
        "tests/fuzz/corpus/$target" >"$build/$target.log" 2>&1 || status=1
    count=$(sed -n 's/^stat::number_of_executed_units: *//p' "$build/$target.log")
    echo "$target ${count:-0} $(date +%Y-%m-%d)" | tee -a $build/counts
done
ls "$build/found"
exit $status
