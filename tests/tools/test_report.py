#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""summary.json: valid JSON with everything that scripts rely on; --explain says what it should."""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

SPHFSI = os.environ.get("SPHFSI", "./sphfsi")
CASE = "tests/fault/tiny.cfg"


def refuse_constant(name):
    raise ValueError(f"{name} is not JSON")


def summary(out, *options):
    subprocess.run([SPHFSI, CASE, "--out", str(out), "--quiet", *options], check=True,
                   stderr=subprocess.DEVNULL)
    return json.loads((out / "summary.json").read_text(), parse_constant=refuse_constant)


def check_summary(top):
    title = 'a "title" with \\ and \u00fc'
    s = summary(top / "run", "--set", "title=" + title)
    assert s["title"] == s["parameters"]["title"] == title, s["title"]
    assert s["exit_reason"] == "finished" and s["message"] == ""
    assert s["end_time"] == s["parameters"]["end_time"] == 0.02
    assert 0.02 <= s["time"] < 0.0205, s["time"]
    assert s["particles"]["fluid"] == 100 and s["particles"]["solid"] == 45
    assert s["particles"]["wall"] > 0 and s["fluid_left_domain"] == 0
    assert s["steps"] >= 70 and s["solid_substeps"] >= s["steps"]
    assert s["wall_seconds"] > 0 and s["particle_steps_per_second"] > 0
    assert set(s["phase_seconds"]) == {"sort", "packed", "wall", "fluid", "solid", "contact",
                                       "update",
                                       "output"}
    assert {"FLUID", "GRAVITY", "WALL", "SOLID", "COUPLING"} <= set(s["effects"])
    step = s["time_step"]
    assert 0 < step["smallest"] <= step["mean"] <= step["largest"] < 0.001
    assert sum(step["bound_steps"].values()) == s["steps"] and step["bound"] in step["bound_steps"]
    assert len(s["state_hash"]) == 16 and int(s["state_hash"], 16) >= 0
    assert s["extremes"]["density_lowest"] <= s["extremes"]["density_highest"]
    assert abs(s["drift"]["mass"]) < 1e-9
    assert s["ledger_end"]["time"] == s["time"] and s["ledger_start"]["time"] == 0
    gate = s["parameters"]["solid"]["gate"]
    assert gate["young"] == 1e6 and gate["law"] == "paper"
    assert gate["shape"] == [{"kind": "box", "points": [[0.1, 0], [0.13, 0.15]]}]
    assert s["parameters"]["output"]["probe_interval"] == 1e-4
    assert s["parameters"]["output"]["checkpoint_minutes"] == 10


def check_restart(top):
    """Numbers of the whole run stay those of the whole run."""
    out = top / "cut"
    cut = summary(out, "--until", "0.01")
    s = summary(out, "--restart")
    whole = summary(top / "whole")
    assert s["restarted_from"].endswith(".ckpt") and s["start_time"] == cut["time"] >= 0.01
    for key in ("state_hash", "steps", "solid_substeps", "ledger_start", "extremes", "drift",
                "counters"):
        assert s[key] == whole[key], key


def check_explain(top):
    text = subprocess.run([SPHFSI, CASE, "--explain", "--out", str(top / "none")], check=True,
                          capture_output=True, text=True).stdout
    for words in ("100 particles", "enabled effects", "COUPLING", "disabled effects",
                  "MOTION", "bytes per particle", "compiled loops of the fluid",
                  "<- limits the step", "Eq. 28b",
                  "ns per fluid particle and evaluation", "solid sub-step",
                  "on this machine when idle",
                  "MB"):
        assert words in text, f"--explain does not say {words!r}:\n{text}"
    assert not (top / "none").exists()


def main():
    with tempfile.TemporaryDirectory() as top:
        check_summary(Path(top))
        check_restart(Path(top))
        check_explain(Path(top))
    return 0


if __name__ == "__main__":
    sys.exit(main())
