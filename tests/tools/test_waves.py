#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Separation of incident and reflected waves, against waves of known heights. Exit 77: a package is
missing."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import packages
with packages():
    import numpy as np
    import runfiles  # noqa: F401  it finds the package
    from sphfsi.files import BadFile
    from sphfsi.waves import separate, wave_number

DEPTH, PERIOD = 0.4, 1.2
TIME = np.arange(0, 10 * PERIOD, 0.01)


def sea(places, parts):
    """Levels of waves (period, amplitude, amplitude back, phase)."""
    levels = np.zeros((len(places), len(TIME)))
    for period, there, back, phase in parts:
        omega = 2 * np.pi / period
        k = wave_number(omega, DEPTH)
        for n, x in enumerate(places):
            levels[n] += there * np.cos(omega * TIME - k * x) + \
                back * np.cos(omega * TIME + k * x + phase)
    return levels


def test_dispersion():
    k = wave_number(2 * np.pi / PERIOD, DEPTH)
    assert abs(9.81 * k * np.tanh(k * DEPTH) / (2 * np.pi / PERIOD)**2 - 1) < 1e-12


def test_regular_waves():
    """By two and three gauges, with a bound harmonic and a mean level that do not count."""
    length = 2 * np.pi / wave_number(2 * np.pi / PERIOD, DEPTH)
    for places in ([1, 1 + length / 4], [1, 1 + length / 10, 1 + length / 3]):
        levels = sea(places, [(PERIOD, 0.02, 0.003, 0.7), (PERIOD / 2, 0.004, 0, 0)]) + 0.1
        found = separate(TIME, levels, places, DEPTH, PERIOD)
        assert abs(found.incident - 0.04) < 1e-9 and abs(found.reflection - 0.15) < 1e-8, found


def test_all_periods_count():
    """Rows for two periods, each of them once. A wave of two thirds of the period is periodic in
    both together and does not count."""
    length = 2 * np.pi / wave_number(2 * np.pi / PERIOD, DEPTH)
    places, rows = [1, 1 + length / 4], len(TIME) // 5
    levels = sea(places, [(PERIOD, 0.02, 0.003, 0.7), (PERIOD / 1.5, 0.01, 0, 0)])[:, -rows:]
    found = separate(TIME[-rows:], levels, places, DEPTH, PERIOD)
    assert abs(found.incident - 0.04) < 1e-9 and abs(found.reflection - 0.15) < 1e-8, found


def test_irregular_waves():
    """Frequencies of the record; those for which the gauges are half a length apart are left
    out."""
    parts = [(TIME[-1] / n, 0.01 / n, 0.002 / n, n) for n in range(6, 16)]
    places = [1, 1.25, 1.6]
    found = separate(TIME, sea(places, parts), places, DEPTH)
    wanted = 4 * np.sqrt(sum(part[1]**2 for part in parts) / 2)
    assert abs(found.incident / wanted - 1) < 0.02 and abs(found.reflection - 0.2) < 0.02, found


def test_bad_gauges():
    length = 2 * np.pi / wave_number(2 * np.pi / PERIOD, DEPTH)
    for places, period, said in (([1], PERIOD, "two or more gauges"),
                                 ([1, 1 + length / 2], PERIOD, "0.05 to 0.45"),
                                 ([1, 2], 100, "shorter than the period")):
        try:
            separate(TIME, sea(places, [(PERIOD, 0.02, 0, 0)]), places, DEPTH, period)
        except BadFile as problem:
            assert said in str(problem), problem
        else:
            raise AssertionError(said)


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
