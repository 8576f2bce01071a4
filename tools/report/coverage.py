#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Do the bands of tools/refine.py hold known answers? Writes docs/results/coverage.md.

Each problem of tools/report/coverage.toml runs over three coarse spacings, speed of sound and step;
finished runs are kept in runs/coverage. Examples:

  tools/report/coverage.py                  runs what is missing, writes the report
  tools/report/coverage.py --only couette   these problems, to the screen
  tools/report/coverage.py --cached         the report from docs/results/coverage.json alone
"""
import math
import tomllib
import warnings

from common import OUT, QUICK, ROOT, load, np, options, program_version, run_tool, store_rows, \
    table, write
from sphfsi import Case, Error
from sphfsi.bands import FORMAL_ORDER
from sphfsi.measures import measures

REPORT, RUNS = OUT / "coverage.md", ROOT / "runs" / ("coverage-quick" if QUICK else "coverage")
KINDS = ("solid", "rest", "wave", "viscous", "open", "coupled", "rigid")
SCENES = {"solid": "solid", "coupled": "coupled"}  # of the evidence; others are "fluid"
QUICK_PROBLEMS = ("stretched_bar", "couette")


def case_of(name, problem):
    """The case of a problem, written out where it is not a file as it stands."""
    text = problem.get("case") or (ROOT / problem["file"]).read_text(encoding="utf-8")
    if "case" in problem or "add" in problem:
        path = RUNS / f"{name}.cfg"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text + problem.get("add", ""), encoding="utf-8")
    else:
        path = ROOT / problem["file"]
    return Case(path, **dict(text.split("=", 1) for text in problem.get("set", [])))


def answers(problem, end):
    """{(column, measure): exact value}."""
    names = {**vars(np), "sum": sum}
    for word, text in problem.get("let", {}).items():
        names[word] = eval(text, names)
    found = {tuple(key.split()): float(eval(text, names))
             for key, text in problem.get("answer", {}).items()}
    time = np.linspace(0, end, 4001)
    for column, text in problem.get("curve", {}).items():
        exact = measures(column, time, eval(text, {**names, "t": time}), problem.get("from"))
        found.update(((column, measure), exact[measure]) for measure in problem["measures"])
    return found


def run_problem(name, problem):
    """Rows: problem, column, measure, answer, value, limit, band, orders and why there is none."""
    study = case_of(name, problem).refinement(
        RUNS / name, ratio=problem.get("ratio", 2.0), until=problem.get("until", 0.0), threads=1,
        start=problem.get("from"), without=problem.get("without", []), notes=lambda _: None)
    study.run(False)
    report = study.report(lambda _: None)
    columns, rows = {**report["ledger"], **report}, []
    paper = study.own["parameters"]["scheme"] == "paper" and problem["kind"] != "solid"
    for (column, measure), exact in answers(problem, study.end).items():
        found = columns[column].get(measure)
        rows.append({"problem": name, "column": column, "measure": measure, "answer": exact,
                     "known": problem.get("known", 1e-6), "dp": report["dp"],
                     "accuracy": "paper" if paper else "standard",
                     **({"value": found["values"][0], "limit": found["extrapolated"],
                         "band": found["band"], "order": found["spacing"]["order"],
                         "why": found["spacing"]["why_no_order"], "scatter": found["scatter"],
                         **{key: found[key]["values"] for key in FORMAL_ORDER if key in found}}
                        if found else {"value": None})})
    return rows


def state(row):
    """held or missed; no result where the band is larger than the value; absent."""
    if row["value"] is None:
        return "absent"
    if row["band"] is None or row["band"] > abs(row["value"]):
        return "no result"
    error = abs(row["value"] - row["answer"]) - row["known"] * abs(row["answer"])
    return "held" if error <= row["band"] else "missed"


def evidence(rows, problems):
    """Rows of src/app/data/evidence.csv: error by particles across, coarse first."""
    for row in rows:
        problem = problems[row["problem"]]
        for dp, value in reversed(list(zip(row["dp"], row.get("spacing", ())))):
            if "across" in problem and value != row["answer"]:
                yield [SCENES.get(problem["kind"], "fluid"), row["accuracy"], row["problem"],
                       f"{row['column']} {row['measure']}", f"{problem['across'] / dp:.3g}",
                       "particles across", percent(abs(value - row["answer"]), abs(row["answer"]))]


def evidence_coverage(lines):
    """As --explain does, the error of each row is foreseen from the other problems of its kind: how
    many have so many others that a bound of 90 % exists (Wilks 1941), and how many keep it."""
    known = held = 0
    for scene, accuracy, name, _, n, _, error in lines:
        others = {(other[2], other[3]): float(other[6]) for other in lines
                  if other[:2] == [scene, accuracy] and other[2] != name and
                  float(other[4]) <= float(n)}
        k = math.ceil(0.9 * (len(others) + 1))
        if k <= len(others):
            known, held = known + 1, held + (float(error) <= sorted(others.values())[k - 1])
    return known, held


def percent(part, whole):
    return f"{100 * part / whole:.2g}" if whole else "-"


def cells(row):
    """Of the table: the answer, the value's error, the band and the limit's error, in per cent of
    the answer."""
    name = f"{row['column']} {row['measure']}"
    if row["value"] is None:
        return [row["problem"], name, f"{row['answer']:.4g}", "", "", "", "", "absent"]
    size = abs(row["answer"])
    limit = "-" if row["limit"] is None else percent(row["limit"] - row["answer"], size)
    return [row["problem"], name, f"{row['answer']:.4g}",
            percent(row["value"] - row["answer"], size),
            percent(np.nan if row["band"] is None else row["band"], size),
            row["why"] if row["order"] is None else f"{row['order']:.2f}", limit, state(row)]


def report(rows, problems, version):
    counted = [row for row in rows if state(row) in ("held", "missed")]
    held = [row for row in counted if state(row) == "held"]
    ordered = [row for row in counted if row["order"] is not None]
    kinds = [[kind, len(own), sum(state(row) == "held" for row in own)] for kind in KINDS
             if (own := [row for row in counted if problems[row["problem"]]["kind"] == kind])]
    missed = [f"* {row['problem']}, {row['column']} {row['measure']}: off by "
              f"{percent(row['value'] - row['answer'], abs(row['answer']))} %, band "
              f"{percent(row['band'], abs(row['answer']))} %"
              for row in counted if state(row) == "missed"]
    silent = [f"* {row['problem']}, {row['column']} {row['measure']}: {state(row)}"
              for row in rows if row not in counted]
    sources = [[name, problem["kind"], problem["source"]] for name, problem in problems.items()]
    known, kept = evidence_coverage(list(evidence(rows, problems)))
    return {"version": version, "known": known, "kept": kept, "kept_share": percent(kept, known),
            "problems": len({row["problem"] for row in rows}),
            "held": len(held), "counted": len(counted), "share": percent(len(held), len(counted)),
            "ordered": len(ordered),
            "ordered_held": sum(row in held for row in ordered),
            "kinds": table(["kind", "quantities", "held"], kinds),
            "missed": "\n".join(missed) or "None.", "silent": "\n".join(silent) or "None.",
            "rows": table(["problem", "quantity", "answer", "error (%)", "90 % band (%)",
                           "order in spacing", "error of the limit (%)", "band"],
                          map(cells, rows)),
            "sources": table(["problem", "kind", "answer from"], sources)}


def main():
    parser = options(__doc__)
    parser.add_argument("--only", default="", help="part of a problem's name")
    parser.add_argument("--cached", action="store_true", help="run nothing")
    args = parser.parse_args()
    with open(ROOT / "tools" / "report" / "coverage.toml", "rb") as file:
        problems = tomllib.load(file)
    chosen = [name for name in problems if args.only in name and
              (not QUICK or name in QUICK_PROBLEMS)]
    results, rows = REPORT.with_suffix(".json"), []
    if args.cached:
        rows = load(results)["rows"]
        return write(REPORT, REPORT.name, **report(rows, problems, load(results)["version"]))
    warnings.simplefilter("ignore")
    for name in chosen:
        try:
            found = run_problem(name, problems[name])
        except Error as problem:
            print(f"{name}: {problem}", flush=True)
            continue
        for row in found:
            print(*cells(row), sep="  ", flush=True)
        rows += found
    if args.only:
        return None
    found = {"version": program_version(), "evidence": list(evidence(rows, problems))}
    store_rows(results, found, "rows", rows)
    return write(REPORT, REPORT.name, **report(rows, problems, found["version"]))


if __name__ == "__main__":
    run_tool(main)
