#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Sub-steps of the solid against a single rate: a dam break on an elastic obstacle
(tests/stability/obstacle.cfg) whose fluid step holds 1 to 2 solid steps, and the motion of the
article's cases. Keeps the results in docs/results/stability_substeps.json;
tools/report/stability_report.py puts the tables into docs/results/stability.md.

Example: tools/report/stability_substeps.py                   all rows (40 CPU-minutes)
         tools/report/stability_substeps.py --part obstacle   those of the obstacle, the others as
         they are kept"""
import argparse
import json
import math
import os
import statistics

from common import OUT, QUICK, ROOT, in_scratch, load, runfiles, table

CASE = ROOT / "tests/stability/obstacle.cfg"
RESULTS = OUT / "stability_substeps.json"
ROWS = (  # name, settings
    ("E = 1 MPa, defaults", ()),
    ("precision double", ("precision=double",)),
    ("wall_repulsion = 0.1", ("water.wall_repulsion=0.1",)),
    ("ledger 1 ms, in step with the probes", ("output.ledger_interval=1 ms",)),
    ("probes 10 ms", ("output.probe_interval=10 ms",)),
    ("E = 1.5 MPa", ("obstacle.young=1.5 MPa",)),
    ("law = svk", ("obstacle.law=svk",)),
    ("E = 0.9 MPa", ("obstacle.young=0.9 MPa",)),
    ("nu = 0.3", ("obstacle.poisson=0.3",)),
    ("probes 2 ms", ("output.probe_interval=2 ms",)),
    ("E = 4 MPa", ("obstacle.young=4 MPa",)),
)
SHORT = ("end_time=0.5 ms",) if QUICK else ()
SINGLE = "numerics.multirate=off"
# Runs that differ in round-off alone; a maximum after a splash scatters.
SKINS = (0.45, 0.5, 0.55)[:2 if QUICK else 3]
INTEGRATORS = ("symplectic", "verlet", "leapfrog")[:1 if QUICK else 3]
MOTIONS = (  # name, case, spacing and half of it, end, the direction in which M1 moves most
    ("gate", "cases/gate.cfg", ("1 mm", "0.5 mm"), "0.1 s", "dx"),
    ("hydrostatic plate", "cases/hydrostatic_plate.cfg", ("12.5 mm", "6.25 mm"), "0.05 s", "dy"),
)


def figures(run):
    """Result, largest hourglass and elastic energy, mean sub-steps, CPU seconds."""
    summary, ledger = run.summary, run.table("ledger.csv")

    def largest(name):
        return float(f"{ledger[name + '_J_per_m'].max():.4g}")
    return {"finished": summary["exit_reason"] == "finished", "time": summary["time"],
            "hourglass": largest("hourglass"), "elastic": largest("elastic"),
            "substeps": round(summary["solid_substeps"] / summary["steps"], 2),
            "seconds": round(run.seconds, 1),
            "gain": float(f"{summary['drift']['gain_over_available_energy']:.2g}")}


def motion(case, settings):
    """Displacements of M1 at the times of its probe."""
    def points(run):
        rows = run.table()
        return {round(t, 7): place for t, *place in
                zip(rows["time_s"], rows["M1_dx_m"], rows["M1_dy_m"])}
    return in_scratch(points, ROOT / case, [*settings, *SHORT])


def difference(one, other):
    """Root mean square of the distance of two motions, m."""
    times = one.keys() & other.keys()
    square = sum(math.dist(one[t], other[t])**2 for t in times) / len(times)
    return float(f"{math.sqrt(square):.3g}")


def motions():
    """What the article's cases change by a single rate, by half of dp, and by a density off by
    1e-6."""
    rows = []
    for name, case, (spacing, half), end, axis in MOTIONS[:1 if QUICK else None]:
        for integrator in INTEGRATORS:
            common = (f"integrator={integrator}", f"end_time={end}", f"dp={spacing}")
            many = motion(case, common)
            column = 0 if axis == "dx" else 1
            body = "gate" if name == "gate" else "plate"
            rows.append({
                "name": name, "dp": spacing, "integrator": integrator, "end": end,
                "largest": max(abs(at[column]) for at in many.values()),
                "single": difference(many, motion(case, (*common, SINGLE))),
                "half": difference(many, motion(case, (*common[:2], f"dp={half}"))),
                "density": difference(motion(case, (*common, f"{body}.density=1000")),
                                      motion(case, (*common, f"{body}.density=1000.001")))})
            print(rows[-1], flush=True)
    return rows


def values():
    """What the section of docs/results/stability.md says."""
    kept = load(RESULTS)
    rows, ratios = [], []
    for row in kept["obstacle"]:
        many, one = row["many"], row["single"]
        ratios.append(many["hourglass"] / one["hourglass"])
        rows.append([row["name"], "finished" if many["finished"] else f"stopped at "
                                                                      f"{many['time']:.3g} s",
                     f"{many['substeps']:.2f}", f"{100 * many['gain']:.2g} %",
                     *(f"{each['hourglass']:.3g} ± {each['scatter']:.1g}" for each in (many, one)),
                     f"{ratios[-1]:.2f}", f"{many['elastic']:.3g}", f"{many['seconds']:.1f}",
                     f"{one['seconds']:.1f}"])
    changes = [[row["name"], row["dp"], row["integrator"], row["end"],
                *(f"{1e6 * row[key]:.3g}" for key in ("largest", "single", "half", "density"))]
               for row in kept["motions"]]
    finished = sum(row["many"]["finished"] for row in kept["obstacle"])
    return {"substeps": table(["setting", "ends", "sub-steps a step", "gain", "hourglass",
                               "single rate",
                               "ratio", "elastic", "CPU-s", "single rate"], rows),
            "substeps_finish": f"{finished} of {len(rows)} finish. The hourglass energy is "
                               f"{min(ratios):.2f} to {max(ratios):.2f} times that of a single "
                               f"rate.",
            "motions": table(["case", "dp", "integrator", "until", "largest displacement",
                              "single rate",
                              "half of dp", "density"], changes)}


def mean_of(settings):
    """The runs of all skins as one: means, the scatter of the hourglass energy, the largest
    gain."""
    runs = [in_scratch(figures, CASE, (*settings, *SHORT, f"numerics.skin={skin}"))
            for skin in SKINS]
    mean = {key: float(f"{statistics.mean(each[key] for each in runs):.4g}") for key in runs[0]}
    return mean | {"finished": all(each["finished"] for each in runs),
                   "gain": max(each["gain"] for each in runs),
                   "scatter": float(f"{statistics.stdev(each['hourglass'] for each in runs):.2g}")}


def obstacle():
    rows = []
    for name, settings in ROWS[:1 if QUICK else None]:
        rows.append({"name": name, "many": mean_of(settings),
                     "single": mean_of((*settings, SINGLE))})
        print(rows[-1], flush=True)
    return rows


def save(kept):
    parts = [f'"{part}": [\n' + ",\n".join(json.dumps(row) for row in rows) + "\n]"
             for part, rows in kept.items()]
    RESULTS.write_text("{" + ",\n".join(parts) + "}\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--part", choices=("obstacle", "motions"), help="only this part (both)")
    args = parser.parse_args()
    os.nice(10)
    for part, measure in (("obstacle", obstacle), ("motions", motions)):
        if args.part in (None, part):
            save(load(RESULTS, {}) | {part: measure()})
    if load(RESULTS).keys() >= {"obstacle", "motions"}:
        print(*values().values(), sep="\n\n")


if __name__ == "__main__":
    runfiles.run_tool(main)
