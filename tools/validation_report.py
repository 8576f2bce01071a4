# SPDX-License-Identifier: MIT
"""Writes docs/validation.md and its figures from the runs that there are.

A run that is not there is taken from what is kept of it (validation_kept.py). A section that meets a
reference that is missing or malformed says so and the rest goes on; a run that failed, has not ended or was
not run stands in its table with that word."""

import datetime
import subprocess
import sys
from pathlib import Path

from palette import shrink
from runfiles import BadFile, Run, np
from validation_measures import Missing, NotRun, balance
from validation_runs import BY_NAME, ENDED, ROOT, SPECS

TOOLS = Path(__file__).resolve().parent
ORIGIN = "Runs"  # entry of a picture that says of which runs and version it is


class Report:
    """What the sections share: the folder of figures, targets, runs that failed just now, kept results."""

    def __init__(self, docs, failed, kept):
        self.docs, self.images, self.failed = Path(docs), Path(docs) / "img", failed
        self.targets, self.kept = [], kept

    def folder(self, spec):
        """Where the result of a run is: its own folder if it has ended there and is of the case that is
        meant now, or else what is kept of it, or else its own folder, such as it is."""
        has_summary = (spec.folder / "summary.json").is_file()
        case = spec.folder / "case.cfg"
        if has_summary and Run(spec.folder).summary.get("exit_reason") in ENDED and case.is_file() and \
                self.kept.means(spec, case.read_text()):
            return spec.folder
        try:
            return self.kept.find(spec)
        except NotRun:
            if has_summary:
                return spec.folder
            raise

    def run(self, name):
        """A finished run."""
        if name in self.failed:
            raise Missing(f"failed: {self.failed[name]}")
        run = Run(self.folder(BY_NAME[name]))
        if run.failure():
            reason = run.summary.get("exit_reason", "")
            ended = run.summary.get("time", 0)
            raise Missing(f"failed at t = {ended:.3g} s: {run.summary.get('message', reason)}"
                          if reason == "guard" else f"unfinished, at t = {ended:.3g} s")
        return run

    def has(self, *names):
        """Those of the names that have finished."""
        found = []
        for name in names:
            try:
                self.run(name)
                found.append(name)
            except (Missing, BadFile):
                pass
        return found

    def first(self, *names):
        """The first of the names that has finished."""
        found = self.has(*names)
        if not found:
            raise Missing("none of the runs " + ", ".join(names) + " has finished")
        return found[0]

    def coarse(self, *families):
        """By the paper's two integrators: the first family of which one has finished, or the last."""
        pairs = [[f"{name}-verlet", name] for name in families]
        return next((pair for pair in pairs if self.has(*pair)), pairs[-1])

    def shown(self, fine, coarse):
        """The runs that a figure puts side by side: the finer ones, if both of the paper's integrators
        or else leapfrog have got through."""
        pair = self.has(f"{fine}-verlet", fine)
        return pair if len(pair) == 2 else self.has(f"{fine}-leapfrog") or pair or coarse

    def target(self, case, words, value, met):
        """A row of the table of targets; met: True, False, or None where there is no run."""
        self.targets.append((case, words, value, {True: "met", False: "**missed**", None: "not run"}[met]))

    def try_target(self, case, words, measure):
        """measure() gives (text, met)."""
        try:
            value, met = measure()
            self.target(case, words, value, bool(met))
        except (Missing, BadFile) as problem:
            self.target(case, words, str(problem), None)

    # --- tables ---
    def table(self, head, specs, cells):
        """A row for each run: its words and what cells(run) gives, or why there is nothing."""
        lines = ["| run | " + " | ".join(head) + " |", "|---" * (len(head) + 1) + "|"]
        for spec in specs:
            try:
                row = cells(self.run(spec.name))
            except (Missing, BadFile) as problem:
                row = [f"*{problem}*"] + [""] * (len(head) - 1)
            lines.append(f"| {spec.words} | " + " | ".join(row) + " |")
        return [*lines, ""]

    # --- figures ---
    def draw(self, tool, names, image, caption, *options):
        """A figure by one of the drawing tools, or the sentence why there is none. Where the snapshots
        that it shows are not kept, the picture that there is stays, and the report says of what it is."""
        runs = [self.run(name) for name in self.has(*names)]
        if not runs:
            return [f"*No figure: none of {', '.join(names)} has finished.*", ""]
        path = self.images / f"validation-{image}.png"
        if tool == "plot_fields":
            full = [run for run in runs if (run.folder / "fields.vtkhdf").is_file()]
            if len(full) < len(runs) and path.is_file():
                return self.standing(path, caption)
            if not full:
                return ["*No figure: the snapshots are not kept, and it has not been drawn before.*", ""]
            runs = full
        done = subprocess.run([sys.executable, str(TOOLS / f"{tool}.py"), *(str(run.folder) for run in runs),
                               "--out", str(path), *map(str, options)],
                              capture_output=True, text=True, check=False)
        if done.returncode:
            last = (done.stderr.strip().splitlines() or ["no message"])[-1]
            return [f"*No figure: {last}*", ""]
        versions = dict.fromkeys(run.summary.get("version", "?") for run in runs)
        return self.picture(path, caption, f"{', '.join(run.name for run in runs)} by {', '.join(versions)}")

    def save(self, figure, image, caption):
        path = self.images / f"validation-{image}.png"
        figure.savefig(path)
        return self.picture(path, caption)

    def picture(self, path, caption, origin=""):
        shrink(path, {ORIGIN: origin} if origin else {})
        return [f"![{caption}](img/{path.name})", "", f"*{caption}*", ""]

    def standing(self, path, caption):
        """A picture that was drawn when the snapshots were there."""
        from PIL import Image
        try:
            with Image.open(path) as image:
                origin = image.info.get(ORIGIN) or "runs and a version that it does not name"
        except (OSError, ValueError) as problem:
            return [f"*No figure: the snapshots are not kept, and {path.name} cannot be read "
                    f"({problem}).*", ""]
        return [f"![{caption}](img/{path.name})", "", f"*{caption}; drawn before, of {origin}*", ""]


def series(run, column, since=-1.0):
    """Time and a column of probes.csv from an instant on."""
    table = run.table("probes.csv")
    if column not in table:
        raise BadFile(f"{run.folder / 'probes.csv'}: no column {column}")
    time, value = table["time_s"], table[column]
    return time[time >= since], value[time >= since]


def cost(run):
    summary = run.summary
    return [f"{summary['steps']:,}", f"{summary['solid_substeps']:,}",
            f"{summary['wall_seconds']:.0f} ({summary['threads']})"]


COST = ["fluid steps", "solid steps", "s (threads)"]


def starting(prefix):
    return [spec for spec in SPECS if spec.name.startswith(prefix)]


def ledgers(report, prefixes):
    """Energy and momentum of all finished runs whose names begin with one of the prefixes."""
    lines = ["| run | energy in play (J/m) | dissipated | largest gain from nowhere | momentum x, "
             "y at the end (N s/m) | mass | density |", "|---" * 7 + "|"]
    for spec in [s for p in prefixes for s in starting(p)]:
        try:
            play, lost, gain, along, up, mass, density = balance(report.run(spec.name))
        except (Missing, BadFile):
            continue
        lines.append(
            f"| {spec.name} | {play:.4g} | {lost:.4g} | {gain:.2g} ({100 * gain / play:.2g} %) "
            f"| {along:.3g}, {up:.3g} | {mass:+.1g} | {100 * density:.2g} % |")
    return [*lines, ""]


def machine():
    path = Path("/proc/cpuinfo")
    for line in path.read_text().splitlines() if path.exists() else []:
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return "unknown processor"


def by_version(report, newest):
    """Names of the finished runs by the version of the program, the newest first."""
    found = {}
    for name in report.has(*BY_NAME):
        found.setdefault(report.run(name).summary.get("version", "?"), []).append(name)
    return dict(sorted(found.items(), key=lambda item: (item[0] != newest, -len(item[1]))))


def what_was_run(report, versions):
    """The runs by how they stand; those of another version than the newest for themselves."""
    stand, done = {"unfinished or failed": [], "not run": []}, {}
    for k, (version, names) in enumerate(versions.items()):
        done[f"finished, by {version}" if k else "finished"] = names
    for spec in SPECS:
        try:
            report.run(spec.name)
        except NotRun as nothing:
            wrong = str(nothing).partition("; ")[2]
            stand["not run"].append(f"{spec.name} ({wrong})" if wrong else spec.name)
        except (Missing, BadFile):
            stand["unfinished or failed"].append(spec.name)
    return [f"* {words} ({len(names)}): {', '.join(names) or 'none'}"
            for words, names in {**(done or {"finished": []}), **stand}.items()] + [""]


def sections():
    """(title, function) of each section, in order."""
    from validation_cases import baffle, cantilever, gate, plate, sluice
    import validation_checks as checks
    return [("3.1 Free oscillation of a cantilever", cantilever),
            ("3.2 Hydrostatic water column on an elastic plate", plate),
            ("3.3 Dam-break wave and elastic gate", gate),
            ("3.4 Dam break in a wet bed and an elastic baffle", baffle),
            ("3.5 Dam break and an elastic sluice gate", sluice),
            ("Still water", checks.still), ("Standing wave", checks.wave),
            ("Taylor-Green vortices", checks.vortices),
            ("Dam break on a dry bed: the front", checks.front),
            ("Dam break: pressures of the impact", checks.impact),
            ("Patch test", checks.patch), ("Static large bending: the elastica", checks.beam),
            ("Free rotation of an unloaded block", checks.block),
            ("Bar stretched by its own weight", checks.bar),
            ("Ledgers of the verification runs", checks.all_ledgers)]


def write_report(docs, failed, kept, newest):
    """`newest`: the version of the program as it is now."""
    report = Report(docs, failed, kept)
    report.images.mkdir(parents=True, exist_ok=True)
    body = []
    for title, section in sections():
        body += [f"## {title}", ""]
        try:
            body += section(report)
        except (Missing, BadFile) as problem:
            body += [f"**Not reported: {problem}.**", ""]
        print(f"section: {title}", flush=True)
    versions = by_version(report, newest)
    done = [name for names in versions.values() for name in names]
    taken = sum(report.run(name).folder != BY_NAME[name].folder for name in done)
    head = [
        "# Validation", "",
        "Written by `make validate` (`tools/validate.py`); nothing here is typed by hand, and what "
        "is judged is computed from the runs. Program " +
        (", ".join(f"{version} ({len(names)} runs)" for version, names in versions.items()) or newest) +
        f"; {taken} of the {len(done)} runs are kept results (`docs/validation/`). Report of "
        f"{datetime.date.today()}, {machine()}. Seconds are the clock's of a run's last process, "
        f"on a machine that other work shared: they show ratios at best.", "",
        "## Targets", "", "| case | target | found | |", "|---|---|---|---|",
        *("| " + " | ".join(row) + " |" for row in report.targets), "",
        "Why a target is missed is said in the section of its case.", ""]
    tail = ["## What was run", "",
            "A run that is not listed as finished has no number in this report. Names are those of "
            "`tools/validation_runs.py`; `--only =NAME` runs one.", "", *what_was_run(report, versions)]
    path = report.docs / "validation.md"
    path.write_text("\n".join([*head, *body, *tail]).rstrip() + "\n")
    print(f"written {path.relative_to(ROOT) if path.is_relative_to(ROOT) else path}")


