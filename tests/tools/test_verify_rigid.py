#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The theory of tools/report/verify_rigid.py and cases/reference/rigid.py, in limits that are
known. Exit 77: a package is missing."""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import ROOT, packages
sys.path.insert(0, str(ROOT / "cases" / "reference"))
with packages():
    import numpy as np
    import rigid
    import verify_rigid as of


def test_zone():
    """Without damping all returns. A weak zone in shallow water has the factor of T-101."""
    assert abs(of.zone_reflection(1, 1.5, 1e-9) - 1) < 1e-6
    kd, rate, length = 0.3, 3, 2
    group = (1 + 2 * kd / math.sinh(2 * kd)) / 2  # over the celerity
    found = of.zone_reflection(kd, length, rate)
    assert abs(found / math.exp(-rate * length / 3 / group) - 1) < 0.1


def test_heave_in_deep_water():
    """Against the Fourier integral with Ursell's coefficients: -0.633 and 0.313 of the start."""
    times = np.arange(0, 1, 0.005)
    when, found = of.extrema(times, rigid.heave(times, 0.1, 3, 10))
    assert np.allclose(found[:2], [-0.633, 0.313], atol=0.008)
    assert np.allclose(when[:2], [0.3778, 0.7326], atol=0.004)


def test_flux():
    """In shallow water all harmonics have one group velocity."""
    times = np.arange(0, 30, 0.1)
    level = 1 + 3 * np.cos(2 * math.pi * times / 10) + 4 * np.sin(4 * math.pi * times / 10)
    assert abs(of.height_by_flux(times, level, 10, 0.0001) - 10) < 1e-3


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
