#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the paper's five cases and the verification cases, and writes docs/validation.md.

Runs that are finished, of the same effective case and program version, are not repeated;
interrupted ones go on from their checkpoint. Without --quick the paper's resolutions are run: many
hours. With --keep, what the report reads of the longer runs goes to docs/validation/NAME.zip as
they end, without the snapshots, and counts as run from then on, on any machine and with any
version, until its case changes. Runs of the quick selection are not kept: they are run again in
minutes. Example: tools/report/validation.py --quick --jobs 2; tools/report/validation.py --only
gate,=plate --no-report --keep
"""

import argparse
import os
import sys
from pathlib import Path

from common import PROGRAM, BadFile, run_tool
from validation_kept import FOLDER as KEPT, Kept
from validation_report import write_report
from validation_runs import FOLDER as RUNS, ROOT, SPECS, Program, Runner


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="the coarse selection only")
    parser.add_argument("--only", default="", metavar="NAME,...",
                        help="only runs whose names begin with one of these, in this order; =NAME "
                             "means "
                        "that run alone")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1,
                        help="runs at a time, a thread each (default: %(default)s)")
    parser.add_argument("--program", type=Path, default=PROGRAM, help="default: ./sphfsi")
    parser.add_argument("--runs", type=Path, default=RUNS, metavar="DIR",
                        help="where the runs are (default: runs/validation)")
    parser.add_argument("--any-version", action="store_true",
                        help="take finished runs of other versions as they are; the report says "
                             "which")
    parser.add_argument("--again", action="store_true", help="run also what is kept")
    parser.add_argument("--keep", action="store_true",
                        help="keep the results of the longer runs; with --no-run of those that "
                             "have ended")
    parser.add_argument("--no-run", action="store_true", help="only write the report")
    parser.add_argument("--no-report", action="store_true", help="only run")
    return parser.parse_args()


def chosen(only, quick):
    """The runs to do, in order; the longest first where no order is asked for."""
    specs = [spec for spec in SPECS if spec.quick or not quick]
    if not only:
        return sorted(specs, key=lambda spec: -spec.cost)
    found = {}
    for name in only.split(","):
        wanted = [spec for spec in specs
                  if (spec.name == name[1:] if name.startswith("=")
                      else spec.name.startswith(name))]
        if not wanted:
            raise BadFile(f"--only {name}: no run of the selection has this name; "
                          "tools/report/validation_runs.py has the names")
        found.update(dict.fromkeys(wanted))
    return list(found)


def main():
    args = arguments()
    specs = chosen(args.only, args.quick)
    for spec in SPECS:
        spec.folder = args.runs.resolve() / spec.name
    program = Program(args.program.resolve())
    kept = Kept(KEPT, program.means)
    runner = Runner(program, kept, args.any_version, args.again, args.keep)
    if args.no_run:
        for spec in specs:
            runner.store(spec)
    else:
        runner.run_all(specs, max(1, args.jobs))
    wrong = [] if args.no_report else write_report(ROOT / "docs", runner.failed, kept,
                                                   program.version)
    for line in wrong:
        print(f"validate: {line}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    run_tool(main)
