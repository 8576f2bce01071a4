#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Linear theory of rigid bodies in water, which shares no code with the solver: the heave of a
cylinder in a tank and the roll of a box in deep water.

  cases/reference/rigid.py    writes rigid_heave.csv and rigid_roll.csv beside it
"""
import math
from pathlib import Path

import numpy as np

G, RHO = 9.81, 1000.0
HEAVE_WORDS = """\
# COMPUTED: height over its start of the cylinder of cases/verify/rigid_heave.cfg, by boundary
# elements: cases/reference/rigid.py.
time_s,height"""
ROLL_WORDS = """\
# COMPUTED: angle of the box of cases/verify/rigid_roll.cfg after a spin of 1 rad/s in deep water,
# without vortices: cases/reference/rigid.py.
time_s,angle_rad"""


def exp_e1(z):
    """exp(z) E1(z), by the series of E1."""
    term, total = np.ones_like(z), -np.euler_gamma - np.log(z)
    for k in range(1, 120):
        term = term * -z / k
        total = total - term / k
    return np.exp(z) * total


def potentials(at, a, b, normal):
    """Integrals of ln r and of its derivative along `normal` over the panels from a to b, seen from
    the points `at`."""
    length = abs(b - a)
    place = (at[:, None] - a) * np.conj(b - a) / length
    x, y = place.real, place.imag
    seen = np.arctan2(length * abs(y), x * (x - length) + y**2)
    value = x * np.log(abs(place)) - (x - length) * np.log(abs(place - length)) - length
    turn = np.sign((np.conj(1j * (b - a)) * normal).real)
    return value + abs(y) * seen, np.where(abs(y) < 1e-12, 0, -np.sign(y) * seen * turn)


def heave(times, radius, depth, half):
    """Height over its initial value of a half-submerged cylinder of half the water's density,
    released from rest in the middle of a tank: linear theory in time, with boundary elements on
    the hull, the surface and the end, and their images in the bed and the middle. The pressures
    that accelerate the cylinder follow from the height of the surface at once."""
    count = 32, 90, 24
    part = [np.linspace(0, 1, n + 1) for n in count]
    ends = (-1j * radius * np.exp(0.5j * math.pi * part[0]),
            radius + (half - radius) * np.sinh(3 * part[1]) / math.sinh(3) + 0j,
            half - 1j * depth * part[2])
    a, b = (np.concatenate([line[cut] for line in ends]) for cut in (np.s_[:-1], np.s_[1:]))
    middle, length = (a + b) / 2, abs(b - a)
    hull, surface = np.s_[:count[0]], np.s_[count[0]:count[0] + count[1]]
    normal = np.repeat([0, 1j, 1], count)  # out of the water
    normal[hull] = -middle[hull] / abs(middle[hull])
    up = normal[hull].imag * length[hull]

    def below(z):
        return np.conj(z) - 2j * depth
    images = [(a, b, normal), (below(a), below(b), np.conj(normal))]
    images += [tuple(-np.conj(z) for z in image) for image in images]
    single, double = sum(np.array(potentials(middle, *image)) for image in images)
    double -= math.pi * np.eye(len(a))  # double phi = single dphi/dn
    known, solve = double[:, surface].copy(), double.copy()
    solve[:, surface] = -single[:, surface]
    by_speed = np.linalg.solve(solve, single[:, hull] @ normal[hull].imag)
    by_surface = np.linalg.solve(solve, -known)
    mass = RHO * math.pi * radius**2 / 2
    whole = mass + 2 * RHO * up @ by_speed[hull]

    def rate(state):
        height, speed, (level, potential) = state[0], state[1], np.split(state[2:], 2)
        force = -2 * RHO * G * (radius * height - up @ by_surface[hull] @ level)
        return np.concatenate([[speed, force / whole], by_surface[surface] @ potential
                               + by_speed[surface] * speed, -G * level])
    state, found, step = np.zeros(2 + 2 * count[1]), [], (times[1] - times[0]) / 4
    state[0] = 1
    for k in range(4 * len(times)):
        if k % 4 == 0:
            found.append(state[0])
        one = rate(state)
        two = rate(state + step / 2 * one)
        three = rate(state + step / 2 * two)
        state = state + step / 6 * (one + 2 * (two + three) + rate(state + step * three))
    return np.array(found)


def roll_coefficients(width, draft, omega, panels=20):
    """Added inertia and damping of a box that rolls about the middle of its waterline in deep
    water: sources on the hull with the potential of Frank (1967)."""
    corners = np.array([-width / 2, -width / 2 - 1j * draft, width / 2 - 1j * draft, width / 2])
    part = (1 - np.cos(np.pi * np.arange(panels) / panels)) / 2
    sides = [a + (b - a) * part for a, b in zip(corners, corners[1:])]
    ends = np.concatenate([*sides, corners[-1:]])
    a, b, k = ends[:-1], ends[1:], omega**2 / G
    middle, length, normal = (a + b) / 2, abs(b - a), -1j * (b - a) / abs(b - a)
    own, n = np.eye(len(middle), dtype=bool), normal[:, None]
    potential = np.where(own, length * (np.log(length / 2) - 1), 0j)
    speed = np.where(own, math.pi, 0j)
    for s, weight in zip(*np.polynomial.legendre.leggauss(4)):
        source = middle + s * (b - a) / 2
        to, image = middle[:, None] - source, middle[:, None] - np.conj(source)
        near = np.where(own, 1, to)
        at = k * (image.imag + 1j * abs(image.real))
        wave, turn = np.exp(at), k * (n.imag + 1j * n.real * np.where(image.real < 0, -1, 1))
        both, slope = exp_e1(at) + 1j * math.pi * wave, exp_e1(at) - 1 / at + 1j * math.pi * wave
        potential += weight * length / 2 * (
            np.log(abs(near)) - np.log(abs(image)) - 2 * (both.real - 1j * math.pi * wave.real))
        speed += weight * length / 2 * (
            np.where(own, 0, (n / near).real) - (n / image).real
            - 2 * ((slope * turn).real - 1j * math.pi * (wave * turn).real))
    motion = (np.conj(middle) * normal).imag
    moment = RHO * (potential @ np.linalg.solve(speed, motion) * motion * length).sum()
    return -moment.real, omega * moment.imag


def roll(times, width, spin):
    """Angle of a box twice as wide as high and half as dense as water, on a hinge at its centre,
    after a spin at the start: the Fourier integral of the linear equation of motion."""
    draft, some = width / 4, np.linspace(0.5, 16, 60)
    found = np.array([roll_coefficients(width, draft, omega) for omega in some]).T
    omega = np.linspace(0.05, 16, 4000)
    added, damping = (np.interp(omega, some, column) for column in found)
    inertia = RHO / 2 * width * 2 * draft * (width**2 + 4 * draft**2) / 12
    stiffness = RHO * G * (width**3 / 12 - width * draft**2 / 2)
    angle = inertia * spin / (stiffness - omega**2 * (inertia + added) + 1j * omega * damping)
    return 2 / math.pi * np.trapezoid(angle.real * np.cos(np.outer(times, omega)), omega, axis=1)


def write_table(name, words, rows):
    table = Path(__file__).with_name(name)
    lines = [words, *(",".join(f"{value:.8g}" for value in row) for row in rows)]
    table.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"written {table}")


def main():
    times = np.arange(0, 1.601, 0.005)
    write_table("rigid_heave.csv", HEAVE_WORDS, zip(times, heave(times, 0.1, 0.6, 4.4)))
    times = np.arange(0, 2.601, 0.01)
    write_table("rigid_roll.csv", ROLL_WORDS, zip(times, roll(times, 0.4, 1.0)))


if __name__ == "__main__":
    main()
