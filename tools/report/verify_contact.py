#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs small scenes of contact at two or three resolutions and says how far each is off (make
verify-contact, some minutes on one core). The scenes are cases/verify/contact_*.cfg and two others.
A figure is (words, value, limit or None); it is kept if |value| <= limit. run.constants has what
the tool has set. Figures are stored in docs/results/contact_verification.json."""
import math

from common import OUT, np, run_figures, run_tool, single
from metrics import reference, snapshots
from sphfsi.snapshots import KINDS

REPORT = OUT / "contact_verification.md"
G = 9.81
DISC = {"radius": 0.05, "young": 1e6, "poisson": 0.3}


def speed_after(run, column, count=100):
    """Slope of the last rows."""
    table = run.table()
    return float(np.polyfit(table["time_s"][-count:], table[column][-count:], 1)[0])


# --- pressure ---
def press_of(stiffer, limit):
    """What floor and joint add to the compression of the blocks, as the height of a layer of the
    softer block."""
    def measure(run):
        table, dp, soft = run.table(), run.dp, min(1, stiffer)
        strain = -1e-4 * (1 - 0.3 ** 2)
        lower, upper = (float(table[f"{body}_dy_m"][-1]) / strain for body in ("lower", "upper"))
        at_floor, at_joint = lower - 0.05, upper - lower - 0.05 - 0.05 / stiffer
        return [("layer that the floor adds, dp", at_floor / dp, limit),
                ("layer that the joint adds, dp", at_joint * soft / dp, limit)]
    return measure


# --- impact ---
def disc_of(speed, limits):
    def measure(run):
        """The disc touches first a spacing below its start."""
        back, way, until = next(row[1:] for row in reference("contact_disc.csv").T if
                                row[0] == speed)
        y, ledger = run.table()["disc_cy_m"], run.table("ledger.csv")
        touching = ledger["time_s"][ledger["contact_J_per_m"] > 0]
        found = (speed_after(run, "disc_cy_m") / speed, float(y[0] - y.min()) - run.dp,
                 float(touching[-1]) - run.dp / speed)
        rows = [(f"{words}, % more than {wanted:.4g}", 100 * (value / wanted - 1), limit)
                for words, value, wanted, limit in zip(
                    ("restitution", "way of the centre", "time in contact"), found,
                    (back, way, until), limits)]
        balance = abs(ledger["dissipated_J_per_m"]).max() / ledger["kinetic_J_per_m"][0]
        return rows + [("energy that does not close, % of the kinetic", 100 * float(balance), 0.5)]
    return measure


def measure_bars(run):
    apart = (speed_after(run, "long_cx_m") - speed_after(run, "short_cx_m")) / run.constants["v"]
    return [("restitution less 1/2", apart - 0.5, 0.02)]


# --- line contact ---
def disc_compression(load):
    """How much two rigid plates approach each other under a load per depth (Johnson 1985, Sec.
    5.6)."""
    plane, radius = DISC["young"] / (1 - DISC["poisson"] ** 2), DISC["radius"]
    half = math.sqrt(4 * load * radius / (math.pi * plane))
    return 2 * load / (math.pi * plane) * (2 * math.log(4 * radius / half) - 1)


def measure_line(runs):
    """Loads at two ways of the plate. The lattice moves the whole curve by a part of dp; its slope
    does not know."""
    ways = [run.constants["D"] for run in runs]
    exact = [disc_compression(-float(run.table()["plate_fy_N_per_m"][-10:].mean()))
             for run in runs]
    return [("disc too large by, dp a contact", float(exact[1] - ways[1]) / 2 / runs[0].dp, 0.25),
            ("indentation between two loads, % too large",
             100 * ((ways[1] - ways[0]) / (exact[1] - exact[0]) - 1), 5)]


# --- friction ---
def incline(run):
    slope, friction = run.constants["slope"], run.constants["mu"]
    norm = G / math.sqrt(1 + slope ** 2)
    table = run.table()
    start = run.constants["settle"] + 0.5 * run.constants["rise"]
    return norm, slope, friction, table["time_s"], table["block_cx_m"] - table["block_cx_m"][0], \
        start


def slide_of(limit):
    def measure(run):
        """Driven for `push` with (slope - mu) of the normal gravity, then braked with mu of it."""
        norm, slope, friction, t, x, start = incline(run)
        push = run.constants["push"]
        speed = (slope - friction) * norm * push
        way, time = speed ** 2 / (2 * friction * norm), speed / (friction * norm)
        pushed = float(np.interp(start + push, t, x))
        rest = t[x < x[-1] - 1e-5][-1]
        return [("way until it rests, % more than v^2/(2 mu g)",
                 100 * (float(x[-1] - pushed) / way - 1), limit),
                ("time until it rests, % more than v/(mu g)",
                 100 * (float(rest - start - push) / time - 1), limit)]
    return measure


def slope_of(limit):
    def measure(run):
        norm, slope, friction, t, x, start = incline(run)
        way = 0.5 * (slope - friction) * norm * (t[-1] - start) ** 2
        return [("way down, % more than t^2/2 g (sin a - mu cos a)", 100 * (float(x[-1]) / way - 1),
                 limit)]
    return measure


def held_of(limit):
    def measure(run):
        """Ways in spacings, of the last 0.5 s and before."""
        _, _, _, t, x, _ = incline(run)
        late = t > t[-1] - 0.5
        return [("way down before 1 s, dp", float(x[~late][-1]) / run.dp, None),
                ("way down from 1 to 1.5 s, dp", float(x[-1] - x[~late][-1]) / run.dp, limit)]
    return measure


def topple_of(falls, body="block", limit=0.3):
    def measure(run):
        angle = float(abs(run.table()[f"{body}_angle_rad"]).max())
        return [("falls, as statics says" if falls else "stands, as statics says (1: falls)",
                 int((angle > limit) != falls), 0)]
    return measure


# --- a stack ---
def gaps(run, step):
    """Mean distance between the surfaces of the stack at each joint, in spacings; 1 is touch."""
    with snapshots(run) as shots:
        x, body = shots.load(step, "Points")[:, :2], shots.load(step, "body")
        solid = shots.load(step, "kind") == KINDS["solid"]
        first = shots.load(0, "Points")[:, :2]
    rows = []
    for k in range(3):
        mine = solid & (body == k)
        for side in (first[mine, 1].min(), first[mine, 1].max()):
            rows.append(x[mine & (abs(first[:, 1] - side) < 1e-6), 1].mean())
    return [(above - below) / run.dp for below,
            above in zip([-0.5 * run.dp, *rows[1::2]], rows[0::2])]


def measure_stack(run):
    """Pressures of the weight above each joint over E; statics."""
    table = run.table()
    half = len(table["time_s"]) // 2
    moved = max(float(np.hypot(table[f"{b}_cx_m"][half:] - table[f"{b}_cx_m"][half],
                               table[f"{b}_cy_m"][half:] - table[f"{b}_cy_m"][half]).max())
                for b in "abc")
    overlap = [1 - gap for gap in gaps(run, -1)]
    return [("moves from 5 to 10 s, dp", moved / run.dp, 1e-3),
            ("largest overlap at rest, dp", max(overlap), 0.01)]


# --- a strip that folds ---
def measure_fold(run):
    thick, drop = 0.02, 0.05
    places, heights = reference("contact_fold.csv")
    with snapshots(run) as shots:
        first, x = shots.load(0, "Points")[:, :2], shots.load(-1, "Points")[:, :2]
    arm = (first[:, 1] > 0) & (first[:, 0] > 0)
    off = []
    for place in np.unique(np.round(first[arm, 0], 7)):
        row = arm & (abs(first[:, 0] - place) < 1e-6)
        off.append(x[row, 1].mean() - 0.5 * thick - np.interp(place, places, heights))
    off = 100 * np.array(off) / drop
    return [("axis from the beam's, RMS, % of the gap", float(np.sqrt((off ** 2).mean())), 0.5),
            ("the same, largest", float(abs(off).max()), 1)]


def measure_beams(run):
    table = run.table()
    return [("deflection of the lower beam, % more than half of the way",
             100 * (float(-table["lower_dy_m"][-20:].mean()) / 0.00625 - 1), 1)]


# --- what must not pass ---
def particles(shots, step):
    x, kind, body = shots.load(step, "Points")[:, :2], shots.load(step, "kind"), shots.load(step,
                                                                                            "body")
    return x, kind == KINDS["wall"], kind == KINDS["solid"], body


def outline(x, first):
    """Of a lattice of columns: the outermost particles in order, in their present places."""
    left, right = (np.flatnonzero(abs(first[:, 0] - side) < 1e-6)
                   for side in (first[:, 0].min(), first[:, 0].max()))
    left, right = left[np.argsort(first[left, 1])], right[np.argsort(-first[right, 1])]
    return x[np.concatenate([left, right])]


def inside(points, polygon):
    """How many points lie in the polygon: an odd number of its edges is to the right of each."""
    ax, ay = polygon.T
    bx, by = np.roll(polygon, -1, axis=0).T
    px, py = points[:, :1], points[:, 1:]
    crosses = (ay > py) != (by > py)
    at = ax + (py - ay) * (bx - ax) / np.where(by == ay, 1, by - ay)
    return int((np.count_nonzero(crosses & (at > px), axis=1) % 2 == 1).sum())


def measure_bullet(run):
    """Particles of the body between the outermost ones of the target, summed over 200 snapshots."""
    passed = 0
    with snapshots(run) as shots:
        first, wall, solid, body = particles(shots, 0)
        for step in range(len(shots.times)):
            x = shots.load(step, "Points")[:, :2]
            target = solid & (body == 0) if run.constants["held"] else wall
            passed += inside(x[solid & (body == 1)], outline(x[target], first[target]))
    return [("particles that have passed", passed, 0),
            ("1: the run stopped", int(run.stopped), None)]


def measure_driven(run):
    """The ram moves by 60 of the 115 mm between itself and the floor. The blocks begin 5 mm
    apart."""
    table = run.table()
    apart = 0.005 + table["U_dy_m"] - table["L_dy_m"]
    return [("largest overlap of the blocks, dp", -float(apart.min()) / run.dp, 0.5),
            ("1: the run stopped", int(run.stopped), 0)]


# --- the scenes ---
def scene(case, key, levels, measure, *more, **constants):
    """`key` is the constant that is varied, with its unit in words; `more`: constants of runs of a
    level that are measured together."""
    def settings(level, own):
        words = {**constants, **own, key[0]: level}
        return [f"{'' if word == 'dp' else 'constants.'}{word}={value!r}"
                for word, value in words.items()]
    return {f"{level:g} {key[1]}": (case, [settings(level, own) for own in more or [{}]],
                                    measure if more else single(measure)) for level in levels}


def friction(measure, levels, **constants):
    return scene("contact_slide", ("ratio", "over the height"), levels, measure,
                 **{"mu": 0.3, "settle": 0.2, "rise": 1e-3, **constants})


def press(limit, stiffer=1.0, **constants):
    return scene("contact_press", ("ratio", "over the height"), (10, 20),
                 press_of(stiffer, limit), stiffer=stiffer, **constants)


def disc(speed, limits, levels, **constants):
    return scene("contact_disc", ("ratio", "over the radius"), levels,
                 disc_of(speed, limits), v=speed, **constants)


def bullet(**constants):
    return scene("contact_bullet", ("E", "Pa, modulus"), (1e6, 2e7, 5e9), measure_bullet,
                 **{"v": 200, "held": 0, "corner": 0, "top": 0.1, **constants})


SCENES = {
    "equal blocks on a floor": press(0.2),
    "upper block with a spacing of 2/3": press(0.2, finer=1.5),
    "upper block ten times as stiff": press(0.2, stiffer=10.0),
    "upper block a tenth as stiff": press(0.2, stiffer=0.1),
    "upper block with a lattice turned by 0.5": press(0.5, turn=0.5),
    "disc on a wall, 3 m/s": disc(3, (1, 3, 5), (10, 20, 40), two=0),
    "disc on a wall, 1 m/s": disc(1, (1, 5, 10), (20, 40), two=0),
    "disc on a disc, 3 m/s each": disc(3, (1, 3, 5), (10, 20, 40), two=1),
    "bar on a bar twice as long":
        scene("contact_bars", ("ratio", "over the width"), (4, 8, 16), measure_bars, v=0.2),
    **{f"disc between plates, lattice turned by {turn}":
       scene("contact_line", ("ratio", "over the radius"), (20, 40, 80), measure_line,
             {"D": 1.2e-3}, {"D": 2.4e-3}, turn=turn) for turn in (0, 0.3, 0.6)},
    "block that slides to rest": friction(slide_of(2), (4, 8), slope=0.6, push=0.2),
    "block on a slope of 0.6": friction(slope_of(1), (4, 8), slope=0.6, push=10),
    "block on a slope of 0.28 that turns in 0.3 s":
        friction(held_of(0.01), (4, 8, 16), slope=0.28, push=10, rise=0.3),
    "block on a slope of 0.25 that turns in 1 ms":
        friction(held_of(0.01), (4, 8, 16), slope=0.25, push=10),
    "block on a slope of 0.28 that turns in 1 ms":
        friction(held_of(None), (4, 8, 16), slope=0.28, push=10),
    **{f"block as wide as high on a slope of {slope}, friction 1.5":
       friction(topple_of(slope > 1), (10, 20), slope=slope, mu=1.5, push=10, rise=0.3, aspect=1)
       for slope in (0.85, 1.05)},
    "three blocks on a floor, 10 s":
        scene("contact_stack", ("ratio", "over the height"), (5, 10), measure_stack, over=-0.1),
    **{f"three blocks, the upper overhangs by {over} of its length":
       scene("contact_stack", ("ratio", "over the height"), (5, 10),
             topple_of(over > 0.5, "c", 0.2), over=over) for over in (0.4, 0.55)},
    "strip that folds onto itself":
        scene("contact_fold", ("ratio", "through the thickness"), (4, 8), measure_fold),
    "beam pressed onto a beam":
        scene("beam_on_beam", ("across", "through the thickness"), (4, 8), measure_beams),
    "200 m/s at a wall": bullet(), "200 m/s at a strip of three": bullet(held=1),
    "200 m/s, corner first, at a wall": bullet(corner=1),
    "200 m/s, corner first, at a strip of three": bullet(corner=1, held=1),
    "200 m/s, corner on corner": bullet(corner=1, held=1, top=0),
    "ram presses two blocks to half their height":
        scene("pressed", ("dp", "m, spacing"), (5e-3, 2.5e-3), measure_driven),
}


if __name__ == "__main__":
    run_tool(lambda: run_figures(__doc__, SCENES, REPORT, stops=True))
