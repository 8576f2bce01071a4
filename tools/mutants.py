#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures the tests: puts small faults into the sources, one at a time, and counts those that a test finds.

    tools/mutants.py --count 400        400 faults drawn with a seed, results into docs/mutants.md (hours)
    tools/mutants.py --files src/solid  faults of one folder or file only

A fault flips a sign, changes a factor, shifts a limit by one, drops a term or a statement, or inverts a
condition. For each, the C tests that run the changed line (by gcov) are run, the shortest first. A fault
whose object code is that of the program is equivalent. Results are kept in build/mutants/results.json, and
a run that was interrupted goes on from there.
"""
import argparse
import hashlib
import json
import os
import random
import re
import shutil
import subprocess
import sys
import time
from collections import Counter, defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
WORK = ROOT / "build" / "mutants"
TREE = WORK / "tree"
ENV = {**os.environ, "OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive"}
# kind: (pattern, replacement); each match on a line of code is a candidate.
RULES = [
    ("sign", r"(?<=[\w)\]]) \+ (?=[\w(*])", " - "), ("sign", r"(?<=[\w)\]]) - (?=[\w(*])", " + "),
    ("sign", r" \+= ", " -= "), ("sign", r" -= ", " += "), ("sign", r"(?<=return )-(?=[\w(])", ""),
    ("factor", r"\b0\.5\b", "0.25"), ("factor", r"(?<![\w.\[])2(?= \* \w)", "3"), ("factor", r"\b1e-", "3e-"),
    ("factor", r"(?<=\w) \* (?=\w)", " / "),
    ("off by one", r"(?<=[\w)\]]) < (?=[\w(])", " <= "), ("off by one", r"(?<=[\w)\]]) <= (?=[\w(])", " < "),
    ("off by one", r"(?<=[\w)\]]) > (?=[\w(])", " >= "), ("off by one", r" \+ 1\b(?!\.)", ""),
    ("off by one", r" - 1\b(?!\.)", ""),
    ("condition", r"\bif \((.*)\)(?= [\w*{]|$)", r"if (!(\1))"), ("condition", r" && ", " || "),
    ("condition", r" \|\| ", " && "), ("condition", r" == ", " != "),
    ("branch", r" \? ([\w.>\-]+) : ([\w.>\-]+)", r" ? \2 : \1"),
    ("missing term", r"(?<=[\w)\]]) [+-] [\w.>\-\[\]]+ \* [\w.>\-\[\]]+(?=[;,)])", ""),
    ("missing statement", r"^( +)(?!return|const|int|double|static|struct|else|for|if|case|break|continue)"
                          r"[\w.>\-\[\]]+ (?:=|\+=|-=|\*=) .*;$", r"\1;"),
    ("missing statement", r"^( +)(?!return|sizeof)\w+\([^;{}]*\);$", r"\1;"),
]


def run(words, **more):
    return subprocess.run(words, cwd=TREE, env=ENV, capture_output=True, text=True, **more)


def code_lines(text):
    """(number, line) of the lines that hold code only: no comment, string, preprocessor or macro."""
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
    """So many faults, from every file, by its number of lines; the same for the same seed and sources."""
    dice, chosen = random.Random(seed), []
    found = {path: list(candidates(path)) for path in paths}
    total = sum(map(len, found.values()))
    for path, faults in sorted(found.items()):
        n = min(len(faults), max(1, round(count * len(faults) / total)))
        chosen += dice.sample(faults, n)
    return chosen


def copy_tree():
    WORK.mkdir(parents=True, exist_ok=True)
    TREE.mkdir(exist_ok=True)
    for name in ("src", "include", "tests", "cases", "bench", "tools", "data"):
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, TREE / name, dirs_exist_ok=True)
    for name in ("Makefile", ".clang-format"):
        shutil.copy2(ROOT / name, TREE)
    (TREE / "build").mkdir(exist_ok=True)
    for path in (ROOT / "build").iterdir():
        if path.is_file():
            shutil.copy2(path, TREE / "build")
    if (ROOT / "build/deps").is_dir():
        shutil.copytree(ROOT / "build/deps", TREE / "build/deps", dirs_exist_ok=True)


def make(config, goals, timeout=1200):
    return run(["make", "-s", "-j2", "SETUP=no", f"CONFIG={config}", *goals], timeout=timeout)


def tests():
    return sorted(path for path in (TREE / "tests").glob("*/test_*.c"))


def goal(config, test):
    return f"build/{config}/tests/{test.parent.name}/{test.stem}"


def coverage():
    """{test: {"seconds": s, "lines": {file: [numbers]}}}, by a build with gcov."""
    kept = WORK / "coverage.json"
    if kept.exists():
        return json.loads(kept.read_text())
    built = make("coverage", [goal("coverage", test) for test in tests()], timeout=3600)
    if built.returncode:
        sys.exit(f"the coverage build fails:\n{built.stderr[-2000:]}")
    result = {}
    for test in tests():
        for old in (TREE / "build/coverage").rglob("*.gcda"):
            old.unlink()
        start = time.time()
        try:
            passed = run([goal("coverage", test)], timeout=600).returncode == 0
        except subprocess.TimeoutExpired:
            passed = False
        if not passed:
            print(f"{test.stem}: left out, it fails or takes too long in the coverage build", flush=True)
            continue
        seconds, lines = time.time() - start, defaultdict(set)
        data = sorted(map(str, (TREE / "build/coverage/src").rglob("*.gcda")))
        for line in run(["gcov", "--json-format", "--stdout", *data]).stdout.splitlines():
            for file in json.loads(line)["files"]:
                name = file["file"]
                name = str(Path(name).relative_to(TREE)) if name.startswith("/") else name
                lines[name] |= {row["line_number"] for row in file["lines"] if row["count"]}
        result[f"{test.parent.name}/{test.stem}"] = {"seconds": seconds, "lines": {
            name: sorted(numbers) for name, numbers in lines.items() if name.startswith("src/")}}
        print(f"{test.stem}: {seconds:.1f} s", flush=True)
    kept.write_text(json.dumps(result))
    return result


def objects():
    """Digest of all object code of the library, without debugging information."""
    digest = hashlib.sha256()
    for path in sorted((TREE / "build/mutant/src").rglob("*.o")):
        stripped = WORK / "stripped.o"
        subprocess.run(["strip", "--strip-debug", "-o", stripped, path], check=True)
        digest.update(stripped.read_bytes())
    return digest.hexdigest()


def judge(fault, covered, original, time_of):
    """found (by which test), not found, not run by any C test, equivalent, or does not compile."""
    path = TREE / fault["file"]
    text = path.read_text()
    lines = text.split("\n")
    lines[fault["line"] - 1] = fault["text"]
    path.write_text("\n".join(lines))
    try:
        names = sorted((name for name, one in covered.items()
                        if fault["line"] in one["lines"].get(fault["file"], ())), key=time_of.get)
        if make("mutant", ["build/mutant/libsphfsi.a"]).returncode:
            return "does not compile", ""
        if objects() == original:
            return "equivalent", "same object code"
        for name in names:
            if make("mutant", [f"build/mutant/tests/{name}"]).returncode:
                return "found", "compiler"
            try:
                if run([f"build/mutant/tests/{name}"], timeout=10 + 10 * time_of[name]).returncode:
                    return "found", name
            except subprocess.TimeoutExpired:
                return "found", f"{name} (time limit)"
        return ("not found", ", ".join(names[:3])) if names else ("not run", "")
    finally:
        path.write_text(text)


def report(results, args):
    count = Counter(result["verdict"] for result in results)
    real = count["found"] + count["not found"] + count["not run"]
    share = 100 * count["found"] / real if real else 0
    lines = ["# Faults that the tests find", "",
             f"Of {real} faults that change the program, the C tests find {count['found']}: {share:.1f} %. "
             f"{count['not found']} lie on lines that a test runs and are not found; {count['not run']} lie "
             f"on lines that no C test runs. {count['equivalent']} further ones change no object code.", "",
             f"Written by `make mutants` (seed {args.seed}); scripts under tests/ are not run here.", "",
             "| folder | found | not found | not run |", "|---|---|---|---|"]
    for folder in sorted({result["file"].split("/")[1] for result in results}):
        own = Counter(r["verdict"] for r in results if r["file"].split("/")[1] == folder)
        lines.append(f"| {folder} | {own['found']} | {own['not found']} | {own['not run']} |")
    lines += ["", "## Not found", "", "| where | kind | before | after |", "|---|---|---|---|"]
    for r in results:
        if r["verdict"] in ("not found", "not run"):
            before, after = (r[k].replace("|", "\\|") for k in ("before", "after"))
            where, what = f"{r['file']}:{r['line']}", f"{r['kind']}, {r['verdict']}"
            lines.append(f"| {where} | {what} | `{before}` | `{after}` |")
    (ROOT / "docs/mutants.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines[:12]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0], epilog=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--files", default="src", help="folder or file of src/")
    parser.add_argument("--minutes", type=float, default=1e9, help="stop after so long, and write the report")
    args = parser.parse_args()
    under = ROOT / args.files
    paths = [under] if under.is_file() else sorted(p for p in under.rglob("*") if p.suffix in (".c", ".h"))
    faults = draw(paths, args.count, args.seed)
    copy_tree()
    covered = coverage()
    time_of = {name: one["seconds"] for name, one in covered.items()}
    if make("mutant", ["build/mutant/libsphfsi.a"]).returncode:
        sys.exit("the program does not build")
    original = objects()
    kept = WORK / "results.json"
    results = json.loads(kept.read_text()) if kept.exists() else []
    done = {(r["file"], r["before"], r["after"]) for r in results}
    start = time.time()
    random.Random(args.seed).shuffle(faults)
    for k, fault in enumerate(faults):
        if (fault["file"], fault["before"], fault["after"]) in done:
            continue
        if time.time() - start > 60 * args.minutes:
            break
        verdict, by = judge(fault, covered, original, time_of)
        results.append({**fault, "verdict": verdict, "by": by})
        kept.write_text(json.dumps(results))
        where = f"{fault['file']}:{fault['line']}"
        print(f"{k + 1}/{len(faults)} {where} {fault['kind']}: {verdict} {by}", flush=True)
    report(sorted(results, key=lambda r: (r["file"], r["line"])), args)
    return 0


if __name__ == "__main__":
    sys.exit(main())
