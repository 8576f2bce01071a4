#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Shows what accuracy costs in time: runs the cases of a study in many settings and reports
error against cost.

Reads tools/report/accuracy.toml (its head explains it), runs every point that has not been run
(runs/study, by the effective case and the sources of the program), and writes
docs/results/accuracy.json, docs/results/accuracy.md and its figures. An interrupted study continues
where it stopped. Examples:

  tools/report/accuracy.py                 run all missing points, then write the report
  tools/report/accuracy.py --list          list the points, and the time of those that are missing
  tools/report/accuracy.py --only gate     only points whose names begin with this
  tools/report/accuracy.py --report        the report from docs/results/accuracy.json alone
"""

import json
import time
from pathlib import Path

import study_report
from common import OUT, QUICK, ROOT, BadFile, load, options, run_tool
from runs import program_hash
from study import (complain, done, give_jobs, points_of, read_study, record_of, repeats_of,
                   run_point)
from study_metrics import measure

STUDY = ROOT / "tools" / "report" / "accuracy.toml"


def arguments():
    parser = options(__doc__)
    parser.add_argument("--study", type=Path, default=STUDY, help="the definition")
    parser.add_argument("--runs", type=Path, default=ROOT / "runs" / "study", help="the runs")
    parser.add_argument("--only", default="", help="run only points whose names begin with this")
    parser.add_argument("--list", action="store_true", help="list the points and their cost, as "
                        "the last results tell")
    parser.add_argument("--cached", action="store_true",
                        help="run nothing; report what has been run or was collected before")
    parser.add_argument("--report", action="store_true", help="only write the report")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the report")
    parser.add_argument("--data", type=Path, help="collected results (beside the definition)")
    return parser.parse_args()


def forecast(jobs, cost):
    known = [cost[job.words] for job in jobs if job.words in cost]
    unknown = len(jobs) - len(known)
    return f"about {sum(known) / 60:.1f} min left" + \
        (f" without {unknown} of unknown cost" if unknown else "")


def run_all(missing, study, cost):
    """One after the other, so that they do not disturb each other's timing."""
    print(f"{len(missing)} points to run; {forecast(missing, cost)}", flush=True)
    started = time.monotonic()
    for number, job in enumerate(missing, 1):
        record = run_point(job, study)
        cpu = [t["cpu"] for t in record["timings"]]
        print(f"[{number}/{len(missing)}, {(time.monotonic() - started) / 60:.1f} min] "
              f"{job.words}: {record['outcome']}, {min(cpu):.2f} s of CPU ({len(cpu)} runs); "
              f"{forecast(missing[number:], cost)}", flush=True)


def add_errors(records, jobs, study):
    """Errors of every finished point, measured against references and the finest base run; what
    cannot be measured is returned."""
    holes = []
    for name, case in study["case"].items():
        own = [r for r in records if r["case"] == name]
        best = max((r for r in own if r["knob"] == "base" and r["outcome"] == "finished" and
                    "errors" not in r), key=lambda r: r["level"], default=None)
        finest = best and jobs[best["name"]].folder
        for record in own:
            if "errors" in record:  # of earlier results
                continue
            record["errors"], record["values"] = {}, {}
            for error in case["error"] if record["outcome"] == "finished" else []:
                try:
                    value, off = measure(error, jobs[record["name"]].folder, finest, ROOT)
                except (BadFile, ArithmeticError, KeyError, OSError, TypeError,
                        ValueError) as problem:
                    holes.append(f"{record['name']}: {error['name']}: {problem}")
                    complain(holes[-1])
                    value, off = None, None
                if record is best and error["kind"].endswith("finest"):
                    off = None
                record["errors"][error["name"]], record["values"][error["name"]] = off, value
    return holes


def collect(records, holes, study, data):
    """One line for each point, so that a change of one is a change of a line."""
    keys = ("name", "case", "level", "knob", "value", "set", "outcome", "message", "program", "dp",
            "steps", "solid_steps", "particle_steps", "evaluations", "errors", "values", "timing")
    rows = [json.dumps({k: record.get(k) for k in keys}) for record in records]
    machines = sorted({json.dumps(r["machine"]) for r in records if "machine" in r})
    versions = sorted({r["version"] for r in records if r.get("version")})
    head = {"program": program_hash(), "versions": versions,
            "machines": [json.loads(m) for m in machines], "holes": holes,
            "definition": {k: study[k] for k in ("study", "preset", "case", "knob")}}
    text = "{\n" + ",\n".join(f"{json.dumps(k)}: {json.dumps(v)}" for k, v in head.items())
    data.write_text(text + ',\n"points": [\n' + ",\n".join(rows) + "\n]}\n")


def main():
    args = arguments()
    own = OUT / "accuracy.json"
    args.data = args.data or (own if args.study.resolve() == STUDY
                              else args.study.with_name("results.json"))
    ours = args.data.resolve() == own and not QUICK
    evidence = ROOT / "src" / "app" / "data" / "evidence.csv" if ours else None
    if args.report:
        return study_report.write(args.data, args.out, evidence)
    study = read_study(args.study)
    points = points_of(study)
    if QUICK:  # the coarsest of each case with the defaults
        points = [p for p in points if p["level"] == 0 and p["knob"] == "base"]
    chosen = [p for p in points if p["name"].startswith(args.only)]
    if not chosen:
        raise BadFile(f"no point {args.only} in {args.study}; --list shows them")
    jobs = give_jobs(chosen if args.list else points, study, args.runs)
    before = {p["name"]: p for p in load(args.data, {"points": []})["points"]
              if p["outcome"] != "not run"}
    cost = {name: cpu * repeats_of(cpu, study["study"]) for name, p in before.items()
            if p["timing"] for cpu in [min(t["cpu"] for t in p["timing"])]}
    missing = {job.folder: job for p in reversed(chosen)
               if (job := jobs[p["name"]]) and not done(job)}
    missing = list(reversed(missing.values()))
    if args.list:
        for p in chosen:
            job = jobs[p["name"]]
            state = job and done(job).get("outcome", "missing") or "refused"
            expected = f"{cost[p['name']]:8.1f} s" if p["name"] in cost else 10 * " "
            print(f"{state:9s} {expected}  {p['name']}  {' '.join(p['set'])}")
        print(f"{len(chosen)} points, {len(missing)} to run: {forecast(missing, cost)}")
        return 0
    if missing and not args.cached:
        run_all(missing, study, cost)
    records = [record_of(p, jobs[p["name"]], before) for p in points]
    collect(records, add_errors(records, jobs, study), study, args.data)
    return study_report.write(args.data, args.out, evidence)


if __name__ == "__main__":
    run_tool(main)
