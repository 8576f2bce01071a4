#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs each test on the build for gcov and keeps which lines and branches of src/ it took.

    tests/mutants/coverage.py                  all tests that run the program: build/coverage/taken
    tests/mutants/coverage.py --filter fluid   those whose path contains this
    tests/mutants/coverage.py --missing        lists the lines and branches that no test took

A test is run again only if it has changed, or if a source has. Branches of a line are merged over
the functions that the compiler made of it (a law is compiled for float and for double), and over
the copies of an inlined function (a law is inlined for each set of effects, and each copy has one
outcome only). Three kinds of branches do not count. On a line without a decision of its own they
belong to functions that were put into it, and count where these are written. A failed ASSERT is
what no input reaches. And TRY hands on an error, which counts where it arises.
"""
import argparse
import gzip
import hashlib
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from itertools import zip_longest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "coverage"
KEPT = BUILD / "taken"
SUMMARY = ROOT / "tests" / "mutants" / "coverage.json"
ENV = {**os.environ, "OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive",
       "PYTHON": sys.executable}
# Tests of tools, of installing and of the set-up run no line of src/ that others do not. The audit
# counts every file that a run opens, and gcov opens more.
LEFT_OUT = ("tests/tools/", "test_wheel", "test_install", "test_setup", "test_audit",
            "test_absence")


def all_tests(part=""):
    """The tests that run the program, as paths below ROOT."""
    found = sorted(str(path.relative_to(ROOT)) for kind in ("c", "sh", "py")
                   for path in ROOT.glob(f"tests/*/test_*.{kind}"))
    return [name for name in found if part in name and not any(word in name for word in LEFT_OUT)]


def command(test, build):
    if test.endswith(".c"):
        return [str(build / test.removesuffix(".c"))]
    return ["bash" if test.endswith(".sh") else sys.executable, test]


def limit(seconds):
    """In a child: a group of its own, each process of which may use so many seconds of the
    processor."""
    os.setpgid(0, 0)
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))


def run_test(test, build, program, seconds, **more):
    """(exit status, seconds of the processor); wall time counts only where nothing else ends a
    wait."""
    library = str(program.parent / "libsphfsi.so")
    env = {**ENV, "SPHFSI": str(program), "SPHFSI_LIBRARY": library, "BUILD": str(build), **more}
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(command(test, build), cwd=ROOT, env=env,
                                   stdin=subprocess.DEVNULL, stdout=output,
                                   stderr=output, preexec_fn=lambda: limit(seconds))
        alarm = threading.Timer(30 + 10 * seconds, os.killpg, (process.pid, 9))
        alarm.start()
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        alarm.cancel()
    return process.returncode, used.ru_utime + used.ru_stime


def digest_of(paths):
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def sources():
    return [path for path in ROOT.glob("src/*/*") if path.suffix in (".c", ".h", ".def")]


def gcov(folder):
    """{file: {"lines": {number: taken}, "branches": {number: [taken]}}} of the data in folder."""
    data = sorted(folder.rglob("*.gcda"))
    for path in data:
        inside = Path("/") / path.relative_to(folder)
        shutil.copy2(inside.with_suffix(".gcno"), path.with_suffix(".gcno"))
    out = folder / "json"
    out.mkdir()
    for k in range(0, len(data), 20):
        subprocess.run(["gcov", "-b", "--json-format", "--preserve-paths",
                        *map(str, data[k:k + 20])],
                       cwd=out, capture_output=True, check=True)
    result = {}
    for path in out.glob("*.gz"):
        for file in json.loads(gzip.decompress(path.read_bytes()))["files"]:
            name = file["file"]
            name = str(Path(name).relative_to(ROOT)) if name.startswith(str(ROOT)) else name
            if not name.startswith("src/") or name.endswith(".def"):
                continue
            for row in file["lines"]:
                line, taken = row["line_number"], [b["count"] > 0 for b in row["branches"]]
                merge(result, {name: {"lines": {line: row["count"] > 0},
                                      "branches": {line: taken}}})
    return result


def merge(total, more):
    for name, file in more.items():
        own = total.setdefault(name, {"lines": {}, "branches": {}})
        for line, taken in file["lines"].items():
            own["lines"][int(line)] = own["lines"].get(int(line), False) or taken
        for line, taken in file["branches"].items():
            before = own["branches"].get(int(line), [])
            own["branches"][int(line)] = [any(pair) for pair in zip_longest(before, taken)]


def kept(test):
    return KEPT / (test.replace("/", "-") + ".json")


def cover(test, key):
    """Runs one test and keeps what it took."""
    with tempfile.TemporaryDirectory(dir=BUILD) as folder:
        start = time.time()
        status, _ = run_test(test, BUILD, BUILD / "sphfsi", 600, GCOV_PREFIX=folder)
        seconds = time.time() - start
        files = gcov(Path(folder))
    kept(test).write_text(json.dumps({"key": key, "status": status, "seconds": seconds,
                                      "files": files}))
    print(f"{test}: {seconds:.0f} s, exit status {status}", flush=True)


def collect(names, jobs=2):
    """{test: its exit status and what it took}; tests whose outcome is kept are not run again."""
    base = digest_of(sources())
    keys = {name: base + digest_of([ROOT / name]) for name in names}
    stale = [name for name in names if not kept(name).exists() or
             json.loads(kept(name).read_text())["key"] != keys[name]]
    if stale:
        goals = [f"build/coverage/{name.removesuffix('.c')}" for name in stale
                 if name.endswith(".c")]
        subprocess.run(["make", "-s", "-j2", "SETUP=no", "CONFIG=coverage", "all", *goals],
                       cwd=ROOT, check=True)
        KEPT.mkdir(exist_ok=True)
        with ThreadPoolExecutor(jobs) as pool:
            list(pool.map(lambda name: cover(name, keys[name]), stale))
    return {name: json.loads(kept(name).read_text()) for name in names}


DECISION = re.compile(r"\?|&&|\|\||\b(?:if|for|while)\b")


def one_copy(text, taken):
    """The branches of a line with those of its inlined copies merged: two for each decision in its
    text."""
    decisions = len(DECISION.findall(text))
    if text.strip().startswith(("ASSERT(", "TRY(")) or not decisions and "switch" not in text:
        return []
    n = 2 * decisions
    if n == 0 or len(taken) <= n or len(taken) % n:
        return taken
    return [any(taken[k::n]) for k in range(n)]


def total_of(tests):
    total = {}
    for test in tests.values():
        merge(total, test["files"])
    for name, file in total.items():
        text = (ROOT / name).read_text().split("\n")
        for line, taken in file["branches"].items():
            file["branches"][line] = one_copy(text[line - 1], taken)
    return total


def text_of(name, line):
    return (ROOT / name).read_text().split("\n")[line - 1].strip()


def keep_summary(tests, total):
    """Keeps in SUMMARY what tests/mutants/mutants.py reports."""
    folders = defaultdict(dict)
    for name, file in total.items():
        folders[name.split("/")[1]][name] = file
    version = subprocess.run(["git", "describe", "--always"], cwd=ROOT, capture_output=True,
                             text=True)
    SUMMARY.write_text(json.dumps({
        "version": version.stdout.strip(), "tests": len(tests), "of": len(all_tests()),
        "all": shares(total),
        "folders": {name: shares(files) for name, files in sorted(folders.items())},
        "missing": [(name, line, text_of(name, line)) for name, line, what in missing(total)
                    if what == "line"]}, indent=1) + "\n")


def shares(total):
    """(lines taken, lines, branches taken, branches)"""
    lines = [taken for file in total.values() for taken in file["lines"].values()]
    branches = [taken for file in total.values() for line in file["branches"].values()
                for taken in line]
    return sum(lines), len(lines), sum(branches), len(branches)


def missing(total):
    """(file, line, what) of what no test took."""
    for name, file in sorted(total.items()):
        for line, taken in sorted(file["lines"].items()):
            branches = file["branches"].get(line, [])
            if not taken:
                yield name, line, "line"
            elif not all(branches):
                yield name, line, f"{len(branches) - sum(branches)} of {len(branches)} branches"


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--filter", default="", help="part of the paths of the tests to run")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--missing", action="store_true", help="list what no test took")
    args = parser.parse_args()
    tests = collect(all_tests(args.filter), args.jobs)
    total = total_of(tests)
    if not args.filter:
        keep_summary(tests, total)
    for name, line, what in missing(total) if args.missing else ():
        print(f"{name}:{line}: {what}: {text_of(name, line)}")
    lines, all_lines, branches, all_branches = shares(total)
    print(f"{100 * lines / all_lines:.2f} % of {all_lines} lines, "
          f"{100 * branches / all_branches:.2f} % of {all_branches} branches")


if __name__ == "__main__":
    main()
