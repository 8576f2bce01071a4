#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Beams against theory, solids and the benchmark of Turek and Hron (make verify-beam, three
quarters of an hour on one core): large deflection, frequencies, energy; frequencies in water of a
plate with water on one side or both; a plate that floats on waves; an elastic wedge that enters
water; the elastic gate, the baffle and the bar in a channel as beams.

The scenes are texts in this tool, floating_plate.cfg and elastic_wedge.cfg of cases/verify, and
cases/gate.cfg, wet_baffle.cfg and turek_hron with a beam for their solid. The figures are kept in
docs/results/beam_verification.json."""
import math
import re
import sys

from common import COLOURS, IMAGES, OUT, ROOT, load, np, plt, run_figures, run_tool
from metrics import reference
from palette import save
from sphfsi.waves import separate
from turek_hron import REFERENCE, columns, period, summary

sys.path.insert(0, str(ROOT / "cases" / "reference"))
from floating_plate import Plate  # noqa: E402

REPORT = OUT / "beam_verification.md"
RHO, G = 1000.0, 9.81
SOUND, DEPTH = 100.0, 0.5  # of the scenes with wet plates; their plates are 1 m long


# --- theory ---
def beam_matrices(length, supports, stiff, shear, mass, inertia, n=80):
    """Places of nodes, and stiffness and mass of their displacements and angles, of Timoshenko's
    beam by elements that are exact at their nodes. `supports`: clamp, hinge or free at each end."""
    h = length / n
    part = 12 * stiff / (shear * h * h)
    own = stiff / (h**3 * (1 + part)) * np.array(
        [[12, 6 * h, -12, 6 * h], [6 * h, (4 + part) * h * h, -6 * h, (2 - part) * h * h],
         [-12, -6 * h, 12, -6 * h], [6 * h, (2 - part) * h * h, -6 * h, (4 + part) * h * h]])
    K, M = np.zeros((2, 2 * n + 2, 2 * n + 2))
    for k in range(n):
        at = slice(2 * k, 2 * k + 4)
        K[at, at] += own
        M[at, at] += h / 2 * np.diag([mass, max(inertia, 1e-9 * mass)] * 2)
    held = {"clamp": (0, 1), "hinge": (0,), "free": ()}
    gone = [*held[supports[0]], *(2 * n + c for c in held[supports[1]])]
    keep = np.setdiff1d(np.arange(2 * n + 2), gone)
    return np.linspace(0, length, n + 1), K, M, keep


def plate_frequency(supports, stiff, shear, mass, inertia, shape, length=1.0, added=None):
    """Frequency of the mode that is most like `shape`. added(x, omega): mass and stiffness that the
    fluid adds to the displacements of the nodes."""
    x, K, M, keep = beam_matrices(length, supports, stiff, shear, mass, inertia)
    omega, like = 60.0, shape(x)
    for _ in range(1 if added is None else 4):
        Mt, Kt = M.copy(), K.copy()
        if added is not None:
            more = added(x, omega)
            Mt[::2, ::2] += more[0]
            Kt[::2, ::2] += more[1]
        root = np.linalg.inv(np.linalg.cholesky(Mt[np.ix_(keep, keep)]))
        square, modes = np.linalg.eigh(root @ Kt[np.ix_(keep, keep)] @ root.T)
        full = np.zeros((len(M), len(keep)))
        full[keep] = root.T @ modes
        found = full[::2]
        alike = abs(like @ found)
        alike[square < 1] = 0  # rigid motion
        omega = math.sqrt(square[np.argmax(alike)])
    return omega / (2 * math.pi)


def basin(above, below):
    """The fluid of a basin as wide as a horizontal plate: cos(n pi x), n odd, with the depth of
    each side, a free surface above and a bottom below."""
    def added(x, omega):
        h = x[1] - x[0]
        weight = np.full(len(x), h)
        weight[[0, -1]] = h / 2
        n = np.arange(1, 60, 2)
        k = np.sqrt(np.maximum((n * math.pi)**2 - (omega / SOUND)**2, 1e-9))
        high, wave = np.tanh(k * above), omega**2 / G
        per = (k - wave * high) / (k * (k * high - wave))
        if below:
            per += 1 / (k * np.tanh(k * below))
        shape = np.cos(np.outer(n, math.pi * x)) * weight
        return 2 * RHO * (shape.T * per) @ shape, RHO * G * ((below > 0) - 1) * np.diag(weight)
    return added


# --- beam alone ---
DRY = """dp = 5 cm
end_time = 20
[beam b]
shape = polyline: 0, 0; 1, 0
axial_stiffness = 1e6
bending_stiffness = 1
mass = 1
thickness = 5 mm
{}
[probe p]
quantity = displacement
body = b
point = {}, 0
[output]
probe_interval = {}
"""
TABLE = {1: (0.30172, 0.05643), 5: (0.71379, 0.38763), 10: (0.81061, 0.55500)}
SUPPORTS = {"clamped and free": ("clamp = 0, 0", "x^2*(6-4*x+x^2)", 1.8751041, 1),
            "hinged": ("hinge = 0, 0\nhinge = 1, 0", "sin(pi*x)", math.pi, 0.5),
            "clamped": ("clamp = 0, 0\nclamp = 1, 0", "x^2*(1-x)^2", 4.7300407, 0.5),
            "free": ("", "cos(4.7300407*x) + cosh(4.7300407*x) - 0.982502215*"
                         "(sin(4.7300407*x) + sinh(4.7300407*x))", 4.7300407, 0.5)}


def frequency_of(t, y, near):
    """The frequency near another of an oscillation whose size may change: least squares."""
    for width in (0.2, 0.02, 0.002, 0.0002):
        trials, left = near * (1 + width * np.linspace(-1, 1, 31)), []
        for f in trials:
            wave = np.stack([np.cos(2 * math.pi * f * t), np.sin(2 * math.pi * f * t),
                             np.ones_like(t)], axis=1)
            base = np.hstack([wave, wave * (t / t[-1])[:, None]])
            left.append(((base @ np.linalg.lstsq(base, y, rcond=None)[0] - y)**2).sum())
        near = trials[int(np.argmin(left))]
    return near


def elastica():
    text = DRY.format("mass_damping = 20\ndamping_time = 0.05\nclamp = 0, 0\n[load f]\nbody = b\n"
                      "force = 0, -1\nshape = box 0.99, -0.01, 1.01, 0.01\n"
                      "history = min(t/5, 1)\n[numerics]\nfixed_step = 0.1", 1, 1)

    def measure(runs):
        return [(f"{what}, P L^2/EI = {force}, % too large",
                 100 * (-run.table()[f"p_d{axis}_m"][-1] / wanted - 1), 0.3)
                for (force, known), run in zip(TABLE.items(), runs)
                for what, axis, wanted in zip(("deflection", "shortening"), "yx", known)]
    return text, [[f"load f.force=0,-{force}"] for force in TABLE], measure


def dry(supports):
    lines, shape, kl, at = SUPPORTS[supports]
    wanted = kl**2 / (2 * math.pi)
    text = DRY.format(f"velocity = 0, 1e-6*({shape})\n{lines}\n[numerics]\n"
                      f"fixed_step = {0.005 / wanted}", at, 0.005 / wanted)

    def measure(runs):
        p = runs[0].table()
        found = frequency_of(p["time_s"], p["p_dy_m"], wanted)
        return [("frequency, % too high", 100 * (found / wanted - 1), 0.3)]
    return text, [[f"end_time={10 / wanted}"]], measure


def energy():
    """A beam that falls against its clamp, far beyond small displacements."""
    periods = 100 * 2 * math.pi / 1.8751041**2

    def measure(runs):
        p = runs[0].table("ledger.csv")
        now = p["kinetic_J_per_m"] + p["elastic_J_per_m"] + p["potential_J_per_m"]
        swing = (p["kinetic_J_per_m"] + p["elastic_J_per_m"]).max()
        return [("change of the energy in 100 periods, % of the largest exchanged",
                 100 * abs(now - now[0]).max() / swing, 0.1)]
    return DRY.format("clamp = 0, 0", 1, 0.05), [["gravity=0, -2", f"end_time={periods}",
                                                  "output.ledger_interval=0.05"]], measure


# --- in water ---
BASIN = """dp = 1/20
end_time = 0.7
gravity = 0, -9.81
[constants]
H = 0.5
thick = 1
ratio = 1
sides = 2
plate = thick/20
EI = (1000*ratio*plate + 230*sides)*(2*pi*10)^2/7.853^4
force = EI*7.853^4*0.1*min(plate, 1/40)  # small, or it is stretched
[fluid w]
{fluid}
sound_speed = 100
surface = {surface}
[wall tank]
{walls}
{body}
gravity = off
[load l]
body = b
{load}
[probe p]
quantity = displacement
body = b
point = {probe}
[output]
probe_interval = 1e-3
"""
SHAKE = "*(sin(pi*min(t, 0.1)/0.1))^2"
TALL = "shape = polyline: 0, 1.4*H; 0, {0}\nshape = polyline: 1, {0}; 1, 1.4*H"
CUP = "shape = polyline: 0, {0}; 0, {0} - H; 1, {0} - H; 1, {0}"
SECTION = "thickness = plate\nyoung = 12*EI/plate^3\ndensity = 1000*ratio"
ON_BEAM = "shape = box 0.01, -1, 0.99, 1\ntraction = 0, {}force*sin(2*pi*x)" + SHAKE
SIDES = {1: "one side wet", 2: "both sides wet"}
DENSITIES, THICKNESSES = (0.01, 1, 10), (0.05, 0.2, 1, 4)


def wet_text(sides, solid):
    fluid = "shape = box 0, 0, 1, H"
    weight = "" if sides == 2 else "9810*H + "
    if sides == 2:
        fluid += "\nshape = box 0, -plate - H, 1, -plate"
    if solid:
        walls = TALL.format("0") + ("\n" + CUP.format("-plate") if sides == 2 else "")
        body = ("[solid b]\nshape = box -0.1, -plate, 1.1, 0\n"
                "clamp = box -0.1, -plate, 0, 0\nclamp = box 1, -plate, 1.1, 0\npoisson = 0\n"
                "young = 12*EI/plate^3\ndensity = 1000*ratio")
        load = ("shape = box 0, -1/40, 1, 0\ntraction = 0, "
                f"{weight}force*sin(2*pi*x)" + SHAKE)
    else:
        walls = TALL.format("-plate - 0.2")  # their corners must not touch the plate
        if sides == 2:
            walls = "shape = polyline: 0, 1.4*H; 0, -plate - H; 1, -plate - H; 1, 1.4*H"
        body = ("[beam b]\nshape = polyline: 0, -plate/2; 1, -plate/2\nclamp = 0, -plate/2\n"
                "clamp = 1, -plate/2\n" + SECTION)
        load = ON_BEAM.format(weight)
    return BASIN.format(fluid=fluid, walls=walls, body=body, load=load, surface="H",
                        probe="0.25, -plate/2").replace("sides = 2", f"sides = {sides}")


def section(sides, thick, ratio):
    """Bending and shear stiffness, mass and rotary inertia of the plate of a scene."""
    t, mass = thick / 20, RHO * ratio * thick / 20
    stiff = (mass + 230 * sides) * (2 * math.pi * 10)**2 / 7.853**4
    return stiff, 5 * stiff / t**2, mass, mass * t * t / 12


def theory(sides, thick, ratio):
    """Frequency in water and in vacuum of the plate of a scene."""
    words = (("clamp", "clamp"), *section(sides, thick, ratio),
             lambda x: np.sin(2 * math.pi * x))
    return (plate_frequency(*words, added=basin(DEPTH, DEPTH if sides == 2 else 0)),
            plate_frequency(*words))


def found_frequency(run, near):
    if run.stopped:
        return math.nan
    p = run.table()
    late = p["time_s"] > 0.12
    return frequency_of(p["time_s"][late], p["p_dy_m"][late], near)


POINTS = [(thick, ratio) for thick in THICKNESSES for ratio in DENSITIES]


def wet(sides, points=tuple(POINTS)):
    def measure(runs):
        wanted = [theory(sides, *point)[0] for point in points]
        return [(f"frequency, thickness {thick:g} dp, density ratio {ratio:g}, % too high",
                 100 * (found_frequency(run, f) / f - 1), 2)
                for (thick, ratio), run, f in zip(points, runs, wanted)]
    return wet_text(sides, False), [[f"thick={thick}", f"ratio={ratio}"]
                                    for thick, ratio in points], measure


def solid_wet():
    """Four spacings thick; the frequency in water over that in vacuum, which its own stiffness does
    not change."""
    points = [(sides, ratio) for sides in (1, 2) for ratio in DENSITIES]

    def measure(runs, dry):
        own = found_frequency(dry, theory(2, 2, 1)[1]) / theory(2, 2, 1)[1]
        wanted = [theory(sides, 2, ratio)[0] for sides, ratio in points]
        return [("frequency in vacuum, % too high", 100 * (own - 1), None),
                *((f"frequency over that in vacuum, {SIDES[sides]}, density ratio {ratio:g}, "
                   "% too high", 100 * (found_frequency(run, f) / f / own - 1), 2)
                  for (sides, ratio), run, f in zip(points, runs, wanted))]
    vacuum = re.sub(r"(?s)\[fluid w\].*?(?=\[wall)", "", wet_text(2, True))
    return ([*(wet_text(sides, True) for sides, _ in points), vacuum],
            [*(["dp=1/40", "thick=2", f"ratio={ratio}"] for _, ratio in points),
             ["dp=1/40", "thick=2"]],
            lambda runs: measure(runs[:-1], runs[-1]))


# --- on waves ---
def floating(runs):
    """In the last two periods of cases/verify/floating_plate.cfg, whose numbers these are."""
    depth, k = 0.4, 5.0
    omega, wave, dp = math.sqrt(G * k * math.tanh(k * depth)), 2 * math.pi / k, runs[0].dp
    start, length, draft = round(2.5 * wave / dp) * dp, round(wave / dp) * dp, 3 / 32 * depth
    theory = Plate(omega, depth, length, 3 * RHO * G / k**4, RHO * draft, draft, 2 * draft, 24.0)
    p, turn = runs[0].table(), 2 * math.pi / omega
    late = p["time_s"] > p["time_s"][-1] - 2 * turn
    t = p["time_s"][late]

    def waves(ending, first):
        return separate(t, [p[f"{name}{ending}_level_m"][late] for name in ("near", "far")],
                        [first, first + 0.25 * wave], depth, turn)
    before, after = waves("", start - 0.8 * wave), waves("_last", start + length + 0.55 * wave)
    rows = [("height that returns", before.reflection, abs(theory.reflected)),
            ("height that passes", after.incident / before.incident, abs(theory.transmitted))]
    base = np.stack([np.ones_like(t), *(f(n * omega * t) for n in (1, 2, 3)
                                        for f in (np.cos, np.sin))], axis=1)
    for n in range(5):
        fit = np.linalg.lstsq(base, p[f"w{n}_dy_m"][late], rcond=None)[0]
        rows.append((f"elevation at {n / 4:g} of its length",
                     math.hypot(fit[1], fit[2]) / (before.incident / 2),
                     abs(theory.elevation(n / 4 * length))))
    return [(f"{what}, {wanted:.3f} of the incident by theory, % too large",
             float(100 * (found / wanted - 1)), 5) for what, found, wanted in rows]


# --- that enters water ---
def slam(runs):
    """Of a plate of cases/verify/elastic_wedge.cfg, against Wagner's theory, from the touch on."""
    p, (time, bent, _, impulse) = runs[0].table(), reference("elastic_wedge.csv")
    t, force = p["time_s"], p["water_fy_N_per_m"]
    found = (p["middle_dy_m"] + 30 * t,
             np.append(0, np.cumsum(np.diff(t) * (force[1:] + force[:-1]) / 2)))
    return [(f"{what} at {1e3 * at:g} ms, % too large", float(100 * (
                np.interp(at + 4 * runs[0].dp / 30, t, own) / np.interp(at, time, wanted) - 1)), 10)
            for what, own, wanted in zip(("deflection", "impulse"), found, (bent, impulse))
            for at in (1.2e-3, 2.2e-3)]


# --- cases of solids, with a beam for them ---
def as_beam(case, solid, beam, *dropped):
    text = (ROOT / "cases" / f"{case}.cfg").read_text(encoding="utf-8")
    text = re.sub(r"(?s)\[(reference|domain|contact bed).*?(?=\n\[|\Z)", "", text)
    for words in ("scheme = paper", "integrator = symplectic", *dropped):
        text = re.sub(rf"(?m)^{re.escape(words)}.*\n", "", text)
    return re.sub(rf"(?s)\[solid {solid}\].*?(?=\n\[)", beam, text)


def peak(wanted, seconds):
    """Largest displacement against that of the converged solid of docs/results/validation.md, mm,
    and what both took, s."""
    def measure(runs):
        return [("largest displacement, % too large", 100 * (
                    1e3 * runs[0].table()["M1_dx_m"].max() / wanted - 1), 3),
                ("processor time over the solid's", runs[0].seconds / seconds, 0.1)]
    return measure


MIDDLE = "W + gate_thickness/2"
GATE = as_beam("gate", "gate", "[beam gate]\nshape = polyline: {0}, top; {0}, gate_length; "
               "{0}, dp/100\n"
               "clamp = {0}, top\nclamp = {0}, gate_length\nthickness = gate_thickness\n"
               "density = 1100 kg/m^3\nyoung = 7.8 MPa\npoisson = 0.4\n".replace("{0}", MIDDLE),
               "shape = box W, gate_length,").replace(f"{MIDDLE}, 0", f"{MIDDLE}, dp/100")
BAFFLE = as_beam("wet_baffle", "baffle", "[beam baffle]\nshape = polyline: base_x + base_width/2, "
                 "base_height; base_x + base_width/2, tip\nclamp = base_x + base_width/2, "
                 "base_height\nthickness = thickness\ndensity = 1250 kg/m^3\nyoung = 5.7 MPa\n"
                 "poisson = 0.4\n", "minus = box baffle_x").replace(
                     "baffle_x + baffle_width/2, tip", "base_x + base_width/2, tip")


def bar(name, density, *more):
    text = as_beam(f"turek_hron/{name}", "bar",
                   "[beam bar]\nshape = polyline: 0.25, 0.2; 0.6, 0.2\n"
                   f"clamp = 0.25, 0.2, cylinder\nthickness = 20 mm\ndensity = {density}\n"
                   "young = 2*mu*(1 + nu_s)\npoisson = nu_s\ndamping_time = 20 us\nslip = none\n"
                   "velocity = 0, start*(cosh(k*(x - 0.25)) - cos(k*(x - 0.25)) - 1.0185*"
                   "(sinh(k*(x - 0.25)) - sin(k*(x - 0.25))))\n",
                   "minus = box 0.2, 0.19", "kick =", "k =").replace(
                       "[constants]", "[constants]\nstart = 0\nk = 4.6941/0.35", 1).replace(
                           "sides = one", "sides = both", 1)

    def measure(runs):
        times, series = columns(runs[0].folder)
        found, rows = period(times, series["uy"]), []
        for what, (mean, size, often) in REFERENCE[name].items():
            if what == "ux" and name != "fsi1":
                continue
            own = summary(times, series[what], found)
            if size is None:
                rows.append((f"{what}, mean, % too large", 100 * (own["mean"] / mean - 1), 5))
            else:  # the standard deviation, if there is no period
                rows += [(f"{what}, {part}, % too large", 100 * (own[part] / wanted - 1),
                          5 if what == "uy" else None)
                         for part, wanted in (("amplitude", size), ("frequency", often))
                         if own[part]]
        return [(words, float(value), limit) for words, value, limit in rows]
    return text, [list(more)], measure


SCENES = {
    "beam alone, large deflection, 20 elements": elastica(),
    **{f"beam alone, {name}, 20 elements": dry(name) for name in SUPPORTS},
    "beam alone, large swings": energy(),
    **{f"plate in a basin, {SIDES[sides]}": wet(sides) for sides in SIDES},
    "solid in a basin, 4 spacings thick": solid_wet(),
    **{f"plate on waves, {n} spacings in the depth": ("floating_plate", [[f"across={n}"]], floating)
       for n in (16, 24, 32)},
    "plate on waves of 1 %, 32 spacings in the depth":
        ("floating_plate", [["across=32", "steep=0.01"]], floating),
    **{f"elastic wedge, {n} spacings in a plate": ("elastic_wedge", [[f"across={n}"]], slam)
       for n in (60, 120)},
    **{name + (", h_over_dp = 1.5" if more else ""): (text, [[*sets, *more]], measure)
       for name, text, sets, measure in (
           ("gate, dp = 5 mm", GATE, ["dp=5 mm", "wall=20 mm"], peak(43.6, 1494)),
           ("baffle, dp = 7 mm", BAFFLE, ["dp=7 mm"], peak(30.7, 657)))
       for more in ([], ["numerics.h_over_dp=1.5"])},
    "FSI1, 10 spacings across": bar("fsi1", 1000, "bar.mass_damping=40", "end_time=20 s"),
    "FSI2, 10 spacings across": bar("fsi2", 10000, "start=1.2", "ramp=0.3 s", "end_time=9 s"),
    "FSI3, 20 spacings across": bar("fsi3", 1000, "across=20", "start=0.6", "ramp=0.5 s",
                                    "end_time=5 s")}


def draw(known):
    """Frequencies in water over those in vacuum against the mass of the water that moves along."""
    figure, axes = plt.subplots(figsize=(6, 3.4), layout="constrained")
    ratio = np.logspace(-1.5, 4.5, 200)
    axes.plot(ratio, 1 / np.sqrt(1 + ratio), "k-", lw=1)
    axes.annotate("theory", (100, 0.1), xytext=(6, 6), textcoords="offset points")
    for sides, marker, colour in ((1, "o", COLOURS[0]), (2, "s", COLOURS[1])):
        rows = known.get(f"plate in a basin, {SIDES[sides]}", {"figures": []})["figures"]
        for k, (_, error, _) in enumerate(rows):
            thick, density = POINTS[k]
            inside, alone = theory(sides, thick, density)
            axes.plot((alone / inside)**2 - 1, inside / alone * (1 + error / 100), marker,
                      mfc="none", color=colour)
        axes.annotate(SIDES[sides], (0.05, 0.03 * 1.8 ** (2 - sides)), color=colour)
    axes.set(xscale="log", yscale="log", xlabel="added mass of the water / mass of the plate",
             ylabel="frequency in water / in vacuum")
    axes.set_title("Plate modelled as a beam: first frequency in water", fontsize=10, loc="left")
    save(figure, IMAGES / "beam_wet.png", dpi=130)


def main():
    run_figures(__doc__, SCENES, REPORT, stops=True)
    draw(load(REPORT.with_suffix(".json"), {}))


if __name__ == "__main__":
    run_tool(main)
