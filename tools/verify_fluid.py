#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs small scenes of still water, waves, impact, openings and bodies with both schemes of the fluid and
says how far each is off (make verify-fluid, ten minutes on one core).

  tools/verify_fluid.py                     writes docs/fluid_verification.md
  tools/verify_fluid.py --only 'still water'   runs these scenes again, keeps the figures of the others
  tools/verify_fluid.py --list              says which scenes there are

The scenes are those of cases/verify, shipped cases and templates. tools/verify_fluid_measures.py says how
each figure is taken. The figures are kept in docs/fluid_verification.json."""
import argparse
import json
import tempfile
from pathlib import Path

import verify_fluid_measures as of
from verify_runs import ROOT, Run, case_of, cell, kept, number, program_version

REPORT = ROOT / "docs" / "fluid_verification.md"
KEPT = REPORT.with_suffix(".json")  # the figures of each scene, as last run
SCHEMES = ("paper", "standard")


def single(measure):
    """For scenes of one run."""
    return lambda runs: measure(runs[0])


def skins(*settings):
    """Runs that differ in round-off alone. The cells limit the skin, so that larger ones are equal."""
    return [[*settings, f"numerics.skin={skin}"] for skin in (0.35, 0.4, 0.45, 0.5, 0.55)]


# Shipped cases and templates with walls or bodies, coarse and short: the end (s), other settings. Not the
# channel: it is too narrow for h = 2 dp.
SHIPPED = {"accelerated_tank": (0.75, []), "elastic_valve": (0.4, []),
           "gate": (0.2, ["dp=1.25 mm"]), "hydrostatic_plate": (0.1, []),
           "rolling_tank": (1.6, []), "sluice_gate": (0.5, ["dp=2 mm"]), "still_water": (1, []),
           "two_posts": (0.6, []), "wet_baffle": (0.6, ["dp=2 mm"]), "channel_flap": (0.5, []),
           "tank": (1, [])}


def standard_only(name):
    """Long runs, whose figures of the paper's scheme say nothing new: it fails in shorter ones."""
    return name.startswith(("shipped", "still water, flat", "still water, slope", "still water, elastic"))


# (scene, what it is called, settings of each run, how they are measured)
RUNS = [
    ("fluid_rest_flat", "still water, flat bottom", [[]], single(of.rest_of(0.2))),
    ("fluid_rest", "still water, hump and post", [[]], single(of.rest_of(0.2))),
    *[("fluid_rest_slope", f"still water, slope of {angle} degrees", [[f"constants.angle={angle} deg"]],
       single(of.rest_of(0.2))) for angle in (15, 30, 45)],
    ("fluid_rest_floor", "still water, elastic floor", [[]], single(of.rest_of(0.2))),
    *[("fluid_wave", f"standing wave, H/dp = {ratio}", [[f"constants.ratio={ratio}"]],
       single(of.wave_of(judged)))
      for ratio, judged in ((10, ""), (20, "frequency"), (40, "frequency, loss"))],
    *[("fluid_travel", f"travelling wave, height 10 dp, alpha = {alpha}", [[f"constants.alpha={alpha}"]],
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
    ("fluid_opening", "opening", [["constants.across=4"], ["constants.across=16"]], of.measure_opening),
    ("dam_break", "template dam_break", [[]], single(of.penetration)),
    ("baffle", "template baffle", skins() + skins("dp=2 mm"), of.measure_baffle),
    ("fluid_turned", "gate, turned with gravity", [[f"constants.angle={a} deg"] for a in (0, 15, 30, 45)],
     of.measure_turned),
    *[(case, f"shipped {case}, {end} s",
       [[f"end_time={end} s", f"output.snapshot_interval={end / 40} s", *settings]], single(of.penetration))
      for case, (end, settings) in SHIPPED.items()],
]


def rows_of(name, scene):
    """One row a figure, with both schemes."""
    rows = []
    for k, (what, _, limit) in enumerate(scene["figures"]["standard"]):
        row = {"scene": name, "what": what, "limit": limit}
        for scheme, figures in scene["figures"].items():
            row[scheme] = figures[k][1]
            row[scheme + "_kept"] = kept(row[scheme], limit)
        rows.append(row)
    return rows


def answer(rows):
    """The first lines: which limits the standard scheme keeps."""
    good = [r for r in rows if r["limit"] is not None and r["standard_kept"]]
    missed = [r for r in rows if r["limit"] is not None and not r["standard_kept"]]
    lines = [f"The standard scheme keeps {len(good)} of {len(good) + len(missed)} limits; "
             f"of {sum('paper' in r for r in good + missed)} that were run with it the paper's keeps "
             f"{sum(r.get('paper_kept', False) for r in good + missed)}."]
    if missed:
        lines += ["", "It misses:", ""]
        lines += [f"* {r['scene']}, {r['what']}: {number(r['standard'])}, limit {number(r['limit'])}"
                  for r in missed]
    return lines


def report(scenes):
    rows = [row for name, scene in scenes.items() for row in rows_of(name, scene)]
    versions = sorted({scene["version"] for scene in scenes.values()})
    lines = ["# Verification of the fluid", "", *answer(rows), "",
             "Written by `make verify-fluid`; do not edit. " + ", ".join(versions) + ". One thread. The "
             "scenes are those of `cases/verify`, shipped cases and templates, with `scheme = paper` and "
             "`standard`. `tools/verify_fluid_measures.py` says how each figure is taken. One in brackets "
             "misses its limit; *stopped* is a run that a guard stopped, or a wave without a period.", "",
             "| scene | figure | limit | paper | standard |", "|---|---|---|---|---|"]
    for r in rows:
        cells = [cell(r[s], r["limit"]) if s in r else "" for s in SCHEMES]
        limit = "" if r["limit"] is None else number(r["limit"])
        lines.append(f"| {r['scene']} | {r['what']} | {limit} | {cells[0]} | {cells[1]} |")
    lines += ["", "Processor time, s, on a machine with other work:", "", "| scene | paper | standard |",
              "|---|---|---|"]
    lines += [f"| {name} | {s.get('paper', '')} | {s.get('standard', '')} |" for name, s in
              ((name, scene["seconds"]) for name, scene in scenes.items())]
    return "\n".join(lines) + "\n"


def kept_figures():
    return json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.is_file() else {}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--list", action="store_true", help="say which runs there are")
    parser.add_argument("--only", default="", help="part of a scene's name")
    chosen = parser.parse_args()
    for scene, name, variants, measure in RUNS:
        if chosen.list:
            print(name)
        if chosen.list or chosen.only not in name:
            continue
        now = {"version": program_version(), "figures": {}, "seconds": {}}
        for scheme in SCHEMES[standard_only(name):]:
            with tempfile.TemporaryDirectory() as folder:
                runs = [Run(case_of(scene, folder), [f"scheme={scheme}", *settings], Path(folder) / f"run{k}")
                        for k, settings in enumerate(variants)]
                now["figures"][scheme] = measure(runs)
                now["seconds"][scheme] = round(sum(run.seconds for run in runs), 1)
        for row in rows_of(name, now):
            print(name, row["what"], *(number(row[s]) for s in SCHEMES if s in row), flush=True)
        KEPT.write_text(json.dumps({**kept_figures(), name: now}, indent=1) + "\n", encoding="utf-8")
    if not chosen.list:
        known = kept_figures()
        scenes = {name: known[name] for _, name, *_ in RUNS if name in known}
        REPORT.write_text(report(scenes), encoding="utf-8")


if __name__ == "__main__":
    main()
