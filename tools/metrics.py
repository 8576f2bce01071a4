# SPDX-License-Identifier: MIT
"""What is measured on the curves of runs, and the exact solutions they are held against."""

import math

from runfiles import BadFile, np


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


def damped_sine(time, value, omega):
    """Frequency and decay of C exp(-g t) cos(w t + phi) that fits best, near `omega`."""
    def misfit(w, g):
        fade = np.exp(-g * time)
        base = np.stack([fade * np.cos(w * time), fade * np.sin(w * time)], axis=1)
        coefficients = np.linalg.lstsq(base, value, rcond=None)[0]
        return float(np.sum((base @ coefficients - value) ** 2))

    best, width, decay = (omega, 0.0), 0.15 * omega, 0.5
    for _ in range(8):  # a grid that closes in
        grid = [(best[0] + width * a, max(0.0, best[1] + decay * b))
                for a in np.linspace(-1, 1, 13) for b in np.linspace(-1, 1, 9)]
        best = min(grid, key=lambda pair: misfit(*pair))
        width, decay = width / 3, decay / 3
    return best


def order(steps, errors):
    """Order of convergence: slope of log error over log step."""
    return float(np.polyfit(np.log(steps), np.log(np.abs(errors)), 1)[0])


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


def wet_bed_bore(high, low, g=9.81):
    """Stoker (1957): depth and speed of the bore where water of depth `high` breaks into `low`."""
    def excess(depth):  # of the velocity behind the bore over that in the rarefaction
        bore = math.sqrt(g * depth * (depth + low) / (2 * low))
        return bore * (1 - low / depth) - 2 * (math.sqrt(g * high) - math.sqrt(g * depth))

    lower, upper = low, high
    for _ in range(80):
        depth = 0.5 * (lower + upper)
        lower, upper = (lower, depth) if excess(depth) > 0 else (depth, upper)
    return depth, math.sqrt(g * depth * (depth + low) / (2 * low))


def elastica(load, points=400):
    """Tip of a cantilever of length 1 that carries the weight `load` = w L^3/D, spread evenly and
    always downwards: with theta counted downwards theta'' = -load (1 - s) cos theta, theta(0) = 0,
    theta'(1) = 0, by shooting with Runge-Kutta steps. Returns (x, y) of the tip; y is negative."""
    step = 1 / points

    def shoot(curvature):
        def rate(s, state):
            angle, bend, _, _ = state
            return np.array([bend, -load * (1 - s) * math.cos(angle), math.cos(angle),
                             -math.sin(angle)])
        state = np.array([0.0, curvature, 0.0, 0.0])
        for k in range(points):
            s = k * step
            a = rate(s, state)
            b = rate(s + step / 2, state + step / 2 * a)
            c = rate(s + step / 2, state + step / 2 * b)
            d = rate(s + step, state + step * c)
            state = state + step / 6 * (a + 2 * b + 2 * c + d)
        return state

    low, high = -(load + 10), load + 10
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if shoot(middle)[1] < 0 else (low, middle)
    state = shoot(0.5 * (low + high))
    return float(state[2]), float(state[3])


def lattice_shear(h_over_dp):
    """Square of the speed of shear waves across the diagonal of an even lattice under a pressure p,
    over p/rho: the sum of V s^2 W_tt over the neighbours, s along the diagonal and t across it, which
    follows from Eq. 3b for small displacements. A fluid has none; kernel of Eq. 4."""
    n, h = int(2 * h_over_dp) + 1, h_over_dp
    x, y = (a.ravel() for a in np.meshgrid(np.arange(-n, n + 1.0), np.arange(-n, n + 1.0)))
    r = np.hypot(x, y)
    x, y, r = (a[(r > 0) & (r < 2 * h)] for a in (x, y, r))
    q, norm = r / h, 7 / (4 * np.pi * h ** 2)
    first = -5 * norm * q * (1 - q / 2) ** 3 / h
    second = norm * (7.5 * q - 5 * (1 - q / 2)) * (1 - q / 2) ** 2 / h ** 2
    along, across = (x + y) ** 2 / 2, (x - y) ** 2 / 2
    return float(np.sum(along * (second * across / r ** 2 + first / r * (1 - across / r ** 2))))


def nearest(points, others, reach):
    """Distance from each point to the nearest of the others; reach where none is nearer."""
    result = np.full(len(points), reach, dtype=float)
    if not len(points) or not len(others):
        return result
    low, high = points.min(axis=0) - reach, points.max(axis=0) + reach
    others = others[((others > low) & (others < high)).all(axis=1)]
    for k in range(0, len(points), 256):
        part = points[k:k + 256]
        if len(others):
            d = np.hypot(part[:, None, 0] - others[None, :, 0], part[:, None, 1] - others[None, :, 1])
            result[k:k + 256] = np.minimum(reach, d.min(axis=1))
    return result


def surface_height(x, dp, at):
    """Height of the topmost particle's upper side in columns of two spacings at the places `at`."""
    column = np.round((x[:, 0] - at[0]) / (2 * dp)).astype(int)
    top = np.zeros(len(at))
    inside = (column >= 0) & (column < len(at))
    np.maximum.at(top, column[inside], x[inside, 1] + dp / 2)
    return top
