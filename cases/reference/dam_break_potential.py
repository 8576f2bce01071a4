#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Front of a dam break on a dry bed by potential flow, as a reference whose time origin is exact.

  cases/reference/dam_break_potential.py                    writes the table beside it (3 min)
  cases/reference/dam_break_potential.py --spacing 0.008    a coarser solution, to the screen

A square column of water, at rest between a wall and a plate, is free at t = 0. The fluid is
incompressible and has no friction, so its velocity has a potential. Unit of length is the height H,
of time sqrt(H/g).

Method (Longuet-Higgins and Cokelet 1976): nodes of the free surface move with the fluid, their
potential changes by u^2/2 - y. The normal velocity follows from the potential by Green's identity
over straight elements, whose integrals are exact. The mirror images in the wall and in the bed take
the place of both, so that only the free surface has nodes. Steps are those of Runge and Kutta.
After each the nodes are set anew on cubic splines and smoothed by the formula of five points of
that article.

At t = 0 the acceleration is infinite at the foot (Pohle 1952), as the logarithm of the distance.
The spacing of the nodes is least there, and the nose of the tongue is as round as they resolve it.
The upper corner has a radius, CORNER."""
import argparse
import math
from pathlib import Path

import numpy as np

TABLE = Path(__file__).with_name("dam_break_front_potential.csv")
CORNER = 0.02
END, ROWS = 1.8, 36
HEAD = """\
# COMPUTED: front of a dam break on a dry bed, x/H against t sqrt(g/H), x from the wall behind the
# column of H x H. Potential flow, free at t = 0: cases/reference/dam_break_potential.py.
# {error}
time_nd,front_nd
"""


def second_derivatives(s, f, first, last):
    """Of the cubic spline through f(s); each end is 'even' (no slope) or 'odd' (no curvature)."""
    h, n = np.diff(s), len(s)
    slopes, i = np.diff(f) / h, np.arange(1, n - 1)
    matrix, right = np.zeros((n, n)), np.zeros(n)
    matrix[i, i - 1], matrix[i, i], matrix[i, i + 1] = h[:-1], 2 * (h[:-1] + h[1:]), h[1:]
    right[1:-1] = 6 * np.diff(slopes)
    for row, near, part, end, sign in ((0, 1, 0, first, 1), (n - 1, n - 2, -1, last, -1)):
        matrix[row, row] = 1
        if end == "even":
            matrix[row, row], matrix[row, near] = 2 * h[part], h[part]
            right[row] = 6 * sign * slopes[part]
    return np.linalg.solve(matrix, right)


class Spline:
    """Cubic spline: its values, and its slope at the nodes."""

    def __init__(self, s, f, first, last):
        self.s, self.f, self.m = s, f, second_derivatives(s, f, first, last)

    def __call__(self, t):
        s, f, m = self.s, self.f, self.m
        k = np.clip(np.searchsorted(s, t) - 1, 0, len(s) - 2)
        h = s[k + 1] - s[k]
        a, b = (s[k + 1] - t) / h, (t - s[k]) / h
        return a * f[k] + b * f[k + 1] + ((a**3 - a) * m[k] + (b**3 - b) * m[k + 1]) * h * h / 6

    def slope(self):
        h, m = np.diff(self.s), self.m
        slopes = np.diff(self.f) / h
        return np.append(slopes - h * (2 * m[:-1] + m[1:]) / 6,
                         slopes[-1] + h[-1] * (m[-2] + 2 * m[-1]) / 6)


def lengths(x, y):
    return np.concatenate([[0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])


def splines(x, y, phi):
    """Over the length from the wall to the tip. The wall mirrors x, the bed mirrors y."""
    s = lengths(x, y)
    return Spline(s, x, "odd", "even"), Spline(s, y, "even", "odd"), Spline(s, phi, "even", "even")


def element_integrals(px, py, x, y):
    """Over each straight element, seen from each point p: of ln r times the weights of its two
    ends, and of the derivative of ln r along the normal to the right."""
    tx, ty = np.diff(x), np.diff(y)
    length = np.hypot(tx, ty)
    tx, ty = tx / length, ty / length
    ax, ay = px[:, None] - x[:-1], py[:, None] - y[:-1]
    u, v = ax * tx + ay * ty, ay * tx - ax * ty  # along the element, and to its left
    w = length - u
    r1, r2 = u * u + v * v, w * w + v * v
    log1, log2 = (0.5 * np.log(np.maximum(r, 1e-300)) for r in (r1, r2))
    angle = np.where(abs(v) < 1e-12 * length, 0, np.arctan2(v * length, v * v - u * w))
    whole = w * log2 + u * log1 - length + v * angle
    far = (0.5 * (r2 * log2 - r1 * log1) - 0.25 * (r2 - r1) + u * whole) / length
    turned = (v * (log2 - log1) + u * angle) / length
    return whole - far, far, angle - turned, turned


def normal_velocity(x, y, phi):
    """Outward normal derivative of the potential at the nodes. The surface goes from the wall to
    the tip."""
    n = len(x)
    single, double = np.zeros((n, n)), np.zeros((n, n))
    for mx in (1, -1):
        for my in (1, -1):
            near, far, near_n, far_n = element_integrals(mx * x, my * y, x, y)
            single[:, :-1] += near
            single[:, 1:] += far
            double[:, :-1] -= near_n
            double[:, 1:] -= far_n
    angles = double.sum(axis=1)  # a constant potential has no flow
    return np.linalg.solve(single, double @ phi - angles * phi)


def velocity(x, y, phi):
    """At the nodes, and the normal velocity."""
    dx, dy, along = (f.slope() for f in splines(x, y, phi))
    size = np.hypot(dx, dy)
    dx, dy, along = dx / size, dy / size, along / size
    out = normal_velocity(x, y, phi)
    u, v = along * dx - out * dy, along * dy + out * dx
    u[0] = v[-1] = 0
    return u, v, out


def rates(state):
    u, v, _ = velocity(*state)
    return np.array([u, v, 0.5 * (u * u + v * v) - state[1]])


def spread(length, size):
    """Lengths of nodes whose spacing is that of size."""
    fine = np.linspace(0, length, 20001)
    count = np.append(0, np.cumsum(fine[1] / size(fine[1:])))
    return np.interp(np.linspace(0, count[-1], round(count[-1]) + 1), count, fine)


def sizes(length, corner, spacing):
    """The spacing of the nodes grows with the distance from the tip and from the upper corner."""
    return lambda s: spacing * np.minimum(np.minimum(10, 1 + 25 * (length - s)),
                                          1.5 + 40 * abs(s - corner))


def column(spacing):
    """The surface at the start: top, rounded corner, side."""
    turn = np.linspace(0, math.pi / 2, 200)
    flat = 1 - CORNER
    x = np.concatenate([np.linspace(0, flat, 400)[:-1], flat + CORNER * np.sin(turn),
                        np.ones(3000)])
    y = np.concatenate([np.ones(399), flat + CORNER * np.cos(turn),
                        flat * np.linspace(1, 0, 3001)[1:]])
    s = lengths(x, y)
    corner = flat + CORNER * math.pi / 4
    nodes = spread(s[-1], sizes(s[-1], corner, spacing))
    return np.array([np.interp(nodes, s, x), np.interp(nodes, s, y), 0 * nodes])


def smooth(f, mirror_wall, mirror_bed):
    """The formula of five points of Longuet-Higgins and Cokelet, which leaves cubics as they
    are."""
    e = np.concatenate([mirror_wall * f[2:0:-1], f, mirror_bed * f[-2:-4:-1]])
    return (-e[:-4] + 4 * e[1:-3] + 10 * e[2:-2] + 4 * e[3:-1] - e[4:]) / 16


def set_anew(state, corner, spacing):
    """Nodes with the spacing that is asked for, smoothed; corner is the node of the upper
    corner."""
    x, y, phi = splines(*state)
    nodes = spread(x.s[-1], sizes(x.s[-1], x.s[corner], spacing))
    corner = int(np.argmin(abs(nodes - x.s[corner])))
    new = np.array([smooth(x(nodes), -1, 1), smooth(y(nodes), 1, -1), smooth(phi(nodes), 1, 1)])
    new[0, 0] = new[1, -1] = 0
    return new, corner


def area(state):
    x, y, _ = state
    return 0.5 * abs(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))


def energy(state):
    x, y, phi = state
    f = phi * velocity(*state)[2]
    kinetic = 0.25 * np.sum((f[1:] + f[:-1]) * np.hypot(np.diff(x), np.diff(y)))
    return kinetic + abs(np.sum((y[1:]**2 + y[1:] * y[:-1] + y[:-1]**2) / 6 * np.diff(x)))


def solve(spacing, end):
    """Times, fronts, the state at the end; as many steps as the spacing of the nodes asks for."""
    state = column(spacing)
    corner = int(np.argmin(np.hypot(state[0] - 1, state[1] - 1)))
    steps = math.ceil(end / spacing)
    dt, fronts = end / steps, [state[0].max()]
    for _ in range(steps):
        k1 = rates(state)
        k2 = rates(state + 0.5 * dt * k1)
        k3 = rates(state + 0.5 * dt * k2)
        state = state + dt / 6 * (k1 + 2 * k2 + 2 * k3 + rates(state + dt * k3))
        state, corner = set_anew(state, corner, spacing)
        fronts.append(state[0].max())
    return np.linspace(0, end, steps + 1), np.array(fronts), state


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--spacing", type=float, help="least spacing of nodes, H; its solution to "
                                                      "the screen")
    chosen = parser.parse_args()
    at = np.linspace(0, END, ROWS + 1)
    spacing = chosen.spacing or 0.002
    time, front, state = solve(spacing, END)
    rows = np.interp(at, time, front)
    start = column(spacing)
    print(f"area {area(state) / area(start) - 1:+.1e}, energy "
          f"{energy(state) / energy(start) - 1:+.1e}")
    lines = "".join(f"{t:.2f},{x:.4f}\n" for t, x in zip(at, rows))
    if chosen.spacing:
        print(lines)
        return
    off = float(abs(np.interp(at, *solve(2 * spacing, END)[:2]) / rows - 1).max())
    error = f"Twice the spacing of nodes changes it by {100 * off:.2f} %."
    TABLE.write_text(HEAD.format(error=error) + lines, encoding="utf-8")
    print(error)


if __name__ == "__main__":
    main()
