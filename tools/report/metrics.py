# SPDX-License-Identifier: MIT
"""What is measured on the curves of runs, and the exact solutions they are held against."""

import math

from common import ROOT, BadFile, np, read_table
from sphfsi.snapshots import KINDS, Snapshots


def reference(name):
    """Columns of a table of cases/reference, in order."""
    return np.array(list(read_table(ROOT / "cases" / "reference" / name)[0].values()))


def snapshots(run):
    return Snapshots(run.folder / "fields.vtkhdf")


def water(run):
    """Time, positions and velocities of the fluid in each snapshot of a run."""
    shots = snapshots(run)
    for step, time in enumerate(shots.times):
        fluid = shots.load(step, "kind") == KINDS["fluid"]
        yield (time, shots.load(step, "Points")[fluid, :2], shots.load(step, "velocity")[fluid, :2])


def foremost(run):
    """Times of the snapshots, and the largest x of the fluid in each."""
    return np.array([(time, x[:, 0].max()) for time, x, _ in water(run)]).T


def order(sizes, errors):
    """Of convergence, between the last two of more and more particles."""
    return math.log(errors[-2] / errors[-1]) / math.log(sizes[-1] / sizes[-2])


def crossings(time, value):
    """Times at which a sampled curve changes sign; a zero at its start is none."""
    k = np.flatnonzero(value[1:-1] * value[2:] < 0) + 1
    return time[k] + (time[k + 1] - time[k]) * value[k] / (value[k] - value[k + 1])


def oscillation(time, value, period):
    """Of a free oscillation about zero that starts there: first period, mean period, drift of the
    phase at the last crossing against `period` (degrees, positive: late), and share of the
    amplitude that is lost in a second."""
    zeros = crossings(time, value)
    if len(zeros) < 2:
        raise BadFile("the curve is shorter than a period")
    ends = np.concatenate([[time[0]], zeros])
    tops = [np.abs(value[(time >= a) & (time <= b)]).max() for a, b in zip(ends, ends[1:])]
    middle = 0.5 * (ends[1:] + ends[:-1])
    slope = np.polyfit(middle, np.log(tops), 1)[0] if len(tops) > 2 else math.nan
    return {"first": zeros[1] - time[0], "mean": 2 * (zeros[-1] - time[0]) / len(zeros),
            "drift": 360 * ((zeros[-1] - time[0]) / period - len(zeros) / 2),
            "amplitude": np.abs(value).max(), "late": tops[-1], "loss": 1 - math.exp(slope)}


def damped_sine(time, value, omega, mean=False):
    """Frequency and decay of C exp(-g t) cos(w t + phi) that fits best, near `omega`; with `mean`
    of exp(-g t) (C cos(w t + phi) + D)."""
    def misfit(w, g):
        fade = np.exp(-g * time)
        base = np.stack([fade * np.cos(w * time), fade * np.sin(w * time)] + [fade] * mean, axis=1)
        coefficients = np.linalg.lstsq(base, value, rcond=None)[0]
        return float(np.sum((base @ coefficients - value) ** 2))

    best, width, decay = (omega, 0.0), 0.15 * omega, 0.5
    for _ in range(8):  # a grid that closes in
        grid = [(best[0] + width * a, max(0.0, best[1] + decay * b))
                for a in np.linspace(-1, 1, 13) for b in np.linspace(-1, 1, 9)]
        best = min(grid, key=lambda pair: misfit(*pair))
        width, decay = width / 3, decay / 3
    return best


def strongest(time, value, least=0.0):
    """Frequency (Hz) of the highest peak of the spectrum above `least`, the mean taken out."""
    value = (value - value.mean()) * np.hanning(len(value))
    step = (time[-1] - time[0]) / (len(time) - 1)
    spectrum = np.abs(np.fft.rfft(value, 8 * len(value)))
    frequency = np.fft.rfftfreq(8 * len(value), step)
    return float(frequency[np.argmax(np.where(frequency >= least, spectrum, 0))])


def running_mean(value, n):
    """Mean over n samples; shorter by n - 1."""
    return np.convolve(value, np.ones(n) / n, "valid")


def bisect(f, low, high):
    """The root of f between two numbers at which it has different signs."""
    sign = f(low) > 0
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if (f(middle) > 0) == sign else (low, middle)
    return 0.5 * (low + high)


def wet_bed_bore(high, low, g=9.81):
    """Stoker (1957): depth and speed of the bore where water of depth `high` breaks into `low`."""
    def excess(depth):  # of the velocity behind the bore over that in the rarefaction
        bore = math.sqrt(g * depth * (depth + low) / (2 * low))
        return bore * (1 - low / depth) - 2 * (math.sqrt(g * high) - math.sqrt(g * depth))

    depth = bisect(excess, low, high)
    return depth, math.sqrt(g * depth * (depth + low) / (2 * low))


def nearest(points, others, reach):
    """Distance from each point to the nearest of the others; reach where none is nearer."""
    result = np.full(len(points), reach, dtype=float)
    if len(points) and len(others):
        a, b = close_pairs(points, others, reach)
        np.minimum.at(result, a, np.hypot(*(points[a] - others[b]).T))
    return result


def close_pairs(points, others, reach):
    """Indices (of points, of others) of all pairs nearer than reach."""
    low = np.minimum(points.min(axis=0), others.min(axis=0)) - 2 * reach
    cell, own = ((((x - low) / reach).astype(np.int64)) for x in (others, points))
    rows = int(max(cell[:, 1].max(), own[:, 1].max())) + 3
    key = cell[:, 0] * rows + cell[:, 1]
    order = np.argsort(key, kind="stable")
    key, found = key[order], []
    for shift in (dx * rows + dy for dx in (-1, 0, 1) for dy in (-1, 0, 1)):
        wanted = own[:, 0] * rows + own[:, 1] + shift
        first, count = np.searchsorted(key, wanted), np.searchsorted(key, wanted, "right")
        count -= first
        a = np.repeat(np.arange(len(points)), count)
        place = np.arange(len(a)) - np.repeat(np.cumsum(count) - count, count)
        b = order[np.repeat(first, count) + place]
        near = np.hypot(*(points[a] - others[b]).T) < reach
        found.append((a[near], b[near]))
    return tuple(map(np.concatenate, zip(*found)))


def surrounded(points, others, reach, sector):
    """How many points have others nearer than reach on all sides: none of their directions leaves a
    free sector (rad) as wide as that."""
    if not len(points) or not len(others):
        return 0
    a, b = close_pairs(points, others, reach)
    if not len(a):
        return 0
    angle = np.arctan2(*(others[b] - points[a]).T[::-1])
    order = np.lexsort((angle, a))
    a, angle = a[order], angle[order]
    first = np.flatnonzero(np.r_[True, a[1:] != a[:-1]])
    last = np.r_[first[1:], len(a)] - 1
    gap = np.r_[0, np.diff(angle)]
    gap[first] = 2 * math.pi - (angle[last] - angle[first])
    return int((np.maximum.reduceat(gap, first) < sector).sum())


def beam_frequency(young, poisson, density, thickness, length):
    """First frequency (Hz) of a thin cantilever in plane strain, Euler and Bernoulli."""
    stiffness = young / (1 - poisson ** 2) * thickness ** 3 / 12
    return 1.875104 ** 2 / (2 * math.pi * length ** 2) * math.sqrt(stiffness /
                                                                   (density * thickness))


def about_running_mean(time, value, width):
    """Time and what is left of a curve when its mean over `width` (s) is taken out."""
    half = max(1, round(0.5 * width / float(np.median(np.diff(time)))))
    if len(time) < 4 * half:
        raise BadFile(f"a curve of {time[-1] - time[0]:.3g} s is too short for a mean over "
                      f"{width:g} s")
    return time[half:-half], value[half:-half] - running_mean(value, 2 * half + 1)


def mean_frequency(time, value):
    """From the first to the last change of sign; 0 with fewer than two."""
    zeros = crossings(time, value)
    return 0.5 * (len(zeros) - 1) / (zeros[-1] - zeros[0]) if len(zeros) > 1 else 0.0


def surface_height(x, dp, at):
    """Height of the topmost particle's upper side in columns of two spacings at the places `at`."""
    column = np.round((x[:, 0] - at[0]) / (2 * dp)).astype(int)
    top = np.zeros(len(at))
    inside = (column >= 0) & (column < len(at))
    np.maximum.at(top, column[inside], x[inside, 1] + dp / 2)
    return top
