#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Rigid bodies, waves and damping zones against theory (make verify-rigid, minutes on one core): a
cylinder that heaves, a box that rolls, a wedge that enters water, waves of a piston that leave, a
floating box, a body as dense as water.

The scenes are cases/verify/rigid_*.cfg and wave_piston.cfg, and the template floating_box. The
figures are kept in docs/results/rigid_verification.json."""
import math

from common import OUT, np, run_figures, run_tool
from sphfsi.waves import separate

REPORT = OUT / "rigid_verification.md"
G, RHO = 9.81, 1000.0


def exp_e1(z):
    """exp(z) E1(z), by the series of E1."""
    term, total = np.ones_like(z), -np.euler_gamma - np.log(z)
    for k in range(1, 120):
        term = term * -z / k
        total = total - term / k
    return np.exp(z) * total


def heave_coefficients(size):
    """Added mass over rho pi a^2/2, and damping over that and the frequency, of a half-submerged
    cylinder of radius a = 1 in deep water, size = omega^2 a/g: a source and multipoles whose normal
    velocity is that of the cylinder (Ursell 1949)."""
    angle = (np.arange(60) + 0.5) * math.pi / 120  # from the vertical
    turn = np.exp(-1j * angle)
    wave = np.exp(-size * turn)
    source = exp_e1(-size * turn)
    slope = -size * source - 1 / turn
    values = [(source + 1j * math.pi * wave).real - 1j * math.pi * wave.real]
    normal = [((slope - 1j * math.pi * size * wave) * turn).real
              + 1j * math.pi * size * (wave * turn).real]
    for m in range(1, 10):
        even, odd = np.cos(2 * m * angle), np.cos((2 * m - 1) * angle)
        values.append(even + size / (2 * m - 1) * odd)
        normal.append(-2 * m * even - size * odd)
    strength = np.linalg.lstsq(np.array(normal, complex).T, np.cos(angle).astype(complex),
                               rcond=None)[0]
    found = -2 * np.mean(strength @ np.array(values) * np.cos(angle))
    return found.real, -found.imag


def heave(times, radius):
    """Height over its initial value of the cylinder, released from rest: the Fourier integral of
    the linear equation of motion (Maskell and Ursell 1970)."""
    sizes = np.linspace(0.004, 8, 400)
    mass = RHO * math.pi * radius**2 / 2
    found = mass * np.array([heave_coefficients(size) for size in sizes]).T
    omega = np.linspace(0.02, math.sqrt(sizes[-1] * G / radius), 6000)
    added, damping = (np.interp(omega, np.sqrt(sizes * G / radius), column) for column in found)
    stiffness = 2 * RHO * G * radius
    speed = -stiffness / (stiffness - omega**2 * (mass + added) + 1j * omega**2 * damping)
    v = 2 / math.pi * np.trapezoid(speed.real * np.cos(np.outer(times, omega)), omega, axis=1)
    return 1 + np.concatenate([[0], np.cumsum((v[1:] + v[:-1]) / 2 * np.diff(times))])


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
    wanted_when, wanted = extrema(t, heave(t, 0.1))
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


def measure_waves(runs):
    """Waves there and back in the last three periods, from gauges a quarter of a length apart."""
    p, given = runs[0].table(), {"away": 2, "periods": 12, **runs[0].constants}
    depth, wave = 0.4, 2 * math.pi * 0.4 / given["kd"]
    period = runs[0].end_time / given["periods"]
    late = p["time_s"] > runs[0].end_time - 3 * period

    def found(ending, lengths):
        return separate(p["time_s"][late], [p[f"{name}{ending}_level_m"][late]
                                            for name in ("near", "far")],
                        [lengths * wave, (lengths + 0.25) * wave], depth, period)
    near, last = found("", 1), found("_last", given["away"])
    return [(f"height {lengths:g} lengths away, % too large",
             100 * (waves.incident / (given["steep"] * wave) - 1), 2)
            for waves, lengths in ((near, 1), (last, given["away"]))] + [
        ("height that comes back, %", 100 * near.reflection, 3),
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
           ("piston", 1.5, 40, 0.03), ("piston", 3, 40, 0.03), ("flap", 1.5, 20, 0.03),
           ("flap", 1.5, 40, 0.03))},
    "waves of a piston far away, kd = 1.5, 20 spacings in the depth":
        ("wave_piston", [["kd=1.5", "steep=0.03", "away=10", "periods=25"]], measure_waves),
    "floating box, 20 spacings across":
    ("floating_box", [["end_time=8 s", "lift=0", "height=0.32 m"]], measure_draft),
    "body as dense as the water around it, 10 spacings across":
        ("rigid_neutral", [[]], measure_neutral)}


if __name__ == "__main__":
    run_tool(lambda: run_figures(__doc__, SCENES, REPORT))
