#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Holds what --explain foresees against what runs take: steps, and time of the program from its
start to its end, of the shipped cases, the templates, the elastica and FSI2. Each is cut short by
--until so that it takes about as long as --seconds says. Forecasts and runs take turns, and all
cases do, so that a slow minute of the machine counts once for a case. The error is the median of
forecast over run: CPU time on one thread, which other programs disturb little; wall time on more.

Writes docs/results/forecast.json, one run a line, and the accuracy report, which shows it. A case
that fails is shown as that. Examples, on an idle machine:

  tools/report/forecast.py                      all of these, one thread and all
  tools/report/forecast.py --seconds 60 gate    longer, and only cases whose name begins like this
  tools/report/forecast.py templates/ turek     all templates and FSI2
"""

import os
import re
import statistics
import tempfile
from pathlib import Path

import study_report
from accuracy import machine
from common import OUT, PROGRAM, QUICK, ROOT, BadFile, ask, load, options, run_tool, store_rows
from runs import effective, timed
from study_results import forecast_cells

UNITS = {"s": 1, "min": 60, "h": 3600}
CASES = ["*.cfg", "templates/*.cfg", "turek_hron/fsi2.cfg", "verify/elastica.cfg"]


def arguments():
    parser = options(__doc__)
    parser.add_argument("cases", nargs="*", default=["gate"] if QUICK else [],
                        help="beginnings of names; all without")
    parser.add_argument("--seconds", type=float, default=1 if QUICK else 2,
                        help="aimed at for a run, as foreseen")
    parser.add_argument("--runs", type=int, default=1 if QUICK else 7,
                        help="forecasts and runs of each case")
    parser.add_argument("--threads", type=int, nargs="+", help="1 and all")
    return parser.parse_args()


def foreseen(case, threads, more):
    """Steps, steps of the solid and seconds as --explain says."""
    said = ask("--explain", case, "--threads", threads, *more)
    steps = re.search(r"(?m)^ *about ([\d.e+]+) steps of [\d.]", said)
    solid = re.search(r"(?m)^ *about ([\d.e+]+) solid sub-steps", said)
    cost = re.search(r"(?m)^ *([\d.e+]+) (s|min|h) on this machine when idle", said)
    if not steps or not cost:
        raise BadFile("no forecast")
    return {"steps": float(steps[1]), "solid_steps": float(solid[1]) if solid else None,
            "seconds": float(cost[1]) * UNITS[cost[2]]}


def taken(case, threads, more, folder):
    command = [str(PROGRAM), str(case), "--quiet", "--out", str(folder), "--threads", str(threads),
               *more]
    status, timing, said = timed(command, threads, 3600)
    if status != 0:
        raise BadFile(said.splitlines()[-1] if said else f"exit status {status}")
    summary = load(folder / "summary.json")
    return {"steps": summary["steps"], "solid_steps": summary.get("solid_substeps"),
            "seconds": timing["wall"], "cpu": timing["cpu"], "load": timing["load"],
            "version": summary["version"]}


def name_of(case):
    """Its path below cases/ without an ending."""
    return str(case.relative_to(ROOT / "cases").with_suffix(""))


def median(found):
    """Of each number; what is none is that of the last."""
    return {key: value if value is None or isinstance(value, str) else
            statistics.median(one[key] for one in found) for key, value in found[-1].items()}


def measure(case, row, seconds):
    """A forecast and a run; at first also until when the case runs."""
    if "until" not in row:
        end = float(re.search(r"(?m)^end_time = ([\d.e+-]+)", effective(str(case)))[1])
        whole = foreseen(case, row["threads"], [])["seconds"]
        row.update(end=end, until=float(f"{end * min(1, seconds / whole):.2g}"), whole=whole)
    more = ["--until", repr(row["until"])] if row["until"] < row["end"] else []
    with tempfile.TemporaryDirectory() as folder:
        return (foreseen(case, row["threads"], more),
                taken(case, row["threads"], more, Path(folder) / "run"))


def main():
    args = arguments()
    all_threads = args.threads or sorted({1, os.cpu_count() or 1})
    cases = [case for pattern in CASES for case in sorted((ROOT / "cases").glob(pattern))
             if not args.cases or name_of(case).startswith(tuple(args.cases))]
    if not cases:
        raise BadFile(f"no case of {', '.join(CASES)} begins with {' or '.join(args.cases)}")
    rows = [(case, {"case": name_of(case), "threads": threads}, [])
            for case in cases for threads in all_threads]
    for _ in range(args.runs):
        for case, row, pairs in rows:
            try:
                pairs += [measure(case, row, args.seconds)] if "failed" not in row else []
            except (BadFile, OSError, KeyError, ValueError) as problem:
                row["failed"] = str(problem)
    for _, row, pairs in rows:
        if "failed" not in row:
            row.update(foreseen=median([one for one, _ in pairs]),
                       taken=median([one for _, one in pairs]),
                       each=[[one["seconds"], two["cpu"], two["seconds"]] for one, two in pairs])
        print("  ".join(map(str, forecast_cells(row))), flush=True)
    store_rows(OUT / "forecast.json", {"machine": machine(), "seconds": args.seconds,
                                     "runs": args.runs}, "rows",
               [row for _, row, _ in rows])
    print(f"written {OUT / 'forecast.json'}")
    results = OUT / "accuracy.json"
    return study_report.write(results, OUT) if results.exists() else 0


if __name__ == "__main__":
    run_tool(main)
