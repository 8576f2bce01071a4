#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Sub-steps of the solid against a single rate: a dam break on an elastic obstacle
(tests/stability/obstacle.cfg) whose fluid step holds 1 to 2 solid steps. Keeps the results in
docs/stability_substeps.json; tools/stability_report.py puts the table into docs/stability.md.

Example: tools/stability_substeps.py     all rows (10 CPU-minutes)"""
import argparse
import csv
import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
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


def table():
    """Section for docs/stability.md."""
    rows = json.loads(RESULTS.read_text(encoding="utf-8"))["rows"]
    text = """## Sub-steps against a single rate

A dam break on an elastic obstacle (`tests/stability/obstacle.cfg`, by `tools/stability_substeps.py`). One
step of the fluid holds between one and two of the solid's limits. A count that alternates drives a
checkerboard mode of the solid. Its mark is the hourglass energy, given here at its largest, in J/m.

| setting | ends | sub-steps a step | gain | hourglass | single rate | ratio | elastic | CPU-s | single rate |
|---|---|---|---|---|---|---|---|---|---|
"""
    for row in rows:
        many, one = row["many"], row["single"]
        ends = "finished" if many["finished"] else f"stopped at {many['time']:.3g} s"
        text += (f"| {row['name']} | {ends} | {many['substeps']:.2f} | {100 * many['gain']:.2g} % | "
                 f"{many['hourglass']:.3g} | {one['hourglass']:.3g} | "
                 f"{many['hourglass'] / one['hourglass']:.2f} | {many['elastic']:.3g} | "
                 f"{many['seconds']:.1f} | {one['seconds']:.1f} |\n")
    ratios = [row["many"]["hourglass"] / row["single"]["hourglass"] for row in rows]
    finished = sum(row["many"]["finished"] for row in rows)
    return text + (f"\n{finished} of {len(rows)} finish. The hourglass energy is {min(ratios):.2f} to "
                   f"{max(ratios):.2f} times that of a single rate.\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.parse_args()
    program = Path(os.environ.get("SPHFSI", str(ROOT / "sphfsi"))).resolve()
    os.nice(10)
    rows = []
    for name, settings in ROWS:
        rows.append({"name": name, "many": run(program, settings),
                     "single": run(program, (*settings, SINGLE))})
        print(rows[-1], flush=True)
    lines = ",\n".join(json.dumps(row) for row in rows)
    RESULTS.write_text(f'{{"rows": [\n{lines}\n]}}\n', encoding="utf-8")
    print(table())
    return 0


if __name__ == "__main__":
    sys.exit(main())
