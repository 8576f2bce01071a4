#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The potential flow of a dam break: its first acceleration is that of the exact series, it keeps
volume and energy, and a coarse solution has the front of the table. Exit 77: a package is
missing."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "support"),
                str(Path(__file__).resolve().parents[2] / "cases" / "reference")]
from scripts import packages
with packages():
    import dam_break_potential as dam
    import numpy as np


def first_acceleration(y):
    """Of the free side x = 1: -p_x of the harmonic p with p = 0 at the top and at the side, p_x = 0
    at the wall and p_y = -1 at the bed. Separation: cos(k x) sinh(k (1 - y)), k = (n - 1/2) pi."""
    k = (np.arange(1, 4000) - 0.5) * np.pi
    falls = (np.exp(-k * y[:, None]) - np.exp(-k * (2 - y[:, None]))) / (1 + np.exp(-2 * k))
    return (2 * np.sin(k) ** 2 / k * falls).sum(axis=1)


def test_first_acceleration():
    """The potential grows as -y on the surface. The rounded corner and the singular foot are left
    out."""
    x, y, _ = dam.column(0.004)
    u, _, _ = dam.velocity(x, y, -y)
    side = (x > 0.999) & (y < 0.9) & (y > 0.02)
    assert side.sum() > 20
    assert abs(u[side] / first_acceleration(y[side]) - 1).max() < 0.003


def test_a_coarse_solution():
    time, front, state = dam.solve(0.008, 0.9)
    start = dam.column(0.008)
    assert abs(dam.area(state) / dam.area(start) - 1) < 0.002
    assert abs(dam.energy(state) / dam.energy(start) - 1) < 0.005
    known = np.loadtxt(dam.TABLE, delimiter=",", skiprows=4)
    early = known[:, 0] <= 0.9
    off = np.interp(known[early, 0], time, front) / known[early, 1] - 1
    assert abs(off).max() < 0.006, off


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(f"ok {name}")
