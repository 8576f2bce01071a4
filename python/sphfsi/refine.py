# SPDX-License-Identifier: MIT
"""A case over spacing, kernel, speed of sound and time step: for each measure of each probe the
orders, the limit, and the band of 90 % about what the case's own resolution gives."""
from __future__ import annotations

import json
import math
import os
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Iterable

import numpy as np

from .bands import STUDENT_95, Band, Total, band, student
from .files import BadFile, read_text
from .library import Guard, InputError
from .measures import measures
from .run import Run

if TYPE_CHECKING:
    from .case import Case

MAX_RUNS = 6
RATIOS = (2.0, 1.5, 1.25)  # the first one that the case can have
# Sizes of the speed of sound's inverse, and of the step, over the case's own. Lower speeds are
# cheaper and have the larger error; longer steps might be unstable.
SIZES = {"sound": (math.sqrt(2), 2.0), "step": (math.sqrt(0.5), 0.5)}
# Changes of no consequence: of the skin of the neighbour search and of the step.
REPEATS = ((0.95, 1.0), (0.9, 0.99), (0.85, 0.98), (0.8, 0.97), (0.75, 0.96), (0.7, 0.95))
DIRECTIONS = ("kernel", "sound", "step", "repeats")
# By how much h/dp changes, and its range.
WIDER, NARROWEST, WIDEST = 1.44, 1.1, 2.0
# What a run writes before its first checkpoint.
PARTIAL_FILES = ("probes.csv", "ledger.csv", "fields.vtkhdf", "case.cfg")
HINT = "for a finer first run, use a smaller --ratio, or start from a finer dp (--set dp=...)"


@dataclass
class Job:
    """One run of the plan."""

    folder: Path
    case: Case
    dp: float
    direction: str  # "spacing" or one of DIRECTIONS
    size: float     # of the step of the direction, over the case's own
    seconds: float = 0.0
    failed: str = ""


def _two_digits(value: float) -> str:
    """Two significant digits, without an exponent up to a million."""
    if 100 <= abs(value) < 1e6:
        step = 10.0**(math.floor(math.log10(abs(value))) - 1)
        return f"{step * round(value / step):.0f}"
    return f"{value:.2g}"


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _row(measure: str, spacing: list[float], total: Total) -> str:
    """Values from coarse to fine, limit, orders, band."""
    orders = " ".join(f"{'none' if part.order is None else format(part.order, '.2f'):>6}"
                      for part in total.parts.values())
    known = math.isfinite(total.half) and total.half <= abs(total.value)
    limit = f"{total.limit:.5g}" if math.isfinite(total.limit) else "none"
    share = f" ({_two_digits(100 * total.half / abs(total.value))} %)" if total.value and \
        math.isfinite(total.half) else ""
    why = total.parts["spacing"].why
    text = " ".join(f"{value:12.5g}" for value in reversed(spacing))
    text = f"  {measure:<9} {text} {limit:>12} {orders}  +- {_two_digits(total.half)}{share}"
    if why and total.deviation:
        mean, wide = float(np.mean(total.repeats)), student(STUDENT_95, len(total.repeats))
        text += (f"; {len(total.repeats)} repeats: mean {mean:.4g}, 95 % within "
                 f"+- {_two_digits(wide * total.deviation)}")
    return text + (f"; {why}" if why else "") + ("" if known else "; no result")


class Refinement:
    """The plan of runs, in folders below `folder`: spacings dp * ratio^(runs - 1), ..., dp; and at
    the spacing before the finest the other directions. Those in `without` are left out."""

    def __init__(self, case: Case, folder: Path, runs: int = 3, ratio: float | None = None,
                 until: float = 0.0, threads: int = 0, start: float | None = None,
                 without: Iterable[str] = (), repeats: int = 3,
                 say: Callable[[str], None] = print):
        if not 3 <= runs <= MAX_RUNS:
            raise InputError(f"refine: {runs} resolutions are given, but 3 to {MAX_RUNS} are "
                             f"allowed")
        if ratio is not None and not 1.1 <= ratio <= 4:
            raise InputError(f"refine: the ratio of resolutions is {ratio:g}, but 1.1 to 4 is "
                             f"allowed")
        if not 2 <= repeats <= len(REPEATS):
            raise InputError(f"refine: {repeats} repeats are given, but 2 to {len(REPEATS)} are "
                             f"allowed")
        if wrong := sorted(set(without) - set(DIRECTIONS)):
            raise InputError(f"refine: without {wrong[0]}: there are {', '.join(DIRECTIONS)}")
        self.case, self.folder, self.say = case, folder, say
        self.until, self.threads, self.start = until, threads, start
        with warnings.catch_warnings():  # each run says its own
            warnings.simplefilter("ignore")
            self.own = case.explain(until=until, threads=threads)
            self.ratio, self.off_lattice = self._choose_ratio(runs, ratio)
            self.jobs = [Job(folder / f"dp-{dp:.6g}", case.with_changes(dp=dp), dp, "spacing",
                             dp / self.own["dp"])
                         for dp in (self.own["dp"] * self.ratio**k for k in range(runs))][::-1]
            for direction in DIRECTIONS:
                if direction not in without:
                    self.jobs += self._side_jobs(direction, repeats)
            for job in self.jobs:
                job.seconds = self._price(job)

    # --- the plan ---

    def _try(self, dp: float) -> str:
        """The case in effect in a resolution: read before any run, since runs may take hours. The
        case could be read at its own dp, so what is wrong comes from the resolution."""
        try:
            return self.case.with_changes(dp=dp).effective(until=self.until)
        except InputError as problem:
            own = self.own["dp"]
            raise InputError(f"refine: at dp = {dp:.6g} m, {dp / own:.4g} times the case's: "
                             f"{problem}; {HINT}") from None

    def _choose_ratio(self, runs: int, ratio: float | None) -> tuple[float, bool]:
        """The given ratio, or the largest at which the case can be read in all resolutions, its
        bodies on the lattice if that is possible; and whether they are off it."""
        first = None
        for tried in RATIOS if ratio is None else (ratio,):
            try:
                texts = [self._try(self.own["dp"] * tried**k) for k in reversed(range(runs))]
            except InputError:
                if tried == RATIOS[-1] and first is None or ratio is not None:
                    raise
                continue
            off = any("off the lattice" in text.partition("\n\n")[0] for text in texts)
            if not off:
                return tried, False
            first = first or tried
        return first, True

    def _side_jobs(self, direction: str, repeats: int) -> list[Job]:
        """Runs that differ from that before the finest in one direction."""
        base = next(job for job in self.jobs if math.isclose(job.size, self.ratio))
        keys = self.own["parameters"]
        numerics, fluids = keys["numerics"], list(keys.get("fluid", {}))
        if direction != "step" and not fluids:
            return []
        width = numerics["h_over_dp"]
        wider = min(WIDER, WIDEST / width) if width < WIDER * NARROWEST else 1 / WIDER

        def step(size: float) -> dict[str, float]:
            if numerics["fixed_step"] > 0:
                return {"fixed_step": numerics["fixed_step"] * size}
            return {key: numerics[key] * size for key in ("cfl", "solid_safety")}

        jobs = []
        for k in range(repeats if direction == "repeats" else 2):
            size = 1.0 if direction == "repeats" else wider**(-0.5 * (k + 1)) \
                if direction == "kernel" else SIZES[direction][k]
            if direction == "kernel":
                changes = {"numerics": {"h_over_dp": width / size}}
                if "solid" in keys:  # whose sums are consistent at any h/dp: T-22
                    changes["numerics"]["solid_h_over_dp"] = \
                        numerics["solid_h_over_dp"] or width
            elif direction == "sound":
                changes = {name: {"sound_speed": self.own["derived"]["c0"] / size}
                           for name in fluids}
            elif direction == "step":
                changes = {"numerics": step(size)}
            else:
                skin, size = REPEATS[k]
                changes = {"numerics": {"skin": numerics["skin"] * skin, **step(size)}}
            name = f"repeat-{k + 1}" if direction == "repeats" else \
                f"kernel-{1 / size:.3g}" if direction == "kernel" else f"{direction}-{size:.3g}"
            jobs.append(Job(self.folder / name, base.case.with_changes(**changes), base.dp,
                            direction, size))
        return jobs

    def _price(self, job: Job) -> float:
        """Seconds that the program foresees; 0 of a finished run."""
        if self._is_done(job):
            return 0.0
        try:
            return job.case.explain(until=self.until, threads=self.threads)["cost"]["wall_seconds"]
        except InputError as problem:
            if job.direction == "spacing":
                raise
            job.failed = str(problem)
            return 0.0

    def plan(self, result: Callable[[str], None]) -> None:
        """Prints what is to run and what it costs."""
        for job in self.jobs:
            state = "cannot be run" if job.failed else \
                f"{job.seconds:10.3g} s" if job.seconds else "finished"
            result(f"  {job.folder.name:<14} dp {job.dp:<9.4g} m {job.direction:<8} {state:>12}")
        result(f"  in all {sum(job.seconds for job in self.jobs):.3g} s on this machine when idle")

    # --- the runs ---

    def _is_done(self, job: Job) -> bool:
        """Whether the folder holds a finished run of exactly this case. Of another case the restart
        says so."""
        case, part = job.folder / "case.cfg", job.folder / "case.cfg.part"
        if not case.exists() or Run(job.folder).status != "finished":
            return False
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            own = job.case.write_effective(part, until=self.until)
        part.unlink()
        return read_text(case).partition("\n")[2] == own.partition("\n")[2]

    def _run(self, job: Job, progress: bool) -> None:
        folder = job.folder
        if self._is_done(job):
            self.say(f"{folder} is finished already")
            return
        restart = (folder / "summary.json").exists() or any(folder.glob("*.ckpt"))
        if not restart and not (folder.is_dir() and Run(folder).is_running):
            for name in PARTIAL_FILES:  # killed before its first checkpoint, it starts again
                (folder / name).unlink(missing_ok=True)
        job.case.run(folder, progress=progress, restart=restart, until=self.until,
                     threads=self.threads, notes=self.say)

    def run(self, progress: bool) -> None:
        """Runs what is not finished, coarsest first. A case that is unstable with another speed of
        sound or step tells that; it ends nothing."""
        for k, job in enumerate(self.jobs):
            if job.failed:
                continue
            self.say(f"run {k + 1} of {len(self.jobs)}: dp = {job.dp:.6g} m in {job.folder}")
            try:
                with warnings.catch_warnings():  # of the case, which has said them
                    if job.direction != "spacing":
                        warnings.simplefilter("ignore")
                    self._run(job, progress)
            except Guard as problem:
                if job.direction == "spacing":
                    raise
                job.failed = str(problem)

    # --- the results ---

    def _columns(self, file: str) -> list[dict[str, dict[str, float]]]:
        """The measures of all columns of a file for each run, up to the last time that all of them
        have: the last steps of a solid without fluid may pass rows behind the end."""
        tables = [None if job.failed else Run(job.folder).table(file) for job in self.jobs]
        end = self.end = float(min(table["time_s"][-1] for table in tables if table))
        found = []
        for job, table in zip(self.jobs, tables):
            time = table.pop("time_s") if table else None
            found.append({name: measures(name, time[time <= end], values[time <= end], self.start)
                          for name, values in (table or {}).items()})
        wanted = set(found[0])
        for job, columns in zip(self.jobs, found):
            if not job.failed and (missing := sorted(wanted ^ set(columns))):
                raise BadFile(f"{self.folder}: the runs do not all have the column {missing[0]} "
                              f"of {file}")
        return found

    def _smoothing(self, spacing: Band, size: float) -> float:
        """What a wider kernel adds to the error of a run before the finest: that of a spacing as
        much larger. The rest is that of the sums over particles, which does not fall with dp."""
        if spacing.order is None:
            return 0.0
        return -spacing.shift * self.ratio**spacing.order * (size**-spacing.order - 1)

    def _total(self, values: list[float | None]) -> tuple[list[float], Total] | None:
        """The values over the spacings, finest first, and what they tell; None if a run has no such
        measure."""
        def of(direction):
            return [(job.size, value) for job, value in zip(self.jobs, values)
                    if job.direction == direction and not job.failed]
        spacing = of("spacing")[::-1]
        if any(value is None or not math.isfinite(value) for _, value in spacing):
            return None
        base = spacing[1][1]
        repeats = [base, *(value for _, value in of("repeats"))]
        own = Total(spacing[0][1], {}, repeats)
        difference = math.sqrt(2) * own.scatter
        own.parts["spacing"] = band(*zip(*spacing), difference)
        for direction in ("kernel", "sound", "step"):
            found = of(direction)
            if len(found) == 2 and direction == "kernel":
                found = [(size, value - self._smoothing(own.parts["spacing"], size))
                         for size, value in found]
            if len(found) == 2:
                own.parts[direction] = band(*zip((1.0, base), *found), difference, direction)
        return [value for _, value in spacing], own

    def _report_file(self, file: str, result: Callable[[str], None]) -> dict[str, Any]:
        """The convergence of the columns of one file. Of the ledger only energies are printed."""
        runs, report = self._columns(file), {}
        for name in runs[0]:
            shown = file != "ledger.csv" or name.endswith("_J_per_m")
            report[name], lines = {}, []
            for measure in runs[0][name]:
                found = self._total([run.get(name, {}).get(measure) for run in runs])
                if not found:
                    continue
                spacing, total = found
                lines.append(_row(measure, spacing, total))
                report[name][measure] = {
                    "values": spacing, "extrapolated": _finite(total.limit),
                    "band": _finite(total.half), "scatter": total.deviation,
                    **{key: {"order": part.order, "why_no_order": part.why,
                             "band": _finite(part.half),
                             "sizes": part.sizes, "values": part.values}
                       for key, part in total.parts.items()}}
            if shown and any(entry["values"][0] for entry in report[name].values()):
                result(name)
                for line in lines:
                    result(line)
        return report

    def report(self, result: Callable[[str], None]) -> dict[str, Any]:
        """Prints what the runs tell and writes refine.json."""
        dp = [job.dp for job in self.jobs if job.direction == "spacing"][::-1]
        report: dict[str, Any] = {"dp": dp, "off_lattice": int(self.off_lattice)}
        result("dp (m)      " + " ".join(f"{value:12.5g}" for value in reversed(dp)) +
               " extrapolated  orders in spacing, kernel, sound, step; band of the finest, 90 %")
        finest = next(job.folder for job in self.jobs if job.dp == dp[0])
        probes = [(name, keys) for kind, name, keys in Run(finest).case() if kind == "probe"]
        own = [f"probes_{name}.csv" for name, keys in probes
               if float(keys["interval"].split()[0]) > 0]
        for file in ["probes.csv"] * (len(own) < len(probes)) + own:
            report.update(self._report_file(file, result))
        report["ledger"] = self._report_file("ledger.csv", result)
        result("peak: value of largest magnitude; mean: over the last quarter; band: factors of "
               "safety of Xing and Stern (2010) in each direction, added as squares")
        result("no result: the band is larger than the value of the finest run, so not even the "
               "sign is known")
        for job in self.jobs:
            if job.failed:
                result(f"{job.folder.name} failed, so that its direction is in no band: "
                       f"{job.failed}")
        if self.off_lattice:
            result("bodies are off the lattice in some of these resolutions, so their sizes differ "
                   "and the orders are not reliable")
        part = self.folder / "refine.json.part"
        part.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
        os.replace(part, self.folder / "refine.json")
        return report
