#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs small scenes with open boundaries and says how far each is off (make verify-open, some
minutes on one core): a vortex that leaves, a weir with given discharge, a flow that reverses
periodically, a jet on a plate, a cylinder in a stream. The scenes are cases/verify/open_*.cfg and
cylinder.cfg, whose long runs of four minutes to two hours --only runs alone ("Re = 100, 20").
Figures are kept in docs/results/open_verification.json."""
import math

from common import OUT, np, run_figures, run_tool
from metrics import water

REPORT = OUT / "open_verification.md"
G = 9.81


def on_grid(points, x, values, reach):
    """Means of values at points, weighted by (1 - r/reach)^2."""
    out = np.empty((len(points), values.shape[1]))
    for k, point in enumerate(points):
        r = np.hypot(*(x - point).T) / reach
        weight = np.where(r < 1, (1 - r) ** 2, 0)
        out[k] = weight @ values / weight.sum()
    return out


def measure_vortex(runs):
    """Beside a channel twice as long, over 1.3 m that end 0.1 m before the outlet; per cent of the
    swirl."""
    dp, swirl = runs[0].dp, 0.3
    grid = np.array([(x, y) for x in np.arange(-0.6, 0.701, 0.05)
                     for y in np.arange(-0.4, 0.41, 0.05)])
    most, left, left_long = 0.0, 0.0, 0.0
    for (t, x, v), (_, far_x, far_v) in zip(*map(water, runs)):
        if t < 0.49:
            continue
        near, far = on_grid(grid, x, v, 2 * dp), on_grid(grid, far_x, far_v, 2 * dp)
        most = max(most, float(np.sqrt(((near - far) ** 2).sum(axis=1).mean())))
        if t > 1.99:
            left, left_long = (float(np.hypot(*(found - (1, 0)).T).max()) for found in (near, far))
    return [("RMS difference from a channel twice as long, largest in time, % of the swirl",
             100 * most / swirl, 5),
            ("largest velocity beside the stream's, 2.2 s, % of the swirl", 100 * left / swirl,
             None),
            ("the same in the long channel", 100 * left_long / swirl, None)]


def measure_weir(runs):
    """Means of the last two seconds."""
    q, crest, p = 0.05, 0.1, runs[0].table()
    late = p["time_s"] > p["time_s"][-1] - 2
    level, over = (float(p[next(c for c in p if c.startswith(key))][late].mean())
                   for key in ("head", "over"))
    head = level - crest + (q / level) ** 2 / (2 * G)
    wanted = 1.5 * (q * q / G) ** (1 / 3)
    return [("head over the crest, % too high", 100 * (head / wanted - 1), 5),
            ("discharge over the crest, % too high", 100 * (abs(over) / q - 1), 2)]


def womersley(y, time):
    """Velocity at y (m, -0.5 to 0.5) of the flow of open_reversal.cfg."""
    omega = 2 * math.pi / 4
    k = (1 + 1j) * 0.5 * math.sqrt(omega / (2 * 0.05))
    return (-1j * (1 - np.cosh(k * 2 * y) / np.cosh(k)) * np.exp(1j * omega * time)).real


def measure_reversal(runs):
    """The second period; profile halfway between the boundaries, pressure between 0.4 and 1.6 m.
    Particles of the buffers do not count: the last row of each comes and goes."""
    omega = 2 * math.pi / 4
    off, size, count = [], [], []
    for t, x, v in water(runs[0]):
        count.append(int(((x[:, 0] > 0) & (x[:, 0] < 2)).sum()))
        if t < 3.99:
            continue
        middle = abs(x[:, 0] - 1) < 0.1
        exact = womersley(x[middle, 1], t)
        off.append(((v[middle, 0] - exact) ** 2).mean())
        size.append((exact ** 2).mean())
    p = runs[0].table()
    t = p["time_s"]
    late = t >= 4
    basis = np.stack([np.cos(omega * t[late]), np.sin(omega * t[late])], axis=1)
    drop = (p["ahead_p_Pa"] - p["behind_p_Pa"])[late]
    c, s = np.linalg.lstsq(basis, drop, rcond=None)[0]
    noise, wanted = float(np.std(drop - basis @ (c, s))), 1000 * omega * 1.2
    return [("RMS error of the velocity, % of its RMS", 100 * math.sqrt(sum(off) / sum(size)), 2),
            ("amplitude of the pressure difference, % too high",
             100 * (math.hypot(c, s) / wanted - 1), 2),
            ("its phase, degrees late", math.degrees(math.atan2(s, c)), 2),
            ("rest of it, % of the amplitude", 100 * noise / wanted, None),
            ("change of the number of particles between the lines, %",
             100 * max(abs(n / count[0] - 1) for n in count), 2)]


def measure_jet(runs):
    """Means of the last 0.3 s; the sheets beyond the ends of the plate."""
    ideal, half, d = 1000 * 2**2 * 0.04, 0.4, 0.04
    p = runs[0].table()
    force = -p["plate_fy_N_per_m"][p["time_s"] > 0.3].mean()
    v = np.concatenate([v[abs(x[:, 0]) > half + d] for t, x, v in water(runs[0]) if t > 0.3])
    return [("force on the plate, % of rho U^2 d too high", 100 * (float(force) / ideal - 1), 3),
            ("angle of the sheets behind it, degrees upwards",
             math.degrees(math.atan2(v[:, 1].sum(), abs(v[:, 0]).sum())), 2)]


def first_harmonic(t, signal):
    """Frequency and amplitude of the strongest oscillation, for D = 1 m and U = 1 m/s."""
    def amplitude(f):
        waves = np.stack([np.cos(2 * np.pi * f * t), np.sin(2 * np.pi * f * t), np.ones_like(t)],
                         axis=1)
        return float(np.hypot(*np.linalg.lstsq(waves, signal, rcond=None)[0][:2]))
    frequency = max(np.arange(0.1, 0.3, 0.0005), key=amplitude)
    return float(frequency), amplitude(frequency)


def measure_cylinder(known, judged):
    """The last two fifths of the run, in rho U^2 D/2; `known` by others: drag, lift, Strouhal
    number, of which some are judged."""
    def measure(runs):
        p = runs[0].table()
        late = p["time_s"] > 0.6 * runs[0].end_time
        drag, lift = (p[f"cylinder_f{axis}_N_per_m"][late] / 500 for axis in "xy")
        rows = [("drag coefficient, mean", float(drag.mean()), None),
                ("its standard deviation", float(drag.std()), None)]
        if runs[0].constants["Re"] < 50:
            return [*rows, ("lift coefficient, standard deviation", float(lift.std()), None)]
        frequency, swing = first_harmonic(p["time_s"][late], lift)
        rows += [("lift coefficient, first harmonic", swing, None),
                 ("Strouhal number", frequency, None)]
        found, limits = (float(drag.mean()), swing, frequency), (4, 10, 2)
        return rows + [(f"{words}, % too large", 100 * (value / wanted - 1),
                        limit if judged else None)
                       for words, value, wanted, limit in
                       zip(("drag", "lift", "frequency"), found, known, limits)]
    return measure


def cylinder(reynolds, across):
    """Values of this domain, by cases/reference/cylinder_lattice_boltzmann.py."""
    known = {100: (1.518, 0.387, 0.1785)}.get(reynolds, ())
    end = 25 if reynolds < 50 else 80
    return "cylinder", [[f"Re={reynolds}", f"across={across}", f"end={end}*D/U"]], \
        measure_cylinder(known, across >= 20)


def vortex(ratio):
    return "open_vortex", [[f"ratio={ratio}", f"length={length} m"] for length in (1.6, 3.2)], \
        measure_vortex


# name: case, settings of each run, how they are measured
SCENES = {"vortex, 30 spacings over the channel": vortex(30), "vortex, 60 spacings": vortex(60),
          **{f"{name}, {n} spacings {way}": (f"open_{name}", [[f"{key}={n}"]], measure)
             for name, way, key, measure, sizes in (
                 ("weir", "high", "ratio", measure_weir, (10, 20)),
                 ("reversal", "across", "ratio", measure_reversal, (20, 40)),
                 ("jet", "across", "across", measure_jet, (10, 20))) for n in sizes},
          **{f"cylinder, Re = {reynolds}, {across} spacings across": cylinder(reynolds, across)
             for reynolds in (20, 100, 200) for across in (10, 20, 40)}}

SLOW = [name for name in SCENES if name.startswith("cylinder") and ", 10 " not in name]


if __name__ == "__main__":
    run_tool(lambda: run_figures(__doc__, SCENES, REPORT, slow=SLOW))
