#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes a film of a run's snapshots: MP4 where ffmpeg is there, else GIF."""

import runfiles
from plot_fields import add_look, chosen_fields, chosen_ranges, parse_look
from sphfsi import draw_fields
from sphfsi.snapshots import Snapshots

EXAMPLE = """example:
  tools/animate.py runs/gate --fps 10 --window -0.01 0.4 -0.01 0.16
  tools/animate.py runs/a runs/b --field vorticity --out compare.gif
Several runs stand side by side, at the instants of the first. One colour scale for all frames."""


def arguments():
    parser = runfiles.options(__doc__, EXAMPLE)
    parser.add_argument("run", nargs="*", metavar="RUN", help="folder of a run")
    add_look(parser)
    parser.add_argument("--fps", type=float, default=10, help="frames a second (%(default)s)")
    parser.add_argument("--dpi", type=float, default=150, help="dots an inch (%(default)s)")
    parser.add_argument("--out", metavar="FILE", help=".mp4 (needs ffmpeg) or .gif "
                        "(default: fields.mp4 or fields.gif in the first run's folder)")
    args = parse_look(parser)
    if args.fps <= 0 or args.dpi <= 0:
        parser.error("--fps and --dpi are more than 0")
    return args


def main():
    args = arguments()
    runs = runfiles.make_runs(args.run)
    files = [Snapshots(run.folder / "fields.vtkhdf") for run in runs]
    out = args.out or draw_fields.film_path(runs[0])
    times = draw_fields.film(runs, files, chosen_fields(args), chosen_ranges(args), out,
                             window=args.window, fps=args.fps, dpi=args.dpi)
    print(f"written {out}: {len(times)} frames, t = {times[0]:g} to {times[-1]:g} s")


if __name__ == "__main__":
    runfiles.run_tool(main)
