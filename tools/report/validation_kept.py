# SPDX-License-Identifier: MIT
"""Results of long runs of the validation that are kept in the repository, docs/validation/NAME.zip.

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
import zlib
from pathlib import Path

from common import BadFile, Run, read_text
from validation_measures import FILE, NotRun, malformed, measure_all
from validation_runs import ROOT
from validation_sound import ENDED, TABLES, check_ended

FOLDER = ROOT / "docs" / "validation"
NEEDED = ("summary.json", "case.cfg", FILE)
LARGEST = 60_000  # bytes of an archive above which it is thinned out
# Columns of probes.csv that the report reads, where it does not read all: runs by their beginnings.
COLUMNS = {"plate": ["M1_dy_m"], "cantilever": ["M1_dy_m"], "still": []}
ROWS = ("gate", "wave", "taylor", "block")  # runs of whose ledger it reads the rows


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


class Kept:
    """The kept results below a folder; means(spec, text) says whether an effective case is what the
    specification means now."""

    def __init__(self, folder, means):
        self.folder, self.means = Path(folder), means
        self.room = tempfile.TemporaryDirectory(prefix="sphfsi-kept-")
        self.found = {}  # name: folder where it is unpacked, or why it is not used

    def path(self, spec):
        return self.folder / f"{spec.name}.zip"

    def find(self, spec):
        """The folder with the kept result of a run; NotRun says why there is none."""
        if spec.name not in self.found:
            try:
                self.found[spec.name] = self.unpack(spec)
            except NotRun as reason:
                self.found[spec.name] = reason
            except BadFile as problem:
                print(f"{problem}; it counts as not run", flush=True)
                self.found[spec.name] = NotRun("is damaged")
        if isinstance(self.found[spec.name], NotRun):
            raise self.found[spec.name]
        return self.found[spec.name]

    def unpack(self, spec):
        path, place = self.path(spec), Path(self.room.name) / spec.name
        if not path.is_file():
            raise NotRun
        try:
            with zipfile.ZipFile(path) as file:
                texts = {name: file.read(name).decode() for name in file.namelist()}
        except (OSError, zipfile.BadZipFile, zipfile.LargeZipFile, EOFError, ValueError,
                RuntimeError,
                NotImplementedError, zlib.error) as problem:
            raise BadFile(f"{path}: not a readable archive ({problem})") from None
        strange = set(texts) - {*NEEDED, *TABLES}
        lacking = set(NEEDED) - set(texts)
        if strange or lacking:
            raise BadFile(f"{path}: " + (f"no {min(lacking)} in it" if lacking else
                                         f"{min(strange)} does not belong there"))
        place.mkdir(exist_ok=True)
        for name, text in texts.items():
            (place / name).write_text(text, encoding="utf-8")
        try:
            check(Run(place))
        except BadFile as problem:
            raise BadFile(f"{path}: {str(problem).replace(f'{place}{os.sep}', '')}") from None
        if not self.means(spec, texts["case.cfg"]):
            print(f"{path}: of another case than {spec.name} means now, so not used", flush=True)
            raise NotRun("is of another case")
        return place

    def store(self, spec):
        """Keeps the result of a run that has ended; returns the file."""
        run = Run(spec.folder)
        if run.summary.get("exit_reason") not in ENDED:
            raise BadFile(f"{spec.folder}: has not ended, so it is not kept")
        check_ended(run)
        files = {name: read_text(spec.folder / name)
                 for name in ("summary.json", "case.cfg", *TABLES)
                 if name not in TABLES or (spec.folder / name).is_file()}
        if not self.means(spec, files["case.cfg"]):
            raise BadFile(f"{spec.folder}: of another case than {spec.name} means now, so it is "
                          f"not kept")
        # Where it was run says nothing about the result.
        files["summary.json"] = re.sub(r'(?m)^(\s*"(?:case|restarted_from|forked_from)": ").*/',
                                       r"\1",
                                       files["summary.json"])
        # A run that a guard ended has no numbers in the report.
        measured = {} if run.failure() else measure_all(run)
        files[FILE] = json.dumps(measured, indent=1, sort_keys=True) + "\n"
        self.folder.mkdir(parents=True, exist_ok=True)
        path = self.path(spec)
        part = path.with_suffix(".part")
        part.write_bytes(pack(spec.name, files))
        os.replace(part, path)
        self.found.pop(spec.name, None)
        return path


def refuse_constant(name):
    raise ValueError(f"{name} is not a number that it knows")


def check(run):
    """Complains of a kept result that is not what store() writes."""
    check_ended(run)
    for name in TABLES:
        if (run.folder / name).exists():
            run.table(name)
    run.case()
    try:
        measured = json.loads(read_text(run.folder / FILE), parse_constant=refuse_constant)
    except ValueError as problem:
        raise BadFile(f"{FILE}: not valid JSON ({problem})") from None
    wrong = malformed(measured, run.name) if isinstance(measured, dict) else "not a JSON object"
    if wrong and not run.failure():
        raise BadFile(f"{FILE}: {wrong}")
