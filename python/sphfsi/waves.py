# SPDX-License-Identifier: MIT
"""Incident and reflected waves from the levels at two or more gauges in a line: least squares by
Mansard and Funke (1980), which for two gauges is the method of Goda and Suzuki (1976)."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Sequence

import numpy as np

from .files import BadFile

# Two gauges 0.05 to 0.45 of a length apart are this well conditioned, or better (Goda and Suzuki).
CONDITION = 1 / np.tan(0.05 * np.pi)
HARMONICS = 3  # of regular waves, in the fit; only the first is separated


@dataclass
class Waves:
    """Heights (m) of waves that run towards larger and smaller x: of regular waves twice the
    amplitude of the first harmonic, else 4 sqrt(m0). `amplitude` has both for each `frequency`
    (1/s)."""
    incident: float
    reflected: float
    frequency: np.ndarray
    amplitude: np.ndarray

    @property
    def reflection(self) -> float:
        """The reflected height over the incident one."""
        return self.reflected / self.incident


def wave_number(omega: float, depth: float, gravity: float = 9.81) -> float:
    """k of omega^2 = g k tanh(k d), 1/m, by Newton's method from the longer of both limits."""
    k = max(omega**2 / gravity, omega / np.sqrt(gravity * depth))
    for _ in range(50):
        t = np.tanh(k * depth)
        step = (gravity * k * t - omega**2) / (gravity * (t + k * depth * (1 - t**2)))
        k -= step
        if abs(step) < 1e-14 * k:
            break
    return float(k)


def _fit(time, levels, period):
    """Complex amplitudes of the first harmonic, by least squares over whole periods."""
    turns = 2 * np.pi * time / period
    columns = [np.ones_like(turns)]
    for n in range(1, HARMONICS + 1):
        columns += [np.cos(n * turns), np.sin(n * turns)]
    found = np.linalg.lstsq(np.stack(columns, axis=1), levels.T, rcond=None)[0]
    return found[1] - 1j * found[2]


def separate(time: Sequence[float], levels: Sequence[Sequence[float]], places: Sequence[float],
             depth: float, period: float | None = None, gravity: float = 9.81) -> Waves:
    """Waves from the levels (m) of gauges at the places x (m) in water of a depth (m). `period`
    (s): of regular waves, fitted over the last whole number of periods. Without it all frequencies
    of the record count for which the gauges are well placed."""
    time, levels, places = (np.asarray(values, float) for values in (time, levels, places))
    if len(places) < 2 or levels.shape != (len(places), len(time)):
        raise BadFile(f"{len(places)} gauges with {levels.shape} levels at {len(time)} times: two "
                      "or more gauges are needed, with a level at each time")
    if period is not None:
        # Each row stands for the time until the next one: 80 rows of T/40 are two periods.
        record = (time[-1] - time[0]) * len(time) / max(len(time) - 1, 1)
        periods = int(record / period * (1 + 1e-9))
        if periods < 1:
            raise BadFile(f"the record of {record:g} s is shorter than the period of {period:g} s")
        last = time >= time[-1] - periods * period * (1 + 1e-9)
        frequency = np.array([1 / period])
        amplitudes = _fit(time[last], levels[:, last], period)[:, None]
    else:
        even = np.linspace(time[0], time[-1], len(time))
        values = np.stack([np.interp(even, time, row - row.mean()) for row in levels])
        frequency = np.fft.rfftfreq(len(even), even[1] - even[0])[1:]
        amplitudes = 2 / len(even) * np.fft.rfft(values, axis=1)[:, 1:]
    kept, found = [], []
    for f, heights in zip(frequency, amplitudes.T):
        turn = 1j * wave_number(2 * np.pi * f, depth, gravity) * places
        matrix = np.stack([np.exp(-turn), np.exp(turn)], axis=1)
        if np.linalg.cond(matrix) <= CONDITION * (1 + 1e-6):
            kept.append(f)
            found.append(np.abs(np.linalg.lstsq(matrix, heights, rcond=None)[0]))
    if not kept:
        raise BadFile(f"gauges at x = {', '.join(f'{x:g}' for x in places)} m cannot separate "
                      "these waves: two of them should be 0.05 to 0.45 of a wave length apart")
    amplitude = np.array(found)
    height = 2 * amplitude[0] if period is not None else \
        4 * np.sqrt((amplitude**2).sum(axis=0) / 2)
    return Waves(float(height[0]), float(height[1]), np.array(kept), amplitude)
