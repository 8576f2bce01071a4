# SPDX-License-Identifier: MIT
"""Errors of the presets, and the file of evidence in the program."""
import csv
import io

from common import OUT, load
from study_results import CROSSING, across, cost, finished, main_error, percent
from study_tables import table


def preset_points(study):
    """(preset, scene, case, point) of every point that stands for a preset, finished or not."""
    for preset, knobs in study.definition.get("preset", {}).items():
        for case, entry in study.cases.items():
            knob, _, value = knobs.get(entry["scene"], "base").partition("=")
            for p in sorted(study.of(case, knob, value), key=lambda p: p["level"]):
                yield preset, entry["scene"], case, p


def preset_table(study):
    rows = []
    for preset, _, case, p in preset_points(study):
        entry, error = study.cases[case], study.error(p)
        if finished(p) and error is None:
            continue
        fineness = f"{across(entry, p):.3g} {entry.get('what', 'across')}" if p["dp"] else "-"
        rows.append([case, preset, fineness,
                     percent(error) + (f" {CROSSING}" if study.crosses(p) else "")
                     if finished(p) else f"**{p['outcome']}**",
                     f"{cost(p):.3g}" if finished(p) else "-"])
    return table(["case", "preset", "resolution", "main error (%)", "CPU s"],
                 sorted(rows, key=lambda r: r[0]))


def write_evidence(study, path):
    """What the program says of its presets: the same numbers as a file that it carries."""
    coverage = load(OUT / "coverage.json", {"version": "-", "evidence": []})
    text = io.StringIO(f"# Written by make accuracy: errors in the study of program "
                       f"{', '.join(study.head['versions'])}, and in make coverage of "
                       f"{coverage['version']}; percent of the exact or finest result.\n")
    text.seek(0, io.SEEK_END)
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow("scene accuracy case error resolution what percent".split())
    for preset, scene, case, p in preset_points(study):
        entry, error = study.cases[case], study.error(p)
        if error is not None:
            rows.writerow([scene, preset, entry.get("title", case), main_error(entry),
                           f"{across(entry, p):.3g}", entry.get("what", "across"),
                           f"{100 * error:.3g}"])
    rows.writerows(coverage["evidence"])
    if not path.exists() or path.read_text(encoding="utf-8") != text.getvalue():
        path.write_text(text.getvalue(), encoding="utf-8")
        print(f"written {path}; make puts it into the program")
