# SPDX-License-Identifier: MIT
"""The definition of a study: its points, their keys in the cache, their expected cost."""

import json
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256
from pathlib import Path

import tomllib

from common import PROGRAM, ROOT, BadFile
from study_metrics import KINDS

SCENES = {"solid": "solid alone", "fluid": "fluid alone", "coupled": "fluid and structure"}
# Sources that no run comes by: they look ahead, list, or hold what the study itself has measured.
# What presets set stands in the effective case.
ASIDE = re.compile(r"(evidence|presets|citations|template|embedded|explain|forecast|"
                   r"manual\w*|preview|inspect)\.\w+")


def complain(text):
    print(f"accuracy_cost: {text}", file=sys.stderr, flush=True)


# --- the definition ---

def read_study(path):
    """The definition, without its wrong parts, which are listed."""
    try:
        study = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as problem:
        raise BadFile(f"{path}: {problem}") from None
    study["holes"] = holes = []
    cases, knobs = study.setdefault("case", {}), study.setdefault("knob", {})
    for part, entries, trouble in (("case", cases, case_trouble), ("knob", knobs, knob_trouble)):
        for name, entry in list(entries.items()):
            wrong = trouble(entry)
            if wrong:
                holes.append(f"{Path(path).name}: [{part}.{name}] {wrong}; it is left out")
                del entries[name]
    for name, knob in knobs.items():
        for case in knob.get("cases", []):
            if case not in cases:
                holes.append(f"{Path(path).name}: [knob.{name}] cases: there is no case `{case}`")
    holes += [f"{Path(path).name}: [preset] {text}" for text in preset_trouble(study)]
    if not cases:
        raise BadFile("; ".join(holes) or f"{path}: defines no [case.NAME]")
    study.setdefault("study", {})
    for hole in holes:
        complain(hole)
    return study


def texts(value):
    return isinstance(value, list) and all(isinstance(text, str) for text in value)


def case_trouble(case):
    for key in ("file", "scene", "levels", "across", "error"):
        if key not in case:
            return f"lacks `{key}`"
    if not (ROOT / case["file"]).is_file():
        return f"file = {case['file']}: there is no such case"
    if case["scene"] not in SCENES:
        return f"scene = {case['scene']}: it is one of {', '.join(SCENES)}"
    if not case["levels"] or not all(isinstance(level, str) or texts(level)
                                     for level in case["levels"]):
        return "levels: is not a list of --set arguments, one or a list for each resolution"
    if not isinstance(case["across"], (int, float)) or not case["across"] > 0:
        return f"across = {case['across']}: is not a length in m"
    if not case["error"]:
        return "has no [[case.NAME.error]]"
    return next(filter(None, map(error_trouble, case["error"])), None)


def error_trouble(error):
    if error.get("kind") not in KINDS:
        return f"error kind = {error.get('kind')}: it is one of {', '.join(KINDS)}"
    for key in KINDS[error["kind"]]:
        if key not in error:
            return f"error {error.get('name', '')} of kind {error['kind']} lacks `{key}`"
    file = error.get("file")
    if file and not (ROOT / file).is_file():
        return f"error {error['name']}: there is no reference {file}"
    return None


def knob_trouble(knob):
    if not isinstance(knob.get("values"), dict) or not knob["values"]:
        return "lacks `values`"
    for value, sets in knob["values"].items():
        if not texts(sets):
            return f"value {value}: is not a list of --set arguments"
    return None


def preset_trouble(study):
    """Removes and returns presets whose points do not exist."""
    for preset, scenes in list(study.setdefault("preset", {}).items()):
        for scene, setting in list(scenes.items()):
            knob, _, value = setting.partition("=")
            if scene in SCENES and (setting == "base" or
                                    value in study["knob"].get(knob, {}).get("values", {})):
                continue
            del scenes[scene]
            yield f"{preset}: {scene} = {setting}: no such kind of scene, knob or value"


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


# --- key of a point in the cache ---

def program_hash():
    """Hash of everything in the program that results can depend on."""
    total = sha256()
    for path in sorted([*ROOT.glob("src/*/*"), *ROOT.glob("include/*")]):
        if path.suffix in (".c", ".h", ".def") and not ASIDE.fullmatch(path.name):
            total.update(path.name.encode() + b"\0" + path.read_bytes())
    flags = ROOT / "build" / "release" / "flags"
    if flags.exists():
        total.update(re.sub(r"\S*/\S*", "", flags.read_text()).encode())
    return total.hexdigest()[:16]


def set_arguments(sets):
    return [word for text in sets for word in ("--set", text)]


def ask(case, p, option):
    """The program's answer for a point with `option`, which runs nothing."""
    command = [str(PROGRAM), option, str(ROOT / case["file"]), *set_arguments(p["set"])]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=False, timeout=120,
                              env=dict(os.environ, OMP_NUM_THREADS="1"))
    except (OSError, subprocess.TimeoutExpired) as problem:
        raise BadFile(f"./sphfsi cannot be run ({problem}); make builds it") from None


def give_key(case, p, program):
    """Hash of the case in effect but for its words and references, and the same with the program's;
    without them, and why: it is refused."""
    done = ask(case, p, "--effective")
    p["key"] = p["effective"] = None
    if done.returncode:
        lines = done.stderr.strip().splitlines()
        p.update(outcome="refused", message=lines[-1] if lines else "refused")
        complain(f"{p['name']}: refused: {p['message']}")
        return
    text = re.sub(r"(?m)^(#|title|source).*\n", "", done.stdout)
    text = re.sub(r"(?ms)^\[reference .*?(?=^\[|\Z)", "", text)
    p["effective"] = sha256(text.encode()).hexdigest()[:16]
    p["key"] = sha256((program + text).encode()).hexdigest()[:16]


def give_keys(points, study):
    program = program_hash()
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(lambda p: give_key(study["case"][p["case"]], p, program), points))
    return program


def cached_record(runs, key):
    """The cached record of a key. A run that failed for an outside reason is left out: it runs
    again."""
    try:
        record = json.loads((runs / key / "result.json").read_text()) if key else None
    except (OSError, ValueError):
        return None
    return record if record and record.get("outcome") != "failed" else None


def take_older(points, runs):
    """Uses results of an older program for points that the present one has not run."""
    found = {}
    for path in sorted(runs.glob("*/result.json"), key=lambda p: p.stat().st_mtime):
        record = cached_record(runs, path.parent.name)
        if record and record.get("effective"):
            found[record["effective"]] = path.parent.name
    for p in points:
        if p["key"] and not cached_record(runs, p["key"]):
            p["key"] = found.get(p["effective"], p["key"])


# --- expected cost ---

def foreseen(case, p):
    """CPU s by the program's forecast; None: there is none."""
    said = ask(case, p, "--explain").stdout
    found = re.search(r"(?m)^ *([\d.e+]+) (s|min|h) on this machine when idle", said)
    return float(found[1]) * {"s": 1, "min": 60, "h": 3600}[found[2]] if found else None


def expected_costs(points, study, runs, data, ask_program):
    """{key: CPU s} of the points that are not cached: as the last collected results tell of the
    same point, else as the program foresees it with one thread, which is asked (`ask_program`) once
    and kept; not just before a run, whose first timings that would disturb."""
    kept, before = runs / "forecasts.json", {}
    try:
        known = json.loads(kept.read_text())
    except (OSError, ValueError):
        known = {}
    try:
        for p in json.loads(data.read_text())["points"]:
            if p["timing"]:
                before[p["name"], tuple(p["set"])] = min(t["cpu"] for t in p["timing"])
    except (OSError, ValueError, KeyError):
        pass
    missing = {p["key"]: p for p in points if p["key"] and not cached_record(runs, p["key"])}
    once = {key: before.get((p["name"], tuple(p["set"])), known.get(key)) for key,
            p in missing.items()}
    unknown = [key for key in once if once[key] is None and ask_program]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        once.update(zip(unknown, pool.map(
            lambda key: foreseen(study["case"][missing[key]["case"]], missing[key]), unknown)))
    runs.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(known | {key: once[key] for key in unknown}))
    rules = study["study"]
    return {key: cost * repeats_of(cost, rules) for key, cost in once.items() if cost is not None}


def repeats_of(cpu, rules):
    return rules.get("repeats", 1) if cpu < rules.get("repeat_below", 1e9) else 1
