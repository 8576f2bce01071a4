#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Bands on values whose law is known, measures on curves whose answer is known, and the cost of
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
from sphfsi.bands import NINETY, Total, band  # noqa: E402
from sphfsi.budget import _cost  # noqa: E402
from sphfsi.measures import measures  # noqa: E402
from sphfsi.refine import _row  # noqa: E402


def close(a, b, tolerance=1e-9):
    return abs(a - b) <= tolerance


def of_law(exact, a, p, r, n=3):
    """The values f(h) = exact + a h^p at h = 1, r, r^2, ...: their band, and the value at 1."""
    sizes = [r**k for k in range(n)]
    return band(sizes, [exact + a * h**p for h in sizes])


def test_a_sound_order():
    """The factor of Xing and Stern on the distance to the limit, and 90 % of a band of 95 %."""
    for p in (0.6, 1, 1.7, 2):
        for n in (3, 4, 6):
            b = of_law(7, -0.25, p, 1.5, n)
            assert close(b.order, p, 1e-4) and close(b.shift, 0.25, 1e-4), (p, n, b)
            assert close(b.half, NINETY * (2.45 - 0.425 * p) * 0.25, 1e-3), (p, n, b)


def test_an_order_above_two_is_not_believed():
    b = of_law(7, 0.1, 3, 2)
    assert b.order is None and b.why == "faster than order 2", b
    assert close(b.half, NINETY * (16.4 * 1.5 - 14.8) * 0.1, 1e-4), b


def test_no_order_where_values_go_to_and_fro():
    b = band([1, 2, 4], [1, 3, 2])
    assert b.order is None and b.why == "not monotone" and close(b.half, NINETY * 6), b


def test_no_order_where_differences_hardly_shrink():
    b = of_law(0, 1, 0.3, 2)
    assert b.order is None and b.why == "slower than order 0.5", b
    assert close(b.half, NINETY * (2.45 - 0.425 * 0.3), 1e-4), b


def test_the_formal_order_is_that_of_the_direction():
    """Sums over an even lattice with the Wendland kernel have order 5."""
    sizes = [1, 1 / 1.2, 1 / 1.44]
    for p in (3, 5):
        b = band(sizes, [7 + 0.25 * h**p for h in sizes], direction="kernel")
        assert close(b.order, p, 1e-4), b
        assert close(b.half, NINETY * (2.45 - 0.85 * p / 5) * 0.25, 1e-4), b


def test_any_order_of_runs_will_do():
    mixed = band([4, 1, 2], [7 + 4, 7 + 1, 7 + 2])
    assert close(mixed.half, of_law(7, 1, 1, 2).half) and close(mixed.shift, -1), mixed


def test_equal_values_have_no_band():
    b = band([1, 2, 4], [5, 5, 5])
    assert b.order is None and b.half == 0 and b.why == "no difference", b


def test_values_that_are_not_finite():
    for k in range(3):
        values = [5, 5.1, 5.3]
        values[k] = math.inf if k == 1 else math.nan
        b = band([1, 2, 4], values)
        assert b.order is None and b.why == "not finite" and math.isnan(b.half), b


def test_noise_has_no_order():
    """Differences within what runs scatter by tell nothing of the limit; the scatter is the
    band."""
    b = band([1, 2, 4], [1.1, 1.2, 1.4], scatter=0.31)
    assert b.order is None and b.why == "within the scatter" and b.half == 0, b
    total = Total(1.1, {"spacing": b}, [1.0, 1.1, 1.2])
    assert close(total.scatter, 2.920 * 0.1) and close(total.half, total.scatter), total
    assert math.isnan(total.limit)


def test_a_row_without_order_has_the_repeats():
    total = Total(1.1, {"spacing": band([1, 2, 4], [1.1, 1.2, 1.1])}, [1.0, 1.1, 1.2])
    text = _row("peak", [1.1, 1.2, 1.1], total)
    assert "3 repeats: mean 1.1, 95 % within +- 0.43; not monotone" in text, text
    sound = Total(1, {"spacing": band([1, 2, 4], [1, 2, 4])}, [1.0, 1.1, 1.2])
    assert "repeats" not in _row("peak", [1, 2, 4], sound)


def test_scatter_covers_as_often_as_it_says():
    """Student's band of three runs about a fourth."""
    chance, held, count = random.Random(1), 0, 20000
    for _ in range(count):
        total = Total(0, {}, [chance.gauss(0, 1) for _ in range(4)])
        held += abs(chance.gauss(0, 1)) <= total.half
    assert 0.80 < held / count < 0.92, held / count


def test_directions_add_up_as_squares():
    parts = {"spacing": band([1, 2, 4], [1, 2, 4]), "sound": band([1, 2, 4], [1, 3, 7])}
    total = Total(10, parts, [])
    assert close(total.half, math.hypot(parts["spacing"].half, parts["sound"].half)), total
    assert close(total.limit, 10 + parts["spacing"].shift + parts["sound"].shift), total


def test_a_band_above_the_value_has_no_limit():
    total = Total(1, {"spacing": band([1, 2, 4], [1, 2, 4])}, [])
    assert total.half > 1 and math.isnan(total.limit), total


def test_measures():
    t = np.linspace(0, 4, 801)
    found = measures("a_fx_N_per_m", t, 3 + 0.5 * t + np.sin(2 * np.pi * 1.3 * t))
    assert close(found["frequency"], 1.3, 1e-5) and close(found["impulse"], 16.0846, 1e-3), found
    late = t >= 3
    mean = np.mean(3 + 0.5 * t[late] + np.sin(2 * np.pi * 1.3 * t[late]))
    assert close(found["mean"], mean, 0.01), (found, mean)
    assert "impulse" not in measures("a_dx_m", t, t)


def test_a_peak_between_rows():
    t = 0.1 * np.arange(40)
    assert close(measures("a", t, -(t - 2.03)**2 + 9)["peak"], 9), "parabola"
    assert measures("a", t, t)["peak"] == t[-1]
    assert measures("a", t, -5 * np.ones(40))["peak"] == -5


def test_frequency_of_other_than_sines():
    """A triangle and a decay have one, noise and less than a swing and a half have none."""
    t, chance = np.linspace(0, 3, 900), np.random.default_rng(1)
    triangle = np.abs((1.7 * t) % 1 - 0.5)
    assert close(measures("a", t, triangle)["frequency"], 1.7, 5e-3)
    assert close(measures("a", t, np.exp(-t) * np.sin(20 * t))["frequency"], 20 / 2 / np.pi, 0.02)
    assert math.isnan(measures("a", t, chance.random(900))["frequency"])
    assert math.isnan(measures("a", t, np.sin(2 * t))["frequency"])


def test_from_a_time_on():
    t = np.linspace(0, 4, 401)
    found = measures("a_fx_N_per_m", t, np.where(t < 2, 100.0, t), start=3)
    assert close(found["peak"], 4) and close(found["mean"], 3.5), found
    assert close(found["impulse"], 3.5), found


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
