# SPDX-License-Identifier: MIT
"""What the tools that run cases share: options, how messages are shown, exit status."""

import argparse
import re
import sys
import warnings
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "python"))
try:
    from sphfsi import Error
except ModuleNotFoundError as missing:
    sys.exit(f"{Path(sys.argv[0]).stem}: {missing.name} is missing in {sys.executable}; "
             f"{ROOT}/tools/setup.sh plot installs it; then run $(cat {ROOT}/build/python) "
             f"{' '.join(sys.argv)}")
try:
    from sphfsi import Case, CaseWarning, InputError, Interrupted
except Error as problem:
    sys.exit(f"{Path(sys.argv[0]).stem}: {problem}")

UNITS = {"s": 1, "ms": 1e-3, "us": 1e-6, "min": 60, "h": 3600}


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


class Parser(argparse.ArgumentParser):
    """Options of a tool; a wrong one ends it with exit status 1, as the program does."""

    def __init__(self, doc):
        super().__init__(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)

    def add_case(self):
        self.add_argument("case", metavar="CASE", help="case file")
        self.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                          help="replace a value of the case: dp=1mm, gate.young=12MPa; repeatable")
        self.add_argument("--until", type=until, default=0.0, metavar="TIME",
                          help="simulated time to end at, in s or as 50ms (end_time of the case)")
        self.add_argument("--threads", type=number(1, 2**31 - 1, int), default=0, metavar="N",
                          help="threads to use (as many as are useful)")

    def error(self, message):
        self.exit(1, f"{self.prog}: {message}; --help lists the options\n")


def make_case(args):
    changes = {}
    for text in args.set:
        key, equals, value = text.partition("=")
        if not equals:
            raise InputError(f"--set {text}: give key=value or section.key=value")
        changes[key] = value
    return Case(args.case, **changes)


def _show(message, *_):
    print(f"warning: {message}", file=sys.stderr)


def run_tool(main):
    """Runs main(); a failure becomes one sentence and the program's exit status: 1 for a wrong
    input."""
    warnings.simplefilter("always", CaseWarning)
    warnings.showwarning = _show
    name = Path(sys.argv[0]).stem
    try:
        sys.exit(main())
    except Interrupted as stop:
        print(f"{name}: {stop}", file=sys.stderr)
        sys.exit(130)
    except (Error, OSError, MemoryError) as problem:
        print(f"{name}: {str(problem).removeprefix(name + ': ')}", file=sys.stderr)
        sys.exit(1 if isinstance(problem, InputError) else 2)
