# SPDX-License-Identifier: MIT
"""Draws what probes recorded against time, with the references of the case."""
from __future__ import annotations

import re
import textwrap

import matplotlib.pyplot as plt
import numpy as np

from .files import BadFile, references
from .style import COLOURS, WIDTH, scaled_unit

WORDS = {"dx": "horizontal displacement", "dy": "vertical displacement", "p": "pressure",
         "vx": "horizontal velocity", "vy": "vertical velocity", "level": "water level",
         "sxx": "stress $\\sigma_{xx}$", "syy": "stress $\\sigma_{yy}$",
         "szz": "stress $\\sigma_{zz}$", "sxy": "stress $\\sigma_{xy}$",
         "mises": "von Mises stress", "front": "front", "q": "flux",
         "fx": "horizontal force", "fy": "vertical force", "mz": "moment",
         "ax": "horizontal acceleration", "ay": "vertical acceleration",
         "Exx": "strain $E_{xx}$", "Eyy": "strain $E_{yy}$", "Exy": "strain $E_{xy}$",
         "cx": "x of the centre", "cy": "y of the centre", "angle": "rotation",
         "kinetic": "kinetic energy", "elastic": "strain energy", "hourglass": "hourglass energy"}
# What the label of a panel calls quantities whose words do not end with it.
KINDS = {"level": "level", "front": "front", "cx": "position", "cy": "position",
         **dict.fromkeys(("sxx", "syy", "szz", "sxy"), "stress"),
         **dict.fromkeys(("Exx", "Eyy", "Exy"), "strain")}
UNITS = {"SI": "SI", "m_per_s": "m/s", "N_per_m": "N/m", "Nm_per_m": "N m/m", "J_per_m": "J/m",
         "m2_per_s": "m²/s", "m_per_s2": "m/s²"}
DASHES = [(0, (5, 2)), (0, (1.5, 1.5)), (0, (6, 1.5, 1.5, 1.5)), (0, (8, 3))]
GREYS = ["0.25", "0.45", "0.35", "0.55"]
MARKERS = "osD^v<>"
LABEL = 24  # characters of a line of a label beside a curve
RESULTS = ["points", "rms", "peak", "peak_time_s", "ref_peak", "ref_peak_time_s",
           "peak_difference", "peak_time_difference_s"]


def choose_columns(runs, tables, refs, asked=()):
    """Columns to draw: those asked for, else those that have references, else the displacement of
    M1."""
    shared = [name for name in tables[0] if all(name in t for t in tables)]
    for run, table in zip(runs, tables):
        for name in asked:
            if name not in table:
                raise BadFile(f"{run.folder}: no column {name} in its probes*.csv; "
                              f"there are {', '.join(table)}")
    named = [name for name in shared if any(ref.probe == name for ref in refs)]
    usual = [name for name in ("M1_dx_m", "M1_dy_m") if name in shared]
    chosen = list(asked) or named or usual or shared[:1]
    if not chosen:
        raise BadFile("the runs have no column of probes.csv in common")
    return chosen


def all_columns(runs, tables, refs, asked=()):
    """Columns to draw: those asked for, else all that the runs have in common."""
    if asked:
        return choose_columns(runs, tables, refs, asked)
    shared = [name for name in tables[0] if all(name in t for t in tables)]
    return shared or choose_columns(runs, tables, refs)


def curves_of(runs, tables, columns):
    """What is finite of each column, {column: [(run, time, value)]}."""
    curves = {column: [] for column in columns}
    for column in columns:
        for run, table in zip(runs, tables):
            time, value = table[column]
            sound = np.isfinite(value)
            if not sound.any():
                raise BadFile(f"{run.folder}: {column} holds no number")
            curves[column].append((run, time[sound], value[sound]))
    return curves


def case_references(runs):
    """References of all cases, each once."""
    refs = [ref for run in runs for ref in references(run)]
    return list({(ref.probe, ref.name, ref.label): ref for ref in refs}.values())


def peak(time, value, sign):
    """The first local peak of that sign within 0.5 % of the largest: one cycle of an oscillation
    is as high as the next up to noise, and the first of them is meant."""
    height = sign * value
    k = int(np.argmax(height >= height.max() - 0.005 * abs(height.max())))
    while k + 1 < len(height) and height[k + 1] >= height[k]:
        k += 1
    return time[k], value[k]


def common(time, ref):
    """The points of a reference within the time of a run."""
    inside = (ref.time >= time[0]) & (ref.time <= time[-1]) & np.isfinite(ref.value)
    return ref.time[inside], ref.value[inside]


def along(time, ref):
    """A computed reference at the times of a run."""
    inside = (time >= ref.time[0]) & (time <= ref.time[-1])
    return time[inside], np.interp(time[inside], ref.time, ref.value)


def compare(time, value, ref):
    """RMS difference and peaks where both curves exist, or None where they do not."""
    t, v = common(time, ref)
    if not len(t):
        return None
    own = (time >= t.min()) & (time <= t.max())
    sign = 1.0 if v[np.argmax(np.abs(v))] >= 0 else -1.0
    run_peak = peak(time[own], value[own], sign) if own.any() else (time[-1], value[-1])
    ref_peak = peak(t, v, sign)
    rms = np.sqrt(np.mean((np.interp(t, time, value) - v) ** 2))
    return dict(zip(RESULTS, (len(t), rms, run_peak[1], run_peak[0], ref_peak[1], ref_peak[0],
                              run_peak[1] - ref_peak[1], run_peak[0] - ref_peak[0])))


def reference_style(refs):
    """Black markers for measurements, grey dashes for computations."""
    measured = [ref for ref in refs if ref.measured]
    computed = [ref for ref in refs if not ref.measured]
    styles = {}
    for k, ref in enumerate(measured):
        styles[ref] = dict(color="black", linestyle="none", marker=MARKERS[k % len(MARKERS)],
                           markersize=3.6, markerfacecolor="white" if k else "black", zorder=4,
                           markeredgewidth=0.8)
    for k, ref in enumerate(computed):
        styles[ref] = dict(color=GREYS[k % len(GREYS)], linestyle=DASHES[k % len(DASHES)], zorder=2)
    return styles


def parts_of(column):
    """Probe, quantity and unit of a column <probe>_<quantity>_<unit>."""
    return re.fullmatch(rf"(.+?)_({'|'.join(WORDS)})_([^_]+(?:_per_[^_]+)?)", column)


def kinds_of(columns):
    """What the columns of a panel show, each once: "displacement", or "stress, pressure"."""
    found = [parts_of(column) for column in columns]
    kinds = [KINDS.get(parts[2], WORDS[parts[2]].split()[-1]) if parts else column
             for parts, column in zip(found, columns)]
    return ", ".join(dict.fromkeys(kinds))


def column_words(column, size):
    """Words for the axis, factor and name of the unit of a column <probe>_<quantity>_<unit>."""
    parts = parts_of(column)
    scale, unit = scaled_unit(parts[3] if parts else "", size)
    words = column
    if parts:  # a probe that is named after its quantity says it once
        named = parts[1].lower().replace("_", " ").endswith(WORDS[parts[2]].lower())
        words = parts[1] if named else f"{parts[1]} {WORDS[parts[2]]}"
    unit = UNITS.get(unit or "SI", unit)
    return f"{words} ({unit})", scale, unit


def draw_loads(axes, run, column, scale, colour):
    """Of a load: its largest means, each over its window, and the largest single row, a ring."""
    load = run.summary.get("loads", {}).get(column)
    if not load:
        return
    for window, mean, start in zip(load["window"], load["largest_mean"], load["from"]):
        if mean is not None:
            axes.plot([start, start + window], [scale * mean] * 2, color=colour, linewidth=3,
                      alpha=0.6, solid_capstyle="butt", zorder=4)
    axes.plot(load["largest_single_row_time"], scale * load["largest_single_row"], "o",
              color=colour, markerfacecolor="none", markersize=5, zorder=5)


def draw_column(above, below, column, curves, refs, legend):
    """One column of the figure: the curves, and below them their differences from the references.
    Adds to `legend` what it draws; gives the factor and name of the unit."""
    words, scale, unit = column_words(column, max(np.abs(value).max() for _, _, value in curves))
    styles = reference_style(refs)
    # Where something was measured, only that is worth a difference.
    judges = [ref for ref in refs if ref.measured] or refs
    for ref in refs:
        line, = above.plot(ref.time, scale * ref.value, **styles[ref])
        legend.setdefault(ref.label, line)
    for k, (run, time, value) in enumerate(curves):
        colour = COLOURS[k % len(COLOURS)]
        # Each is thinner than the one below, so that curves that agree are seen as well.
        width = 1.1 + 2.4 * (1 - k / max(1, len(curves) - 1)) * (len(curves) > 1)
        line, = above.plot(time, scale * value, color=colour, zorder=3, linewidth=width)
        legend[run.label()] = line
        draw_loads(above, run, column, scale, colour)
        if run.failure():
            above.plot(time[-1], scale * value[-1], "x", color=colour, markersize=8,
                       markeredgewidth=2, zorder=5)
        for ref in judges if below else []:
            t, v = common(time, ref) if ref.measured else along(time, ref)
            style = dict(styles[ref], color=colour, markeredgecolor=colour, linewidth=0.8)
            if ref.measured:
                style.update(linestyle="-", markersize=2.6)
                style["markerfacecolor"] = "white" if style["markerfacecolor"] == "white" \
                    else colour
            below.plot(t, scale * (np.interp(t, time, value) - v), **style)
    end = max(time[-1] for _, time, _ in curves)
    above.set(ylabel=words, xlim=(0, 1.02 * end or 1))
    low, high = above.get_ylim()
    if low < 0 < high:
        above.axhline(0, color="0.8", linewidth=0.6, zorder=1)
    (below or above).set_xlabel("Time (s)")
    if below:
        below.set_ylabel(f"Difference ({unit})", fontsize=8)
        below.axhline(0, color="0.6", linewidth=0.6, zorder=1)
    return scale, unit


def spread(ends, lines, height):
    """Where labels of these numbers of lines stand, from 0 to 1: as near to the ends of their
    curves as they can be without an overlap, in their order. `height` is that of a line."""
    order = np.argsort(ends, kind="stable")
    size = height * np.asarray(lines)[order]
    below = np.cumsum(size) - 0.5 * size
    blocks = []  # labels that touch: [ends less what is below them, ...]
    for want in np.asarray(ends)[order] - below:
        blocks.append([want])
        while len(blocks) > 1 and np.mean(blocks[-2]) >= np.mean(blocks[-1]):
            blocks[-2:] = [blocks[-2] + blocks[-1]]
    free = [np.mean(block) for block in blocks for _ in block]
    placed = np.empty(len(order))
    placed[order] = below + np.clip(free, 0, max(0, 1 - size.sum()))
    return placed


def label_curves(axes, curves):
    """Names of curves, {name: line}, to the right of the axes in the colours of their lines."""
    size, room = 8, axes.get_position().height * axes.figure.get_figheight() * 72
    names = [textwrap.fill(name, LABEL) for name in curves]
    ends = []
    for line in curves.values():
        time, value = np.asarray(line.get_data(), dtype=float)
        value = value[(time <= axes.get_xlim()[1]) & np.isfinite(value)]
        low, high = axes.get_ylim()
        ends.append((value[-1] - low) / (high - low) if len(value) else 0)
    places = spread(ends, [name.count("\n") + 1.3 for name in names], 1.2 * size / room)
    for name, line, end, place in zip(names, curves.values(), ends, places):
        look = dict(color=line.get_color(), transform=axes.transAxes)
        axes.plot([1, 1.03], [end, place], clip_on=False, linewidth=0.6, **look)
        axes.text(1.04, place, name, fontsize=size, va="center", linespacing=1.0, **look)


def draw_figure(columns, curves, refs):
    """All columns side by side, the names of the curves to the right of the last one."""
    refs = [ref for ref in refs if ref.probe in columns]
    names = [run.label() for run, _, _ in curves[columns[0]]] + [ref.label for ref in refs]
    top, below = 0.12, 0.45
    height = below + top + (3.6 if refs else 2.6)
    right = 0.3 + 0.065 * min(LABEL, max(map(len, names)))
    fig, axes = plt.subplots(2 if refs else 1, len(columns), figsize=(WIDTH, height),
                             squeeze=False, sharex="col",
                             gridspec_kw={"height_ratios": [2.6, 1] if refs else [1]})
    fig.subplots_adjust(left=0.08, right=1 - right / WIDTH, top=1 - top / height,
                        bottom=below / height, wspace=0.32, hspace=0.07)
    units, legend = {}, {}
    for k, column in enumerate(columns):
        own = [ref for ref in refs if ref.probe == column]
        if refs and not own:
            axes[1, k].set_visible(False)
            axes[0, k].tick_params(labelbottom=True)
        legend.clear()
        units[column] = draw_column(axes[0, k], axes[1, k] if own else None, column,
                                    curves[column], own, legend)
        fig.align_ylabels(axes[:, k])
    label_curves(axes[0, -1], legend)
    return fig, units


def panels_of(columns):
    """Columns of the same unit together; a displacement of millimetres stands apart from a
    position. Displacements come first, forces and moments behind all that moves or flows, energies
    last."""
    late = {"N/m": 2, "N m/m": 2, "J/m": 3}
    panels = {}
    for column in columns:
        unit = column_words(column, float("inf"))[2]
        moved = bool(re.search(r"_d[xy]_m$", column))
        panels.setdefault((0 if moved else late.get(unit, 1), unit), []).append(column)
    return [panels[key] for key in sorted(panels, key=lambda key: key[0])]


def without_turns(column, value):
    """An angle from -pi to pi is interrupted where it goes on at the other end, instead of
    joined."""
    value = np.array(value, dtype=float)
    if column.endswith("_angle_rad"):
        value[1:][np.abs(np.diff(value)) > np.pi] = np.nan
    return value


def draw_panel(axes, columns, curves, refs):
    """The columns of one unit; gives its factor and name. Each of several runs has its colour."""
    size = max(np.abs(value).max() for column in columns for _, _, value in curves[column])
    styles = reference_style(refs)
    several = len(curves[columns[0]]) > 1
    for ref in refs:
        words, scale, _ = column_words(ref.probe, size)
        name = ref.label if len(columns) == 1 else f"{words.rpartition(' (')[0]},\n{ref.label}"
        axes.plot(ref.time, scale * ref.value, label=name, **styles[ref])
    for c, column in enumerate(columns):
        words, scale, unit = column_words(column, size)
        for k, (run, time, value) in enumerate(curves[column]):
            name = words.rpartition(" (")[0] + (f", {run.label()}" if several else "")
            colour = COLOURS[(k if several else c) % len(COLOURS)]
            repeated = c if several else c // len(COLOURS)  # with a colour that others have, too
            style = DASHES[(repeated - 1) % len(DASHES)] if repeated else "-"
            axes.plot(time, scale * without_turns(column, value), color=colour, linestyle=style,
                      zorder=3, label=name)
            draw_loads(axes, run, column, scale, colour)
            if run.failure():
                axes.plot(time[-1], scale * value[-1], "x", color=colour, markersize=8,
                          markeredgewidth=2, zorder=5)
    times = [time for column in columns for _, time, _ in curves[column]]
    label = words.rpartition(" (")[0] if len(columns) == 1 else kinds_of(columns)
    axes.set(ylabel=textwrap.fill(f"{label} ({unit})", 34),
             xlim=(min(time[0] for time in times), max(time[-1] for time in times) or 1))
    low, high = axes.get_ylim()
    if low < 0 < high:
        axes.axhline(0, color="0.8", linewidth=0.6, zorder=1)
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5))
    return scale, unit


def draw_panels(columns, curves, refs):
    """One panel for each unit, one below the other, with a legend beside each."""
    panels = panels_of(columns)
    fig, axes = plt.subplots(len(panels), 1, figsize=(WIDTH, 0.4 + 1.9 * len(panels)),
                             squeeze=False,
                             layout="constrained")
    units = {}
    for row, names in zip(axes[:, 0], panels):
        own = [ref for ref in refs if ref.probe in names]
        units.update(dict.fromkeys(names, draw_panel(row, names, curves, own)))
    axes[-1, 0].set_xlabel("Time (s)")
    return fig, units
