# SPDX-License-Identifier: MIT
"""What a run of the study gives and how far that is off: one function for each kind of error.

Each returns the value that was found (None where it is a whole curve) and its relative error.
"""

from runfiles import BadFile, Run, np, read_table
from snapshots import KINDS as PARTICLES
from snapshots import Snapshots

# kind: keys that its [[case.NAME.error]] must have
KINDS = {
    "period": ("name", "column", "reference"),
    "fitted_period": ("name", "column", "reference"),
    "phase": ("name", "column", "reference"),
    "settled": ("name", "column", "reference", "from"),
    "noise": ("name", "column", "from"),
    "final": ("name", "column", "reference"),
    "peak_finest": ("name", "column"),
    "against_file": ("name", "column", "file"),
    "against_finest": ("name", "column"),
    "hydrostatic": ("name", "density", "gravity", "surface"),
    "decay": ("name", "column", "rate"),
    "loss": ("name", "column", "period"),
    "front": ("name", "file"),
}


def column(run, name):
    table = Run(run).table("probes.csv")
    if name not in table:
        raise BadFile(f"{run}/probes.csv: no column {name}")
    return table["time_s"], table[name]


def window(time, value, error):
    keep = (time >= error.get("from", -np.inf)) & (time <= error.get("until", np.inf))
    if not keep.any():
        raise BadFile("the run has no row in the window")
    return time[keep], value[keep]


def zeros(time, value):
    turns = np.flatnonzero(value[1:-1] * value[2:] < 0) + 1
    return time[turns] + (time[turns + 1] - time[turns]) * value[turns] / (value[turns] - value[turns + 1])


def period(error, run, _finest, _root):
    time, value = window(*column(run, error["column"]), error)
    crossings = zeros(time, value - error.get("middle", 0))
    if len(crossings) < 3:
        raise BadFile("fewer than three zero crossings: no period")
    found = 2 * (crossings[-1] - crossings[0]) / (len(crossings) - 1)
    return found, abs(found / error["reference"] - 1)


def fitted_period(error, run, _finest, _root):
    """Period of the sine that explains most of the curve, within half and twice the reference: unlike
    zero crossings it does not mind the acoustic noise of a pressure."""
    time, value = window(*column(run, error["column"]), error)
    best, found = np.inf, np.nan
    for trial in error["reference"] * np.geomspace(0.5, 2, 4001):
        angle = 2 * np.pi * time / trial
        basis = np.stack([np.sin(angle), np.cos(angle), np.ones_like(angle)], axis=1)
        solution = np.linalg.lstsq(basis, value, rcond=None)[0]
        left = np.sum((basis @ solution - value)**2)
        if left < best:
            best, found = left, trial
    return found, abs(found / error["reference"] - 1)


def phase(error, run, _finest, _root):
    """Part of a period by which the last zero crossing comes early or late."""
    time, value = window(*column(run, error["column"]), error)
    crossings = zeros(time, value - error.get("middle", 0))
    if len(crossings) == 0:
        raise BadFile("no zero crossing: no phase")
    turns = crossings[-1] / error["reference"]
    return turns, abs(turns - 0.5 * round(2 * turns))


def settled(error, run, _finest, _root):
    _, value = window(*column(run, error["column"]), error)
    return value.mean(), abs(value.mean() / error["reference"] - 1)


def noise(error, run, _finest, _root):
    _, value = window(*column(run, error["column"]), error)
    return value.std(), value.std() / abs(error.get("scale", value.mean()))


def final(error, run, _finest, _root):
    _, value = column(run, error["column"])
    return value[-1], abs(value[-1] / error["reference"] - 1)


def largest(error, run):
    _, value = window(*column(run, error["column"]), error)
    return value[np.argmax(np.abs(value))]


def peak_finest(error, run, finest, _root):
    found = largest(error, run)
    return found, None if finest == run else abs(found / largest(error, finest) - 1)


def against_file(error, run, _finest, root):
    time, value = column(run, error["column"])
    table, _ = read_table(root / error["file"])
    when, wanted = table.values()
    keep = (when >= time[0]) & (when <= time[-1])
    if not keep.any():
        raise BadFile(f"{error['file']} has no row in the time of the run")
    off = np.interp(when[keep], time, value) - wanted[keep]
    return None, np.sqrt(np.mean(off**2)) / np.max(np.abs(wanted))


def against_finest(error, run, finest, _root):
    time, value = window(*column(run, error["column"]), error)
    when, wanted = window(*column(finest, error["column"]), error)
    off = np.interp(when, time, value) - wanted
    return None, np.sqrt(np.mean(off**2)) / np.max(np.abs(wanted))


def hydrostatic(error, run, _finest, _root):
    """L2 norm over the fluid of p - rho g (surface - y), by rho g times the largest depth."""
    shots = Snapshots(Run(run).folder / "fields.vtkhdf")
    step = len(shots.times) - 1
    fluid = shots.load(step, "kind") == PARTICLES["fluid"]
    y, p = shots.load(step, "Points")[fluid, 1], shots.load(step, "pressure")[fluid]
    weight = error["density"] * error["gravity"]
    depth = error["surface"] - y
    return None, np.sqrt(np.mean((p - weight * depth)**2)) / (weight * depth.max())


def decay_rate(error, run):
    """Rate at which the turns of an oscillation shrink."""
    time, value = window(*column(run, error["column"]), error)
    value = value - error.get("middle", 0)
    turns = np.flatnonzero((value[1:-1] - value[:-2]) * (value[2:] - value[1:-1]) < 0) + 1
    if len(turns) < 3:
        raise BadFile("fewer than three turns: no decay")
    return -np.polyfit(time[turns], np.log(np.abs(value[turns])), 1)[0]


def decay(error, run, _finest, _root):
    found = decay_rate(error, run)
    return found, abs(found / error["rate"] - 1)


def loss(error, run, _finest, _root):
    """Part of its amplitude that an oscillation loses, or gains, in a period."""
    found = 1 - np.exp(-decay_rate(error, run) * error["period"])
    return found, abs(found)


def front(error, run, _finest, root):
    """Way of the water's foremost particle against measured rows of time and place."""
    shots = Snapshots(Run(run).folder / "fields.vtkhdf")
    places = []
    for step in range(len(shots.times)):
        fluid = shots.load(step, "kind") == PARTICLES["fluid"]
        places.append(shots.load(step, "Points")[fluid, 0].max())
    table, _ = read_table(root / error["file"])
    when, wanted = table.values()
    when, wanted = when * error.get("time_unit", 1), wanted * error.get("length_unit", 1)
    keep = when <= shots.times[-1]
    if not keep.any():
        raise BadFile(f"{error['file']} has no row in the time of the run")
    off = np.interp(when[keep], shots.times, places) - wanted[keep]
    return places[-1], np.sqrt(np.mean(off**2)) / wanted[keep].max()


def measure(error, run, finest, root):
    if error["kind"].endswith("finest") and finest is None:
        raise BadFile("no base run has finished to measure it against")
    value, off = globals()[error["kind"]](error, run, finest, root)
    number = lambda x: None if x is None or not np.isfinite(x) else float(x)
    return number(value), number(off)
