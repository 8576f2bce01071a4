#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the validation measures, against lattices, curves and runs of known answer. Exit 77: a
package is missing."""

import sys
import types
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import packages
with packages():
    import h5py  # noqa: F401  the snapshots need it
    import numpy as np
    import metrics
    import validation_measures


def lattice(nx, ny, low=(0.0, 0.0)):
    x, y = np.meshgrid(np.arange(nx) + low[0], np.arange(ny) + low[1])
    return np.stack([x.ravel(), y.ravel()], axis=1)


def test_pairs():
    """Against all distances; negative coordinates and empty cells among them."""
    random = np.random.default_rng(1)
    a, b = random.uniform(-3, 3, (60, 2)), random.uniform(-2, 9, (300, 2))
    far = np.hypot(a[:, None, 0] - b[None, :, 0], a[:, None, 1] - b[None, :, 1])
    found = sorted(zip(*metrics.close_pairs(a, b, 0.7)))
    assert found == sorted(zip(*np.nonzero(far < 0.7))) and len(found) > 20


def test_surrounded():
    """Deep in a lattice, on a site of it and off it: counted; at its face, in a corner of two
    walls, in a gap between two rows: not."""
    def count(points, others):
        return metrics.surrounded(np.array(points, dtype=float), others, 1.2, 2 * np.pi / 3)
    body = lattice(8, 6)
    assert count([[3.5, 2.5], [3, 2], [3.3, 2.1], [3.5, 4.5]], body) == 4
    assert count([[3.5, 5.0], [3.5, 5.4], [3, 6], [20, 20]], body) == 0
    corner = np.concatenate([lattice(4, 12, (-3.5, -3.5)), lattice(12, 4, (-3.5, -3.5))])
    assert count([[0.5, 0.5], [0.1, 0.1]], corner) == 0
    assert count([[4, 0.5]], np.concatenate([lattice(9, 1), lattice(9, 1, (0, 9))])) == 0
    assert metrics.surrounded(np.zeros((0, 2)), body, 1.2, 2) == 0


def test_below_floor():
    floor = lattice(20, 4, (-0.5, -3.5))
    drops = np.array([[5.2, -4.4], [5, 0.5], [-1.2, -2.5], [9, -5.9]])
    assert validation_measures.below_floor(drops, floor, 1.0) == 1
    assert validation_measures.below_floor(drops[1:2] + [0, 30], floor, 1.0) == 0


def test_pressed_in():
    """One drop in the second body, two in the wall, and none in the last snapshot."""
    wall, body = lattice(12, 4, (-0.5, -3.5)), lattice(4, 4, (3, 3))
    drops = [np.array([[4.5, 4.5], [2.5, -1.5], [8.0, -2.0], [9.0, 0.5]]), lattice(4, 1, (8, 8))]

    class File:
        times = [0.0, 1.0]

        def load(self, step, name):
            if name == "Points":
                return np.pad(np.concatenate([drops[step], wall, body]), ((0, 0), (0, 1)))
            of = {"kind": (0, 1, 2), "body": (0, 0, 1)}[name]
            return np.repeat(of, (4, len(wall), len(body)))
    run = types.SimpleNamespace(folder=Path("/nowhere"), spacing=lambda: 1.0)
    before, validation_measures.snapshots = validation_measures.snapshots, lambda run: File()
    try:
        assert validation_measures.pressed_in(run) == {
            "pressed_bodies": 1, "pressed_walls": 2, "pressed_share": 0.5}
    finally:
        validation_measures.snapshots = before


def test_frequencies():
    """A slow swing of 1 Hz under 6 Hz; and the first mode of the cantilever of Sec. 3.1 as a thin
    plate."""
    time = np.arange(0, 2, 1e-3)
    curve = 5 + 3 * np.sin(2 * np.pi * time) + np.sin(2 * np.pi * 6 * time)
    fast_time, fast = metrics.about_running_mean(time, curve, 1 / 6)
    assert abs(metrics.mean_frequency(fast_time, fast) - 6) < 0.3
    assert metrics.mean_frequency(time, np.ones_like(time)) == 0
    assert abs(1 / metrics.beam_frequency(2e6, 0.3975, 1000, 0.02, 0.2) - 0.25406) < 2e-4


def main():
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
    print("the validation's measures find what was put there")


if __name__ == "__main__":
    main()
