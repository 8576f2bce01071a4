# SPDX-License-Identifier: MIT
"""What tools/verify_*.py share: a finished run with its tables and times, numbers in a report."""
import csv
import json
import math
import os
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = os.environ.get("SPHFSI", str(ROOT / "sphfsi"))


class Run:
    """A finished run on one thread: its tables, its particle spacing, the seconds of processor time that it
    took, and whether a guard stopped it."""

    def __init__(self, case, settings, folder):
        self.folder = Path(folder)
        command = [PROGRAM, str(case), "--quiet", "--threads", "1", "--out", str(folder)]
        for setting in settings:
            command += ["--set", setting]
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        if done.returncode not in (0, 2):
            sys.exit(f"{Path(sys.argv[0]).stem}: {' '.join(command)}: {done.stderr.strip()}")
        self.stopped = done.returncode == 2
        top = json.loads((self.folder / "summary.json").read_text(encoding="utf-8"))["parameters"]
        self.dp, self.end_time = top["dp"], top["end_time"]

    def table(self, name="probes.csv"):
        with open(self.folder / name, encoding="utf-8") as file:
            rows = list(csv.reader(file))
        return {column: np.array([float(row[k] or "nan") for row in rows[1:]])
                for k, column in enumerate(rows[0])}


def case_of(scene, folder):
    """The case of a scene: of cases/verify, of cases, or a template, which is written to the folder."""
    for path in (ROOT / "cases" / "verify" / f"{scene}.cfg", ROOT / "cases" / f"{scene}.cfg"):
        if path.is_file():
            return path
    path = Path(folder) / f"{scene}.cfg"
    text = subprocess.run([PROGRAM, "--new", scene], capture_output=True, text=True, check=True).stdout
    path.write_text(text, encoding="utf-8")
    return path


def program_version():
    run = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, check=True)
    return run.stdout.splitlines()[0]


def number(value):
    if math.isnan(value):
        return "stopped"
    return str(value) if isinstance(value, int) else f"{value:.3g}"


def kept(value, limit):
    return limit is None or abs(value) <= limit


def cell(value, limit):
    """A number of a table, in brackets where it misses its limit."""
    return number(value) if kept(value, limit) else f"({number(value)})"
