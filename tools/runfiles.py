# SPDX-License-Identifier: MIT
"""What all tools share: the package of this clone, options, the style of figures, exit status."""

import argparse
import re
import shlex
import sys
import warnings
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
UNITS = {"s": 1, "ms": 1e-3, "us": 1e-6, "min": 60, "h": 3600}


# --- options ---
class Parser(argparse.ArgumentParser):
    """A wrong option ends a tool with exit status 1, as it ends the program."""

    def error(self, message):
        self.exit(1, f"{self.prog}: {message}; --help lists the options\n")


def options(text, example=""):
    """A parser that shows both as they are written."""
    return Parser(description=text, epilog=example,
                  formatter_class=argparse.RawDescriptionHelpFormatter)


def parse(parser):
    """The arguments; without a run the help is shown."""
    args = parser.parse_args()
    if not args.run:
        parser.print_help()
        sys.exit(1)
    return args


def number(low, high, kind=float):
    """The type of an option that takes a number from `low` to `high`."""
    word = "whole number" if kind is int else "number"

    def convert(text):
        try:
            value = kind(text)
        except ValueError:
            value = None
        if value is None or not low <= value <= high:
            raise argparse.ArgumentTypeError(f"'{text}': give a {word} from {low} to {high}")
        return value
    return convert


def seconds(text, example="90s, 10min or 2h"):
    """A time with its unit."""
    found = re.fullmatch(r"\s*([\d.]+(?:[eE][+-]?\d+)?)\s*(s|ms|us|min|h)\s*", text)
    value = float(found[1]) * UNITS[found[2]] if found else 0
    if not 0 < value <= 1e9:
        raise argparse.ArgumentTypeError(f"'{text}': give a time such as {example}")
    return value


def until(text):
    """A simulated time: without a unit it is in s."""
    bare = re.fullmatch(r"\s*[\d.]+(?:[eE][+-]?\d+)?\s*", text)
    return seconds(text + "s" if bare else text, "0.5, 0.5s or 500ms")


def add_case(parser):
    """The options of a tool that runs a case."""
    parser.add_argument("case", metavar="CASE", help="case file")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                        help="replace a value of the case: dp=1mm, gate.young=12MPa; repeatable")
    parser.add_argument("--until", type=until, default=0.0, metavar="TIME",
                        help="simulated time to end at, in s or as 50ms (end_time of the case)")
    parser.add_argument("--threads", type=number(1, 2**31 - 1, int), default=0, metavar="N",
                        help="threads to use (as many as are useful)")


def make_case(path, settings):
    from sphfsi import Case, InputError  # needs the library
    changes = {}
    for text in settings:
        key, equals, value = text.partition("=")
        if not equals:
            raise InputError(f"--set {text}: give key=value or section.key=value")
        changes[key] = value
    return Case(path, **changes)


# --- ends ---
def run_tool(main, failure=1):
    """Runs main() of a tool. What is wrong becomes one sentence and an exit status: 1 for a wrong
    input or a missing library, `failure` for a broken file or a run that did not end well."""
    name = Path(sys.argv[0]).stem
    plt.rcParams.update(STYLE)
    warnings.simplefilter("always", UserWarning)
    warnings.showwarning = lambda message, *_: print(f"warning: {message}", file=sys.stderr)
    try:
        sys.exit(main())
    except KeyboardInterrupt as stop:
        print(f"{name}: {stop or 'interrupted'}", file=sys.stderr)
        sys.exit(130)
    except (Error, OSError, MemoryError) as problem:
        print(f"{name}: {str(problem).removeprefix(name + ': ')}", file=sys.stderr)
        broken = isinstance(problem, (BadFile, ArithmeticError, OSError, MemoryError))
        sys.exit(failure if broken else 1)


def save(figure, path):
    try:
        figure.savefig(path)
    except (OSError, ValueError) as problem:
        raise BadFile(f"cannot write {path}: {problem}") from None
    print(f"written {path}")
