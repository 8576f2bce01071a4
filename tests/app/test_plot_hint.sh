#!/usr/bin/env bash
# The command that a run ends with draws its probes from where the user stands. 77: a package is missing.
set -u
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
fail() { echo "$1"; exit 1; }
"$PYTHON" -c 'import matplotlib, h5py, numpy' 2>/dev/null || { echo "no matplotlib"; exit 77; }
export OMP_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE=1
root=$PWD
tiny=$root/tests/fault/tiny.cfg
hint() { "$@" | sed -n 's/^plot it with: //p'; }

# From another folder, into one whose name a shell would cut in two.
cd "$work" || exit 1
command=$(hint "$SPHFSI" "$tiny" --out "my run's") || fail "no hint"
sh -c "$command" >out.txt 2>&1 || fail "'$command' does not run: $(cat out.txt)"
[ -s "my run's/probes.png" ] || fail "'$command' draws nothing"

# A clone of its own, with and without a Python that is known.
mkdir -p clone/tools clone/build
cp "$SPHFSI" clone/sphfsi
: >clone/tools/plot_probes.py
case $(hint clone/sphfsi "$tiny" --out a) in
    "$work/clone/tools/setup.sh plot && "*) ;;
    *) fail "no word of the set-up where no Python is known" ;;
esac
echo "$PYTHON" >clone/build/python
cd clone || exit 1
[ "$(hint ./sphfsi "$tiny" --out b)" = "$PYTHON tools/plot_probes.py b" ] ||
    fail "the path at the top of a clone"
cd ..
# One of a build folder belongs to that clone, too.
mkdir clone/build/debug && cp "$SPHFSI" clone/build/debug/sphfsi
[ "$(hint clone/build/debug/sphfsi "$tiny" --out d)" = "$PYTHON $work/clone/tools/plot_probes.py d" ] ||
    fail "a program in a folder of build/"

# A program that is installed somewhere.
mkdir bin && cp "$SPHFSI" bin/sphfsi
command=$(hint bin/sphfsi "$tiny" --out c)
printf '#!/bin/sh\nexec "%s" "$@"\n' "$PYTHON" >python3 && chmod +x python3
PATH=$PWD:$PATH PYTHONPATH=$root/python sh -c "$command" >out.txt 2>&1 ||
    fail "'$command' does not run: $(cat out.txt)"
[ -s c/probes.png ] || fail "python3 -m sphfsi plot draws nothing"
PYTHONPATH=$root/python "$PYTHON" -m sphfsi plot none 2>&1 | grep -q "no such folder" || fail "a missing run"
exit 0
