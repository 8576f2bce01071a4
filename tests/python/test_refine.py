#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Order, extrapolation and band of three resolutions on values whose law is known, and the cost of
another dp. Exit 77: a package is missing."""

import math
import random
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import packages
with packages():
    import cffi  # noqa: F401  the package needs it
    import numpy as np
from sphfsi.budget import _cost  # noqa: E402
from sphfsi.refine import converge, errors_agree  # noqa: E402


def close(a, b):
    return abs(a - b) <= 1e-12


def of_law(exact, a, p, r):
    """f(h) = exact + a h^p at h = 1, r, r^2."""
    return converge([exact + a, exact + a * r**p, exact + a * r**(2 * p)], r)


def test_first_order():
    c = of_law(7, -0.25, 1, 1.5)
    assert close(c.order, 1) and close(c.extrapolated, 7) and close(c.band, 1.25 * 0.25), c


def test_an_order_above_two_is_not_believed():
    c = of_law(7, 0.1, 3, 2)
    assert close(c.order, 3), c
    assert close(c.band, 1.25 * 0.7 / 3), c  # the difference of the finest two, 0.7, over 2^2 - 1


def test_no_order_where_values_go_to_and_fro():
    c = converge([1, 3, 2], 2)
    assert c.order is None and c.band == 6 and c.extrapolated == 1 and c.why == "not monotone", c


def test_no_order_where_differences_hardly_shrink():
    c = of_law(0, 1, 0.3, 2)
    assert c.order is None and close(c.band,
                                     3 * (2**0.6 - 1)) and c.why == "slower than order 0.5", c


def test_a_band_above_the_value_is_no_result():
    """Energies dissipated in the template dam_break: all positive, but a limit of their trend is
    negative."""
    c = converge([14, 30.415, 65.021], 2)
    assert c.order is not None and c.extrapolated < 0 and not c.resolves(14), c
    assert not converge([1, 3, 2], 2).resolves(1)
    assert not converge([0, 1, 2], 2).resolves(0)
    assert converge([7, 6, 6.5], 2).resolves(7)
    assert converge([0, 0, 0], 2).resolves(0)


def test_no_result_has_another_sign_than_its_values():
    """Wherever three values of one sign have a limit of the other, the band is above 100 %."""
    chance, turned = random.Random(1), 0
    for k in range(20000):
        values = [chance.randint(1, 2**24) for _ in range(3)]
        c = converge(values, 1.1 + (k % 30) * 0.1)
        turned += c.extrapolated < 0
        assert not (c.resolves(values[0]) and c.extrapolated < 0), (values, c)
    assert turned > 100, turned


def test_three_equal_values_have_no_band():
    c = converge([5, 5, 5], 2)
    assert c.order is None and c.band == 0 and c.why == "no difference", c


def test_values_that_are_not_finite():
    for k in range(3):
        values = [5, 5.1, 5.3]
        values[k] = math.inf if k == 1 else math.nan
        c = converge(values, 2)
        assert c.order is None and c.why == "not finite" and math.isnan(c.band), c
        assert not c.resolves(values[0]), c


def swing_agrees(error, p, noise):
    """A swing, a phase error of order p, and noise in each run."""
    chance, t = np.random.default_rng(1), 0.05 * np.arange(400)
    late = [error * 2**(p * k) for k in range(3)]
    return errors_agree(*(np.sin(t * (1 - e)) + e + noise * (chance.random(400) - 0.5)
                          for e in late))


def test_noise_has_no_order():
    assert swing_agrees(0.001, 2, 0)
    assert swing_agrees(0.002, 1, 0.002)
    assert not swing_agrees(0, 1, 0.01)
    assert not swing_agrees(0.001, 1, 0.1)


def test_cost_of_another_spacing():
    """Twice the spacing: a quarter of the particles, half the steps, as many rows of output."""
    plan = {"dp": 0.01, "particles": {"fluid": 100, "wall": 7, "solid": 44},
            "cost": {"steps": 1000, "wall_seconds": 83, "row_seconds": 3, "memory_bytes": 4e6}}
    assert _cost(plan, 0.02) == {"particles": 36, "steps": 500, "seconds": 13, "megabytes": 1}
    assert _cost(plan, 0.01)["seconds"] == 83


def main():
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
    return 0


if __name__ == "__main__":
    sys.exit(main())
