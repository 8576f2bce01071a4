# SPDX-License-Identifier: MIT
"""Draws snapshots: the fluid and the solid coloured by a field, to scale."""
from __future__ import annotations

import shutil
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FFMpegWriter, PillowWriter
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize

from .files import BadFile
from .snapshots import KINDS, field_values
from .style import WIDTH, scaled_unit

TALLEST = 9.0  # inches: a page
WALL_COLOUR = "0.75"


def load_panel(run, snapshots, time, entries):
    """What one panel shows: for each kind the positions, bodies and values to colour by."""
    step, dp = snapshots.nearest(time), run.spacing()
    panel = {"time": snapshots.times[step], "step": step, "dp": dp, "failure": run.failure()}
    kinds, bodies, points = (snapshots.load(step, name) for name in ("kind", "body", "Points"))
    line = np.zeros(len(kinds), bool)
    panel["beams"] = []
    if snapshots.has("thickness"):  # of beams; NaN: only stiffness and mass are given
        thickness = snapshots.load(step, "thickness")
        line = thickness != 0
        for body in np.unique(bodies[line]):
            here = line & (bodies == body)
            panel["beams"].append((points[here, :2].astype(float),
                                   np.nan_to_num(thickness[here][0])))
    for name, number in KINDS.items():
        here = (kinds == number) & ~line
        x = points[here, :2].astype(float)
        panel[name] = {"x": x, "body": bodies[here], "value": np.empty(0)}
        if name in entries and len(x):
            data = snapshots.load(step, entries[name][0])[here]
            panel[name]["value"] = field_values(entries[name], data, x, dp)
    return panel


def colour_scale(panels, name, entry, given):
    """Colours common to all panels, or None where no panel has such particles."""
    values = np.concatenate([panel[name]["value"] for panel in panels])
    values = values[np.isfinite(values)]
    if not len(values):
        return None
    _, unit, label, colours, middle = entry
    # Single particles at an impact would take all the colours otherwise.
    lo, hi = np.percentile(values, [0.5, 99.5])
    if given:
        lo, hi = given
    elif middle:
        hi = max(abs(lo), abs(hi))
        lo = -hi
    elif label != "density" and hi > 0 and lo > -0.2 * hi:
        lo = 0.0
    if hi <= lo:
        hi = lo + (1e-3 * abs(lo) or 1.0)
    factor, unit = scaled_unit(unit, max(abs(lo), abs(hi)))
    slack = 0.005 * (hi - lo)
    extend = {(False, False): "neither", (True, False): "min", (False, True): "max",
              (True, True): "both"}[bool((values < lo - slack).any()),
                                    bool((values > hi + slack).any())]
    return {"norm": Normalize(lo * factor, hi * factor), "factor": factor, "cmap": colours,
            "label": f"{name.capitalize()}: {label} ({unit})", "extend": extend}


def frame(panels):
    """Box around all particles but the fluid's outermost 0.1 %, which may be single drops."""
    cut = {"fluid": 0.1, "wall": 0, "solid": 0}
    boxes = np.array([np.percentile(panel[name]["x"], [cut[name], 100 - cut[name]], axis=0)
                      for panel in panels for name in KINDS if len(panel[name]["x"])] +
                     [(x.min(axis=0), x.max(axis=0))
                      for panel in panels for x, _ in panel["beams"]])
    pad = 3 * max(panel["dp"] for panel in panels)
    (x0, y0), (x1, y1) = boxes[:, 0].min(axis=0) - pad, boxes[:, 1].max(axis=0) + pad
    return x0, x1, y0, y1


def draw_outline(axes, x, dp, **style):
    """Outline of one body: where its particles, smeared over a fine grid, fill half of the area."""
    if not len(x):
        return
    step = dp / 2
    corner = x.min(axis=0) - 4 * step
    size = np.ceil((x.max(axis=0) - corner) / step).astype(int) + 5
    near = np.floor((x - corner) / step).astype(int)
    share = np.zeros(size[0] * size[1])
    for node in (near + (i, j) for i in range(-2, 4) for j in range(-2, 4)):
        distance2 = (((node * step + corner - x) / dp) ** 2).sum(axis=1)
        # Gaussians of variance dp^2/4 on a lattice of spacing dp add up to nearly one everywhere.
        share += np.bincount(node[:, 0] * size[1] + node[:, 1],
                             np.exp(-2 * distance2) * 2 / np.pi, len(share))
    axes.contour(corner[0] + step * np.arange(size[0]), corner[1] + step * np.arange(size[1]),
                 share.reshape(size).T, [0.5],
                 **{"colors": "black", "linewidths": 0.5, "zorder": 4, **style})


def draw_beam(axes, x, thickness):
    """A beam to scale, at least a hairline, along the places on its line in their order."""
    step = np.diff(x, axis=0)
    length = np.hypot(*step.T)
    parts = length > 1e-3 * length.max()
    start, step = x[:-1][parts], step[parts]
    side = step @ [[0, 1], [-1, 0]] * (0.5 * thickness / length[parts])[:, None]
    faces = np.stack([start - side, start + step - side, start + step + side, start + side], axis=1)
    axes.add_collection(PolyCollection(faces, linewidths=0.5, edgecolor="black",
                                       facecolor="black", zorder=4))


def draw_panel(axes, panel, scales, window):
    """Particles to scale, as pixels also in a PDF, and the outlines of walls and bodies."""
    dp = panel["dp"]
    turn = 2 * np.pi * (np.arange(8) + 0.5) / 8
    # Discs of area dp^2 leave gaps; octagons of this radius just close those of a lattice.
    octagon = 0.72 * dp * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    for order, name in enumerate(("wall", "fluid", "solid")):
        x = panel[name]["x"]
        seen = ((x > np.array(window[::2]) - 4 * dp) & (x < np.array(window[1::2]) + 4 * dp)) \
            .all(axis=1)
        x = x[seen]
        discs = PolyCollection(x[:, None] + octagon, linewidths=0, antialiased=False,
                               rasterized=True, facecolor=WALL_COLOUR, zorder=order)
        scale = scales.get(name)
        if scale:
            discs.set(array=scale["factor"] * panel[name]["value"][seen], cmap=scale["cmap"],
                      norm=scale["norm"])
        axes.add_collection(discs)
        if name == "fluid":  # its free surface, and where it leaves walls and bodies
            draw_outline(axes, x, dp, colors="0.3", linewidths=0.3, zorder=1.5)
        else:
            bodies = panel[name]["body"][seen]
            for body in np.unique(bodies):
                draw_outline(axes, x[bodies == body], dp)
    for beam in panel["beams"]:
        draw_beam(axes, *beam)
    axes.set(xlim=window[:2], ylim=window[2:])
    words = f"$t$ = {panel['time']:.4g} s" + (f"\n{panel['failure']}" if panel["failure"] else "")
    axes.text(0.985, 0.96, words, transform=axes.transAxes, ha="right", va="top", zorder=5,
              bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.5})


def arrange(runs, panels, window):
    """Figure and axes of equal scale. Several runs are columns and their instants rows; the
    instants of one run lie in as many columns as suit a page."""
    aspect = (window[3] - window[2]) / (window[1] - window[0])
    left, right, bottom, bars, gap, row_gap = 0.72, 0.2, 0.45, 0.62, 0.3, 0.14
    top = 0.25 if runs > 1 else 0.1  # the names of the runs

    def width_with(columns):
        rows = -(-panels // columns)
        wide = (WIDTH - left - right - gap * (columns - 1)) / columns
        return min(wide, (TALLEST - top - bottom - bars - row_gap * (rows - 1)) / rows / aspect)

    # Few rows are worth somewhat smaller panels.
    columns = runs if runs > 1 else max(range(1, panels + 1),
                                        key=lambda n: width_with(n) / (-(-panels // n)) ** 0.6)
    rows, wide = -(-panels // columns), width_with(columns)
    tall = wide * aspect
    height = top + bottom + bars + row_gap * (rows - 1) + tall * rows
    total = left + right + gap * (columns - 1) + wide * columns
    total = max(total, 3.6)  # room for the colour bars
    figure, axes = plt.figure(figsize=(total, height)), []
    for k in range(panels):
        row, column = divmod(k, columns)
        axes.append(figure.add_axes([(left + column * (wide + gap)) / total,
                                     (bottom + bars + (rows - 1 - row) * (tall + row_gap)) / height,
                                     wide / total, tall / height]))
        last = k + columns >= panels
        axes[-1].tick_params(labelbottom=last, labelleft=column == 0, direction="out",
                             top=False, right=False)
        axes[-1].locator_params(nbins=max(3, int(wide / 0.75)), axis="x")
        axes[-1].locator_params(nbins=max(2, int(tall / 0.35)), axis="y")
        axes[-1].set_xlabel("$x$ (m)" if last else "")
        axes[-1].set_ylabel("$y$ (m)" if column == 0 else "")
    return figure, axes


def draw_bars(figure, scales):
    """The colour bars side by side at the bottom."""
    height, share = figure.get_size_inches()[1], 0.84 / len(scales)
    for k, scale in enumerate(scales.values()):
        axes = figure.add_axes([0.1 + k * share, 0.42 / height, share - 0.06, 0.1 / height])
        bar = figure.colorbar(ScalarMappable(scale["norm"], scale["cmap"]), cax=axes,
                              orientation="horizontal", extend=scale["extend"])
        bar.set_label(scale["label"], labelpad=1)
        bar.locator = plt.MaxNLocator(5)
        bar.update_ticks()


def common_scales(panels, entries, given):
    """One scale of colours for all panels, of each kind that they hold."""
    scales = {name: colour_scale(panels, name, entries[name], given.get(name)) for name in entries}
    scales = {name: scale for name, scale in scales.items() if scale}
    if not scales:
        raise BadFile("the snapshots hold neither fluid nor solid")
    return scales


def instants(files, times=None):
    """Instants to draw: the nearest snapshots to the times (s), each once; without times four over
    the run, of several runs the last."""
    last = min(file.times[-1] for file in files)
    quarters = [files[0].nearest(last * k / 4) for k in (1, 2, 3, 4)]
    # Of a run that ended early several instants have the same nearest snapshot.
    times = times and list({files[0].nearest(time): time
                            for time in reversed(times)}.values())[::-1]
    return times or ([last] if len(files) > 1 else files[0].times[np.unique(quarters)])


def draw_rows(runs, panels, scales, window):
    """A row of panels for each instant, a column for each of several runs."""
    figure, axes = arrange(len(runs), len(panels), window)
    for place, panel in zip(axes, panels):
        draw_panel(place, panel, scales, window)
    if len(runs) > 1:
        for place, run in zip(axes, runs):
            place.set_title(run.name, pad=4)
    draw_bars(figure, scales)
    return figure


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


def film_path(run):
    """Where the film of a run goes: MP4 where ffmpeg is there, else GIF."""
    return run.folder / f"fields.{'mp4' if shutil.which('ffmpeg') else 'gif'}"


def film(runs, files, entries, given, out, *, window=None, fps=10.0, dpi=150.0):
    """Writes a film of all snapshots, at the instants of the first run; returns these."""
    writer = choose_writer(out, fps)
    last = min(file.times[-1] for file in files)
    times = [time for time in files[0].times if time <= last]
    rows = [[load_panel(run, file, time, entries) for run, file in zip(runs, files)]
            for time in times]
    panels = [panel for row in rows for panel in row]
    scales = common_scales(panels, entries, given)
    window = window or frame(panels)
    figure, axes = arrange(len(runs), len(runs), window)
    draw_bars(figure, scales)
    try:
        with plt.rc_context({"savefig.dpi": dpi}), writer.saving(figure, out, dpi):
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
    plt.close(figure)
    return times
