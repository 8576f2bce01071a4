#!/usr/bin/env bash
# `make install` to a folder of its own; a program outside of the source tree finds the library
# there by pkg-config and by CMake's find_package, and couples its own motion.
set -u
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
if ! [ "${SPHFSI:-./sphfsi}" -ef ./sphfsi ]; then
    echo "installs the release build only"
    exit 77
fi

fail() {
    echo "FAILED: $1"
    exit 1
}

export OMP_NUM_THREADS=1
SETUP=no make -s install PREFIX="$dir/usr" >"$dir/log" 2>&1 ||
    { cat "$dir/log"; fail "make install"; }
"$dir/usr/bin/sphfsi" --version >/dev/null || fail "the installed program does not run"
cp examples/spring_wall.c "$dir"
cd "$dir" || exit 1

# Its displacement after 0.2 s: more than the equilibrium, 14 mm, and less than twice that.
moves() {
    ./spring_wall >"$1.csv" || fail "$1: the example stopped"
    awk -F, 'END { exit !($1 > 0.19 && $2 > 0.014 && $2 < 0.028) }' "$1.csv" ||
        fail "$1: $(tail -n 1 "$1.csv")"
}

ways=0
if command -v pkg-config >/dev/null; then
    export PKG_CONFIG_PATH=$dir/usr/lib/pkgconfig
    cc spring_wall.c $(pkg-config --cflags --libs sphfsi) -o spring_wall || fail "pkg-config"
    readelf -d spring_wall 2>/dev/null | grep -q 'NEEDED.*hdf5' &&
        fail "pkg-config: links HDF5 by itself"
    LD_LIBRARY_PATH=$dir/usr/lib moves pkg-config
    rm spring_wall
    cc spring_wall.c $(pkg-config --cflags --static --libs sphfsi |
        sed 's/-lsphfsi/-l:libsphfsi.a/') \
        -o spring_wall || fail "pkg-config --static"
    moves pkg-config-static
    rm spring_wall
    ways=$((ways + 1))
fi
if command -v cmake >/dev/null; then
    cat >CMakeLists.txt <<'END'
cmake_minimum_required(VERSION 3.20)
project(coupled LANGUAGES C)
find_package(sphfsi 0.1 REQUIRED COMPONENTS ${parts})
add_executable(spring_wall spring_wall.c)
target_link_libraries(spring_wall PRIVATE sphfsi::${library})
END
    for library in sphfsi static; do
        cmake -B build-$library -DCMAKE_PREFIX_PATH="$dir/usr" -Dlibrary=$library \
            -Dparts="$([ $library = sphfsi ] || echo static)" >cmake.log 2>&1 &&
            cmake --build build-$library >>cmake.log 2>&1 ||
            { cat cmake.log; fail "find_package: sphfsi::$library"; }
        cp build-$library/spring_wall .
        moves cmake-$library
    done
    ways=$((ways + 1))
fi
[ $ways -gt 0 ] || { echo "neither pkg-config nor cmake is here"; exit 77; }

# Symbols: programs see sphfsi_... and nothing else.
if command -v nm >/dev/null; then
    { nm -g --defined-only usr/lib/libsphfsi.a; nm -D --defined-only usr/lib/libsphfsi.so; } |
        awk 'NF == 3 { n++; if ($3 !~ /^sphfsi_/) { print $3; bad = 1 } }
             END { exit bad || n < 40 }' ||
        fail "names without sphfsi_ are seen, or none"
fi
