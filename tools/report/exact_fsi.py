#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A wave through the interface of an elastic bar and a fluid against d'Alembert's solution, for
light and heavy bars, with explicit and implicit steps of the bar: orders in space and in time.

  tools/report/exact_fsi.py                 writes docs/results/exact_fsi.md (minutes on a core)
  tools/report/exact_fsi.py 0.1 implicit    one density ratio and kind of steps, to the screen

The scene is cases/verify/fsi_bar.cfg: the one-dimensional model of Banks, Henshaw and Schwendeman
(2012, J. Comput. Phys. 231, 3518; arXiv 1308.5722)."""
import math

from common import OUT, QUICK, ROOT, np, options, program_version, run_tool, table, write
from metrics import order
import sphfsi

REPORT = OUT / "exact_fsi.md"
CASE = ROOT / "cases" / "verify" / "fsi_bar.cfg"
DENSITIES = (0.1, 1, 100) if QUICK else (0.01, 0.1, 1, 10, 100)
RATIOS = (25, 50) if QUICK else (50, 100, 200)
STEPS = ("explicit", "implicit")
# Time: particles over L, steps of the fluid over the least number, of the run to compare with, too.
AT, COUNTS, FINEST = (25, (1, 2, 4), 16) if QUICK else (50, (1, 2, 4), 16)
ASKED = {"space": 1.0, "time": 2.0}
SOUND, LENGTH, SIZE = 10.0, 1.0, 1e-4  # of the case: c, L, V


def least(density):
    """Steps at C = 0.2; more for a light bar, whose added mass bounds the step (T-35d)."""
    return 2 * AT * max(1, math.ceil(0.2 / density))


def pulse(x):
    return SIZE * np.maximum(1 - ((x + 0.3) / 0.2)**2, 0)**4


def exact(x, time, density):
    """The velocity: half of the pulse runs each way; 2r/(1 + r) of that to the right passes x = 0,
    (r - 1)/(r + 1) of it comes back."""
    right, left = x - SOUND * time, x + SOUND * time
    back = (density - 1) / (density + 1) * 0.5 * pulse(-left)
    bar = 0.5 * pulse(right) + 0.5 * pulse(left) + back
    return np.where(x < 0, bar, density / (1 + density) * pulse(right))


def run(density, steps, ratio, count=None):
    """x and velocity of bar and fluid at the end, sorted by number, and the time."""
    numerics = {"solid_steps": steps}
    if count:
        numerics["fixed_step"] = 0.5 * LENGTH / SOUND / count
    s = sphfsi.Case(CASE, r=density, ratio=ratio, numerics=numerics).simulation(threads=1)
    s.advance()
    found = []
    for kind in (s.solid, s.fluid):
        order = np.argsort(kind.id)
        found.append((np.array(kind.x)[order], np.array(kind.vx)[order]))
    return found, s.time


def in_space(density, steps, ratio):
    """RMS errors in bar and fluid over the largest velocity there."""
    found, time = run(density, steps, ratio)
    off = []
    for x, v in found:
        wanted = exact(x, time, density)
        off.append(math.sqrt(np.mean((v - wanted)**2)) / np.abs(wanted).max())
    return off


def in_time(density, steps, counts):
    """RMS differences from the run with the shortest steps, in the same way."""
    finest, _ = run(density, steps, AT, FINEST * least(density))
    out = []
    for count in counts:
        found, _ = run(density, steps, AT, count * least(density))
        out.append([math.sqrt(np.mean((v - best)**2)) / np.abs(best).max()
                    for (_, v), (_, best) in zip(found, finest)])
    return out


def study(kind, density, steps):
    """Rows of both media: errors by size, order between the two finest."""
    sizes = RATIOS if kind == "space" else COUNTS
    errors = [in_space(density, steps, ratio) for ratio in RATIOS] if kind == "space" else \
        in_time(density, steps, COUNTS)
    return [[medium, column, order(sizes, column)]
            for medium, column in zip(("bar", "fluid"), map(list, zip(*errors)))]


def report(studies):
    tables, slopes = [], {}
    for kind, sizes in (("space", RATIOS), ("time", COUNTS)):
        rows = []
        for (of, density, steps), found in studies.items():
            for medium, errors, slope in found if of == kind else ():
                rows.append([f"{density:g}", steps, medium, *(f"{e:.2g}" for e in errors),
                             f"{slope:.2f}"])
                slopes.setdefault(kind, []).append(slope)
        head = [f"L/dp = {n}" for n in sizes] if kind == "space" else \
            [f"{n}n steps".removeprefix("1") for n in sizes]
        tables.append(table(["r", "steps of the bar", "in", *head, "order"], rows))
    words = [f"{kind.capitalize()}: orders of {min(slopes[kind]):.2f} to {max(slopes[kind]):.2f}, "
             f"asked: {asked:g}; {sum(slope >= 0.95 * asked for slope in slopes[kind])} of "
             f"{len(slopes[kind])} are within 5 % of that." for kind, asked in ASKED.items()]
    return {"answer": " ".join(words), "version": program_version(), "space": tables[0],
            "time": tables[1], "at": AT, "finest": FINEST,
            "least": ", ".join(f"{least(r)} for r = {r:g}" for r in DENSITIES)}


def main():
    parser = options(__doc__)
    parser.add_argument("density", nargs="?", type=float)
    parser.add_argument("steps", nargs="?", choices=STEPS, default="explicit")
    args = parser.parse_args()
    if args.density:
        for kind in ASKED:
            for medium, errors, slope in study(kind, args.density, args.steps):
                print(kind, medium, " ".join(f"{e:.3g}" for e in errors), f"{slope:.2f}")
        return
    write(REPORT, REPORT.name, **report({(kind, density, steps): study(kind, density, steps)
                                         for kind in ASKED for density in DENSITIES
                                         for steps in STEPS}))


if __name__ == "__main__":
    run_tool(main)
