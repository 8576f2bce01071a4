#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Keeps what is written about keys up to date with the program's own tables: the reference in
docs/cases.md, and the syntax of case files for VS Code in tools/vscode.

example:
  tools/cases_doc.py ./sphfsi            writes both anew
  tools/cases_doc.py ./sphfsi --check    exit status 1 if one is out of date
"""
import argparse
import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "cases.md"
SYNTAX = ROOT / "tools" / "vscode" / "sphfsi.tmLanguage.json"
MARKER = "<!-- What follows is written by `make docs` from the program's own tables. -->\n"


def page(keys):
    before = PAGE.read_text(encoding="utf-8")
    if MARKER not in before:
        sys.exit(f"{PAGE}: lacks the line that marks where the written part begins: {MARKER}")
    return before[:before.index(MARKER)] + MARKER + "\n" + keys


def section_rule(kind, section):
    """From the heading of a section to the next one: its keys and their choices are known words."""
    choices = sorted({word for key in section["keys"].values() for word in key.get("choices", ())})
    rules = [{"match": rf"^\s*({'|'.join(section['keys'])})\s*(?==)", "name": "variable.parameter"},
             {"match": rf"\b({'|'.join(choices)})\b", "name": "constant.language"},
             {"match": r"^\s*\w+\s*(?==)", "name": "invalid.illegal"}]
    if not choices:
        del rules[1]
    heading = rf"^\[({kind})(\s+\w+)?\]" if section["named"] else rf"^\[({kind})\]"
    return {"begin": heading, "end": r"^(?=\[)", "patterns": [{"include": "#common"}, *rules],
            "beginCaptures": {"1": {"name": "entity.name.section"},
                              "2": {"name": "entity.name.tag"}}}


def syntax(sections):
    top = "|".join(sections["top"]["keys"])
    common = [{"match": "#.*$", "name": "comment.line"},
              {"match": r"\b\d+(\.\d+)?([eE][+-]?\d+)?(\s*(m|mm|cm|s|ms|Pa|kPa|MPa|GPa)\b)?",
               "name": "constant.numeric"}]
    rules = [section_rule(kind, section) for kind, section in sections.items() if kind != "top"]
    language = {"name": "sphfsi case", "scopeName": "source.sphfsi",
                "repository": {"common": {"patterns": common}},
                "patterns": [*rules, {"match": rf"^\s*({top})\s*(?==)",
                                      "name": "variable.parameter"}, {"include": "#common"}]}
    return json.dumps(language, indent=1) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path, help="the program whose keys are documented")
    parser.add_argument("--check", action="store_true", help="change nothing")
    args = parser.parse_args()

    def keys(*more):
        return subprocess.run([args.program.resolve(), "--keys", *more], capture_output=True,
                              text=True, check=True).stdout
    for path, text in ((PAGE, page(keys())), (SYNTAX, syntax(json.loads(keys("--json"))))):
        before = path.read_text(encoding="utf-8") if path.is_file() else ""
        if args.check and text != before:
            sys.exit(f"{path.relative_to(ROOT)}: is older than the tables in src/*/*.def; "
                     "`make docs` writes it anew")
        if text != before:
            path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
