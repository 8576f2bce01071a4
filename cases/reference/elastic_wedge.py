#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The plates of an elastic wedge that enters water at constant speed, by Wagner's theory, which
shares no code with the solver (Scolan 2004, J. Sound Vib. 277, 163; Khabakhpasheva and Korobkin
2013, J. Fluids Struct. 36, 32).

  cases/reference/elastic_wedge.py    writes elastic_wedge.csv beside it

The plates are beams of Euler and Bernoulli, a sum of modes psi_m of a beam that is clamped at
both ends. The potential phi is that of a flat surface: phi_y = -V + sum a'_m psi_m where |x| < c,
phi = 0 beyond. The pressure is -rho phi_t. The contact ends at x = c(t), where the mean of the
height of the plate over the angle arcsin(x/c) vanishes (Wagner's condition)."""
from pathlib import Path

import numpy as np

RHO, SPEED, WIDTH, SLOPE = 1000.0, 30.0, 0.6, np.tan(np.radians(10))
THICK, DENSITY, YOUNG, POISSON = 0.04, 2700.0, 67.5e9, 0.34
MODES, END, STEP = 8, 2.2e-3, 1e-5
WORDS = """\
# COMPUTED: deflection in the middle of a plate of cases/verify/elastic_wedge.cfg, half the width
# of the contact, and the impulse of the water on a plate: cases/reference/elastic_wedge.py. From
# 1 ms on within 2 % of Scolan (2004), as G. Zhang et al., A delta SPH-SPIM coupled method, J.
# Fluids Struct. 101 (2021), show it; digitised, second-hand. Without elasticity the impulse is
# 17 % above that of the similarity solution of Zhao and Faltinsen (1993) for this deadrise.
time_s,deflection_m,contact_m,impulse_Ns_per_m"""


def clamped_modes():
    """k L of the modes, and psi(x/L) of each."""
    numbers = (np.arange(1, MODES + 1) + 0.5) * np.pi
    for _ in range(20):  # cos(k) cosh(k) = 1
        numbers += (np.cos(numbers) - 1 / np.cosh(numbers)) / (
            np.sin(numbers) - np.sinh(numbers) / np.cosh(numbers)**2)
    ratio = (np.cosh(numbers) - np.cos(numbers)) / (np.sinh(numbers) - np.sin(numbers))
    return numbers, lambda x: (np.cosh(np.outer(numbers, x)) - np.cos(np.outer(numbers, x))
                               - ratio[:, None] * (np.sinh(np.outer(numbers, x))
                                                   - np.sin(np.outer(numbers, x))))


class Wedge:
    def __init__(self):
        self.numbers, self.psi = clamped_modes()
        length = WIDTH * np.hypot(1, SLOPE)
        bending = YOUNG / (1 - POISSON**2) * THICK**3 / 12
        x = (np.arange(2000) + 0.5) / 2000
        square = length * (self.psi(x)**2).mean(axis=1)
        self.mass = np.diag(DENSITY * THICK * square)
        self.stiffness = bending * (self.numbers / length)**4 * square
        self.angle = (np.arange(400) + 0.5) * np.pi / 400
        self.waves = np.arange(1, 80, 2)
        self.sines = np.sin(np.outer(self.waves, self.angle))

    def water(self, c):
        """Added mass over rho, the impulse by a unit of speed over rho, and mean of each mode."""
        shape = self.psi(abs(c * np.cos(self.angle)) / WIDTH)
        part = (shape * np.sin(self.angle)) @ self.sines.T
        part *= 2 * c / (self.waves * len(self.angle))
        return (np.pi / 4 * (part * self.waves) @ part.T, np.pi / 4 * c * part[:, 0],
                shape.mean(axis=1))

    def rate(self, time, state):
        """Of the coordinates a_m and of the momentum of each mode."""
        where, momentum = np.split(state, 2)
        c = np.pi / 2 * SPEED * time / SLOPE
        for _ in range(40):
            c = np.pi / 2 * (SPEED * time - where @ self.water(c)[2]) / SLOPE
        added, force, _ = self.water(c)
        speed = np.linalg.solve(self.mass + RHO * added, momentum + RHO * SPEED * force)
        self.contact = c
        self.impulse = RHO * (np.pi / 4 * SPEED * c**2 - force @ speed)
        return np.concatenate([speed, -self.stiffness * where])

    def rows(self):
        state, middle = np.zeros(2 * MODES), self.psi([0.5])[:, 0]
        for k in range(round(END / STEP) + 1):
            one = self.rate(k * STEP, state)
            yield k * STEP, middle @ state[:MODES], self.contact, self.impulse
            two = self.rate((k + 0.5) * STEP, state + STEP / 2 * one)
            three = self.rate((k + 0.5) * STEP, state + STEP / 2 * two)
            four = self.rate((k + 1) * STEP, state + STEP * three)
            state = state + STEP / 6 * (one + 2 * (two + three) + four)


def main():
    table = Path(__file__).with_suffix(".csv")
    lines = [WORDS, *(",".join(f"{value:.6g}" for value in row) for row in Wedge().rows())]
    table.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"written {table}")


if __name__ == "__main__":
    main()
