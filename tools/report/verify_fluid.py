#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs small scenes of still water, waves, impact, openings and bodies with both schemes of the
fluid and says how far each is off (make verify-fluid, ten minutes on one core). The scenes are
those of cases/verify, shipped cases and templates; tools/report/verify_fluid_measures.py says how
each figure is taken. Figures are kept in docs/results/fluid_verification.json."""
import verify_fluid_measures as of
from common import OUT, run_figures, run_tool, single

REPORT = OUT / "fluid_verification.md"
SCHEMES = ("paper", "standard")


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


def both_schemes(scene, name, variants, measure):
    return {scheme: (scene, [[f"scheme={scheme}", *settings] for settings in variants], measure)
            for scheme in SCHEMES[standard_only(name):]}


SCENES = {row[1]: both_schemes(*row) for row in RUNS}


if __name__ == "__main__":
    run_tool(lambda: run_figures(__doc__, SCENES, REPORT, stops=True, asked="standard"))
