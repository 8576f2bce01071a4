#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs a case over spacing, kernel, speed of sound and time step. For every probe's peak, mean,
frequency and impulse it prints the orders, the limit and a band of 90 % for the case's own
resolution. The plan and its cost come first; finished runs are not run again. Results: DIR/*/ and
DIR/refine.json.

examples: tools/refine.py cases/gate.cfg --set dp=2mm --until 50ms --plan
          tools/refine.py cases/gate.cfg --set dp=2mm --until 50ms --without step"""

from runfiles import add_case, make_case, number, options, run_tool, until


def main():
    from sphfsi.refine import DIRECTIONS, MAX_RUNS, REPEATS  # needs the library
    parser = options(__doc__)
    parser.add_argument("-n", dest="runs", type=number(3, MAX_RUNS, int), default=3, metavar="N",
                        help=f"spacings, from 3 to {MAX_RUNS} (%(default)s); the case's is the "
                             "finest")
    parser.add_argument("--ratio", type=number(1.1, 4), metavar="R",
                        help="of neighbouring spacings, from 1.1 to 4 (the largest of 2, 1.5 and "
                             "1.25 that fits the bodies)")
    parser.add_argument("--without", default="", metavar="DIRECTIONS",
                        help=f"do not vary these: {','.join(DIRECTIONS)}; sound where its speed is "
                             "physical")
    parser.add_argument("--repeats", type=number(2, len(REPEATS), int), default=3, metavar="N",
                        help="runs that differ by what has no consequence (%(default)s)")
    parser.add_argument("--from", dest="start", type=until, metavar="TIME",
                        help="measure from this time on (mean: the last quarter, others: all)")
    parser.add_argument("--plan", action="store_true", help="only print the runs and their cost")
    add_case(parser)
    parser.add_argument("--out", metavar="DIR", help="folder of the results (runs/<case name>)")
    parser.add_argument("--quiet", action="store_true", help="only warnings and the table")
    args = parser.parse_args()
    study = make_case(args.case, args.set).refinement(
        args.out, runs=args.runs, ratio=args.ratio, until=args.until, threads=args.threads,
        start=args.start, without=list(filter(None, args.without.split(","))),
        repeats=args.repeats, notes=(lambda _: None) if args.quiet else print)
    if args.plan or not args.quiet:
        study.plan(print)
    if not args.plan:
        study.run(not args.quiet)
        study.report(print)


if __name__ == "__main__":
    run_tool(main, failure=2)
