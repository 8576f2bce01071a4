# SPDX-License-Identifier: MIT
"""Reads the files of a run's folder: docs/formats.md says what they hold."""
from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np

# Where reference curves lie in a clone.
CASES = Path(__file__).resolve().parents[2] / "cases"


class Error(Exception):
    """What went wrong, in one sentence for the user."""


class BadFile(Error):
    """A file that is missing or malformed; the text is the sentence for the user."""


def read_text(path):
    try:
        return Path(path).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as problem:
        reason = getattr(problem, "strerror", None) or "not a text file"
        raise BadFile(f"cannot read {path}: {reason}") from None


def read_table(path, torn=False, finite=True):
    """Columns of a CSV file as {name: array}, in order, and the text of its `#` comments. `torn`:
    a last row without its newline is left out; it is one that a run has not finished. `finite`:
    nan and inf are refused."""
    comments, names, rows = [], None, []
    text = read_text(path)
    if torn:
        text = text[:text.rfind("\n") + 1]
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("#"):
            comments.append(line.lstrip("# "))
        elif names is None and line.strip():
            names = [name.strip() for name in line.split(",")]
        elif line.strip():
            try:
                row = [float(value) for value in line.split(",")]
            except ValueError:
                raise BadFile(f"{path}, line {number}: not a row of numbers") from None
            if len(row) != len(names):
                raise BadFile(f"{path}, line {number}: {len(row)} values "
                              f"for {len(names)} columns")
            wrong = next((k for k, value in enumerate(row) if finite and not math.isfinite(value)),
                         None)
            if wrong is not None:
                raise BadFile(f"{path}, line {number}: {names[wrong]} is {row[wrong]}, not a "
                              f"finite number")
            rows.append(row)
    if not rows:
        raise BadFile(f"{path}: no rows of data")
    return dict(zip(names, np.array(rows).T)), "\n".join(comments)


def check_increasing(path, name, values):
    """Complains of a column of a table that does not increase from row to row."""
    back = np.flatnonzero(np.diff(values) <= 0)
    if len(back):
        before, after = values[back[0]], values[back[0] + 1]
        raise BadFile(f"{path}, row {back[0] + 2} of the data: {name} is {after:g} after "
                      f"{before:g}; it must "
                      "increase from row to row")


def read_case(path):
    """Sections of a case file as a list of (kind, name, {key: value}); values are text."""
    sections = [("top", "", {})]
    for number, line in enumerate(read_text(path).splitlines(), 1):
        header = re.match(r"\s*\[\s*(\w+)\s*([^\]\s]*)\s*\]", line)
        entry = re.match(r'\s*(\w+)\s*=\s*(?:"(.*?)"|([^#]*))', line)
        if header:
            sections.append((header[1], header[2], {}))
        elif entry:
            sections[-1][2][entry[1]] = (entry[2] or entry[3] or "").strip()
        elif line.strip() and not line.lstrip().startswith("#"):
            raise BadFile(f"{path}, line {number}: neither a section nor key = value")
    return sections


class Run:
    """The folder of a run; its files are read when they are asked for."""

    def __init__(self, folder):
        self.folder = Path(folder)
        if not self.folder.is_dir():
            raise BadFile(f"{folder}: no such folder of a run")
        self.name = self.folder.resolve().name
        self.summary = {}
        path = self.folder / "summary.json"
        if path.exists():
            try:
                self.summary = json.loads(read_text(path))
            except ValueError as problem:
                raise BadFile(f"{path}: not valid JSON ({problem})") from None
            if not isinstance(self.summary, dict):
                raise BadFile(f"{path}: not a JSON object")

    def failure(self):
        """How the run ended short of its end, or None."""
        reason = self.summary.get("exit_reason", "running")
        if reason == "finished":
            return None
        return "unfinished" if reason == "running" else f"stopped: {reason}"

    def label(self, name=None):
        name, reason = name or self.name, self.failure()
        return name if reason is None else f"{name} ({reason})"

    def stopped(self):
        return self.summary.get("exit_reason", "running") not in ("finished", "running")

    def table(self, name):
        """Columns of a table. The last rows of a run that was stopped may hold nan: they show why;
        a ledger may hold inf: the least det F of no solid at all."""
        finite = name != "ledger.csv" and not self.stopped()
        columns, _ = read_table(self.folder / name, torn=True, finite=finite)
        if "time_s" not in columns:
            raise BadFile(f"{self.folder / name}: no column time_s")
        return columns

    def curves(self):
        """What the probes recorded, {column: (time, value)}, in the order of the case: all of
        probes.csv, then the files of probes with a rate of their own."""
        found = {}
        files = [path for path in [self.folder / "probes.csv"] if path.exists()]
        files += sorted(self.folder.glob("probes_*.csv"))
        for path in files or [self.folder / "probes.csv"]:
            table = self.table(path.name)
            time = table.pop("time_s")
            found.update((name, (time, value)) for name, value in table.items())
        return found

    def case(self):
        path = self.folder / "case.cfg"
        return read_case(path) if path.exists() else []

    def spacing(self):
        """Particle spacing dp in m."""
        top = next((keys for kind, _, keys in self.case() if kind == "top"), {})
        found = re.fullmatch(r"([\d.eE+-]+)\s*(|m|cm|mm|um)", top.get("dp", ""))
        if not found:
            raise BadFile(f"{self.folder / 'case.cfg'}: missing, or does not say dp")
        return float(found[1]) * {"": 1, "m": 1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6}[found[2]]


def make_names_differ(runs):
    """Where folders are called alike, the name of a run is the whole path."""
    names = [run.folder.resolve().name for run in runs]
    for run, name in zip(runs, names):
        run.name = name if names.count(name) == 1 else str(run.folder)


def resolutions(folder):
    """The folders of the runs of tools/refine.py, coarsest first; of a run, its own."""
    sized = []
    for found in Path(folder).glob("dp-*"):
        try:
            sized.append((-float(found.name.removeprefix("dp-")), found))
        except ValueError:
            pass
    if not sized or (Path(folder) / "ledger.csv").exists():
        return [folder]
    return [found for _, found in sorted(sized)]


def make_runs(folders):
    """Runs whose names differ. The folder of tools/refine.py stands for those of its
    resolutions."""
    runs = [Run(found) for folder in folders for found in resolutions(folder)]
    make_names_differ(runs)
    return runs


class Reference:
    """A curve to compare with: CSV with time in s and a value in SI units. `sort`: its points may
    go back and forth in time, as digitised ones do and as the program takes them. Otherwise the
    times must increase, which those of a file with swapped columns hardly do."""

    def __init__(self, probe, path, name, label, sort=False):
        self.probe, self.path, self.name, self.label = probe, Path(path), name, label
        columns, comments = read_table(path)
        if len(columns) != 2:
            raise BadFile(f"{path}: {len(columns)} columns instead of time_s,value")
        time, value = columns.values()
        if not sort:
            check_increasing(path, next(iter(columns)), time)
        order = np.argsort(time, kind="stable")
        self.time, self.value = time[order], value[order]
        # The word that comes first tells a measurement from a computation that cites one.
        words = re.search(r"(?i)(measure|experiment|laborator)|"
                          r"(numeric|comput|simulat|analytic|theor|calculat|\bsph\b|\bfe\b)",
                          label + "\n" + comments)
        self.measured = bool(words and words[1])


def references(run):
    """The references that the run's effective case names."""
    found = []
    for kind, name, keys in run.case():
        if kind != "reference" or keys.get("formula"):  # the program compares formulas itself
            continue
        if not keys.get("probe") or not keys.get("file"):
            raise BadFile(f"{run.folder / 'case.cfg'}: [reference {name}] lacks probe or file")
        given = Path(keys["file"])
        # A folder that came from elsewhere names files of another checkout: their path below
        # cases/ is tried as well.
        tails = [CASES.joinpath(*given.parts[k:]) for k in range(len(given.parts))]
        path = next((p for p in [run.folder / given, *tails] if p.is_file()), None)
        if path is None:
            raise BadFile(f"{run.folder / 'case.cfg'}: [reference {name}]: no file {given}")
        found.append(Reference(keys["probe"], path, name, keys.get("label") or name, sort=True))
    return found
