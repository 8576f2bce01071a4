#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws snapshots of runs: the fluid and the solid coloured by a field, to scale."""

import runfiles
from sphfsi import draw_fields
from sphfsi.snapshots import FIELDS, Snapshots

EXAMPLE = """example:
  tools/plot_fields.py runs/gate --time 0.04 0.12 0.2 0.28 --out gate.pdf
  tools/plot_fields.py runs/a runs/b --time 0.12 --field vorticity --window 0 0.3 0 0.15
Several instants and several runs: a row for each instant, a column for each run."""


def add_look(parser):
    """Options of what is drawn and how, for all that draws fields."""
    parser.add_argument("--field", choices=FIELDS["fluid"], default="pressure",
                        help="colours the fluid (default: %(default)s)")
    parser.add_argument("--solid", choices=FIELDS["solid"], default="von_mises",
                        help="colours the solid (default: %(default)s)")
    parser.add_argument("--range", nargs=2, type=float, metavar=("LO", "HI"),
                        help="of the fluid's colours, in SI units (default: from the data)")
    parser.add_argument("--solid-range", nargs=2, type=float, metavar=("LO", "HI"),
                        help="of the solid's colours, in SI units")
    parser.add_argument("--window", nargs=4, type=float, metavar=("X0", "X1", "Y0", "Y1"),
                        help="part of the plane to draw, m (default: all but single drops)")


def parse_look(parser):
    args = runfiles.parse(parser)
    if args.window and (args.window[0] >= args.window[1] or args.window[2] >= args.window[3]):
        parser.error("--window needs X0 < X1 and Y0 < Y1")
    return args


def arguments():
    parser = runfiles.options(__doc__, EXAMPLE)
    parser.add_argument("run", nargs="*", metavar="RUN", help="folder of a run")
    parser.add_argument("--name", action="append", default=[], metavar="TEXT",
                        help="title of the RUN at the same place (default: its folder)")
    parser.add_argument("--time", nargs="+", type=float, metavar="T",
                        help="instants in s; the nearest snapshots are drawn (default: four over "
                        "the run; of several runs the last)")
    add_look(parser)
    parser.add_argument("--out", metavar="FILE", help="picture, .png or .pdf "
                        "(default: fields.png in the first run's folder)")
    return parse_look(parser)


def chosen_fields(args):
    return {"fluid": FIELDS["fluid"][args.field], "solid": FIELDS["solid"][args.solid]}


def chosen_ranges(args):
    return {"fluid": args.range, "solid": args.solid_range}


def main():
    args = arguments()
    runs = runfiles.make_runs(args.run)
    for run, name in zip(runs, args.name):
        run.name = name
    files = [Snapshots(run.folder / "fields.vtkhdf") for run in runs]
    entries, panels = chosen_fields(args), []
    for time in draw_fields.instants(files, args.time):
        for run, file in zip(runs, files):
            panels.append(draw_fields.load_panel(run, file, time, entries))
            print(f"{run.name}: step {panels[-1]['step']}, t = {panels[-1]['time']:g} s "
                  f"(asked for {time:g} s)")
    scales = draw_fields.common_scales(panels, entries, chosen_ranges(args))
    window = args.window or draw_fields.frame(panels)
    figure = draw_fields.draw_rows(runs, panels, scales, window)
    runfiles.save(figure, args.out or runs[0].folder / "fields.png")


if __name__ == "__main__":
    runfiles.run_tool(main)
