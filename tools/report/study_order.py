# SPDX-License-Identifier: MIT
"""Observed order and error band from three resolutions."""

import math


def convergence(spacing, value):
    """From (dp, value) of three runs, finest first: order, extrapolated value, relative band.

    Celik et al., J. Fluids Eng. 130 (2008) 078001: p solves p ln r21 = |ln|e32/e21| + q(p)|; the grid
    convergence index with a safety factor of 1.25 (Roache 1994). Without monotone convergence, or
    with p < 0.5, three times the largest difference (after Eca and Hoekstra 2014)."""
    (h1, h2, h3), (f1, f2, f3) = spacing, value
    e21, e32 = f2 - f1, f3 - f2
    widest = 3 * max(abs(e21), abs(e32), abs(f3 - f1))
    scale = abs(f1) or 1.0
    none = {"order": None, "extrapolated": f1, "band": widest / scale}
    if e21 == 0 or e32 / e21 <= 0:
        return dict(none, why="not monotone" if e21 or e32 else "no difference")
    r21, r32 = h2 / h1, h3 / h2
    p = 1.0
    for _ in range(100):
        q = math.log((r21**p - 1) / (r32**p - 1))
        new = min(10.0, max(0.01, (math.log(e32 / e21) + q) / math.log(r21)))
        if abs(new - p) < 1e-10:
            break
        p = 0.5 * (p + new)
    if p < 0.5:
        return dict(none, why=f"p = {p:.2f} < 0.5")
    gain = r21 ** min(p, 2.0) - 1
    return {"order": p, "extrapolated": f1 - e21 / gain, "band": 1.25 * abs(e21) / gain / scale, "why": ""}
