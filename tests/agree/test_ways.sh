#!/usr/bin/env bash
# Clusters, also in chunks, a tile of candidates and a list of neighbours give the same sums:
# bench/neighbours.c, which counts true neighbours by itself. And both benchmark programs are built
# and start.
bench=${BUILD:-build/release}
if [ ! -x "$bench/bench_neighbours" ]; then
    echo "there are no benchmark programs in $bench"
    exit 77
fi
"$bench/bench_bench" --help 2>&1 | grep -q '^usage' ||
    { echo "FAILED: bench_bench --help"; exit 1; }
OMP_NUM_THREADS=1 "$bench/bench_neighbours" --reps 1 | awk -F, '
    { print; value[$2 "," $5] = $7 }
    END {
        off = value["all,largest difference"]
        met = value["cluster,pairs"]; once = value["chunk,pairs"]
        true_ones = value["list,entries"]
        if (!(off > 0 && off < 1e-5)) { print "FAILED: sums differ by " off; bad = 1 }
        if (!(true_ones > 20 && met < 3 * true_ones)) { print "FAILED: " met " pairs"; bad = 1 }
        if (!(once > met / 2 && once < 0.65 * met)) { print "FAILED: " once " in chunks"; bad = 1 }
        exit bad
    }'
