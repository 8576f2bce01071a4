#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes a film of a run's snapshots: MP4 where ffmpeg is there, else GIF."""

import argparse
import shutil
from pathlib import Path

import runfiles
from plot_fields import (add_look, arrange, check_look, chosen_fields, common_scales, draw_bars, draw_panel,
                         frame, load_panel)
from runfiles import BadFile, plt
from snapshots import Snapshots
from matplotlib.animation import FFMpegWriter, PillowWriter

EXAMPLE = """example:
  tools/animate.py runs/gate --fps 10 --window -0.01 0.4 -0.01 0.16
  tools/animate.py runs/a runs/b --field vorticity --out compare.gif
Several runs stand side by side, at the instants of the first. One colour scale for all frames."""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLE,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", nargs="*", metavar="RUN", help="folder of a run")
    add_look(parser)
    parser.add_argument("--fps", type=float, default=10, help="frames a second (%(default)s)")
    parser.add_argument("--dpi", type=float, default=150, help="dots an inch (%(default)s)")
    parser.add_argument("--out", metavar="FILE", help=".mp4 (needs ffmpeg) or .gif "
                        "(default: fields.mp4 or fields.gif in the first run's folder)")
    args = parser.parse_args()
    check_look(parser, args)
    if args.fps <= 0 or args.dpi <= 0:
        parser.error("--fps and --dpi are more than 0")
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
    entries = chosen_fields(args)
    last = min(file.times[-1] for file in files)
    times = [time for time in files[0].times if time <= last]
    rows = [[load_panel(run, file, time, entries, quiet=True) for run, file in zip(runs, files)]
            for time in times]
    panels = [panel for row in rows for panel in row]
    scales = common_scales(panels, entries, args)
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
