#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Drag, lift and frequency of a cylinder in the domain of cases/verify/cylinder.cfg, by another
method.

  cases/reference/cylinder_lattice_boltzmann.py                   Re = 100, to the screen (40 min)
  cases/reference/cylinder_lattice_boltzmann.py --before 20 --length 40    inflow 20 D away

Published values are of wider or longer domains. Here the inflow, five diameters away, and the
planes, ten apart, speed the flow up beside the cylinder.

Method: nine velocities, two relaxation times (Ginzburg et al. 2008, magic number 3/16); cylinder by
interpolated bounce-back (Bouzidi et al. 2001), planes by mirror images, inflow and outflow by Zou
and He (1997). Speeds are 0.06 of the lattice's, so sound is ten times as fast. The inflow
begins slowly, so that little sound is made, and its profile is tilted for a while. The lift grows
until 135 D/U."""
import argparse

import numpy as np

CX = np.array([0, 1, 0, -1, 0, 1, -1, -1, 1])
CY = np.array([0, 0, 1, 0, -1, 1, 1, -1, -1])
WEIGHT = np.array([4 / 9] + 4 * [1 / 9] + 4 * [1 / 36])
OPPOSITE = np.array([0, 3, 4, 1, 2, 7, 8, 5, 6])
MIRROR = np.array([0, 1, 4, 3, 2, 8, 7, 6, 5])  # in a plane along x
SPEED, RAMP, TILTED = 0.06, 15, 10  # lattice units; times in D/U


def links(nx, ny, x0, y0, radius):
    """Nodes of the fluid, direction, and the share of the link that is in the fluid."""
    x, y = np.meshgrid(np.arange(nx), np.arange(ny), indexing="ij")
    solid = np.hypot(x - x0, y - y0) < radius
    found = []
    for q in range(1, 9):
        inside = ~solid & np.roll(solid, (-CX[q], -CY[q]), (0, 1))
        px, py = x[inside] - x0, y[inside] - y0
        a, b = CX[q] ** 2 + CY[q] ** 2, CX[q] * px + CY[q] * py
        share = (-b - np.sqrt(b * b - a * (px * px + py * py - radius ** 2))) / a
        found.append(np.stack([x[inside], y[inside], np.full(len(px), q), share]))
    found = np.concatenate(found, axis=1)
    return solid, *found[:3].astype(int), found[3]


def collide(f, plus, minus):
    rho = f.sum(axis=0)
    u = np.tensordot(CX, f, 1) / rho
    v = np.tensordot(CY, f, 1) / rho
    square = 1 - 1.5 * (u * u + v * v)
    for q in (0, 1, 2, 5, 6):
        o, w = OPPOSITE[q], WEIGHT[q] * rho
        c = 3 * (CX[q] * u + CY[q] * v)
        even, odd = 0.5 * (f[q] + f[o]), 0.5 * (f[q] - f[o])
        even = plus * (even - w * (square + 0.5 * c * c))
        odd = minus * (odd - w * c)
        f[q] -= even + odd
        if o != q:
            f[o] -= even - odd


def stream(f, g):
    for q in range(9):
        g[q] = np.roll(f[q], (CX[q], CY[q]), (0, 1))
    for q in (2, 5, 6):  # from below the lower plane and from above the upper one
        o = MIRROR[q]
        g[q][:, 0] = np.roll(f[o][:, 0], CX[q])
        g[o][:, -1] = np.roll(f[q][:, -1], CX[q])


def ends(g, speed):
    p = g[:, 0]
    rho = (p[0] + p[2] + p[4] + 2 * (p[3] + p[6] + p[7])) / (1 - speed)
    across = 0.5 * (p[2] - p[4])
    p[1], p[5], p[8] = (p[3] + 2 / 3 * rho * speed, p[7] - across + rho * speed / 6,
                        p[6] + across + rho * speed / 6)
    p = g[:, -1]
    u = p[0] + p[2] + p[4] + 2 * (p[1] + p[5] + p[8]) - 1
    across = 0.5 * (p[2] - p[4])
    p[3], p[7], p[6] = p[1] - 2 / 3 * u, p[5] + across - u / 6, p[8] - across - u / 6


def run(reynolds, d, before, length, width, end):
    """Times in D/U, drag and lift coefficients."""
    nx, ny = round(length * d) + 1, round(width * d)
    x0, y0 = before * d, 0.5 * (ny - 1)
    solid, x, y, q, share = links(nx, ny, x0, y0, 0.5 * d)
    o, near = OPPOSITE[q], share < 0.5
    weight = np.where(near, 2 * share, 0.5 / share)
    relax = 3 * SPEED * d / reynolds  # of the stress, less a half
    plus, minus = 1 / (relax + 0.5), 1 / (3 / 16 / relax + 0.5)
    f = np.repeat(WEIGHT, nx * ny).reshape(9, nx, ny)
    g, series = np.empty_like(f), []
    for step in range(round(end * d / SPEED)):
        t = step * SPEED / d
        collide(f, plus, minus)
        stream(f, g)
        back = np.where(near, f[q, x - CX[q], y - CY[q]], f[o, x, y])
        value = weight * f[q, x, y] + (1 - weight) * back
        force = f[q, x, y] + value
        g[o, x, y] = value
        g[:, solid] = WEIGHT[:, None]
        tilt = 0.3 * np.sin(np.pi * np.clip(t - RAMP, 0, TILTED) / TILTED) ** 2
        ends(g, 0.5 * SPEED * (1 - np.cos(np.pi * min(t / RAMP, 1))) *
             (1 + tilt * 2 * (np.arange(ny) - y0) / ny))
        f, g = g, f
        series.append((t, *(2 / SPEED ** 2 / d * np.array([CX[q] @ force, CY[q] @ force]))))
    return np.array(series).T


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, value, meaning in (("reynolds", 100, "Reynolds number"),
                                 ("across", 20, "nodes across the cylinder"),
                                 ("before", 5, "from the inflow to the cylinder, D"),
                                 ("length", 20, "of the domain, D"),
                                 ("width", 10, "distance of the planes, D"),
                                 ("end", 200, "end, D/U; the last 40 count")):
        parser.add_argument(f"--{name}", type=float, default=value,
                            help=f"{meaning} (%(default)s)")
    args = parser.parse_args()
    t, drag, lift = run(args.reynolds, args.across, args.before, args.length, args.width, args.end)
    late = t > args.end - 40
    t, drag, lift = t[late], drag[late], lift[late] - lift[late].mean()
    up = np.flatnonzero((lift[:-1] < 0) & (lift[1:] >= 0))
    frequency = (len(up) - 1) / (t[up[-1]] - t[up[0]])
    whole = slice(up[0], up[-1])
    first = 2 * abs(np.mean(lift[whole] * np.exp(2j * np.pi * frequency * t[whole])))
    print(f"drag {drag[whole].mean():.3f}, lift {first:.3f}, Strouhal number {frequency:.4f}")


if __name__ == "__main__":
    main()
