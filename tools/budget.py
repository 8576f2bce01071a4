#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Says which is the finest dp that runs within a wall time, and what a few round dp cost.

example: tools/budget.py 10min cases/gate.cfg --threads 2"""

from runfiles import add_case, make_case, options, run_tool, seconds


def main():
    parser = options(__doc__)
    parser.add_argument("time", type=seconds, metavar="TIME", help="wall time: 90s, 10min, 2h")
    add_case(parser)
    args = parser.parse_args()
    make_case(args.case, args.set).budget(args.time, until=args.until, threads=args.threads,
                                          notes=print)


if __name__ == "__main__":
    run_tool(main, failure=2)
