#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Keeps the reference of keys in docs/cases.md what the program says of itself.

example:
  tools/cases_doc.py ./sphfsi            writes the part below the marker anew
  tools/cases_doc.py ./sphfsi --check    exit status 1 if it is out of date
"""
import argparse
import subprocess
import sys
from pathlib import Path

PAGE = Path(__file__).resolve().parent.parent / "docs" / "cases.md"
MARKER = "<!-- What follows is written by `make docs` from the program's own tables. -->\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path, help="the program whose keys are documented")
    parser.add_argument("--check", action="store_true", help="change nothing")
    args = parser.parse_args()
    keys = subprocess.run([args.program.resolve(), "--keys"], capture_output=True, text=True,
                          check=True).stdout
    before = PAGE.read_text(encoding="utf-8")
    if MARKER not in before:
        sys.exit(f"{PAGE}: lacks the line that marks where the written part begins: {MARKER}")
    after = before[:before.index(MARKER)] + MARKER + "\n" + keys
    if args.check and after != before:
        sys.exit("docs/cases.md: is older than the tables in src/*/*.def; `make docs` writes it "
                 "anew")
    if after != before:
        PAGE.write_text(after, encoding="utf-8")


if __name__ == "__main__":
    main()
