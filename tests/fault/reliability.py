#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the fault tests and writes docs/results/reliability.md: what was tried, how
often, and the outcome.

The tests, sanitizers and analysers are those that reliability.md beside this file lists. Their last
outcomes are kept in tests/fault/checks.json; fuzzers log their counts in tests/fuzz/counts.txt.
Sanitizers and analysers take long; --run runs them. Examples:

  tests/fault/reliability.py                          the fault tests, then the report
  tests/fault/reliability.py --run memcheck --only    one of the checkers, no report
"""
import argparse
import json
import os
import platform
import re
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CHECKS = ROOT / "tests" / "fault" / "checks.json"
RANDOM = ROOT / "tests" / "fault" / "random.json"
COUNTS = ROOT / "tests" / "fuzz" / "counts.txt"
LONG = {"KILLS": "50", "FULL_STEPS": "40", "INJECT_STRIDE": "5"}
TEMPLATE = Path(__file__).with_suffix(".md").read_text()
TESTS = re.findall(r"(?m)^\| (tests/\S+) \|", TEMPLATE)
COMMANDS = re.findall(r"(?m)^\| [^|]* \| `(make \S+)` \|$", TEMPLATE)
FUZZED = {
    "case": "case reader (without sampling of shapes wider than 40 dp)",
    "expr": "expressions",
    "motion": "motion tables",
    "reference": "reference curves, and the probes compared with them",
    "series": "rows of a run that is continued",
    "checkpoint": "checkpoint reader: every input as it is, then with corrected checksums, loaded "
                  "and advanced by one step",
}


def load(path):
    return json.loads(path.read_text()) if path.exists() else {}


def run(name, command, environment, version):
    """Runs a test or a target, and keeps what it says of itself; whether it failed."""
    start = time.time()
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    said = done.stdout + done.stderr
    cases = re.findall(r"^(\d+) Tests (\d+) Failures", done.stderr, re.M)
    found = [f"{cases[-1][0]} test cases, {cases[-1][1]} failures"] if cases else []
    found += re.findall(r"(?m)^found: (.*)|^(\d+ passed, \d+ failed, \d+ skipped)$", done.stdout)
    found = [text if isinstance(text, str) else "".join(text) for text in found]
    if "test-" in name:
        reports = re.findall(r"WARNING: ThreadSanitizer|ERROR: (?:Address|Leak)Sanitizer|"
                             r"runtime error:", said)
        found.append(f"{len(reports)} reports")
    outcome = {0: "passed", 77: "skipped"}.get(done.returncode, "FAILED")
    records = {**load(CHECKS), name: {
        "outcome": outcome, "found": found, "version": version, "date": time.strftime("%Y-%m-%d"),
        "seconds": round(time.time() - start)}}
    CHECKS.write_text(json.dumps(records, indent=1, sort_keys=True) + "\n")
    print(f"{outcome} {name}: {'; '.join(found)}", flush=True)
    if outcome == "FAILED":
        (ROOT / "build" / "failed-check.log").write_text(said)
    return outcome == "FAILED"


def run_test(test, environment, version):
    command = {".sh": ["bash", test], ".py": [sys.executable, test],
               ".c": [ROOT / "build" / "release" / test.removesuffix(".c")]}[Path(test).suffix]
    return run(test, command, environment, version)


def check(command, version):
    """Runs a target without what make was told of this one."""
    environment = {key: value for key, value in os.environ.items()
                   if key != "ARGS" and not key.startswith("MAKE")}
    return run(command, command.split(), environment, version)


def fuzz_lines():
    """(target, executions, seconds, exit status, version); the status of a run that found what a
    commit has mended is 1/COMMIT."""
    for line in COUNTS.read_text().splitlines() if COUNTS.exists() else []:
        if not line.startswith("#"):
            target, count, seconds, status, version, *_ = line.split()
            yield target, int(count), int(seconds), status, version


def fuzz_outcome(lines):
    """(runs that failed, commits that mended what others found)"""
    status = [line[3] for line in lines]
    return sum(s != "0" and "/" not in s for s in status), \
        [commit for s in status for commit in s.split("/")[1:]]


def fuzz_rows():
    lines = list(fuzz_lines())
    for target in sorted({line[0] for line in lines}):
        own = [line for line in lines if line[0] == target]
        bad, mended = fuzz_outcome(own)
        outcome = f"{bad} RUNS FAILED" if bad else "no crash, hang, leak or report"
        if mended:
            outcome = f"{len(mended)} finding, mended by {', '.join(mended)}; else {outcome}"
        yield (f"| {FUZZED.get(target, target)} | {sum(line[1] for line in own):,} | "
               f"{sum(line[2] for line in own)} | {outcome} | "
               f"{', '.join(sorted({line[4] for line in own}))} |")
    yield f"| all | {sum(line[1] for line in lines):,} | | | |"


def summary(records, scenes):
    """What was tried, how much of it, and what was lost."""
    good, clean = (sum(records.get(name, {}).get("outcome") == "passed" for name in names)
                   for names in (TESTS, COMMANDS))
    lines = list(fuzz_lines())
    bad, mended = fuzz_outcome(lines)
    wrong = len(scenes.get("failures", ()))
    lost = bad + wrong + len(TESTS) - good
    crash = f"{bad} failed runs" if bad else "no crash, hang, leak or report"
    if mended:
        crash += f" but {len(mended)}, which {','.join(mended)} mended"
    said = (f"**What was lost: {f'something in {lost} of these trials' if lost else 'nothing'}.** "
            "Tried were kills, full disks, failing calls, damaged files and bad input: "
            f"{good} of {len(TESTS)} fault tests passed. {sum(line[1] for line in lines):,} fuzzed "
            f"inputs gave {crash}. ")
    if scenes:
        said += (f"{scenes['cases']:,} random scenes ran in {len(scenes['builds'])} builds, were "
                 f"killed {scenes['kills']:,} times, restarted and forked: "
                 f"{f'{wrong} differ' if wrong else 'all agree bit by bit'}. ")
    return said + f"{clean} of {len(COMMANDS)} sanitizer and analyser runs passed."


def scene_lines(scenes):
    if not scenes:
        return "Not run."
    count, failures = scenes["outcomes"], [f"* {why}" for why in scenes["failures"]]
    features = [f"| {n} | {name} |" for name, n in scenes["features"].items()]
    return Path(__file__).with_name("reliability_scenes.md").read_text().rstrip().format(
        **{**scenes, "builds": ", ".join(scenes["builds"]),
           "features": "\n".join([*features, *([""] if failures else []), *failures])},
        first=scenes["seeds"][0], last=scenes["seeds"][1], finished=count.get("finished", 0),
        stopped=count.get("stopped by a guard", 0), refused=count.get("refused", 0),
        differ=len(failures))


def report():
    records, scenes = load(CHECKS), load(RANDOM)

    def outcome(line, name):
        kept = records.get(name)
        return line + (f" {kept['outcome']} | {'; '.join(kept['found'])} | {kept['version']}, "
                       f"{kept['date']} | {kept['seconds']} |" if kept else " not run | | | |")
    text = re.sub(r"(?m)^\| (tests/\S+) \|.*|^\| [^|]* \| `(make \S+)` \|$",
                  lambda row: outcome(row[0], row[1] or row[2]), TEMPLATE)
    return text.format(summary=summary(records, scenes), fuzzed="\n".join(fuzz_rows()),
                       platform=f"{platform.system()} {platform.machine()}",
                       scenes=scene_lines(scenes))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--short", action="store_true", help="the forms that make test runs")
    parser.add_argument("--run", metavar="PART", help="also run the sanitizers and analysers whose "
                        "command has this part, or all of them; `--only` those")
    parser.add_argument("--report", action="store_true", help="run no fault tests, only write the "
                                                              "report")
    parser.add_argument("--only", action="store_true", help="no fault tests, no report")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "results" / "reliability.md")
    args = parser.parse_args()

    environment = dict(os.environ, OMP_WAIT_POLICY="passive", PYTHON=sys.executable)
    environment.setdefault("SPHFSI", "./sphfsi")
    environment.update({} if args.short else LONG)
    version = subprocess.run([environment["SPHFSI"], "--version"], cwd=ROOT, capture_output=True,
                             text=True).stdout.strip()
    failed = [check(command, version) for command in COMMANDS
              if args.run and (args.run == "all" or args.run in command)]
    if not args.only:
        failed += [run_test(test, environment, version) for test in TESTS if not args.report]
        args.out.write_text(report())
        print(f"written: {args.out}")
    return any(failed)


if __name__ == "__main__":
    sys.exit(main())
