#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Shows what accuracy costs in time: runs the cases of a study in many settings and reports
error against cost.

Reads tools/report/accuracy.toml (its head explains it), runs every point that is not in the cache
(runs/study, keyed by the effective case and the sources of the program), and writes
docs/accuracy.json, docs/accuracy.md and its figures. An interrupted study continues where
it stopped. Examples:

  tools/report/accuracy.py                      run all missing points, then write the report
  tools/report/accuracy.py --list               list the points and the time of those that are not
  cached
  tools/report/accuracy.py --only gate          only points whose names begin with this
  tools/report/accuracy.py --report             the report from docs/accuracy.json alone
"""

import argparse
import json
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

try:
    import tomllib  # noqa: F401: wanted by study_points
except ImportError:
    sys.exit("accuracy_cost: Python 3.11 or newer is wanted (tomllib)")

import study_report
from common import BadFile, run_tool
from study_metrics import measure
from study_points import (ROOT, cached_record, complain, expected_costs, give_keys, points_of,
                          read_study,
                          take_older)
from study_results import front_names
from study_runs import run_point

STUDY = ROOT / "tools" / "report" / "accuracy.toml"


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--study", type=Path, default=STUDY, help="the definition")
    parser.add_argument("--runs", type=Path, default=ROOT / "runs" / "study", help="the cache")
    parser.add_argument("--only", default="", help="run only points whose names begin with this")
    parser.add_argument("--list", action="store_true", help="list the points and their expected "
                                                            "cost")
    parser.add_argument("--cached", action="store_true",
                        help="run nothing; report what is cached or was collected before")
    parser.add_argument("--report", action="store_true", help="only write the report")
    parser.add_argument("--again", nargs="?", const="", metavar="NAMES",
                        help="time once more the finished points whose names begin like one of "
                        "these (commas between), or, without NAMES, those of the fronts")
    parser.add_argument("--jobs", type=int, default=1,
                        help="points at a time; their timings are marked as taken side by side")
    parser.add_argument("--older", action="store_true",
                        help="do not repeat points that an older program has run with the same "
                             "effective "
                        "case; the report marks them")
    parser.add_argument("--prefix", default="", help="command in front of each run, such as nice")
    parser.add_argument("--out", type=Path, default=ROOT / "docs", help="folder of the report")
    parser.add_argument("--data", type=Path, help="collected results (beside the definition)")
    return parser.parse_args()


def run_all(points, study, args, again):
    """Records of all points by name. What is not cached runs now, `jobs` at a time."""
    missing = {p["key"]: p for p in reversed(points) if p["key"] and
               p["name"].startswith(args.only) and
               (again(p["name"]) or not cached_record(args.runs, p["key"]))}
    missing = {} if args.cached else dict(reversed(missing.items()))
    if missing:
        cost = expected_costs(points, study, args.runs, args.data, False)
        print(f"{len(missing)} points to run; {forecast(missing, cost, args.jobs)}", flush=True)
        started, done = time.monotonic(), []

        def run(p):
            record = run_point(p, study, args.runs, again(p["name"]))
            done.append(p["key"])
            left = [key for key in missing if key not in done]
            cpu = [t["cpu"] for t in record["timing"]]
            print(f"[{len(done)}/{len(missing)}, {(time.monotonic() - started) / 60:.1f} min] "
                  f"{p['name']}: "
                  f"{record['outcome']}, {min(cpu):.2f} s of CPU ({len(cpu)} runs); "
                  f"{forecast(left, cost, args.jobs)}", flush=True)

        with ThreadPoolExecutor(args.jobs) as pool:
            list(pool.map(run, missing.values()))
    before = collected(args.data)
    return {p["name"]: record_of(p, args.runs, before) for p in points}


def collected(data):
    """Points of the last results by name, with their errors. They replace points without a run
    here."""
    try:
        return {p["name"]: p for p in json.loads(data.read_text())["points"]
                if p["outcome"] != "not run"}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def record_of(p, runs, before):
    if p["key"] is None:
        return dict(p, timing=[])
    try:  # also one that failed, which is shown as that until it runs again
        return dict(json.loads((runs / p["key"] / "result.json").read_text()), **p)
    except (OSError, ValueError):
        old = before.get(p["name"])
        if old and old["set"] == p["set"]:
            return dict(p, **{k: old[k] for k in old if k not in p})
        return dict(p, timing=[], outcome="not run", message="")


def forecast(keys, cost, jobs):
    known = [cost[key] for key in keys if key in cost]
    unknown = len(keys) - len(known)
    return f"about {sum(known) / jobs / 60:.1f} min left" + \
        (f" without {unknown} of unknown cost" if unknown else "")


def add_errors(records, study, runs):
    """Errors of every finished point, measured against references and the finest base run."""
    for name, case in study["case"].items():
        own = [r for r in records.values() if r["case"] == name]
        base = [r for r in own if r["knob"] == "base" and r["outcome"] == "finished" and
                (runs / r["key"] / "run").is_dir()]
        best = max(base, key=lambda r: r["level"], default=None)
        for record in own:
            if "errors" in record:  # of earlier results
                continue
            record["errors"], record["values"] = {}, {}
            for error in case["error"] if record["outcome"] == "finished" else []:
                try:
                    value, off = measure(error, runs / record["key"] / "run",
                                         best and runs / best["key"] / "run", ROOT)
                except (BadFile, ArithmeticError, KeyError, OSError, TypeError,
                        ValueError) as problem:
                    study["holes"].append(f"{record['name']}: {error['name']}: {problem}")
                    complain(study["holes"][-1])
                    value, off = None, None
                if record is best and error["kind"].endswith("finest"):
                    off = None
                record["errors"][error["name"]], record["values"][error["name"]] = off, value


def collect(records, study, data):
    """One line for each point, so that a change of one is a change of a line."""
    rows = []
    for record in records.values():
        keys = ("name", "case", "level", "knob", "value", "set", "outcome", "message", "program",
                "dp",
                "steps", "solid_steps", "particle_steps", "evaluations", "errors", "values",
                "timing")
        rows.append(json.dumps({k: record.get(k) for k in keys}))
    machines = sorted({json.dumps(r["machine"]) for r in records.values() if "machine" in r})
    versions = sorted({r["version"] for r in records.values() if r.get("version")})
    head = {"program": study["program"], "versions": versions,
            "machines": [json.loads(m) for m in machines],
            "holes": study["holes"],
            "definition": {k: study[k] for k in ("study", "preset", "case", "knob")}}
    text = "{\n" + ",\n".join(f"{json.dumps(k)}: {json.dumps(v)}" for k, v in head.items())
    data.write_text(text + ',\n"points": [\n' + ",\n".join(rows) + "\n]}\n")


def list_points(points, study, args):
    cost = expected_costs(points, study, args.runs, args.data, True)
    for p in points:
        record = cached_record(args.runs, p["key"])
        state = record["outcome"] if record else "missing" if p["key"] else "refused"
        expected = f"{cost[p['key']]:8.1f} s" if p["key"] in cost else 10 * " "
        print(f"{state:9s} {expected}  {p['key']}  {p['name']}  {' '.join(p['set'])}")
    print(f"{len(points)} points, {len(cost)} to run: {sum(cost.values()):.0f} s of CPU, "
          f"{forecast(cost, cost, args.jobs)} with --jobs {args.jobs}")
    return 0


def main():
    args = arguments()
    own = ROOT / "docs" / "accuracy.json"
    args.data = args.data or (own if args.study.resolve() == STUDY
                              else args.study.with_name("results.json"))
    ours = args.data.resolve() == own
    evidence = ROOT / "src" / "app" / "data" / "evidence.csv" if ours else None
    if args.report:
        return study_report.write(args.data, args.out, evidence)
    study = read_study(args.study)
    args.jobs = max(1, args.jobs)
    study["prefix"], study["jobs"] = args.prefix, args.jobs
    points = points_of(study)
    chosen = [p for p in points if p["name"].startswith(args.only)]
    if not chosen:
        raise BadFile(f"no point {args.only} in {args.study}; --list shows them")
    if args.list:
        points = chosen
    study["program"] = give_keys(points, study)
    if args.older:
        take_older(points, args.runs)
    if args.list:
        return list_points(points, study, args)
    names = None if args.again is None else \
        [n for n in args.again.split(",") if n] or front_names(args.data)
    records = run_all(points, study, args,
                      lambda name: names is not None and any(name.startswith(n) for n in names))
    add_errors(records, study, args.runs)
    collect(records, study, args.data)
    return study_report.write(args.data, args.out, evidence)


if __name__ == "__main__":
    try:
        run_tool(main)
    except KeyboardInterrupt:
        complain("interrupted; the same command goes on")
        sys.exit(130)
