#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes docs/results/energy_account.md: what the account of energy (docs/theory.md, T-46) finds in
scenes of every kind, with the default step and smaller ones. make stability-map has plates."""
from pathlib import Path

from common import OUT, QUICK, ROOT, in_scratch, options, run_tool, table, write
from stability_map import TERMS

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
    for name, case, settings in SCENES[5:6] if QUICK else SCENES:
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


def main():
    parser = options(__doc__)
    parser.add_argument("--out", type=Path, default=OUT / "energy_account.md",
                        help="the document")
    args = parser.parse_args()
    write(args.out, "energy_account.md", scenes=scenes_table())


if __name__ == "__main__":
    run_tool(main)
