# SPDX-License-Identifier: MIT
"""A case in several resolutions: the limit of each probe and energy, the order of convergence, the
error band of the finest run."""
from __future__ import annotations

import json
import math
import os
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable

import numpy as np

from .files import BadFile, read_table, read_text
from .library import InputError
from .run import Run

if TYPE_CHECKING:
    from .case import Case

MAX_RUNS = 6
MEASURES = ("final", "peak", "settled")
# What a run writes before its first checkpoint.
PARTIAL_FILES = ("probes.csv", "ledger.csv", "fields.vtkhdf", "case.cfg")
HINT = "for a finer first run, use a smaller --ratio, or start from a finer dp (--set dp=...)"


@dataclass
class Convergence:
    """Convergence of one value over three resolutions."""

    extrapolated: float
    band: float  # of the finest value, in its unit
    order: float | None = None
    why: str = ""  # there is no order

    def resolves(self, value: float) -> bool:
        """Whether the band is not larger than the finest value; else not even the sign is known."""
        return self.band <= abs(value)


def _without_order(values, why: str) -> Convergence:
    """Three times the largest difference (after Eca and Hoekstra 2014)."""
    widest = max(values) - min(values)
    return Convergence(values[0], 3 * widest, None, why if widest > 0 else "no difference")


def converge(values, ratio: float) -> Convergence:
    """Richardson extrapolation of three values, finest first; dp grows by `ratio`. Band: grid
    convergence index with a factor of 1.25 (Roache 1994; Celik et al. 2008), the order taken as 2
    at most. Values that do not converge monotonically, or slower than with order 0.5, have no
    order."""
    if not all(map(math.isfinite, values)):
        return Convergence(values[0], math.nan, None, "not finite")
    fine, coarse = values[1] - values[0], values[2] - values[1]
    if fine * coarse <= 0:
        return _without_order(values, "not monotone")
    order = math.log(coarse / fine) / math.log(ratio)
    if order < 0.5:
        return _without_order(values, "slower than order 0.5")
    gain = ratio**min(order, 2) - 1
    return Convergence(values[0] - fine / gain, 1.25 * abs(fine) / gain, order)


def errors_agree(fine, middle, coarse) -> bool:
    """Whether the runs differ in the last part of the time by one error that falls with dp.
    Richardson extrapolation assumes an error C(t) dp^p, so both differences are proportional to
    C(t) (Roache 1998); here more than half of their squares has to be. Noise has none in common."""
    a, b = np.subtract(middle, fine), np.subtract(coarse, middle)
    product = a @ b
    return bool(product >= 0 and product**2 >= 0.5 * (a @ a) * (b @ b))


@dataclass
class Column:
    """One column of a run: its value at the end, of largest magnitude, and mean of the last quarter
    of the time, and the values of that quarter."""

    measures: dict[str, float]
    late: np.ndarray

    @classmethod
    def of(cls, time: np.ndarray, values: np.ndarray) -> Column:
        late = values[time >= 0.75 * time[-1]]
        known = values[~np.isnan(values)]
        peak = known[np.argmax(np.abs(known))] if len(known) else 0.0
        return cls(dict(zip(MEASURES, (float(values[-1]), float(peak), float(late.mean())))), late)


def _converge_columns(columns: list[Column], measure: str, ratio: float) -> Convergence:
    """An order from three final values is chance if the differences of the runs are not those of
    one error."""
    values = [column.measures[measure] for column in columns]
    found = converge(values, ratio)
    if measure == "final" and found.order is not None and len({len(column.late)
                                                               for column in columns}) == 1 \
            and not errors_agree(*(column.late for column in columns)):
        return _without_order(values, "noise")
    return found


def _read_columns(folders: list[Path], file: str) -> list[dict[str, Column]]:
    """The columns of each run up to the last time that all of them have: the last steps of a solid
    without fluid may pass rows behind the end."""
    tables = [read_table(folder / file, torn=True, finite=False)[0] for folder in folders]
    times = [table.pop("time_s") for table in tables]
    end = min(time[-1] for time in times)
    return [{name: Column.of(time[time <= end], values[time <= end])
             for name, values in table.items()} for time, table in zip(times, tables)]


def _two_digits(value: float) -> str:
    """Two significant digits, without an exponent up to a million."""
    if 100 <= abs(value) < 1e6:
        step = 10.0**(math.floor(math.log10(abs(value))) - 1)
        return f"{step * round(value / step):.0f}"
    return f"{value:.2g}"


def _row(measure: str, values, c: Convergence) -> str:
    order = "none" if c.order is None else f"{c.order:.2f}"
    limit = f"{c.extrapolated:.5g}" if c.resolves(values[0]) else "none"
    percent = ""
    if values[0] != 0 and math.isfinite(c.band):
        percent = f" ({_two_digits(100 * c.band / abs(values[0]))} %)"
    return (f"  {measure:<8} {values[2]:12.5g} {values[1]:12.5g} {values[0]:12.5g} {limit:>12}  "
            f"{order:>5}"
            f"  +- {_two_digits(c.band)}{percent}{'; ' + c.why if c.why else ''}"
            f"{'' if c.resolves(values[0]) else '; no result'}")


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


class Refinement:
    """The runs of a case at dp * ratio^(runs - 1), ..., dp * ratio, dp, in folders below
    `folder`."""

    def __init__(self, case: Case, folder: Path, runs: int, ratio: float, until: float,
                 threads: int,
                 say: Callable[[str], None]):
        if not 3 <= runs <= MAX_RUNS:
            raise InputError(f"refine: {runs} resolutions are given, but 3 to {MAX_RUNS} are "
                             f"allowed")
        if not 1.1 <= ratio <= 4:
            raise InputError(f"refine: the ratio of resolutions is {ratio:g}, but 1.1 to 4 is "
                             f"allowed")
        self.case, self.folder, self.ratio, self.say = case, folder, ratio, say
        self.until, self.threads = until, threads
        with warnings.catch_warnings():  # each run says its own
            warnings.simplefilter("ignore")
            own = self._top(case.effective(until=until))
            self.dp = [own * ratio**(runs - 1 - k) for k in range(runs)]
            self.cases = [case.with_changes(dp=dp) for dp in self.dp]
            texts = [self._try(case) for case in self.cases]
        self.off_lattice = any("off the lattice" in text.partition("\n\n")[0] for text in texts)
        self.folders = [folder / f"dp-{dp:.6g}" for dp in self.dp]

    @staticmethod
    def _top(text: str) -> float:
        return float(next(line for line in text.splitlines()
                          if line.startswith("dp = ")).split()[2])

    def _try(self, case: Case) -> str:
        """The case in effect in a resolution: read before any run, since runs may take hours. The
        case could be read at its own dp, so what is wrong comes from the resolution."""
        try:
            return case.effective(until=self.until)
        except InputError as problem:
            dp = case.changes["dp"]
            raise InputError(f"refine: at dp = {dp:.6g} m, {dp / self.dp[-1]:.4g} times the "
                             f"case's: {problem}; "
                             f"{HINT}") from None

    def _is_done(self, k: int) -> bool:
        """Whether the folder holds a finished run of exactly this case. Of another case the restart
        says so."""
        case, part = self.folders[k] / "case.cfg", self.folders[k] / "case.cfg.part"
        if not case.exists() or Run(self.folders[k]).status != "finished":
            return False
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            own = self.cases[k].write_effective(part, until=self.until)
        part.unlink()
        return read_text(case).partition("\n")[2] == own.partition("\n")[2]

    def _run(self, k: int, progress: bool) -> None:
        folder = self.folders[k]
        self.say(f"run {k + 1} of {len(self.dp)}: dp = {self.dp[k]:.6g} m in {folder}")
        if self._is_done(k):
            self.say(f"{folder} is finished already")
            return
        restart = (folder / "summary.json").exists() or any(folder.glob("*.ckpt"))
        if not restart and not (folder.is_dir() and Run(folder).is_running):
            for name in PARTIAL_FILES:  # killed before its first checkpoint, it starts again
                (folder / name).unlink(missing_ok=True)
        self.cases[k].run(folder, progress=progress, restart=restart, until=self.until,
                          threads=self.threads, notes=self.say)

    def run(self, progress: bool) -> None:
        for k in range(len(self.dp)):
            self._run(k, progress)

    def _report_file(self, file: str, result: Callable[[str], None]) -> dict[str, Any]:
        """The convergence of the columns of one file. Of the ledger only energies that end at other
        than zero are printed."""
        runs = _read_columns(self.folders[:-4:-1], file)
        report: dict[str, Any] = {}
        for name in runs[0]:
            if any(name not in run for run in runs):
                raise BadFile(f"{self.folder}: the runs do not all have the column {name} "
                              f"of {file}")
            columns = [run[name] for run in runs]
            ends = columns[0].measures["final"]
            shown = file != "ledger.csv" or (name.endswith("_J_per_m") and ends != 0)
            if shown:
                result(name)
            report[name] = {}
            for measure in MEASURES:
                values = [column.measures[measure] for column in columns]
                found = _converge_columns(columns, measure, self.ratio)
                if shown:
                    result(_row(measure, values, found))
                limit = found.extrapolated if found.resolves(values[0]) else None
                report[name][measure] = {
                    "values": [_finite(v) for v in values], "order": found.order,
                    "why_no_order": found.why, "extrapolated": limit, "band": _finite(found.band)}
        return report

    def report(self, result: Callable[[str], None]) -> dict[str, Any]:
        """Prints the convergence over the three finest runs and writes refine.json."""
        dp = self.dp[:-4:-1]
        report: dict[str, Any] = {"dp": dp, "off_lattice": int(self.off_lattice)}
        result(f"dp (m)     {dp[2]:12.5g} {dp[1]:12.5g} {dp[0]:12.5g} extrapolated  order  band of "
               f"the finest")
        probes = [(name, keys) for kind, name, keys in Run(self.folders[-1]).case()
                  if kind == "probe"]
        own = [f"probes_{name}.csv" for name, keys in probes
               if float(keys["interval"].split()[0]) > 0]
        for file in ["probes.csv"] * (len(own) < len(probes)) + own:
            report.update(self._report_file(file, result))
        report["ledger"] = self._report_file("ledger.csv", result)
        result("peak: value of largest magnitude; settled: mean of the last quarter; band: grid "
               "convergence index "
               "or, if there is no order, 3 times the largest difference")
        result("no result: the band is larger than the value of the finest run, so not even the "
               "sign is known")
        result("noise: in the last quarter the differences of the runs are not proportional to "
               "each other, so no "
               "final value is reliable")
        if self.off_lattice:
            result("bodies are off the lattice in some of these resolutions, so their sizes differ "
                   "and the orders "
                   "are not reliable")
        part = self.folder / "refine.json.part"
        part.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
        os.replace(part, self.folder / "refine.json")
        return report
