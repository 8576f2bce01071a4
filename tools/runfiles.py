# SPDX-License-Identifier: MIT
"""Reads the files of a run's folder and holds what all figures share: style, colours, saving."""

import argparse
import shlex
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def remedy():
    """What a user does whose Python lacks a package: another Python that has it, as setup.sh
    records it."""
    record, command = ROOT / "build" / "python", shlex.join(sys.argv)
    python = record.read_text(encoding="utf-8").strip() if record.is_file() else ""
    if python and Path(python).is_file() and python != sys.executable:
        return f"run {shlex.quote(python)} {command}"
    return (f"{shlex.quote(str(ROOT / 'tools' / 'setup.sh'))} plot installs it; then run "
            f"$(cat {shlex.quote(str(record))}) {command}")


# The package as it lies in this clone, installed or not.
sys.path.insert(0, str(ROOT / "python"))
try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
    from sphfsi.files import (BadFile, Error, Reference, Run, make_runs, read_case, read_table,
                              read_text)
    from sphfsi.style import COLOURS, STYLE, WIDTH
except ImportError as missing:
    sys.exit(f"{Path(sys.argv[0]).stem}: {missing.name} is missing in {sys.executable}; {remedy()}")

__all__ = ["COLOURS", "STYLE", "WIDTH", "BadFile", "Reference", "Run", "make_runs", "np", "options",
           "plt", "read_case", "read_table", "read_text", "run_tool", "save"]


def options(text, example=""):
    """A parser that shows both as they are written."""
    return argparse.ArgumentParser(description=text, epilog=example,
                                   formatter_class=argparse.RawDescriptionHelpFormatter)


def parse(parser):
    """The arguments; without a run the help is shown."""
    args = parser.parse_args()
    if not args.run:
        parser.print_help()
        sys.exit(1)
    return args


def run_tool(main):
    """Runs main() of a tool; what is wrong with a file or a case becomes one sentence and exit
    status 1."""
    plt.rcParams.update(STYLE)
    try:
        sys.exit(main())
    except Error as problem:
        sys.exit(f"{Path(sys.argv[0]).stem}: {problem}")


def save(figure, path):
    try:
        figure.savefig(path)
    except (OSError, ValueError) as problem:
        raise BadFile(f"cannot write {path}: {problem}") from None
    print(f"written {path}")
