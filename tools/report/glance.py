#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the three charts of the README from results that are committed.

  tools/report/glance.py              draws docs/img/glance_{accuracy,stability,effects}.png
  tools/report/glance.py --measure    first measures the cost of the gate as effects are added (two
                                      minutes)
"""
import csv
import re
import statistics
import sys
import tomllib

from common import IMAGES, OUT, QUICK, ROOT, in_scratch, options, plt
from study_results import Study, cost

IMG = IMAGES
EFFECTS = OUT / "effects.csv"
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
BARE = ["water.artificial_viscosity=0"]
FULL = ["water.wall_repulsion=0.1", "water.laminar_viscosity=1e-6", "water.shifting=0.5"]
STAGES = [
    ("water and walls", [*BARE, "water.density_diffusion=0"], False),
    ("+ artificial viscosity", ["water.density_diffusion=0"], False),
    ("+ density diffusion", [], False), ("+ elastic gate", [], True),
    ("+ wall repulsion", FULL[:1], True), ("+ laminar viscosity", FULL[:2], True),
    ("+ particle shifting", FULL, True),
]
PASSES, CURED, FAILS = "#3a8f4d", "#e5a823", "#c0392b"


def draw_accuracy():
    """Error against CPU seconds of every case with default settings; thin: with the scheme of the
    paper."""
    study = Study(ROOT / "docs" / "results" / "accuracy.json")

    def rows_of(points, error):
        return sorted((cost(p), 100 * abs(p["errors"][error])) for p in points
                      if p["outcome"] == "finished" and p["errors"].get(error))
    figure, axes = plt.subplots(figsize=(6, 3.8))
    paper = False
    for case, (label, error, against) in MAIN_ERROR.items():
        rows = rows_of(study.of(case, "base"), error)
        if not rows:
            continue
        line, = axes.loglog(*zip(*rows), STYLE[against], marker="o", ms=4, label=label)
        # An error below that of a finer run has changed its sign on the way: a zero crossing.
        for k, row in enumerate(rows):
            if any(row[1] < 0.9 * e for _, e in rows[k + 1:]):
                axes.plot(*row, "o", ms=4, color="white", markeredgecolor=line.get_color())
        beside = rows_of(study.of(case, "scheme", "paper"), error)
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


def stability_colours():
    """A colour for each scene of the suite; runs of the same scene with a setting, or without a
    remedy that is on by default, are no scenes of their own."""
    text = (ROOT / "docs/results/stability.md").read_text()
    passes = {}
    for line in text.split("| scene | what it is |")[1].split("\n## ")[0].splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 9 and cells[0] != "---":
            passes[cells[0]] = cells[5] == "passes"
    for scene in tomllib.loads((ROOT / "tests/stability/suite.toml").read_text())["scene"]:
        if scene["name"] in passes and not ("settings" in scene or "without" in scene):
            yield PASSES if passes[scene["name"]] else \
                CURED if passes.get(scene.get("remedy")) else FAILS


def draw_stability():
    """One square for each hard scene: green passes by default, amber with a setting, red not at
    all."""
    colours, across = list(stability_colours()), 14
    figure, axes = plt.subplots(figsize=(7, 0.5 * (len(colours) + across - 1) // across + 0.8))
    for k, c in enumerate(colours):
        axes.add_patch(plt.Rectangle((k % across, -(k // across)), 0.9, 0.9, color=c))
    axes.set(xlim=(-0.1, across), ylim=(-((len(colours) - 1) // across) - 0.1, 1), aspect="equal")
    axes.set_title(f"{len(colours)} hard scenes: {colours.count(PASSES)} pass with defaults "
                   f"(green), {colours.count(CURED)} with a setting (amber), "
                   f"{colours.count(FAILS)} fail (red)", fontsize=9)
    axes.axis("off")
    save(figure, "stability")


def gate(elastic):
    """The text of the gate case without probes; without its elastic body where that is not
    wanted."""
    words = "probe|reference" if elastic else "probe|reference|solid|contact|load"
    return re.sub(rf"^\[(?:{words}) [^\n]*\n(?:(?!\[)[^\n]*\n)*", "",
                  (ROOT / "cases/gate.cfg").read_text(), flags=re.M)


def step_ms(run):
    phases = run.summary["phase_seconds"]
    return 1e3 * (sum(phases.values()) - phases["output"]) / run.summary["steps"]


def measure(repeats=5):
    """Median ms of a step on one thread for each row of STAGES, all rows in each round."""
    rounds = [[in_scratch(step_ms, gate(elastic), ["dp=1 mm", *sets], "--until", "0.02")
               for _, sets, elastic in STAGES] for _ in range(repeats)]
    with EFFECTS.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["effects", "ms_per_step"])
        writer.writerows([label, f"{statistics.median(ms):.4g}"]
                         for (label, _, _), ms in zip(STAGES, zip(*rounds)))


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
    parser = options(__doc__)
    parser.add_argument("--measure", action="store_true", help="measure the cost of effects first")
    if parser.parse_args().measure:
        measure()
    draw_accuracy()
    draw_stability()
    if EFFECTS.exists():
        draw_effects()


if __name__ == "__main__":
    sys.exit(main())
