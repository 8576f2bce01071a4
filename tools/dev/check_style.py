#!/usr/bin/env python3
"""Checks what a formatter cannot: layers, sizes, words, flags and exported symbols.

Prints one line per finding, `file:line: what`; warnings do not fail. Needs only Python itself.

example: tools/dev/check_style.py --library build/release/libsphfsi.a
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import layers
import prose
import repeats

ROOT = Path(__file__).resolve().parents[2]

MAX_FILE = 600      # lines
MAX_FUNCTION = 60   # lines; more is a warning
MAX_COLUMNS = 100   # of code, tables and scripts; not of prose in Markdown
CLANG_FORMAT = 14   # other versions break lines differently
# Written apart, so that this file does not find itself.
BANNED = re.compile(r"\bFIX" r"ME\b|\bXX" r"X\b|\bTO" r"DO\b(?!\s*\(#\d+\))")

errors = 0


def report(path, line, text, warning=False):
    global errors
    errors += not warning
    where = f"{path.relative_to(ROOT)}:{line}" if line else f"{path.relative_to(ROOT)}"
    print(f"{where}: {'warning: ' if warning else ''}{text}")


def check_sizes(path, lines):
    if len(lines) > MAX_FILE:
        report(path, 0, f"{len(lines)} lines, more than {MAX_FILE}")
    start = None
    for number, line in enumerate(lines, 1):
        if line == "{":
            start = number
        elif line == "}" and start:
            if number - start - 1 > MAX_FUNCTION:
                report(path, start, f"function of {number - start - 1} lines, more than "
                       f"{MAX_FUNCTION}", warning=True)
            start = None


def check_text(path, lines):
    for number, line in enumerate(lines, 1):
        if path.suffix in (".c", ".h", ".def") and "\t" in line:
            report(path, number, "tab")
        # A formula of a case cannot go on in another line.
        formula = path.suffix == ".cfg" and "=" in line.split("#")[0]
        if path.suffix != ".md" and not formula and len(line) > MAX_COLUMNS:
            report(path, number, f"{len(line)} columns, more than {MAX_COLUMNS}")
        if line != line.rstrip():
            report(path, number, "blanks at the end")
        word = BANNED.search(line)
        if word:
            report(path, number, f"{word[0]} (an issue's number makes the last one acceptable)")


# A string of a user must never reach a shell: no other program is started at all.
PROGRAMS = re.compile(r"\b(system|popen|exec[lv]p?e?|execvpe|fexecve|fork|vfork|"
                      r"posix_spawnp?)\s*\(")


def check_programs(path, lines):
    for number, line in enumerate(lines, 1):
        call = PROGRAMS.search(line)
        if call and path.suffix in (".c", ".h", ".def"):
            report(path, number, f"{call[1]}() starts another program")


def documents():
    """Those of the project: not those of packages in .venv, build/ or runs/."""
    return [p for p in ROOT.rglob("*.md")
            if not any(part[0] == "." or part in ("build", "runs")
                       for part in p.relative_to(ROOT).parts)]


def check_sentences(path):
    """Reports that a tool writes and dated notes are left out."""
    if "results" in path.parts or "notes" in path.parts:
        return
    for line, count, sentence in prose.long_sentences(path):
        report(path, line, f"a sentence of {count} words, more than {prose.LIMIT}: {sentence[:60]}")


# What C libraries round in different ways. app/ forecasts and prints; nothing there enters a state.
ROUNDED = re.compile(r"(?<![\w.\"])(sin|cos|tan|a?sinh?|a?cosh?|a?tanh?|atan2|exp2?|expm1|"
                     r"log(?:2|10|1p)?|cbrt|pow|hypot|erf)f?\((?!\))")


def check_rounding(path, lines):
    """Results have the same bits with every C library."""
    if path.parts[len(ROOT.parts) + 1] == "app" or path.stem == "elementary":
        return
    code = re.sub(r"/\*.*?\*/|\"(\\.|[^\"\\])*\"", lambda hit: "\n" * hit[0].count("\n"),
                  "\n".join(lines), flags=re.S)
    for number, line in enumerate(code.split("\n"), 1):
        for call in ROUNDED.finditer(line):
            report(path, number, f"{call[1]}() has other bits with other C libraries; "
                                 f"base/elementary.h")


def check_flags():
    """Makefile and CMakeLists.txt compile with the same flags and carry the same version."""
    make, cmake = ROOT / "Makefile", ROOT / "CMakeLists.txt"
    makefile, cmakelists = make.read_text(), cmake.read_text()
    ours = set(" ".join(re.findall(r"^(?:COMMON|WARN) *[:+]= (-.*)$", makefile, re.M)).split())
    listed = re.search(r"set\(SPHFSI_FLAGS(.*?)\)", cmakelists, re.S)
    theirs = {flag for flag in listed[1].split() if not flag.startswith(("-march=", "$"))}
    for flag in sorted(ours ^ theirs):
        report(cmake if flag in ours else make, 0, f"lacks the flag {flag} of the other build")
    versions = [re.search(r"^VERSION := (\S+)", makefile, re.M)[1],
                re.search(r"project\(sphfsi VERSION (\S+)", cmakelists)[1],
                re.search(r"^version: (\S+)", (ROOT / "CITATION.cff").read_text(), re.M)[1]]
    if len(set(versions)) > 1:
        report(make, 0, f"version {versions[0]}, CMakeLists.txt {versions[1]}, "
               f"CITATION.cff {versions[2]}")


def check_repeats():
    files = {str(path.relative_to(ROOT / "src")): path.read_text(encoding="utf-8")
             for path in sorted((ROOT / "src").rglob("*.[ch]"))}
    for name, line, text in repeats.findings(files):
        report(ROOT / "src" / name, line, text)


def check_symbols(library):
    """What the library shows to programs that are linked with it begins with sphfsi_."""
    tool = shutil.which("readelf")
    if not tool:
        print("exported symbols not checked: no readelf here")
        return
    which = "--dyn-syms" if library.suffix == ".so" else "-s"
    table = subprocess.run([tool, which, "-W", library], capture_output=True, text=True, check=True)
    for line in table.stdout.splitlines():
        column = line.split()
        if len(column) == 8 and column[4] in ("GLOBAL", "WEAK") \
                and column[6] != "UND" and not column[7].startswith("sphfsi_"):
            report(library, 0, f"exports {column[7]}; hide it or name it sphfsi_...")


# Commits before this one had other habits.
FIRST_CHECKED = "08a1f7c"
# `Add`, `Pass`, `Need`; not `Added`, `Adding`, `Adds`, `Tests: ...`.
IMPERATIVE = re.compile(r"(?!(?!Bring|Embed)\w+(?:[^e]ed|ing|[^s]s)\b)[A-Z][a-z]+(?:-[a-z]+)? \S")


def check_commits():
    """Subjects of new commits: the imperative, at most 72 columns, no full stop."""
    log = subprocess.run(["git", "-C", ROOT, "log", "--no-merges", "--format=%h %s",
                          f"{FIRST_CHECKED}..HEAD"], capture_output=True, text=True)
    if log.returncode:
        print("commit subjects not checked: no git history here")
        return
    for line in log.stdout.splitlines():
        commit, subject = line.split(" ", 1)
        if len(subject) > 72 or subject.endswith(".") or not IMPERATIVE.match(subject):
            report(ROOT / "CONTRIBUTING.md", 0, f"commit {commit}: `{subject}` is not an imperative"
                   " of at most 72 columns without a full stop")


def check_format(paths):
    tool = shutil.which(f"clang-format-{CLANG_FORMAT}") or shutil.which("clang-format")
    version = subprocess.run([tool, "--version"], capture_output=True,
                             text=True).stdout if tool else ""
    if f"version {CLANG_FORMAT}." not in version:
        print(f"format not checked: no clang-format {CLANG_FORMAT} here")
        return
    for path in paths:
        result = subprocess.run([tool, "--dry-run", "-Werror", path], capture_output=True,
                                text=True)
        if result.returncode:
            line = re.match(r"[^:]*:(\d+):", result.stderr)
            report(path, int(line[1]) if line else 0, "not formatted; `make format` does it")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--library", type=Path, action="append", default=[],
                        help="library whose exported symbols to check")
    args = parser.parse_args()

    code = [path for folder in ("src", "include", "tests", "bench", "tools", "cases", "examples",
                                "python", "web")
            for path in sorted((ROOT / folder).rglob("*"))
            if path.suffix in (".c", ".h", ".def", ".py", ".sh", ".cfg")]
    for path in code + [ROOT / "Makefile", ROOT / "CMakeLists.txt"] + sorted(ROOT.glob("*.md")):
        lines = path.read_text(encoding="utf-8").splitlines()
        check_text(path, lines)
        if path.parts[len(ROOT.parts)] in ("src", "include"):
            check_programs(path, lines)
        if path.parts[len(ROOT.parts)] == "src" and path.suffix in (".c", ".h"):
            check_rounding(path, lines)
        if path.suffix in (".c", ".h", ".py", ".sh"):
            check_sizes(path, lines)
        tool = path.parts[len(ROOT.parts)] in ("tools", "web")  # called by name in examples
        if tool and lines and lines[0].startswith("#!") and not os.access(path, os.X_OK):
            report(path, 0, "begins with #! but is not executable; chmod +x")
    build = args.library[0].resolve().parent if args.library else None
    for path in sorted(documents() + code):
        if path.suffix == ".md" or path.parts[len(ROOT.parts)] in ("src", "include", "bench"):
            if path.suffix in prose.READERS:
                check_sentences(path)
    for where, line, text in layers.findings(ROOT, build):
        report(where, line, text)
    check_flags()
    check_repeats()
    check_commits()
    check_format([path for path in code if path.suffix in (".c", ".h")])
    for library in args.library:
        check_symbols(library.resolve())
    print(f"style: {errors} error{'s' * (errors != 1)}")
    return errors > 0


if __name__ == "__main__":
    sys.exit(main())
