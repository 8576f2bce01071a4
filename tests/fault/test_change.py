#!/usr/bin/env python3
"""Every key of a case changed, one at a time, at a restart and at a fork of a run.

A restart refuses every change but those of end_time and [output], by name; a fork takes it or
refuses it by name. Neither crashes, hangs, writes over the run or goes on with a state that a guard
stops at once."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SPHFSI = os.path.realpath(os.environ.get("SPHFSI", "./sphfsi"))
CASE = "tests/fault/tiny.cfg"
failures = []


def run(*arguments):
    result = subprocess.run([SPHFSI, CASE, "--quiet", "--threads", "1", *arguments], timeout=60,
                            capture_output=True, text=True)
    said = [line for line in result.stderr.splitlines() if line.startswith("sphfsi: ")]
    return result.returncode, said[0] if said else ""


def choices():
    """The words that a key of a choice may have."""
    table = Path("src/case/params.def").read_text()
    rows = re.findall(r'^CHOICE\((\w+), *(\w+), *\w+, *"([^"]*)"', table, re.M)
    words = {(section, key): names.split("|") for section, key, names in rows}
    words |= {(section, "side"): words["section", "side"] for section in ("inflow", "outflow")}
    return words


def changed(section, key, value, words):
    """Another value for the key, or None where there is none to try."""
    known = words.get((section, key))
    if known:
        return next(word for word in known if word != value)
    number = re.match(r"-?[0-9.]+(e[-+]?\d+)?", value)
    if not number or not re.search(r"[0-9]", value):
        return None
    x = float(number[0])
    return value.replace(number[0], "1" if key == "verlet_reset" else repr(x * 1.1 if x else 0.1),
                         1)


def keys(case):
    """(section for --set, kind of section, key, value) of each line of an effective case."""
    section, kind = "", "top"
    for line in case.read_text().splitlines():
        head = re.match(r"\[(\w+)(?: (.*))?\]", line)
        pair = re.match(r"(\w+) = (.*)", line)
        if head:
            kind, section = head[1], (head[2] or head[1]) + "."
        elif pair and kind != "constants":
            yield section, kind, pair[1], pair[2]


def main():
    with tempfile.TemporaryDirectory(dir="/dev/shm" if os.access("/dev/shm", os.W_OK)
                                     else None) as top:
        begun = Path(top, "begun")
        status, said = run("--out", str(begun), "--until", "0.002")
        if status:
            sys.exit(f"the run itself: {said}")
        before = {path.name: path.read_bytes() for path in begun.iterdir()}
        taken = refused = kept = 0
        words = choices()
        for section, kind, key, value in keys(begun / "case.cfg"):
            new = changed(kind, key, value, words)
            if new is None:
                continue
            change = ["--set", f"{section}{key}={new}"]
            what = f"{section}{key} from {value} to {new}"
            if kind != "output" and key != "end_time":
                status, said = run("--out", str(begun), "--until", "0.002", "--restart", *change)
                kept += 1
                if status != 1 or "has changed" not in said and "cannot change" not in said:
                    # A value that the case itself refuses is refused by its own sentence.
                    if status != 1 or "--set" not in said and "[" not in said:
                        failures.append(f"restart, {what}: exit status {status}: {said}")
                if {path.name: path.read_bytes() for path in begun.iterdir()} != before:
                    failures.append(f"restart, {what}: the run was changed")
            out = Path(top, "fork")
            status, said = run("--out", str(out), "--until", "0.0022", "--fork", str(begun),
                               *change)
            if status == 0:
                taken += 1
            elif status == 1 and said:
                refused += 1
                if out.exists() and any(path.suffix in (".ckpt", ".csv") for path in out.iterdir()):
                    failures.append(f"fork, {what}: refused, and yet it left a run")
            else:
                failures.append(f"fork, {what}: exit status {status}: {said}")
            shutil.rmtree(out, ignore_errors=True)
        if taken < 10 or refused < 5:
            failures.append(f"only {taken} forks taken, {refused} refused")
        print(f"found: {kept} changes refused at a restart; of a fork {taken} taken, {refused} "
              f"refused; "
              f"{len(failures)} failures")
    for failure in failures:
        print("FAILED:", failure)
    return len(failures) > 0


if __name__ == "__main__":
    sys.exit(main())
