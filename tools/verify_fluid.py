#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs small scenes of still water, waves, impact, openings and bodies with both schemes of the fluid and
says how far each is off (make verify-fluid, some minutes on one core).

  tools/verify_fluid.py            writes docs/fluid_verification.md
  tools/verify_fluid.py --list     says which runs there are

The scenes are cases/verify/fluid_*.cfg and the templates dam_break and baffle."""
import argparse
import csv
import math
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import runfiles  # finds the package of the clone
from sphfsi.snapshots import KINDS, Snapshots

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = os.environ.get("SPHFSI", str(ROOT / "sphfsi"))
REPORT = ROOT / "docs" / "fluid_verification.md"
SCHEMES = ("paper", "standard")
G = 9.81


class Run:
    """A finished run: its tables, its snapshots, and the seconds of processor time that it took."""

    def __init__(self, case, scheme, settings, folder):
        self.folder = folder
        command = [PROGRAM, str(case), "--quiet", "--threads", "1", "--out", str(folder),
                   "--set", f"scheme={scheme}"]
        for setting in settings:
            command += ["--set", setting]
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        self.finished = done.returncode == 0
        if done.returncode not in (0, 2):
            sys.exit(f"verify_fluid: {' '.join(command)}: {done.stderr.strip()}")

    def table(self, name):
        with open(self.folder / name, encoding="utf-8") as file:
            rows = list(csv.reader(file))
        return {column: np.array([float(row[k] or "nan") for row in rows[1:]])
                for k, column in enumerate(rows[0])}


def nearest_of(points, others, reach):
    """Distance of each point to the nearest of the others, or `reach` where none is nearer."""
    cells = {}
    for k, key in enumerate(map(tuple, np.floor(others / reach).astype(int))):
        cells.setdefault(key, []).append(k)
    out = np.full(len(points), reach)
    for i, (cx, cy) in enumerate(np.floor(points / reach).astype(int)):
        near = [k for dx in (-1, 0, 1) for dy in (-1, 0, 1)
                for k in cells.get((cx + dx, cy + dy), ())]
        if near:
            out[i] = min(reach, np.sqrt(((others[near] - points[i]) ** 2).sum(axis=1).min()))
    return out


def entered(run, dp):
    """Particle-snapshots within half a spacing of a wall's or body's particle; the least distance, in dp."""
    shots = Snapshots(run.folder / "fields.vtkhdf")
    count, least = 0, 1.0
    for step in range(len(shots.times)):
        x, kind = shots.load(step, "Points")[:, :2], shots.load(step, "kind")
        distance = nearest_of(x[kind == KINDS["fluid"]], x[kind != KINDS["fluid"]], dp) / dp
        count += int((distance < 0.5).sum())
        least = min(least, float(distance.min()))
    return count, least


def measure_rest(run, _):
    """Pressure errors of three places and level, means of the last tenth, in % of rho g H and H; change since
    half of the run; the fastest that a particle goes, in mean, over sqrt(gH)."""
    p, ledger, H = run.table("probes.csv"), run.table("ledger.csv"), 0.2
    def mean(column, end):
        n = len(p[column])
        return p[column][int(n * (end - 0.1)):int(n * end)].mean()
    places = (("foot_p_Pa", 0.04), ("crest_p_Pa", 0.12), ("corner_p_Pa", 0.1))
    off = [100 * (mean(c, 1) / (1000 * G * H) - (H - y) / H) for c, y in places]
    drift = max(abs(100 * (mean(c, 1) - mean(c, 0.5)) / (1000 * G * H)) for c, _ in places)
    level = [c for c in p if c.startswith("level")][0]
    speed = math.sqrt(2 * ledger["kinetic_J_per_m"][-1] / ledger["mass_kg_per_m"][-1] / (G * H))
    return [("largest pressure error, % of rho g H", max(off, key=abs), 1),
            ("its change from 10 to 20 s, % of rho g H", drift, 0.1),
            ("level, % of H", 100 * (mean(level, 1) / H - 1), 0.1),
            ("RMS speed at the end, 1e-3 sqrt(gH)", 1e3 * speed, 1)]


def measure_wave(run, _):
    """The kinetic energy is greatest twice a period: parabolas through its maxima give period and decay."""
    H, k = 0.3, 2 * math.pi / 0.9
    period = 2 * math.pi / math.sqrt(G * k * math.tanh(k * H))
    ledger = run.table("ledger.csv")
    t, kinetic = ledger["time_s"], ledger["kinetic_J_per_m"]
    at, top = [0.0], [kinetic[0]]
    while True:
        guess = at[-1] + (at[-1] - at[-2] if len(at) > 1 else period / 2)
        if guess + 0.17 * period > t[-1]:
            break
        near = abs(t - guess) < 0.17 * period
        c = np.polyfit(t[near] - guess, kinetic[near], 2)
        at.append(guess - c[1] / (2 * c[0]))
        top.append(np.polyval(c, -c[1] / (2 * c[0])))
    n = np.arange(2, len(at))
    found = 2 * np.polyfit(n, at[2:], 1)[0]
    decay = np.polyfit(n / 2, np.log(top[2:]), 1)[0] / 2
    return [("frequency, % too high", 100 * (period / found - 1), 1),
            ("loss of amplitude a period, %", 100 * (1 - math.exp(decay)), 2)]


def measure_impact(run, dp):
    p = run.table("probes.csv")
    t, q = p["time_s"], p["wall_p_Pa"] / (1000 * G * 0.6)
    mean = np.convolve(q, np.ones(21) / 21, "same")
    plateau = (t > 0.85) & (t < 1.25)
    count, least = entered(run, dp)
    noise = float(np.std((q - mean)[plateau]))
    return [("deviation from the 20 ms mean in the plateau, rho g H", noise, 0.05),
            ("mean of the plateau, rho g H", float(q[plateau].mean()), None),
            ("particles that have entered, by snapshots", count, 0), ("nearest to a body, dp", least, None)]


def measure_opening(run, _):
    p = run.table("probes.csv")
    flux = [c for c in p if c.startswith("out")][0]
    return [("water let through in 0.4 s, 1e-3 m^2", 1e3 * float(np.trapezoid(p[flux], p["time_s"])), None)]


def measure_dam_break(run, dp):
    count, least = entered(run, dp)
    return [("particles that have entered, by snapshots", count, 0), ("nearest to a body, dp", least, None)]


def measure_baffle(run, dp):
    p = run.table("probes.csv")
    count, least = entered(run, dp)
    return [("largest tip displacement, mm", 1e3 * float(abs(p["tip_dx_m"]).max()), None),
            ("largest vertical load, N/m", float(abs(p["load_fy_N_per_m"]).max()), None),
            ("particles that have entered, by snapshots", count, 0), ("nearest to a body, dp", least, None)]


# (scene, what it is called, settings, dp, how it is measured)
RUNS = [
    ("fluid_rest", "still water, hump and post, H/dp = 20, 20 s", [], 0.01, measure_rest),
    ("fluid_wave", "standing wave, H/dp = 10", ["constants.ratio=10"], 0.03, measure_wave),
    ("fluid_wave", "standing wave, H/dp = 20", ["constants.ratio=20"], 0.015, measure_wave),
    ("fluid_wave", "standing wave, H/dp = 40", ["constants.ratio=40"], 0.0075, measure_wave),
    ("fluid_impact", "impact on a wall, H/dp = 40", ["constants.ratio=40"], 0.015, measure_impact),
    ("fluid_impact", "impact on a wall, H/dp = 60", ["constants.ratio=60"], 0.01, measure_impact),
    ("fluid_opening", "opening of 4 dp", ["constants.across=4"], 0.01, measure_opening),
    ("fluid_opening", "opening of 16 dp", ["constants.across=16"], 0.0025, measure_opening),
    ("dam_break", "template dam_break, dp = 5 mm", [], 0.005, measure_dam_break),
    ("baffle", "template baffle, dp = 4 mm", [], 0.004, measure_baffle),
    ("baffle", "template baffle, dp = 2 mm", ["dp=2 mm"], 0.002, measure_baffle),
]


def case_of(scene, folder):
    path = ROOT / "cases" / "verify" / f"{scene}.cfg"
    if path.is_file():
        return path
    path = Path(folder) / f"{scene}.cfg"
    text = subprocess.run([PROGRAM, "--new", scene], capture_output=True, text=True, check=True).stdout
    path.write_text(text, encoding="utf-8")
    return path


def number(value):
    return str(value) if isinstance(value, int) else f"{value:.3g}"


def answer(rows):
    """The first paragraph: which limits the standard scheme keeps."""
    kept = [r for r in rows if r["limit"] is not None and r["standard_kept"]]
    missed = [r for r in rows if r["limit"] is not None and not r["standard_kept"]]
    text = f"The standard scheme keeps {len(kept)} of {len(kept) + len(missed)} limits; " \
           f"the paper's keeps {sum(r['paper_kept'] for r in kept + missed)}."
    if missed:
        text += " It misses: " + "; ".join(
            f"{r['scene']}, {r['what']} ({number(r['standard'])}, limit {number(r['limit'])})"
            for r in missed) + "."
    return text


def report(rows, seconds, version):
    lines = ["# Verification of the fluid", "", answer(rows), "",
             "Written by `make verify-fluid`; do not edit. " + version + " One thread. The scenes are "
             "`cases/verify/fluid_*.cfg` and two templates, each with `scheme = paper` and `standard`; "
             "`tools/verify_fluid.py` says how each figure is measured. A limit in brackets is missed.", "",
             "| scene | figure | limit | paper | standard |", "|---|---|---|---|---|"]
    for r in rows:
        cells = [number(r[s]) if r["limit"] is None or r[s + "_kept"] else f"({number(r[s])})"
                 for s in SCHEMES]
        limit = "" if r["limit"] is None else number(r["limit"])
        lines.append(f"| {r['scene']} | {r['what']} | {limit} | {cells[0]} | {cells[1]} |")
    lines += ["", "Processor time, s, on a machine with other work:", "", "| scene | paper | standard |",
              "|---|---|---|"]
    lines += [f"| {name} | {s['paper']:.1f} | {s['standard']:.1f} |" for name, s in seconds.items()]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--list", action="store_true", help="say which runs there are")
    parser.add_argument("--only", default="", help="part of a scene's name; writes no report")
    chosen = parser.parse_args()
    rows, seconds = [], {}
    for scene, name, settings, dp, measure in RUNS:
        if chosen.list:
            print(name)
        if chosen.list or chosen.only not in name:
            continue
        found, seconds[name] = {}, {}
        for scheme in SCHEMES:
            with tempfile.TemporaryDirectory() as folder:
                run = Run(case_of(scene, folder), scheme, settings, Path(folder) / "run")
                found[scheme] = measure(run, dp)
                seconds[name][scheme] = run.seconds
        for k, (what, _, limit) in enumerate(found["paper"]):
            row = {"scene": name, "what": what, "limit": limit}
            for scheme in SCHEMES:
                row[scheme] = found[scheme][k][1]
                row[scheme + "_kept"] = limit is None or abs(row[scheme]) <= limit
            rows.append(row)
            print(name, what, number(row["paper"]), number(row["standard"]), flush=True)
    if rows and not chosen.only:
        version = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, check=True)
        REPORT.write_text(report(rows, seconds, version.stdout.splitlines()[0] + "."), encoding="utf-8")


if __name__ == "__main__":
    main()
