#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs a case in several resolutions, coarsest first, and prints what probes and energies converge
to, with order and error band; finished runs are not run again. Results: DIR/dp-*/ and
DIR/refine.json.

example: tools/refine.py cases/gate.cfg -n 3 --set dp=2mm --until 50ms"""

from casetool import Parser, make_case, number, run_tool


def main():
    parser = Parser(__doc__)
    parser.add_argument("-n", dest="runs", type=number(3, 6, int), default=3, metavar="N",
                        help="resolutions, from 3 to 6 (%(default)s)")
    parser.add_argument("--ratio", type=number(1.1, 4), default=2.0, metavar="R",
                        help="of neighbouring resolutions, from 1.1 to 4 (%(default)g)")
    parser.add_case()
    parser.add_argument("--out", metavar="DIR", help="folder of the results (runs/<case name>)")
    parser.add_argument("--quiet", action="store_true", help="only warnings and the table")
    args = parser.parse_args()
    make_case(args).refine(args.out, runs=args.runs, ratio=args.ratio, until=args.until,
                           threads=args.threads, progress=not args.quiet,
                           notes=None if args.quiet else print, results=print)


if __name__ == "__main__":
    run_tool(main)
