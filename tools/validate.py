#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the paper's five cases and the verification cases, and writes docs/validation.md.

Runs that are finished, of the same effective case and program version, are not repeated; interrupted
ones go on from their checkpoint. Without --quick the paper's resolutions are run: many hours.
Example: tools/validate.py --quick --jobs 2; tools/validate.py --only gate --no-report
"""

import argparse
import os
from pathlib import Path

from runfiles import run_tool
from validation_report import write_report
from validation_runs import ROOT, SPECS, Runner


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="the coarse selection only")
    parser.add_argument("--only", default="", metavar="NAME,...",
                        help="only runs whose names begin with one of these, in this order")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1,
                        help="runs at a time, a thread each (default: %(default)s)")
    parser.add_argument("--program", type=Path, default=ROOT / "sphfsi", help="default: ./sphfsi")
    parser.add_argument("--any-version", action="store_true",
                        help="take finished runs of other versions as they are; the report says which")
    parser.add_argument("--no-run", action="store_true", help="only write the report")
    parser.add_argument("--no-report", action="store_true", help="only run")
    return parser.parse_args()


def chosen(args):
    specs = [spec for spec in SPECS if spec.quick or not args.quick]
    if not args.only:
        return specs
    return list(dict.fromkeys(spec for name in args.only.split(",") for spec in specs
                              if spec.name.startswith(name)))


def main():
    args = arguments()
    failed = {}
    if not args.no_run:
        runner = Runner(args.program.resolve(), args.any_version)
        runner.run_all(chosen(args), max(1, args.jobs))
        failed = runner.failed
    if not args.no_report:
        write_report(ROOT / "docs", failed)
    return 0


if __name__ == "__main__":
    run_tool(main)
