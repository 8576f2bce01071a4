# SPDX-License-Identifier: MIT
"""Checks that the folder of a finished run has all that the report reads, complete and of the right
type. Numbers of an incomplete run, or a traceback within a section, would be worse than none."""

import math

from sphfsi.draw_ledger import read_ledger
from common import BadFile, check_increasing, np

ENDED = ("finished", "guard")  # exit reasons after which a run would end in the same way again
STOPPED = {"version": str, "message": str, "time": float}  # what is said of a run without numbers
SUMMARY = {**STOPPED, "steps": int, "solid_substeps": int, "wall_seconds": float, "threads": int,
           "fluid_left_domain": int, "derived": dict}
WORDS = {str: "a text", int: "a whole number", float: "a number", dict: "an object"}
TABLES = {"probes.csv": "probe_interval", "ledger.csv": "ledger_interval"}
LATE = 1.001  # output intervals that a table may end before its run, with a tolerance for round-off


def is_of(kind, value):
    if isinstance(value, bool):
        return False
    if kind is float:
        return isinstance(value, (int, float)) and math.isfinite(value)
    return isinstance(value, kind)


def need(path, entries, key, kind):
    """An entry of the kind that is needed, of summary.json or of an object in it."""
    if key not in entries:
        raise BadFile(f"{path}: {key} is missing; it should be {WORDS[kind]}")
    if not is_of(kind, entries[key]):
        raise BadFile(f"{path}: {key} is {entries[key]!r:.60}; it should be {WORDS[kind]}")
    return entries[key]


def check_standing(run):
    """Complains of a summary without the state of the run."""
    for key, kind in STOPPED.items():
        need(run.folder / "summary.json", run.summary, key, kind)


def check_ended(run):
    """Complains of what is wrong with a run that has ended."""
    path = run.folder / "summary.json"
    if run.summary.get("exit_reason") not in ENDED:
        raise BadFile(f"{path}: exit_reason is {run.summary.get('exit_reason', 'missing')}, not "
                      f"{' or '.join(ENDED)}")
    check_standing(run)
    if run.failure():
        return
    for key, kind in SUMMARY.items():
        need(path, run.summary, key, kind)
    if not (run.folder / "case.cfg").is_file():
        raise BadFile(f"{run.folder}: no case.cfg, which says what was run")
    if any(kind == "fluid" for kind, _, _ in run.case()):
        need(path, run.summary["derived"], "c0", float)
    for name in TABLES:
        check_table(run, name)


def interval(run, key):
    """An output interval in s of the effective case."""
    path = run.folder / "case.cfg"
    text = next((keys[key] for kind, _, keys in run.case() if kind == "output" and key in keys),
                None)
    try:
        return float(text.split()[0])
    except (AttributeError, IndexError, ValueError):
        raise BadFile(f"{path}: {key} is {text}; it should be a time in s") from None


def is_written(run, name):
    """Whether the run writes this table: probes.csv only for probes without an interval of their
    own."""
    if name == "ledger.csv":
        return interval(run, TABLES[name]) > 0
    return any(kind == "probe" and (keys.get("interval") or "0").split()[0] == "0"
               for kind, _, keys in run.case())


def check_table(run, name):
    """Complains of a table of a finished run that is missing, incomplete or not numeric."""
    path = run.folder / name
    if not path.exists() and not is_written(run, name):
        return
    table = run.table(name)
    check_increasing(path, "time_s", table["time_s"])
    if name == "ledger.csv":
        for column, values in read_ledger(run).items():
            # Of no solid at all the least det F is inf.
            if column != "det_low" and not np.isfinite(values).all():
                row = np.flatnonzero(~np.isfinite(values))[0]
                raise BadFile(f"{path}, row {row + 1} of the data: {column} is {values[row]}, not "
                              f"a finite "
                              "number")
    end, last = run.summary["time"], table["time_s"][-1]
    if last < end - LATE * interval(run, TABLES[name]):
        raise BadFile(f"{path}: ends at t = {last:.6g} s, though the run has finished at {end:.6g} "
                      f"s; it has "
                      "been cut short")
