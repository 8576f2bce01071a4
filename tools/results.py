#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the elastic gate and the cantilever in several forms and writes docs/results.md.

Runs that have finished already are not repeated (remove their folder below runs/results to do so).
Example: tools/results.py --threads 2
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

from runfiles import BadFile, read_table, run_tool

ROOT = Path(__file__).resolve().parent.parent
RUNS = ROOT / "runs" / "results"
IMAGES = ROOT / "docs" / "img"
PRINTED = {"gradient": "linear", "hourglass_form": "printed"}

# name, case, --set arguments, what is different about it
GATE = [
    ("gate", ["integrator=symplectic"], "dp = 0.5 mm, symplectic"),
    ("gate-verlet", ["integrator=verlet"], "dp = 0.5 mm, Verlet"),
    ("gate-1mm", ["dp=1 mm"], "dp = 1 mm, symplectic"),
    ("gate-1mm-verlet", ["dp=1 mm", "integrator=verlet"], "dp = 1 mm, Verlet"),
    ("gate-1mm-single-verlet", ["dp=1 mm", "numerics.multirate=off", "integrator=verlet"],
     "dp = 1 mm, Verlet, no sub-steps: the step of both media is the solid's"),
    ("gate-1mm-printed", ["dp=1 mm"] + [f"gate.{k}={v}" for k, v in PRINTED.items()],
     "dp = 1 mm, symplectic, Eqs. 13 and 17 as printed"),
    ("gate-1mm-plane-stress", ["dp=1 mm", "integrator=verlet", "gate.plane=stress"],
     "dp = 1 mm, Verlet, plane stress"),
]
CANTILEVER = [(f"cantilever-{ratio}{tail}", [f"ratio={ratio}"] + sets, f"ts/dp = {ratio}{words}")
              for ratio in (10, 20)
              for tail, sets, words in (
                  ("", [], ""),
                  ("-printed", [f"plate.{k}={v}" for k, v in PRINTED.items()],
                   ", Eqs. 13 and 17 as printed"))]
PERIOD, AMPLITUDE = 0.25515, 0.02302  # linear 2-D plane-strain elasticity, converged FE


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--threads", type=int, default=0, help="threads of each run (all)")
    parser.add_argument("--only", default="", help="only runs whose name begins like this")
    return parser.parse_args()


def summary_of(run):
    try:
        return json.loads((run / "summary.json").read_text())
    except (OSError, ValueError):
        return {}


def simulate(name, case, sets, threads):
    """Runs a case unless its folder holds a finished run; its folder."""
    run = RUNS / name
    if summary_of(run).get("exit_reason") == "finished":
        return run
    command = [str(ROOT / "sphfsi"), str(ROOT / "cases" / case), "--out", str(run), "--quiet"]
    command += ["--restart"] if list(run.glob("*.ckpt")) else []
    command += ["--threads", str(threads)] if threads else []
    for item in sets:
        command += ["--set", item]
    print(" ".join(command[1:]), flush=True)
    if subprocess.run(command, check=False).returncode:
        print(f"{name}: the run failed", file=sys.stderr)
    return run


def cost(summary):
    seconds = summary["wall_seconds"]
    return (f"{summary['steps']:,} | {summary['solid_substeps']:,} | {seconds:.0f} "
            f"({summary['threads']})")


def gate_row(run, words, measured):
    """One row of the gate's table, or a row that says why there is none."""
    summary = summary_of(run)
    if summary.get("exit_reason") != "finished":
        return f"| {words} | {summary.get('message') or 'did not finish'} | | | | | | |"
    table, _ = read_table(run / "probes.csv")
    time, dx = table["time_s"], 1e3 * table["M1_dx_m"]
    top = int(np.argmax(dx))
    difference = np.interp(measured["time_s"], time, dx) - 1e3 * measured["value"]
    return (f"| {words} | {dx[top]:.1f} | {time[top]:.3f} | {np.interp(0.36, time, dx):.1f} | "
            f"{np.sqrt(np.mean(difference**2)):.1f} | {cost(summary)} |")


def cantilever_row(run, words):
    summary = summary_of(run)
    if summary.get("exit_reason") != "finished":
        return f"| {words} | {summary.get('message') or 'did not finish'} | | | | | | |"
    table, _ = read_table(run / "probes.csv")
    time, dy = table["time_s"], table["M1_dy_m"]
    turns = np.flatnonzero(dy[1:-1] * dy[2:] < 0) + 1
    zeros = time[turns] + (time[turns + 1] - time[turns]) * dy[turns] / (dy[turns] - dy[turns + 1])
    late = np.max(np.abs(dy[time > 0.75 * time[-1]]))
    return (f"| {words} | {zeros[1]:.4f} | {100 * (zeros[1] / PERIOD - 1):+.2f} | {1e3 * late:.2f} | "
            f"{100 * (late / AMPLITUDE - 1):+.1f} | {cost(summary)} |")


def draw(tool, runs, image, *options):
    command = [sys.executable, str(ROOT / "tools" / tool), *map(str, runs), "--out", str(image), *options]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def draw_all():
    IMAGES.mkdir(parents=True, exist_ok=True)
    draw("plot_m1.py", [RUNS / name for name in ("gate", "gate-verlet", "gate-1mm", "gate-1mm-plane-stress")],
         IMAGES / "gate_m1.png")
    draw("plot_fields.py", [RUNS / "gate", RUNS / "gate-verlet"], IMAGES / "gate_both.png",
         "--time", "0.08", "0.16", "0.36", "--window", "-0.01", "0.35", "-0.01", "0.165")
    draw("plot_fields.py", [RUNS / "gate"], IMAGES / "gate_fields.png",
         "--time", "0.08", "0.2", "--window", "-0.01", "0.35", "-0.01", "0.165")
    draw("plot_ledger.py", [RUNS / "gate"], IMAGES / "gate_ledger.png")


REPORT = """# Results

Written by `make results` (`tools/results.py`); nothing here is typed by hand. Program {version}, {machine}.
Seconds are the clock's, whatever else the machine was doing; `make bench` measures speed.

## Elastic gate (Sec. 3.3)

Horizontal displacement of the free end. Measured (Antoci et al. 2007): peak 46.4 mm at 0.16 s, 37.3 mm at
0.36 s; RMS is over its nine points. Plane strain and hourglass coefficient 50, as in the paper, unless said
otherwise.

| run | peak (mm) | at (s) | at 0.36 s (mm) | RMS (mm) | fluid steps | solid steps | seconds (threads) |
|---|---|---|---|---|---|---|---|
{gate}

![Displacement of M1](img/gate_m1.png)

Pressure and von Mises stress, symplectic (left) and Verlet (right):

![Fields of both integrators](img/gate_both.png)

![Energies](img/gate_ledger.png)

## Cantilever (Sec. 3.1)

First period and amplitude of the last quarter of 1 s, against linear two-dimensional elasticity ({period} s,
{amplitude:.2f} mm).

| run | period (s) | error (%) | amplitude (mm) | error (%) | steps | solid steps | seconds (threads) |
|---|---|---|---|---|---|---|---|
{cantilever}
"""


def machine():
    for line in Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []:
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return "unknown processor"


def main():
    args = arguments()
    measured, _ = read_table(ROOT / "cases" / "reference" / "gate_antoci_2007_x.csv")
    chosen = [row for row in GATE + CANTILEVER if row[0].startswith(args.only)]
    for name, sets, _ in chosen:
        simulate(name, name.split("-")[0] + ".cfg", sets, args.threads)
    if len(chosen) < len(GATE + CANTILEVER):
        return 0
    if not summary_of(RUNS / "gate"):
        raise BadFile(f"{RUNS / 'gate'} holds no run to report on")
    draw_all()
    text = REPORT.format(
        version=summary_of(RUNS / "gate")["version"], machine=machine(), period=PERIOD,
        amplitude=1e3 * AMPLITUDE,
        gate="\n".join(gate_row(RUNS / name, words, measured) for name, _, words in GATE),
        cantilever="\n".join(cantilever_row(RUNS / name, words) for name, _, words in CANTILEVER))
    (ROOT / "docs" / "results.md").write_text(text)
    print("written docs/results.md")
    return 0


if __name__ == "__main__":
    run_tool(main)
