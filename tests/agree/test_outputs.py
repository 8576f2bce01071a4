#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""No output moves a bit: whatever the intervals of rows, snapshots and checkpoints, with further
probes, ended and continued at any time, a run has the same state at the same step. Rows are at
multiples of their interval, and their error falls with the time step as docs/formats.md says."""
import csv
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import PROGRAM, ROOT

INTEGRATORS = ("symplectic", "verlet", "leapfrog")
TINY = (ROOT / "tests/fault/tiny.cfg").read_text()
BAR = """dp = 1 cm
end_time = 20 ms
[solid bar]
shape = box 0, 0, 0.2, 0.03
clamp = box 0, 0, 0.03, 0.03
density = 1000
young = 1 MPa
poisson = 0.3
[solid ball]
shape = box 0.1, 0.06, 0.13, 0.09
density = 1000
young = 1 MPa
poisson = 0.3
velocity = 0, -4
[load pull]
body = bar
shape = box 0.18, 0, 0.21, 0.03
force = 20*sin(300*t), -10
[probe tip]
body = bar
point = 0.2, 0
[output]
probe_interval = 0.1 ms
ledger_interval = 1 ms
"""
MORE_PROBES = """
[probe foot]
quantity = force
body = tank
interval = 0.13 ms
[probe mean]
quantity = pressure
point = 0.05, 0.02
interval = 0.9 ms
average = 0.31 ms
"""
WATCHED = (["output.probe_interval=0.37 ms"], ["output.ledger_interval=7 us"],
           ["output.snapshot_interval=0.7 ms"], ["output.checkpoint_interval=0.11 ms"],
           ["output.probe_interval=3 us", "output.checkpoint_interval=1.7 ms"])


def run(folder, name, text, *options, sets=()):
    """Runs a case; returns its folder and its summary."""
    out, case = folder / name, folder / f"{name}.cfg"
    case.write_text(text)
    done = subprocess.run([PROGRAM, case, "--quiet", "--out", out, *options,
                           *(word for each in sets for word in ("--set", each))],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return out, json.loads((out / "summary.json").read_text())


def state(summary):
    return summary["steps"], summary["time"], summary["state_hash"]


def column(path, name):
    with open(path) as file:
        rows = list(csv.DictReader(file))
    return [float(row["time_s"]) for row in rows], [float(row[name]) for row in rows]


def check_bits(folder, text, more, integrator):
    """Other outputs; an end and a restart: the same state, and after a restart the same rows."""
    chosen = [f"integrator={integrator}"]
    whole, summary = run(folder, "whole", text, "--until", "0.0113", sets=chosen)
    assert 0.0113 <= summary["time"] < 0.0113 + 17 * summary["time_step"]["largest"]
    assert summary["end_time"] == 0.0113
    for k, sets in enumerate(WATCHED):
        other = run(folder, f"other{k}", text, "--until", "0.0113", sets=chosen + sets)[1]
        assert state(other) == state(summary), (integrator, sets)
    if more:
        other = run(folder, "more", text + more, "--until", "0.0113", sets=chosen)[1]
        assert state(other) == state(summary), (integrator, "more probes")
    run(folder, "cut", text + more, "--until", "0.00437", sets=chosen)
    parts = run(folder, "cut", text + more, "--until", "0.0113", "--restart", sets=chosen)
    assert state(parts[1]) == state(summary), (integrator, "restart")
    for path in (folder / "more" if more else whole).glob("*.csv"):
        assert path.read_bytes() == (parts[0] / path.name).read_bytes(), (integrator, path.name)


def check_times(folder, lone):
    """Rows up to the end that was asked for; of a lone solid, up to the last state."""
    out = folder / "whole"
    end = json.loads((out / "summary.json").read_text())["time" if lone else "end_time"]
    for path, interval in ((out / "probes.csv", 1e-4), (out / "ledger.csv", 1e-3)):
        times = column(path, "time_s")[0]
        assert times == [float(f"{k * interval:.12g}") for k in range(len(times))], path
        assert 0 <= end - times[-1] < interval, (path, times[-1])


MOVED = """dp = 1 cm
end_time = 0.1
integrator = {}
[solid block]
shape = box 0, 0, 0.03, 0.03
clamp = box -1, -1, 1, 1
clamp_motion = swing
density = 1000
young = 1 MPa
poisson = 0.3
[motion swing]
x = 0.1*sin(50*t)
[numerics]
fixed_step = {}
[probe d]
body = block
point = 0.015, 0.015
[probe v]
quantity = velocity
body = block
point = 0.015, 0.015
[output]
probe_interval = 0.37 ms
"""


def check_errors(folder):
    """A body with a given motion: its displacement, whose rate is known, has an error of the fourth
    power of the step; its velocity one of the second."""
    errors = []
    for k, step in enumerate((4e-3, 2e-3, 1e-3)):
        out, _ = run(folder, f"moved{k}", MOVED.format("leapfrog", step))
        times, shown = column(out / "probes.csv", "d_dx_m")
        assert len(times) > 250
        moved = max(abs(x - 0.1 * math.sin(50 * t)) for t, x in zip(times, shown))
        times, shown = column(out / "probes.csv", "v_vx_m_per_s")
        speed = max(abs(v - 5 * math.cos(50 * t)) for t, v in zip(times, shown) if t > step)
        errors.append((moved, speed))
    for (moved, speed), (moved_next, speed_next) in zip(errors, errors[1:]):
        assert 13 < moved / moved_next < 19, errors
        assert 3.4 < speed / speed_next < 4.6, errors
    print("errors of displacement and velocity:", errors)


def main():
    with tempfile.TemporaryDirectory() as top:
        for k, (text, more) in enumerate(((TINY, MORE_PROBES), (BAR, ""))):
            for integrator in INTEGRATORS:
                folder = Path(top) / f"{k}{integrator}"
                folder.mkdir()
                check_bits(folder, text, more, integrator)
                check_times(folder, lone=k == 1)
        check_errors(Path(top))


if __name__ == "__main__":
    main()
