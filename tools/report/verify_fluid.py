#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs small scenes of still water, waves, impact, openings and bodies with both schemes of the
fluid and says how far each is off (make verify-fluid, ten minutes on one core). The scenes are
those of cases/verify, shipped cases and templates. A figure is (words, value, limit or None); it is
kept if |value| <= limit. Figures are stored in docs/results/fluid_verification.json."""
import math

import metrics
from common import OUT, np, run_figures, run_tool, single
from metrics import reference
from sphfsi.snapshots import KINDS

REPORT = OUT / "fluid_verification.md"
SCHEMES = ("paper", "standard")


def skins(*settings):
    """Runs that differ in round-off alone. The cells limit the skin, so that larger ones are
    equal."""
    return [[*settings, f"numerics.skin={skin}"] for skin in (0.35, 0.4, 0.45, 0.5, 0.55)]
G = 9.81
FLUID = KINDS["fluid"]


def steps_of(run):
    shots = metrics.snapshots(run)
    for step in range(len(shots.times)):
        yield shots, step


def entered(run):
    """Particle-snapshots within half a spacing of a wall's or body's particle; the least distance,
    in dp."""
    count, least, dp = 0, 1.0, run.dp
    for shots, step in steps_of(run):
        x, kind = shots.load(step, "Points")[:, :2], shots.load(step, "kind")
        distance = metrics.nearest(x[kind == FLUID], x[kind != FLUID], dp) / dp
        count += int((distance < 0.5).sum())
        least = min(least, float(distance.min()))
    return count, least


def penetration(run):
    count, least = entered(run)
    return [("particles that have entered, by snapshots", count, 0),
            ("nearest to a body, dp", least, None)]


def largest_group(points, reach):
    """The points of the largest group whose members are linked by distances within reach."""
    if len(points) == 0:
        return points
    a, b = metrics.close_pairs(points, points, reach)
    group, before = np.arange(len(points)), None
    while before is None or (group != before).any():
        before = group.copy()
        np.minimum.at(group, a, before[b])  # the least number of a neighbour, and of its group
        group = group[group]
    return points[group == np.bincount(group).argmax()]


def distances(water, bodies, sign):
    """How far fluid particles are from the face of a body at their height, in the direction of sign
    and in the unit of the coordinates, which is dp; nan above the body. The face is half a spacing
    outside the centres."""
    rows, edge = np.floor(bodies[:, 1]).astype(int), {}
    for row, x in zip(rows, sign * bodies[:, 0]):
        edge[row] = max(edge.get(row, -math.inf), x)
    faces = [edge.get(row, math.nan) for row in np.floor(water[:, 1]).astype(int)]
    return sign * water[:, 0] - np.array(faces) - 0.5


def cavity(run, face, sign):
    """Widest gap between a submerged upright face and the fluid, in dp, over all snapshots. The
    face is that of the bodies within 24 dp of x = face, wherever it has bent to, with fluid in the
    direction of sign. A row of 1.5 dp is submerged if at least six particles lie in the 8 dp beside
    the face, and at least five touch it in the 8 dp above; a jet or a film is none. Only the
    largest group of particles within 32 dp of x = face counts, linked by 2 dp: drops in the air are
    no water that the face is under."""
    widest, dp = 0.0, run.dp
    for shots, step in steps_of(run):
        x, kind = shots.load(step, "Points")[:, :2] / dp, shots.load(step, "kind")
        off = abs(x[:, 0] - face / dp)
        water = largest_group(x[(kind == FLUID) & (off < 32)], 2)
        away = distances(water, x[(kind != FLUID) & (off < 24)], sign)
        y, away = water[(away > 0) & (away < 8), 1], away[(away > 0) & (away < 8)]
        touching = np.sort(y[away < 1.5])
        for row in np.arange(0.5, touching[-5], 0.5) if len(touching) >= 5 else ():
            here = away[abs(y - row) < 0.75]
            gap = here.min() - 0.5 if len(here) >= 6 else 0
            if gap > 1 and ((touching > row) & (touching < row + 8)).sum() >= 5:
                widest = max(widest, float(gap))
    return widest


# --- still water ---
def rest_of(depth):
    def measure(run):
        """Over the snapshots of the last tenth, and of the tenth before half of the run: L2 error
        of the pressure of all particles, fastest particle; level by the probe."""
        end, speed, error, height = run.end_time, [], {0.5: [], 1.0: []}, []
        for shots, step in steps_of(run):
            if step == 0:
                height = [shots.load(0, "Points")[shots.load(0, "kind") == FLUID, 1].mean()]
            for part, found in error.items():
                if (part - 0.1) * end < shots.times[step] <= part * end * 1.0001:
                    fluid = shots.load(step, "kind") == FLUID
                    y, p = shots.load(step, "Points")[fluid, 1], shots.load(step, "pressure")[fluid]
                    found.append(float(np.sqrt(np.mean((p / (1000 * G * depth) - (depth - y) /
                                                        depth) ** 2))))
                    if part == 1:
                        v = shots.load(step, "velocity")[fluid, :2]
                        height.append(y.mean())
                        speed.append(float(np.hypot(v[:, 0], v[:, 1]).max()))
        if not error[1.0]:
            return [(words, math.nan, limit) for words, limit in REST]
        level = run.table("probes.csv")
        level = level[[c for c in level if c.startswith("level")][0]]
        values = (100 * np.mean(error[1.0]), 100 * (np.mean(error[1.0]) - np.mean(error[0.5])),
                  100 * (level[-len(level) // 10:].mean() / depth - 1),
                  100 * (np.mean(height[1:]) - height[0]) / depth,
                  1e3 * np.mean(speed) / math.sqrt(G * depth))
        return [(words, float(value), limit) for (words, limit), value in zip(REST, values)]
    return measure


REST = [("L2 error of the pressure, % of rho g H", 1),
        ("its change from 50 to 100 s, % of rho g H", 0.1),
        ("level at a gauge, % of H", 0.1),
        ("centre of mass, % of H higher than at the start", None),
        ("fastest particle, 1e-3 sqrt(gH)", 1)]


# --- waves ---
def wave_of(judged):
    """Limits apply where the measured wave is resolved as the aim says."""
    def waves(frequency, loss):
        return [("frequency, % too high", frequency, 1 if "frequency" in judged else None),
                ("loss of amplitude a period, %", loss, 2 if "loss" in judged else None)]

    def measure(run):
        """The kinetic energy is greatest twice a period: parabolas through its maxima give both.
        Each is sought half a period after the one before it; where one is missing there is no
        period."""
        H, k = 0.3, 2 * math.pi / 0.9
        period = 2 * math.pi / math.sqrt(G * k * math.tanh(k * H))
        within = 0.17 * period
        ledger = run.table("ledger.csv")
        t, kinetic = ledger["time_s"], ledger["kinetic_J_per_m"]
        at, top = [0.0], [kinetic[0]]
        while (guess := at[-1] + period / 2) + within <= t[-1]:
            near = abs(t - guess) < within
            c = np.polyfit(t[near] - guess, kinetic[near], 2)
            later = -c[1] / (2 * c[0])
            if not (c[0] < 0 and abs(later) < within):
                return waves(math.nan, math.nan)
            at.append(guess + later)
            top.append(np.polyval(c, later))
        if len(at) < 4:
            return waves(math.nan, math.nan)
        n = np.arange(2, len(at))
        found = 2 * np.polyfit(n, at[2:], 1)[0]
        decay = np.polyfit(n / 2, np.log(top[2:]), 1)[0] / 2
        return waves(100 * (period / found - 1), 100 * (1 - math.exp(decay)))
    return measure


def travel_of(judged):
    def measure(run):
        """First component in space of eight gauges, from one to five periods: its phase turns with
        omega, its size is the amplitude."""
        p = run.table("probes.csv")
        H, k, a = 0.36, 2 * math.pi / 1.2, 0.03
        T = math.tanh(k * H)
        omega = math.sqrt(G * k * T * (1 + (9 - 10 * T**2 + 9 * T**4) / (8 * T**4) * (k * a) ** 2))
        gauges = [p[c] for c in p if c.startswith("at")]
        wave = sum(g * np.exp(-2j * math.pi * (j + 0.5) / 8) for j, g in enumerate(gauges)) / 4
        late = p["time_s"] > 2 * math.pi / omega
        t, wave = p["time_s"][late], wave[late]
        celerity = -np.polyfit(t, np.unwrap(np.angle(wave)), 1)[0] / omega
        loss = 1 - math.exp(np.polyfit(t, np.log(abs(wave)), 1)[0] * 2 * math.pi / omega)
        limit = 1 if judged else None
        return [("celerity, % too high", 100 * (celerity - 1), limit),
                ("loss of height a wave length, %", 100 * loss, limit)]
    return measure


# --- impact ---
def over(measure):
    """For runs that differ in round-off alone: of each figure the mean and its standard deviation
    over the runs, and of what must not be the worst run."""
    worst = {"particles": np.max, "nearest": np.min, "widest": np.max}

    def measure_all(runs):
        rows, n = [], len(runs)
        for figures in zip(*(measure(run) for run in runs)):
            (what, _, limit), values = figures[0], [value for _, value, _ in figures]
            if what.split()[0] in worst:
                rows.append((f"{what}, worst of {n}", float(worst[what.split()[0]](values)), limit))
            else:
                rows += [(f"{what}, mean of {n}", float(np.mean(values)), limit),
                         ("its standard deviation", float(np.std(values, ddof=1)), None)]
        return rows
    return measure_all


def impact_of(limit):
    def measure(run):
        p = run.table("probes.csv")
        t, q = p["time_s"], p["wall_p_Pa"] / (1000 * G * 0.6)
        mean = np.convolve(q, np.ones(21) / 21, "same")
        plateau = (t > 0.85) & (t < 1.25)
        later = t > 1.3
        return [("deviation from the 20 ms mean in the plateau, rho g H",
                 float(np.std((q - mean)[plateau])),
                 limit),
                ("mean of the plateau, rho g H", float(q[plateau].mean()), None),
                ("later peak, mean over 20 ms, rho g H", float(mean[later][:-10].max()), None),
                *penetration(run),
                ("widest cavity at the far wall, dp", cavity(run, 3.22, -1), 1)]
    return measure


# Medians of Lobovsky et al. 2014, Pa s, s, s, Pa; second-hand.
IMPACT = {"impulse": 1274, "before": 0.007, "after": 0.104, "peak": 18569}
# Later peaks at 3, 30 and 80 mm over rho g H, t sqrt(g/H) of each: Lobovsky et al. 2014, H = 0.3 m,
# one run, read from the curves that PySPH's examples/db_exp_data.py has.
LATER = {"P1": (0.909, 5.97), "P3": (0.927, 5.95), "P4": (0.827, 5.99)}


def measure_later_peaks(run):
    p, H = run.table("probes.csv"), 0.3
    t, rows = p["time_s"] * math.sqrt(G / H), []
    for sensor, (peak, when) in LATER.items():
        q = np.convolve(p[f"{sensor}_p_Pa"] / (1000 * G * H), np.ones(5) / 5, "same")  # 5 ms
        late = (t > 5.2) & (t < t[-5])
        rows += [(f"{sensor}: later peak, mean over 5 ms, % more than measured",
                  100 * (float(q[late].max()) / peak - 1), 25),
                 (f"{sensor}: time of the later peak, % late",
                  100 * (float(t[late][np.argmax(q[late])]) / when - 1), None)]
    return rows


def measure_gate_impact(run):
    p = run.table("probes.csv")
    t, H = p["time_s"], 0.6
    front = [c for c in p if c.startswith("front")][0]
    time, place = reference("dam_break_front_lobovsky_2014.csv")
    found = np.interp(time, t * math.sqrt(G / H), p[front] / H)
    off = 100 * (found / place - 1)
    p = p["wall_p_Pa"]
    short = np.convolve(p, np.ones(11) / 11, "same")  # 5 ms
    top = t[np.argmax(short)]
    during = (t >= top - IMPACT["before"]) & (t <= top + IMPACT["after"])
    push = float(np.trapezoid(p[during], t[during]))
    return [("front, largest deviation from the measured one, %", float(max(off, key=abs)), 5),
            ("front from t = sqrt(H/g) on, largest deviation, %",
             float(max(off[time > 1], key=abs)), 5),
            ("impulse of the first peak, % more than measured",
             100 * (push / IMPACT["impulse"] - 1), 10),
            ("first peak, mean over 5 ms, % more than measured",
             100 * (float(short.max()) / IMPACT["peak"] - 1), None),
            ("time of the first peak, sqrt(H/g)", float(top) * math.sqrt(G / H), None)]


def measure_front(run):
    """Martin and Moyce's series of the square column (as in Lobovsky et al. 2014, Fig. 12). No
    instant of its release is known, so the time counts from where the front is at 1.44 a, a point
    of the series."""
    time, place = reference("dam_break_martin_moyce_1952.csv")
    width = 0.05715
    t, x = metrics.foremost(run) / np.array([[math.sqrt(width / G)], [width]])
    known = float(np.interp(1.44, place, time))
    shift = float(np.interp(1.44, x, t)) - known
    late = time >= known
    off = 100 * (np.interp(time[late] + shift, t, x) / place[late] - 1)
    return [("front, largest deviation from Martin and Moyce, %", float(max(off, key=abs)), 5),
            ("shift of the time, sqrt(a/g)", shift, None)]


# --- several runs at once ---
def measure_free_front(runs):
    """The path of the front against potential flow (cases/reference/dam_break_potential.py), whose
    time begins with the release, as in the runs, of which each is finer than the one before."""
    time, place = reference("dam_break_front_potential.csv")
    H, means, rows = 0.6, [], []
    for run in runs:
        p, ratio = run.table("probes.csv"), round(H / run.dp)
        front = p[[c for c in p if c.startswith("front")][0]] / H
        off = 100 * (np.interp(time, p["time_s"] * math.sqrt(G / H), front) / place - 1)
        means.append(float(np.mean(abs(off))))
        rows.append((f"H/dp = {ratio}: front, largest deviation from potential flow, %",
                     float(max(off, key=abs)), 5 if ratio == 40 else None))
    order = math.log(means[0] / means[-1]) / math.log(runs[0].dp / runs[-1].dp)
    return [*rows, ("order of its mean deviation", order, None)]


def measure_opening(runs):
    """The same opening with 4 and with 16 particles across."""
    through = [1e3 * float(np.trapezoid(*(p[c] for c in p if c.startswith("out")), p["time_s"]))
               for p in (run.table("probes.csv") for run in runs)]
    return [("water let through in 0.4 s, 4 across, 1e-3 m^2", through[0], None),
            ("the same, 16 across, 1e-3 m^2", through[1], None),
            ("4 across against 16, % more", 100 * (through[0] / through[1] - 1), 3)]


BAFFLE_TIP = 18.3  # mm, converged
# column, words, unit
BAFFLE_LOADS = [("load_fy_N_per_m", "vertical load", "N/m"),
                ("load_fx_N_per_m", "horizontal load", "N/m"),
                ("load_mz_Nm_per_m", "moment of the load", "N")]


def more(values):
    """By how much the first half is more than the second, %."""
    half = len(values) // 2
    return float(100 * (np.mean(values[:half]) / np.mean(values[half:]) - 1))


def measure_baffle(runs):
    """Half of the runs have dp, half dp/2. In each half only the skin of the search differs, which
    does not matter. Of each load the largest row, its largest mean over 20 rows (20 ms), and the
    impulse to 0.4 s; of the foot the largest row."""
    tables = [run.table("probes.csv") for run in runs]

    def largest(column, rows=1):
        """Of the means over so many rows."""
        return [float(abs(metrics.running_mean(p[column], rows)).max()) for p in tables]

    half, rows, tips, foot = len(runs) // 2, [], largest("tip_dx_m"), largest("foot_mz_Nm_per_m")
    for words, part, limit in (("4 across", slice(0, half), 3),
                               ("8 across", slice(half, None), 1.5)):
        tip = 1e3 * np.array(tips[part])
        rows += [(f"{words}: largest tip displacement, mean of {half}, mm", float(tip.mean()),
                  None),
                 (f"{words}: the same, % more than converged ({BAFFLE_TIP} mm)",
                  float(100 * (tip.mean() / BAFFLE_TIP - 1)), limit),
                 (f"{words}: its standard deviation, %", float(100 * tip.std(ddof=1) / tip.mean()),
                  None)]
    for column, words, unit in BAFFLE_LOADS:
        top, early = largest(column), [p["time_s"] <= 0.4 for p in tables]
        impulses = [float(np.trapezoid(p[column][k], p["time_s"][k]))
                    for p, k in zip(tables, early)]
        two = np.mean(top[half:])
        rows += [(f"8 across: largest {words}, {unit}", float(two), None),
                 (f"8 across: {words}, standard deviation, %",
                  float(100 * np.std(top[half:], ddof=1) / two), None),
                 (f"{words}, 4 across against 8, % more", more(top), 5),
                 (f"{words}, means over 20 ms: the same", more(largest(column, 20)), None),
                 (f"{words}, impulse to 0.4 s: the same", more(impulses), None)]
    rows += [("8 across: largest moment in the clamp, N", float(np.mean(foot[half:])), None),
             ("moment in the clamp, 4 across against 8, % more", more(foot), None)]
    for words, run in (("4 across", runs[0]), ("8 across", runs[half])):
        rows += [(f"{words}: {what}", value, limit) for what, value, limit in penetration(run)]
        rows.append((f"{words}: widest cavity upstream, dp", cavity(run, 0.5, -1), 1))
    return rows


def measure_turned(runs):
    """The first run is not turned."""
    tables = [run.table("probes.csv") for run in runs]
    tips = [1e3 * float(np.hypot(p["tip_dx_m"], p["tip_dy_m"]).max()) for p in tables]
    pressures = [float(p["foot_p_Pa"].mean()) for p in tables]
    rows = [("not turned: largest tip displacement, mm", tips[0], None)]
    for angle, tip, pressure in zip((15, 30, 45), tips[1:], pressures[1:]):
        rows += [(f"{angle} degrees: tip displacement, % more", 100 * (tip / tips[0] - 1), 1),
                 (f"{angle} degrees: mean pressure, % more", 100 * (pressure / pressures[0] - 1),
                  1)]
    return rows


# --- the scenes ---
# Shipped cases and templates with walls or bodies, coarse and short: the end (s), other settings.
# Not the channel: it is too narrow for h = 2 dp.
SHIPPED = {"accelerated_tank": (0.75, []), "elastic_valve": (0.4, []),
           "gate": (0.2, ["dp=1.25 mm"]), "hydrostatic_plate": (0.1, []),
           "rolling_tank": (1.6, []), "sluice_gate": (0.5, ["dp=2 mm"]), "still_water": (1, []),
           "two_posts": (0.6, []), "wet_baffle": (0.6, ["dp=2 mm"]), "channel_flap": (0.5, []),
           "tank": (1, [])}


def standard_only(name):
    """Long runs, whose figures of the paper's scheme say nothing new: it fails in shorter ones."""
    return name.startswith(("shipped", "still water, flat", "still water, slope",
                            "still water, elastic"))


# (scene, what it is called, settings of each run, how they are measured)
RUNS = [
    ("fluid_rest_flat", "still water, flat bottom", [[]], single(rest_of(0.2))),
    ("fluid_rest", "still water, hump and post", [[]], single(rest_of(0.2))),
    *[("fluid_rest_slope", f"still water, slope of {angle} degrees",
       [[f"constants.angle={angle} deg"]], single(rest_of(0.2))) for angle in (15, 30, 45)],
    ("fluid_rest_floor", "still water, elastic floor", [[]], single(rest_of(0.2))),
    *[("fluid_wave", f"standing wave, H/dp = {ratio}", [[f"constants.ratio={ratio}"]],
       single(wave_of(judged)))
      for ratio, judged in ((10, ""), (20, "frequency"), (40, "frequency, loss"))],
    *[("fluid_travel", f"travelling wave, height 10 dp, alpha = {alpha}",
       [[f"constants.alpha={alpha}"]], single(travel_of(judged)))
      for alpha, judged in ((0, True), (0.01, False))],
    *[("fluid_impact", f"impact on a wall, H/dp = {ratio}", skins(f"constants.ratio={ratio}"),
       over(impact_of(limit))) for ratio, limit in ((40, None), (60, 0.05))],
    ("dam_break_impact", "impact on a wall, measured one, H/dp = 60", skins("end_time=1.25 s"),
     over(measure_later_peaks)),
    *[("fluid_gate_impact", f"dam break behind a gate, H/dp = {ratio}",
       skins(f"constants.ratio={ratio}")[:runs], over(measure_gate_impact))
      for ratio, runs in ((60, 5), (120, 2))],
    ("dam_break_front", "dam break, square column, a/dp = 40", [["constants.n2=1"]],
     single(measure_front)),
    ("fluid_front", "dam break, square column, free at once",
     [[f"constants.ratio={ratio}"] for ratio in (20, 40, 80)], measure_free_front),
    ("fluid_opening", "opening", [["constants.across=4"], ["constants.across=16"]],
     measure_opening),
    ("dam_break", "template dam_break", [[]], single(penetration)),
    ("baffle", "template baffle", skins() + skins("dp=2 mm"), measure_baffle),
    ("fluid_turned", "gate, turned with gravity",
     [[f"constants.angle={a} deg"] for a in (0, 15, 30, 45)], measure_turned),
    *[(case, f"shipped {case}, {end} s",
       [[f"end_time={end} s", f"output.snapshot_interval={end / 40} s", *settings]],
       single(penetration))
      for case, (end, settings) in SHIPPED.items()],
]


SCENES = {name: {scheme: (scene, [[f"scheme={scheme}", *rest] for rest in variants], measure)
                 for scheme in SCHEMES[standard_only(name):]}
          for scene, name, variants, measure in RUNS}


if __name__ == "__main__":
    run_tool(lambda: run_figures(__doc__, SCENES, REPORT, stops=True, asked="standard"))
