#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Manufactured solutions: the solid converges with second order, and the
source of the fluid is that of its fields. Exit 77: a package is missing."""

import sys
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import packages
with packages():
    import manufactured
    import numpy as np


def test_order_of_the_solid():
    errors = [manufactured.run_solid(ratio)["displacement"] for ratio in (10, 20)]
    assert errors[1] < 0.008 and manufactured.order((10, 20), errors) > 1.8, errors


def test_source_of_the_fluid():
    """v_t + (v . grad) v + grad P/rho - (nu rho0/rho) lap v by differences, at some places."""
    x, y, t, e = np.array([0.13, 0.41, 0.77]), np.array([0.29, 0.62, 0.93]), 0.07, 1e-4
    for flow in manufactured.FLOWS.values():
        def at(dx=0.0, dy=0.0, dt=0.0):
            p = SimpleNamespace(x=x + dx, y=y + dy)
            return np.array(flow.velocity(p, t + dt)), flow.pressure(p)
        (v, P), (left, right, down, up) = at(), [at(dx, dy) for dx,
                                                 dy in ((-e, 0), (e, 0), (0, -e), (0, e))]
        rate = (at(dt=e)[0] - at(dt=-e)[0]) / (2 * e)
        slope_x, slope_y = (right[0] - left[0]) / (2 * e), (up[0] - down[0]) / (2 * e)
        laplacian = (left[0] + right[0] + up[0] + down[0] - 4 * v) / e**2
        density = manufactured.DENSITY * (1 + 7 * P /
                                          (manufactured.DENSITY * manufactured.SOUND**2))**(1 / 7)
        pressure = np.array([right[1] - left[1], up[1] - down[1]]) / (2 * e * density)
        viscosity = manufactured.VISCOSITY * manufactured.DENSITY / density
        source = rate + v[0] * slope_x + v[1] * slope_y + pressure - viscosity * laplacian
        found = np.array(flow.acceleration(SimpleNamespace(x=x, y=y, time=t)))
        assert np.allclose(found, source, rtol=1e-5, atol=1e-4), (found, source)
        assert np.allclose(slope_x[0] + slope_y[1], 0, atol=1e-5)


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(f"ok {name}")
