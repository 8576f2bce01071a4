#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""References of contact that share no code with the solver: a disc of finite elements that meets a
rigid wall, and a beam by finite differences that lies down on a floor.

  cases/reference/contact.py    writes contact_disc.csv and contact_fold.csv beside it
"""
import math

from pathlib import Path

import numpy as np

DISC_WORDS = """\
# COMPUTED: a disc of 0.1 m (1000 kg/m^3, 1 MPa, Poisson's ratio 0.3, neo-Hookean) falls
# on a rigid wall. Finite elements, 24 over half of its width: cases/reference/contact.py.
# `way` is that of its centre after the first touch, until the last of which `contact` counts.
speed_m_per_s,restitution,way_m,contact_s"""
FOLD_WORDS = """# COMPUTED: axis of the arm of cases/verify/contact_fold.cfg, by finite differences:
# cases/reference/contact.py.
x_m,y_m"""


# --- a disc of four-node elements ---
def disc_mesh(n, radius):
    """Nodes, elements and the nodes of the circle: a block of n by n elements amid four that reach
    the circle."""
    s, layers = np.linspace(-1, 1, n + 1), max(1, round(0.6 * n))
    u, v = np.meshgrid(s, s)
    size, bulge = 0.45 * radius, 0.12
    inner = np.stack([size * u * (1 + bulge * (1 - v * v)), size * v * (1 + bulge * (1 - u * u))],
                     -1).reshape(-1, 2)
    k = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    elements = [np.stack([k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]], -1).reshape(-1, 4)]
    ring = np.concatenate([k[0, :-1], k[:-1, -1], k[-1, :0:-1], k[:0:-1, 0]])
    angle = -0.75 * math.pi + 2 * math.pi * np.arange(4 * n) / (4 * n)
    circle = radius * np.stack([np.cos(angle), np.sin(angle)], -1)
    nodes, before, count = [inner], ring, len(inner)
    for layer in range(1, layers + 1):
        part = layer / layers
        nodes.append((1 - part) * inner[ring] + part * circle)
        now = count + np.arange(4 * n)
        count += 4 * n
        elements.append(np.stack([before, now, np.roll(now, -1), np.roll(before, -1)], -1))
        before = now
    return np.concatenate(nodes), np.concatenate(elements), before


class Disc:
    """Neo-Hookean (T-21), plane strain, four points of integration, masses at the nodes."""

    def __init__(self, n, radius, density, young, poisson):
        self.nodes, elements, self.edge = disc_mesh(n, radius)
        self.element = elements.T
        self.lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
        self.shear = young / (2 * (1 + poisson))
        slopes, weights, g = [], [], 1 / math.sqrt(3)
        for a, b in ((-g, -g), (g, -g), (g, g), (-g, g)):
            slope = 0.25 * np.array([[-(1 - b), -(1 - a)], [1 - b, -(1 + a)],
                                     [1 + b, 1 + a], [-(1 + b), 1 - a]])
            jacobian = np.einsum("ena,nb->eab", self.nodes[elements], slope)
            slopes.append(np.einsum("nb,ebc->nec", slope, np.linalg.inv(jacobian)))
            weights.append(np.linalg.det(jacobian))
        self.slope, self.weight = np.array(slopes), np.array(weights)
        area = self.weight.sum(axis=0)
        self.mass = density * np.bincount(elements.ravel(), np.repeat(area / 4, 4), len(self.nodes))
        sides = [np.hypot(*(self.nodes[elements[:, k]] - self.nodes[elements[:, k - 1]]).T)
                 for k in range(4)]
        self.step = 0.5 * min(s.min()
                              for s in sides) / math.sqrt((self.lame + 2 * self.shear) / density)

    def force(self, u):
        ux, uy = u[self.element, 0], u[self.element, 1]
        bx, by = self.slope[..., 0], self.slope[..., 1]
        xx, xy = 1 + (bx * ux).sum(axis=1), (by * ux).sum(axis=1)
        yx, yy = (bx * uy).sum(axis=1), 1 + (by * uy).sum(axis=1)
        det = xx * yy - xy * yx
        q = (self.lame / 2 * (det * det - 1) - self.shear) / det
        pxx, pxy = self.weight * (self.shear * xx + q * yy), self.weight * (self.shear * xy - q *
                                                                            yx)
        pyx, pyy = self.weight * (self.shear * yx - q * xy), self.weight * (self.shear * yy + q *
                                                                            xx)
        fx = -(pxx[:, None] * bx + pxy[:, None] * by).sum(axis=0)
        fy = -(pyx[:, None] * bx + pyy[:, None] * by).sum(axis=0)
        return np.stack([np.bincount(self.element.ravel(), f.ravel(), len(self.nodes))
                         for f in (fx, fy)], -1)


def disc_impact(speed, radius, density, young, poisson, n):
    """Of a disc that falls on a rigid wall: restitution, way of its centre after the first touch,
    m, and time until the last one, s. The wall is a spring per node, as stiff as a twentieth of an
    element."""
    disc = Disc(n, radius, density, young, poisson)
    below = disc.edge[disc.nodes[disc.edge, 1] < 0]
    spring = 20 * young
    step = min(disc.step, 0.7 * math.sqrt(disc.mass[below].min() / spring))
    u, v = np.zeros_like(disc.nodes), np.zeros_like(disc.nodes)
    v[:, 1] = -speed
    time = last = lowest = 0.0
    while time < last + 0.06 * radius / speed or time < radius / speed / 10:
        force = disc.force(u)
        push = -spring * np.minimum(0, disc.nodes[below, 1] + u[below, 1] + radius)
        force[below, 1] += push
        v += step * force / disc.mass[:, None]
        u += step * v
        time += step
        last = time if push.any() else last
        lowest = min(lowest, float(disc.mass @ u[:, 1]))
    mass = disc.mass.sum()
    return float(disc.mass @ v[:, 1]) / mass / speed, -lowest / mass, last


# --- a beam that lies down ---
def beam_elements(q, stiffness, length):
    """Forces and tangents of the elements of Reissner's beam (1972); q is x, y, angle of each
    node."""
    axial, lateral, bending = stiffness
    d, angle = np.diff(q[:, :2], axis=0) / length, 0.5 * (q[1:, 2] + q[:-1, 2])
    c, s, turn = np.cos(angle), np.sin(angle), np.diff(q[:, 2]) / length
    along, across = c * d[:, 0] + s * d[:, 1], -s * d[:, 0] + c * d[:, 1]
    normal, shear, moment = axial * (along - 1), lateral * across, bending * turn
    of_along = np.stack([c, s, length * across], -1) / length
    of_across = np.stack([-s, c, -length * along], -1) / length
    force3 = length * (normal[:, None] * of_along + shear[:, None] * of_across)
    tangent3 = length * (axial * of_along[:, :, None] * of_along[:, None, :] +
                         lateral * of_across[:, :, None] * of_across[:, None, :])
    tangent3[:, 0, 2] += -normal * s - shear * c
    tangent3[:, 1, 2] += normal * c - shear * s
    tangent3[:, 2, 0], tangent3[:, 2, 1] = tangent3[:, 0, 2], tangent3[:, 1, 2]
    tangent3[:, 2, 2] -= length * (normal * along + shear * across)
    ends = np.array([[-1, 0, 0, 1, 0, 0], [0, -1, 0, 0, 1, 0], [0, 0, 0.5, 0, 0, 0.5]])
    force = force3 @ ends
    tangent = np.einsum("ka,ekl,lb->eab", ends, tangent3, ends)
    force[:, 2] -= moment
    force[:, 5] += moment
    for a, b, sign in ((2, 2, 1), (5, 5, 1), (2, 5, -1), (5, 2, -1)):
        tangent[:, a, b] += sign * bending / length
    return force, tangent


def lying_beam(length, thick, young, poisson, weight, drop, n=200):
    """Heights of n + 1 points of the axis of a beam that is held level at one end and lies on a
    floor `drop` below it: plane strain, shear coefficient 5/6, `weight` per length. The floor
    yields by a thousandth of `thick`."""
    plane = young / (1 - poisson ** 2)
    stiffness = plane * thick, 5 / 6 * young / (2 * (1 + poisson)) * thick, plane * thick ** 3 / 12
    q, part = np.zeros((n + 1, 3)), length / n
    q[:, 0] = places = np.linspace(0, length, n + 1)
    lengths = np.full(n + 1, part)
    lengths[[0, -1]] = part / 2
    floor, free = 1000 * weight / thick * lengths, slice(3, None)
    rows = 3 * np.arange(n)[:, None] + np.arange(6)
    for load in np.linspace(0.02, 1, 50):
        step = np.ones(1)
        while abs(step).max() > 1e-10:
            force, tangent = beam_elements(q, stiffness, part)
            residual, matrix = np.zeros(q.size), np.zeros((q.size, q.size))
            np.add.at(residual, rows, force)
            np.add.at(matrix, (rows[:, :, None], rows[:, None, :]), tangent)
            sunk = np.maximum(0, -drop - q[:, 1])
            residual[1::3] += load * weight * lengths - floor * sunk
            matrix[1::3, 1::3][np.diag_indices(n + 1)] += floor * (sunk > 0)
            step = -np.linalg.solve(matrix[free, free], residual[free])
            q[1:] += (step * min(1, 0.3 / max(abs(step).max(), 0.3))).reshape(-1, 3)
    return places, q[:, 1]


def write_table(name, words, rows):
    table = Path(__file__).with_name(name)
    lines = [words, *(",".join(f"{value:.8g}" for value in row) for row in rows)]
    table.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"written {table}")


def main():
    speeds = (1.0, 3.0)
    write_table("contact_disc.csv", DISC_WORDS, [
        (speed, *disc_impact(speed, 0.05, 1000, 1e6, 0.3, n=24)) for speed in speeds])
    write_table("contact_fold.csv", FOLD_WORDS, zip(*lying_beam(0.5, 0.02, 3e6, 0.3,
                                                                1000 * 9.81 * 0.02, 0.05)))


if __name__ == "__main__":
    main()
