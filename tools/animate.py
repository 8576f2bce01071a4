#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes a film of a run's snapshots: MP4 where ffmpeg is there, else GIF."""

import argparse
import shutil
import sys
from pathlib import Path

import runfiles
from plot_fields import arrange, colour_scale, draw_bars, draw_panel, frame, load_panel
from runfiles import BadFile, plt
from snapshots import FIELDS, Snapshots
from matplotlib.animation import FFMpegWriter, PillowWriter

EXAMPLE = """example:
  tools/animate.py runs/gate --fps 10 --window -0.01 0.4 -0.01 0.16
  tools/animate.py runs/a runs/b --field vorticity --out compare.gif
Several runs stand side by side, at the instants of the first. One colour scale for all frames."""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLE,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", nargs="*", metavar="RUN", help="folder of a run")
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
    parser.add_argument("--fps", type=float, default=10, help="frames a second (%(default)s)")
    parser.add_argument("--dpi", type=float, default=150, help="dots an inch (%(default)s)")
    parser.add_argument("--out", metavar="FILE", help=".mp4 (needs ffmpeg) or .gif "
                        "(default: fields.mp4 or fields.gif in the first run's folder)")
    args = parser.parse_args()
    if not args.run:
        parser.print_help()
        sys.exit(1)
    if args.fps <= 0 or args.dpi <= 0:
        parser.error("--fps and --dpi are more than 0")
    if args.window and (args.window[0] >= args.window[1] or args.window[2] >= args.window[3]):
        parser.error("--window needs X0 < X1 and Y0 < Y1")
    return args


def choose_writer(out, fps):
    kind = Path(out).suffix.lower()
    if kind == ".gif":
        return PillowWriter(fps=fps)
    if kind != ".mp4":
        raise BadFile(f"cannot write {out}: the name ends in neither .mp4 nor .gif")
    if not shutil.which("ffmpeg"):
        raise BadFile(f"cannot write {out}: there is no ffmpeg here; install it or choose a .gif")
    # Players want an even number of pixels and this layout of colours.
    return FFMpegWriter(fps=fps, codec="h264", extra_args=["-pix_fmt", "yuv420p", "-vf",
                                                           "pad=ceil(iw/2)*2:ceil(ih/2)*2"])


def main():
    args = arguments()
    runs = runfiles.make_runs(args.run)
    files = [Snapshots(run.folder / "fields.vtkhdf") for run in runs]
    out = args.out or runs[0].folder / f"fields.{'mp4' if shutil.which('ffmpeg') else 'gif'}"
    writer = choose_writer(out, args.fps)
    entries = {"fluid": FIELDS["fluid"][args.field], "solid": FIELDS["solid"][args.solid]}
    last = min(file.times[-1] for file in files)
    times = [time for time in files[0].times if time <= last]
    rows = [[load_panel(run, file, time, entries, quiet=True) for run, file in zip(runs, files)]
            for time in times]
    panels = [panel for row in rows for panel in row]
    given = {"fluid": args.range, "solid": args.solid_range}
    scales = {name: colour_scale(panels, name, entries[name], given[name]) for name in entries}
    scales = {name: scale for name, scale in scales.items() if scale}
    if not scales:
        raise BadFile("the snapshots hold neither fluid nor solid")
    window = args.window or frame(panels)
    figure, axes = arrange(len(runs), len(runs), window)
    draw_bars(figure, scales)
    plt.rcParams["savefig.dpi"] = args.dpi
    try:
        with writer.saving(figure, out, args.dpi):
            for row in rows:
                for place, panel, run in zip(axes, row, runs):
                    for artist in [*place.collections, *place.texts]:
                        artist.remove()
                    draw_panel(place, panel, scales, window)
                    if len(runs) > 1:
                        place.set_title(run.name, pad=4)
                writer.grab_frame()
    except OSError as problem:
        raise BadFile(f"cannot write {out}: {problem}") from None
    print(f"written {out}: {len(rows)} frames, t = {times[0]:g} to {times[-1]:g} s")


if __name__ == "__main__":
    runfiles.run_tool(main)
