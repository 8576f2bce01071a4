#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A sweep on a Slurm of one node: jobs run there with the resources of the workflow. Snakemake is
killed in the middle and its jobs are cancelled; started again, it continues them from their
checkpoints. Exit 77: Slurm, its executor or a package is missing."""

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
import slurm
with packages():
    import sweep

TINY = ROOT / "tests" / "fault" / "tiny.cfg"
ENDS = ("0.02", "8")  # s; the second is under way when the first is done
RUNS = len(ENDS)


def workflow(out):
    """The history of jobs needs a database, which this Slurm has not."""
    return [sweep.snakemake(), "-d", out, "-s", out / "Snakefile", "--rerun-incomplete", "--nolock",
            "--executor", "slurm", "--jobs", "2", "--slurm-status-command", "squeue",
            "--slurm-init-seconds-before-status-checks", "2", "--seconds-between-status-checks",
            "2"]


def has_executor():
    said = subprocess.run([sweep.snakemake(), "--help"], capture_output=True, text=True).stdout
    return "--slurm-status-command" in said


def kill_in_the_middle(cluster, out, log):
    """Gives the marks of the runs that were done by then."""
    whole = subprocess.Popen(list(map(str, workflow(out))), env=cluster.environment,
                             start_new_session=True,
                             stdout=log, stderr=log)
    for _ in range(1200):
        time.sleep(0.1)
        done = list((out / "runs").glob("*.done"))
        under_way = (out / "runs" / "1" / "probes.csv").exists()
        if (done and under_way) or whole.poll() is not None:
            break
    os.killpg(whole.pid, signal.SIGKILL)
    whole.wait()
    cluster.say("scancel", "--user", str(os.getuid()))
    cluster.until(lambda: not cluster.say("squeue", "--noheader"))
    return done


def check_sweep(cluster, folder):
    out, log = folder / "sweep", open(folder / "log", "w+")
    sets = ("output.snapshot_interval=0.5", "output.probe_interval=10 ms",
            "output.ledger_interval=10 ms")
    sets = [word for text in sets for word in ("--set", text)]
    subprocess.run([sys.executable, TOOLS / "sweep.py", TINY, *sets, "--vary",
                    f"end_time={','.join(ENDS)}",
                    "--out", out, "--program", PROGRAM], check=True, stdout=subprocess.DEVNULL)
    done = kill_in_the_middle(cluster, out, log)
    assert 1 <= len(done) < RUNS, (done, (folder / "log").read_text())
    before = {mark: (mark.with_suffix("") / "summary.json").stat().st_mtime_ns for mark in done}
    again = subprocess.run(list(map(str, workflow(out))), env=cluster.environment, stdout=log,
                           stderr=log)
    assert again.returncode == 0, (folder / "log").read_text()
    for mark, stamp in before.items():
        assert (mark.with_suffix("") /
                "summary.json").stat().st_mtime_ns == stamp, f"{mark}: run twice"
    rows = list(csv.DictReader((out / "table.csv").open()))
    assert [row["exit_reason"] for row in rows] == ["finished"] * RUNS, rows
    summaries = [json.loads((out / "runs" / str(k) / "summary.json").read_text())
                 for k in range(RUNS)]
    assert (out / "sweep.png").stat().st_size > 5000
    restarted = [k for k, summary in enumerate(summaries) if summary.get("restarted_from")]
    assert 1 in restarted, (restarted, (folder / "log").read_text())
    return len(done), len(restarted)


def main():
    if not sweep.snakemake():
        print("snakemake is missing")
        return 77
    if not has_executor():
        print("snakemake-executor-plugin-slurm is missing")
        return 77
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        folder = Path(name)
        (folder / "slurm").mkdir()
        folder.chmod(0o755)
        try:
            with slurm.Slurm(folder / "slurm") as cluster:
                done, restarted = check_sweep(cluster, folder)
        except slurm.Missing as reason:
            print(reason)
            return 77
    print(f"{RUNS} jobs of Slurm; {done} were done at the kill, {restarted} continued from a "
          f"checkpoint")
    return 0


if __name__ == "__main__":
    sys.exit(main())
