#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the three charts of the README from results that are committed.

    tools/report/glance.py                    draws docs/img/glance_{accuracy,stability,effects}.png
    tools/report/glance.py --measure          first measures the cost of the gate as effects are
    added (two minutes)
"""
import argparse
import csv
import json
import re
import statistics
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = Path(__file__).resolve().parents[2]
IMG = ROOT / "docs" / "img"
EFFECTS = ROOT / "docs" / "effects.csv"
# case of the accuracy study: its name, its main error, what the error is measured against
MAIN_ERROR = {
    "cantilever": ("cantilever, period", "period", "exact"),
    "elastica": ("bending, tip", "tip, in lengths", "exact"),
    "plate": ("hydrostatic plate, deflection", "settled deflection", "exact"),
    "still": ("still water, pressure", "pressure (L2)", "exact"),
    "wave": ("standing wave, period", "period", "exact"),
    "impact": ("impact, noise of the pressure", "noise of the pressure", "exact"),
    "dam": ("dam break, front", "front", "experiment"),
    "gate": ("elastic gate, motion", "tip motion (RMS) from the finest run", "finest run"),
}
STYLE = {"exact": "-", "experiment": ":", "finest run": "--"}
# Each row adds one effect to the one above: label, settings, and whether the gate is elastic.
STAGES = [
    ("water and walls", {"water.artificial_viscosity": "0", "water.density_diffusion": "0"}, False),
    ("+ artificial viscosity", {"water.density_diffusion": "0"}, False),
    ("+ density diffusion", {}, False),
    ("+ elastic gate", {}, True),
    ("+ wall repulsion", {"water.wall_repulsion": "0.1"}, True),
    ("+ laminar viscosity", {"water.wall_repulsion": "0.1", "water.laminar_viscosity": "1e-6"},
     True),
    ("+ particle shifting", {"water.wall_repulsion": "0.1", "water.laminar_viscosity": "1e-6",
                             "water.shifting": "0.5"}, True),
]


def cost_and_error(points, case, error, paper):
    """(CPU seconds, error in %) of a case with default settings, or with the scheme of the
    paper."""
    return sorted((min(t["cpu"] for t in p["timing"]), 100 * abs(p["errors"][error]))
                  for p in points
                  if p["case"] == case and p["outcome"] == "finished" and p["errors"].get(error)
                  and (p["knob"] == "scheme" and p["value"] == "paper" if paper
                       else p["knob"] == "base"))


def draw_accuracy():
    """Error against CPU seconds of every case with default settings; thin: with the scheme of the
    paper."""
    points = json.loads((ROOT / "docs/accuracy.json").read_text())["points"]
    figure, axes = plt.subplots(figsize=(6, 3.8))
    paper = False
    for case, (label, error, against) in MAIN_ERROR.items():
        rows = cost_and_error(points, case, error, False)
        if rows:
            line, = axes.loglog(*zip(*rows), STYLE[against], marker="o", ms=4, label=label)
            # An error below that of a finer run has changed its sign on the way: a zero crossing.
            lucky = [row for k, row in enumerate(rows)
                     if any(row[1] < 0.9 * e for _, e in rows[k + 1:])]
            for cpu, off in lucky:
                axes.plot(cpu, off, "o", ms=4, color="white", markeredgecolor=line.get_color())
            beside = cost_and_error(points, case, error, True)
            if beside:
                axes.loglog(*zip(*beside), STYLE[against], marker="x", ms=4, lw=0.7,
                            color=line.get_color())
                paper = True
    for against, style in STYLE.items():
        axes.plot([], [], style, color="0.3", label=f"error against: {against}")
    axes.set(xlabel="CPU time (s)", ylabel="error (%)")
    axes.grid(True, which="major", alpha=0.3)
    axes.plot([], [], "o", ms=4, color="white", markeredgecolor="0.3", label="zero crossing")
    if paper:
        axes.plot([], [], marker="x", ms=4, lw=0.7, color="0.3", label="scheme = paper")
    axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1, 0.5))
    save(figure, "accuracy")


def stability_rows():
    """(scene, passes with defaults, passes with a setting) of each scene of the suite; runs of the
    same scene with a setting, or without a remedy that is on by default, are no scenes of their
    own."""
    table = (ROOT /
             "docs/stability.md").read_text().split("| scene | what it is |")[1].split("\n## ")[0]
    passes = {}
    for line in table.splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 9 and cells[0] != "---":
            passes[cells[0]] = cells[5] == "passes"
    for scene in tomllib.loads((ROOT / "tests/stability/suite.toml").read_text())["scene"]:
        if scene["name"] in passes and not ("settings" in scene or "without" in scene):
            yield scene["name"], passes[scene["name"]], passes.get(scene.get("remedy"), False)


def draw_stability():
    """One square for each hard scene: green passes by default, amber with a setting, red not at
    all."""
    rows = list(stability_rows())
    colour = ["#3a8f4d" if ok else "#e5a823" if setting else "#c0392b" for _, ok, setting in rows]
    across = 14
    figure, axes = plt.subplots(figsize=(7, 0.5 * (len(rows) + across - 1) // across + 0.8))
    for k, c in enumerate(colour):
        axes.add_patch(plt.Rectangle((k % across, -(k // across)), 0.9, 0.9, color=c))
    total = {c: colour.count(c) for c in ("#3a8f4d", "#e5a823", "#c0392b")}
    axes.set(xlim=(-0.1, across), ylim=(-((len(rows) - 1) // across) - 0.1, 1), aspect="equal")
    axes.set_title(f"{len(rows)} hard scenes: {total['#3a8f4d']} pass with defaults (green), "
                   f"{total['#e5a823']} with a setting (amber), {total['#c0392b']} fail (red)",
                   fontsize=9)
    axes.axis("off")
    save(figure, "stability")


def gate(elastic):
    """The text of the gate case without probes; without its elastic body where that is not
    wanted."""
    words = "probe|reference" if elastic else "probe|reference|solid|contact|load"
    return re.sub(rf"^\[(?:{words}) [^\n]*\n(?:(?!\[)[^\n]*\n)*", "",
                  (ROOT / "cases/gate.cfg").read_text(), flags=re.M)


def measure(program, repeats=5):
    """Median ms of a step on one thread for each row of STAGES, all rows in each round."""
    cost = [[] for _ in STAGES]
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(repeats):
            for k, (_, settings, elastic) in enumerate(STAGES):
                case, out = Path(folder) / "gate.cfg", Path(folder) / "run"
                case.write_text(gate(elastic))
                sets = [word for key, value in {**settings, "dp": "1 mm"}.items()
                        for word in ("--set", f"{key}={value}")]
                subprocess.run([program, case, "--quiet", "--threads", "1", "--until", "0.02",
                                "--out", out,
                                *sets], check=True, stderr=subprocess.DEVNULL)
                summary = json.loads((out / "summary.json").read_text())
                phases = summary["phase_seconds"]
                cost[k].append(1e3 * (sum(phases.values()) - phases["output"]) / summary["steps"])
                subprocess.run(["rm", "-r", out], check=True)
    with EFFECTS.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["effects", "ms_per_step"])
        writer.writerows([label, f"{statistics.median(c):.4g}"] for (label, _, _),
                         c in zip(STAGES, cost))


def draw_effects():
    """Cost of a step of the gate as effects are added."""
    rows = list(csv.DictReader(EFFECTS.open()))
    value = [float(row["ms_per_step"]) for row in rows]
    figure, axes = plt.subplots(figsize=(7, 2.6))
    axes.barh([row["effects"] for row in rows][::-1], value[::-1], color="#3a5f8a")
    for k, v in enumerate(value[::-1]):
        axes.text(v, k, f" {v:.2f}", va="center", fontsize=8)
    axes.set(xlabel="ms per step of the gate (dp = 1 mm, one thread)", xlim=(0, 1.1 * max(value)))
    axes.spines[["top", "right"]].set_visible(False)
    save(figure, "effects")


def save(figure, name):
    path = IMG / f"glance_{name}.png"
    figure.savefig(path, dpi=110, bbox_inches="tight")
    print(f"wrote {path.relative_to(ROOT)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0], epilog=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--measure", action="store_true", help="measure the cost of effects first")
    parser.add_argument("--program", default=str(ROOT / "sphfsi"))
    args = parser.parse_args()
    if args.measure:
        measure(args.program)
    draw_accuracy()
    draw_stability()
    if EFFECTS.exists():
        draw_effects()
    return 0


if __name__ == "__main__":
    sys.exit(main())
