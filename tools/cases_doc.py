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


NEEDS = ("`body` (solid), `point`", "`point`, optional `on`", "`point`, optional `body` or `on`",
         "`body` (solid)", "`body` (solids or walls), optional `point` of the moment", "",
         "`point`, `to`")  # of a quantity, by its target
KINDS = {"default with solids": " with only solids", "default with fluid": " with only fluid",
         "default with an inflow, no gravity": " with an inflow and no gravity",
         "default with fluid and solids": " with fluid and solids"}


def escaped(text):
    """| would end a cell of a table."""
    return text.replace("|", "\\|")


def default(section, key):
    """What the default scheme sets, by kind of scene, and the paper's value."""
    if "needed" in key:
        return "**needed**"
    paper = f"`{key['default']}`" if key.get("default") else ""
    kinds = [kind for kind in KINDS if kind in key]
    if not kinds:
        return paper
    stream = "default with an inflow, no gravity"
    absent = {"fluid": ["default with solids"], "solid": ["default with fluid", stream]}
    absent = absent.get(section, []) + [stream] * (key.get(stream) == key.get("default with fluid"))
    value = {kind: key.get(kind, key.get("default")) for kind in KINDS if kind not in absent}
    equal = len(set(value.values())) == 1
    return (f"`{key[kinds[0]]}`" if equal else
            ", ".join(f"`{value[kind]}`{KINDS[kind]}" for kind in value)
            ) + f"; `scheme = paper`: {paper}"


def span(key):
    """The range of a number, or the names of a choice."""
    sides = [f"{sign} {key[side]:g}" for sign, side in
             ((">", "exclusiveMinimum"), ("≥", "minimum"), ("<", "exclusiveMaximum"),
              ("≤", "maximum")) if side in key]
    return ", ".join(key.get("choices", sides))


def table(heads, rows):
    line = ["| " + " | ".join(row) + " |" for row in (heads, *rows)]
    return [line[0], "|" + "---|" * len(heads), *line[1:]]


def markdown(known):
    """The tables of all sections, quantities and effects."""
    lines = ["## Sections and keys"]
    for name, section in known["sections"].items():
        title = "Top of the file" if name == "top" else f"[{name}{' NAME' * section['named']}]"
        rows = [(f"`{word}`", key["type"], key.get("unit", ""), default(name, key), span(key),
                 escaped(key["meaning"]), f"`{word} = {key['example']}`" if key["example"] else "")
                for word, key in section["keys"].items()]
        lines += ["", f"### {title}", "", *([section["meaning"], ""] if section["meaning"] else []),
                  *table(("key", "type", "unit", "default", "range", "meaning", "example"), rows)]
    rows = [(f"`{word}`", NEEDS[q["target"]], f"`{q['columns']}`", q["meaning"])
            for word, q in known["quantities"].items()]
    lines += ["", "### Quantities of a probe", "",
              "A column is called PROBE_COLUMN, such as `tip_dx_m`. Forces, moments, energies and "
              "fluxes are per metre of depth.", "",
              *table(("quantity", "keys", "columns", "meaning"), rows)]
    rows = [(word, effect["enabled_by"], escaped(effect["meaning"]), effect["source"])
            for word, effect in known["effects"].items()]
    lines += ["", "### Effects", "",
              "An effect is a part of the model that a case enables. Only enabled effects are "
              "computed; `--explain` lists them.", "",
              *table(("effect", "enabled by", "meaning", "source"), rows)]
    return "\n".join(lines) + "\n"


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

    known = json.loads(subprocess.run([args.program.resolve(), "--keys", "--json"],
                                      capture_output=True, text=True, check=True).stdout)
    for path, text in ((PAGE, page(markdown(known))), (SYNTAX, syntax(known["sections"]))):
        before = path.read_text(encoding="utf-8") if path.is_file() else ""
        if args.check and text != before:
            sys.exit(f"{path.relative_to(ROOT)}: is older than the tables in src/*/*.def; "
                     "`make docs` writes it anew")
        if text != before:
            path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
