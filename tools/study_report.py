# SPDX-License-Identifier: MIT
"""The report of the accuracy study (docs/accuracy.md and its figures) from its collected results."""

import json
import os
import re
from pathlib import Path

from matplotlib.ticker import LogFormatter

from runfiles import COLOURS, WIDTH, BadFile, np, plt, read_text, save
from study_points import ROOT
from study_presets import fronts, preset_table, write_evidence
from study_results import Study, across, cost, finished, machine_text, main_error, setting
from study_tables import (aims_table, base_table, best_knobs, failures, forecast_table, halving_table,
                          knob_table, order_table)

MARKS = "osD^v<>ph*XP"
PANEL = 2.5  # inches


# --- figures ---

class PlainLog(LogFormatter):
    """0.2 instead of 2e-01; which ticks have a label is left to its parent."""

    def __call__(self, x, pos=None):
        return f"{x:g}" if super().__call__(x, pos) else ""



def groups_of(study, case):
    """{group: [(knob, value)]} of the settings that the case has, in the order of the definition."""
    groups = {}
    for knob, entry in study.knobs.items():
        for value in entry["values"]:
            if study.of(case, knob, value):
                groups.setdefault(entry.get("group", "settings"), []).append((knob, value))
    return groups or {"settings": []}


def draw_line(axes, study, points, **style):
    """Points of one setting in the order of resolution; those that did not finish stand as crosses at the
    top, over the time that they took."""
    known = sorted((p for p in points if study.error(p)), key=lambda p: p["level"])
    style.setdefault("markersize", 4.5)
    if known:
        axes.loglog([cost(p) for p in known], [100 * study.error(p) for p in known], **style)
    lost = [p for p in points if p["timing"] and not finished(p)]
    if lost:
        if not known:
            axes.plot([], [], **dict(style, label=style["label"] + ": none finished"))
        axes.plot([cost(p) for p in lost], [0.96] * len(lost), "x", color=style["color"], markersize=6,
                  markeredgewidth=1.5, transform=axes.get_xaxis_transform(), clip_on=False)


def draw_group(axes, study, case, group, settings):
    front = study.front(case)
    axes.loglog([cost(p) for p in front], [100 * study.error(p) for p in front], color="0.85",
                linewidth=7, solid_capstyle="round", zorder=1, label="Pareto front of all settings")
    draw_line(axes, study, study.of(case, "base"), color="black", marker="o", linewidth=1.6, zorder=4,
              label="base settings")
    knobs = list(dict.fromkeys(knob for knob, _ in settings))
    for number, (knob, value) in enumerate(settings):
        draw_line(axes, study, study.of(case, knob, value), color=COLOURS[number % len(COLOURS)],
                  linestyle=["-", "--", ":"][knobs.index(knob) % 3],
                  marker=MARKS[1 + number % (len(MARKS) - 1)], linewidth=0.9, zorder=3,
                  label=f"{knob} = {value}")
    axes.set_title(group, loc="left")
    axes.set_ylabel(f"{main_error(study.cases[case])} (%)", fontsize=7)
    axes.grid(True, which="both", linewidth=0.3, alpha=0.5)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=7)


def draw_case(study, case, path):
    groups = groups_of(study, case)
    figure, panels = plt.subplots(len(groups), 1, figsize=(WIDTH, 0.4 + PANEL * len(groups)), sharex=True,
                                  sharey=True, squeeze=False)
    for axes, (group, settings) in zip(panels[:, 0], groups.items()):
        draw_group(axes, study, case, group, settings)
    panels[-1, 0].set_xlabel("CPU time (s)")
    for axis in (panels[0, 0].xaxis, panels[0, 0].yaxis):  # all panels share them
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(PlainLog(minor_thresholds=(1, 0.5)))
    figure.suptitle(study.cases[case].get("title", case), fontsize=10)
    figure.tight_layout()
    save(figure, path)
    plt.close(figure)


# --- text ---

TEXT = """# What accuracy costs in time

Written by `make accuracy` (`tools/accuracy_cost.py`) from `{data}`; nothing here is typed by hand.

{circumstances}

Cost is CPU time, the least of a point's repeats; beside it stand median and spread. Points that cost
more than {repeat_below:g} s were run once. *Base settings* are those of the case file with the program's
defaults. In the figures each setting has a line; the Pareto front is the broad grey one; crosses at the top
stand for points that did not finish. {note}

## The cheapest way to an error

CPU seconds, setting and resolution of the cheapest point whose main error is no larger.

{aims}

{cases}

## Order of convergence

From the three finest runs with base settings: the observed order p, the extrapolated value, and the
band of the finest run, 1.25 |f1 - f2|/(r^p - 1) relative to it (the grid convergence index; Roache 1994;
Celik et al. 2008; p at most 2). Where the three do not converge monotonically, or p < 0.5, there is no order
and the band is three times their largest difference (Eça and Hoekstra 2014). The order one level coarser
leaves the finest run out and takes the next one in: how far the two are apart tells how far either can be
relied upon. *Extrapolated* differs from *reference* where the model, not the resolution, is off, or where
three grids do not yet tell the order.

{order}

## To halve the error

Slope of error against cost, and against dp, over the resolutions with base settings.

{halving}

## Which knob buys most accuracy per second

In each column error and cost over those of the base settings at the same resolution. *Gain*: how many
times longer the base settings, refined, would take to the same error (geometric mean over the columns):
above 1 the setting is worth it. A gain of a quantity whose error passes through zero, or that hardly
depends on resolution, says little; without a slope of error against cost there is none.

{knobs}

### Best by kind of scene

Settings that finished everywhere.

{best}

## Presets

`accuracy = draft | standard | fine` at the top of a case file sets what `src/case/presets.def` lists;
`standard` is the program's defaults.

{fronts}

### Their error in the study

{presets}

## Forecast against reality

{forecast}

## What failed

{failures}

## Holes

{holes}
"""

CASE = """## {title}

{words} Main error: **{error}**. {references}

![Error against cost](img/accuracy_{case}.png)

{table}

Pareto front, from cheap to exact: {front}.
"""


def case_text(study, case):
    entry = study.cases[case]
    sources = [f"{e['name']}: {e['source']}." for e in entry["error"] if e.get("source")]
    front = ", ".join(f"{setting(p)} at {across(entry, p):.3g}" for p in study.front(case))
    return CASE.format(title=entry.get("title", case), words=entry.get("words", ""), case=case,
                       error=main_error(entry), references=" ".join(sources),
                       table=base_table(study, case), front=front or "no finished point")


def circumstances(study):
    """Machine, compiler, threads, load: as the timings have them."""
    points = [p for p in study.points if p["timing"]]
    timings = [t for p in points for t in p["timing"]]
    machines = "; ".join(map(machine_text, study.head["machines"])) or "unknown machine"
    versions = ", ".join(study.head["versions"]) or "unknown"
    lines = [f"Program {versions} (sources {study.head['program']}); {machines}; threads of a run: "
             f"{study.threads()}. {len(study.points)} points, of which {len(points)} ran, in {len(timings)} "
             "runs."]
    if timings:
        loads = [t["load"] for t in timings]
        lines.append(f"Load average before a run: median {np.median(loads):.1f}, {min(loads):.1f} to "
                     f"{max(loads):.1f}.")
    for mark, is_so, words in (("†", study.busy, "was timed beside other work than the study's"),
                               ("‡", study.beside, "was timed beside another run of the study"),
                               ("§", study.older, "is of an older program in the same effective case")):
        number = sum(map(is_so, points))
        lines.append(f"{mark} {words}: {number} of {len(points)} points.")
    if not any(t.get("joules") is not None for t in timings):
        lines.append("No energy: the machine has no counter in /sys/class/powercap.")
    return "\n".join(lines)


def forecast_section(path):
    if not path.exists():
        return "Not measured: `make forecast` does it."
    try:
        data = json.loads(read_text(path))
        return ("What `--explain` said against what the shipped cases took, cut short so that a run was to "
                f"take {data['seconds']:g} s (`make forecast`); {machine_text(data['machine'])}.\n\n"
                f"{forecast_table(data)}")
    except (ValueError, KeyError, TypeError) as problem:
        raise BadFile(f"{path}: not the forecasts of tools/forecast.py ({problem})") from None


def write(data, out, evidence=None):
    study = Study(data)
    if evidence:
        write_evidence(study, evidence)
    (out / "img").mkdir(parents=True, exist_ok=True)
    for case in study.cases:
        draw_case(study, case, out / "img" / f"accuracy_{case}.png")
    rules = study.definition["study"]
    knobs = "\n\n".join(f"### {entry.get('title', case)}: {main_error(entry)}\n\n{knob_table(study, case)}"
                        for case, entry in study.cases.items())
    inside = data.resolve().is_relative_to(ROOT)
    text = TEXT.format(
        data=Path(os.path.relpath(data, ROOT)) if inside else data.name,
        circumstances=circumstances(study), note=rules.get("note", ""),
        repeat_below=rules.get("repeat_below", np.inf), aims=aims_table(study),
        cases="\n".join(case_text(study, c) for c in study.cases), order=order_table(study),
        halving=halving_table(study), knobs=knobs, best=best_knobs(study), fronts=fronts(study),
        presets=preset_table(study), forecast=forecast_section(data.with_name("forecast.json")),
        failures=failures(study), holes="\n".join(f"* {h}" for h in study.head["holes"]) or "None.")
    (out / "accuracy.md").write_text(re.sub(r" +\n", "\n", text), encoding="utf-8")
    print(f"written {out / 'accuracy.md'}")
    return 0
