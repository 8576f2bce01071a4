#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The accuracy study on a tiny grid: cache, holes, report; and errors of curves made by hand."""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import PROGRAM, ROOT, packages
with packages():
    import tomllib
    from accuracy import points_of
    from study_metrics import measure
    from runfiles import BadFile, np

STUDY = """
[study]
threads = 1
repeats = 2
time_limit = 60
[preset]
draft = { solid = "kappa=0" }
[case.plate]
file = "cases/cantilever.cfg"
scene = "solid"
set = ["end_time=0.02 s"]
levels = ["ratio=4", "ratio=6", "ratio=8"]
knob_levels = [0]
across = 0.02
names = { solid = "plate" }
[[case.plate.error]]
name = "end"
kind = "final"
column = "M1_dy_m"
reference = 0.01
[[case.plate.error]]
name = "elsewhere"
kind = "final"
column = "M2_dy_m"
reference = 0.01
[knob.kappa]
values = { "0" = ["{solid}.hourglass=0"], same = ["{solid}.hourglass=50"] }
[knob.wrong]
values = { key = ["{solid}.hourglas=0"], unstable = ["numerics.fixed_step=0.01"] }
[knob.killed]
values = { it = ["{solid}.density=1234"] }
[knob.fluid]
values = { any = ["{fluid}.density_diffusion=0"] }
"""
# What is wrong with a definition, and the words that say so.
WRONG = (
    ("across = 0.02", "", "[case.plate] lacks `across`"),
    ('values = { any = ["{fluid}.density_diffusion=0"] }', "", "[knob.fluid] lacks `values`"))
# The program, but for a run that is killed as long as there is a file `kill`.
KILLER = """#!/bin/sh
case "$* " in
*--effective*|*--explain*) ;;
*density=1234*) [ -e '{folder}/kill' ] && kill -9 $$ ;;
esac
exec '{program}' "$@"
"""


def check(wanted, what):
    if not wanted:
        sys.exit(what)


def prepare(folder):
    """A study, and a program of which one run is killed."""
    (folder / "study.toml").write_text(STUDY)
    (folder / "kill").touch()
    program = folder / "program"
    program.write_text(KILLER.format(folder=folder, program=PROGRAM))
    program.chmod(0o755)
    return dict(os.environ, SPHFSI=str(program))


def study(folder, environment, *more):
    done = subprocess.run(
        [sys.executable, ROOT / "tools" / "report" / "accuracy.py", "--study",
         folder / "study.toml", *more],
        capture_output=True, text=True, check=False, env=environment)
    return done.returncode, done.stdout + done.stderr


def points_in(folder):
    return {p["name"]: p for p in json.loads((folder / "results.json").read_text())["points"]}


def whole_study(folder):
    environment = prepare(folder)
    status, text = study(folder, environment, "--only", "plate/0/wrong=key")
    check(status == 0 and "No point has an error" in (folder / "accuracy.md").read_text(),
          f"a study without an error has no report: {text}")
    status, text = study(folder, environment)
    check(status == 0, f"the study failed: {text}")
    for words in ("did you mean `hourglass`", "plate/0/base: elsewhere:", "has a column M2_dy_m",
                  "plate/0/killed=it: failed: exit status -9"):
        check(words in text, f"it does not say '{words}': {text}")
    points = points_in(folder)
    check(len(points) == 8 and not any("fluid" in name for name in points),
          f"points: {list(points)}")
    for name, outcome in (("wrong=key", "refused"), ("wrong=unstable", "unstable"),
                          ("killed=it", "failed"),
                          ("kappa=0", "finished")):
        check(points[f"plate/0/{name}"]["outcome"] == outcome, f"{name} is not shown as {outcome}")
    base = points["plate/0/base"]
    check(len(base["timing"]) == 2 and base["errors"]["end"] > 0 and base["evaluations"] > 0,
          str(base))
    check(points["plate/0/kappa=same"]["timing"] == base["timing"], "an equal case was run twice")
    check(points["plate/0/kappa=0"]["values"] != base["values"], "the knob changed nothing")
    report = (folder / "accuracy.md").read_text()
    for words in ("unstable", "did you mean", "| plate | end |", "**failed**",
                  "exit status -9", "7 of 8 points ran"):
        check(words in report, f"the report lacks '{words}'")
    resumed(folder, environment, points)


def resumed(folder, environment, points):
    """Only what failed or is missing runs again."""
    (folder / "kill").unlink()
    status, text = study(folder, environment, "--list")
    check(status == 0 and "1 to run" in text and "min left" in text, text)
    status, text = study(folder, environment)
    check(status == 0 and text.count(" s of CPU (") == 1 and "killed=it: finished" in text,
          f"not just what had failed ran: {text}")
    next((folder / "runs").glob("*.json")).unlink()
    status, text = study(folder, environment)
    check(text.count(" s of CPU (") == 1, f"not just what was missing ran: {text}")
    for path in (folder / "runs").glob("*.json"):
        path.unlink()
    status, text = study(folder, environment, "--cached")
    check(status == 0 and
          points_in(folder)["plate/2/base"]["errors"] == points["plate/2/base"]["errors"],
          f"without runs the collected results are lost: {text}")
    status, text = study(folder, environment, "--only", "plate/9/base")
    check(status == 1 and "no point plate/9/base" in text, text)
    for before, after, words in WRONG:
        (folder / "study.toml").write_text(STUDY.replace(before, after, 1))
        status, text = study(folder, environment)
        check(status == 1 and words in text, f"it does not say '{words}': {text}")
    (folder / "study.toml").write_text("[case")
    status, text = study(folder, environment)
    check(status == 1 and "study.toml" in text and "Traceback" not in text, text)


def presets():
    """Points that stand for a preset are the case that the preset makes; `standard` is the
    default."""
    with open(ROOT / "tools" / "report" / "accuracy.toml", "rb") as file:
        definition = tomllib.load(file)
    sets = {p["name"]: p["set"] for p in points_of(definition)}

    def effective(case, arguments):
        words = [word for text in arguments for word in ("--set", text)]
        text = subprocess.run([PROGRAM, "--effective", ROOT / case, *words], capture_output=True,
                              text=True,
                              check=True).stdout
        return [line for line in text.splitlines() if not line.startswith(("accuracy", "#"))]

    for preset, scenes in definition["preset"].items():
        for name, case in definition["case"].items():
            if preset == "paper" and case["scene"] == "solid":
                continue  # the scheme is of the fluid
            level = case.get("knob_levels", [0])[0]
            base = sets[f"{name}/{level}/base"]
            point = sets[f"{name}/{level}/{scenes[case['scene']]}"]
            chosen = "scheme=paper" if preset == "paper" else f"accuracy={preset}"
            check(effective(case["file"], base + [chosen]) == effective(case["file"], point),
                  f"{name}: `{preset}` of presets.c is not {scenes[case['scene']]} of study.toml")
    for case in sorted((ROOT / "cases").glob("*.cfg")):
        check(effective(case, ["accuracy=standard"]) == effective(case, []),
              f"{case.name}: the defaults are not the preset standard")


def write_probes(folder, time, value):
    folder.mkdir()
    rows = "".join(f"{t!r},{v!r}\n" for t, v in zip(time.tolist(), value.tolist()))
    (folder / "probes.csv").write_text("time_s,c\n" + rows)


def errors_by_hand(folder):
    time = np.linspace(0, 3, 3001)
    run, other = folder / "a", folder / "b"
    write_probes(run, time, np.exp(-0.2 * time) * np.sin(2 * np.pi * time / 0.5) )
    write_probes(other, time, np.full_like(time, 2.0))

    def off(of, **error):
        return measure(dict(error, name="x", column="c"), of, other, ROOT)

    value, error = off(run, kind="period", reference=0.4)
    check(abs(value - 0.5) < 1e-3 and abs(error - 0.25) < 3e-3, f"period {value}, {error}")
    value, error = off(run, kind="damped_period", reference=0.48)
    check(abs(value - 0.5) < 1e-3 and abs(error - 0.0417) < 3e-3, f"damped period {value}, {error}")
    value, error = off(run, kind="damped_loss", reference=0.5)
    check(abs(value - (1 - np.exp(-0.1))) < 1e-3 and error == value,
          f"damped loss {value}, {error}")
    write_probes(folder / "energy", time,
                 np.exp(-0.4 * time) * (1 + np.cos(4 * np.pi * time / 0.5)))
    value, error = off(folder / "energy", kind="damped_period", reference=0.48, energy=True)
    check(abs(value - 0.5) < 1e-3, f"damped period of an energy {value}")
    value, error = off(folder / "energy", kind="damped_loss", reference=0.5, energy=True)
    check(abs(value - (1 - np.exp(-0.1))) < 1e-3, f"damped loss of an energy {value}")
    write_probes(folder / "noisy", time,
                 5 * time + 0.3 * np.sqrt(2) * np.sin(2 * np.pi * time / 0.02))
    value, error = off(folder / "noisy", kind="noise_about_mean", window=0.02, scale=3)
    check(abs(value - 0.3) < 0.02 and abs(error - 0.1) < 0.007, f"noise about a mean {value}, "
                                                                f"{error}")
    check(off(other, kind="settled", reference=4.0, **{"from": 1})[1] == 0.5, "settled")
    check(off(other, kind="final", reference=1.0) == (2.0, 1.0), "final")
    check(abs(off(other, kind="against_finest")[1]) == 0, "a run is off itself")
    value, error = off(run, kind="phase", reference=0.5)
    check(error < 2e-3, f"phase {error}")
    for bad in (dict(kind="period", reference=1.0, **{"from": 9}),
                dict(kind="period", reference=1.0)):
        try:
            off(other, **bad)
            sys.exit(f"{bad} was answered for a curve that has no period")
        except BadFile:
            pass


def main():
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    presets()
    with tempfile.TemporaryDirectory() as name:
        errors_by_hand(Path(name))
    with tempfile.TemporaryDirectory() as name:
        whole_study(Path(name))


if __name__ == "__main__":
    main()
