#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The study as a Snakemake workflow: a run that is killed fails its job, the others go on; the second
time only that one runs; the report is that of the plain tool. SNAKEMAKE names the program if it is not in
the path."""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from test_study import ROOT, check, points_in, prepare, study  # which is skipped without its packages


def workflow(folder, environment, snakemake):
    done = subprocess.run(
        [snakemake, "-s", ROOT / "tools" / "study" / "Snakefile", "--cores", "2", "--keep-going", "--config",
         f"study={folder}/study.toml", f"runs={folder}/runs", f"out={folder}",
         f"data={folder}/results.json", f"python={sys.executable}"],
        capture_output=True, text=True, check=False, env=environment, cwd=folder)
    return done.returncode, done.stdout + done.stderr


def times_of(folder):
    return {path.parent.name: path.stat().st_mtime_ns for path in (folder / "runs").glob("*/result.json")}


def whole(folder, snakemake):
    environment = prepare(folder)
    status, text = workflow(folder, environment, snakemake)
    check(status != 0 and "plate/0/killed=it: failed" in text, f"the killed run did not fail: {text}")
    before = times_of(folder)
    check(len(before) == 5 and not (folder / "accuracy.md").exists(), f"not all others went on: {text}")
    (folder / "kill").unlink()
    status, text = workflow(folder, environment, snakemake)
    after = times_of(folder)
    check(status == 0 and len(after) == 6, f"it was not resumed: {text}")
    check(all(after[key] == before[key] for key in before), "what was finished ran again")
    records = list((folder / "runs").glob("*/benchmark.tsv"))
    check(len(records) == 6 and "cpu_time" in records[0].read_text(), "benchmark records are missing")
    report = (folder / "accuracy.md").read_text()
    check(points_in(folder)["plate/0/killed=it"]["outcome"] == "finished",
          "the report lacks the resumed point")
    status, text = study(folder, environment)
    check(status == 0 and "points to run" not in text, f"the plain tool has more to run: {text}")
    check((folder / "accuracy.md").read_text() == report, "the plain tool writes another report")
    next((folder / "runs").glob("*/result.json")).unlink()
    status, text = workflow(folder, environment, snakemake)
    check(status == 0 and times_of(folder).keys() == after.keys(), f"a result that was taken away: {text}")


def main():
    snakemake = os.environ.get("SNAKEMAKE") or shutil.which("snakemake")
    if not snakemake:
        print("snakemake is not in the path, nor named by SNAKEMAKE")
        sys.exit(77)
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    with tempfile.TemporaryDirectory() as name:
        whole(Path(name), snakemake)


if __name__ == "__main__":
    main()
