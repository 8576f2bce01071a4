#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The reader of the Turek-Hron benchmark: periods, mean and amplitude of series of known answer."""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
import turek_hron


def series(function, end=10.0, step=0.005):
    times = [k * step for k in range(int(end / step) + 1)]
    return times, [function(t) for t in times]


def test_a_swing_that_repeats_itself():
    """From rest to a swing of 1.9 Hz about 1.3, with a part of three times the frequency."""
    times, values = series(lambda t: 1.3 + min(1, t / 4) * (
        80 * math.sin(2 * math.pi * 1.9 * t) + 5 * math.sin(6 * math.pi * 1.9 * t)))
    spans = turek_hron.periods(times, values)
    assert len(spans) == turek_hron.PERIODS
    found = turek_hron.summary(times, values, spans)
    assert found["state"] == "periodic"
    assert abs(found["frequency"] - 1.9) < 0.01, found
    assert abs(found["mean"] - 1.3) < 0.5, found
    top = max(values[len(values) // 2:])
    assert abs(found["amplitude"] - (top - 1.3)) < 0.5, found


def test_a_swing_that_still_grows():
    times, values = series(lambda t: math.exp(0.4 * t) * math.sin(2 * math.pi * 0.5 * t))
    spans = turek_hron.periods(times, values)
    assert spans == []
    assert turek_hron.summary(times, values, spans)["state"] == "neither steady nor periodic yet"


def test_what_rests():
    times, values = series(lambda t: -66.1 * (1 - math.exp(-2 * t)))
    found = turek_hron.summary(times, values, turek_hron.periods(times, values))
    assert found["state"] == "steady" and abs(found["mean"] + 66.1) < 0.01, found


def test_a_target_is_met_missed_or_not_shown():
    swing = {"state": "periodic", "mean": 1.3, "amplitude": 81.6 * 1.02, "frequency": 1.93 * 1.05}
    run = {"case": "fsi2", "cpu_seconds": 3600 * 2.5, "series": {"uy": swing}}
    assert turek_hron.judged(run, "uy", "amplitude", 3) == "+2.0 % | 3 % | met"
    assert turek_hron.judged(run, "uy", "frequency", 2) == "+5.0 % | 2 % | **missed**"
    assert turek_hron.judged(run, "run", "cost", 2) == "2.5 core-hours | 2 core-hours | **missed**"
    swing["state"] = "neither steady nor periodic yet"
    assert turek_hron.judged(run, "uy", "amplitude", 3).endswith("not shown")


def test_every_reference_has_its_case():
    for name in turek_hron.REFERENCE:
        assert (turek_hron.CASES / f"{name}.cfg").is_file(), name


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(f"ok {name}")
