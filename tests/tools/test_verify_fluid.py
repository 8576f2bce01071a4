#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The figures of tools/report/verify_fluid.py, of made-up runs with known answers. Exit
77: a package is missing."""

import math
import sys
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import packages
with packages():
    import numpy as np
    import verify_fluid as of


class Made:
    """A run with the tables and snapshots that are given: (fluid, bodies) each."""

    def __init__(self, table=None, shots=(), dp=1.0):
        self.made, self.shots, self.dp, self.end_time = table, shots, dp, 1

    def table(self, _):
        return self.made

    def snapshots(self, _):
        for step, (fluid, bodies) in enumerate(self.shots):
            shots = mock.Mock(times=np.arange(len(self.shots)))
            fields = {"Points": np.vstack([fluid, bodies]),
                      "kind": np.array([of.FLUID] * len(fluid) + [1] * len(bodies))}
            shots.load = lambda _, name, fields=fields: fields[name]
            yield shots, step


def test_a_travelling_wave():
    """0.5 % too fast, with a loss of 2 % a period and a standing second harmonic."""
    k, T = 2 * math.pi / 1.2, math.tanh(2 * math.pi * 0.36 / 1.2)
    omega = math.sqrt(9.81 * k * T *
                      (1 + (9 - 10 * T**2 + 9 * T**4) / (8 * T**4) * (k * 0.03) ** 2))
    t = np.linspace(0, 5 * 2 * math.pi / omega, 1000)
    size = 0.03 * 0.98 ** (t * omega / (2 * math.pi))
    table = {"time_s": t}
    for j in range(8):
        x = (j + 0.5) / 8 * 1.2
        table[f"at{j}_level_m"] = 0.36 + size * np.cos(k * x - 1.005 * omega *
                                                       t) + 0.002 * np.cos(2 * k * x)
    (_, fast, _), (_, loss, _) = of.travel_of(True)(Made(table))
    assert abs(fast - 0.5) < 1e-3 and abs(loss - 2) < 1e-3, (fast, loss)


def test_runs_that_differ_in_round_off():
    """Means with their scatter, and the worst run of what must not be."""
    made = iter(((1, 0, 0.7, 2), (2, 3, 0.6, 1), (6, 1, 0.8, 0)))

    def measure(_):
        noise, inside, near, gap = next(made)
        return [("noise", noise, 5), ("particles inside", inside, 0), ("nearest", near, None),
                ("widest cavity", gap, 1)]
    assert of.over(measure)([None] * 3) == [
        ("noise, mean of 3", 3, 5), ("its standard deviation", math.sqrt(7), None),
        ("particles inside, worst of 3", 3, 0), ("nearest, worst of 3", 0.6, None),
        ("widest cavity, worst of 3", 2, 1)]


def test_a_standing_wave():
    """Kinetic energy of a wave 1 % too fast whose amplitude loses 3 % a period."""
    k = 2 * math.pi / 0.9
    omega = 1.01 * math.sqrt(9.81 * k * math.tanh(k * 0.3))
    t = np.arange(0, 7 * 2 * math.pi / omega, 0.001)
    decay = 0.97 ** (2 * t * omega / (2 * math.pi))
    table = {"time_s": t, "kinetic_J_per_m": decay * np.cos(omega * t) ** 2}
    (_, fast, limit), (_, loss, free) = of.wave_of("frequency")(Made(table))
    assert abs(fast - 1) < 0.01 and abs(loss - 3) < 0.01, (fast, loss)
    assert (limit, free) == (1, None)


LATTICE = np.array([(-0.5 - i, 0.5 + j) for i in range(10) for j in range(12)])
WALL = np.array([(0.5, 0.5 + j) for j in range(12)])


def at_the_wall(fluid, what):
    run = Made(shots=[(fluid, WALL)])
    with mock.patch.object(of, "steps_of", run.snapshots):
        return what(run)


def test_particles_that_enter():
    assert at_the_wall(LATTICE, of.entered) == (0, 1.0)
    count, least = at_the_wall(np.vstack([LATTICE, [(0.2, 3.5)]]), of.entered)
    assert count == 1 and abs(least - 0.3) < 1e-12, (count, least)


def test_a_cavity_is_below_water_that_touches_the_face():
    def widest(run):
        return of.cavity(run, 0, -1)
    x, y = LATTICE.T
    assert at_the_wall(LATTICE, widest) == 0
    assert at_the_wall(LATTICE[(x < -3) | (y < 2) | (y > 5)], widest) == 3
    assert at_the_wall(LATTICE[(x < -3) | (y < 2)], widest) == 0  # open above
    drops = np.array([(-3.5 - i, 20.5 + j) for i in range(4) for j in range(12)])
    # drops in the air hang on no water
    assert at_the_wall(np.vstack([LATTICE, drops]), widest) == 0


def test_a_wave_without_a_period_has_no_figure():
    t = np.arange(0, 7, 0.001)
    found = of.wave_of("frequency")(Made({"time_s": t, "kinetic_J_per_m": np.exp(-t)}))
    assert all(math.isnan(figure) for _, figure, _ in found), found


def test_a_front_against_potential_flow():
    """Three runs that lag by 4, 2 and 1 %."""
    time, place = of.reference("dam_break_front_potential.csv")
    seconds = time * math.sqrt(0.6 / 9.81)
    runs = [Made({"time_s": seconds, "front_m": 0.6 * place * (1 - 0.8 / ratio)}, dp=0.6 / ratio)
            for ratio in (20, 40, 80)]
    found = of.measure_free_front(runs)
    assert np.allclose([figure for _, figure, _ in found], [-4, -2, -1, 1]), found
    assert [limit for _, _, limit in found] == [None, 5, None, None]


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(f"ok {name}")
