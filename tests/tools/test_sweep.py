#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Sweeps: grids and samples, what is refused, what a run that was stopped leaves, the table and the
plot; by snakemake where it is installed, with a kill in the middle. Exit 77: a package is
missing."""

import csv
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import PROGRAM, ROOT, TOOLS, packages
with packages():
    import sweep
    from sphfsi.sweep import swings
from runfiles import BadFile, np

TINY = ROOT / "tests" / "fault" / "tiny.cfg"
os.environ.setdefault("OMP_NUM_THREADS", "1")


def tool(*options, status=0):
    said = subprocess.run([sys.executable, TOOLS / "sweep.py", *map(str, options), "--program",
                           str(PROGRAM)],
                          capture_output=True, text=True)
    assert said.returncode == status, said.stdout + said.stderr
    return said.stdout + said.stderr


def refused(words, function, *args):
    try:
        function(*args)
    except BadFile as problem:
        assert words in str(problem), problem
        return
    raise AssertionError(words)


def check_values():
    runs = sweep.grid([sweep.read_vary("dp=2mm,1mm"),
                       sweep.read_vary("gate.young=8MPa:14MPa:2MPa")])
    assert len(runs) == 8 and runs[0] == {"dp": "2mm", "gate.young": "8 MPa"}
    assert runs[-1] == {"dp": "1mm", "gate.young": "14 MPa"}
    assert len(sweep.grid([sweep.read_vary("a=0:0.3:0.1")])) == 4  # round-off loses no end
    varied = [sweep.read_vary("gate.young=8:14MPa"), sweep.read_vary("integrator=verlet,leapfrog")]
    runs = sweep.sample(varied, "lhs:20", 1)
    assert runs == sweep.sample(varied, "lhs:20", 1) != sweep.sample(varied, "lhs:20", 2)
    shares = np.array([float(run["gate.young"].split()[0]) - 8 for run in runs]) / 6
    assert sorted(np.floor(20 * shares)) == list(range(20))  # each twentieth once
    assert [run["integrator"] for run in runs].count("verlet") == 10
    refused("not LOW:HIGH:STEP in one unit", sweep.read_vary, "dp=1mm:2cm:1mm")
    refused("no lower to a higher", sweep.read_vary, "dp=2mm:1mm:1mm")
    refused("not KEY=VALUES", sweep.read_vary, "dp")
    refused("needs the step", sweep.grid, [sweep.read_vary("dp=1mm:2mm")])
    refused("not lhs:N", sweep.sample, varied, "lhs", 1)


def check_swings():
    """The slopes of a plane are found, the noise of the sample's other values apart."""
    random = np.random.default_rng(3)
    a, b = random.random(30), 10 * random.random(30)
    a[0], a[1], b[2], b[3] = 0, 1, 0, 10
    swing = swings(["a", "b"], {"a": a, "b": b}, 7 + 3 * a - 0.2 * b)
    assert abs(swing["a"] - 3) < 1e-9 and abs(swing["b"] + 2) < 1e-9, swing


def check_runs(folder):
    out = folder / "grid"
    said = tool(TINY, "--vary", "dp=10mm,5mm", "--vary", "gate.young=1MPa:2MPa:1MPa", "--out", out)
    assert "4 runs of" in said and "snakemake" in said, said
    plan = json.loads((out / "sweep.json").read_text())
    assert len(plan["runs"]) == 4 and plan["minutes"] >= 5
    said = tool(TINY, "--vary", "dp=10mm", "--out", out, status=1)
    assert "holds another sweep" in said, said
    said = tool(TINY, "--vary", "gate.yung=1e6", "--out", folder / "bad", status=1)
    assert "unknown key `yung`" in said and not (folder / "bad").exists(), said
    # A run that was stopped goes on from its checkpoint; one that left none begins anew.
    subprocess.run([*sweep.command(plan, 1, out / "runs" / "1", "--quiet"), "--until", "0.01"],
                   check=True,
                   stderr=subprocess.DEVNULL)
    summary = out / "runs" / "1" / "summary.json"
    # as a kill leaves it
    summary.write_text(summary.read_text().replace('"finished"', '"running"'))
    (out / "runs" / "2").mkdir()
    (out / "runs" / "2" / "probes.csv").write_text("time_s\n")
    for k in range(4):
        tool("--out", out, "--one", k)
    tool("--out", out, "--one", 0)  # nothing is left to do
    assert json.loads(summary.read_text())["restarted_from"]
    tool("--out", out, "--gather")
    check_table(out, 4)


def check_table(out, count):
    rows = list(csv.DictReader((out / "table.csv").open()))
    assert len(rows) == count and all(row["exit_reason"] == "finished" for row in rows), rows
    assert all(0 < abs(float(row["M1_dx_m:largest"])) < 0.1 for row in rows)
    assert (out / "sweep.png").stat().st_size > 5000


def check_kill(folder):
    """Killed with all its jobs in the middle, the sweep goes on; what was done is not done
    again."""
    out = folder / "killed"
    options = [TINY, "--set", "end_time=0.3", "--vary", "gate.young=1MPa:4MPa:1MPa", "--out", out,
               "--go", 1,
               "--metric", "M1_dx_m:largest"]
    whole = subprocess.Popen([sys.executable, TOOLS / "sweep.py", *map(str, options), "--program",
                              PROGRAM],
                             start_new_session=True, stdout=subprocess.DEVNULL,
                             stderr=subprocess.DEVNULL)
    for _ in range(1200):
        time.sleep(0.05)
        done = list((out / "runs").glob("*.done"))
        if done:
            break
    os.killpg(whole.pid, signal.SIGKILL)
    whole.wait()
    assert 1 <= len(done) < 4, done
    folder_of = done[0].with_suffix("")
    before = (folder_of / "summary.json").stat().st_mtime_ns
    tool(*options)
    assert (folder_of / "summary.json").stat().st_mtime_ns == before
    check_table(out, 4)


def main():
    check_values()
    check_swings()
    with tempfile.TemporaryDirectory() as folder:
        check_runs(Path(folder))
        if sweep.snakemake():
            check_kill(Path(folder))
            print("sweeps run, also by snakemake and after a kill")
        else:
            print("sweeps run; snakemake is missing")


if __name__ == "__main__":
    main()
