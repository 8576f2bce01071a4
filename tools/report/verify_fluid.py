#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs small scenes of still water, waves, impact, openings and bodies with both schemes of the
fluid and says how far each is off (make verify-fluid, ten minutes on one core).

  tools/report/verify_fluid.py                     writes docs/results/fluid_verification.md
  tools/report/verify_fluid.py --only 'still water'   runs these scenes again, keeps the figures of
  the others
  tools/report/verify_fluid.py --list              says which scenes there are

The scenes are those of cases/verify, shipped cases and templates.
tools/report/verify_fluid_measures.py says how each figure is taken. The figures are kept in
docs/results/fluid_verification.json."""
import verify_fluid_measures as of
from common import (OUT, cell, kept, limit_text, measure_scene, number, run_scenes, run_tool,
                    table)

REPORT = OUT / "fluid_verification.md"
SCHEMES = ("paper", "standard")


def single(measure):
    """For scenes of one run."""
    return lambda runs: measure(runs[0])


def skins(*settings):
    """Runs that differ in round-off alone. The cells limit the skin, so that larger ones are
    equal."""
    return [[*settings, f"numerics.skin={skin}"] for skin in (0.35, 0.4, 0.45, 0.5, 0.55)]


# Shipped cases and templates with walls or bodies, coarse and short: the end (s), other settings.
# Not the channel: it is too narrow for h = 2 dp.
SHIPPED = {"accelerated_tank": (0.75, []), "elastic_valve": (0.4, []),
           "gate": (0.2, ["dp=1.25 mm"]), "hydrostatic_plate": (0.1, []),
           "rolling_tank": (1.6, []), "sluice_gate": (0.5, ["dp=2 mm"]), "still_water": (1, []),
           "two_posts": (0.6, []), "wet_baffle": (0.6, ["dp=2 mm"]), "channel_flap": (0.5, []),
           "tank": (1, [])}


def standard_only(name):
    """Long runs, whose figures of the paper's scheme say nothing new: it fails in shorter ones."""
    return name.startswith(("shipped", "still water, flat", "still water, slope",
                            "still water, elastic"))


# (scene, what it is called, settings of each run, how they are measured)
RUNS = [
    ("fluid_rest_flat", "still water, flat bottom", [[]], single(of.rest_of(0.2))),
    ("fluid_rest", "still water, hump and post", [[]], single(of.rest_of(0.2))),
    *[("fluid_rest_slope", f"still water, slope of {angle} degrees",
       [[f"constants.angle={angle} deg"]],
       single(of.rest_of(0.2))) for angle in (15, 30, 45)],
    ("fluid_rest_floor", "still water, elastic floor", [[]], single(of.rest_of(0.2))),
    *[("fluid_wave", f"standing wave, H/dp = {ratio}", [[f"constants.ratio={ratio}"]],
       single(of.wave_of(judged)))
      for ratio, judged in ((10, ""), (20, "frequency"), (40, "frequency, loss"))],
    *[("fluid_travel", f"travelling wave, height 10 dp, alpha = {alpha}",
       [[f"constants.alpha={alpha}"]],
       single(of.travel_of(judged))) for alpha, judged in ((0, True), (0.01, False))],
    *[("fluid_impact", f"impact on a wall, H/dp = {ratio}", skins(f"constants.ratio={ratio}"),
       of.over(of.impact_of(limit))) for ratio, limit in ((40, None), (60, 0.05))],
    ("dam_break_impact", "impact on a wall, measured one, H/dp = 60", skins("end_time=1.25 s"),
     of.over(of.measure_later_peaks)),
    *[("fluid_gate_impact", f"dam break behind a gate, H/dp = {ratio}",
       skins(f"constants.ratio={ratio}")[:runs], of.over(of.measure_gate_impact))
      for ratio, runs in ((60, 5), (120, 2))],
    ("dam_break_front", "dam break, square column, a/dp = 40", [["constants.n2=1"]],
     single(of.measure_front)),
    ("fluid_front", "dam break, square column, free at once",
     [[f"constants.ratio={ratio}"] for ratio in (20, 40, 80)], of.measure_free_front),
    ("fluid_opening", "opening", [["constants.across=4"], ["constants.across=16"]],
     of.measure_opening),
    ("dam_break", "template dam_break", [[]], single(of.penetration)),
    ("baffle", "template baffle", skins() + skins("dp=2 mm"), of.measure_baffle),
    ("fluid_turned", "gate, turned with gravity",
     [[f"constants.angle={a} deg"] for a in (0, 15, 30, 45)],
     of.measure_turned),
    *[(case, f"shipped {case}, {end} s",
       [[f"end_time={end} s", f"output.snapshot_interval={end / 40} s", *settings]],
       single(of.penetration))
      for case, (end, settings) in SHIPPED.items()],
]


def rows_of(known):
    """(scene, words, limit, {scheme: value}) of each figure."""
    for name, scene in known.items():
        for k, (what, _, limit) in enumerate(scene["figures"]["standard"]):
            yield name, what, limit, {scheme: figures[k][1]
                                      for scheme, figures in scene["figures"].items()}


def answer(rows):
    """The first lines: which limits the standard scheme keeps."""
    rows = [row for row in rows if row[2] is not None]
    missed = [f"* {name}, {what}: {number(values['standard'])}, limit {number(limit)}"
              for name, what, limit, values in rows if not kept(values["standard"], limit)]
    paper = [kept(values["paper"], limit) for _, _, limit, values in rows if "paper" in values]
    text = (f"The standard scheme keeps {len(rows) - len(missed)} of {len(rows)} limits; "
            f"of {len(paper)} that were run with it the paper's keeps {sum(paper)}.")
    return "\n".join([text, "", "It misses:", "", *missed] if missed else [text])


def report(known):
    rows = list(rows_of(known))
    figures = table(["scene", "figure", "limit", *SCHEMES],
                    [[name, what, limit_text(limit),
                      *(cell(values[s], limit) if s in values else "" for s in SCHEMES)]
                     for name, what, limit, values in rows])
    seconds = table(["scene", *SCHEMES], [[name, *(scene["seconds"].get(s, "") for s in SCHEMES)]
                                          for name, scene in known.items()])
    return {"answer": answer(rows), "figures": figures, "seconds": seconds}


def run_scene(name):
    scene, _, variants, measure = next(row for row in RUNS if row[1] == name)
    now = {"figures": {}, "seconds": {}}
    for scheme in SCHEMES[standard_only(name):]:
        now["figures"][scheme], now["seconds"][scheme] = measure_scene(
            scene, ([f"scheme={scheme}", *settings] for settings in variants), measure)
    for _, what, _, values in rows_of({name: now}):
        print(name, what, *map(number, values.values()), flush=True)
    return now


if __name__ == "__main__":
    run_tool(lambda: run_scenes(__doc__, [row[1] for row in RUNS], run_scene, REPORT, report))
