# SPDX-License-Identifier: MIT
"""What all reports share: the program, runs of it in folders that are read at once, kept results as
JSON, and tables in Markdown."""

import json
import math
import os
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import runfiles  # noqa: E402  finds the package of the clone
from runfiles import *  # noqa: E402,F403
from runfiles import BadFile, read_table  # noqa: E402

# Where reports go; in their quick form (QUICK=1) to a folder to be looked at.
QUICK = os.environ.get("QUICK", "") not in ("", "0")
OUT = ROOT / "build" / "quick" if QUICK else ROOT / "docs" / "results"
IMAGES = OUT / "img" if QUICK else ROOT / "docs" / "img"
IMAGES.mkdir(parents=True, exist_ok=True)

PROGRAM = Path(os.environ.get("SPHFSI") or ROOT / "sphfsi").resolve()


def settings(sets):
    return [word for text in sets for word in ("--set", text)]


def last_line(done):
    """The last line of output of a failed program."""
    return (done.stderr.strip().splitlines() or [f"no message, exit status {done.returncode}"])[-1]


def ask(*words, program=PROGRAM):
    """What the program answers to options that run nothing."""
    try:
        done = subprocess.run([str(program), *map(str, words)], capture_output=True, text=True,
                              check=False)
    except OSError:
        raise BadFile(f"cannot run {program}; build it with make") from None
    if done.returncode:
        raise BadFile(last_line(done))
    return done.stdout


def program_version(program=PROGRAM):
    return ask("--version", program=program).split()[-1]


def machine():
    info = Path("/proc/cpuinfo")
    for line in info.read_text().splitlines() if info.exists() else []:
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return "unknown processor"


def cpu_seconds():
    """User time of the runs so far: other load on the machine changes it little."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


class CaseRun:
    """A run of a case: its tables and summary, the seconds of processor time that it took, and
    whether a guard stopped it. `case` is a path or the text of a case."""

    def __init__(self, case, sets, folder, *more, threads=1):
        self.folder = Path(folder)
        if "\n" in str(case):
            text, case = case, self.folder.with_suffix(".cfg")
            case.write_text(text, encoding="utf-8")
        command = [str(PROGRAM), str(case), "--quiet", "--out", str(folder), *settings(sets), *more]
        before = cpu_seconds()
        done = subprocess.run([*command, "--threads", str(threads)] if threads else command,
                              capture_output=True, text=True, check=False)
        self.seconds, self.stopped = cpu_seconds() - before, done.returncode == 2
        if done.returncode not in (0, 2):
            raise BadFile(f"{' '.join(command)}: {done.stderr.strip()}")
        self.summary = json.loads((self.folder / "summary.json").read_text(encoding="utf-8"))
        top = self.summary["parameters"]
        self.dp, self.end_time = top["dp"], top["end_time"]
        words = (word.removeprefix("constants.").split("=") for word in sets)
        self.constants = {key: float(value) for key, value in words
                          if re.fullmatch(r"[-+.\de]+", value)}

    def table(self, name="probes.csv"):
        return read_table(self.folder / name, finite=False)[0]


def in_scratch(measure, case, sets, *more, **options):
    """measure(run) of a run whose folder is then removed."""
    with tempfile.TemporaryDirectory() as folder:
        return measure(CaseRun(case, sets, f"{folder}/run", *more, **options))


def summary_of(case, sets, *more, **options):
    return in_scratch(lambda run: run.summary, case, sets, *more, **options)


def case_of(scene, folder):
    """The case of a scene: its text, a case of cases/verify, cases or tests/stability, or a
    template, which is written to the folder."""
    if "\n" in scene:
        return scene
    for part in ("cases/verify", "cases", "tests/stability"):
        path = ROOT / part / f"{scene}.cfg"
        if path.is_file():
            return path
    path = Path(folder) / f"{scene}.cfg"
    path.write_text(ask("--new", scene), encoding="utf-8")
    return path


def measure_scene(scene, settings, measure, stops):
    """measure(runs) of runs of a scene, one for each list of settings, and their processor time. A
    list of scenes has one for each run. Whether a guard may stop a run."""
    scenes = scene if isinstance(scene, list) else [scene] * len(settings)
    with tempfile.TemporaryDirectory() as folder:
        runs = [CaseRun(case_of(scene, folder), sets, Path(folder) / f"run{k}")
                for k, (scene, sets) in enumerate(zip(scenes, settings))]
        if not stops and any(run.stopped for run in runs):
            raise BadFile(f"a guard stopped {scene}")
        return measure(runs), round(sum(run.seconds for run in runs), 1)


# --- kept results ---
def load(path, default=None):
    return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else default


def store(path, data):
    path.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")


def store_rows(path, head, name, rows):
    """A row a line, so that a change of one is a change of a line."""
    lines = ",\n".join(json.dumps(row) for row in rows)
    path.write_text(f'{json.dumps(head)[:-1]}, "{name}": [\n{lines}\n]}}\n', encoding="utf-8")


# --- tables ---
def table(head, rows):
    rows = [[str(cell) for cell in row] for row in rows]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def number(value):
    if math.isnan(value):
        return "stopped"
    return str(value) if isinstance(value, int) else f"{value:.3g}"


def kept(value, limit):
    return limit is None or abs(value) <= limit


def cell(value, limit):
    """A number of a table, in brackets where it misses its limit."""
    return number(value) if kept(value, limit) else f"({number(value)})"


def fill(template, **values):
    """The text of a report, which lies beside its tool, with its values."""
    return (Path(__file__).parent / template).read_text(encoding="utf-8").format(**values)


def words_of(file):
    """A function that gives a paragraph of a Markdown file by its heading, filled with values."""
    text = (Path(__file__).parent / file).read_text(encoding="utf-8")
    parts = dict(part.split("\n\n", 1) for part in text.split("## ")[1:])
    return lambda heading, **values: parts[heading].rstrip("\n").format(**values)


def write(path, template, **values):
    path.write_text(fill(template, **values).rstrip() + "\n", encoding="utf-8")
    print(f"written {path.relative_to(ROOT) if path.is_relative_to(ROOT) else path}")


# --- reports of many small scenes ---
def single(measure):
    """For a scene of one run."""
    return lambda runs: measure(runs[0])


def judged(rows):
    """The first lines of a report: how many limits are kept, and which are missed. `rows` are
    (words, value, limit)."""
    rows = [row for row in rows if row[2] is not None]
    missed = [f"* {words}: {number(value)}, limit {number(limit)}" for words, value, limit in rows
              if not kept(value, limit)]
    text = f"{len(rows) - len(missed)} of {len(rows)} limits are kept."
    return "\n".join([text, "", "Missed:", "", *missed] if missed else [text])


def last_cost(report, name):
    """Seconds that a scene took when the committed report was written."""
    scene = load(ROOT / "docs/results" / report.replace(".md", ".json"), {}).get(name)
    return sum(variants(scene["seconds"]).values()) if scene else math.inf


def variants(scene):
    """By their names; a scene of one has no name for it."""
    return scene if isinstance(scene, dict) else {"": scene}


def figures_report(known, asked=None):
    """The answer and the tables of a report; the limits hold for the variant `asked` or for all."""
    rows, answer = [], []
    for name, scene in known.items():
        figures = variants(scene["figures"])
        for k, (what, _, limit) in enumerate(next(iter(figures.values()))):
            values = {variant: of[k][1] for variant, of in figures.items()}
            answer += [(", ".join(filter(None, (name, what, variant != asked and variant))),
                        value, limit)
                       for variant, value in values.items() if asked in (None, variant)]
            rows.append([name, what, *([", ".join(values)] if any(values) else []),
                         ", ".join(cell(value, limit) for value in values.values()),
                         "" if limit is None else number(limit)])
    head = ["scene", "figure", "with", "found", "limit"]
    return {"answer": judged(answer),
            "figures": table(head if len(rows[0]) == len(head) else head[:2] + head[3:], rows),
            "seconds": table(["scene", "processor time, s"],
                             [[name, ", ".join(f"{seconds:.0f}" for seconds in
                                               variants(scene["seconds"]).values())]
                              for name, scene in known.items()])}


def run_figures(doc, scenes, path, slow=(), stops=False, asked=None):
    """The command line of such a report. `scenes` has for each name a case, the settings of each of
    its runs, and measure(runs), which gives rows (words, value, limit or None); or several of
    these, {name of a variant: ...}. A limit is kept if |value| <= limit. `stops`: measure knows
    runs that a guard stopped, whose value is NaN. Figures are kept beside the report at `path`, so
    that --only runs some scenes anew, and nothing else runs the slow ones. The text lies beside
    the tool under the name of `path`."""
    parser = options(doc)
    parser.add_argument("--list", action="store_true", help="say which scenes there are")
    parser.add_argument("--only", default="", help="part of a scene's name: runs these again, "
                        "keeps the figures of the others")
    args, results = parser.parse_args(), path.with_suffix(".json")
    if args.list:
        print("\n".join(scenes))
        return
    chosen = [min(scenes, key=lambda name: last_cost(path.name, name))] if QUICK else scenes
    for name in (name for name in chosen
                 if args.only in name and (args.only or name not in slow)):
        figures, seconds = {}, {}
        for variant, (scene, settings, measure) in variants(scenes[name]).items():
            figures[variant], seconds[variant] = measure_scene(scene, settings, measure, stops)
            for what, value, _ in figures[variant]:
                print(name, variant, what, number(value), flush=True)
        found = {"figures": figures, "seconds": seconds}
        if "" in figures:
            found = {key: of[""] for key, of in found.items()}
        store(results, {**load(results, {}), name: {"version": program_version(), **found}})
    known = load(results, {})
    known = {name: known[name] for name in scenes if name in known}
    versions = ", ".join(sorted({entry["version"] for entry in known.values()}))
    absent = ", ".join(name for name in scenes if name not in known)
    values = figures_report(known, asked)
    values["answer"] += f"\n\nNot run yet: {absent}." * (bool(absent) and not QUICK)
    write(path, path.name, versions=versions, **values)
