# SPDX-License-Identifier: MIT
"""Writes docs/results/validation.md and its figures from the existing runs.

A missing run is replaced by its kept result (validation_kept.py). If a run failed, has not ended or
was not run, its table says so. An error in a run, a row, a target or a section is reported in its
place, and the rest continues."""

import datetime
import subprocess
import sys
from pathlib import Path

from common import (IMAGES, OUT, ROOT, BadFile, Run, last_line, machine, program_version,
                    read_text, sentence,
                    table, words_of)
from palette import shrink
from validation_kept import ENDED, check_ended, means
from validation_measures import Missing, NotRun, balance
from validation_runs import BY_NAME, JOBS

MISSED = "**missed**"
ORIGIN = "Runs"  # entry of a picture that says of which runs and version it is
paragraph = words_of("validation_words.md")


class Report:
    """Data of all sections: the folder of figures, targets, runs that failed just now, kept
    results."""

    def __init__(self, docs, failed, kept):
        self.docs, self.failed = Path(docs), failed
        self.images = IMAGES if self.docs == OUT else self.docs / "img"
        self.targets, self.kept = [], kept
        self.runs = {}   # name: the run, or why there is none
        self.wrong = {}  # what is wrong with files or the program: where it was met first

    def why(self, where, problem):
        """The text instead of a result, while an exception is handled. A missing run is no fault. A
        missing file or an unexpected error makes the command fail."""
        if isinstance(problem, Missing):
            return str(problem)
        text = sentence(problem)
        self.wrong.setdefault(text, where)
        return text

    def load(self, job):
        """The run in its own folder if it has ended there with the present case, else the kept
        result, else its own folder as it is."""
        own = None
        if (job.folder / "summary.json").is_file():
            own = Run(job.folder)
            case = job.folder / "case.cfg"
            if own.summary.get("exit_reason") in ENDED and case.is_file() and \
                    means(job, read_text(case)):
                return own
        try:
            return self.kept.find(job)
        except NotRun:
            if own:
                return own
            raise

    def finished(self, name):
        if name in self.failed:
            raise Missing(f"failed: {self.failed[name]}")
        run = self.load(BY_NAME[name])
        reason = run.summary.get("exit_reason")
        if reason in ENDED:
            check_ended(run)
        if reason == "finished":
            return run
        ended = f"at t = {run.summary.get('time', float('nan')):.3g} s"
        raise Missing(f"failed {ended}: {run.summary['message']}" if reason == "guard" else
                      f"unfinished, {ended}")

    def run(self, name):
        """A finished run; Missing or BadFile says why there is none."""
        if name not in self.runs:
            try:
                self.runs[name] = self.finished(name)
            except Missing as reason:
                self.runs[name] = reason
            except Exception as problem:  # one run must not cost the report
                self.runs[name] = BadFile(self.why(name, problem))
        if isinstance(self.runs[name], Exception):
            raise self.runs[name].with_traceback(None)
        return self.runs[name]

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
        for name in self.has(*names):
            return name
        raise Missing("none of the runs " + ", ".join(names) + " has finished")

    def coarse(self, *families):
        """Runs with the paper's two integrators: the first family with a finished run, or the
        last."""
        pairs = [[f"{name}-verlet", name] for name in families]
        return next((pair for pair in pairs if self.has(*pair)), pairs[-1])

    def shown(self, fine, coarse):
        """The runs that a figure compares: the finer ones, if both of the paper's integrators or
        leapfrog have finished."""
        pair = self.has(f"{fine}-verlet", fine)
        return pair if len(pair) == 2 else self.has(f"{fine}-leapfrog") or pair or coarse

    def target(self, case, words, measure):
        """A row of the table of targets; measure() gives (text, whether it is met)."""
        try:
            value, met = measure()
            self.targets.append((case, words, value, "met" if met else MISSED))
        except Exception as problem:  # the other targets stand
            self.targets.append(
                (case, words, self.why(f"target: {case}, {words}", problem),
                 "not run" if isinstance(problem, Missing) else "**not judged**"))

    # --- tables ---
    def rows(self, head, entries, cells):
        """A table with a row for each (words, name): what cells(run) gives, or why there is
        nothing."""
        rows = []
        for words, name in entries:
            try:
                row = cells(self.run(name))
            except Exception as problem:  # the other rows stand
                row = [f"*{self.why(f'row of {name}', problem)}*"]
            rows.append([words, *row, *[""] * (len(head) - 1 - len(row))])
        return [table(head, rows), ""]

    def table(self, head, prefix, cells, without="\n"):
        """A row for each run whose name begins with the prefix."""
        return self.rows(["run", *head], [(job.words, job.name) for job in starting(prefix)
                                          if without not in job.name], cells)

    # --- figures ---
    def draw(self, tool, names, image, caption, *options):
        """A figure by one of the drawing tools, or why there is none. If the snapshots are not
        kept, the existing picture stays, and the report says which runs it shows."""
        runs = [self.run(name) for name in self.has(*names)]
        if not runs:
            return [f"*No figure: none of {', '.join(names)} has finished.*", ""]
        path = self.images / f"validation-{image}.png"
        if tool == "plot_fields":
            full = [run for run in runs if (run.folder / "fields.vtkhdf").is_file()]
            if len(full) < len(runs) and path.is_file():
                return self.standing(path, caption)
            if not full:
                return ["*No figure: the snapshots are not kept, and it has not been drawn "
                        "before.*", ""]
            runs = full
        done = subprocess.run([sys.executable, str(ROOT / "tools" / f"{tool}.py"),
                               *(str(run.folder) for run in runs), "--out", str(path),
                               *map(str, options)], capture_output=True, text=True, check=False)
        if done.returncode:
            return [f"*No figure: {self.why(path.name, BadFile(last_line(done)))}*", ""]
        versions = dict.fromkeys(run.summary.get("version", "?") for run in runs)
        return self.picture(path, caption, f"{', '.join(run.name for run in runs)} by "
                                           f"{', '.join(versions)}")

    def save(self, figure, image, caption):
        path = self.images / f"validation-{image}.png"
        figure.savefig(path)
        return self.picture(path, caption)

    def picture(self, path, caption, origin=""):
        shrink(path, {ORIGIN: origin} if origin else {})
        return [f"![{caption}](../img/{path.name})", "", f"*{caption}*", ""]

    def standing(self, path, caption):
        """A picture that was drawn when the snapshots were there."""
        from PIL import Image
        with Image.open(path) as image:
            origin = image.info.get(ORIGIN) or "runs and a version that it does not name"
        return [f"![{caption}](../img/{path.name})", "",
                f"*{caption}; an earlier picture, of {origin}*", ""]


def series(run, column, since=-1.0):
    """Time and a column of probes.csv from an instant on."""
    found = run.table("probes.csv")
    if column not in found:
        raise BadFile(f"{run.folder / 'probes.csv'}: no column {column}")
    time, value = found["time_s"], found[column]
    return time[time >= since], value[time >= since]


def cost(run):
    summary = run.summary
    return [f"{summary['steps']:,}", f"{summary['solid_substeps']:,}",
            f"{summary['wall_seconds']:.0f} ({summary['threads']})"]


COST = ["fluid steps", "solid steps", "s (threads)"]
STEPS = ["steps", *COST[1:]]  # of one medium alone


def starting(prefix):
    return [job for job in JOBS if job.name.startswith(prefix)]


def ledgers(report, *prefixes):
    """Energy and momentum of all finished runs whose names begin with one of the prefixes."""
    def cells(run):
        play, lost, gain, along, up, mass, density = balance(run)
        return [f"{play:.4g}", f"{lost:.4g}", f"{gain:.2g} ({100 * gain / play:.2g} %)",
                f"{along:.3g}, {up:.3g}", f"{mass:+.1g}", f"{100 * density:.2g} %"]
    names = report.has(*(job.name for prefix in prefixes for job in starting(prefix)))
    return report.rows(["run", "available energy (J/m)", "dissipated", "largest spurious gain",
                        "momentum x, y at the end (N s/m)", "mass", "density"],
                       [(name, name) for name in names], cells)


def by_version(report, newest):
    """Names of the finished runs by the version of the program, the newest first."""
    found = {}
    for name in report.has(*BY_NAME):
        found.setdefault(report.run(name).summary.get("version", "?"), []).append(name)
    return dict(sorted(found.items(), key=lambda item: (item[0] != newest, -len(item[1]))))


def what_was_run(report, versions):
    """The runs by state. Finished runs of older versions are listed separately."""
    stand, done, explicit = {"unfinished or failed": [], "damaged": [], "not run": []}, {}, []
    for k, (version, names) in enumerate(versions.items()):
        done[f"finished, by {version}" if k else "finished"] = names
    for name in BY_NAME:
        try:
            effects = report.run(name).summary.get("effects", [])
            explicit += [name] if "MULTIRATE" in effects and "IMPEDANCE" not in effects else []
        except NotRun as nothing:
            wrong = str(nothing).partition("; ")[2]
            stand["not run"].append(f"{name} ({wrong})" if wrong else name)
        except Missing:
            stand["unfinished or failed"].append(name)
        except BadFile as problem:
            stand["damaged"].append(f"{name} ({problem})")
    if explicit:
        done["of these with an explicit interface force over sub-steps, the default of earlier "
             "versions"] = explicit
    return [f"* {words} ({len(names)}): {', '.join(names) or 'none'}"
            for words, names in {**(done or {"finished": []}), **stand}.items()] + [""]


def sections():
    """(title, function) of each section, in order."""
    import validation_cases as cases
    import validation_checks as checks
    return [("3.1 Free oscillation of a cantilever", cases.cantilever),
            ("3.2 Hydrostatic water column on an elastic plate", cases.plate),
            ("3.3 Dam-break wave and elastic gate", cases.gate),
            ("3.4 Dam break in a wet bed and an elastic baffle", cases.baffle),
            ("3.5 Dam break and an elastic sluice gate", cases.sluice),
            ("Sub-steps of the solid", cases.rates),
            ("Still water", checks.still), ("Standing wave", checks.wave),
            ("Taylor-Green vortices", checks.vortices),
            ("Dam break on a dry bed: the front", checks.front),
            ("Dam break: pressures of the impact", checks.impact),
            ("Patch test", checks.patch), ("Static large bending: the elastica", checks.beam),
            ("Free rotation of an unloaded block", checks.block),
            ("Bar stretched by its own weight", checks.bar),
            ("Ledgers of the verification runs", lambda report: ledgers(
                report, "still", "wave", "taylor", "front", "impact", "elastica", "block", "bar"))]


def write_section(report, title, section):
    """The lines of a section, or why there are none."""
    try:
        body = section(report)
    except Exception as problem:  # the other sections stand
        body = [f"**Not reported: {report.why(f'section {title}', problem)}.**", ""]
    print(f"section: {title}", flush=True)
    return [f"## {title}", "", *body]


def reason(case, words):
    """Where the difference of a missed target comes from: rows `case | part of the target | why`
    of the words, the first that fits."""
    rows = (row.split(" | ") for row in paragraph("reasons").splitlines())
    return next(text for name, part, text in rows
                if case.startswith(name) and (part == "any" or part in words))


def counted(rows):
    cases = [row[0] for row in rows]
    return ", ".join(f"{case} ({cases.count(case)})" for case in dict.fromkeys(cases)) or "none"


def target_sections(targets):
    """A sentence that says how many targets are met and missed, and tables of what is met, of what
    is missed with the reason, and of the rest."""
    met, missed = ([row for row in targets if row[3] == word] for word in ("met", MISSED))
    rest = [row for row in targets if row not in met and row not in missed]
    other = f"{len(rest)} could not be judged. " if rest else ""
    summary = paragraph("summary", met=len(met), all=len(targets), met_by=counted(met),
                        missed=len(missed), missed_by=counted(missed), other=other)
    head = ["case", "target", "found", ""]
    lines = ["## Targets that are met", "", table(head, met), "",
             "## Targets that are missed", "", table([*head, "where the difference comes from"], (
                 [*row, reason(row[0], row[1])] for row in missed)), ""]
    if rest:
        lines += ["## Targets that are not judged", "", table(head, rest), ""]
    return summary, lines


def write_report(docs, failed, kept):
    """Returns what is wrong with files or the program, a sentence each."""
    report, newest = Report(docs, failed, kept), program_version()
    report.images.mkdir(parents=True, exist_ok=True)
    body = [line for title, section in sections() for line in write_section(report, title, section)]
    versions = by_version(report, newest)
    done = [name for names in versions.values() for name in names]
    summary, targets = target_sections(report.targets)
    head = paragraph(
        "head", summary=summary, taken=sum(report.run(name).folder != BY_NAME[name].folder
                                           for name in done), done=len(done),
        versions=", ".join(f"{version} ({len(names)} runs)"
                           for version, names in versions.items()) or newest,
        date=datetime.date.today(), machine=machine())
    path = report.docs / "validation.md"
    path.write_text("\n".join(["# Validation", "", head, "", *targets, *body, "## What was run", "",
                               paragraph("tail"), "",
                               *what_was_run(report, versions)]).rstrip() + "\n")
    print(f"written {path.relative_to(ROOT) if path.is_relative_to(ROOT) else path}")
    return [f"{where}: {text}" for text, where in report.wrong.items()]
