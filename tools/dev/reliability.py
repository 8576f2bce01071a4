#!/usr/bin/env python3
"""Runs the fault tests and writes docs/reliability.md: what was tried, how often, and the outcome.

Fuzzers log their counts in tests/fuzz/counts.txt. The last outcome of every fault test, sanitizer
and analyser is kept in tests/fault/checks.json. Sanitizers and analysers take long; --run runs them
(a part of the command, or `all`). --report writes the document from the kept outcomes.
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
FAULT_TESTS = [
    ("fault/test_kill.sh", "kill -9 at random moments, then `--restart`, until the run finishes"),
    ("agree/test_stops.c", "a stop after every step, for every integrator, with and without "
                           "sub-steps, and after some steps of every shipped case. Every second "
                           "run continues from an older checkpoint, on two threads instead of one. "
                           "State, rows and snapshots are compared bit by bit"),
    ("agree/test_restart.sh", "interrupted runs against whole ones, bit by bit, and on another "
                              "number of threads"),
    ("agree/test_restart_cases.sh", "the same for every shipped case, coarse and short"),
    ("output/test_checkpoint.c", "a checkpoint with every byte flipped, one at a time, cut at "
                                 "every length, or of another case: it is recognised, and the one "
                                 "before it is used"),
    ("fault/test_full.sh", "a full disk (a small tmpfs) at every stage; the folder removed during "
                           "a run"),
    ("fault/test_inject.sh", "the n-th call that makes, writes, syncs, renames or removes a file "
                             "fails, or the program is killed within it (strace)"),
    ("fault/test_alloc.c", "every allocation of a run, a restart, a fork, --inspect and --explain "
                           "fails once"),
    ("fault/test_run.sh", "command lines, folders, locks, signals, a guard"),
    ("fault/test_hostile.sh", "pipes, devices, links, huge files and odd names in the place of "
                              "files; bursts of signals"),
    ("fault/test_audit.sh", "the files that a run touches, from the system calls; clocks that step "
                            "back"),
    ("fault/test_change.py", "every key of a case changed at a restart and at a fork"),
    ("fault/test_fork.sh", "`--inspect`, `--fork`, other formats, byte orders, dp"),
    ("case/test_case_errors.c", "bad case files against the exact message"),
    ("fault/test_bad_input.c", "damaged, shuffled, huge and cut case files"),
    ("fault/test_corpus.c", "every input in the fuzzers' corpus"),
]
CHECKED = [
    ("AddressSanitizer and UndefinedBehaviorSanitizer", "make test-sanitize"),
    ("ThreadSanitizer (clang, libomp)", "make test-thread"),
    ("valgrind memcheck", "make memcheck"),
    ("cppcheck, clang-tidy, gcc -fanalyzer", "make analyze"),
]
FUZZED = {
    "case": "case reader (without sampling of shapes wider than 40 dp)",
    "expr": "expressions",
    "motion": "motion tables",
    "reference": "reference curves, and the probes compared with them",
    "series": "rows of a run that is continued",
    "checkpoint": "checkpoint reader: every input as it is, then with corrected checksums, loaded "
                  "and advanced by one step",
}


def found_in(text):
    return [line[7:] for line in text.splitlines() if line.startswith("found: ")]


def program_version(program):
    return subprocess.run([program, "--version"], cwd=ROOT, capture_output=True,
                          text=True).stdout.strip()


def kept():
    return json.loads(CHECKS.read_text()) if CHECKS.exists() else {}


def keep(name, outcome, found, version, seconds):
    records = kept()
    records[name] = {"outcome": outcome, "found": found, "version": version,
                     "date": time.strftime("%Y-%m-%d"), "seconds": round(seconds)}
    CHECKS.write_text(json.dumps(records, indent=1, sort_keys=True) + "\n")
    print(f"{outcome} {name}: {'; '.join(found)} ({seconds:.0f} s)", flush=True)


def run_test(test, environment, version):
    """Whether it failed."""
    start = time.time()
    path = ROOT / "tests" / test
    command = {".sh": ["bash", path], ".py": [sys.executable, path],
               ".c": [ROOT / "build" / "release" / "tests" / test.removesuffix(".c")]}[path.suffix]
    result = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    found = found_in(result.stdout)
    cases = re.findall(r"^(\d+) Tests (\d+) Failures", result.stderr, re.M)
    if cases:
        found.insert(0, f"{cases[-1][0]} test cases, {cases[-1][1]} failures")
    verdict = {0: "passed", 77: "skipped"}.get(result.returncode, "FAILED")
    keep(f"tests/{test}", verdict, found, version, time.time() - start)
    return verdict == "FAILED"


def check(command, version):
    """Runs a target, without what make was told of this one, and keeps what it says of itself."""
    start = time.time()
    environment = {key: value for key, value in os.environ.items()
                   if key != "ARGS" and not key.startswith("MAKE")}
    result = subprocess.run(command.split(), cwd=ROOT, env=environment, capture_output=True,
                            text=True)
    found = found_in(result.stdout)
    found += re.findall(r"^\d+ passed, \d+ failed, \d+ skipped$", result.stdout, re.M)
    reports = len(re.findall(r"(?:WARNING: ThreadSanitizer|ERROR: AddressSanitizer|runtime error:|"
                             r"ERROR: LeakSanitizer)", result.stdout + result.stderr))
    if "test-" in command:
        found.append(f"{reports} reports")
    keep(command, "passed" if result.returncode == 0 else "FAILED", found, version,
         time.time() - start)
    if result.returncode:
        (ROOT / "build" / "failed-check.log").write_text(result.stdout + result.stderr)
    return result.returncode != 0


def failed(status):
    """A run of a fuzzer that found what no commit has mended."""
    return status != "0" and "/" not in status


def mended(status):
    return status.split("/")[1:]


def fuzz_rows():
    total, rows = 0, {}
    for line in COUNTS.read_text().splitlines() if COUNTS.exists() else []:
        if line.startswith("#"):
            continue
        target, count, seconds, status, version, compiler, _ = line.split()
        row = rows.setdefault(target, [0, 0, 0, set(), []])
        row[0] += int(count)
        row[1] += int(seconds)
        row[2] += failed(status)
        row[4] += mended(status)
        row[3].add(version)
        total += int(count)
    for target, (count, seconds, bad, versions, found) in sorted(rows.items()):
        outcome = "no crash, hang, leak or report" if not bad else f"{bad} RUNS FAILED"
        if found:
            outcome = f"{len(found)} finding, mended by {', '.join(found)}; else {outcome}"
        yield (f"| {FUZZED.get(target, target)} | {count:,} | {seconds} | {outcome} | "
               f"{', '.join(sorted(versions))} |")
    yield f"| all | {total:,} | | | |"


def row(first, record):
    if not record:
        return f"| {first} | not run | | | |"
    return (f"| {first} | {record['outcome']} | {'; '.join(record['found'])} | "
            f"{record['version']}, {record['date']} | {record['seconds']} |")


def random_cases():
    return json.loads(RANDOM.read_text()) if RANDOM.exists() else {}


def summary(records):
    """What was tried, how much of it, and what was lost."""
    def state(names):
        outcomes = [records[name]["outcome"] for name in names if name in records]
        return sum(o == "passed" for o in outcomes), len(names)
    (good, tests), (clean, checks) = (state([f"tests/{test}" for test, _ in FAULT_TESTS]),
                                      state([command for _, command in CHECKED]))
    lines = [line.split() for line in COUNTS.read_text().splitlines() if not line.startswith("#")] \
        if COUNTS.exists() else []
    bad = sum(failed(line[3]) for line in lines)
    found = [commit for line in lines for commit in mended(line[3])]
    scenes = random_cases()
    wrong = len(scenes.get("failures", ()))
    lost = bad + wrong + (tests - good)
    said = (f"**What was lost: "
            f"{'nothing' if not lost else f'something in {lost} of these trials'}.** "
            f"Tried were kills, full disks, failing calls, damaged files and bad input: {good} of "
            f"{tests} "
            f"fault tests passed. {sum(int(line[1]) for line in lines):,} fuzzed inputs gave "
            f"{f'{bad} failed runs' if bad else 'no crash, hang, leak or report'}"
            f"{f' but {len(found)}, which {chr(44).join(found)} mended' if found else ''}. ")
    if scenes:
        said += (f"{scenes['cases']:,} random scenes ran in {len(scenes['builds'])} builds, were "
                 f"killed {scenes['kills']:,} times, restarted and forked: "
                 f"{f'{wrong} differ' if wrong else 'all agree bit by bit'}. ")
    return said + f"{clean} of {checks} sanitizer and analyser runs passed."


def random_lines():
    scenes = random_cases()
    if not scenes:
        return []
    count = scenes["outcomes"]
    lines = ["", "## Random scenes", "",
             "`make random-cases` draws small scenes with a seed and runs each with every build "
             f"({', '.join(scenes['builds'])}) and on another number of threads. Each is killed "
             "and restarted, stopped and restarted on another build, and forked without a change. "
             "State, rows and snapshots have to agree bit by bit; of a fork its last snapshot.", "",
             f"Of {scenes['cases']:,} scenes (seeds {scenes['seeds'][0]} to {scenes['seeds'][1]}, "
             f"{scenes['steps']:,} steps) {count.get('finished', 0):,} finished with finite "
             f"numbers and speeds below that of sound. {count.get('stopped by a guard', 0)} were "
             f"stopped by a guard at the same step everywhere. {len(scenes['failures'])} differ. "
             f"{count.get('refused', 0)} more were refused by a sentence. Program "
             f"{scenes['version']}, {scenes['date']}, {scenes['seconds']} s.",
             "", "| of the scenes | have |", "|---|---|"]
    return lines + [f"| {n} | {name} |" for name, n in scenes["features"].items()] + \
        ([""] + [f"* {why}" for why in scenes["failures"]] if scenes["failures"] else [])


def report():
    records = kept()
    lines = ["# Reliability", "", summary(records), "",
             f"`make reliability` writes this report on {platform.system()} {platform.machine()}. "
             "Nothing in it is edited by hand.", "",
             "## Fault tests", "", "Times were measured on a machine with other work.", "",
             "| test | what | outcome | found | version, date | s |", "|---|---|---|---|---|---|"]
    lines += [row(f"tests/{test} | {what}", records.get(f"tests/{test}")) for test,
              what in FAULT_TESTS]
    lines += ["", "## Fuzzers", "",
              "The fuzzers use libFuzzer with AddressSanitizer, UndefinedBehaviorSanitizer and "
              "LeakSanitizer (`make fuzz`). The counts are sums of tests/fuzz/counts.txt, which "
              "comes from the fuzzers' logs.", "",
              "| what | executions | s | outcome | versions |", "|---|---|---|---|---|",
              *fuzz_rows()]
    lines += random_lines()
    lines += ["", "## Sanitizers and analysers", "",
              "| tool | command | outcome | found | version, date | s |",
              "|---|---|---|---|---|---|"]
    lines += [row(f"{name} | `{command}`", records.get(command)) for name, command in CHECKED]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true", help="the forms that make test runs")
    parser.add_argument("--run", metavar="PART", help="also run the sanitizers and analysers whose "
                                                      "command "
                        "has this part, or all of them; `--only` those")
    parser.add_argument("--report", action="store_true", help="run no fault tests, only write the "
                                                              "report")
    parser.add_argument("--only", action="store_true", help="no fault tests, no report")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "reliability.md")
    args = parser.parse_args()

    environment = dict(os.environ, OMP_WAIT_POLICY="passive", PYTHON=sys.executable)
    environment.setdefault("SPHFSI", "./sphfsi")
    if not args.short:
        environment.update(LONG)
    version = program_version(environment["SPHFSI"])
    failed = 0
    for _, command in CHECKED:
        if args.run and (args.run == "all" or args.run in command):
            failed += check(command, version)
    if args.only:
        return failed > 0
    for test, _ in FAULT_TESTS if not args.report else []:
        failed += run_test(test, environment, version)
    args.out.write_text(report())
    print(f"written: {args.out}")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
