#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The stability map: runs a plate between waters (tests/stability/thin.cfg) over density,
thickness, stiffness, one wet side or two, integrator and scheme. Keeps the results in
docs/results/stability_map.json and draws docs/img/stability_map.png.
tools/report/stability.py puts both into docs/results/stability.md.

Example: tools/report/stability_map.py --jobs 2       all 1440 plates (10 CPU-minutes), the picture
         tools/report/stability_map.py --most 100     at most 100 of those that no result is kept of
         tools/report/stability_map.py --draw         the picture from the results that are kept"""
import functools
import itertools
import math
import os
import random
from concurrent.futures import ThreadPoolExecutor

from matplotlib.colors import LogNorm

import common
import palette
from common import (COLOURS, IMAGES, OUT, QUICK, ROOT, fill, np, options, plt, program_version,
                    store_rows, summary_of, table)

CASE = ROOT / "tests/stability/thin.cfg"
RESULTS = OUT / "stability_map.json"
PICTURE = IMAGES / "stability_map.png"

DENSITIES = (0.01, 0.1, 0.3, 1, 3, 10)        # over that of water
ACROSS = (2, 3, 5, 10)                       # particles through the thickness
SUBSTEPS = (0.5, 1.5, 2.5, 12.5, 100)        # step of the fluid over the limit of the solid's step
SIDES = (1, 2)                               # wet sides
INTEGRATORS = ("leapfrog", "symplectic", "verlet")
SCHEMES = ("paper", "standard")
TERMS = ("fluid", "interface", "solid", "boundaries")
COLUMNS = ("density", "across", "sides", "integrator", "scheme", "substeps",
           "E",       # Pa
           "result",  # finished, stopped, or why it was not run
           "time",    # s
           # of a region by a term over the energy in play until then, at its largest (T-46)
           "gain",
           "term",    # that has gained most
           "in_run")  # the gain of that term over the largest energy in play of the run

# thin.cfg and what is set here
DP, HEIGHT, LENGTH, GRAVITY, WATER, NU = 5e-3, 0.1, 0.12, 9.81, 1000.0, 0.3
RIGHT = {1: 0.0, 2: 0.05}  # level behind the plate
END = 0.05
LIMIT = 0.01               # gain over the available energy that passes
TENTH = 0.1                # deflection over length, and strain, beyond which a scene is left out
GREENHILL = 7.837          # weight x length^3 / stiffness at which a clamped column buckles


def statics(density, across, sides, young):
    """Why a plate cannot stand by itself: beam theory for its deflection by the net pressure of the
    water and for buckling by its weight, and its strain by either. Empty where it stands."""
    rho, thick = density * WATER, across * DP
    bending = young * thick**3 / (12 * (1 - NU**2))

    def tip(level):  # of a load that grows linearly downwards from `level`
        return WATER * GRAVITY * level**4 * (level / 30 + (LENGTH - level) / 24) / bending

    if tip(HEIGHT) - tip(RIGHT[sides]) > TENTH * LENGTH:
        return "bends"
    if rho * GRAVITY * thick * LENGTH**3 > GREENHILL * bending:
        return "buckles"
    if max(WATER * GRAVITY * HEIGHT, rho * GRAVITY * LENGTH) * (1 - NU**2) > TENTH * young:
        return "is crushed"
    return ""


def case_text(sides):
    """thin.cfg; for one wet side without the water on the right."""
    text = CASE.read_text(encoding="utf-8")
    if sides == 1:
        begin, end = text.index("[fluid right]"), text.index("[wall tank]")
        text = text[:begin] + text[end:]
    return text


def run(scene, young, end):
    """The summary of a run."""
    density, across, sides, integrator, scheme = scene
    settings = [f"scheme={scheme}", f"integrator={integrator}", f"across={across}",
                f"E={young:.9g}",
                f"plate.density={density * WATER:.9g}", f"end_time={end}",
                "output.ledger_interval=1",
                "output.probe_interval=1", "output.snapshot_interval=1"]
    settings += [f"right={RIGHT[sides]}"] if sides == 2 else []
    return summary_of(case_text(sides), settings)


@functools.cache
def stiffness(scene):
    """Young's modulus at which the fluid's step is the limit of the solid's. The limit goes with
    the speed of sound in the solid, so one short run with a stiff plate gives it."""
    young = 4e6 * scene[0]
    step = run(scene, young, 2e-3)["time_step"]
    return young * (step["solid"] / step["largest"])**2


def result(point):
    """A row of the table for one point of the grid."""
    *scene, substeps = point
    young = substeps**2 * stiffness(tuple(scene))
    row = [*point, float(f"{young:.4g}")]
    reason = statics(*scene[:3], young)
    if reason:
        return [*row, reason, 0, 0, "", 0]
    summary = run(scene, young, END)
    drift = summary["drift"]
    terms = {name: drift["gains_by_term"][name].get("gain_over_available_energy") or 0
             for name in TERMS}
    finished = summary["exit_reason"] == "finished"
    return [*row, "finished" if finished else "stopped", float(f"{summary['time']:.4g}"),
            float(f"{drift['gain_over_available_energy']:.3g}"), max(terms, key=terms.get),
            float(f"{max(terms.values()):.3g}")]


def save(rows):
    before = common.load(RESULTS, {"versions": []})["versions"]
    versions = [*before, *({program_version()} - set(before))]  # all programs that rows are from
    store_rows(RESULTS, {"versions": versions, "columns": COLUMNS}, "rows", sorted(rows))


def run_all(jobs, most):
    """Runs the plates that no result is kept of: heavy ones first, since light ones take ten times
    as long, and else in an order that covers the grid at any time."""
    grid = list(itertools.product(DENSITIES, ACROSS, SIDES, INTEGRATORS, SCHEMES, SUBSTEPS))
    rows = [list(row.values()) for row in load()] if RESULTS.exists() else []
    known = {tuple(row[:6]) for row in rows}
    random.Random(1).shuffle(grid)
    grid = sorted((point for point in grid if point not in known),
                  key=lambda point: point[0] < 0.3)[:most]
    with ThreadPoolExecutor(jobs) as pool:
        for count, row in enumerate(pool.map(result, grid), 1):
            rows.append(row)
            if row[7] == "stopped" or row[9] > LIMIT:
                print(f"{count} of {len(grid)}: {row}", flush=True)
            if count % 20 == 0:
                save(rows)
    save(rows)


def load_kept():
    """In the quick form, before any plate has run, what is committed."""
    return common.load(RESULTS) or common.load(ROOT / "docs" / "results" / RESULTS.name)


def load():
    """The rows as dictionaries."""
    kept = load_kept()
    return [dict(zip(kept["columns"], row)) for row in kept["rows"]]


def judge(row):
    """`passes`, `gains`, `stopped` or `left out`."""
    if row["result"] not in ("finished", "stopped"):
        return "left out"
    return "stopped" if row["result"] == "stopped" else "gains" if row["in_run"] > LIMIT \
        else "passes"


def grid_size():
    return math.prod(map(len, (DENSITIES, ACROSS, SIDES, INTEGRATORS, SCHEMES, SUBSTEPS)))


def report(rows):
    """Section for docs/results/stability.md."""
    verdicts = [judge(row) for row in rows]
    gains = [row for row, verdict in zip(rows, verdicts) if verdict == "gains"]
    early = sum(verdict == "passes" and row["gain"] > LIMIT for row, verdict in zip(rows, verdicts))
    gained = [[f"{row['density']:g}", row["across"], row["sides"], row["integrator"], row["scheme"],
               f"{row['substeps']:g}", f"{100 * row['in_run']:.2g} %", row["term"]]
              for row in sorted(gains, key=lambda row: -row["in_run"])]
    head = ["density", "across", "wet sides", "integrator", "scheme", "sub-steps", "gain", "term"]
    missing = grid_size() - len(rows)
    return fill("stability_map.md", plates=len(rows) - verdicts.count("left out"),
                missing=f"{missing} are not run yet. " * (missing > 0), early=early,
                stopped=verdicts.count("stopped"), gains=len(gains),
                percent=100 * LIMIT, gained="\n" + table(head, gained) + "\n" if gains else "",
                left_out=verdicts.count("left out"), end=END, height=HEIGHT, right=RIGHT[2],
                versions=", ".join(load_kept()["versions"]),
                **{name: sum(row["result"] == words for row in rows) for name, words in
                   (("bend", "bends"), ("buckle", "buckles"), ("crushed", "is crushed"))})


def draw(rows):
    """The largest gain of the plates that differ in wet sides, integrator and scheme alone, as a
    share of the largest energy of the run."""
    figure, axes = plt.subplots(1, len(ACROSS), figsize=(8.2, 2.9), sharey=True,
                                layout="constrained")
    for across, panel in zip(ACROSS, axes):
        worst = np.full((len(SUBSTEPS), len(DENSITIES)), np.nan)
        for row in rows:
            if row["across"] == across and judge(row) != "left out":
                at = SUBSTEPS.index(row["substeps"]), DENSITIES.index(row["density"])
                worst[at] = np.fmax(worst[at], 100 * max(row["in_run"], row["result"] == "stopped"))
        shown = panel.pcolormesh(worst, norm=LogNorm(1e-3, 100 * LIMIT),
                                 cmap=plt.get_cmap("Blues").with_extremes(over=COLOURS[1]))
        panel.set_facecolor("0.85")
        panel.set_xticks(np.arange(len(DENSITIES)) + 0.5, [f"{d:g}" for d in DENSITIES], fontsize=8)
        panel.set_yticks(np.arange(len(SUBSTEPS)) + 0.5, [f"{n:g}" for n in SUBSTEPS], fontsize=8)
        panel.set_title(f"{across} particles across", fontsize=9)
        panel.tick_params(length=0)
    figure.supxlabel("density of the plate over that of water", fontsize=10)
    figure.supylabel("fluid step over the limit\nof the solid's step", fontsize=10)
    figure.suptitle("Largest spurious gain of energy of an elastic plate in water. "
                    "Grey: cannot stand by statics", fontsize=10, x=0.01, ha="left")
    bar = figure.colorbar(shown, extend="both", label="gain of energy (%)")
    bar.set_ticks([1e-3, 0.01, 0.1, 1], labels=["0.001", "0.01", "0.1", "1: limit"])
    palette.save(figure, PICTURE, dpi=150)
    print(f"wrote {PICTURE.relative_to(ROOT)}")


def main():
    parser = options(__doc__)
    parser.add_argument("--draw", action="store_true", help="only draw the results that are kept")
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time (1)")
    parser.add_argument("--most", type=int, default=10 if QUICK else None,
                        help="at most so many plates in this call")
    args = parser.parse_args()
    if not args.draw:
        os.nice(10)
        run_all(args.jobs, args.most)
    rows = load()
    print(report(rows), end="")
    draw(rows)


if __name__ == "__main__":
    main()
