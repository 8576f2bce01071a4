#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The references of cases/reference/contact.py against what is known, and figures of
made-up runs. Exit 77: a package is missing."""

import math
import sys
from pathlib import Path
from unittest import mock

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "support"),
                str(Path(__file__).resolve().parents[2] / "cases" / "reference")]
from scripts import packages
with packages():
    import contact as reference
    import numpy as np
    from common import figures_report
    import verify_contact as of


def test_a_soft_floor_is_not_reached():
    """A short cantilever under its weight, small slopes: w L^4/(8 E' I) and the part of shear, w
    L^2/(2 G A 5/6)."""
    L, t, E = 0.2, 0.02, 1e9
    plane = E / (1 - 0.3 ** 2)
    wanted = 20 * (L ** 4 / (8 * plane * t ** 3 / 12) + L ** 2 / (2 * E / 2.6 * t * 5 / 6))
    _, y = reference.lying_beam(L, t, E, 0.3, 20, 1, n=40)
    assert abs(-y[-1] / wanted - 1) < 2e-3, (y[-1], wanted)


def test_a_long_beam_lies_down():
    """A thin one with small slopes lies down (72 E' I h/w)^(1/4) from its clamp; half-way 5/16 of
    the height is left."""
    t, E, h, w = 2e-3, 1e9, 1e-3, 20
    free = (72 * E / (1 - 0.3 ** 2) * t ** 3 / 12 * h / w) ** 0.25
    x, y = reference.lying_beam(1.5 * free, t, E, 0.3, w, h, n=60)
    assert abs(np.interp(free / 2, x, y) / h + 11 / 16) < 0.01, (free,
                                                                 np.interp(free / 2, x, y) / h)
    assert y[x > free].max() < -0.998 * h


def test_a_disc_of_elements():
    """Linear fields: the force of a small uniform strain is the stress at the circle, and rotation
    costs none."""
    disc = reference.Disc(6, 1.0, 1000, 1e6, 0.3)
    area = disc.mass.sum() / 1000
    assert abs(area / math.pi - 1) < 0.02, area
    angle = 0.3
    turned = disc.nodes @ np.array([[math.cos(angle), math.sin(angle)],
                                    [-math.sin(angle), math.cos(angle)]])
    assert abs(disc.force(turned - disc.nodes)).max() < 1e-6
    strain = 1e-6
    force = disc.force(strain * disc.nodes * (1, 0))
    virial = -(force[:, 0] * disc.nodes[:, 0]).sum() / area  # of a stress that is uniform
    assert abs(virial / (strain * (disc.lame + 2 * disc.shear)) - 1) < 1e-4, virial


def test_a_disc_bounces():
    """A slow impact loses less than a fast one, and the disc comes back after about the period of
    its own."""
    slow, fast = (reference.disc_impact(v, 0.05, 1000, 1e6, 0.3, n=6) for v in (1, 3))
    assert 0.9 < fast[0] < slow[0] < 1, (slow, fast)
    assert 0.008 < fast[2] < slow[2] < 0.012, (slow, fast)


def test_points_in_a_polygon():
    square = np.array([(0, 0), (2, 0), (2, 2), (1, 1), (0, 2)], dtype=float)  # with a notch
    points = np.array([(0.2, 1.0), (1.0, 1.5), (1.0, 0.5), (3.0, 0.5)])
    assert of.inside(points, square) == 2


def test_the_answer_counts_every_resolution():
    known = {"s": {"figures": {level: [["figure", value, 2], ["not judged", 9.0, None]]
                               for level, value in (("1 across", 3.0), ("2 across", 1.0))},
                   "seconds": {"1 across": 1, "2 across": 2}}}
    lines = figures_report(known)["answer"].splitlines()
    assert lines[0] == "1 of 2 limits are kept.", lines
    assert "* s, figure, 1 across: 3, limit 2" in lines, lines
    assert figures_report(known, "2 across")["answer"] == "1 of 1 limits are kept."


def test_a_block_that_slides():
    t = np.linspace(0, 1.5, 1501)
    norm, push = 9.81 / math.sqrt(1 + 0.6 ** 2), 0.2
    speed = 0.3 * norm * push
    after = np.clip(t - 0.2005, 0, push)
    brake = np.clip(t - 0.2005 - push, 0, speed / (0.3 * norm))
    x = 0.5 * 0.3 * norm * after ** 2 + speed * brake - 0.5 * 0.3 * norm * brake ** 2
    run = mock.Mock(table=lambda: {"time_s": t, "block_cx_m": x},
                    constants={"slope": 0.6, "mu": 0.3, "settle": 0.2, "rise": 1e-3, "push": push})
    (_, way, _), (_, time, _) = of.slide_of(1)(run)
    assert abs(way) < 0.1 and abs(time) < 2, (way, time)


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(f"ok {name}")
