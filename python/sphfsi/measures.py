# SPDX-License-Identifier: MIT
"""What is measured on the curve of a probe: peak, mean, frequency, impulse."""
from __future__ import annotations

import re

import numpy as np

# Columns whose integral over time means something: forces, moments, pressures, flow rates.
LOAD = re.compile(r".*_(N_per_m|Nm_per_m|Pa|m2_per_s)$")


def mean(time: np.ndarray, value: np.ndarray) -> float:
    return float(np.trapezoid(value, time) / (time[-1] - time[0]))


def peak(value: np.ndarray) -> float:
    """Of largest magnitude, between the rows by the parabola through three of them."""
    k = int(np.argmax(np.abs(value)))
    if not 0 < k < len(value) - 1:
        return float(value[k])
    before, after = value[k] - value[k - 1], value[k] - value[k + 1]
    return float(value[k] + (before - after)**2 / (8 * (before + after))) if before + after else \
        float(value[k])


def _misfit(time, value, frequency):
    """Sum of squares that a straight line and the best three harmonics leave of a curve, by its
    normal equations."""
    angle = 2 * np.pi * frequency * np.outer(time, (1, 2, 3))
    base = np.column_stack([np.ones_like(time), time / time[-1], np.cos(angle), np.sin(angle)])
    right = base.T @ value
    return float(value @ value - right @ np.linalg.lstsq(base.T @ base, right, rcond=None)[0])


def frequency(time: np.ndarray, value: np.ndarray) -> float:
    """Of the periodic curve about a straight line that fits best (Hz), near the highest peak of the
    spectrum. NAN: it explains less than half of the variance, or has less than three half
    swings."""
    if len(time) < 16 or not np.ptp(value) > 0:
        return float("nan")
    time = time - time[0]
    rest = value - np.polyval(np.polyfit(time, value, 1), time)
    spectrum = np.abs(np.fft.rfft(rest * np.hanning(len(rest)), 8 * len(rest)))
    best, width = np.argmax(spectrum) / (8 * (time[1] - time[0]) * len(rest)), 0.5 / time[-1]
    for _ in range(10):  # a grid that closes in
        grid = [f for f in best + width * np.linspace(-1, 1, 9) if f > 0]
        best = min(grid, key=lambda f: _misfit(time, rest, f))
        width /= 3
    explained = 1 - _misfit(time, rest, best) / np.sum(rest**2)
    return float(best) if explained > 0.5 and best * time[-1] >= 1.5 else float("nan")


def measures(name: str, time: np.ndarray, value: np.ndarray, start: float | None = None) \
        -> dict[str, float]:
    """Peak (value of largest magnitude), mean (over the last quarter of the time), frequency and,
    of loads, impulse of a column; `start`: all of them from this time on."""
    known = ~np.isnan(value)
    time, value = time[known], value[known]
    if len(time) < 2:
        return {"peak": float("nan"), "mean": float("nan")}
    late = time >= (0.75 * time[-1] if start is None else start)
    if start is not None:
        time, value = time[late], value[late]
        late = late[late]
    found = {"peak": peak(value), "mean": mean(time[late], value[late]),
             "frequency": frequency(time, value)}
    if LOAD.match(name):
        found["impulse"] = float(np.trapezoid(value, time))
    return found
