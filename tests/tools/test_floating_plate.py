#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The floating plate of linear theory: it conserves energy, has the limits of a plate without
stiffness, of a rigid one and of a dock in shallow water, and does not depend on the side from which
the waves come. Exit 77: a package is missing."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "support"),
                str(Path(__file__).resolve().parents[2] / "cases" / "reference")]
from scripts import packages
with packages():
    import floating_plate as theory
    import numpy as np

RHO_G = theory.RHO * theory.G


def plate(kd, length, stiffness, mass=1.0, **more):
    """In waves of k = 1/m."""
    omega = np.sqrt(theory.G * np.tanh(kd))
    return theory.Plate(omega, kd, length, stiffness * RHO_G, mass, **more)


def energy(p):
    return abs(p.reflected)**2 + abs(p.transmitted)**2


def test_energy_is_conserved():
    for stiffness in (0.01, 1, 10):
        assert abs(energy(plate(2, 6, stiffness)) - 1) < 1e-4
        p = plate(2, 6, stiffness, 150, draft=0.15, edge=0.3, pull=30)
        assert abs(energy(p) - 1) < 1e-4


def test_a_plate_without_stiffness_follows_the_water():
    p = plate(2, 6, 1e-4, 0.01)
    assert abs(p.reflected) < 2e-3 and abs(p.transmitted - 1) < 0.01
    x = np.linspace(0, 6, 20)
    assert abs(p.elevation(x) / np.exp(1j * x) - 1).max() < 0.01


def test_a_stiff_plate_is_rigid():
    p = plate(2, 6, 1e5)
    x = np.linspace(0, 6, 20)
    w = p.elevation(x)
    assert abs(w - np.polyval(np.polyfit(x, w, 1), x)).max() < 1e-4
    assert abs(abs(p.reflected) / abs(plate(2, 6, 1e6).reflected) - 1) < 1e-3


def test_a_dock_in_shallow_water():
    """A plate that hardly moves: the water below it moves as one, 1/T = 1 - i k L/2."""
    for length in (1.0, 3.0):
        p = plate(0.05, length, 1e5, 1e9, panels=300, away=6.0)
        assert abs(abs(p.transmitted) * np.hypot(1, length / 2) - 1) < 0.006, abs(p.transmitted)


def test_the_green_function_of_the_open_surface():
    """Values by the integral equation of Meylan and Squire with the Green function of this depth,
    without draft, for a plate as long as the wave and kd = 2."""
    for stiffness, reflected, front, middle, back in ((0.3, 0.0319, 1.237, 0.769, 1.201),
                                                      (4, 0.4311, 0.905, 0.407, 0.982),
                                                      (100, 0.5829, 1.125, 0.262, 0.852)):
        p = plate(2, 2 * np.pi, stiffness)
        found = abs(p.elevation([0, np.pi, 2 * np.pi]))
        assert abs(abs(p.reflected) - reflected) < 1e-3
        assert abs(found - (front, middle, back)).max() < 2e-3, found


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(f"ok {name}")
