#!/usr/bin/env bash
# `make install` to a folder of its own; a program outside of the source tree finds the library there by
# pkg-config and by CMake's find_package, and couples its own motion.
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
SETUP=no make -s install PREFIX="$dir/usr" >"$dir/log" 2>&1 || { cat "$dir/log"; fail "make install"; }
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
    moves pkg-config
    rm spring_wall
    ways=$((ways + 1))
fi
if command -v cmake >/dev/null; then
    cat >CMakeLists.txt <<'END'
cmake_minimum_required(VERSION 3.20)
project(coupled LANGUAGES C)
find_package(sphfsi REQUIRED)
add_executable(spring_wall spring_wall.c)
target_link_libraries(spring_wall PRIVATE sphfsi::sphfsi)
END
    cmake -B build -DCMAKE_PREFIX_PATH="$dir/usr" >cmake.log 2>&1 && cmake --build build >>cmake.log 2>&1 ||
        { cat cmake.log; fail "find_package"; }
    cp build/spring_wall .
    [ $ways -gt 0 ] || moves cmake # the program is the same
    ways=$((ways + 1))
fi
[ $ways -gt 0 ] || { echo "neither pkg-config nor cmake is here"; exit 77; }
