# SPDX-License-Identifier: MIT
"""The finest resolution that a given time allows."""
from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING, Any, Callable

from .library import InputError

if TYPE_CHECKING:
    from .case import Case

# Candidates for dp: these times a power of ten, m.
ROUND_NUMBERS = (8, 5, 4, 2.5, 2, 1.25, 1)
# Candidates with more particles are skipped.
MAX_PARTICLES = 2e7


def _cost(plan: dict[str, Any], dp: float) -> dict[str, float]:
    """The cost with another dp: there are 1 / dp^2 particles and 1 / dp steps, and as many rows of
    output."""
    scale, cost = dp / plan["dp"], plan["cost"]
    rows = cost["row_seconds"]
    return {"particles": (plan["particles"]["fluid"] + plan["particles"]["solid"]) / scale**2,
            "steps": cost["steps"] / scale,
            "seconds": rows + (cost["wall_seconds"] - rows) / scale**3,
            "megabytes": 1e-6 * cost["memory_bytes"] / scale**2}


def _why_not(case: Case, dp: float) -> str:
    """Why the case cannot have this spacing; empty if it can."""
    try:
        head = case.with_changes(dp=dp).effective().partition("\n\n")[0]
    except InputError:
        return "the case refuses it"
    return "bodies off the lattice" if "off the lattice" in head else ""


def _line(dp: float, cost: dict[str, float], remark: str) -> str:
    return (f"  dp {dp:<9.4g} m {cost['particles']:10.3g} particles {cost['steps']:10.3g} steps "
            f"{cost['seconds']:10.3g} s {cost['megabytes']:8.3g} MB  {remark}")


def find_dp(case: Case, seconds: float, until: float, threads: int,
            say: Callable[[str], None]) -> float | None:
    """Prints the cost of round spacings from a tenth of the budget to three times the budget;
    returns the finest one within the budget."""
    if not 0 < seconds <= 1e9:
        raise InputError(f"budget = {seconds:g} s must be above 0 and at most 1e9")
    plan = case.explain(until=until, threads=threads)
    own, threads, best = plan["dp"], plan["cost"]["threads"], None
    say(f"budget of {seconds:.4g} s with {threads} thread{'' if threads == 1 else 's'} on this "
        f"machine when idle")
    for power in range(math.ceil(math.log10(own)) + 1, -9, -1):
        for dp in (number * 10.0**power for number in ROUND_NUMBERS):
            cost = _cost(plan, dp)
            if not 0.1 * seconds <= cost["seconds"] <= 3 * seconds or \
                cost["particles"] > MAX_PARTICLES:
                continue
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                why = _why_not(case, dp)
            if not why and cost["seconds"] <= seconds:
                best = dp
            say(_line(dp, cost, why or ("fits" if cost["seconds"] <= seconds else "too long")))
    say(_line(own, _cost(plan, own), "the case's own"))
    if best:
        say(f"finest dp within the budget: --set dp={best:.6g}")
    else:
        say("no listed dp both fits all bodies to the lattice and runs within the budget; allow "
            "more time or choose "
            "another dp")
    lines = plan.text.splitlines()
    for line in lines[next(k for k, line in enumerate(lines)
                           if line.startswith("expected error")):]:
        say(line)
    return best
