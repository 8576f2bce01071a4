#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures the tests: puts small faults into the sources, one at a time, and counts those that a
test finds.

    mutants.py --count 440        faults drawn with a seed from all files, and the report (hours)
    mutants.py --files src/solid  faults of one folder or file only
    mutants.py --again            judges anew what was not found, for instance by new tests
    mutants.py --report           writes docs/results/mutants.md from what is kept

A fault flips a sign, changes a factor, shifts a limit by one, drops a term or a statement, or
inverts a condition. The objects that hold the changed line are compiled, and the tests that run it
(by gcov, tests/mutants/coverage.py) are linked and run, the shortest first, until one finds it or
their time is used up. Faults that none finds are judged again with the build of `make test-
sanitize`, which sees what is read behind an array, or not freed. A fault whose object code is that
of the program is equivalent. So are those that tests/mutants/equivalent.txt explains. Results are
kept in tests/mutants/results.json; a run that was interrupted goes on from there. How a fault was
judged first is kept beside its present verdict: tests are written for those of each sample that
were not found, so only a fresh sample measures the tests.
"""
import argparse
import json
import random
import re
import shutil
import subprocess
import threading
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import coverage
from coverage import ROOT, all_tests, run_test

SANITIZER = "AddressSanitizer"
WORK = ROOT / "build" / "mutants"
KEPT = ROOT / "tests" / "mutants" / "results.json"
SKIPPED = 77
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

    def __init__(self, program, jobs, longest):
        self.seconds = self.baseline(program, jobs, longest)
        kept = coverage.collect([t for t, s in self.seconds.items() if s <= longest], jobs)
        self.taken = {name: one["files"] for name, one in kept.items()}
        self.uses = {file: {str(o.relative_to(program.build).with_suffix(".c")) for o in objects}
                     for file, objects in program.uses.items()}

    def baseline(self, program, jobs, longest):
        """{test: seconds of the processor}, of those that pass on the build without faults in
        time."""
        kept, seconds = WORK / "baseline.json", {}
        key = coverage.digest_of(coverage.sources())
        if kept.exists() and (old := json.loads(kept.read_text()))["key"] == key:
            seconds = old["seconds"]

        def measure(test):
            name = f"{test} {coverage.digest_of([ROOT / test])}"
            if name not in seconds:
                status, used = run_test(test, program.build, program.build / "sphfsi",
                                        int(2 * longest))
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


def compiler(program, folder):
    """The command that finds the file with the fault first; its compiler may be several words."""
    k = program.compile.index("-Iinclude")
    return [*program.compile[:k], f"-I{folder}/tree/src", *program.compile[k:], "-w"]


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
        made = subprocess.run([*compiler(program, folder), version, "-c", "-o", new, path],
                              cwd=ROOT, capture_output=True)
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
    subprocess.run([*compiler(program, folder), "-Itests/support", *unity, "-c", "-o", new, test],
                   cwd=ROOT, check=True)
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


def groups(name):
    """Groups of lines of a text in tests/mutants, with a blank line between."""
    path = KEPT.with_name(name)
    text = path.read_text().strip() if path.exists() else ""
    return [[line.strip() for line in group.split("\n")] for group in text.split("\n\n") if group]


def explained():
    """{fault: reason}: groups of file, line before, line after and reason."""
    return {(file, before, after): " ".join(reason)
            for file, before, after, *reason in groups("equivalent.txt")}


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
    return "\n".join(["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads),
                      *("| " + " | ".join(map(str, row)) + " |" for row in rows)])


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
    """A row for each sample: how its faults were judged first, and what the present tests find of
    them."""
    for seed in sorted({r["seed"] for r in results}):
        own = [r for r in results if r["seed"] == seed]
        first = counted([r for r in own if not (
            r["verdict"] == "equivalent" and r["first"].startswith("not "))], "first")
        yield seed, *(first if seed > 1 else ("", "", "")), *counted(own)


def by_folder(results, folders):
    for folder, (lines, all_lines, branches, all_branches) in folders.items():
        c = Counter(r["verdict"] for r in results if r["file"].split("/")[1] == folder)
        yield (folder, c["found"], c["not found"], c["not run"], c["equivalent"],
               f"{100 * lines / all_lines:.2f} %",
               f"{100 * branches / max(1, all_branches):.2f} %")


def report(results, seconds, longest):
    """docs/results/mutants.md"""
    reasons, cover = explained(), json.loads(coverage.SUMMARY.read_text())
    seed = max((r["seed"] for r in results), default=1)
    results = [{**r, **(standing(r) or {"verdict": "line deleted"})} for r in results]
    for r in results:
        if r["verdict"] in ("not found", "not run") and key(r) in reasons:
            r.update(verdict="equivalent", by=reasons[key(r)])
    results.sort(key=lambda r: (r["file"], r["line"]))
    count, (found, real, share) = Counter(r["verdict"] for r in results), counted(results)
    own = [r for r in results if r["verdict"] == "equivalent" and r["by"] != "same object code"]
    fresh = counted([r for r in results if r["seed"] == seed and r not in own], "first")
    lines, all_lines, branches, all_branches = cover["all"]
    kinds = Counter((r["kind"], r["verdict"].split()[0]) for r in results)
    why = {(file, line): rest[-1] for file, *rest in groups("uncovered.txt") for line in rest[:-1]}
    where = ("where", "kind", "before", "after")
    text = Path(__file__).with_suffix(".md").read_text().format(
        real=real, found=found, share=share, fresh=fresh[1], fresh_share=fresh[2],
        tests=cover["tests"], all_tests=cover["of"], lines=100 * lines / all_lines,
        all_lines=all_lines, branches=100 * branches / all_branches, all_branches=all_branches,
        version=cover["version"],
        files=len({r["file"] for r in results if r["verdict"] != "line deleted"}),
        equivalent=count["equivalent"], same=count["equivalent"] - len(own), explained=len(own),
        broken=count["does not compile"], deleted=count["line deleted"],
        sanitized=sum(r["verdict"] == "found" and r["by"].startswith(SANITIZER) for r in results),
        seconds=seconds, longest=longest,
        samples=table(samples(results), "seed", "found at first", "of", "share", "found now", "of",
                      "share"),
        folders=table(by_folder(results, cover["folders"]), "folder", "found", "not found",
                      "on no line that tests run", "equivalent", "lines", "branches"),
        kinds=table([(kind, kinds[kind, "found"], kinds[kind, "not"])
                     for kind in sorted({r["kind"] for r in results})],
                    "kind", "found", "not found"),
        missed=table(listed(r for r in results if r["verdict"].startswith("not ")), *where,
                     "tests that were run"),
        own=table(listed(own), *where, "why"),
        left=table([(f"{file}:{line}", "`" + text.replace("|", "\\|") + "`",
                     why.get((file, text), "")) for file, line, text in cover["missing"]],
                   "where", "line", "why"))
    (ROOT / "docs/results/mutants.md").write_text(text.rstrip() + "\n")
    print("\n".join(text.split("\n")[:6]))


def judge_all(faults, program, tests, results, args, slower=1):
    """Judges faults, several at a time, and keeps each verdict at once. `slower`: by the build with
    the sanitizers, of which only what it finds counts."""
    def one(fault):
        verdict, by = judge(program, tests, fault, slower * args.seconds, slower)
        if slower > 1 and verdict != "found":
            return
        with LOCK:
            known = [r for r in results if key(r) == key(fault)]
            first = known[0]["first"] if args.again and known else verdict
            results[:] = [r for r in results if r not in known]
            results.append({**fault, "verdict": verdict, "first": first,
                            "by": f"{SANITIZER}, {by}" if slower > 1 else by,
                            "seed": fault.get("seed", args.seed)})
            KEPT.write_text(json.dumps(results, indent=1) + "\n")
            print(f"{len(results)} {fault['file']}:{fault['line']} {fault['kind']}: {verdict} {by}",
                  flush=True)
    with ThreadPoolExecutor(args.jobs) as pool:
        list(pool.map(one, faults))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=440)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--files", default="src", help="folder or file of src/")
    parser.add_argument("--seconds", type=float, default=8,
                        help="of the processor, for one fault's tests (%(default)g)")
    parser.add_argument("--longest", type=float, default=3, help="seconds of the processor: tests "
                        "that take longer are not run with faults (%(default)g)")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--again", action="store_true", help="judge anew what was not found")
    parser.add_argument("--report", action="store_true", help="only write docs/results/mutants.md")
    args = parser.parse_args()
    results = json.loads(KEPT.read_text()) if KEPT.exists() else []
    if args.report:
        report(results, args.seconds, args.longest)
        return
    WORK.mkdir(parents=True, exist_ok=True)
    program = Program("mutant")
    tests, under = Tests(program, args.jobs, args.longest), ROOT / args.files
    if args.again:
        reasons = explained()
        faults = [now for r in results if r["verdict"].startswith("not ") and key(r) not in reasons
                  and (ROOT / r["file"]).is_relative_to(under) and (now := standing(r))]
    else:
        paths = [under] if under.is_file() else \
            sorted(p for p in under.rglob("*") if p.suffix in (".c", ".h"))
        done = {key(r) for r in results}
        faults = [f for f in draw(paths, args.count, args.seed) if key(f) not in done]
    judge_all(faults, program, tests, results, args)
    drawn = {key(fault) for fault in faults}
    missed = [r for r in results if key(r) in drawn and r["verdict"].startswith("not ")]
    if missed:
        args.again = True
        judge_all(missed, Program("sanitize"), tests, results, args, slower=4)
    report(results, args.seconds, args.longest)


if __name__ == "__main__":
    main()
