#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws what probes recorded against time, for several runs, with the references of their case: a
panel for each unit, displacements above forces."""

import csv
import itertools
from pathlib import Path

import runfiles
from runfiles import BadFile, Reference
from sphfsi import draw_probes

EXAMPLE = """example:
  tools/plot_probes.py runs/gate runs/gate-dp0.5mm --out gate.pdf --csv gate.csv
  tools/plot_probes.py runs/gate --column M1_dy_m --reference lab.csv --label "Lab, test 3"
"""


def arguments(description, example, default, picture):
    parser = runfiles.options(description, example)
    parser.add_argument("run", nargs="*", metavar="RUN", help="folder of a run, or of "
                                                              "tools/refine.py")
    parser.add_argument("--name", action="append", default=[], metavar="TEXT",
                        help="name of the RUN at the same place (default: its folder)")
    parser.add_argument("--column", action="append", default=[], metavar="NAME",
                        help="column of probes.csv, such as M1_dx_m; may be repeated "
                        f"(default: {default})")
    parser.add_argument("--reference", action="append", default=[], metavar="FILE",
                        help="CSV file time_s,value for the first column; may be repeated")
    parser.add_argument("--label", action="append", default=[], metavar="TEXT",
                        help="legend text of the --reference at the same place")
    parser.add_argument("--from", type=float, default=0, metavar="TIME", dest="start",
                        help="draw and compare from this time on, in s")
    parser.add_argument("--out", metavar="FILE", help="picture, .png or .pdf "
                        f"(default: {picture} in the first folder)")
    parser.add_argument("--csv", metavar="FILE", help="write the table, in SI units")
    args = runfiles.parse(parser)
    if len(args.label) > len(args.reference):
        parser.error("--label without its --reference")
    return args


def print_table(rows, units):
    """A line for each run and reference; values in the unit of the figure, times in s."""
    print(f"{'run':<20} {'reference':<20} {'column':<10} {'points':>6} {'unit':>5} {'RMS':>9}"
          f" {'peak':>9} {'at':>8} {'ref.peak':>9} {'at':>8} {'diff.':>9} {'at':>9}")
    for run, ref, result in rows:
        head = f"{run.label():<20} {ref.name:<20} {ref.probe:<10}"
        if result is None:
            print(head, "no time in common")
            continue
        scale, unit = units[ref.probe]
        points, *numbers = [result[key] * (1 if "time" in key or key == "points" else scale)
                            for key in draw_probes.RESULTS]
        print(head, f"{points:6d} {unit:>5} {numbers[0]:9.4g}",
              *(f"{number:{form}}" for number, form in zip(
                  numbers[1:], ("9.4g", "8.4g", "9.4g", "8.4g", "+9.3g", "+9.3g"))))


def write_csv(path, rows):
    try:
        with open(path, "w", newline="", encoding="utf-8") as file:
            out = csv.writer(file, lineterminator="\n")
            out.writerow(["run", "reference", "column", *draw_probes.RESULTS])
            for run, ref, result in rows:
                if result is not None:
                    out.writerow([run.label(), ref.name, ref.probe,
                                  *(f"{result[key]:.9g}" for key in draw_probes.RESULTS)])
    except OSError as problem:
        raise BadFile(f"cannot write {path}: {problem.strerror}") from None


def plot(args, choose, draw, picture):
    """`choose` gives the columns to draw, `draw` the figure and the units of its columns."""
    runs = runfiles.make_runs(args.run)
    for run, name in zip(runs, args.name):
        run.name = name
    tables = [run.curves() for run in runs]
    refs = draw_probes.case_references(runs)
    columns = choose(runs, tables, refs, args.column)
    refs += [Reference(columns[0], path, Path(path).stem, label or Path(path).stem, sort=True)
             for path, label in itertools.zip_longest(args.reference, args.label)]
    curves = {column: [(run, time[time >= args.start], value[time >= args.start])
                       for run, time, value in found]
              for column, found in draw_probes.curves_of(runs, tables, columns).items()}
    for run, time, _ in itertools.chain.from_iterable(curves.values()):
        if not len(time):
            raise BadFile(f"{run.folder}: ends before {args.start:g} s")
    figure, units = draw(columns, curves, refs)
    rows = [(run, ref, draw_probes.compare(time, value, ref)) for column in columns
            for run, time, value in curves[column] for ref in refs if ref.probe == column]
    if rows:
        print_table(rows, units)
    if args.csv:
        write_csv(args.csv, rows)
    runfiles.save(figure, args.out or Path(args.run[0]) / picture)


def main():
    args = arguments(__doc__, EXAMPLE, "all", "probes.png")
    plot(args, draw_probes.all_columns, draw_probes.draw_panels, "probes.png")


if __name__ == "__main__":
    runfiles.run_tool(main)
