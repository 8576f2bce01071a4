# SPDX-License-Identifier: MIT
"""The report of the accuracy study (docs/results/accuracy.md and its figures) from its collected
results."""

import csv
import io
import json
import os
import re
import textwrap
from pathlib import Path

from matplotlib.ticker import LogFormatter

from common import IMAGES, OUT, COLOURS, ROOT, WIDTH, BadFile, fill, load, np, plt, read_text
from palette import save
from study_results import (CROSSING, Study, across, against, aims_table, base_table, cost, failures,
                           forecast_table, halving_table, knob_table, machine_text, main_error,
                           percent)


# --- figures ---

class PlainLog(LogFormatter):
    """0.2 instead of 2e-01; which ticks have a label is left to its parent."""

    def __call__(self, x, pos=None):
        return f"{x:g}" if super().__call__(x, pos) else ""


def draw_line(axes, study, points, colour, label, **style):
    """Points of one setting in the order of resolution, named at the end of the line."""
    known = sorted((p for p in points if study.error(p)), key=lambda p: p["level"])
    if known:
        x, y = [cost(p) for p in known], [100 * study.error(p) for p in known]
        axes.loglog(x, y, "o-", color=colour, markersize=4, **style)
        axes.annotate(label, (x[-1], y[-1]), xytext=(6, 0), textcoords="offset points",
                      color=colour, va="center", fontsize=8)


def draw_case(study, case, path):
    """Error against cost of all settings; named are the defaults, the article's scheme, and the
    points that no other one beats in both."""
    figure, axes = plt.subplots(figsize=(0.75 * WIDTH, 2.8), layout="constrained")
    known, front = study.known(case), study.front(case)
    axes.loglog([cost(p) for p in known], [100 * study.error(p) for p in known], ".", color="0.7",
                zorder=1)
    axes.loglog([cost(p) for p in front], [100 * study.error(p) for p in front], color="0.8",
                lw=6, solid_capstyle="round", zorder=0)
    draw_line(axes, study, study.of(case, "scheme", "paper"), COLOURS[0], "scheme = paper")
    draw_line(axes, study, study.of(case, "base"), "black", "defaults", zorder=4)
    label = textwrap.fill(f"error (%): {main_error(study.cases[case])}", 30)
    axes.set(xlabel="CPU time (s)", ylabel=label,
             xlim=(None, 4 * max(cost(p) for p in known)))
    axes.set_title(f"{study.cases[case].get('title', case)}. Dots: other settings; "
                   "grey band: the best of all", fontsize=8, loc="left")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(PlainLog(minor_thresholds=(1, 0.5)))
    save(figure, path)
    plt.close(figure)


# --- text ---

def case_text(study, case):
    entry = study.cases[case]
    sources = [f"* {e['name']}, against {against(e)}: {e['source']}."
               for e in entry["error"] if e.get("source")]
    picture = f"![Error against cost](../img/accuracy_{case}.png)" if study.known(case) \
        else "No point has an error yet."
    return fill("accuracy_case.md", title=entry.get("title", case), words=entry.get("words", ""),
                picture=picture, error=main_error(entry), against=against(entry["error"][0]),
                references="\n".join(sources), table=base_table(study, case))


def summary(study):
    """The price of half the error, and the finest runs."""
    price, finest, none = [], [], []
    for case, entry in study.cases.items():
        title = entry.get("title", case)
        title = title[0].lower() + title[1:]
        b = study.slope(case, main_error(entry))
        price += [(2 ** (1 / b), title)] if b else []
        none += [] if b else [title]
        known = [p for p in study.base(case) if study.error(p)]
        finest += [(study.error(known[-1]), cost(known[-1]), title)] if known else []
    text = "**What does accuracy cost?** "
    if price:
        (low, easy), (high, hard) = min(price), max(price)
        text += (f"Refinement to half the main error costs {low:.1f} ({easy}) to {high:.1f} "
                 f"({hard}) times the CPU time")
        text += (f". It does not reduce the error of: {', '.join(none)}. " if none else ". ")
    if finest:
        (low, fast, best), (high, slow, worst) = min(finest), max(finest)
        text += (f"The finest runs with an error reach {percent(low)} % ({best}, {fast:.3g} s) to "
                 f"{percent(high)} % ({worst}, {slow:.3g} s). ")
    return text


def circumstances(study):
    """Machine, compiler, threads, load: as the timings have them."""
    points = [p for p in study.points if p["timing"]]
    timings = [t for p in points for t in p["timing"]]
    machines = "; ".join(map(machine_text, study.head["machines"])) or "unknown machine"
    versions = ", ".join(study.head["versions"]) or "unknown"
    lines = [f"* Program {versions} (sources {study.head['program']}), {machines}, threads of a "
             f"run: {study.definition['study'].get('threads', 1)}.",
             f"* {len(points)} of {len(study.points)} points ran, in {len(timings)} runs."]
    if timings:
        loads = [t["load"] for t in timings]
        lines.append(f"* Load average before a run: median {np.median(loads):.1f}, "
                     f"{min(loads):.1f} to {max(loads):.1f}.")
    return "\n".join(lines)


def forecast_section(path):
    if not path.exists():
        return "Not measured: `make forecast` does it."
    try:
        data = json.loads(read_text(path))
        runs = data.get("runs", 1)
        return ("The table compares the forecast of `--explain` with whole runs, their start and "
                "the reading of the case included (`make forecast`). It has CPU time on one "
                "thread and wall time on more. "
                f"{f'Each number is a median of {runs}. ' * (runs > 1)}"
                f"Runs were cut short to about {data['seconds']:g} s. "
                f"{machine_text(data['machine'])}.\n\n"
                f"{forecast_table(data)}")
    except (ValueError, KeyError, TypeError) as problem:
        raise BadFile(f"{path}: not the forecasts of tools/report/forecast.py "
                      f"({problem})") from None


# --- the file of evidence in the program: what --explain says of errors ---

def write_evidence(study, path):
    """Errors of the presets by case and resolution, and those of make coverage."""
    coverage = load(OUT / "coverage.json", {"version": "-", "evidence": []})
    text = io.StringIO(f"# Written by make accuracy: errors in the study of program "
                       f"{', '.join(study.head['versions'])}, and in make coverage of "
                       f"{coverage['version']}; percent of the exact or finest result.\n")
    text.seek(0, io.SEEK_END)
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow("scene accuracy case error resolution what percent".split())
    for preset, knobs in study.definition.get("preset", {}).items():
        for case, entry in study.cases.items():
            knob, _, value = knobs.get(entry["scene"], "base").partition("=")
            points = sorted(study.of(case, knob, value), key=lambda p: p["level"])
            rows.writerows([entry["scene"], preset, entry.get("title", case), main_error(entry),
                            f"{across(entry, p):.3g}", entry.get("what", "across"),
                            f"{100 * study.error(p):.3g}"]
                           for p in points if study.error(p) is not None)
    rows.writerows(coverage["evidence"])
    if not path.exists() or path.read_text(encoding="utf-8") != text.getvalue():
        path.write_text(text.getvalue(), encoding="utf-8")
        print(f"written {path}; make puts it into the program")


def write(data, out, evidence=None):
    study = Study(data)
    if evidence:
        write_evidence(study, evidence)
    images = IMAGES if out == OUT else out / "img"
    images.mkdir(parents=True, exist_ok=True)
    for case in filter(study.known, study.cases):
        draw_case(study, case, images / f"accuracy_{case}.png")
    rules = study.definition["study"]
    knobs = "\n\n".join(f"### {entry.get('title', case)}: "
                        f"{main_error(entry)}\n\n{knob_table(study, case)}"
                        for case, entry in study.cases.items())
    inside = data.resolve().is_relative_to(ROOT)
    text = fill(
        "accuracy.md", summary=summary(study), crossing=CROSSING,
        data=Path(os.path.relpath(data, ROOT)) if inside else data.name,
        circumstances=circumstances(study), note=rules.get("note", ""),
        repeat_below=rules.get("repeat_below", np.inf), aims=aims_table(study),
        cases="\n".join(case_text(study, c) for c in study.cases),
        halving=halving_table(study), knobs=knobs,
        forecast=forecast_section(data.with_name("forecast.json")),
        failures=failures(study), holes="\n".join(f"* {h}" for h in study.head["holes"]) or "None.")
    (out / "accuracy.md").write_text(re.sub(r" +\n", "\n", text), encoding="utf-8")
    print(f"written {out / 'accuracy.md'}")
    return 0
