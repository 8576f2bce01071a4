#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The accuracy study on a tiny grid: cache, holes, report; and errors of curves made by hand."""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
try:
    import tomllib  # noqa: F401
    from study_metrics import measure
    from study_order import convergence
    from runfiles import BadFile, np
except (ImportError, SystemExit):
    print("tomllib, numpy or matplotlib is missing")
    sys.exit(77)

STUDY = """
[study]
threads = 1
repeats = 2
time_limit = 60
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
[case.strange]
file = "cases/none.cfg"
scene = "solid"
levels = []
across = 1
error = []
[knob.kappa]
values = { "0" = ["{solid}.hourglass=0"], same = ["{solid}.hourglass=50"] }
[knob.wrong]
values = { key = ["{solid}.hourglas=0"], unstable = ["numerics.fixed_step=0.01"] }
[knob.fluid]
values = { any = ["{fluid}.density_diffusion=0"] }
"""


def check(wanted, what):
    if not wanted:
        sys.exit(what)


def study(folder, *more):
    done = subprocess.run(
        [sys.executable, ROOT / "tools" / "accuracy_cost.py", "--study", folder / "study.toml",
         "--runs", folder / "runs", "--out", folder, "--data", folder / "results.json", *more],
        capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def whole_study(folder):
    (folder / "study.toml").write_text(STUDY)
    status, text = study(folder)
    check(status == 0, f"the study failed: {text}")
    check("[case.strange] file = cases/none.cfg: there is no such case" in text, text)
    check("did you mean `hourglass`" in text, f"the misspelt knob is not named: {text}")
    points = {p["name"]: p for p in json.loads((folder / "results.json").read_text())["points"]}
    check(len(points) == 7 and not any("fluid" in name for name in points), f"points: {list(points)}")
    check(points["plate/0/wrong=key"]["outcome"] == "refused", "a refused point is not shown as such")
    check(points["plate/0/wrong=unstable"]["outcome"] == "unstable", "an unstable point is not shown so")
    base = points["plate/0/base"]
    check(len(base["timing"]) == 2 and base["errors"]["end"] > 0 and base["evaluations"] > 0, str(base))
    check(points["plate/0/kappa=same"]["timing"] == base["timing"], "an equal case was run twice")
    check(points["plate/0/kappa=0"]["values"] != base["values"], "the knob changed nothing")
    report = (folder / "accuracy.md").read_text()
    for words in ("unstable", "did you mean", "cases/none.cfg", "| plate | end |"):
        check(words in report, f"the report lacks '{words}'")

    status, text = study(folder)
    check(status == 0 and "finished," not in text, f"a cached study ran again: {text}")
    result = next((folder / "runs").glob("*/result.json"))
    result.unlink()
    status, text = study(folder)
    check(text.count(" s of CPU") == 1, f"not just what was missing ran: {text}")
    status, text = study(folder, "--point", "plate/9/base")
    check(status == 1 and "no point plate/9/base" in text, text)
    (folder / "study.toml").write_text("[case")
    status, text = study(folder)
    check(status == 1 and "study.toml" in text and "Traceback" not in text, text)


def write_probes(folder, time, value):
    folder.mkdir()
    rows = "".join(f"{t!r},{v!r}\n" for t, v in zip(time.tolist(), value.tolist()))
    (folder / "probes.csv").write_text("time_s,c\n" + rows)


def errors_by_hand(folder):
    time = np.linspace(0, 3, 3001)
    run, other = folder / "a", folder / "b"
    write_probes(run, time, np.exp(-0.2 * time) * np.sin(2 * np.pi * time / 0.5) + 0)
    write_probes(other, time, np.full_like(time, 2.0))

    def off(of, **error):
        return measure(dict(error, name="x", column="c"), of, other, ROOT)

    value, error = off(run, kind="period", reference=0.4)
    check(abs(value - 0.5) < 1e-3 and abs(error - 0.25) < 3e-3, f"period {value}, {error}")
    value, error = off(run, kind="fitted_period", reference=0.4)
    check(abs(value - 0.5) < 2e-3, f"fitted period {value}")
    value, error = off(run, kind="decay", rate=0.1)
    check(abs(value - 0.2) < 1e-3 and abs(error - 1) < 1e-2, f"decay {value}, {error}")
    check(off(other, kind="settled", reference=4.0, **{"from": 1})[1] == 0.5, "settled")
    check(off(other, kind="final", reference=1.0) == (2.0, 1.0), "final")
    check(abs(off(other, kind="against_finest")[1]) == 0, "a run is off itself")
    value, error = off(run, kind="phase", reference=0.5)
    check(error < 2e-3, f"phase {error}")
    for bad in (dict(kind="period", reference=1.0, **{"from": 9}), dict(kind="period", reference=1.0)):
        try:
            off(other, **bad)
            sys.exit(f"{bad} was answered for a curve that has no period")
        except BadFile:
            pass
    c = convergence((1, 1.25, 2), tuple(3 + 0.1 * h**1.5 for h in (1, 1.25, 2)))
    check(abs(c["order"] - 1.5) < 1e-6 and abs(c["extrapolated"] - 3) < 1e-6, str(c))


def main():
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    with tempfile.TemporaryDirectory() as name:
        errors_by_hand(Path(name))
    with tempfile.TemporaryDirectory() as name:
        whole_study(Path(name))


if __name__ == "__main__":
    main()
