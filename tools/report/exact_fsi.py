#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Elastic bodies and a fluid against exact solutions, for light and heavy bodies, with explicit and
implicit steps of the body: orders in space and in time (make exact-fsi, half an hour).

The scenes are those of cases/verify, after models of Banks, Henshaw and Schwendeman (arXiv
1308.5722, 1308.5913):
  pulse   fsi_bar.cfg: a pulse runs from a bar into a fluid
  column  fsi_column.cfg: a bar carries a column of fluid, which is an added mass
  layer   fsi_layer.cfg: a wave along an elastic layer under a fluid; `stiff` has a larger c0"""
import math
from concurrent.futures import ProcessPoolExecutor

from common import OUT, QUICK, ROOT, np, options, program_version, run_tool, table, write
from metrics import bisect, order
import sphfsi

REPORT = OUT / "exact_fsi.md"
DENSITIES = (0.1, 1, 100) if QUICK else (0.01, 0.1, 1, 10, 100)
STEPS = ("explicit", "implicit")
# Time: steps of the fluid over the least number, of the run to compare with, too.
COUNTS, FINEST = (1, 2, 4), 16
ASKED = {"space": 1.0, "time": 2.0}
LENGTH, RHO = 1.0, 1000.0  # of all cases: L, density of the fluid


class Pulse:
    """Half of the pulse runs each way. Of that to the right 2r/(1 + r) passes x = 0, and
    (r - 1)/(r + 1) comes back."""
    case, ratios, at = "fsi_bar", (25, 50) if QUICK else (25, 50, 100), 25
    courant = 1 / 6  # of the longest steps of the study in time
    lightest = {"space": 0.01, "time": 0.01}
    sound, size = 10.0, 1e-4
    end = 0.5 * LENGTH / sound

    def __init__(self, density):
        self.density, self.settings = density, {}

    def pulse(self, x):
        return self.size * np.maximum(1 - ((x + 0.3) / 0.2)**2, 0)**4

    def exact(self, body, x, _, time):
        right, left = x - self.sound * time, x + self.sound * time
        back = (self.density - 1) / (self.density + 1) * 0.5 * self.pulse(-left)
        if body:
            return 0.5 * self.pulse(right) + 0.5 * self.pulse(left) + back, 0 * x
        return self.density / (1 + self.density) * self.pulse(right), 0 * x


class Column:
    """The lowest mode, sin(w (x + L)/c_b) in the bar and b cos(w (x - L)/c) in the fluid, with
    r c_b cot(w L/c_b) = c tan(w L/c)."""
    case, ratios, at = "fsi_column", (25, 50) if QUICK else (25, 50, 100), 25
    courant, lightest = 1 / 3, {"space": 0.1, "time": 0.1}
    sound, omega, size = 10.0, 2.0, -1e-5
    end = 0.75 * math.pi / omega

    def __init__(self, density):
        phase = self.omega * LENGTH / self.sound
        self.phase = bisect(lambda a: density / a / math.tan(a) - math.tan(phase) / phase,
                            1e-6, 0.5 * math.pi)
        self.b = math.sin(self.phase) / math.cos(phase)
        self.settings = {"bar": f"{self.omega * LENGTH / self.phase:.17g} m/s", "b": self.b}

    def exact(self, body, x, _, time):
        v = self.size * math.cos(self.omega * time)
        return v * (np.sin(self.phase * (x + LENGTH)) if body else
                    self.b * np.cos(self.omega * (x - LENGTH) / self.sound)), 0 * x


class Layer:
    """The displacement is that of the potentials f cos(k x) and g sin(k x), with f'' = (k^2 -
    w^2/c_p^2) f and g'' = (k^2 - w^2/c_s^2) g; the pressure is that of cosh(l (y - H)) with l^2 =
    k^2 - w^2/c^2. E is the largest for which w belongs to a mode."""
    case, ratios, at = "fsi_layer", (16, 32) if QUICK else (16, 32, 64), 16
    courant, lightest = 1 / 3, {"space": 0.01, "time": 0.1}
    sound, nu, size = 10.0, 0.3, 1e-6
    high, deep, k = 0.5 * LENGTH, 0.25 * LENGTH, math.pi / LENGTH
    omega = 0.2 * sound * k
    end = 0.75 * math.pi / omega

    def __init__(self, density):
        self.density = density
        scale = density * RHO * (self.omega / self.k)**2
        tries = scale * max(1, 1 / density) * np.geomspace(1e3, 1e-2, 2000)
        signs = [self.determinant(young) > 0 for young in tries]
        first = signs.index(not signs[0])
        self.form(bisect(self.determinant, tries[first], tries[first - 1]))
        columns = self.matrix()
        _, _, last = np.linalg.svd(columns / np.abs(columns).max(axis=0))
        self.weights = last[-1] / np.abs(columns).max(axis=0)
        self.weights *= self.size / self.solid(0.0)[1]
        self.settings = self.case_settings()

    def form(self, young):
        """With this modulus: coefficients of the solutions."""
        self.young, self.mu = young, young / (2 * (1 + self.nu))
        self.lam = 2 * self.mu * self.nu / (1 - 2 * self.nu)
        inertia = self.density * RHO * self.omega**2
        self.squares = (self.k**2 - inertia / (self.lam + 2 * self.mu),
                        self.k**2 - inertia / self.mu)
        self.decay = math.sqrt(self.k**2 - (self.omega / self.sound)**2)
        self.weights = np.zeros(5)

    def potentials(self, y):
        """f, f', g, g'."""
        found = []
        for square, even, odd in zip(self.squares, self.weights[:4:2], self.weights[1:4:2]):
            rate = math.sqrt(abs(square))
            cosine, sine = (np.cosh, np.sinh) if square > 0 else (np.cos, np.sin)
            found += [even * cosine(rate * y) + odd * sine(rate * y) / rate,
                      even * math.copysign(rate, square) * sine(rate * y) + odd * cosine(rate * y)]
        return found

    def solid(self, y):
        """Velocities over sin(k x) and cos(k x) at cos(w t) = 1, and the stresses yy and xy in the
        same way at sin(w t) = 1."""
        f, df, g, dg = self.potentials(y)
        k, (a, b) = self.k, self.squares
        ux, uy, duy = dg - k * f, df - k * g, a * f - k * dg
        return (self.omega * ux, self.omega * uy,
                (self.lam + 2 * self.mu) * duy + self.lam * k * ux,
                self.mu * ((b + k**2) * g - 2 * k * df))

    def fluid(self, y):
        """Velocities and pressure, in the same way."""
        depth = self.decay * (y - self.high)
        p, dp = self.weights[4] * np.cosh(depth), self.weights[4] * np.sinh(depth)
        return (-self.k * p / (RHO * self.omega), self.decay * dp / (RHO * self.omega), p)

    def matrix(self):
        """What must be zero: displacement of the lower side, shear and pressure above, and the
        difference of normal velocities there; of each weight."""
        columns = []
        for n in range(5):
            self.weights = np.eye(5)[n]
            below, above, water = self.solid(-self.deep), self.solid(0.0), self.fluid(0.0)
            columns.append([below[0], below[1], above[3], above[2] + water[2], above[1] - water[1]])
        return np.array(columns).T

    def determinant(self, young):
        self.form(young)
        matrix = self.matrix()
        matrix = matrix / np.abs(matrix).max(axis=1, keepdims=True)
        return np.linalg.det(matrix / np.abs(matrix).max(axis=0))

    def text(self, f, df, g, dg):
        """The sum of these times f, f', g and g' as an expression of the case."""
        terms = []
        for square, even, odd, plain, slope in zip(self.squares, self.weights[:4:2],
                                                   self.weights[1:4:2], (f, g), (df, dg)):
            rate, kind = math.sqrt(abs(square)), "h" if square > 0 else ""
            factors = (plain * even + slope * odd,
                       plain * odd / rate + slope * even * math.copysign(rate, square))
            terms += [f"{factor:+.12g}*{name}{kind}({rate:.12g}*y)"
                      for factor, name in zip(factors, ("cos", "sin"))]
        return "(" + " ".join(terms) + ")"

    def case_settings(self):
        k, wave = self.k, self.lam + 2 * self.mu
        stress = self.text(self.lam * self.squares[0] - wave * k**2, 0, 0, (wave - self.lam) * k)
        speed = self.weights[4] / (RHO * self.omega)
        high = f"({self.decay:.12g}*(y - H))"
        load = {"traction": f"-{stress}*sin(omega*t), 0"}
        return {"E": f"{self.young:.12g} Pa", "omega": self.omega, "begin": load, "end": load,
                "layer": {"velocity": f"omega*{self.text(-k, 0, 0, 1)}*sin(k*x), "
                                      f"omega*{self.text(0, 1, -k, 0)}*cos(k*x)"},
                "water": {"velocity": f"{-k * speed:.12g}*cosh{high}*sin(k*x), "
                                      f"{self.decay * speed:.12g}*sinh{high}*cos(k*x)"}}

    def exact(self, body, x, y, time):
        vx, vy, *_ = self.solid(y) if body else self.fluid(y)
        v = math.cos(self.omega * time) * (y > -self.deep)  # clamped below
        return v * vx * np.sin(self.k * x), v * vy * np.cos(self.k * x)


class Stiff(Layer):
    """The same wave with a fluid that is hardly compressed."""
    lightest = {"space": 0.1, "time": 0.1}
    omega = 0.05 * Layer.sound * Layer.k
    end = 0.75 * math.pi / omega


PROBLEMS = {"pulse": Pulse, "column": Column, "layer": Layer, "stiff": Stiff}


def least(problem, density):
    """Steps of the largest size; more for a light body, whose added mass bounds them (T-35d)."""
    lag = 1.5 * LENGTH / problem.at / problem.sound
    return math.ceil(problem.end / lag / min(problem.courant, 0.9 * density))


def run(problem, density, steps, ratio, count=None):
    """Velocities of body and fluid at the end, sorted by number, and the exact ones."""
    numerics = {"solid_steps": steps}
    if count:
        numerics["fixed_step"] = problem.end / count
    s = sphfsi.Case(ROOT / "cases" / "verify" / f"{problem.case}.cfg", r=density, ratio=ratio,
                    numerics=numerics, **problem.settings).simulation(threads=1)
    s.advance()
    found = []
    for body, kind in ((True, s.solid), (False, s.fluid)):
        order = np.argsort(kind.id)
        x, y, vx, vy = (np.array(of)[order] for of in (kind.x, kind.y, kind.vx, kind.vy))
        found.append((np.array([vx, vy]), np.array(problem.exact(body, x, y, s.time))))
    return found


def off(found, wanted):
    """RMS difference over the largest velocity."""
    return math.sqrt(np.mean(np.sum((found - wanted)**2, 0))) / np.abs(wanted).max()


def in_space(problem, density, steps, ratio):
    return [off(*of) for of in run(problem, density, steps, ratio)]


def in_time(problem, density, steps):
    """Differences from the run with the shortest steps, of body and fluid."""
    number = least(problem, density)
    finest = run(problem, density, steps, problem.at, FINEST * number)
    return [[off(found, best) for (found, _), (best, _) in
             zip(run(problem, density, steps, problem.at, count * number), finest)]
            for count in COUNTS]


def study(kind, name, density, steps):
    """Rows of both media: errors by size, order between the two finest."""
    problem = PROBLEMS[name](density)
    sizes = problem.ratios if kind == "space" else COUNTS
    errors = [in_space(problem, density, steps, ratio) for ratio in sizes] if kind == "space" \
        else in_time(problem, density, steps)
    rows = [[medium, column, order(sizes, column)]
            for medium, column in zip(("body", "fluid"), map(list, zip(*errors)))]
    for medium, column, slope in rows:
        print(kind, name, f"{density:g}", steps, medium, " ".join(f"{e:.3g}" for e in column),
              f"{slope:.2f}", flush=True)
    return rows


def tables(kind, studies):
    """One for each problem, under its name."""
    text = []
    for name, problem in PROBLEMS.items():
        rows = [[f"{density:g}", steps, medium, *(f"{e:.2g}" for e in errors), f"{slope:.2f}"]
                for (of, which, density, steps), found in studies.items()
                for medium, errors, slope in found if (of, which) == (kind, name)]
        head = [f"L/dp = {n}" for n in problem.ratios] if kind == "space" else \
            [f"{n}n steps".removeprefix("1") for n in COUNTS]
        text += [f"`{name}`", table(["r", "steps of the body", "in", *head, "order"], rows)]
    return "\n\n".join(text)


def report(studies):
    words, counts = [], []
    for kind, asked in ASKED.items():
        slopes = [slope for (of, *_), found in studies.items() for *_, slope in found if of == kind]
        words.append(f"{kind.capitalize()}: orders of {min(slopes):.2f} to {max(slopes):.2f}, "
                     f"asked: {asked:g}; {sum(slope >= 0.95 * asked for slope in slopes)} of "
                     f"{len(slopes)} are within 5 % of that or above.")
    for name, problem in PROBLEMS.items():
        counts.append([f"`{name}`", problem.at,
                       *(least(problem, r) if r >= problem.lightest["time"] else ""
                         for r in DENSITIES)])
    return {"answer": " ".join(words), "version": program_version(),
            "space": tables("space", studies), "time": tables("time", studies), "finest": FINEST,
            "least": table(["n", "L/dp", *(f"r = {r:g}" for r in DENSITIES)], counts)}


def main():
    options(__doc__).parse_args()
    names = ("pulse", "column", "layer") if QUICK else PROBLEMS
    rows = [(kind, name, density, steps) for kind in ASKED for name in names
            for density in DENSITIES if density >= PROBLEMS[name].lightest[kind] for steps in STEPS]
    with ProcessPoolExecutor() as pool:
        write(REPORT, REPORT.name, **report(dict(zip(rows, pool.map(study, *zip(*rows))))))


if __name__ == "__main__":
    run_tool(main)
