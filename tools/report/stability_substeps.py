#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Sub-steps of the solid against a single rate: a dam break on an elastic obstacle
(tests/stability/obstacle.cfg) whose fluid step holds 1 to 2 solid steps, and the motion of the article's
cases. Keeps the results in docs/stability_substeps.json; tools/report/stability_report.py puts the tables into
docs/stability.md.

Example: tools/report/stability_substeps.py                   all rows (40 CPU-minutes)
         tools/report/stability_substeps.py --part obstacle   those of the obstacle, the others as they are kept"""
import argparse
import csv
import json
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CASE = ROOT / "tests/stability/obstacle.cfg"
RESULTS = ROOT / "docs/stability_substeps.json"
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
SINGLE = "numerics.multirate=off"
SKINS = (0.45, 0.5, 0.55)  # runs that differ in round-off alone; a maximum after a splash scatters
INTEGRATORS = ("symplectic", "verlet", "leapfrog")
MOTIONS = (  # name, case, spacing and half of it, end, the direction in which M1 moves most
    ("gate", "cases/gate.cfg", ("1 mm", "0.5 mm"), "0.1 s", "dx"),
    ("hydrostatic plate", "cases/hydrostatic_plate.cfg", ("12.5 mm", "6.25 mm"), "0.05 s", "dy"),
)


def run(program, settings):
    """Result, largest hourglass and elastic energy, mean sub-steps, CPU seconds."""
    with tempfile.TemporaryDirectory() as folder:
        command = [str(program), str(CASE), "--quiet", "--threads", "1", "--out", f"{folder}/run"]
        for setting in settings:
            command += ["--set", setting]
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        subprocess.run(command, capture_output=True, check=False)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        summary = json.loads(Path(folder, "run/summary.json").read_text(encoding="utf-8"))
        with open(f"{folder}/run/ledger.csv", encoding="utf-8") as file:
            ledger = list(csv.DictReader(file))

    def largest(name):
        return float(f"{max(float(line[name + '_J_per_m']) for line in ledger):.4g}")

    return {"finished": summary["exit_reason"] == "finished", "time": summary["time"],
            "hourglass": largest("hourglass"), "elastic": largest("elastic"),
            "substeps": round(summary["solid_substeps"] / summary["steps"], 2), "seconds": round(seconds, 1),
            "gain": float(f"{summary['drift']['gain_over_available_energy']:.2g}")}


def motion(program, case, settings):
    """Displacements of M1 at the times of its probe."""
    with tempfile.TemporaryDirectory() as folder:
        command = [str(program), str(ROOT / case), "--quiet", "--threads", "1", "--out", f"{folder}/run"]
        for setting in settings:
            command += ["--set", setting]
        subprocess.run(command, capture_output=True, check=True)
        with open(f"{folder}/run/probes.csv", encoding="utf-8") as file:
            return {round(float(line["time_s"]), 7): (float(line["M1_dx_m"]), float(line["M1_dy_m"]))
                    for line in csv.DictReader(file)}


def difference(one, other):
    """Root mean square of the distance of two motions, m."""
    times = one.keys() & other.keys()
    return float(f"{math.sqrt(sum(math.dist(one[t], other[t])**2 for t in times) / len(times)):.3g}")


def motions(program):
    """What the article's cases change by a single rate, by half of dp, and by a density off by 1e-6."""
    rows = []
    for name, case, (spacing, half), end, axis in MOTIONS:
        for integrator in INTEGRATORS:
            common = (f"integrator={integrator}", f"end_time={end}", f"dp={spacing}")
            many = motion(program, case, common)
            column = 0 if axis == "dx" else 1
            body = "gate" if name == "gate" else "plate"
            rows.append({
                "name": name, "dp": spacing, "integrator": integrator, "end": end,
                "largest": max(abs(at[column]) for at in many.values()),
                "single": difference(many, motion(program, case, (*common, SINGLE))),
                "half": difference(many, motion(program, case, (*common[:2], f"dp={half}"))),
                "density": difference(motion(program, case, (*common, f"{body}.density=1000")),
                                      motion(program, case, (*common, f"{body}.density=1000.001")))})
            print(rows[-1], flush=True)
    return rows


def table():
    """Section for docs/stability.md."""
    kept = load()
    rows = kept["obstacle"]
    text = """## Sub-steps against a single rate

A dam break on an elastic obstacle (`tests/stability/obstacle.cfg`, by `tools/report/stability_substeps.py`). One
step of the fluid holds between one and two of the solid's limits. A count that alternates drives a
checkerboard mode of the solid. Its mark is the hourglass energy, given here at its largest, in J/m. Means of
three runs that differ in round-off alone, with their standard deviation; of the gain the largest.

| setting | ends | sub-steps a step | gain | hourglass | single rate | ratio | elastic | CPU-s | single rate |
|---|---|---|---|---|---|---|---|---|---|
"""
    for row in rows:
        many, one = row["many"], row["single"]
        ends = "finished" if many["finished"] else f"stopped at {many['time']:.3g} s"
        text += (f"| {row['name']} | {ends} | {many['substeps']:.2f} | {100 * many['gain']:.2g} % | "
                 f"{many['hourglass']:.3g} ± {many['scatter']:.1g} | "
                 f"{one['hourglass']:.3g} ± {one['scatter']:.1g} | "
                 f"{many['hourglass'] / one['hourglass']:.2f} | {many['elastic']:.3g} | "
                 f"{many['seconds']:.1f} | {one['seconds']:.1f} |\n")
    ratios = [row["many"]["hourglass"] / row["single"]["hourglass"] for row in rows]
    finished = sum(row["many"]["finished"] for row in rows)
    text += (f"\n{finished} of {len(rows)} finish. The hourglass energy is {min(ratios):.2f} to "
             f"{max(ratios):.2f} times that of a single rate.\n")
    text += """
Changes of the motion of M1 in the article's cases, root mean square, in um. The last columns are a single
rate, half of dp, and a body of 1000.001 instead of 1000 kg/m^3, which is the density of water.

| case | dp | integrator | until | largest displacement | single rate | half of dp | density |
|---|---|---|---|---|---|---|---|
"""
    for row in kept["motions"]:
        text += (f"| {row['name']} | {row['dp']} | {row['integrator']} | {row['end']} | "
                 + " | ".join(f"{1e6 * row[key]:.3g}" for key in ("largest", "single", "half", "density"))
                 + " |\n")
    text += """
The gate splashes by then, and spray amplifies the last digits of the start (dated note
[2026-11-24](notes/2026-11-24-interface.md)). Without spray the change is below 1e-6 of the displacement
(`tests/stability/test_density.py`).
"""
    return text


def mean_of(program, settings):
    """The runs of all skins as one: means, the scatter of the hourglass energy, the largest gain."""
    runs = [run(program, (*settings, f"numerics.skin={skin}")) for skin in SKINS]
    mean = {key: float(f"{statistics.mean(each[key] for each in runs):.4g}") for key in runs[0]}
    return mean | {"finished": all(each["finished"] for each in runs),
                   "gain": max(each["gain"] for each in runs),
                   "scatter": float(f"{statistics.stdev(each['hourglass'] for each in runs):.2g}")}


def obstacle(program):
    rows = []
    for name, settings in ROWS:
        rows.append({"name": name, "many": mean_of(program, settings),
                     "single": mean_of(program, (*settings, SINGLE))})
        print(rows[-1], flush=True)
    return rows


def load():
    return json.loads(RESULTS.read_text(encoding="utf-8"))


def save(kept):
    parts = [f'"{part}": [\n' + ",\n".join(json.dumps(row) for row in rows) + "\n]"
             for part, rows in kept.items()]
    RESULTS.write_text("{" + ",\n".join(parts) + "}\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--part", choices=("obstacle", "motions"), help="only this part (both)")
    args = parser.parse_args()
    program = Path(os.environ.get("SPHFSI", str(ROOT / "sphfsi"))).resolve()
    os.nice(10)
    for part, measure in (("obstacle", obstacle), ("motions", motions)):
        if args.part in (None, part):
            save(load() | {part: measure(program)})
    print(table())
    return 0


if __name__ == "__main__":
    sys.exit(main())
