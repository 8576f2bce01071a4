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
import tomllib

from common import COLOURS, IMAGES, OUT, QUICK, ROOT, in_scratch, options, plt, run_tool
from palette import save
from study_results import Study, cost

EFFECTS = OUT / "effects.csv"
# Cases of the accuracy study that both schemes have: label, main error, what it is against.
CASES = {"still": ("still water: pressure", "pressure (L2)"),
         "wave": ("standing wave: period", "period"),
         "impact": ("wave impact: noise of the pressure", "noise of the pressure"),
         "gate": ("elastic gate: motion, from its finest run",
                  "tip motion (RMS) from the finest run"),
         "plate": ("hydrostatic plate: deflection", "settled deflection")}
# Scenes of the stability suite that are named in the picture.
NAMED = {"heavy block onto the bed": "a heavy block sinks onto the bed",
         "retreating wall": "a wall retreats from the water",
         "nu = 0.4999": "a solid with Poisson's ratio 0.4999",
         "light plate, ratio 0.02": "a plate of 1/50 of the water's density",
         "very soft gate": "a gate bends by 0.4 of its length",
         "water entry": "an elastic wedge enters water at 4 m/s",
         "wave slap": "a wave slaps a stiff plate",
         "jet through one spacing": "a jet through an opening of one particle",
         "pressure behind a thin plate": "pressure behind a plate of two particles"}
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
NONE = 3e-4  # %: where scenes stand that gain nothing, or less


def draw_accuracy():
    """Error against CPU seconds of cases that both schemes have."""
    study = Study(ROOT / "docs" / "results" / "accuracy.json")

    def line_of(points, error):
        return zip(*sorted((cost(p), 100 * abs(p["errors"][error])) for p in points
                           if p["outcome"] == "finished" and p["errors"].get(error)))
    figure, axes = plt.subplots(figsize=(6.4, 3.4), layout="constrained")
    for colour, (case, (label, error)) in zip(COLOURS, CASES.items()):
        seconds, off = line_of(study.of(case, "base"), error)
        axes.loglog(seconds, off, "o-", color=colour, markersize=4)
        axes.loglog(*line_of(study.of(case, "scheme", "paper"), error), "--", color=colour, lw=1)
        end, place = (0, (-30, -46)) if case == "still" else (-1, (7, 3))  # beside its line
        axes.annotate(label, (seconds[end], off[end]), xytext=place, textcoords="offset points",
                      color=colour, va="center", fontsize=9, bbox={"fc": "w", "lw": 0, "pad": 0.5})
    axes.set(xlabel="CPU time (s)", ylabel="error (%)", xlim=(0.02, 4e3))
    axes.set_yticks([0.1, 1, 10, 100], ["0.1", "1", "10", "100"])
    axes.set_title("solid: scheme = standard, the default;  dashed: scheme = paper, the article's",
                   fontsize=9, loc="left")
    save(figure, IMAGES / "glance_accuracy.png", dpi=130)


def scenes():
    """(name, whether it passes with defaults, with a setting, gain in %) of each scene of the
    suite; runs with a setting, or without a remedy that is on by default, are none."""
    text = (ROOT / "docs" / "results" / "stability.md").read_text(encoding="utf-8")
    rows = {}
    for line in text.split("| scene | what it is |")[1].split("\n## ")[0].splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 9 and cells[0] != "---":
            rows[cells[0]] = cells[5] == "passes", 100 * float(re.search(r"gain (\S+),",
                                                                         cells[7])[1])
    for scene in tomllib.loads((ROOT / "tests/stability/suite.toml").read_text())["scene"]:
        if scene["name"] in rows and not ("settings" in scene or "without" in scene):
            passes, gain = rows[scene["name"]]
            yield scene["name"], passes, rows.get(scene.get("remedy"), (passes,))[0], gain


def draw_stability():
    """Spurious energy that hard scenes gain: some by their names, the others in a row."""
    found = list(scenes())
    figure, axes = plt.subplots(figsize=(7.2, 2.7), layout="constrained")
    rows = list(NAMED)
    for name, passes, _, gain in found:
        row = rows.index(name) if name in NAMED else len(rows)
        axes.plot(max(gain, NONE), -row, "o", color=COLOURS[0] if passes else COLOURS[1],
                  markersize=7, alpha=1 if name in NAMED or not passes else 0.4, zorder=3)
    for row in range(len(rows) + 1):
        axes.axhline(-row, color="0.9", lw=0.7)
    good = sum(passes for _, passes, _, _ in found)
    cured = sum(cure for _, passes, cure, _ in found if not passes)
    axes.set_yticks([-row for row in range(len(rows) + 1)],
                    [*NAMED.values(), f"the other {len(found) - len(rows)} scenes"])
    axes.set(xscale="log", xlim=(2e-4, 100),
             xlabel="spurious gain, % of the energy in play")
    axes.set_xticks([NONE, 1e-3, 0.01, 0.1, 1, 10, 100],
                    ["none", "0.001", "0.01", "0.1", "1", "10", "100"])
    axes.minorticks_off()
    axes.spines[["top", "left", "right"]].set_visible(False)
    axes.tick_params(top=False, left=False, right=False)
    axes.set_title(f"{len(found)} hard scenes: {good} stable with defaults, {cured} with a setting "
                   f"(orange), {len(found) - good - cured} unstable", fontsize=9, loc="right")
    save(figure, IMAGES / "glance_stability.png", dpi=130)


def gate(elastic):
    """The text of the gate case without probes; without its elastic body where that is not
    wanted."""
    words = "probe|reference" if elastic else "probe|reference|solid|contact|load"
    return re.sub(rf"^\[(?:{words}) [^\n]*\n(?:(?!\[)[^\n]*\n)*", "",
                  (ROOT / "cases/gate.cfg").read_text(), flags=re.M)


def step_ms(run):
    phases = run.summary["phase_seconds"]
    return 1e3 * (sum(phases.values()) - phases["output"]) / run.summary["steps"]


def measure(repeats=1 if QUICK else 5):
    """Median ms of a step on one thread for each row of STAGES, all rows in each round."""
    until = "0.002" if QUICK else "0.02"
    rounds = [[in_scratch(step_ms, gate(elastic), ["dp=1 mm", *sets], "--until", until)
               for _, sets, elastic in STAGES] for _ in range(repeats)]
    with EFFECTS.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["effects", "ms_per_step"])
        writer.writerows([label, f"{statistics.median(ms):.4g}"]
                         for (label, _, _), ms in zip(STAGES, zip(*rounds)))


def draw_effects():
    """Cost of a step of the gate as effects are added, what each adds in colour."""
    rows = list(csv.DictReader(EFFECTS.open()))
    value = [float(row["ms_per_step"]) for row in rows]
    before = [0, *value[:-1]]
    places = range(len(rows), 0, -1)
    figure, axes = plt.subplots(figsize=(6.4, 2.4), layout="constrained")
    axes.barh(places, before, color="0.85")
    axes.barh(places, [v - b for v, b in zip(value, before)], left=before, color=COLOURS[0])
    for y, v, b in zip(places, value, before):
        axes.text(v, y, f" +{100 * (v / b - 1):.0f} %" if b else f" {v:.2f} ms", va="center",
                  fontsize=8)
    axes.set_yticks(places, [row["effects"] for row in rows])
    axes.set(xlabel="time of a step, ms (elastic gate, dp = 1 mm, one thread)",
             xlim=(0, 1.12 * max(value)))
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(top=False, right=False, left=False)
    axes.set_title("Only a scene that names an effect pays for it", fontsize=9, loc="left")
    save(figure, IMAGES / "glance_effects.png", dpi=130)


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
    run_tool(main)
