#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs small scenes of contact at two or three resolutions and says how far each is off (make
verify-contact, some minutes on one core).

  tools/report/verify_contact.py                 writes docs/results/contact_verification.md
  tools/report/verify_contact.py --only disc     runs these scenes again, keeps the figures of the
  others
  tools/report/verify_contact.py --list          says which scenes there are

The scenes are cases/verify/contact_*.cfg and two others. tools/report/verify_contact_measures.py
says how each figure is taken. The figures are kept in docs/results/contact_verification.json."""
import metrics
import verify_contact_measures as of
from common import OUT, cell, judged, limit_text, measure_scene, run_scenes, run_tool, table

REPORT = OUT / "contact_verification.md"
LINE = [{"D": 1.2e-3}, {"D": 2.4e-3}]


def scene(name, case, key, levels, measure, constants=None, variants=None, against=""):
    """`key` is the constant that is varied, with its unit in words; with `variants` a level has
    several runs, which are measured together."""
    return {"name": name, "case": case, "key": key, "levels": levels, "measure": measure,
            "constants": constants or {}, "variants": variants, "against": against}


def friction(name, measure, levels, **constants):
    return scene(name, "contact_slide", ("ratio", "over the height"), levels, measure,
                 {"mu": 0.3, "settle": 0.2, "rise": 1e-3, **constants}, against="Coulomb, statics")


def press(name, limit, stiffer=1.0, **constants):
    return scene(name, "contact_press", ("ratio", "over the height"), (10, 20),
                 of.press_of(stiffer, limit),
                 {"stiffer": stiffer, **constants}, against="uniform compression: no layer")


def disc(name, speed, limits, levels, **constants):
    return scene(name, "contact_disc", ("ratio", "over the radius"), levels,
                 of.disc_of(speed, limits), {"v": speed, **constants}, against="finite elements")


def bullet(name, **constants):
    levels = (1e6, 2e7, 5e9)
    return scene(name, "contact_bullet", ("E", "Pa, modulus"), levels, of.measure_bullet,
                 {"v": 200, "held": 0, "corner": 0, "top": 0.1, **constants},
                 against="nothing passes")


SCENES = [
    press("equal blocks on a floor", 0.2),
    press("upper block with a spacing of 2/3", 0.2, finer=1.5),
    press("upper block ten times as stiff", 0.2, stiffer=10.0),
    press("upper block a tenth as stiff", 0.2, stiffer=0.1),
    press("upper block with a lattice turned by 0.5", 0.5, turn=0.5),
    disc("disc on a wall, 3 m/s", 3, (1, 3, 5), (10, 20, 40), two=0),
    disc("disc on a wall, 1 m/s", 1, (1, 5, 10), (20, 40), two=0),
    disc("disc on a disc, 3 m/s each", 3, (1, 3, 5), (10, 20, 40), two=1),
    scene("bar on a bar twice as long", "contact_bars", ("ratio", "over the width"), (4, 8, 16),
          of.measure_bars, {"v": 0.2}, against="Saint-Venant"),
    *[scene(f"disc between plates, lattice turned by {turn}", "contact_line",
            ("ratio", "over the radius"),
            (20, 40, 80), of.measure_line, {"turn": turn}, LINE, "Johnson 1985, Sec. 5.6")
      for turn in (0, 0.3, 0.6)],
    friction("block that slides to rest", of.slide_of(2), (4, 8), slope=0.6, push=0.2),
    friction("block on a slope of 0.6", of.slope_of(1), (4, 8), slope=0.6, push=10),
    friction("block on a slope of 0.28 that turns in 0.3 s", of.held_of(0.01), (4, 8, 16),
             slope=0.28, push=10, rise=0.3),
    friction("block on a slope of 0.25 that turns in 1 ms", of.held_of(0.01), (4, 8, 16),
             slope=0.25, push=10),
    friction("block on a slope of 0.28 that turns in 1 ms", of.held_of(None), (4, 8, 16),
             slope=0.28, push=10),
    *[friction(f"block as wide as high on a slope of {slope}, friction 1.5",
               of.topple_of(slope > 1), (10, 20), slope=slope, mu=1.5, push=10, rise=0.3, aspect=1)
      for slope in (0.85, 1.05)],
    scene("three blocks on a floor, 10 s", "contact_stack", ("ratio", "over the height"), (5, 10),
          of.measure_stack, {"over": -0.1}, against="statics"),
    *[scene(f"three blocks, the upper overhangs by {over} of its length", "contact_stack",
            ("ratio", "over the height"), (5, 10), of.stands_of(over > 0.5), {"over": over},
            against="statics")
      for over in (0.4, 0.55)],
    scene("strip that folds onto itself", "contact_fold", ("ratio", "through the thickness"),
          (4, 8), of.measure_fold, against="beam by finite differences"),
    scene("beam pressed onto a beam", "beam_on_beam", ("across", "through the thickness"), (4, 8),
          of.measure_beams, against="symmetry"),
    bullet("200 m/s at a wall"), bullet("200 m/s at a strip of three", held=1),
    bullet("200 m/s, corner first, at a wall", corner=1),
    bullet("200 m/s, corner first, at a strip of three", corner=1, held=1),
    bullet("200 m/s, corner on corner", corner=1, held=1, top=0),
    scene("ram presses two blocks to half their height", "pressed", ("dp", "m, spacing"),
          (5e-3, 2.5e-3), of.measure_driven, against="no overlap of half a spacing"),
]


def run_level(of_scene, level):
    """Figures of one resolution, and the processor time."""
    def settings(variant):
        constants = {**of_scene["constants"], **variant, of_scene["key"][0]: level}
        return [f"{'' if key == 'dp' else 'constants.'}{key}={value!r}"
                for key, value in constants.items()]
    several = of_scene["variants"]
    return measure_scene(of_scene["case"], map(settings, several or [{}]),
                         lambda runs: of_scene["measure"](runs if several else runs[0]))


def order(values, levels):
    """Of the last two resolutions, where the error falls without a change of sign."""
    falls = len(values) > 1 and 1 <= levels[0] <= 1000 and abs(values[-1]) < abs(values[-2])
    return f"{metrics.order(levels, values):.1f}" if falls and values[-2] * values[-1] > 0 else ""


def rows_of(known):
    """(scene, words, values, limit) of each figure."""
    for of_scene in SCENES:
        levels = known.get(of_scene["name"], {"figures": [[]]})["figures"]
        for k, (words, _, limit) in enumerate(levels[0]):
            yield of_scene, words, [figures[k][1] for figures in levels], limit


def answer(rows):
    return judged([(f"{s['name']}, {words}, at {level:g}", value, limit)
                   for s, words, values, limit in rows for level,
                   value in zip(s["levels"], values)])


def report(known):
    rows = list(rows_of(known))
    absent = [f"* {s['name']}" for s in SCENES if s["name"] not in known]
    return {"answer": "\n".join([answer(rows),
                                 *(["", "Not run yet:", "", *absent] if absent else [])]),
            "figures": table(
                ["scene", "figure", "resolution", "found", "order", "limit", "reference"],
                [[s["name"], words, ", ".join(f"{level:g}" for level in s["levels"]) +
                  f" {s['key'][1]}", ", ".join(cell(value, limit) for value in values),
                  order(values, s["levels"]) if "%" in words else "", limit_text(limit),
                  s["against"]] for s, words, values, limit in rows]),
            "seconds": table(["scene", "processor time, s"],
                             [[name, ", ".join(map(str, entry["seconds"]))]
                              for name, entry in known.items()])}


def run_scene(name):
    of_scene = next(s for s in SCENES if s["name"] == name)
    found = [run_level(of_scene, level) for level in of_scene["levels"]]
    for k, (words, _, limit) in enumerate(found[0][0]):
        print(name, words, *(cell(figures[k][1], limit) for figures, _ in found), flush=True)
    return {"figures": [figures for figures, _ in found],
            "seconds": [seconds for _, seconds in found]}


if __name__ == "__main__":
    run_tool(lambda: run_scenes(__doc__, [s["name"] for s in SCENES], run_scene, REPORT, report))
