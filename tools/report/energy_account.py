#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes docs/results/energy_account.md: what the account of energy (docs/theory.md, T-46) finds in
scenes of every kind, with the default step and smaller ones, and in a grid of plates between
waters.

Example: tools/report/energy_account.py --grid"""
import itertools
import statistics
from pathlib import Path

from common import OUT, QUICK, ROOT, fill, in_scratch, options, run_tool, table, write
from stability_map import TERMS, statics

THIN = "tests/stability/thin.cfg"
DROP = """dp = 5 mm
end_time = 0.1
gravity = 0, -9.81
[fluid drop]
shape = circle 0.2, 0.06, 0.05
max_speed = 3
velocity = 0, -2
artificial_viscosity = 0.02
[wall bed]
shape = box 0, -0.02, 0.4, 0
"""
WAVE = """dp = 10 mm
end_time = 2
gravity = 0, -9.81
[fluid water]
shape = polygon 0, 0; 1, 0; 1, 0.25; 0.75, 0.28; 0.5, 0.3; 0.25, 0.32; 0, 0.35
sound_speed = 20
artificial_viscosity = 0.002
surface = 0.35
[wall tank]
shape = polyline thickness -0.04: 0, 0.6; 0, 0; 1, 0; 1, 0.6
"""
SCENES = (
    ("gate, dp = 1 mm, 30 ms", "cases/gate.cfg", ("dp=1 mm", "end_time=30 ms")),
    ("hydrostatic plate, 20 ms", "cases/hydrostatic_plate.cfg", ("end_time=20 ms",)),
    ("template baffle", "cases/templates/baffle.cfg", ("end_time=0.4 s",)),
    ("template dam break, dp = 10 mm", "cases/templates/dam_break.cfg", ("dp=10 mm", "wall=40 mm")),
    ("standing wave", WAVE, ()),
    ("drop onto a wall, 2 m/s", DROP, ()),
    ("plate, water on both sides", THIN, ()),
    ("plate, 0.1 m against 0.05 m", THIN, ("right=0.05", "end_time=0.1")),
)
STEPS = (1, 2, 4)


def run(case, settings):
    """Whether a guard stopped a run, and its summary."""
    return in_scratch(lambda run: (run.stopped, run.summary), case if "\n" in case else ROOT / case,
                      settings)


def percent(share):
    return "-" if share is None else f"{100 * share:.2g}"


def shares(summary):
    terms = summary["drift"]["gains_by_term"]
    return [terms[name].get("gain_over_available_energy") for name in TERMS]


def scenes_table():
    rows = []
    for name, case, settings in SCENES:
        for part in STEPS:
            smaller = () if part == 1 else (f"numerics.cfl={default_cfl(case) / part:g}",)
            stopped, summary = run(case, (*settings, *smaller))
            head = (name, "1") if part == 1 else ("", f"1/{part}")
            rows.append([*head, *map(percent, shares(summary))])
            rows[-1][-1] += " (stopped)" if stopped else ""
            print(*rows[-1], flush=True)
    return table(["scene", "step over default", *TERMS], rows)


def default_cfl(case):
    """Its C: 0.4 with leapfrog, else 0.2."""
    text = case if "\n" in case else (ROOT / case).read_text(encoding="utf-8")
    return 0.2 if "scheme = paper" in text else 0.4


def grid_text():
    stopped, where, worst, left_out = 0, [], {name: [] for name in TERMS}, 0
    plates = list(itertools.product((20, 50, 100, 300, 1000, 2000, 5000, 10000), (2, 3, 5, 8),
                                    (0.05, 1, 50), ("leapfrog", "verlet")))
    for density, across, stiffness, integrator in plates:
        if statics(density / 1000, across, 2, stiffness * 0.02 * 2e9 / across**3):
            left_out += 1
            continue
        status, summary = run(THIN, (
            f"plate.density={density}", f"across={across}", f"E={stiffness}*0.02*2e9/across^3",
            f"integrator={integrator}", "right=0.05", "end_time=0.1"))
        stopped += status
        gains = {name: gain or 0 for name, gain in zip(TERMS, shares(summary))}
        largest = max(gains, key=gains.get)
        if summary["drift"]["gain_over_available_energy"] > 0.01:
            where.append(f"- {density} kg/m^3, {across} across, {stiffness:g} E, {integrator} "
                         f"({largest}, {percent(gains[largest])} %)")
        for name in TERMS:
            worst[name].append(gains[name])
    typical = [f"- {name}: {percent(statistics.median_high(found))} %, at most "
               f"{percent(max(found))} %" for name, found in worst.items()]
    return fill("energy_account_grid.md", plates=len(plates), left_out=left_out, stopped=stopped,
                others=len(plates) - left_out, above=len(where), typical="\n".join(typical),
                where="\n".join(where))


def main():
    parser = options(__doc__)
    parser.add_argument("--grid", action="store_true", help="also 192 plates between waters (ten "
                                                            "minutes)")
    parser.add_argument("--out", type=Path, default=OUT / "energy_account.md",
                        help="the document")
    args = parser.parse_args()
    write(args.out, "energy_account.md", options=" --grid" * args.grid, scenes=scenes_table(),
          grid=grid_text() if args.grid else "")


if __name__ == "__main__":
    run_tool(main)
