#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures the cost of the program and writes bench/<processor>.csv and docs/performance.md.

All times are user time of one thread, which other work on the machine changes little, in medians of
interleaved runs. --bench runs the bench alone, says what has changed against the file there was,
and writes it anew. QUICK=1: short runs, once each."""

import csv
import os
import re
import shutil
import statistics
import subprocess
import tempfile
from datetime import date
from pathlib import Path

from common import (OUT, QUICK, ROOT, CaseRun, in_scratch, machine, options, program_version,
                    run_tool, table, write)

# As the Makefile says where another build folder is measured (B=...).
BUILD = Path(os.environ.get("BUILD") or ROOT / "build/release").resolve()
REPORT = OUT / "performance.md" if QUICK else ROOT / "docs" / "performance.md"
# Arithmetic of a pack of pairs in today's loop with viscosity and diffusion, sums of both sides;
# and of a solid's pair in the default form, its three loops together, displacements in two parts.
# Counted in the source.
OPERATIONS, SOLID_OPERATIONS = 45, 56
# words, case below cases/, settings, end (s)
WORK = [
    ("gate, dp = 1 mm", "gate", ["dp=1 mm"], 0.03),
    ("the same, scheme = standard", "gate", ["dp=1 mm", "scheme=standard"], 0.03),
    ("gate, dp = 0.5 mm", "gate", [], 0.005),
    ("cantilever, 10 across", "cantilever", ["ratio=10"], 0.3),
    ("cantilever, 20 across", "cantilever", ["ratio=20"], 0.05),
    ("hydrostatic plate, dp = 12.5 mm", "hydrostatic_plate", ["dp=12.5 mm"], 0.02),
    ("template dam_break", "templates/dam_break", [], 0.2),
    ("template baffle", "templates/baffle", [], 0.2),
    ("Turek-Hron FSI2, 10 across", "turek_hron/fsi2", ["across=10"], 0.1),
]


def run_bench(reps, large):
    """What the two programs print: comment lines, and rows of a table."""
    def ask(name, *more):
        return subprocess.run([str(BUILD / name), "--reps", str(reps), *more], check=True,
                              text=True, capture_output=True).stdout
    return ask("bench_bench", *["--large"] * large) + ask("bench_neighbours")


def parse(text):
    """Comment lines, and medians by (what, variant, particles, threads, part)."""
    lines = text.splitlines()
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return [line[2:] for line in lines if line.startswith("#")], {
        (row["what"], row["variant"], int(row["particles"]), int(row["threads"]), row["part"]):
        float(row["median"]) for row in rows}


def compare(rows, path):
    before = parse(path.read_text())[1] if path.exists() else {}
    for key, new in rows.items():
        if before.get(key):
            print(f"{' '.join(map(str, key)):60s} {before[key]:10.4g} -> {new:10.4g} "
                  f"{100 * (new / before[key] - 1):+6.1f} %")


def sweep_rows(rows):
    """ns per fluid particle and evaluation on one thread, of the smallest and largest scene."""
    parts = ["sort", "packed", "wall", "fluid", "update", "all", "memory"]
    scenes = dict.fromkeys(key[1:3] for key in rows if key[0] == "fluid")
    sizes = [n for _, n in scenes]
    for variant, n in (scene for scene in scenes if scene[1] in (min(sizes), max(sizes))):
        yield [variant, n, *(f"{rows.get(('fluid', variant, n, 1, part), float('nan')):.1f}"
                             for part in parts)]


def limits(rows):
    """Shares of the arithmetic limit: of the pair loop of the largest scene, of the solid."""
    peak = rows["machine", "fma", 0, 1, "float"]
    variant = [key[1] for key in rows if key[4] == "pairs" and "(mixed)" in key[1]][-1]
    n = max(key[2] for key in rows if key[1] == variant)
    of = {part: rows["fluid", variant, n, 1, part] for part in ("pairs", "fluid")}
    solid = {key[4]: value for key, value in rows.items()
             if key[:2] == ("solid", "default (mixed)") and key[3] == 1}
    return {"peak": peak, "fluid_share": 100 * of["pairs"] * OPERATIONS / of["fluid"] / peak,
            "solid_share": 100 * solid["slots"] * SOLID_OPERATIONS / solid["step"] / peak,
            "solid_ns": solid["step"]}


def per_step(run):
    """ms of user time a step, particles, and what a particle costs in ns."""
    particles = sum(run.summary["particles"][kind] for kind in ("fluid", "solid"))
    steps = max(run.summary["steps"], run.summary["solid_substeps"]) \
        if not run.summary["particles"]["fluid"] else run.summary["steps"]
    return {"seconds": run.seconds, "steps": steps, "substeps": run.summary["solid_substeps"],
            "particles": particles, "ms": 1e3 * run.seconds / steps,
            "a_second": run.seconds / run.summary["time"]}


def work_rows(repeats):
    rounds = [[in_scratch(per_step, ROOT / "cases" / f"{case}.cfg", sets, "--until",
                          str(0.02 * end if QUICK else end)) for _, case, sets, end in WORK]
              for _ in range(repeats)]
    for (words, *_), found in zip(WORK, zip(*rounds)):
        one = found[0]
        middle = {key: statistics.median(each[key] for each in found)
                  for key in ("seconds", "ms", "a_second")}
        yield [words, one["particles"], one["steps"], one["substeps"], f"{middle['seconds']:.2f}",
               f"{middle['ms']:.3g}", f"{1e6 * middle['ms'] / one['particles']:.0f}",
               f"{middle['a_second']:.3g}"]


def real_gate(repeats):
    """ns a fluid particle and step of the gate at 1 mm from 0.19 to 0.21 s, where its water has
    lost the order of the lattice."""
    start, end = (0.002, 0.003) if QUICK else (0.19, 0.21)
    with tempfile.TemporaryDirectory() as folder:
        sets = ["dp=1 mm", f"output.checkpoint_interval={start}"]
        before = CaseRun(ROOT / "cases" / "gate.cfg", sets, f"{folder}/run", "--until", str(start))
        found = []
        for k in range(repeats):
            shutil.copytree(before.folder, f"{folder}/run{k}")
            after = CaseRun(ROOT / "cases" / "gate.cfg", sets, f"{folder}/run{k}", "--restart",
                            "--until", str(end))
            found.append(after.seconds / (after.summary["steps"] - before.summary["steps"]))
    return 1e9 * statistics.median(found) / after.summary["particles"]["fluid"]


def main():
    parser = options(__doc__)
    parser.add_argument("--bench", action="store_true", help="the bench only")
    parser.add_argument("--reps", type=int, default=1 if QUICK else 5, help="repetitions, of which "
                        "the median counts (%(default)s)")
    args = parser.parse_args()
    text = run_bench(args.reps, large=not (QUICK or args.bench))
    processor = parse(text)[0][0].split(",")[0].lower()
    name = re.sub(r"[^a-z0-9]+", "-", processor).strip("-")
    path = (OUT if QUICK else ROOT / "bench") / f"{name}.csv"
    compare(parse(text)[1], path)
    path.write_text(text)
    if args.bench:
        return
    notes, rows = parse(text)
    repeats = 1 if QUICK else args.reps
    write(REPORT, "performance.md", version=program_version(), date=date.today(),
          processor=machine(), bench=notes[0], load=os.getloadavg()[0], file=path.name,
          gate=real_gate(repeats),
          sweeps=table(["kernel", "particles", "sort", "packed", "wall", "fluid", "update", "all",
                        "bytes"], sweep_rows(rows)),
          work=table(["work", "particles", "steps", "solid steps", "CPU s", "ms a step",
                      "ns a particle and step", "CPU s a simulated s"], work_rows(repeats)),
          **limits(rows))


if __name__ == "__main__":
    run_tool(main)
