# SPDX-License-Identifier: MIT
"""Results of long runs of the validation that are kept in docs/results/validation/NAME.zip.

An archive holds what the report reads of a run without its snapshots: summary.json, the effective
case, probes.csv, ledger.csv, and in measured.json the numbers that take the snapshots or every row.
Runs of the quick selection are not kept, since they are run again in minutes. A kept result counts
as long as its case is what the specification gives now, whichever version of the program it is
of."""

import io
import json
import os
import re
import tempfile
import zipfile
from pathlib import Path

from common import ROOT, BadFile, Run, ask, check_increasing, read_text, sentence
from sphfsi.draw_ledger import read_ledger
from validation_measures import FILE, NotRun, measure_all

FOLDER = ROOT / "docs" / "results" / "validation"
ENDED = ("finished", "guard")  # exit reasons after which a run would end in the same way again
TABLES = ("probes.csv", "ledger.csv")
NEEDED = {"summary.json", "case.cfg", FILE}
LARGEST = 60_000  # bytes of an archive above which it is thinned out
# Columns of probes.csv that the report reads, where it does not read all: runs by their beginnings.
COLUMNS = {"plate": ["M1_dy_m"], "cantilever": ["M1_dy_m"], "still": []}
ROWS = ("gate", "wave", "taylor", "block")  # runs of whose ledger it reads the rows
# What earlier versions wrote where nothing was named and no case can hold now: it changed no bit.
RETIRED = re.compile(r"(interface = (auto|impedance)|gradients = plain|kernel = \w+|idle = \w+)$")


def archive(files):
    """A zip file whose bytes depend on the names and texts of the files only."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as out:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.create_system, entry.external_attr = 3, 0o644 << 16  # the same on any system
            entry.compress_type = zipfile.ZIP_DEFLATED
            out.writestr(entry, files[name])
    return buffer.getvalue()


def thin_columns(text, columns):
    lines = [line.split(",") for line in text.splitlines()]
    picked = [k for k, name in enumerate(lines[0]) if name in ("time_s", *columns)]
    return "".join(",".join(line[k] for k in picked) + "\n" for line in lines)


def thin_rows(text, every):
    head, *rows = text.splitlines(keepends=True)
    return "".join([head, *rows[:-1:every], rows[-1]])


def pack(name, files):
    """The archive, thinned out where the report reads less if it is too large."""
    data = archive(files)
    wanted = next((c for prefix, c in COLUMNS.items() if name.startswith(prefix)), None)
    if len(data) > LARGEST and wanted is not None and "probes.csv" in files:
        files = {**files, "probes.csv": thin_columns(files["probes.csv"], wanted)}
        data = archive(files)
    whole, every = files.get("ledger.csv"), 1
    while len(data) > LARGEST and whole and not name.startswith(ROWS) and every < 64:
        every *= 2
        data = archive({**files, "ledger.csv": thin_rows(whole, every)})
    return data


def physics(text):
    """Lines of an effective case that the results depend on: comments name the program, the paths
    of files the place where it ran, numerics.skin says only when particles are sorted, and without
    a fluid there is no scheme."""
    fluid = "\n[fluid " in text
    return [line for line in text.splitlines() if line.strip() and not line.startswith(
        ("#", "file ", "title ", "source ", "label ", "skin ")) and
        (fluid or not line.startswith("scheme "))]


def means(job, text):
    """Whether the effective case of a run, which another version may have written, is what the job
    means now. A key that came later has its default. A case without `scheme` is older than it and
    the paper's; one without `energy_account` is older than contact, too."""
    now = job.effective()
    if physics(text) == physics(now):
        return True
    files = iter([line for line in now.splitlines() if line.startswith("file ")])
    lines = [next(files, line) if line.startswith("file ") else line
             for line in text.splitlines() if not RETIRED.match(line)]
    if not re.search("(?m)^scheme =", text):
        lines.insert(0, "scheme = paper")
    with tempfile.NamedTemporaryFile("w", suffix=".cfg", encoding="utf-8") as old:
        old.write("\n".join([*lines, ""]))
        old.flush()
        try:
            then = ask("--effective", old.name)
        except BadFile:
            return False
    if "\nenergy_account =" not in text:
        now, then = (re.sub(r"(?m)^\[contact .*\n((?!\[).*\n)*?enabled = off\n((?!\[).*\n)*", "", t)
                     for t in (now, then))
    return physics(then) == physics(now)


def check_ended(run):
    """Complains of a run that has ended without all that the report reads of it."""
    path, summary = run.folder / "summary.json", run.summary
    if summary.get("exit_reason") not in ENDED:
        raise BadFile(f"{path}: exit_reason is {summary.get('exit_reason', 'missing')}, not "
                      f"{' or '.join(ENDED)}")
    numbers = [] if run.failure() else ["steps", "solid_substeps", "wall_seconds", "threads"]
    for key in ("version", "message", "time", *numbers):
        if not isinstance(summary.get(key), str if key in ("version", "message") else (int, float)):
            raise BadFile(f"{path}: {key} is {summary.get(key, 'missing')!r}")
    if run.failure():
        return
    if any(kind == "fluid" for kind, _, _ in run.case()) and "c0" not in summary.get("derived", {}):
        raise BadFile(f"{path}: c0 is missing")
    probes = any(kind == "probe" and (keys.get("interval") or "0").split()[0] == "0"
                 for kind, _, keys in run.case())
    for name in TABLES if probes else TABLES[1:]:
        time = run.table(name)["time_s"]
        check_increasing(run.folder / name, "time_s", time)
        # Rows end at the end that was asked for, a run with the first step at or after it.
        end = min(summary["time"], summary.get("end_time", summary["time"]))
        if time[-1] < end - 1.5 * (time[-1] - time[0]) / max(1, len(time) - 1):
            raise BadFile(f"{run.folder / name}: ends at t = {time[-1]:.6g} s, though the run has "
                          f"ended at {summary['time']:.6g} s")
    read_ledger(run)


class Kept:
    """The kept results below a folder."""

    def __init__(self, folder):
        self.folder, self.found = Path(folder), {}  # name: the run, or why there is none
        self.scratch = tempfile.TemporaryDirectory(prefix="sphfsi-kept-")

    def path(self, job):
        return self.folder / f"{job.name}.zip"

    def find(self, job):
        """The kept result of a run; NotRun says why there is none."""
        if job.name not in self.found:
            try:
                self.found[job.name] = self.unpack(job)
            except NotRun as reason:
                self.found[job.name] = reason
            except Exception as problem:
                print(f"{self.path(job)}: {sentence(problem)}; it counts as not run", flush=True)
                self.found[job.name] = NotRun("is damaged")
        if isinstance(self.found[job.name], NotRun):
            raise self.found[job.name]
        return self.found[job.name]

    def unpack(self, job):
        path, place = self.path(job), Path(self.scratch.name) / job.name
        if not path.is_file():
            raise NotRun
        try:
            with zipfile.ZipFile(path) as file:
                names = set(file.namelist())
                if not NEEDED <= names <= {*NEEDED, *TABLES}:
                    raise BadFile(f"holds {', '.join(sorted(names))}")
                file.extractall(place)
        except (OSError, ValueError, EOFError, RuntimeError, zipfile.BadZipFile) as problem:
            raise BadFile(f"not a readable archive ({problem})") from None
        run = Run(place)
        check_ended(run)
        try:
            json.loads(read_text(place / FILE))
        except ValueError as problem:
            raise BadFile(f"{FILE}: not valid JSON ({problem})") from None
        if not means(job, read_text(place / "case.cfg")):
            print(f"{path}: of another case than {job.name} means now, so not used", flush=True)
            raise NotRun("is of another case")
        return run

    def store(self, job):
        """Keeps the result of a run that has ended; returns the file."""
        run = Run(job.folder)
        check_ended(run)
        files = {name: read_text(job.folder / name)
                 for name in ("summary.json", "case.cfg", *TABLES) if (job.folder / name).is_file()}
        # Where it was run says nothing about the result.
        files["summary.json"] = re.sub(
            r'(?m)^(\s*"(?:case|restarted_from|forked_from)": ").*/', r"\1", files["summary.json"])
        # A run that a guard ended has no numbers in the report.
        measured = {} if run.failure() else measure_all(run)
        files[FILE] = json.dumps(measured, indent=1, sort_keys=True) + "\n"
        self.folder.mkdir(parents=True, exist_ok=True)
        part = self.path(job).with_suffix(".part")
        part.write_bytes(pack(job.name, files))
        os.replace(part, self.path(job))
        self.found.pop(job.name, None)
        return self.path(job)
