#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Orders of convergence against manufactured solutions: in the fluid, at no-slip walls and in the
solid.

  tools/report/manufactured.py    writes docs/results/manufactured.md (some minutes on one core)

A field is chosen, and the acceleration that makes it a solution is added to that of the program.
The scenes are cases/verify/manufactured_*.cfg; the method is that of Roache (2002) and, for
particles, of Negi and Ramachandran (2022, arXiv 2208.10848)."""
import math

from common import OUT, QUICK, ROOT, np, options, program_version, run_tool, table, write
from metrics import order
import sphfsi

REPORT = OUT / "manufactured.md"
SCHEMES = {"paper": {"scheme": "paper"}, "standard": {"scheme": "standard"}}
RATIOS = {"fluid": (25, 50, 100, 200), "wall": (25, 50, 100, 200), "solid": (10, 20, 40, 80)}
RATIOS = {scene: ratios[:2] for scene, ratios in RATIOS.items()} if QUICK else RATIOS
# Least orders that are asked for between the two finest runs.
ASKED = {"fluid": 1.8, "wall": 1.0, "solid": 1.8}
K = 2 * math.pi
VISCOSITY, DENSITY, SOUND = 0.01, 1000.0, 15.0  # of the cases; L = U = 1
YOUNG, POISSON, AMPLITUDE = 1e6, 0.3, 0.02


def waves(x):
    """cos(kx) and its first three derivatives."""
    return np.cos(K * x), -K * np.sin(K * x), -K**2 * np.cos(K * x), K**3 * np.sin(K * x)


def bump(y):
    """sin^2(pi y) and its first three derivatives."""
    return (0.5 - 0.5 * np.cos(K * y), 0.5 * K * np.sin(K * y), 0.5 * K**2 * np.cos(K * y),
            -0.5 * K**3 * np.sin(K * y))


class Flow:
    """psi = X(x) Y(y)/k, velocity g(t) (psi_y, -psi_x), pressure p0 + rho U^2 X Y."""

    def __init__(self, across):
        self.across = across  # Y and its derivatives

    def factors(self, p):
        return waves(p.x), self.across(p.y)

    def velocity(self, p, t):
        x, y = self.factors(p)
        g = 1 + 0.5 * math.sin(K * t)
        return g * x[0] * y[1] / K, -g * x[1] * y[0] / K

    def pressure(self, p):
        x, y = self.factors(p)
        return DENSITY * (3 + x[0] * y[0])

    def acceleration(self, p):
        """v_t + (v . grad) v + grad P/rho - (nu rho0/rho) lap v: the dynamic viscosity is
        constant"""
        x, y = self.factors(p)
        g, rate = 1 + 0.5 * math.sin(K * p.time), 0.5 * K * math.cos(K * p.time)
        u, v = x[0] * y[1] / K, -x[1] * y[0] / K
        gradient = np.array([[x[1] * y[1], x[0] * y[2]], [-x[2] * y[0], -x[1] * y[1]]]) / K
        laplacian = np.array([x[2] * y[1] + x[0] * y[3], -x[3] * y[0] - x[1] * y[2]]) / K
        # Tait with gamma = 7: the density of this pressure.
        density = DENSITY * (1 + 7 * self.pressure(p) / (DENSITY * SOUND**2))**(1 / 7)
        slope = np.array([x[1] * y[0], x[0] * y[1]]) * DENSITY / density
        return tuple(rate * np.array([u, v]) + g**2 * (gradient[:, 0] * u + gradient[:, 1] * v)
                     + slope - VISCOSITY * DENSITY / density * g * laplacian)


FLOWS = {"fluid": Flow(waves), "wall": Flow(bump)}


def run_flow(scene, scheme, ratio):
    """RMS errors of velocity over U and of pressure over rho U^2 at the end."""
    flow = FLOWS[scene]
    case = sphfsi.Case(ROOT / "cases" / "verify" / f"manufactured_{scene}.cfg", ratio=ratio,
                       **SCHEMES[scheme])
    s = case.simulation(threads=1)
    s.set_force("fluid", flow.acceleration)
    s.advance()
    f = s.fluid
    u, v = flow.velocity(f, s.time)
    return {"velocity": math.sqrt(np.mean((f.vx - u)**2 + (f.vy - v)**2)),
            "pressure": math.sqrt(np.mean((f.pressure - flow.pressure(f))**2)) / DENSITY}


LAME = (YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), YOUNG / (2 + 2 * POISSON))
DIRECTION = np.array([1.0, -0.5])


def shape(x, y):
    """sin^2(pi x) sin^2(pi y) within the unit square, 0 on its rim."""
    inside = (x > 0) & (x < 1) & (y > 0) & (y < 1)
    return np.where(inside, (np.sin(math.pi * x) * np.sin(math.pi * y))**2, 0.0)


def stress(x, y, size):
    """P = F (lambda tr(E) I + 2 mu E) of the displacement size * shape * DIRECTION; (2, 2, n)."""
    inside = (x > 0) & (x < 1) & (y > 0) & (y < 1)
    sx, sy = np.sin(math.pi * x)**2, np.sin(math.pi * y)**2
    slope = np.where(inside, math.pi * np.array([np.sin(K * x) * sy, sx * np.sin(K * y)]), 0.0)
    F = np.eye(2)[:, :, None] + size * DIRECTION[:, None, None] * slope[None]
    E = 0.5 * (np.einsum("kin,kjn->ijn", F, F) - np.eye(2)[:, :, None])
    S = LAME[0] * (E[0, 0] + E[1, 1]) * np.eye(2)[:, :, None] + 2 * LAME[1] * E
    return np.einsum("ikn,kjn->ijn", F, S)


class Block:
    """u = AMPLITUDE (1 - cos wt)/2 shape DIRECTION, half a period of w over the run."""

    def __init__(self, solid, end):
        order = np.argsort(solid.id)
        self.X, self.Y = solid.X[order], solid.Y[order]
        self.w = math.pi / end

    def size(self, t):
        return 0.5 * AMPLITUDE * (1 - math.cos(self.w * t))

    def acceleration(self, p):
        """u_tt - Div P/rho; the divergence by central differences, exact to 1e-8 of its size"""
        x, y, e, size = self.X[p.id], self.Y[p.id], 1e-4, self.size(p.time)
        div = (stress(x + e, y, size)[:, 0] - stress(x - e, y, size)[:, 0]
               + stress(x, y + e, size)[:, 1] - stress(x, y - e, size)[:, 1]) / (2 * e)
        swing = 0.5 * AMPLITUDE * self.w**2 * math.cos(self.w * p.time)
        return tuple(swing * DIRECTION[:, None] * shape(x, y) - div / DENSITY)


def run_solid(ratio):
    """RMS errors of displacement over AMPLITUDE and of the stress P over its RMS at the end."""
    case = sphfsi.Case(ROOT / "cases" / "verify" / "manufactured_solid.cfg", ratio=ratio)
    s = case.simulation(threads=1)
    block = Block(s.solid, s.end_time)
    s.set_force("solid", block.acceleration)
    s.advance()
    p = s.solid
    x, y, size = p.X, p.Y, block.size(s.time)
    exact = size * shape(x, y)
    error = (p.ux - exact * DIRECTION[0])**2 + (p.uy - exact * DIRECTION[1])**2
    P = stress(x, y, size)
    off = (p.Pxx - P[0, 0])**2 + (p.Pxy - P[0, 1])**2 + (p.Pyx - P[1, 0])**2 + (p.Pyy - P[1, 1])**2
    inside = (x > 0) & (x < 1) & (y > 0) & (y < 1)
    return {"displacement": math.sqrt(np.mean(error[inside])) / AMPLITUDE,
            "stress": math.sqrt(np.mean(off[inside]) / np.mean((P**2).sum((0, 1))[inside]))}


def study(scene):
    """[scheme, quantity, errors by ratio] of a scene."""
    out = []
    for scheme in SCHEMES if scene != "solid" else ("-",):
        runs = [run_solid(ratio) if scene == "solid" else run_flow(scene, scheme, ratio)
                for ratio in RATIOS[scene]]
        out += [[scheme, quantity, [r[quantity] for r in runs]] for quantity in runs[0]]
    return out


def report(studies):
    """The values of the document's text."""
    tables, judged = [], {True: [], False: []}
    for scene, found in studies.items():
        rows = []
        for scheme, quantity, errors in found:
            slope, name = order(RATIOS[scene], errors), f"{quantity}, {scheme}".removesuffix(", -")
            judged[slope >= ASKED[scene]].append(f"{scene}, {name} ({slope:.2f})")
            rows.append([name, *(f"{e:.3g}" for e in errors), f"{slope:.2f}", ASKED[scene]])
        tables.append(table([f"{scene}, L/dp =", *map(str, RATIOS[scene]), "order", "asked"], rows))
    met, missed = ("; ".join(judged[is_met]) for is_met in (True, False))
    answer = (f"Met: {met}. " if met else "") + \
        (f"Missed: {missed}." if missed else "All orders asked for are met.")
    return {"answer": answer, "version": program_version(), "tables": "\n\n".join(tables)}


def main():
    options(__doc__).parse_args()
    write(REPORT, REPORT.name, **report({scene: study(scene) for scene in RATIOS}))


if __name__ == "__main__":
    run_tool(main)
