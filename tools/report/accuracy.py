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
import os
import re
import sys
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import common
import study_report
from common import OUT, QUICK, ROOT, BadFile, load, options, run_tool
from runs import Job, case_hash, program_hash
from study_metrics import measure

STUDY = ROOT / "tools" / "report" / "accuracy.toml"
NEEDED = {"case": ("file", "scene", "levels", "across", "error"), "knob": ("values",)}
KEEP = ("probes.csv", "ledger.csv", "summary.json", "case.cfg", "fields.vtkhdf")


def complain(text):
    print(f"accuracy: {text}", file=sys.stderr, flush=True)


def read_study(path):
    try:
        study = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as problem:
        raise BadFile(f"{path}: {problem}") from None
    for part in ("study", "preset", "case", "knob"):
        study.setdefault(part, {})
    for part, keys in NEEDED.items():
        for name, entry in study[part].items():
            lacks = [key for key in keys if not entry.get(key)]
            if lacks:
                raise BadFile(f"{path}: [{part}.{name}] lacks `{lacks[0]}`")
    return study


# --- points ---
def point(case, level, knob, value, sets):
    name = f"{case}/{level}/{knob}" + (f"={value}" if value else "")
    return {"name": name, "case": case, "level": level, "knob": knob, "value": value, "set": sets}


def knob_points(study, name, levels):
    """The points of a case that turn a knob."""
    case = study["case"][name]
    names, fixed = case.get("names", {}), case.get("set", [])
    for knob, entry in study["knob"].items():
        if name not in entry.get("cases", [name]) or entry.get("needs", "") not in ("", *names):
            continue
        numbers = entry.get("levels", case.get("knob_levels", range(len(levels))))
        for value, sets in entry["values"].items():
            try:
                sets = [text.format(**names) for text in sets]
            except (KeyError, IndexError):  # a knob of a medium that the case does not have
                continue
            for number in numbers:
                if 0 <= number < len(levels):
                    yield point(name, number, knob, value, fixed + levels[number] + sets)


def points_of(study):
    """Every point: (name, case, level, knob, value, --set arguments), the most important first:
    defaults, points of presets, then the other knobs, each from coarse to fine."""
    chosen = {tuple(setting.partition("=")[::2]) for scenes in study["preset"].values()
              for setting in scenes.values()}
    points = []
    for name, case in study["case"].items():
        levels = [[level] if isinstance(level, str) else level for level in case["levels"]]
        points += [point(name, number, "base", "", case.get("set", []) + level)
                   for number, level in enumerate(levels)]
        points += knob_points(study, name, levels)
    return sorted(points, key=lambda p: (p["knob"] != "base", (p["knob"], p["value"]) not in chosen,
                                         p["level"]))


# --- runs ---
def give_jobs(points, study, runs):
    """{name: the run of a point}, in a folder by its effective case; a point that is refused has
    none, and the reason."""
    def job_of(p):
        job = Job(runs / "none", ROOT / study["case"][p["case"]]["file"], p["set"], p["name"])
        try:
            key = case_hash(job.effective())
        except BadFile as problem:
            p.update(outcome="refused", message=str(problem))
            complain(f"{p['name']}: refused: {problem}")
            return None
        return Job(runs / key, job.case, job.sets, p["name"])
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return dict(zip((p["name"] for p in points), pool.map(job_of, points)))


def done(job):
    """The record of a run that need not be repeated: one that failed for an outside reason runs
    again."""
    record = job.record()
    return record if record.get("outcome") not in (None, "started", "failed") else {}


def repeats_of(cpu, rules):
    return rules.get("repeats", 1) if cpu < rules.get("repeat_below", 1e9) else 1


def run_point(job, study):
    """Runs a point, a cheap one several times for its timing, and keeps what it gave and took."""
    rules, timings = study["study"], job.record().get("timings", [])
    wanted = len(timings) + 1
    while len(timings) < wanted:
        record = job.run(lambda text: None, rules.get("threads", 1), rules.get("time_limit", 600),
                         anew=True)
        timings.append(record["timing"])
        if record["outcome"] == "finished" and len(timings) == 1:
            wanted = repeats_of(timings[0]["cpu"], rules)
    if record["outcome"] != "finished":
        complain(f"{job.words}: {record['outcome']}: {record['message']}")
    for file in job.folder.glob("*"):
        if file.name not in KEEP:
            file.unlink()
    job.store({**record, "timings": timings, "machine": machine(), **numbers_of(job.folder)})
    return job.record()


def numbers_of(folder):
    summary = load(folder / "summary.json", {})
    counters = summary.get("counters", {})
    return {"dp": summary.get("parameters", {}).get("dp"), "steps": summary.get("steps"),
            "solid_steps": summary.get("solid_substeps"),
            "particle_steps": counters.get("particle_steps"),
            "evaluations": (counters.get("evaluations") or 0) +
                           (counters.get("solid_evaluations") or 0)}


def machine():
    """What the timings depend on besides the program."""
    flags = ROOT / "build" / "release" / "flags"
    words = flags.read_text().split() if flags.exists() else ["unknown compiler"]
    compiler = " ".join(dict.fromkeys((words[0], words[-1])))
    options = " ".join(w for w in words if re.match("-O|-march|-mcpu", w))
    return {"cpu": common.machine(), "cores": os.cpu_count(),
            "compiler": f"{compiler} {options}".strip()}


def record_of(p, job, before):
    """A point with what its run gave; of one that has not run here, what the last results say."""
    record = job.record() if job else {}
    if not job or record.get("timings"):
        kept = {k: v for k, v in record.items() if k not in ("case", "timing", "log")}
        return {**p, **kept, "timing": record.get("timings", [])}
    old = before.get(p["name"], {})
    if old.get("set") == p["set"]:
        return {**old, **p}
    return {**p, "timing": [], "outcome": "not run", "message": ""}


# --- the study ---
def arguments():
    parser = options(__doc__)
    parser.add_argument("--study", type=Path, default=STUDY, help="another definition; its "
                        "runs, results and report go beside it")
    parser.add_argument("--only", default="", help="run only points whose names begin with this")
    parser.add_argument("--list", action="store_true", help="list the points and their cost, as "
                        "the last results tell")
    parser.add_argument("--cached", action="store_true",
                        help="run nothing; report what has been run or was collected before")
    parser.add_argument("--report", action="store_true", help="only write the report")
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
    ours, beside = args.study.resolve() == STUDY, args.study.parent
    out, data = (OUT, OUT / "accuracy.json") if ours else (beside, beside / "results.json")
    runs = ROOT / "runs" / "study" if ours else beside / "runs"
    evidence = ROOT / "src" / "app" / "data" / "evidence.csv" if ours and not QUICK else None
    if args.report:
        return study_report.write(data, out, evidence)
    study = read_study(args.study)
    points = points_of(study)
    if QUICK:  # the coarsest of each case with the defaults
        points = [p for p in points if p["level"] == 0 and p["knob"] == "base"]
    chosen = [p for p in points if p["name"].startswith(args.only)]
    if not chosen:
        raise BadFile(f"no point {args.only} in {args.study}; --list shows them")
    jobs = give_jobs(chosen if args.list else points, study, runs)
    before = {p["name"]: p for p in load(data, {"points": []})["points"]
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
    collect(records, add_errors(records, jobs, study), study, data)
    return study_report.write(data, out, evidence)


if __name__ == "__main__":
    run_tool(main)
