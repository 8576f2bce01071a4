# SPDX-License-Identifier: MIT
"""What a run of the study gives and how far that is off: one function for each kind of error.

Each returns the value that was found (None where it is a whole curve) and its relative error.
"""

import metrics
from common import BadFile, Run, np, read_table
from sphfsi.snapshots import KINDS


def column(run, name):
    """Times and values of a column of the probes or, if they have none of that name, of the
    ledger."""
    for file in ("probes.csv", "ledger.csv"):
        if (Run(run).folder / file).exists():
            table = Run(run).table(file)
            if name in table:
                return table["time_s"], table[name]
    raise BadFile(f"{run}: neither probes.csv nor ledger.csv has a column {name}")


def window(time, value, error):
    keep = (time >= error.get("from", -np.inf)) & (time <= error.get("until", np.inf))
    if not keep.any():
        raise BadFile("the run has no row in the window")
    return time[keep], value[keep]


def period(error, run, _finest, _root):
    time, value = window(*column(run, error["column"]), error)
    crossings = metrics.crossings(time, value - error.get("middle", 0))
    if len(crossings) < 3:
        raise BadFile("fewer than three zero crossings: no period")
    found = 2 * (crossings[-1] - crossings[0]) / (len(crossings) - 1)
    return found, abs(found / error["reference"] - 1)


def damped(error, run):
    """Frequency and decay of the damped sine that fits best. Noise disturbs it less than zero
    crossings. An energy oscillates and decays twice as fast as the amplitude, about a mean that
    decays with it."""
    time, value = window(*column(run, error["column"]), error)
    times = 2 if error.get("energy") else 1
    frequency, decay = metrics.damped_sine(time, value, times * 2 * np.pi / error["reference"],
                                           times == 2)
    return frequency / times, decay / times


def damped_period(error, run, _finest, _root):
    found = 2 * np.pi / damped(error, run)[0]
    return found, abs(found / error["reference"] - 1)


def damped_loss(error, run, _finest, _root):
    """Part of its amplitude that an oscillation without friction loses in a period."""
    found = 1 - np.exp(-damped(error, run)[1] * error["reference"])
    return found, found


def phase(error, run, _finest, _root):
    """Part of a period by which the last zero crossing comes early or late."""
    time, value = window(*column(run, error["column"]), error)
    crossings = metrics.crossings(time, value - error.get("middle", 0))
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


def noise_about_mean(error, run, _finest, _root):
    """Standard deviation from the running mean over `window` seconds."""
    time, value = column(run, error["column"])
    n = 1 + 2 * round(error["window"] / (time[1] - time[0]) / 2)
    mean = metrics.running_mean(value, n)
    _, rest = window(time[n // 2:n // 2 + len(mean)], value[n // 2:n // 2 + len(mean)] - mean,
                     error)
    return rest.std(), rest.std() / error["scale"]


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
    shots = metrics.snapshots(Run(run))
    step = len(shots.times) - 1
    fluid = shots.load(step, "kind") == KINDS["fluid"]
    y, p = shots.load(step, "Points")[fluid, 1], shots.load(step, "pressure")[fluid]
    weight = error["density"] * error["gravity"]
    depth = error["surface"] - y
    return None, np.sqrt(np.mean((p - weight * depth)**2)) / (weight * depth.max())


def front(error, run, _finest, root):
    """Position of the foremost particle against measured rows of time and position."""
    time, place = metrics.foremost(Run(run))
    table, _ = read_table(root / error["file"])
    when, wanted = table.values()
    when, wanted = when * error.get("time_unit", 1), wanted * error.get("length_unit", 1)
    keep = when <= time[-1]
    if not keep.any():
        raise BadFile(f"{error['file']} has no row in the time of the run")
    off = np.interp(when[keep], time, place) - wanted[keep]
    return place[-1], np.sqrt(np.mean(off**2)) / wanted[keep].max()


def front_finest(_error, run, finest, _root):
    (time, place), (when, wanted) = (metrics.foremost(Run(of)) for of in (run, finest))
    off = np.interp(when, time, place) - wanted
    return place[-1], np.sqrt(np.mean(off**2)) / wanted.max()


def tip(error, run, _finest, _root):
    """Mean place of a cantilever's end under a dead load against (x, y) of a theory, in lengths."""
    name, length = error["probe"], error["length"]
    mean = [window(*column(run, f"{name}_{axis}_m"), error)[1].mean() / length
            for axis in ("dx", "dy")]
    return mean[1], np.hypot(mean[0] + 1 - error["x"], mean[1] - error["y"])


def measure(error, run, finest, root):
    if error["kind"].endswith("finest") and finest is None:
        raise BadFile("no base run has finished to measure it against")
    value, off = globals()[error["kind"]](error, run, finest, root)
    number = lambda x: None if x is None or not np.isfinite(x) else float(x)
    return number(value), number(off)
