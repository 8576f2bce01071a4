#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs small scenes of contact at two or three resolutions and says how far each is off (make
verify-contact, some minutes on one core). The scenes are cases/verify/contact_*.cfg and two others;
tools/report/verify_contact_measures.py says how each figure is taken. Figures are kept in
docs/results/contact_verification.json."""
import verify_contact_measures as of
from common import OUT, run_figures, run_tool, single

REPORT = OUT / "contact_verification.md"


def scene(case, key, levels, measure, *more, **constants):
    """`key` is the constant that is varied, with its unit in words; `more`: constants of runs of a
    level that are measured together."""
    def settings(level, own):
        words = {**constants, **own, key[0]: level}
        return [f"{'' if word == 'dp' else 'constants.'}{word}={value!r}"
                for word, value in words.items()]
    return {f"{level:g} {key[1]}": (case, [settings(level, own) for own in more or [{}]],
                                    measure if more else single(measure)) for level in levels}


def friction(measure, levels, **constants):
    return scene("contact_slide", ("ratio", "over the height"), levels, measure,
                 **{"mu": 0.3, "settle": 0.2, "rise": 1e-3, **constants})


def press(limit, stiffer=1.0, **constants):
    return scene("contact_press", ("ratio", "over the height"), (10, 20),
                 of.press_of(stiffer, limit), stiffer=stiffer, **constants)


def disc(speed, limits, levels, **constants):
    return scene("contact_disc", ("ratio", "over the radius"), levels,
                 of.disc_of(speed, limits), v=speed, **constants)


def bullet(**constants):
    return scene("contact_bullet", ("E", "Pa, modulus"), (1e6, 2e7, 5e9), of.measure_bullet,
                 **{"v": 200, "held": 0, "corner": 0, "top": 0.1, **constants})


SCENES = {
    "equal blocks on a floor": press(0.2),
    "upper block with a spacing of 2/3": press(0.2, finer=1.5),
    "upper block ten times as stiff": press(0.2, stiffer=10.0),
    "upper block a tenth as stiff": press(0.2, stiffer=0.1),
    "upper block with a lattice turned by 0.5": press(0.5, turn=0.5),
    "disc on a wall, 3 m/s": disc(3, (1, 3, 5), (10, 20, 40), two=0),
    "disc on a wall, 1 m/s": disc(1, (1, 5, 10), (20, 40), two=0),
    "disc on a disc, 3 m/s each": disc(3, (1, 3, 5), (10, 20, 40), two=1),
    "bar on a bar twice as long":
        scene("contact_bars", ("ratio", "over the width"), (4, 8, 16), of.measure_bars, v=0.2),
    **{f"disc between plates, lattice turned by {turn}":
       scene("contact_line", ("ratio", "over the radius"), (20, 40, 80), of.measure_line,
             {"D": 1.2e-3}, {"D": 2.4e-3}, turn=turn) for turn in (0, 0.3, 0.6)},
    "block that slides to rest": friction(of.slide_of(2), (4, 8), slope=0.6, push=0.2),
    "block on a slope of 0.6": friction(of.slope_of(1), (4, 8), slope=0.6, push=10),
    "block on a slope of 0.28 that turns in 0.3 s":
        friction(of.held_of(0.01), (4, 8, 16), slope=0.28, push=10, rise=0.3),
    "block on a slope of 0.25 that turns in 1 ms":
        friction(of.held_of(0.01), (4, 8, 16), slope=0.25, push=10),
    "block on a slope of 0.28 that turns in 1 ms":
        friction(of.held_of(None), (4, 8, 16), slope=0.28, push=10),
    **{f"block as wide as high on a slope of {slope}, friction 1.5":
       friction(of.topple_of(slope > 1), (10, 20), slope=slope, mu=1.5, push=10, rise=0.3, aspect=1)
       for slope in (0.85, 1.05)},
    "three blocks on a floor, 10 s":
        scene("contact_stack", ("ratio", "over the height"), (5, 10), of.measure_stack, over=-0.1),
    **{f"three blocks, the upper overhangs by {over} of its length":
       scene("contact_stack", ("ratio", "over the height"), (5, 10), of.stands_of(over > 0.5),
             over=over) for over in (0.4, 0.55)},
    "strip that folds onto itself":
        scene("contact_fold", ("ratio", "through the thickness"), (4, 8), of.measure_fold),
    "beam pressed onto a beam":
        scene("beam_on_beam", ("across", "through the thickness"), (4, 8), of.measure_beams),
    "200 m/s at a wall": bullet(), "200 m/s at a strip of three": bullet(held=1),
    "200 m/s, corner first, at a wall": bullet(corner=1),
    "200 m/s, corner first, at a strip of three": bullet(corner=1, held=1),
    "200 m/s, corner on corner": bullet(corner=1, held=1, top=0),
    "ram presses two blocks to half their height":
        scene("pressed", ("dp", "m, spacing"), (5e-3, 2.5e-3), of.measure_driven),
}


if __name__ == "__main__":
    run_tool(lambda: run_figures(__doc__, SCENES, REPORT, stops=True))
