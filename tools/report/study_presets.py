# SPDX-License-Identifier: MIT
"""The file of evidence in the program: what --explain says of errors."""
import csv
import io

from common import OUT, load
from study_results import across, main_error


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
