#!/usr/bin/env bash
# The template with a lifted plate runs to its end without a warning.
set -u
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
export OMP_NUM_THREADS=1
"$SPHFSI" --new baffle >"$work/my.cfg" || exit 1
"$SPHFSI" "$work/my.cfg" --out "$work/run" --quiet >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
! grep -i warning "$work/log"
