# SPDX-License-Identifier: MIT
"""Numbers of the validation that need snapshots or all rows of the ledger, which are not kept
(validation_kept.py). They are computed from a run with all its files, and read from a kept one."""

import functools
import json

import metrics
from sphfsi.draw_ledger import energy_shares, read_ledger
from common import BadFile, np, read_text
from sphfsi.snapshots import Snapshots

G = 9.81
FILE = "measured.json"
MEASURES = {}  # name: (function, beginnings of the names of the runs that it is for, its parts)


class Missing(Exception):
    """There is no finished run to report on; the text says how the run stands."""


class NotRun(Missing):
    """There are no files of a run; the text says what is wrong with its kept result, if there is
    one."""

    def __init__(self, wrong=""):
        super().__init__("not run" + (f"; what is kept of it {wrong}" if wrong else ""))


def whole_run(prefixes, *parts):
    """Decorates a function of a run that gives these parts: numbers, or lists of numbers."""
    def decorate(compute):
        name = compute.__name__

        @functools.wraps(compute)
        def measure(run):
            path = run.folder / FILE
            if not path.exists():
                return compute(run)
            found = json.loads(read_text(path)).get(name, {"missing": f"{name} is not kept"})
            if "missing" in found:
                raise Missing(found["missing"])
            return tuple(found[part] for part in parts)
        MEASURES[name] = (compute, tuple(prefixes), parts)
        return measure
    return decorate


def measure_all(run):
    """The measures of a run to keep, for JSON."""
    found = {}
    for name, (compute, prefixes, parts) in MEASURES.items():
        if not run.name.startswith(prefixes):
            continue
        try:
            found[name] = dict(zip(parts, compute(run)))
        except Missing as reason:
            found[name] = {"missing": str(reason)}
    return found


def number(run, name):
    """A constant of the effective case in SI units, or dp."""
    for kind, _, keys in run.case():
        if kind in ("constants", "top", "numerics") and name in keys:
            return float(keys[name].split()[0])
    raise BadFile(f"{run.folder / 'case.cfg'}: no constant {name}")


def snapshots(run):
    return Snapshots(run.folder / "fields.vtkhdf")


def water(file, step):
    """Positions of the water in a snapshot."""
    return file.load(step, "Points")[file.load(step, "kind") == 0][:, :2]


@whole_run([""], "play", "lost", "gain", "momentum_x", "momentum_y", "mass", "density")
def balance(run):
    """From the ledger: the available energy, the dissipated energy, the largest spurious gain;
    momentum and relative change of the mass at the end; the largest relative deviation of the
    density."""
    ledger = read_ledger(run)
    lost, mass = ledger["dissipated"], ledger["mass"]
    gain = np.max(np.maximum.accumulate(lost) - lost)
    return tuple(map(float, (
        energy_shares(ledger)[1], lost[-1], gain, ledger["momentum_x"][-1],
        ledger["momentum_y"][-1],
        mass[-1] / mass[0] - 1 if mass[0] else 0.0, np.nanmax(ledger["dens_extreme"]))))


@whole_run(["gate", "baffle", "sluice"], "closest", "median", "gaps")
def contact(run):
    """Between water and structure over the snapshots, in spacings: the closest distance, the median
    over the wetted surface, and the share of the surface with a gap."""
    file, dp = snapshots(run), run.spacing()
    closest, near, wetted, gaps = np.inf, [], 0, 0
    for step in range(1, len(file.times)):
        kind, x = file.load(step, "kind"), file.load(step, "Points")[:, :2]
        solid, fluid = x[kind == 2], x[kind == 0]
        start = solid - file.load(step, "displacement")[kind == 2][:, :2]
        low, high = start.min(axis=0), start.max(axis=0)
        skin = ((start - low < 0.6 * dp) | (high - start < 0.6 * dp)).any(axis=1)
        away = metrics.nearest(solid[skin], fluid, 3 * dp) / dp
        wet = away < 2.99
        if wet.any():
            closest = min(closest, away.min())
            near.append(away[away < 1.5])
            wetted, gaps = wetted + wet.sum(), gaps + (wet & (away > 1.5)).sum()
    if not wetted:
        raise Missing("no snapshot with water at the structure")
    return float(closest), float(np.median(np.concatenate(near))), float(gaps / wetted)


@whole_run(["gate", "baffle", "sluice"], "bodies", "walls", "share")
def pressed_in(run):
    """Water among the particles of one body or wall, which leave no sector of 120 degrees free
    within 1.2 spacings (some 0.8 spacings below the surface), or that hangs below the tank's floor
    at y = 0. The most at once in bodies, in walls; the share of the snapshots with any."""
    file, dp, bodies, walls, any_in = snapshots(run), run.spacing(), 0, 0, 0
    for step in range(len(file.times)):
        kind, body, x = (file.load(step, name) for name in ("kind", "body", "Points"))
        drops, found = x[kind == 0][:, :2], {1: 0, 2: 0}
        for which in found:
            for part in np.unique(body[kind == which]):
                here = x[(kind == which) & (body == part)][:, :2]
                found[which] += metrics.surrounded(drops, here, 1.2 * dp, 2 * np.pi / 3)
        found[1] += below_floor(drops, x[(kind == 1) & (x[:, 1] < 0)][:, :2], dp)
        bodies, walls = max(bodies, found[2]), max(walls, found[1])
        any_in += any(found.values())
    return bodies, walls, any_in / len(file.times)


def below_floor(drops, floor, dp):
    """How many hang below it, the nearest of its particles above them."""
    a, b = metrics.close_pairs(drops, floor, 1.5 * dp)
    away, up = np.hypot(*(floor[b] - drops[a]).T), floor[b, 1] - drops[a, 1]
    order = np.lexsort((away, a))
    first = np.flatnonzero(np.r_[True, np.diff(a[order]) > 0])[:len(a)]
    return int((up[order][first] > 0.55 * dp).sum())


@whole_run(["baffle"], "depth", "speed")
def bore(run):
    """Depth and speed of the bore between the plate and the foundation, from the surface in the
    snapshots: the front is where it stands halfway between the water ahead and Stoker's bore."""
    start, still = 0.503, 0.03
    least = 0.5 * (still + metrics.wet_bed_bore(0.15, still)[0])
    file, dp = snapshots(run), run.spacing()
    at = np.arange(start + 0.02, start + 0.29, 2 * dp)
    front, depths = [], []
    for step, time in enumerate(file.times):
        x = water(file, step)
        height = metrics.surface_height(x[x[:, 1] < 0.2], dp, at)
        ahead = np.flatnonzero(height > least)
        if len(ahead) and at[ahead[-1]] < at[-1] - 0.02 and ahead[-1] > 3:
            front.append((time, at[ahead[-1]]))
            behind = height[(at > at[ahead[-1]] - 0.12) & (at < at[ahead[-1]] - 0.03)]
            if len(behind) > 4:
                depths.append(float(np.median(behind)))
    if len(front) < 3 or not depths:
        raise Missing("too few snapshots of the bore")
    time, way = np.array(front).T
    return float(np.mean(depths)), float(np.polyfit(time, way, 1)[0])


@whole_run(["sluice"], "speed")
def front_speed(run):
    """Speed of the foremost water over most of the tank behind the plate."""
    start, end = 0.55, 1.45
    file = snapshots(run)
    way = np.array([water(file, step)[:, 0].max() for step in range(len(file.times))])
    k = np.flatnonzero((way > start) & (way < end))
    if len(k) < 2:
        raise Missing("too few snapshots of the front")
    return (float((way[k[-1]] - way[k[0]]) / (file.times[k[-1]] - file.times[k[0]])),)


@whole_run(["still"], "error", "energy", "slope")
def rest(run):
    """Still water at the end: L2 error of the pressure over that of rho g (H - y), kinetic over
    potential energy, and the slope of a straight line through the pressures over rho g."""
    height, file = number(run, "H"), snapshots(run)
    step = len(file.times) - 1
    here = file.load(step, "kind") == 0
    x, p, v = (file.load(step, name)[here].astype(float)
               for name in ("Points", "pressure", "velocity"))
    exact = 1000 * G * (height - x[:, 1])
    slope = np.polyfit(height - x[:, 1], p, 1)[0] / (1000 * G)
    energy = float((0.5 * (v ** 2).sum(axis=1)).sum() / (G * x[:, 1]).sum())
    return float(np.sqrt(np.mean((p - exact) ** 2) / np.mean(exact ** 2))), energy, float(slope)


@whole_run(["front"], "time", "way")
def front_of(run):
    """Time and place of the foremost water in the snapshots; drops of fewer than four do not
    count."""
    file, dp = snapshots(run), run.spacing()
    way = []
    for step in range(len(file.times)):
        x = water(file, step)
        x = x[np.argsort(-x[:, 0])]
        away = np.hypot(*(x[:60, None] - x[None, :200]).transpose(2, 0, 1))
        company = (away < 2.1 * dp).sum(axis=1) > 3
        way.append(float(x[int(np.argmax(company)), 0] + dp / 2))
    return file.times.tolist(), way


@whole_run(["block"], "change")
def turning(run):
    """Relative change of the angular momentum from the first to the last snapshot."""
    file = snapshots(run)

    def momentum(step):
        x, v = file.load(step, "Points"), file.load(step, "velocity").astype(float)
        return float((x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]).sum())
    return (momentum(len(file.times) - 1) / momentum(0) - 1,)
