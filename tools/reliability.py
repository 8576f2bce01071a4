#!/usr/bin/env python3
"""Runs the rehearsed faults and writes docs/reliability.md: what was tried, how often, what came out.

What other tools found (fuzzers, sanitizers, valgrind, static analysis) is taken from a file of
`name | what was run | outcome` lines, by default docs/reliability.txt, kept by whoever ran them.
"""
import argparse
import os
import platform
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LONG = {"KILLS": "50", "FULL_STEPS": "40"}
SCRIPTS = [
    ("tests/fault/test_kill.sh", "kill -9 at random moments, then `--restart`, until the run is through"),
    ("tests/fault/test_full.sh", "a full disk (a small tmpfs) at every stage; the folder removed"),
    ("tests/fault/test_fork.sh", "`--inspect`, `--fork`, other formats, byte orders, dp"),
    ("tests/fault/test_run.sh", "command lines, folders, locks, signals, a guard"),
    ("tests/agree/test_restart.sh", "cut runs against whole ones, bit for bit"),
    ("tests/agree/test_restart_cases.sh", "the same for every shipped case, coarse and short"),
]


def run(script, environment):
    start = time.time()
    result = subprocess.run(["bash", script], cwd=ROOT, env=environment, capture_output=True,
                            text=True)
    found = [line[7:] for line in result.stdout.splitlines() if line.startswith("found: ")]
    verdict = {0: "passed", 77: "skipped"}.get(result.returncode, "FAILED")
    print(f"{verdict} {script} {time.time() - start:.0f} s")
    return verdict, found[-1] if found else "", time.time() - start


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true", help="the forms that make test runs")
    parser.add_argument("--notes", type=Path, default=ROOT / "docs" / "reliability.txt")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "reliability.md")
    args = parser.parse_args()

    environment = dict(os.environ, OMP_WAIT_POLICY="passive", PYTHON=sys.executable)
    environment.setdefault("SPHFSI", "./sphfsi")
    if not args.short:
        environment.update(LONG)
    version = subprocess.run([environment["SPHFSI"], "--version"], cwd=ROOT, capture_output=True,
                             text=True).stdout.strip()
    lines = ["# Reliability", "",
             f"Written by `make reliability`, sphfsi {version}, {platform.system()} "
             f"{platform.machine()}, {time.strftime('%Y-%m-%d')}. Not edited by hand; the second table "
             f"is [reliability.txt]({args.notes.name}), where runs of other tools are noted down.", "",
             "## Faults rehearsed", "", "| script | what | outcome | found | s |",
             "|---|---|---|---|---|"]
    failed = 0
    for script, what in SCRIPTS:
        verdict, found, seconds = run(script, environment)
        failed += verdict == "FAILED"
        lines.append(f"| {script} | {what} | {verdict} | {found} | {seconds:.0f} |")
    lines += ["", "## Fuzzers, sanitizers, analysers", "", "| tool | what was run | outcome |",
              "|---|---|---|"]
    for note in args.notes.read_text().splitlines() if args.notes.exists() else []:
        if note.strip() and not note.startswith("#"):
            lines.append("| " + " | ".join(part.strip() for part in note.split("|")) + " |")
    args.out.write_text("\n".join(lines) + "\n")
    print(f"written: {args.out}")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
