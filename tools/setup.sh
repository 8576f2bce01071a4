#!/usr/bin/env bash
# Finds what sphfsi needs and, where it may, installs what is missing.
#
#   tools/setup.sh build    C compiler with OpenMP, HDF5           -> build/hdf5.mk, and
#                           build/python where there is a Python for plot
#   tools/setup.sh test     the above, Unity, Python as for plot   -> build/unity.mk
#   tools/setup.sh plot     Python 3 with numpy, matplotlib, h5py  -> build/python
#   tools/setup.sh web      a compiler for WebAssembly             -> build/zig.mk
#
# Installs through apt-get as root, or with a sudo that needs no password, after a question on the
# terminal. With SETUP=yes (`make gate`, `make test`) or CI it does not ask; without a terminal the
# answer is no. Python packages go into .venv where pip can reach them. Otherwise prints what to
# install and exits with 1. Says nothing when nothing is missing. Hints: CC, HDF5_PREFIX, UNITY_DIR,
# PYTHON, ZIG; SETUP=no installs nothing.
set -u
cd "$(dirname "$0")/.." || exit 1
CC=${CC:-cc}

ziglang_version=0.17.1
unity_version=2.6.1
unity_url=https://github.com/ThrowTheSwitch/Unity/archive/refs/tags/v$unity_version.tar.gz
unity_sha256=b41a66d45a6b99758fb3202ace6178177014d52fc524bf1f72687d93e9867292
# Debian's cjson carries Unity 2.4 for its own tests. apt verifies what it downloads by the
# archive's signature; the version known to work is pinned besides.
cjson_known=cjson_1.7.15.orig.tar.gz
cjson_sha256=5308fd4bd90cef7aa060558514de6a1a4a0819974a26e6ed13973c5f624c24b2

missing=()   # in words
packages=()  # Debian's names
formulas=()  # Homebrew's names

say() { echo "setup: $*" >&2; }
have() { command -v "$1" >/dev/null 2>&1; }
lacks() { missing+=("$1") packages+=($2) formulas+=($3); }

# Writes $2 to the file $1, unless it says so already.
record() { [ "$(cat "$1" 2>/dev/null)" = "$2" ] || { mkdir -p build && echo "$2" >"$1"; }; }

# --- compiler and HDF5 ---

find_compiler() {
    local kind="gcc libc6-dev libgomp1"
    case "$CC $($CC --version 2>/dev/null)" in *clang*) kind="clang libc6-dev libomp-dev" ;; esac
    mkdir -p build
    if ! have "${CC%% *}"; then
        lacks "a C compiler ($CC)" "${kind% libgomp1}" gcc
    elif ! echo 'int omp_get_max_threads(void); int main(void) { return !omp_get_max_threads(); }' |
        $CC -x c -fopenmp -o build/probe - >/dev/null 2>&1; then
        lacks "OpenMP or the C library's headers for $CC" "${kind#* }" gcc
    fi
    rm -f build/probe
}

# Compiler and linker flags of HDF5, on two lines. Debian's hdf5.pc may belong to an MPI build,
# hence its serial name comes first.
hdf5_flags() {
    local name show
    if [ -n "${HDF5_PREFIX:-}" ]; then
        [ -e "$HDF5_PREFIX/include/hdf5.h" ] || return 1
        echo "-isystem $HDF5_PREFIX/include"
        echo "-L$HDF5_PREFIX/lib -Wl,-rpath,$HDF5_PREFIX/lib -lhdf5"
        return
    fi
    if have pkg-config; then
        for name in hdf5-serial hdf5; do
            pkg-config --exists $name 2>/dev/null || continue
            pkg-config --cflags-only-I $name | sed 's/-I */-isystem /g'
            pkg-config --libs $name
            return
        done
    fi
    have h5cc && show=$(h5cc -show 2>/dev/null) || return 1
    tr ' ' '\n' <<<"$show" | sed -n 's/^-I/-isystem /p' | tr '\n' ' '
    echo
    echo "$(tr ' ' '\n' <<<"$show" | sed -n 's/^-L\(.*\)/-L\1 -Wl,-rpath,\1/p' | tr '\n' ' ')-lhdf5"
}

find_build() {
    # Found earlier for the same compiler and prefix, and still there: enough.
    local key="# $CC ${HDF5_PREFIX:-}" flags
    if [ "$(head -n 1 build/hdf5.mk 2>/dev/null)" = "$key" ] && have "${CC%% *}" &&
        [ -e "$(sed -n 's/^# header //p' build/hdf5.mk)" ]; then
        return
    fi
    find_compiler
    if ! flags=$(hdf5_flags); then
        lacks "HDF5${HDF5_PREFIX:+ below $HDF5_PREFIX}" "libhdf5-dev pkg-config" "hdf5 pkg-config"
    elif [ ${#missing[@]} = 0 ]; then
        local cflags=${flags%%$'\n'*} libs=${flags#*$'\n'} header
        header=$(echo '#include <hdf5.h>' | $CC $cflags -E - 2>/dev/null |
            sed -n 's/^# [0-9]* "\(.*\/hdf5\.h\)".*/\1/p' | head -n 1)
        if [ -z "$header" ]; then
            lacks "HDF5's header, hdf5.h" "libhdf5-dev pkg-config" "hdf5 pkg-config"
        else
            record build/hdf5.mk "$key"$'\n'"# header $header
HDF5_CFLAGS := $cflags"$'\n'"HDF5_LIBS := $libs"
        fi
    fi
}

# --- Python ---

python_complete() {
    "$1" -c 'import sys, importlib.util as u
sys.exit(any(u.find_spec(m) is None for m in ("numpy", "matplotlib", "h5py")))' >/dev/null 2>&1
}

# Every python3 in the PATH, not just the first: a version manager's often has no packages.
pythons() {
    local p
    for p in "${PYTHON:-}" "$PWD/.venv/bin/python" $(type -aP python3) /usr/bin/python3; do
        [ ! -x "$p" ] || echo "$p"
    done
}

find_python() {
    local p
    for p in ${PYTHON:-$(cat build/python 2>/dev/null)} $(pythons); do
        python_complete "$p" || continue
        # The interpreter itself, not a version manager's stand-in for it.
        record build/python "$("$p" -c 'import sys; print(sys.executable)')"
        return
    done
    lacks "Python 3 with numpy, matplotlib and h5py" \
        "python3-numpy python3-matplotlib python3-h5py python3-cffi" \
        "python numpy python-matplotlib"
}

# pip of the first Python that has it and succeeds, with its options.
pip_install() {
    local python=$1
    shift
    "$python" -m pip install --quiet --disable-pip-version-check --retries 1 --timeout 15 \
        --only-binary :all: "$@" >build/pip.log 2>&1
}

# A virtual environment from the first python that can make one and reach the package index.
make_venv() {
    local p
    for p in $(pythons); do
        "$p" -c 'import venv, ensurepip' 2>/dev/null || continue
        say "installing numpy, matplotlib, h5py and cffi into .venv"
        rm -rf .venv
        "$p" -m venv .venv >/dev/null 2>&1 &&
            pip_install .venv/bin/python -r tools/requirements.txt && return
        rm -rf .venv
        say "pip did not succeed (build/pip.log)"
        return 1
    done
    return 1
}

# Notes a Python that has all, where none is known yet; a build misses nothing without one.
note_python() { [ -e build/python ] || (find_python); }

# --- Unity ---

# Takes Unity from directory $1 if its source is there (Canonical's desktop has a unity.h, too).
use_unity() {
    grep -qs TEST_ASSERT_EQUAL_DOUBLE "$1/unity.h" || return 1
    [ -e "$1/unity.c" ] || return 1
    record build/unity.mk "UNITY_SRC := $1
UNITY_CFLAGS := -isystem $1 -DUNITY_INCLUDE_DOUBLE"
}

find_unity() {
    local dir
    for dir in ${UNITY_DIR:+"$UNITY_DIR" "$UNITY_DIR/src"} /usr/src/unity /usr/src/unity/src \
        /usr/include /usr/include/unity /usr/local/include /usr/local/include/unity \
        build/deps/unity/src; do
        use_unity "$dir" && return
    done
    fetch_unity_release || fetch_unity_from_debian && use_unity build/deps/unity/src && return
    lacks "Unity $unity_version, the C test framework (git clone it, set UNITY_DIR)" "" ""
}

# Unpacks the archive $1, checked against sha256 $2 unless that is empty.
unpack_unity() {
    local sum member
    sum=$(sha256sum "$1" 2>/dev/null || shasum -a 256 "$1") && sum=${sum%% *}
    if [ "$sum" != "${2:-$sum}" ]; then
        say "$(basename "$1"): sha256 is $sum, not the expected $2"
        return 1
    fi
    rm -rf build/deps/unpack build/deps/unity
    mkdir -p build/deps/unpack
    tar xf "$1" -C build/deps/unpack || return 1
    member=$(find build/deps/unpack -path '*/src/unity.c' | head -n 1)
    # The whole tree: Debian's unity.h includes a file of the examples beside src.
    [ -n "$member" ] && mv "${member%/src/unity.c}" build/deps/unity && rm -rf build/deps/unpack
}

fetch_unity_release() {
    [ "${SETUP:-}" != no ] && have curl || return 1
    mkdir -p build/deps
    say "fetching Unity $unity_version"
    curl -fsSL --connect-timeout 3 --max-time 20 -o build/deps/unity.tar.gz "$unity_url" \
        2>/dev/null && unpack_unity build/deps/unity.tar.gz $unity_sha256
}

# The deb-src line for the system's own archive and release goes into a private apt state, so the
# system's settings stay as they are and no privilege is needed.
private_sources() {
    local codename
    codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
    [ -n "$codename" ] || return 1
    cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null |
        grep -E "^deb .*[[:space:]]$codename[[:space:]]+.*(main|universe)" |
        sed 's/^deb /deb-src /' >"$1.list"
    cat /etc/apt/sources.list.d/*.sources 2>/dev/null |
        awk -v RS= -v ORS='\n\n' "/Suites:[^\n]*[[:space:]]$codename([[:space:]]|\$)/ &&
            /Components:[^\n]*(main|universe)/" | sed 's/^Types:.*/Types: deb-src/' >"$1.sources"
    [ -s "$1.list" ] || [ -s "$1.sources" ]
}

fetch_unity_from_debian() {
    [ "${SETUP:-}" != no ] && have apt-get && [ -r /etc/os-release ] || return 1
    local apt=$PWD/build/deps/apt tarball sum=
    rm -rf "$apt"
    mkdir -p "$apt"/{parts,lists/partial,cache/archives/partial}
    private_sources "$apt/parts/source" || return 1
    local options=(-qq -o Dir::Etc::SourceList=/dev/null -o Dir::Etc::SourceParts="$apt/parts"
        -o Dir::State::Lists="$apt/lists" -o Dir::Cache="$apt/cache" -o Acquire::Languages=none
        -o APT::Sandbox::User=root -o Acquire::http::Timeout=20 -o Acquire::Retries=2)
    say "fetching Unity from Debian's source package cjson"
    (cd "$apt" && apt-get "${options[@]}" update &&
        apt-get "${options[@]}" source --download-only cjson) >"$apt/log" 2>&1
    tarball=$(ls "$apt"/cjson_*.orig.tar.* 2>/dev/null | grep -v '\.asc$' | head -n 1)
    if [ -z "$tarball" ]; then
        say "apt-get source cjson did not succeed (build/deps/apt/log)"
        return 1
    fi
    [ "$(basename "$tarball")" != $cjson_known ] || sum=$cjson_sha256
    unpack_unity "$tarball" "$sum" && rm -rf "$apt"
}

# --- compiler for WebAssembly ---

# `zig cc` is clang with wasi-libc. Debian's clang 14 has no relaxed SIMD.
zig_works() {
    echo 'int main(void) { return 0; }' | env ZIG_{LOCAL,GLOBAL}_CACHE_DIR=build/web/cache "$1" cc \
        -target wasm32-wasi -msimd128 -mrelaxed-simd -x c -o build/probe.wasm - >/dev/null 2>&1
}

find_zig() {
    local zig known
    known=$(sed -n 's/^ZIG := //p' build/zig.mk 2>/dev/null)
    [ -n "$known" ] && [ -x "$known" ] && [ -z "${ZIG:-}" ] && return
    for zig in ${ZIG:+"$ZIG"} build/deps/ziglang/ziglang/zig $(type -aP zig); do
        [ -x "$zig" ] && zig_works "$zig" && record build/zig.mk "ZIG := $zig" && return
    done
    lacks "a compiler for WebAssembly (zig, of PyPI's ziglang)" "" ""
}

# 100 MB, and nothing outside of build/ changes.
fetch_zig() {
    local p
    say "fetching ziglang $ziglang_version into build/deps/ziglang"
    for p in $(pythons); do
        pip_install "$p" --no-deps --target build/deps/ziglang "ziglang==$ziglang_version" && return
    done
    say "pip did not succeed (build/pip.log)"
    return 1
}

# --- all of it ---

find_all() {
    missing=() packages=() formulas=()
    local need
    for need in "$@"; do
        case $need in
            build) find_build; note_python ;;
            plot) find_python ;;
            web) find_zig ;;
            test) find_build && find_python && find_unity ;;
            *) say "unknown need '$need'; one of: build test plot web"; exit 1 ;;
        esac
    done
}

privilege() {
    [ "${SETUP:-}" != no ] && have apt-get || return 1
    [ "$(id -u)" = 0 ] || { have sudo && sudo -n true 2>/dev/null && echo "sudo -n"; }
}

# With the package lists there are, and once more with new ones: those of last month name files that
# the mirror no longer has.
install_packages() {
    local run="$1 env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=120"
    shift
    say "installing $* (build/apt.log)"
    { $run install -y --no-install-recommends "$@" </dev/null ||
        { $run update && $run install -y --no-install-recommends "$@" </dev/null; }; } \
        >build/apt.log 2>&1 ||
        say "apt-get did not succeed: $(grep '^E:' build/apt.log | tail -n 1)"
}

# Whether the packages may be installed.
agreed() {
    local answer
    [ "${SETUP:-}" = yes ] || [ -n "${CI:-}" ] && return
    [ -t 2 ] && { : </dev/tty; } 2>/dev/null || return 1
    read -rp "setup: install $* with apt-get, as root? [y/N] " answer </dev/tty
    case $answer in [yY]*) ;; *) return 1 ;; esac
}

unique() { printf '%s\n' "$@" | awk '!seen[$0]++'; }

mkdir -p build
find_all "$@"
[ ${#missing[@]} -gt 0 ] || exit 0

if [ "${SETUP:-}" != no ]; then
    case "${missing[*]}" in *"Python 3"*) make_venv && find_all "$@" ;; esac
    case "${missing[*]}" in *WebAssembly*) fetch_zig && find_all "$@" ;; esac
fi
if [ ${#packages[@]} -gt 0 ] && sudo=$(privilege) && agreed $(unique "${packages[@]}"); then
    install_packages "$sudo" $(unique "${packages[@]}")
    find_all "$@"
fi
[ ${#missing[@]} -gt 0 ] || exit 0

unique "${missing[@]}" | while read -r item; do say "missing: $item"; done
if have brew && [ ${#formulas[@]} -gt 0 ]; then
    say "to install it: brew install $(echo $(unique "${formulas[@]}"))"
    case "${formulas[*]}" in *gcc*) say "and then: make CC=gcc-14 (or its version)" ;; esac
elif [ ${#packages[@]} -gt 0 ]; then
    say "to install it on Debian or Ubuntu: sudo apt-get install $(echo $(unique "${packages[@]}"))"
    have apt-get || say "elsewhere the packages have similar names (Fedora: docs/guide.md, Sec. 1)"
fi
exit 1
