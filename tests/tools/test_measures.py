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
    import performance_targets
    import validation_cases
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
        assert validation_measures.pressed_in(run) == (1, 2, 0.5)
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


class Made:
    """A report with runs that are made up: mean deflections."""

    def __init__(self, **means):
        self.means, self.found = {name.replace("_", "-"): mean for name, mean in means.items()}, {}

    def first(self, *names):
        return names[0]

    def run(self, name):
        return self.means[name.replace("3.125mm", "fine")]

    def target(self, case, words, measure):
        try:
            self.found[words] = measure()
        except KeyError:
            self.found[words] = None


def test_plate_targets():
    exact = validation_cases.deflections()[0]
    whole, validation_cases.settled = validation_cases.settled, lambda run: {
        "mean": run, "std": -0.019 * run, "half": -0.05 * run}
    try:
        for fine, verdict in ((1.01, ("+1.00 %", True)), (1.03, ("+3.00 %", False))):
            made = Made(plate=exact * 1.05, plate_fine_leapfrog=fine * exact,
                        plate_leapfrog=0.98 * exact)
            validation_cases.plate_targets(made, [("plate", "symplectic")])
            assert made.found["deflection closer to 2-D elasticity at half the spacing"] == verdict
        words = "fluctuation after 0.5 s below 2 % ({}), symplectic"
        assert made.found[words.format("standard deviation")] == ("1.90 %", True)
        assert made.found[words.format("half of the range")] == ("5.00 %", False)
        off = made.found["settled deflection within 4 % of 2-D elasticity, symplectic"]
        assert off == ("+5.00 %", False)
    finally:
        validation_cases.settled = whole


def test_apart():
    """Two curves that differ by a constant, one of them shorter and of other times."""
    time = np.linspace(0, 1, 101)
    run = {"time_s": time, "M1_dx_m": 2 * time}
    other = {"time_s": time[:51:2], "M1_dx_m": 2 * time[:51:2] + 0.1}
    made = [types.SimpleNamespace(folder=Path("/nowhere"), table=lambda name, t=t: t)
            for t in (run, other)]
    off, top = validation_cases.apart(*made, "M1_dx_m")
    assert abs(off - 0.1) < 1e-12 and abs(top - 1.0) < 1e-12


def test_gained():
    """The rows up to an instant only, and as the ledger's own reader names them."""
    ledger = {"time": np.array([0, 1, 2, 3.0]), "dissipated": np.array([0, 2, 1.5, -4])}
    before, validation_cases.read_ledger = validation_cases.read_ledger, lambda run: ledger
    try:
        assert validation_cases.gained(None, 2.0) == 0.5
        assert validation_cases.gained(None, 3.0) == 6.0
    finally:
        validation_cases.read_ledger = before


def test_performance_targets():
    """Seconds and rates against their limits; a run and a number that are not there."""
    rows = performance_targets.run_rows({"gate, dp = 1 mm, leapfrog": {"seconds": 11.9},
                                         "cantilever, ts/dp = 20": {"seconds": 10.1, "rate": 31}})
    found = {(row[0], row[2]): row[3:] for row in rows}
    assert found["gate, dp = 1 mm, leapfrog", "at most 12 s"] == ("11.9", "met")
    assert found["cantilever, ts/dp = 20", "at most 10 s"] == ("10.1", "**missed**")
    assert found["cantilever, ts/dp = 20", "at least 30 million particle steps a second"] == ("31",
                                                                                              "met")
    assert found["hydrostatic plate, leapfrog", "at most 150 s"] == ("no result", "not run")

    def value(what, variant, particles, threads, part):
        if part == "all":
            return 60 + particles / 1e4
        return 240 if part == "memory" else float("nan")
    rows = performance_targets.bench_rows(value, [10000, 100000],
                                          {"gate": {"sort": 1, "output": 4, "x": 95}},
                                          {"steps alone": 1.9})
    assert [row[4] for row in rows] == ["met", "met", "met", "**missed**", "met"]
    assert rows[1][3] == "1.15"


def main():
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
    print("the validation's measures find what was put there")


if __name__ == "__main__":
    main()
