#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the paper's five cases and the verification cases, and writes docs/results/validation.md.

Runs that are finished, of the same effective case and program, are not repeated; interrupted ones
go on from their checkpoint. Without --quick the paper's resolutions are run: many hours. With
--keep, what the report reads of the longer runs goes to docs/results/validation/NAME.zip as they
end, without the snapshots, and counts as run from then on, on any machine and with any version,
until its case changes. Examples:

  tools/report/validation.py --quick --jobs 2
  tools/report/validation.py --only gate,=plate --no-report --keep
"""

import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from common import OUT, options, run_tool
from validation_kept import FOLDER as KEPT, Kept
from validation_report import write_report
from validation_runs import FOLDER, JOBS, Runner, chosen

def arguments():
    parser = options(__doc__)
    parser.add_argument("--quick", action="store_true", help="the coarse selection only")
    parser.add_argument("--only", default="", metavar="NAME,...",
                        help="only runs whose names begin with one of these, in this order; =NAME "
                             "means that run alone")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1,
                        help="runs at a time, a thread each (default: %(default)s)")
    parser.add_argument("--runs", type=Path, default=FOLDER, metavar="DIR",
                        help="where the runs are (default: runs/validation)")
    parser.add_argument("--any-version", action="store_true",
                        help="take finished runs of other versions; the report says which")
    parser.add_argument("--again", action="store_true", help="run also what is kept")
    parser.add_argument("--keep", action="store_true", help="keep the results of the longer runs; "
                        "with --no-run of those that have ended")
    parser.add_argument("--no-run", action="store_true", help="only write the report")
    parser.add_argument("--no-report", action="store_true", help="only run")
    return parser.parse_args()


def main():
    args = arguments()
    jobs = chosen(args.only, args.quick)
    for job in JOBS:
        job.folder = args.runs.resolve() / job.name
    runner = Runner(Kept(KEPT), args.any_version, args.again, args.keep)
    with ThreadPoolExecutor(1 if args.no_run else max(1, args.jobs)) as pool:
        list(pool.map(runner.store if args.no_run else runner.run, jobs))
    wrong = [] if args.no_report else write_report(OUT, runner.failed, runner.kept)
    for line in wrong:
        print(f"validate: {line}", file=sys.stderr)
    return bool(wrong)


if __name__ == "__main__":
    run_tool(main)
