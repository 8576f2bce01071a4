#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Rigid bodies, waves and damping zones against theory (make verify-rigid, minutes on one core): a
cylinder that heaves, a box that rolls, a wedge that enters water, waves of a piston that leave, a
floating box, a body as dense as water.

The scenes are cases/verify/rigid_*.cfg and wave_piston.cfg, and the template floating_box. The
figures are kept in docs/results/rigid_verification.json."""
import math

from common import OUT, np, run_figures, run_tool
from sphfsi.waves import separate, wave_number

REPORT = OUT / "rigid_verification.md"
G, RHO = 9.81, 1000.0


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


def extrema(times, values):
    """Times and values where the curve turns, by a parabola through three rows."""
    k = 1 + np.flatnonzero(np.diff(np.sign(np.diff(values))))
    slope, bend = (values[k + 1] - values[k - 1]) / 2, values[k + 1] - 2 * values[k] + values[k - 1]
    return times[k] - slope / bend * (times[1] - times[0]), values[k] - slope**2 / (2 * bend)


def measure_heave(runs):
    p = runs[0].table()
    t, y = p["time_s"], p["cylinder_cy_m"] / p["cylinder_cy_m"][0]
    when, found = extrema(t, y)
    wanted_when, wanted = extrema(t, heave(t, 0.1, 0.6, 4.4))
    period, wanted_period = when[2] - when[0], wanted_when[2] - wanted_when[0]
    return [("period between the first two troughs, % too long",
             100 * (period / wanted_period - 1), 2),
            *((f"{name}, % of the start, too high", 100 * (found[k] - wanted[k]), 5)
              for k, name in enumerate(("first trough", "first crest", "second trough")))]


def measure_roll(runs):
    """Theory has no vortices, which take more than the waves: its damping is no reference."""
    p, spin = runs[0].table(), runs[0].constants["turning"]
    when, found = extrema(p["time_s"], p["box_angle_rad"])
    wanted_when, wanted = extrema(p["time_s"], roll(p["time_s"], 0.4, spin))
    return [("period between the first two crests, % too long",
             100 * ((when[2] - when[0]) / (wanted_when[2] - wanted_when[0]) - 1), 2),
            ("second crest over the first", found[2] / found[0], None),
            ("the same without vortices, theory", wanted[2] / wanted[0], None)]


def measure_wedge(runs):
    """F = 14.139 rho V^3 t for a deadrise of 30 degrees; from a third of the time on."""
    p = runs[0].table()
    t = p["time_s"]
    late = t > t[-1] / 3
    force, t = p["force_fy_N_per_m"][late] / RHO, t[late]
    return [("force, % too large", 100 * ((force @ t) / (t @ t) / 14.139 - 1), 3),
            ("its scatter, % of the last force", 100 * np.std(force / (14.139 * t[-1])
                                                              - t / t[-1]), None)]


def zone_reflection(kd, length, rate, power=2):
    """T-101a: the reflected over the incident amplitude, for a zone `length` wave lengths long and
    a rate in 1/T, by finite volumes. Depth and gravity are 1."""
    omega, wave, rows = math.sqrt(kd * math.tanh(kd)), 2 * math.pi / kd, 16
    before = wave / 2 + 3  # of the zone
    whole = before + length * wave
    columns = int(whole * max(160 / wave, 12))
    dx, dy = whole / columns, 1 / rows

    def over(x):
        part = np.clip((x - before) / (length * wave), 0, 1)
        return dy / dx / (1j * omega + rate * omega / (2 * math.pi) * part**power)
    at, row = (np.arange(columns) + 0.5) * dx, np.eye(rows)
    face, middle = over(at - dx / 2), over(at)
    face[0] *= 2  # half a spacing from the end, where the incident wave is given
    upright = np.diff(row, axis=0).T @ np.diff(row, axis=0) * (dx / dy)**2
    incident, to_next = np.cosh(kd * (np.arange(rows) + 0.5) * dy), [None] * columns
    for i in reversed(range(columns)):
        matrix = middle[i] * upright + face[i] * row
        through = middle[i] * dx / dy
        matrix[-1, -1] += 1j * omega * dx * through / (through + 0.5j * omega * dy)
        if i < columns - 1:
            matrix += face[i + 1] * (row - to_next[i + 1])
        to_next[i] = face[i] * np.linalg.inv(matrix)
    p = [incident]
    for step in to_next:
        p.append(step @ p[-1])
    free = at < before - 1.5  # where evanescent waves have decayed
    there, back = np.linalg.lstsq(np.exp(1j * kd * np.outer(at[free], [-1, 1])),
                                  np.array(p[1:])[free] @ incident, rcond=None)[0]
    return abs(back / there)


def height_by_flux(time, level, period, depth):
    """Height of a wave of one frequency that carries the energy of the first five harmonics."""
    base, flux = 2 * math.pi / period, []
    terms = [f(n * base * time) for n in range(1, 6) for f in (np.cos, np.sin)]
    found = np.linalg.lstsq(np.stack([np.ones_like(time), *terms], axis=1), level, rcond=None)[0]
    for n in range(1, 6):
        k = wave_number(n * base, depth)
        flux.append(n / k * (1 + 2 * k * depth / math.sinh(2 * k * depth)))
    return 2 * math.sqrt(((found[1::2]**2 + found[2::2]**2) * flux).sum() / flux[0])


def measure_waves(runs):
    """Waves there and back in the last three periods, from gauges a quarter of a length apart.
    Long waves give energy to their harmonics, so their limit is for the flux of energy."""
    p, given = runs[0].table(), {"away": 2, "periods": 12, **runs[0].constants}
    depth, wave = 0.4, 2 * math.pi * 0.4 / given["kd"]
    period = runs[0].end_time / given["periods"]
    late = p["time_s"] > runs[0].end_time - 3 * period

    def found(ending, lengths):
        return separate(p["time_s"][late], [p[f"{name}{ending}_level_m"][late]
                                            for name in ("near", "far")],
                        [lengths * wave, (lengths + 0.25) * wave], depth, period)
    near, last = found("", 1), found("_last", given["away"])
    rows, height, long = [], given["steep"] * wave, given["kd"] < 1
    for waves, ending, lengths in (near, "", 1), (last, "_last", given["away"]):
        rows.append((f"height at x = {lengths:g} lengths, % too large",
                     100 * (waves.incident / height - 1), None if long else 2))
        if long:
            flux = [height_by_flux(p["time_s"][late], p[f"{name}{ending}_level_m"][late], period,
                                   depth) for name in ("near", "far")]
            rows.append(("the same with the energy of its harmonics",
                         100 * (np.mean(flux) / height - 1), 2))
    return [*rows, ("height that comes back, %", 100 * near.reflection, 3),
            ("the same by linear theory", 100 * zone_reflection(given["kd"], 1.5, 12), None)]


def measure_draft(runs):
    """Mean of the last half, from rest, against what Archimedes says."""
    p = runs[0].table()
    height = p["box_cy_m"][p["time_s"] > runs[0].end_time / 2].mean()
    return [("draft, % too large", 100 * float(0.6 - height) / 0.16, 0.5)]


def measure_neutral(runs):
    p = runs[0].table()
    return [("largest distance from its place, dp", float(
        np.hypot(p["box_cx_m"], p["box_cy_m"] - p["box_cy_m"][0]).max()) / runs[0].dp, 0.1)]


# name: case, settings of each run, how they are measured
SCENES = {
    **{f"heave of a cylinder, {n} spacings in the radius":
       ("rigid_heave", [[f"across={n}"]], measure_heave) for n in (10, 20)},
    "roll of a box, 20 spacings in its width": ("rigid_roll", [["turning=0.6"]], measure_roll),
    **{f"wedge, {n} spacings in the last depth":
       ("rigid_wedge", [[f"across={n}"]], measure_wedge) for n in (10, 20)},
    **{f"waves of a {maker}, kd = {kd:g}, {n} spacings in the depth":
       ("wave_piston", [[f"across={n}", f"kd={kd}", f"steep={steep}",
                         f"flap={int(maker == 'flap')}"]], measure_waves)
       for maker, kd, n, steep in (
           ("piston", 0.5, 20, 0.01), ("piston", 1, 20, 0.03), ("piston", 1.5, 20, 0.03),
           ("piston", 1.5, 40, 0.03), ("piston", 3, 40, 0.03), ("flap", 1.5, 20, 0.03))},
    "waves of a piston far away, kd = 1.5, 20 spacings in the depth":
        ("wave_piston", [["kd=1.5", "steep=0.03", "away=10", "periods=25"]], measure_waves),
    "floating box, 20 spacings across":
    ("floating_box", [["end_time=8 s", "lift=0", "height=0.32 m"]], measure_draft),
    "body as dense as the water around it, 10 spacings across":
        ("rigid_neutral", [[]], measure_neutral)}


if __name__ == "__main__":
    run_tool(lambda: run_figures(__doc__, SCENES, REPORT))
