# SPDX-License-Identifier: MIT
"""The definition of an accuracy study, its points, and running them."""

import os
import re
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import tomllib

import common
from common import ROOT, BadFile
from runs import Job, case_hash

SCENES = {"solid": "solid alone", "fluid": "fluid alone", "coupled": "fluid and structure"}
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
    summary = common.load(folder / "summary.json", {})
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


