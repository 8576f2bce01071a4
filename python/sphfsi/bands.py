# SPDX-License-Identifier: MIT
"""The error band of a value from runs in which one step of the discretization changes.

The error is that of a power of the step, fitted by least squares (Eca and Hoekstra 2014, J.
Comput. Phys. 262, 104). The band is this error times the factor of safety of Xing and Stern (2010,
J. Fluids Eng. 132, 061403). It grows with the distance of the observed order from the formal one,
which is 2 for smoothing length, compressibility (Mach number) and time. For sums over particles it
is that of an even lattice with the Wendland kernel, 5 in dp/h (Quinlan, Basa and Lastiwka 2006,
Int. J. Numer. Meth. Eng. 66, 2064). Values that do not approach a limit get three times their
range (Eca and Hoekstra 2009, Comput. Fluids 38, 1580).

Both cover 95 %. A band of 90 % is narrower by the ratio of the quantiles of a normal distribution,
as in the GUM (JCGM 100:2008, G.1.3). Independent directions add up as squares. What changes by
round-off alone scatters after Student's distribution. docs/notes/2026-11-27-bands.md compares laws.
"""
from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Sequence

import numpy as np

NINETY = 1.645 / 1.960
FORMAL_ORDER = {"spacing": 2.0, "kernel": 5.0, "sound": 2.0, "step": 2.0}
# Quantiles of Student's distribution by degrees of freedom, both tails together 10 % and 5 %.
STUDENT_90 = (math.inf, 6.314, 2.920, 2.353, 2.132, 2.015, 1.943, 1.895, 1.860, 1.833)
STUDENT_95 = (math.inf, 12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262)


@dataclass
class Band:
    """Of a value in one direction: half the width of its 90 % band, the order, and what takes the
    value to its limit."""

    half: float
    order: float | None = None
    why: str = ""  # there is no order
    shift: float = 0.0
    sizes: Sequence[float] = ()
    values: Sequence[float] = ()


def safety(share: float) -> float:
    """Xing and Stern's factor for an observed order that is so many times the formal one."""
    return 2.45 - 0.85 * share if share <= 1 else 16.4 * share - 14.8


def student(table: tuple[float, ...], count: int) -> float:
    """The quantile for so many runs."""
    return table[min(count, len(table)) - 1]


def _fit(sizes: np.ndarray, values: np.ndarray, order: float) -> tuple[float, float, float, float]:
    """Limit, error at size 1, standard deviation of the fit, what it leaves of the value there."""
    base = np.stack([np.ones_like(sizes), sizes**order], axis=1)
    (limit, slope), *_ = np.linalg.lstsq(base, values, rcond=None)
    rest = values - base @ (limit, slope)
    free = max(1, len(sizes) - 2)
    own = float(abs(rest[np.argmin(abs(sizes - 1))]))
    return float(limit), abs(float(slope)), math.sqrt(float(rest @ rest) / free), own


def _observed_order(sizes: np.ndarray, values: np.ndarray) -> float:
    """The power of the step, from -2 to 8, that fits best; 0 of three values without a trend."""
    if len(sizes) == 3:
        at = np.argsort(sizes)
        (a, b, c), (near, far) = sizes[at], np.diff(values[at])
        if near * far <= 0:
            return 0.0
        low, high = -2.0, 8.0
        for _ in range(60):
            p = 0.5 * (low + high) or 1e-9
            low, high = (p, high) if (c**p - b**p) / (b**p - a**p) < far / near else (low, p)
        return p
    orders = np.linspace(-2, 8, 400)  # without zero
    for width in (0.05, 0.005, 0.0005):
        best = min(orders, key=lambda p: _fit(sizes, values, p)[2])
        orders = best + width * np.linspace(-1, 1, 40)
    return float(min(orders, key=lambda p: _fit(sizes, values, p)[2]))


def band(sizes: Sequence[float], values: Sequence[float], scatter: float = 0.0,
         direction: str = "spacing") -> Band:
    """Of the value at size 1, from values at three or more sizes of the step over the user's own.
    Differences within `scatter` (90 %) tell nothing."""
    return replace(_band(np.asarray(sizes, float), np.asarray(values, float), scatter,
                         FORMAL_ORDER[direction]), sizes=list(sizes), values=list(values))


def _band(sizes: np.ndarray, values: np.ndarray, scatter: float, formal: float) -> Band:
    own = float(values[np.argmin(abs(sizes - 1))])
    if not np.isfinite(values).all():
        return Band(math.nan, None, "not finite")
    if np.ptp(values) <= 1e-12 * np.abs(values).max():
        return Band(0.0, None, "no difference")
    if np.ptp(values) <= scatter:
        return Band(0.0, None, "within the scatter")
    order = _observed_order(sizes, values)
    limit, error, deviation, rest = _fit(sizes, values, order or 1.0)
    if order <= 0 or deviation > np.ptp(values) / (len(values) - 1):
        return Band(NINETY * 3 * float(np.ptp(values)), None, "not monotone")
    half = NINETY * (safety(order / formal) * error + deviation + rest)
    if 0.5 <= order < formal + 0.1:
        return Band(half, order, "", limit - own)
    why = "slower than order 0.5" if order < 0.5 else f"faster than order {formal:g}"
    return Band(half, None, why)


@dataclass
class Total:
    """Of a value in all directions: limit (NAN without an order in spacing), 90 % band."""

    value: float
    parts: dict[str, Band]
    repeats: list[float]  # values of runs that differ by what has no consequence

    @property
    def deviation(self) -> float:
        return float(np.std(self.repeats, ddof=1)) if len(self.repeats) > 1 else 0.0

    @property
    def scatter(self) -> float:
        """Half the width that holds 90 % of such runs."""
        return student(STUDENT_90, len(self.repeats)) * self.deviation if self.deviation else 0.0

    @property
    def half(self) -> float:
        return math.hypot(self.scatter, *(part.half for part in self.parts.values()))

    @property
    def limit(self) -> float:
        if self.parts["spacing"].order is None or not self.half <= abs(self.value):
            return math.nan
        return self.value + sum(part.shift for part in self.parts.values())
