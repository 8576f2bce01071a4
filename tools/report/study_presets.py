# SPDX-License-Identifier: MIT
"""Presets and the front that they follow from, and the file of evidence in the program."""
import csv
import io

from common import fill, np
from study import SCENES
from study_results import CROSSING, across, cost, finished, main_error, percent
from study_tables import table

# The rule that proposes presets, in means over cases and resolutions relative to the defaults: the
# largest error of `draft`, the largest cost and error of `fine`, and the largest error in any
# point.
DRAFT_WORSE, FINE_COST, FINE_ERROR, WORST = 1.1, 4, 0.9, 1.5

RULE = fill("accuracy_rule.md", draft=DRAFT_WORSE, cost=FINE_COST, error=FINE_ERROR, worst=WORST)


def mean(values):
    return float(np.exp(np.mean(np.log(values))))


def candidates(study, scene):
    """Settings of numerics by their mean (cost, error, worst error), and those with a point that
    failed or is missing: {(knob, value): numbers or words}."""
    found = {("base", ""): (1.0, 1.0, 1.0)}
    cases = [c for c in study.cases if study.cases[c]["scene"] == scene]
    for knob, entry in study.knobs.items():
        for value in entry["values"] if entry.get("preset") else []:
            points = [p for case in cases for p in study.of(case, knob, value)]
            if not points:
                continue
            if value in entry.get("not_preset", {}):
                found[knob, value] = entry["not_preset"][value]
                continue
            bad = sorted({p["outcome"] for p in points if not finished(p)})
            ratios = [study.ratios(p, main_error(study.cases[p["case"]])) for p in points]
            ratios = [r for r in ratios if r]
            if bad or not ratios:
                found[knob, value] = ", ".join(bad) or "no error to compare"
            else:
                errors, costs = zip(*ratios)
                found[knob, value] = (mean(costs), mean(errors), max(errors))
    return found


def mean_front(numbers):
    """Settings that no other setting beats in both mean cost and mean error."""
    found, best = [], np.inf
    for key, (_, error, _) in sorted(numbers.items(), key=lambda item: item[1][:2]):
        if error < best:
            found.append(key)
            best = error
    return found


def proposed(numbers):
    front = mean_front(numbers)
    draft = min((k for k, (c, e, worst) in numbers.items() if e <= DRAFT_WORSE and worst <= WORST),
                key=lambda k: numbers[k][0])
    fine = min((k for k in front if numbers[k][0] <= FINE_COST and numbers[k][1] <= FINE_ERROR and
                numbers[k][2] <= WORST), key=lambda k: numbers[k][1], default=("base", ""))
    return {"draft": draft, "standard": ("base", ""), "fine": fine}


def front_section(study, scene):
    settings = candidates(study, scene)
    numbers = {k: v for k, v in settings.items() if not isinstance(v, str)}
    front = mean_front(numbers)
    chosen = {preset: tuple(scenes.get(scene, "base").partition("=")[::2])
              for preset, scenes in study.definition.get("preset", {}).items()}

    def named(k):
        return ", ".join(p for p, key in chosen.items() if key == k)

    rows = [[study.label(*k), f"{c:.2f}", f"{e:.2f}", f"{worst:.2f}", "yes" if k in front else "",
             named(k)]
            for k, (c, e, worst) in sorted(numbers.items(), key=lambda item: item[1][0])]
    rows += [[study.label(*k), f"**{v}**", "", "", "", named(k)]
             for k, v in settings.items() if isinstance(v, str)]
    rule = proposed(numbers)
    differ = [preset for preset in chosen if chosen[preset] != rule.get(preset, ("base", ""))]
    verdict = "The program follows the rule."
    if differ:
        verdict = ", ".join(f"`{p}` is {study.label(*chosen[p])}" for p in differ)
        verdict = f"The program differs: {verdict}."
    return table(["setting", "cost", "error", "worst error", "on the front", "preset"], rows) + \
        "\n\nBy the rule: " + "; ".join(f"`{p}` is {study.label(*k)}" for p, k in rule.items()) + \
        f". {verdict}"


def fronts(study):
    scenes = [s for s in SCENES if any(c["scene"] == s for c in study.cases.values())]
    return RULE + "\n\n" + "\n\n".join(
        f"### {SCENES[scene].capitalize()}\n\n{front_section(study, scene)}" for scene in scenes)


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
    text = io.StringIO(f"# Written by make accuracy: errors of the presets in the study of program "
                       f"{', '.join(study.head['versions'])}; percent of the exact or finest "
                       f"result.\n")
    text.seek(0, io.SEEK_END)
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow("scene accuracy case error resolution what percent".split())
    for preset, scene, case, p in preset_points(study):
        entry, error = study.cases[case], study.error(p)
        if error is not None:
            rows.writerow([scene, preset, entry.get("title", case), main_error(entry),
                           f"{across(entry, p):.3g}", entry.get("what", "across"),
                           f"{100 * error:.3g}"])
    if not path.exists() or path.read_text(encoding="utf-8") != text.getvalue():
        path.write_text(text.getvalue(), encoding="utf-8")
        print(f"written {path}; make puts it into the program")
