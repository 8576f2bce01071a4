#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Rigid bodies, waves and damping zones against theory (make verify-rigid, minutes on one core): a
cylinder that heaves, a box that rolls, a wedge and a cylinder that enter water, waves of a piston
that leave, a floating box, a body as dense as water.

The scenes are cases/verify/rigid_*.cfg and wave_piston.cfg, and the template floating_box. The
figures are kept in docs/results/rigid_verification.json."""
import math

from common import OUT, np, run_figures, run_tool
from metrics import reference
from sphfsi.waves import separate, wave_number

REPORT = OUT / "rigid_verification.md"


def extrema(times, values):
    """Times and values where the curve turns, by a parabola through three rows."""
    k = 1 + np.flatnonzero(np.diff(np.sign(np.diff(values))))
    slope, bend = (values[k + 1] - values[k - 1]) / 2, values[k + 1] - 2 * values[k] + values[k - 1]
    return times[k] - slope / bend * (times[1] - times[0]), values[k] - slope**2 / (2 * bend)


def measure_heave(runs):
    p = runs[0].table()
    t, y = p["time_s"], p["cylinder_cy_m"] / p["cylinder_cy_m"][0]
    when, found = extrema(t, y)
    wanted_when, wanted = extrema(*reference("rigid_heave.csv"))
    period, wanted_period = when[2] - when[0], wanted_when[2] - wanted_when[0]
    return [("period between the first two troughs, % too long",
             100 * (period / wanted_period - 1), 2),
            *((f"{name}, % of the start, too high", 100 * (found[k] - wanted[k]), 5)
              for k, name in enumerate(("first trough", "first crest", "second trough")))]


def measure_roll(runs):
    """Theory has no vortices, which take more than the waves: its damping is no reference."""
    p = runs[0].table()
    when, found = extrema(p["time_s"], p["box_angle_rad"])
    wanted_when, wanted = extrema(*reference("rigid_roll.csv"))
    return [("period between the first two crests, % too long",
             100 * ((when[2] - when[0]) / (wanted_when[2] - wanted_when[0]) - 1), 2),
            ("second crest over the first", found[2] / found[0], None),
            ("the same without vortices, theory", wanted[2] / wanted[0], None)]


def measure_wedge(runs):
    """F = 14.139 rho V^3 t for a deadrise of 30 degrees; from a third of the time on."""
    p = runs[0].table()
    t = p["time_s"]
    late = t > t[-1] / 3
    force, t = p["force_fy_N_per_m"][late] / 1000, t[late]
    return [("force, % too large", 100 * ((force @ t) / (t @ t) / 14.139 - 1), 3),
            ("its scatter, % of the last force", 100 * np.std(force / (14.139 * t[-1])
                                                              - t / t[-1]), None)]


def measure_fall(runs):
    """Depth over the diameter, against t sqrt(g/D)."""
    p, ratio, rows = runs[0].table(), runs[0].constants["ratio"], []
    time = p["time_s"] * math.sqrt(9.81 / 0.11)
    depth = (p["cylinder_cy_m"][0] - p["cylinder_cy_m"]) / 0.11
    for measured, words, limit in ((0, "theory", 5), (1, "the experiment", None)):
        at, wanted = np.array([row[2:] for row in reference("rigid_fall.csv").T
                               if list(row[:2]) == [ratio, measured] and row[2] < time[-1]]).T
        away = 100 * (np.interp(at, time, depth) - wanted)
        rows += [(f"depth, most that it exceeds {words}, % of the diameter",
                  away[np.argmax(abs(away))], limit),
                 ("the same, root of the mean square", math.sqrt((away**2).mean()), None)]
    return rows


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
    "roll of a box, 20 spacings in its width": ("rigid_roll", [[]], measure_roll),
    **{f"wedge, {n} spacings in the last depth":
       ("rigid_wedge", [[f"across={n}"]], measure_wedge) for n in (10, 20)},
    **{f"cylinder that falls, {words} buoyant, {n} spacings in its diameter":
       ("rigid_fall", [[f"across={n}", f"ratio={ratio}"]], measure_fall)
       for words, ratio in (("half", 0.5), ("neutrally", 1)) for n in (20, 40)},
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
