#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""An added mass and a wave along an elastic layer converge to their exact solutions, for light and
heavy bodies, with the order of the exchange in space and in time. Exit 77: a package is missing."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import packages
with packages():
    import cffi  # noqa: F401  the library needs it
    import exact_fsi
    from metrics import order


def test_space():
    for name, ratios in (("column", (25, 50)), ("layer", (16, 32))):
        for density, steps in ((0.1, "implicit"), (1, "explicit"), (100, "implicit")):
            problem = exact_fsi.PROBLEMS[name](density)
            errors = [exact_fsi.in_space(problem, density, steps, ratio) for ratio in ratios]
            for column in zip(*errors):
                assert column[1] < 0.25 and order(ratios, column) > 0.7, (name, density, errors)


def test_time():
    errors = exact_fsi.in_time(exact_fsi.PROBLEMS["layer"](1), 1, "implicit")
    for column in zip(*errors):
        assert order(exact_fsi.COUNTS, column) > 1.6, errors


test_space()
test_time()
