#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Shows what accuracy costs in time: runs the cases of a study in many settings and reports
error against cost.

Reads tools/study/study.toml (its head explains it), runs every point that is not in the cache
(runs/study, keyed by the effective case and the sources of the program), and writes
tools/study/results.json, docs/accuracy.md and its figures. An interrupted study goes on where
it was. Examples:

  tools/accuracy_cost.py                      all that is missing, then the report
  tools/accuracy_cost.py --list               the points, and which of them are cached
  tools/accuracy_cost.py --only gate          only points whose name begins like this
  tools/accuracy_cost.py --point gate/2/base  one of them (what a workflow engine calls)
  tools/accuracy_cost.py --report             the report from tools/study/results.json alone
"""

import argparse
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from hashlib import sha256
from pathlib import Path
from resource import RLIMIT_CPU, setrlimit
from signal import SIGXCPU

try:
    import tomllib
except ImportError:
    sys.exit("accuracy_cost: Python 3.11 or newer is wanted (tomllib)")

import study_report
from runfiles import BadFile, run_tool
from study_metrics import KINDS, measure

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = Path(os.environ.get("SPHFSI") or ROOT / "sphfsi").resolve()
STUDY = ROOT / "tools" / "study" / "study.toml"
KEEP = ("probes.csv", "ledger.csv", "summary.json", "case.cfg", "fields.vtkhdf")
POWERCAP = Path("/sys/class/powercap")


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--study", type=Path, default=STUDY, help="the definition")
    parser.add_argument("--runs", type=Path, default=ROOT / "runs" / "study", help="the cache")
    parser.add_argument("--only", default="", help="only points whose name begins like this")
    parser.add_argument("--point", help="run this one point and write no report")
    parser.add_argument("--list", action="store_true", help="list the points, run nothing")
    parser.add_argument("--plan", action="store_true", help="the points as JSON, run nothing")
    parser.add_argument("--cached", action="store_true",
                        help="run nothing; points that are not cached are reported as not run")
    parser.add_argument("--report", action="store_true", help="no runs; only the report")
    parser.add_argument("--again", nargs="?", const="", metavar="NAMES",
                        help="time once more the finished points whose names begin like one of "
                        "these (commas between), or, without NAMES, those of the fronts")
    parser.add_argument("--prefix", default="", help="command in front of each run, such as nice")
    parser.add_argument("--out", type=Path, default=ROOT / "docs", help="folder of the report")
    parser.add_argument("--data", type=Path, help="collected results (beside the definition)")
    return parser.parse_args()


# --- the definition ---

def complain(text):
    print(f"accuracy_cost: {text}", file=sys.stderr, flush=True)


def read_study(path):
    """The definition, and what is wrong with it; wrong parts are taken out, the rest goes on."""
    try:
        study = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as problem:
        raise BadFile(f"{path}: {problem}") from None
    holes = []
    cases = study.setdefault("case", {})
    study.setdefault("preset", {})
    for name, case in list(cases.items()):
        wrong = case_trouble(case)
        if wrong:
            holes.append(f"{Path(path).name}: [case.{name}] {wrong}; the case is left out")
            del cases[name]
    for name, knob in list(study.setdefault("knob", {}).items()):
        if not isinstance(knob.get("values"), dict) or not knob["values"]:
            holes.append(f"{Path(path).name}: [knob.{name}] lacks `values`; it is left out")
            del study["knob"][name]
            continue
        for case in knob.get("cases", []):
            if case not in cases:
                holes.append(f"{Path(path).name}: [knob.{name}] cases: there is no case `{case}`")
    if not cases:
        raise BadFile("; ".join(holes) or f"{path}: defines no [case.NAME]")
    study["holes"] = holes
    for hole in holes:
        complain(hole)
    return study


def case_trouble(case):
    for key in ("file", "scene", "levels", "across", "error"):
        if key not in case:
            return f"lacks `{key}`"
    if not (ROOT / case["file"]).is_file():
        return f"file = {case['file']}: there is no such case"
    if case["scene"] not in study_report.SCENES:
        return f"scene = {case['scene']}: it is one of {', '.join(study_report.SCENES)}"
    for error in case["error"]:
        if error.get("kind") not in KINDS:
            return f"error kind = {error.get('kind')}: it is one of {', '.join(KINDS)}"
        for key in KINDS[error["kind"]]:
            if key not in error:
                return f"error {error.get('name', '')} of kind {error['kind']} lacks `{key}`"
        file = error.get("file")
        if file and not (ROOT / file).is_file():
            return f"error {error['name']}: there is no reference {file}"
    return None


def points_of(study):
    """Every point: (name, case, level, knob, value, --set arguments)."""
    points = []
    for name, case in study["case"].items():
        fixed = case.get("set", [])
        levels = [[level] if isinstance(level, str) else level for level in case["levels"]]
        for number, level in enumerate(levels):
            points.append(point(name, number, "base", "", fixed + level))
        for knob, entry in study["knob"].items():
            names = case.get("names", {})
            if name not in entry.get("cases", [name]) or entry.get("needs", "") not in ("", *names):
                continue
            for value, sets in entry["values"].items():
                try:
                    sets = [text.format(**names) for text in sets]
                except KeyError:  # a knob of a medium that the case does not have
                    continue
                for number in entry.get("levels", case.get("knob_levels", range(len(levels)))):
                    if number < len(levels):
                        points.append(point(name, number, knob, value, fixed + levels[number] + sets))
    return sorted(points, key=lambda p: (p["knob"] != "base", p["level"]))


def point(case, level, knob, value, sets):
    name = f"{case}/{level}/{knob}" + (f"={value}" if value else "")
    return {"name": name, "case": case, "level": level, "knob": knob, "value": value, "set": sets}


# --- what a point is called in the cache ---

def program_hash():
    """Of everything that the results can depend on."""
    total = sha256()
    for path in sorted([*ROOT.glob("src/*"), *ROOT.glob("include/*")]):
        if path.suffix in (".c", ".h", ".def") and path.name != "evidence.def":
            total.update(path.name.encode() + b"\0" + path.read_bytes())
    flags = ROOT / "build" / "release" / "flags"
    if flags.exists():
        total.update(re.sub(r"\S*/\S*", "", flags.read_text()).encode())
    return total.hexdigest()[:16]


def set_arguments(sets):
    return [word for text in sets for word in ("--set", text)]


def effective_hash(case, p, program):
    """Of the case in effect but for its words and references; None and why: it is refused."""
    command = [str(PROGRAM), "--effective", str(ROOT / case["file"]), *set_arguments(p["set"])]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    except (OSError, subprocess.TimeoutExpired) as problem:
        raise BadFile(f"./sphfsi cannot be run ({problem}); make builds it") from None
    if done.returncode:
        return None, done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "refused"
    text = re.sub(r"(?m)^(#|title|source).*\n", "", done.stdout)
    text = re.sub(r"(?ms)^\[reference .*?(?=^\[|\Z)", "", text)
    return sha256((program + text).encode()).hexdigest()[:16], ""


# --- one run ---

def joules():
    """Counters of the processor packages in J, or None where there are none."""
    try:
        return sum(int((zone / "energy_uj").read_text()) for zone in POWERCAP.glob("intel-rapl:?")) * 1e-6 \
            if list(POWERCAP.glob("intel-rapl:?")) else None
    except (OSError, ValueError):
        return None


def timed(command, threads, limit):
    """Runs it: (exit status or None for too long, wall s, J or None, load before, stderr). The limit is
    of CPU time, so that a busy machine, or one where each run waits for its turn, changes nothing."""
    environment = dict(os.environ, OMP_NUM_THREADS=str(threads), OMP_WAIT_POLICY="passive")
    load, energy, start = os.getloadavg()[0], joules(), time.monotonic()
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True,
                               preexec_fn=lambda: setrlimit(RLIMIT_CPU, (limit, limit + 5)))
    _, stderr = process.communicate()
    status = None if process.returncode in (-SIGXCPU, 128 + SIGXCPU) else process.returncode
    wall, after = time.monotonic() - start, joules()
    return status, wall, None if energy is None or after is None else after - energy, load, stderr


def run_once(folder, case, p, study):
    """A run in its folder: its record, and one of its timing."""
    shutil.rmtree(folder, ignore_errors=True)
    command = [*shlex.split(study["prefix"]), str(PROGRAM), str(ROOT / case["file"]), "--quiet",
               "--out", str(folder), *set_arguments(p["set"])]
    before = os.times()
    status, wall, energy, load, stderr = timed(command, study["study"].get("threads", 1),
                                               study["study"].get("time_limit", 600))
    after = os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    timing = {"cpu": round(cpu, 3), "wall": round(wall, 3), "joules": energy, "load": round(load, 2)}
    message = stderr.strip().splitlines()[-1] if stderr and stderr.strip() else ""
    if status is None:
        message = f"more than {study['study'].get('time_limit', 600)} s of CPU time"
    summary = {}
    try:
        summary = json.loads((folder / "summary.json").read_text())
    except (OSError, ValueError):
        pass
    guard = summary.get("exit_reason") == "guard"
    outcome = "too slow" if status is None else \
        {0: "finished", 1: "refused", 2: "unstable" if guard else "failed"}.get(status, "failed")
    if summary and status is not None:
        timing["wall"] = round(summary.get("wall_seconds", wall), 3)  # without waiting for its turn
    return outcome, message if outcome != "finished" else "", summary, timing


def record_of(p, outcome, message, summary):
    counters = summary.get("counters", {})
    return dict(p, outcome=outcome, message=message, version=summary.get("version", ""),
                dp=summary.get("parameters", {}).get("dp"), steps=summary.get("steps"),
                solid_steps=summary.get("solid_substeps"), particles=summary.get("particles"),
                particle_steps=counters.get("particle_steps"),
                evaluations=(counters.get("evaluations") or 0) + (counters.get("solid_evaluations") or 0),
                hash=summary.get("state_hash"))


def write_json(path, data):
    part = path.with_suffix(".part")
    part.write_text(json.dumps(data, indent=1))
    part.replace(path)


def run_point(p, study, runs, again=False):
    """Runs a point unless it is cached; `again` adds timings to a finished one."""
    case, rules = study["case"][p["case"]], study["study"]
    folder = runs / p["key"]
    folder.mkdir(parents=True, exist_ok=True)
    result, run = folder / "result.json", folder / "run"
    if result.exists() and not again:
        return json.loads(result.read_text())
    outcome, message, summary, timing = run_once(run, case, p, study)
    record = record_of(p, outcome, message, summary)
    record["timing"] = [timing]
    if outcome == "finished":
        repeats = rules.get("repeats", 1) if timing["cpu"] < rules.get("repeat_below", 1e9) else 1
        for _ in range(repeats - 1):
            record["timing"].append(run_once(run, case, p, study)[3])
    else:
        complain(f"{p['name']}: {outcome}: {message}")
    for file in list(run.glob("*")) if run.is_dir() else []:
        if file.name not in KEEP:
            file.unlink()
    record["machine"] = study_report.machine(ROOT)
    write_json(result, record)
    return record


# --- the whole ---

def give_keys(points, study):
    """Cache keys; refused points stay in the report as what they are."""
    program = program_hash()
    for p in points:
        p["key"], why = effective_hash(study["case"][p["case"]], p, program)
        if p["key"] is None:
            p.update(outcome="refused", message=why)
            complain(f"{p['name']}: refused: {why}")
    return program


def run_all(points, study, runs, again, cached):
    records, done = {}, {}
    for number, p in enumerate(points, 1):
        if p["key"] is None:
            records[p["name"]] = dict(p, timing=[])
            continue
        if cached and not (runs / p["key"] / "result.json").exists():
            records[p["name"]] = dict(p, timing=[], outcome="not run", message="")
            continue
        if p["key"] not in done:
            start = time.monotonic()
            fresh = not (runs / p["key"] / "result.json").exists() or again(p["name"])
            done[p["key"]] = run_point(p, study, runs, again(p["name"]))
            if fresh:
                cpu = [t["cpu"] for t in done[p["key"]]["timing"]]
                print(f"[{number}/{len(points)}] {p['name']}: {done[p['key']]['outcome']}, "
                      f"{min(cpu):.2f} s of CPU ({len(cpu)} runs, {time.monotonic() - start:.0f} s)",
                      flush=True)
        records[p["name"]] = dict(done[p["key"]], **p)
    return records


def add_errors(records, study, runs):
    """Errors of every finished point, measured against references and the finest base run."""
    for name, case in study["case"].items():
        own = [r for r in records.values() if r["case"] == name]
        base = [r for r in own if r["knob"] == "base" and r["outcome"] == "finished"]
        best = max(base, key=lambda r: r["level"], default=None)
        for record in own:
            record["errors"], record["values"] = {}, {}
            if record["outcome"] != "finished":
                continue
            for error in case["error"]:
                try:
                    value, off = measure(error, runs / record["key"] / "run",
                                         best and runs / best["key"] / "run", ROOT)
                except BadFile as problem:
                    study["holes"].append(f"{record['name']}: {error['name']}: {problem}")
                    complain(study["holes"][-1])
                    value, off = None, None
                if record is best and error["kind"] == "against_finest":
                    off = None
                record["errors"][error["name"]], record["values"][error["name"]] = off, value


def collect(records, study, program, data):
    """One line for each point, so that a change of one is a change of a line."""
    rows = []
    for record in records.values():
        keys = ("name", "case", "level", "knob", "value", "set", "outcome", "message", "dp", "steps",
                "solid_steps", "particle_steps", "evaluations", "errors", "values", "timing")
        rows.append(json.dumps({k: record.get(k) for k in keys}))
    machines = sorted({json.dumps(r["machine"]) for r in records.values() if "machine" in r})
    versions = sorted({r["version"] for r in records.values() if r.get("version")})
    head = {"program": program, "versions": versions, "machines": [json.loads(m) for m in machines],
            "holes": study["holes"], "definition": {k: study[k] for k in ("study", "preset", "case", "knob")}}
    text = "{\n" + ",\n".join(f"{json.dumps(k)}: {json.dumps(v)}" for k, v in head.items())
    data.write_text(text + ',\n"points": [\n' + ",\n".join(rows) + "\n]}\n")


def main():
    args = arguments()
    data = args.data or args.study.with_name("results.json")
    evidence = ROOT / "src" / "evidence.def" if data.resolve() == STUDY.with_name("results.json") else None
    if args.report:
        return study_report.write(data, args.out, evidence)
    study = read_study(args.study)
    study["prefix"] = args.prefix
    points = [p for p in points_of(study) if p["name"].startswith(args.only)]
    if args.point:
        points = [p for p in points if p["name"] == args.point]
        if not points:
            raise BadFile(f"no point {args.point} in {args.study}; --list shows them")
    program = give_keys(points, study)
    if args.plan:
        print(json.dumps([{"name": p["name"], "key": p["key"]} for p in points]))
        return 0
    if args.list:
        for p in points:
            cached = p["key"] and (args.runs / p["key"] / "result.json").exists()
            print(f"{'cached ' if cached else 'missing'}  {p['key']}  {p['name']}  {' '.join(p['set'])}")
        return 0
    if args.point:
        return 0 if points[0]["key"] is None else not run_point(points[0], study, args.runs)
    names = None if args.again is None else \
        [n for n in args.again.split(",") if n] or study_report.front_names(data)
    records = run_all(points, study, args.runs,
                      lambda name: names is not None and any(name.startswith(n) for n in names),
                      args.cached)
    add_errors(records, study, args.runs)
    collect(records, study, program, data)
    return study_report.write(data, args.out, evidence)


if __name__ == "__main__":
    run_tool(main)
