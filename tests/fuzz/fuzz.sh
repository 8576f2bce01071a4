#!/usr/bin/env bash
# Fuzzes the readers with libFuzzer, ASan and UBSan: tests/fuzz/fuzz.sh [SECONDS for each target]
# [TARGET...] Targets: case expr motion reference series checkpoint. Needs clang with its runtime
# (Debian: clang libclang-rt-14-dev).
# What was run is appended to tests/fuzz/counts.txt, from the fuzzer's own log; failing inputs land
# in build/fuzz/found. Found inputs grow in build/fuzz/; KEEP=1 adds those that reach new code to
# the corpus, tests/fuzz/corpus.tar.gz, whose bytes depend on the inputs only.
set -eu
cd "$(dirname "$0")/../.."
if ! command -v clang >/dev/null; then
    echo "fuzz: clang and its runtime are missing; on Debian:" \
        "sudo apt-get install clang libclang-rt-14-dev"
    exit 1
fi
seconds=${1:-60}
shift || true
targets=("$@")
[ $# -gt 0 ] || targets=(case expr motion reference series checkpoint)
build=build/fuzz
counts=tests/fuzz/counts.txt
corpus=tests/fuzz/corpus.tar.gz
mkdir -p $build/found
rm -rf $build/corpus
tar -xzf $corpus -C $build
hdf5=$(sed -n 's/^HDF5_CFLAGS[ :]*= *//p' build/hdf5.mk)
libs=$(sed -n 's/^HDF5_LIBS[ :]*= *//p' build/hdf5.mk)
sanitize=address,undefined
flags=(-std=gnu11 -O2 -g -ffp-contract=off -fno-math-errno -fno-omit-frame-pointer -fopenmp-simd -w
    -march="${ARCH:-native}" -Iinclude -Isrc -Itests/support $hdf5 -DSPHFSI_VERSION='"0"'
    -fno-sanitize-recover=undefined)

# Objects are made anew when a source, or a header or a table, is newer.
newest=$(ls -t src/*/*.h src/*/*.def tests/support/*.h tests/fuzz/fuzz.sh | head -n 1)
objects=()
sh tools/embed.sh $build/embedded.c cases/templates/*.cfg src/app/data/*
for file in src/*/*.c $build/embedded.c tests/support/fuzz.c; do
    [ $file != src/app/main.c ] || continue
    object=$build/$(echo "$file" | tr / _).o
    objects+=("$object")
    [ "$object" -nt "$file" ] && [ "$object" -nt "$newest" ] ||
        clang "${flags[@]}" -fsanitize=$sanitize,fuzzer-no-link -c -o "$object" "$file"
done

# Every key of params.def, so that new ones are tried as soon as they are there.
{
    cat tests/fuzz/case.dict
    sed -n 's/^[A-Z_]*([a-z]*, *\([a-z_0-9]*\),.*/"\1 = "/p' src/case/params.def | sort -u
} >$build/dict

version=$(git describe --always --dirty --exclude='*' 2>/dev/null || echo unknown)
compiler=clang-$(clang -dumpversion)
status=0
for target in "${targets[@]}"; do
    program=$build/fuzz_$target
    length=4096 mutator=()
    [ "$target" != checkpoint ] || length=8192 mutator=(tests/fuzz/mutate.c)
    clang "${flags[@]}" -fsanitize=$sanitize,fuzzer -DTARGET="fuzz_$target" \
        -Wl,--wrap=scene_sample -o "$program" tests/fuzz/entry.c "${mutator[@]}" "${objects[@]}" \
            $libs -lm
    mkdir -p "$build/work-$target"
    result=0
    "$program" -max_total_time="$seconds" -max_len=$length -timeout=20 -rss_limit_mb=2048 \
        -dict=$build/dict -print_final_stats=1 -artifact_prefix="$build/found/$target-" \
        "$build/work-$target" "$build/corpus/$target" >"$build/$target.log" 2>&1 || result=$?
    [ $result = 0 ] || status=1
    count=$(sed -n 's/^stat::number_of_executed_units: *//p' "$build/$target.log")
    [ -s $counts ] || echo "# target executions seconds exit_status version compiler date" >$counts
    echo "$target ${count:-0} $seconds $result $version $compiler $(date +%Y-%m-%d)" |
        tee -a $counts
    if [ "${KEEP:-}" ]; then
        "$program" -merge=1 -timeout=20 "$build/corpus/$target" "$build/work-$target" \
            >"$build/$target-merge.log" 2>&1 || status=1
    fi
done
if [ "${KEEP:-}" ]; then
    tar --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner --mode=go-w,u+rw -C $build -cf \
        - corpus |
        gzip -9n >$corpus
fi
ls "$build/found"
exit $status
