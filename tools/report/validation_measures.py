# SPDX-License-Identifier: MIT
"""What the validation measures on ledgers and snapshots of a run; each function gives a dict."""

import metrics
from common import BadFile, np
from metrics import snapshots
from sphfsi.draw_ledger import energy_shares, read_ledger


def balance(run):
    """From the ledger: the available energy, the dissipated energy, the largest spurious gain;
    momentum and relative change of the mass at the end; the largest relative deviation of the
    density."""
    ledger = read_ledger(run)
    lost, mass = ledger["dissipated"], ledger["mass"]
    return {"play": energy_shares(ledger)[1], "lost": lost[-1],
            "gain": np.max(np.maximum.accumulate(lost) - lost),
            "momentum_x": ledger["momentum_x"][-1], "momentum_y": ledger["momentum_y"][-1],
            "mass": mass[-1] / mass[0] - 1 if mass[0] else 0.0,
            "density": np.nanmax(ledger["dens_extreme"])}


def interface(run):
    return contact(run) | pressed_in(run)


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
        raise BadFile(f"{run.folder}: no snapshot with water at the structure")
    return {"closest": closest, "median": np.median(np.concatenate(near)), "gaps": gaps / wetted}


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
    return {"pressed_bodies": bodies, "pressed_walls": walls,
            "pressed_share": any_in / len(file.times)}


def below_floor(drops, floor, dp):
    """How many hang below it, the nearest of its particles above them."""
    a, b = metrics.close_pairs(drops, floor, 1.5 * dp)
    away, up = np.hypot(*(floor[b] - drops[a]).T), floor[b, 1] - drops[a, 1]
    order = np.lexsort((away, a))
    first = np.flatnonzero(np.r_[True, np.diff(a[order]) > 0])[:len(a)]
    return int((up[order][first] > 0.55 * dp).sum())


def bore(run):
    """Depth and speed of the bore between the plate and the foundation, from the surface in the
    snapshots: the front is where it stands halfway between the water ahead and Stoker's bore."""
    start, still = 0.503, 0.03
    least = 0.5 * (still + metrics.wet_bed_bore(0.15, still)[0])
    dp, front, depths = run.spacing(), [], []
    at = np.arange(start + 0.02, start + 0.29, 2 * dp)
    for time, x, _ in metrics.water(run):
        height = metrics.surface_height(x[x[:, 1] < 0.2], dp, at)
        ahead = np.flatnonzero(height > least)
        if len(ahead) and at[ahead[-1]] < at[-1] - 0.02 and ahead[-1] > 3:
            front.append((time, at[ahead[-1]]))
            behind = height[(at > at[ahead[-1]] - 0.12) & (at < at[ahead[-1]] - 0.03)]
            if len(behind) > 4:
                depths.append(float(np.median(behind)))
    if len(front) < 3 or not depths:
        raise BadFile(f"{run.folder}: too few snapshots of the bore")
    time, way = np.array(front).T
    return {"depth": np.mean(depths), "speed": np.polyfit(time, way, 1)[0]}


def front_speed(run):
    """Speed of the foremost water over most of the tank behind the plate."""
    start, end = 0.55, 1.45
    times, way = metrics.foremost(run)
    k = np.flatnonzero((way > start) & (way < end))
    if len(k) < 2:
        raise BadFile(f"{run.folder}: too few snapshots of the front")
    return {"speed": (way[k[-1]] - way[k[0]]) / (times[k[-1]] - times[k[0]])}
