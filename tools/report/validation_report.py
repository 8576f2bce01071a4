# SPDX-License-Identifier: MIT
"""Writes docs/validation.md and its figures from the existing runs.

A missing run is replaced by its kept result (validation_kept.py). If a run failed, has not ended or
was not run, its table says so. An error in a run, a row, a target or a section is reported in its
place, and the rest continues."""

import datetime
import subprocess
import sys
from pathlib import Path

from palette import shrink
from common import BadFile, Run, last_line, machine, read_text, sentence, words_of
from validation_measures import Missing, NotRun, balance
from validation_runs import BY_NAME, ROOT, SPECS
from validation_sound import ENDED, check_ended, check_standing

TOOLS = Path(__file__).resolve().parents[1]
MISSED = "**missed**"
ORIGIN = "Runs"  # entry of a picture that says of which runs and version it is


paragraph = words_of("validation_words.md")


class Report:
    """Data of all sections: the folder of figures, targets, runs that failed just now, kept
    results."""

    def __init__(self, docs, failed, kept):
        self.docs, self.images, self.failed = Path(docs), Path(docs) / "img", failed
        self.targets, self.kept = [], kept
        self.runs = {}      # name: the run, or why there is none
        self.wrong = {}     # what is wrong with files or the program: where it was met first
        # runs that are damaged, and what is kept of them stands instead: what is wrong
        self.replaced = {}

    def why(self, where, problem):
        """The text instead of a result, while an exception is handled. A missing run is no fault. A
        missing file or an unexpected error makes the command fail."""
        if isinstance(problem, Missing):
            return str(problem)
        text = sentence(problem)
        self.wrong.setdefault(text, where)
        return text

    def load(self, spec):
        """The result of a run: its own folder if it has ended there with the present case, else the
        kept result, else its own folder as it is."""
        own = damage = None
        try:
            if (spec.folder / "summary.json").is_file():
                own = Run(spec.folder)
                case = spec.folder / "case.cfg"
                if own.summary.get("exit_reason") in ENDED and case.is_file() and \
                        self.kept.means(spec, read_text(case)):
                    check_ended(own)
                    return own
        except BadFile as problem:
            damage = problem
        try:
            kept = Run(self.kept.find(spec))
        except NotRun:
            if damage:
                raise damage from None
            if not own:
                raise
            return own
        if damage:
            self.replaced[spec.name] = str(damage)
        return kept

    def finished(self, name):
        if name in self.failed:
            raise Missing(f"failed: {self.failed[name]}")
        run = self.load(BY_NAME[name])
        if not run.failure():
            check_ended(run)
            return run
        check_standing(run)
        ended = run.summary["time"]
        raise Missing(f"failed at t = {ended:.3g} s: {run.summary['message']}"
                      if run.summary["exit_reason"] == "guard" else f"unfinished, at t = "
                                                                    f"{ended:.3g} s")

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
        found = self.has(*names)
        if not found:
            raise Missing("none of the runs " + ", ".join(names) + " has finished")
        return found[0]

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

    def target(self, case, words, value, met):
        """A row of the table of targets. met: True, False, None if there is no run, or why it is
        unknown."""
        told = {True: "met", False: MISSED, None: "not run"}
        self.targets.append((case, words, value, told.get(met, met)))

    def try_target(self, case, words, measure):
        """measure() gives (text, met)."""
        try:
            value, met = measure()
            self.target(case, words, value, bool(met))
        except Exception as problem:  # the other targets stand
            self.target(case, words, self.why(f"target: {case}, {words}", problem),
                        "not run" if isinstance(problem, Missing) else "**not judged**")

    # --- tables ---
    def table(self, head, specs, cells):
        """A row for each run: its words and what cells(run) gives, or why there is nothing."""
        lines = ["| run | " + " | ".join(head) + " |", "|---" * (len(head) + 1) + "|"]
        for spec in specs:
            try:
                row = cells(self.run(spec.name))
            except Exception as problem:  # the other rows stand
                row = [f"*{self.why(f'row of {spec.name}', problem)}*"] + [""] * (len(head) - 1)
            lines.append(f"| {spec.words} | " + " | ".join(row) + " |")
        return [*lines, ""]

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
        done = subprocess.run([sys.executable, str(TOOLS / f"{tool}.py"),
                               *(str(run.folder) for run in runs),
                               "--out", str(path), *map(str, options)],
                              capture_output=True, text=True, check=False)
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
        return [f"![{caption}](img/{path.name})", "", f"*{caption}; an earlier picture, of "
                                                      f"{origin}*", ""]


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
    lines = ["| run | available energy (J/m) | dissipated | largest spurious gain | momentum x, "
             "y at the end (N s/m) | mass | density |", "|---" * 7 + "|"]
    for name in report.has(*(spec.name for prefix in prefixes for spec in starting(prefix))):
        try:
            play, lost, gain, along, up, mass, density = balance(report.run(name))
        except Exception as problem:  # the other rows stand
            lines.append(f"| {name} | *{report.why(f'ledger of {name}', problem)}* |" + " |" * 5)
            continue
        lines.append(
            f"| {name} | {play:.4g} | {lost:.4g} | {gain:.2g} ({100 * gain / play:.2g} %) "
            f"| {along:.3g}, {up:.3g} | {mass:+.1g} | {100 * density:.2g} % |")
    return [*lines, ""]


def by_version(report, newest):
    """Names of the finished runs by the version of the program, the newest first."""
    found = {}
    for name in report.has(*BY_NAME):
        found.setdefault(report.run(name).summary.get("version", "?"), []).append(name)
    return dict(sorted(found.items(), key=lambda item: (item[0] != newest, -len(item[1]))))


def what_was_run(report, versions):
    """The runs by state. Finished runs of older versions are listed separately."""
    stand, done = {"unfinished or failed": [], "damaged": [], "not run": []}, {}
    for k, (version, names) in enumerate(versions.items()):
        done[f"finished, by {version}" if k else "finished"] = names
    held = []
    for spec in SPECS:
        try:
            effects = report.run(spec.name).summary.get("effects", [])
            held += [spec.name] if "MULTIRATE" in effects and "IMPEDANCE" not in effects else []
        except NotRun as nothing:
            wrong = str(nothing).partition("; ")[2]
            stand["not run"].append(f"{spec.name} ({wrong})" if wrong else spec.name)
        except Missing:
            stand["unfinished or failed"].append(spec.name)
        except BadFile as problem:
            stand["damaged"].append(f"{spec.name} ({problem})")
    stand["damaged"] += [f"{name} ({text}; what is kept of it stands instead)"
                         for name, text in report.replaced.items()]
    if held:
        done["of these with an explicit interface force over sub-steps, the default of earlier "
             "versions"] = held
    return [f"* {words} ({len(names)}): {', '.join(names) or 'none'}"
            for words, names in {**(done or {"finished": []}), **stand}.items()] + [""]


def sections():
    """(title, function) of each section, in order."""
    from validation_cases import baffle, cantilever, gate, plate, sluice
    from validation_rates import rates
    import validation_checks as checks
    return [("3.1 Free oscillation of a cantilever", cantilever),
            ("3.2 Hydrostatic water column on an elastic plate", plate),
            ("3.3 Dam-break wave and elastic gate", gate),
            ("3.4 Dam break in a wet bed and an elastic baffle", baffle),
            ("3.5 Dam break and an elastic sluice gate", sluice),
            ("Sub-steps of the solid", rates),
            ("Still water", checks.still), ("Standing wave", checks.wave),
            ("Taylor-Green vortices", checks.vortices),
            ("Dam break on a dry bed: the front", checks.front),
            ("Dam break: pressures of the impact", checks.impact),
            ("Patch test", checks.patch), ("Static large bending: the elastica", checks.beam),
            ("Free rotation of an unloaded block", checks.block),
            ("Bar stretched by its own weight", checks.bar),
            ("Ledgers of the verification runs", checks.all_ledgers)]


def write_section(report, title, section):
    """The lines of a section, or why there are none."""
    try:
        body = section(report)
    except Exception as problem:  # the other sections stand
        body = [f"**Not reported: {report.why(f'section {title}', problem)}.**", ""]
    print(f"section: {title}", flush=True)
    return [f"## {title}", "", *body]


# Where the difference of a missed target comes from: case, a part of the target's words, the
# reason.
REASONS = [
    ("cantilever", "", "discretisation of the clamp and of the solid (Sec. 3.1)"),
    ("hydrostatic plate", "half the spacing", "acoustic wave of the column: the start is not the "
                                              "discrete "
     "equilibrium, and the paper's alpha hardly damps it"),
    ("hydrostatic plate", "fluctuation", "acoustic wave of the column: the start is not the "
                                         "discrete "
                                         "equilibrium "
     "because the lattice sum of h/dp = 1.35 is 0.983"),
    ("gate", "measured", "stiffness of the body: linear rubber in plane strain instead of the "
                         "measured rubber; leaks past "
     "the sides of the laboratory's gate"),
    ("sluice gate", "water pressed", "a few particles at a time, pressed into the bed in spite of "
                                     "`wall_repulsion`; "
     "the cause was not studied"),
    ("still water", "Eq. 6", "density diffusion of Eq. 6, which treats the hydrostatic gradient as "
                             "noise"),
    ("still water", "", "lattice sum of h/dp = 1.35 and compression of the water"),
    ("standing wave", "order", "shear stiffness of the even lattice, which depends on h/dp and not "
                               "on "
                               "the spacing"),
    ("standing wave", "", "shear stiffness of the even lattice at this h/dp"),
    ("dry dam break", "impact peak", "water hammer of a compressible fluid without air; a wider "
                                     "kernel damps its "
     "noise"),
    ("dry dam break", "", "uncertain reading of the published times, and the membrane that needs "
                          "time "
                          "to open"),
]


def reason(case, words):
    return next((text for name, part, text in REASONS if case.startswith(name) and part in words),
                "see the section of the case")


def summary(targets):
    """Three sentences: how many targets are met, how many are missed, and in which cases."""
    def counted(rows):
        cases = [row[0] for row in rows]
        return ", ".join(f"{case} ({cases.count(case)})" for case in dict.fromkeys(cases)) or "none"
    met = [row for row in targets if row[3] == "met"]
    missed = [row for row in targets if row[3] == MISSED]
    other = len(targets) - len(met) - len(missed)
    return (f"**Does it agree with theory and experiment?** {len(met)} of {len(targets)} targets "
            f"are met: "
            f"{counted(met)}. {len(missed)} are missed: {counted(missed)}. " +
            (f"{other} could not be judged. " if other else "") +
            "The second table says where each difference comes from.")


def target_tables(targets):
    """What is met, then what is missed with the reason, then the rest."""
    met = [row for row in targets if row[3] == "met"]
    missed = [row for row in targets if row[3] == MISSED]
    rest = [row for row in targets if row not in met and row not in missed]
    lines = ["## Targets that are met", "", "| case | target | found | |", "|---|---|---|---|",
             *("| " + " | ".join(row) + " |" for row in met), "",
             "## Targets that are missed", "",
             "| case | target | found | | where the difference comes from |",
             "|---|---|---|---|---|",
             *("| " + " | ".join([*row, reason(row[0], row[1])]) + " |" for row in missed), ""]
    if rest:
        lines += ["## Targets that are not judged", "", "| case | target | found | |",
                  "|---|---|---|---|",
                  *("| " + " | ".join(row) + " |" for row in rest), ""]
    return lines


def write_report(docs, failed, kept, newest):
    """Returns what is wrong with files or the program, a sentence each. `newest`: the present
    version of the program."""
    report = Report(docs, failed, kept)
    report.images.mkdir(parents=True, exist_ok=True)
    body = []
    for title, section in sections():
        body += write_section(report, title, section)
    versions = by_version(report, newest)
    done = [name for names in versions.values() for name in names]
    taken = sum(report.run(name).folder != BY_NAME[name].folder for name in done)
    head = [
        "# Validation", "", summary(report.targets), "",
        "`make validate` (`tools/report/validation.py`) writes this report. Nothing in it is "
        "edited by hand: "
        "the numbers "
        "come from the runs, the sentences from the tool.", "",
        "* Program " +
        (", ".join(f"{version} ({len(names)} runs)" for version, names in versions.items())
                         or newest) + ".",
        f"* {taken} of the {len(done)} runs are kept results (`docs/validation/`).",
        f"* Date and machine of the report: {datetime.date.today()}, {machine()}.",
        "* Seconds are wall-clock time of a run's last process, on a machine with other work. They "
        "show ratios at "
        "best.", "", *target_tables(report.targets)]
    tail = ["## What was run", "",
            "A run that is not listed as finished has no number in this report. The names are "
            "those of "
            "`tools/report/validation_runs.py`; `--only =NAME` runs one of them.", "",
            *what_was_run(report, versions)]
    path = report.docs / "validation.md"
    path.write_text("\n".join([*head, *body, *tail]).rstrip() + "\n")
    print(f"written {path.relative_to(ROOT) if path.is_relative_to(ROOT) else path}")
    return [f"{where}: {text}" for text, where in report.wrong.items()]
