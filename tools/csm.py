#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs CSM1 or CSM3 of Turek and Hron (2006), a bar on a cylinder under gravity without fluid, at several
numbers of particles across, and prints displacements of the bar's end, errors and orders.

CSM1 is static: the weight is raised over three periods, and the mean over the next one is taken.
CSM3 is a free swing from rest; compared are its lowest point and its frequency in the first three
periods, where the reference has a later one. Its order is that of the differences between runs, which need
one ratio of refinement. Exit status 1 if the vertical displacement converges with an order below 1.

example:
  tools/csm.py ./sphfsi --test 1 --across 5 10 20 --out runs/csm
"""
import argparse
import csv
import math
import re
import subprocess
import sys
from pathlib import Path

CASE = """dp = {dp:.15g}
end_time = {end}
gravity = 0, {gravity}
[numerics]
lattice_origin = 0, 0.19
[solid bar]
shape = box 0.24, 0.19, 0.6, 0.21
clamp = circle 0.2, 0.2, 0.05
density = 1000
young = 1.4 MPa
poisson = 0.4
law = svk
[probe A]
quantity = displacement
body = bar
point = 0.6, 0.2
interval = 5 ms
[output]
snapshot_interval = {end}
ledger_interval = {end}
"""
LOAD = """[load weight]
body = bar
shape = box 0.2, 0.18, 0.61, 0.22
force = 0, {force:.15g}
history = min(t/{ramp}, 1)^3*(10 - 15*min(t/{ramp}, 1) + 6*min(t/{ramp}, 1)^2)
"""
PERIOD = 1 / 1.0995
# ux and uy in mm, at the lowest point of a swing in CSM3 (mean less amplitude), and Hz.
REFERENCE = {1: {"ux": -7.187, "uy": -66.10},
             3: {"ux": -14.305 - 14.305, "uy": -63.607 - 65.160, "frequency": 1.0995}}


def sampled_area(program, case):
    """What the particles of the bar cover, as --preview says."""
    drawing = case.with_suffix(".svg")
    subprocess.run([program, "--preview", case, "--out", drawing], check=True, capture_output=True)
    found = re.search(r"solid bar: .*?(\d+) particles(?: of (\S+) x (\S+) m)?[;,]",
                      drawing.read_text(encoding="utf-8"))
    return int(found[1]), (float(found[2]) * float(found[3]) if found[2] else None)


def columns(table):
    with open(table, encoding="utf-8", newline="") as file:
        rows = [[float(value) for value in row] for row in list(csv.reader(file))[1:]]
    return [list(column) for column in zip(*rows)]


def mean_from(times, values, start):
    inside = [k for k, time in enumerate(times) if time >= start - 1e-9]
    pairs = zip(inside, inside[1:])
    return sum(0.5 * (values[a] + values[b]) for a, b in pairs) / (len(inside) - 1)


def frequency(times, values):
    """From the first to the last trough, each the vertex of a parabola."""
    troughs = []
    for k in range(1, len(values) - 1):
        a, b, c = values[k - 1:k + 2]
        if b < a and b <= c and b < 0.8 * min(values):
            troughs.append(times[k] + (times[k] - times[k - 1]) * 0.5 * (a - c) / (a - 2 * b + c))
    return (len(troughs) - 1) / (troughs[-1] - troughs[0])


def run(args, across):
    dp, ramp = 0.02 / across, 3 * PERIOD
    end = 4 * PERIOD if args.test == 1 else 3.3
    text = CASE.format(dp=dp, end=end, gravity=0 if args.test == 1 else -2)
    args.out.mkdir(parents=True, exist_ok=True)
    case = args.out / f"csm{args.test}-{across}.cfg"
    case.write_text(text, encoding="utf-8")
    if args.test == 1:
        n, cell = sampled_area(args.program, case)
        text += LOAD.format(force=-2 * 1000 * n * (cell or dp * dp), ramp=ramp)
        case.write_text(text, encoding="utf-8")
    subprocess.run([args.program, case, "--quiet", "--threads", "1", "--out", case.with_suffix("")],
                   check=True)
    time, ux, uy = columns(case.with_suffix("") / "probes_A.csv")[:3]
    if args.test == 1:
        return {"ux": 1e3 * mean_from(time, ux, ramp), "uy": 1e3 * mean_from(time, uy, ramp)}
    return {"ux": 1e3 * min(ux), "uy": 1e3 * min(uy), "frequency": frequency(time, uy)}


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--test", type=int, choices=(1, 3), default=1)
    parser.add_argument("--across", type=int, nargs="+", default=[5, 10, 20])
    parser.add_argument("--out", type=Path, default=Path("runs/csm"))
    args = parser.parse_args()
    args.program = args.program.resolve()
    reference, errors, values = REFERENCE[args.test], [], []
    names = list(reference)
    print("across " + " ".join(f"{name:>20}" for name in names))
    print("       " + " ".join(f"{reference[name]:20.4f}" for name in names) + "  reference")
    for across in args.across:
        found = run(args, across)
        off = {name: found[name] / reference[name] - 1 for name in names}
        errors.append(abs(off["uy"]))
        values.append(found["uy"])
        print(f"{across:6} " + " ".join(f"{found[name]:10.4f} ({100 * off[name]:+6.2f} %)"
                                        for name in names), flush=True)
    if args.test == 3:
        errors = [abs(a - b) for a, b in zip(values, values[1:])]
    orders = [math.log(a / b) / math.log(fine / coarse) for a, b, coarse, fine in
              zip(errors, errors[1:], args.across, args.across[1:])]
    print(f"order of uy, from {'differences' if args.test == 3 else 'errors'}: "
          + ", ".join(f"{order:.2f}" for order in orders))
    sys.exit(any(order < 1 for order in orders))


if __name__ == "__main__":
    main()
