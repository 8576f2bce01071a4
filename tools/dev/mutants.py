#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures the tests: puts small faults into the sources, one at a time, and counts those that a
test finds.

    tools/dev/mutants.py --count 440        faults drawn with a seed from all files; docs/mutants.md
    (hours)
    tools/dev/mutants.py --files src/solid  faults of one folder or file only
    tools/dev/mutants.py --again            judges anew what was not found, for instance by new
    tests
    tools/dev/mutants.py --again --tests fluid/test_open,test_wall --files src/fluid
                                        the same of some files by some tests only, however long they
                                        take
    tools/dev/mutants.py --report           writes docs/mutants.md from what is kept

A fault flips a sign, changes a factor, shifts a limit by one, drops a term or a statement, or
inverts a condition. The objects that hold the changed line are compiled, and the tests that run it
(by gcov,
tools/dev/coverage.py) are linked and run, the shortest first, until one finds it or their time is
used up. Faults that none finds are judged again with the build of `make test-sanitize`, which sees
what is read behind an array, or not freed. A fault whose object code is that of the program is
equivalent. So are those that tests/mutants/equivalent.txt explains. Results are kept in
tests/mutants/results.json; a run that was interrupted goes on from there. How a fault was judged
first is kept beside its present verdict: tests are written for those of each sample that were not
found, so only a fresh sample measures the tests. The coverage is that which tools/dev/coverage.py
kept last.
"""
import argparse
import json
import os
import random
import re
import shutil
import subprocess
import sys
import threading
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import coverage
from coverage import ROOT, all_tests, run_test

SANITIZER = "AddressSanitizer"
WORK = ROOT / "build" / "mutants"
KEPT = ROOT / "tests" / "mutants" / "results.json"
EXPLAINED = ROOT / "tests" / "mutants" / "equivalent.txt"
SKIPPED = 77
LONGEST = 3  # seconds of the processor: tests that take longer are not run with faults
LOCK = threading.Lock()
# kind: (pattern, replacement); each match on a line of code is a candidate.
RULES = [
    ("sign", r"(?<=[\w)\]]) \+ (?=[\w(*])", " - "), ("sign", r"(?<=[\w)\]]) - (?=[\w(*])", " + "),
    ("sign", r" \+= ", " -= "), ("sign", r" -= ", " += "), ("sign", r"(?<=return )-(?=[\w(])", ""),
    ("factor", r"\b0\.5\b", "0.25"), ("factor", r"(?<![\w.\[])2(?= \* \w)", "3"),
    ("factor", r"\b1e-", "3e-"),
    ("factor", r"(?<=\w) \* (?=\w)", " / "),
    ("off by one", r"(?<=[\w)\]]) < (?=[\w(])", " <= "),
    ("off by one", r"(?<=[\w)\]]) <= (?=[\w(])", " < "),
    ("off by one", r"(?<=[\w)\]]) > (?=[\w(])", " >= "), ("off by one", r" \+ 1\b(?!\.)", ""),
    ("off by one", r" - 1\b(?!\.)", ""),
    ("condition", r"\bif \((.*)\)(?= [\w*{]|$)", r"if (!(\1))"), ("condition", r" && ", " || "),
    ("condition", r" \|\| ", " && "), ("condition", r" == ", " != "),
    ("branch", r" \? ([\w.>\-]+) : ([\w.>\-]+)", r" ? \2 : \1"),
    ("missing term", r"(?<=[\w)\]]) [+-] [\w.>\-\[\]]+ \* [\w.>\-\[\]]+(?=[;,)])", ""),
    ("missing statement",
     r"^( +)(?!return|const|int|double|static|struct|else|for|if|case|break|continue)"
                          r"[\w.>\-\[\]]+ (?:=|\+=|-=|\*=) .*;$", r"\1;"),
    ("missing statement", r"^( +)(?!return|sizeof)\w+\([^;{}]*\);$", r"\1;"),
]


def code_lines(text):
    """(number, line) of the lines that hold code only: no comment, string, preprocessor or
    macro."""
    comment = False
    for number, line in enumerate(text.split("\n"), 1):
        plain = not comment and "/*" not in line and '"' not in line and not line.startswith("#") \
            and not line.endswith("\\")
        if plain and line.strip():
            yield number, line
        comment = (comment or "/*" in line) and "*/" not in line.split("/*")[-1]


def candidates(path):
    """All faults that the rules make of a file."""
    for number, line in code_lines(path.read_text()):
        if not line.startswith(" "):
            continue
        for kind, pattern, instead in RULES:
            for match in re.finditer(pattern, line):
                changed = line[:match.start()] + match.expand(instead) + line[match.end():]
                yield {"file": str(path.relative_to(ROOT)), "line": number, "kind": kind,
                       "before": line.strip(), "after": changed.strip(), "text": changed}


def draw(paths, count, seed):
    """So many faults, from every file, by its number of lines; the same for the same seed and
    sources."""
    dice, chosen = random.Random(seed), []
    found = {path: list(candidates(path)) for path in paths}
    total = sum(map(len, found.values()))
    for path, faults in sorted(found.items()):
        n = min(len(faults), max(1, round(count * len(faults) / total)))
        chosen += dice.sample(faults, n)
    dice.shuffle(chosen)
    return chosen


class Program:
    """A build without faults: how its objects are compiled and linked."""

    def __init__(self, config):
        self.build = ROOT / "build" / config
        goals = [f"build/{config}/{t.removesuffix('.c')}" for t in all_tests() if t.endswith(".c")]
        subprocess.run(["make", "-s", "-j2", "SETUP=no", f"CONFIG={config}", "all", *goals],
                       cwd=ROOT,
                       check=True)
        info = subprocess.run(["make", "-s", "SETUP=no", f"CONFIG={config}", "info"], cwd=ROOT,
                              check=True,
                              capture_output=True, text=True).stdout
        self.compile = re.search(r"^compile +(.*)", info, re.M)[1].split()
        self.libraries = re.search(r"^link +(.*)", info, re.M)[1].split()
        self.uses = {}  # header or source: objects
        for path in self.build.glob("src/*/*.d"):
            for name in re.findall(r"src/[\w./]+", path.read_text().split("\n\n")[0]):
                self.uses.setdefault(name, set()).add(path.with_suffix(".o"))
        self.support = sorted(map(str, self.build.glob("tests/support/*.o"))) + [str(self.build /
                                                                                     "unity.o")]
        self.sound = {}  # test: whether it passes without a fault

    def passes(self, test, seconds):
        if test not in self.sound:
            status, _ = run_test(test, self.build, self.build / "sphfsi", seconds)
            self.sound[test] = status == 0
        return self.sound[test]


class Tests:
    """The tests: how long they take without faults, and which lines they run."""

    def __init__(self, program, jobs):
        self.seconds = self.baseline(program, jobs)
        self.kept = coverage.collect([t for t, s in self.seconds.items() if s <= LONGEST], jobs)
        self.taken = {name: one["files"] for name, one in self.kept.items()}
        self.uses = {file: {str(o.relative_to(program.build).with_suffix(".c")) for o in objects}
                     for file, objects in program.uses.items()}

    def baseline(self, program, jobs):
        """{test: seconds of the processor}, of those that pass on the build without faults in
        time."""
        kept, seconds = WORK / "baseline.json", {}
        key = coverage.digest_of(coverage.sources())
        if kept.exists() and (old := json.loads(kept.read_text()))["key"] == key:
            seconds = old["seconds"]

        def measure(test):
            name = f"{test} {coverage.digest_of([ROOT / test])}"
            if name not in seconds:
                status, used = run_test(test, program.build, program.build / "sphfsi", 2 * LONGEST)
                with LOCK:
                    seconds[name] = used if status == 0 else None
                    kept.write_text(json.dumps({"key": key, "seconds": seconds}))
                print(f"{test}: {used:.1f} s, exit status {status}", flush=True)
            return test, seconds[name]

        with ThreadPoolExecutor(jobs) as pool:
            return {test: used for test, used in pool.map(measure, all_tests()) if used is not None}

    def covering(self, fault):
        """The tests that run the line, the shortest first; those of its own folder count as
        shorter."""
        folder = fault["file"].split("/")[1]
        lines = {t: files.get(fault["file"], {"lines": {}})["lines"] for t,
                 files in self.taken.items()}
        # A statement of several lines counts on its first, or on some of them.
        known = {int(line) for one in lines.values() for line in one if int(line) <= fault["line"]}
        line = str(max(known, default=0))
        names = [test for test, one in lines.items() if test in self.seconds and one.get(line)]
        if not any(lines.values()):  # constants only: whatever runs a file that includes it
            names = [test for test, files in self.taken.items() if test in self.seconds and any(
                any(files.get(file, {"lines": {}})["lines"].values())
                for file in self.uses[fault["file"]])]
        return sorted(names, key=lambda t: self.seconds[t] * (0.2 if f"/{folder}/" in t else 1))


class Named:
    """Tests named by parts of their paths, whatever lines they run."""

    def __init__(self, parts):
        names = [test for test in all_tests() if any(part in test for part in parts.split(","))]
        self.seconds = dict.fromkeys(names, LONGEST)

    def covering(self, fault):
        return list(self.seconds)


def build(program, fault, folder):
    """The objects that the fault changes; None: it does not compile."""
    source = folder / "tree" / fault["file"]
    source.parent.mkdir(parents=True)
    lines = (ROOT / fault["file"]).read_text().split("\n")
    lines[fault["line"] - 1] = fault["text"]
    source.write_text("\n".join(lines))
    objects, version = [], f'-DSPHFSI_VERSION="{(program.build / "version").read_text().strip()}"'
    for old in sorted(program.uses.get(fault["file"], ())):
        name = str(old.relative_to(program.build).with_suffix(".c"))
        path = source if name == fault["file"] else ROOT / name
        new = folder / str(old.relative_to(program.build)).replace("/", "_")
        first = [program.compile[0], f"-I{folder}/tree/src"]
        made = subprocess.run([*first, *program.compile[1:], "-w", version, "-c", "-o", new, path],
                              cwd=ROOT,
                              capture_output=True)
        if made.returncode:
            return None
        if new.read_bytes() != old.read_bytes():
            objects.append(str(new))
    return objects


def object_of_test(program, test, fault, folder):
    """The test's object, compiled anew if it includes the header with the fault."""
    old = program.build / test.replace(".c", ".o")
    if not fault["file"].endswith(".h") or fault["file"] not in old.with_suffix(".d").read_text():
        return str(old)
    new = folder / "test.o"
    unity = re.search(r"^UNITY_CFLAGS := (.*)", (ROOT / "build/unity.mk").read_text(),
                      re.M)[1].split()
    subprocess.run([program.compile[0], f"-I{folder}/tree/src", *program.compile[1:], "-w",
                    "-Itests/support",
                    *unity, "-c", "-o", new, test], cwd=ROOT, check=True)
    return str(new)


def link(program, test, fault, objects, folder):
    """The test, or for a script the program, with the objects in front of those without the
    fault."""
    if test.endswith(".c"):
        out = folder / test.removesuffix(".c")
        parts = [object_of_test(program, test, fault, folder), *program.support]
    else:
        out, parts = folder / "sphfsi", [str(program.build / "src/app/main.o")]
    if out.exists():
        return
    out.parent.mkdir(parents=True, exist_ok=True)
    named = re.findall(r"^ \* --wrap: ([\w ]+)", (ROOT / test).read_text(), re.M)
    wrap = [f"-Wl,--wrap={name}" for name in " ".join(named).split()] if test.endswith(".c") else []
    parts = [part for part in parts if not any(o.endswith("src_app_main.o") for o in objects)
             or not part.endswith("main.o")]
    core = str(program.build / "core.a")
    subprocess.run([*program.compile, "-w", *wrap, "-o", out, *parts, *objects, core,
                    *program.libraries],
                   cwd=ROOT, check=True)
    if "/python/" in test:
        rest = [str(o) for o in program.build.glob("src/*/*.o") if o.name != "main.o"
                and not any(x.endswith(str(o.relative_to(program.build)).replace("/", "_"))
                            for x in objects)]
        subprocess.run([*program.compile, "-w", "-shared", "-o", folder / "libsphfsi.so", *rest,
                        *[o for o in objects if not o.endswith("main.o")], *program.libraries],
                       cwd=ROOT, check=True)


def judge(program, tests, fault, seconds, slower=1):
    """(found, not found, not run, equivalent or does not compile; by what)"""
    folder = WORK / f"fault-{threading.get_ident()}"
    shutil.rmtree(folder, ignore_errors=True)
    try:
        objects = build(program, fault, folder)
        if objects is None:
            return "does not compile", ""
        if not objects:
            return "equivalent", "same object code"
        used, tried = 0, []
        for test in tests.covering(fault):
            usual = slower * tests.seconds[test]
            # The interpreter is not built with the sanitizer.
            if slower > 1 and (test.endswith(".py") or
                               not program.passes(test, int(20 + 5 * usual))):
                continue
            if tried and used + usual > seconds:
                break
            try:
                link(program, test, fault, objects, folder)
            except subprocess.CalledProcessError:
                return "found", "linker"
            status, own = run_test(test, folder, folder / "sphfsi", int(5 + 5 * usual))
            used += own
            tried.append(test)
            if status not in (0, SKIPPED):
                return "found", test
        return ("not found", ", ".join(tried)) if tried else ("not run", "")
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def key(fault):
    return fault["file"], fault["before"], fault["after"]


def explained():
    """{fault: reason}: groups of four lines, file, before, after and reason, with a blank line
    between."""
    groups = EXPLAINED.read_text().strip().split("\n\n") if EXPLAINED.exists() else []
    rows = [[line.strip() for line in group.split("\n")] for group in groups]
    return {(file, before, after): " ".join(reason) for file, before, after, *reason in rows}


def standing(fault):
    """The fault on the line where its text stands in the present source; None: the line is gone."""
    path = ROOT / fault["file"]
    lines = path.read_text().split("\n") if path.exists() else []
    numbers = [k for k, line in enumerate(lines, 1) if line.strip() == fault["before"]]
    if not numbers:
        return None
    number = min(numbers, key=lambda k: abs(k - fault["line"]))
    indent = len(lines[number - 1]) - len(lines[number - 1].lstrip())
    return {**fault, "line": number, "text": " " * indent + fault["after"]}


def table(rows, *heads):
    return ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads),
            *("| " + " | ".join(str(cell) for cell in row) + " |" for row in rows), ""]


def listed(results):
    for r in results:
        before, after = (r[name].replace("|", "\\|") for name in ("before", "after"))
        by = r.get("by", "")
        if r["verdict"].startswith("not "):  # by name the list would be long
            by = len(by.split(", ")) if by else 0
        yield f"{r['file']}:{r['line']}", r["kind"], f"`{before}`", f"`{after}`", by


def counted(results, name="verdict"):
    """(found, of so many that are not equivalent, share in words)"""
    count = Counter(r[name] for r in results)
    real = count["found"] + count["not found"] + count["not run"]
    return count["found"], real, f"{100 * count['found'] / real:.1f} %" if real \
        else "an unknown share"


def samples(results):
    """A line for each sample: how its faults were judged first, and what the present tests find of
    them."""
    rows = []
    for seed in sorted({r["seed"] for r in results}):
        own = [r for r in results if r["seed"] == seed and not (
            r["verdict"] == "equivalent" and r["first"].startswith("not "))]
        found, real, share = counted(own, "first")
        rows.append((seed, found if seed > 1 else "", real if seed > 1 else "", share if seed > 1
                     else "",
                     *counted([r for r in results if r["seed"] == seed])))
    return ["## By sample", "",
            "Tests are written for the faults of each sample that were not found. Only faults "
            "drawn anew, and judged before that, measure the tests. Faults that were later "
            "explained as equivalent do not count. Of the first sample the first verdicts were not "
            "kept.", "",
            *table(rows, "seed", "found at first", "of", "share", "found now", "of", "share")]


def report(results, seconds):
    """docs/mutants.md"""
    reasons, cover = explained(), json.loads(coverage.SUMMARY.read_text())
    fresh = max((r["seed"] for r in results), default=1)
    results = [{**r, **(standing(r) or {"verdict": "line deleted"})} for r in results]
    for r in results:
        if r["verdict"] in ("not found", "not run") and key(r) in reasons:
            r.update(verdict="equivalent", by=reasons[key(r)])
    results.sort(key=lambda r: (r["file"], r["line"]))
    count = Counter(r["verdict"] for r in results)
    found, real, share = counted(results)
    by_samples = samples(results)
    own = [r for r in results if r["verdict"] == "equivalent" and r["by"] != "same object code"]
    last = [r for r in results if r["seed"] == fresh and r not in own]
    at_first = counted(last, "first")
    sanitized = sum(r["verdict"] == "found" and r["by"].startswith(SANITIZER) for r in results)
    lines, all_lines, branches, all_branches = cover["all"]
    text = [
        "# What the tests find", "",
        f"Of {real} small faults put into the sources, the tests find {found}: {share}. This "
        f"includes tests written for faults that had not been found. Of {at_first[1]} faults drawn "
        f"anew last, before that, they found {at_first[2]}. {cover['tests']} of {cover['of']} "
        f"tests run {100 * lines / all_lines:.2f} % of the {all_lines} lines of `src/` and take "
        f"{100 * branches / all_branches:.2f} % of the {all_branches} branches (version "
        f"{cover['version']}).",
        "",
        f"The faults lie in {len({r['file'] for r in results})} files and were drawn with a seed. "
        f"{count['equivalent']} further faults change nothing: {count['equivalent'] - len(own)} "
        f"give the same object code, {len(own)} are explained below. {count['does not compile']} "
        f"do not compile. {count['line deleted']} stood on lines that have since been changed or "
        f"deleted. {sanitized} are found with the build of `make test-sanitize` only. The tests "
        f"that run its line, the shortest first, have {seconds:.0f} s of the processor to find a "
        f"fault. Tests of more than {LONGEST} s were run with faults only if named by hand. So the "
        "share is a lower bound, and faults that are equivalent for a reason nobody has written "
        "down count as not found.", "",
        "`make mutants` writes this page. A fault flips a sign, changes a factor, shifts a limit "
        "by one, drops a term or a statement, or inverts a condition. A branch is one outcome of a "
        "jump in the unoptimised build (gcov); copies of an inlined line count "
        "once.", "", *by_samples,
        "## By folder", ""]
    rows = []
    for folder, share in cover["folders"].items():
        c = Counter(r["verdict"] for r in results if r["file"].split("/")[1] == folder)
        rows.append((folder, c["found"], c["not found"], c["not run"], c["equivalent"],
                     f"{100 * share[0] / share[1]:.2f} %",
                     f"{100 * share[2] / max(1, share[3]):.2f} %"))
    text += table(rows, "folder", "found", "not found", "on no line that tests run", "equivalent",
                  "lines",
                  "branches")
    text += ["## By kind of fault", ""]
    rows = [(kind, sum(r["kind"] == kind and r["verdict"] == "found" for r in results),
             sum(r["kind"] == kind and r["verdict"].startswith("not") for r in results))
            for kind in sorted({r["kind"] for r in results})]
    text += table(rows, "kind", "found", "not found")
    text += ["## Not found", "",
             *table(listed(r for r in results if r["verdict"].startswith("not ")),
                                       "where", "kind", "before", "after", "tests that were run")]
    text += ["## Equivalent", "", *table(listed(own), "where", "kind", "before", "after", "why"),
             *left_over(cover["missing"])]
    (ROOT / "docs/mutants.md").write_text("\n".join(text).rstrip() + "\n")
    print("\n".join(text[:6]))


def left_over(missing):
    """The lines that no test runs, with the reason that tests/mutants/uncovered.txt gives for their
    text."""
    path = ROOT / "tests" / "mutants" / "uncovered.txt"
    groups = path.read_text().strip().split("\n\n") if path.exists() else []
    reasons = {}
    for file, *rest in ([line.strip() for line in group.split("\n")] for group in groups):
        reasons |= {(file, line): rest[-1] for line in rest[:-1]}
    rows = [(f"{file}:{line}", "`" + text.replace("|", "\\|") + "`", reasons.get((file, text), ""))
            for file, line, text in missing]
    return ["## Lines that no test runs", "", *table(rows, "where", "line", "why")]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0], epilog=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=440)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--files", default="src", help="folder or file of src/")
    parser.add_argument("--minutes", type=float, default=1e9, help="stop after so long, and write "
                                                                   "the report")
    parser.add_argument("--seconds", type=float, default=8, help="of the processor, for one "
                                                                 "fault's tests")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--again", action="store_true", help="judge anew what was not found")
    parser.add_argument("--tests", help="judge by these only, parts of their paths with commas; "
                                        "what they do not find keeps its verdict")
    parser.add_argument("--report", action="store_true", help="only write docs/mutants.md")
    args = parser.parse_args()
    results = json.loads(KEPT.read_text()) if KEPT.exists() else []
    if args.report:
        report(results, args.seconds)
        return 0
    WORK.mkdir(parents=True, exist_ok=True)
    KEPT.parent.mkdir(exist_ok=True)
    program = Program("mutant")
    tests = Named(args.tests) if args.tests else Tests(program, args.jobs)
    seconds = float("inf") if args.tests else args.seconds
    under = ROOT / args.files
    if args.again:
        reasons = explained()
        faults = [now for r in results if r["verdict"].startswith("not ") and key(r) not in reasons
                  and (ROOT / r["file"]).is_relative_to(under) and (now := standing(r))]
    else:
        paths = [under] if under.is_file() else \
            sorted(p for p in under.rglob("*") if p.suffix in (".c", ".h"))
        done = {key(r) for r in results}
        faults = [f for f in draw(paths, args.count, args.seed) if key(f) not in done]
    start = time.time()

    def one(fault, program, slower):
        if time.time() - start > 60 * args.minutes:
            return
        verdict, by = judge(program, tests, fault, slower * seconds, slower)
        if args.tests and verdict.startswith("not ") or slower > 1 and verdict != "found":
            return
        if slower > 1:
            by = f"{SANITIZER}, {by}"
        with LOCK:
            known = [r for r in results if key(r) == key(fault)]
            first = known[0]["first"] if args.again else verdict
            results[:] = [r for r in results if r not in known]
            results.append({**fault, "verdict": verdict, "by": by, "first": first,
                            "seed": fault.get("seed", args.seed)})
            KEPT.write_text(json.dumps(results, indent=1) + "\n")
            where = f"{fault['file']}:{fault['line']}"
            print(f"{len(results)} {where} {fault['kind']}: {verdict} {by}", flush=True)

    with ThreadPoolExecutor(args.jobs) as pool:
        list(pool.map(lambda fault: one(fault, program, 1), faults))
    drawn = {key(fault) for fault in faults}
    missed = [r for r in results if key(r) in drawn and r["verdict"].startswith("not ")]
    if missed:
        sanitized = Program("sanitize")
        with ThreadPoolExecutor(args.jobs) as pool:
            list(pool.map(lambda fault: one(fault, sanitized, 4), missed))
    report(results, args.seconds)
    return 0


if __name__ == "__main__":
    sys.exit(main())
