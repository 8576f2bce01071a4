#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs a case over a grid or a sample of values: writes folders and a Snakemake workflow, which
runs locally or on a cluster and continues after a kill, and gathers one table and one plot."""

import argparse
import itertools
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import runfiles
from runfiles import COLOURS, BadFile, np, plt

ROOT = Path(__file__).resolve().parent.parent
EXAMPLE = """examples (PY=$(cat build/python)):
  $PY tools/sweep.py cases/gate.cfg --vary dp=2mm,1mm --vary gate.young=8MPa:14MPa:2MPa --go
  $PY tools/sweep.py cases/gate.cfg --vary gate.young=8MPa:14MPa \\
      --vary water.artificial_viscosity=0.01:0.05 --sample lhs:50 --metric M1_dx_m:largest \\
      --out sweeps/gate-sample
On a cluster: snakemake -d DIR -s DIR/Snakefile --executor slurm --jobs 20 --rerun-incomplete
(with snakemake-executor-plugin-slurm; threads, memory and time of a job stand in the workflow)."""
METRICS = {"final": lambda v: v[-1], "low": np.min, "high": np.max, "mean": np.mean,
           "largest": lambda v: v[np.argmax(np.abs(v))]}
MOST_FORECASTS = 16
NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLE,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", nargs="?", help="case file")
    parser.add_argument("--vary", action="append", default=[], metavar="KEY=VALUES",
                        help="values A,B,C or a range LOW:HIGH:STEP (of a sample LOW:HIGH); may be "
                             "repeated")
    parser.add_argument("--sample", metavar="lhs:N", help="N runs by Latin hypercube instead of "
                                                          "the grid")
    parser.add_argument("--seed", type=int, default=1, help="of the sample (%(default)s)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                        help="in every run")
    parser.add_argument("--until", metavar="TIME", help="end of every run, s")
    parser.add_argument("--threads", type=int, default=1, help="of a run (%(default)s)")
    parser.add_argument("--metric", metavar="COLUMN:WHAT", help="what the plot shows: a column of "
                                                                "the "
                        f"probes and one of {', '.join(METRICS)} (default: the first column, "
                        f"largest)")
    parser.add_argument("--out", metavar="DIR", help="(default: sweeps/NAME)")
    parser.add_argument("--program", default=str(ROOT / "sphfsi"), help="(%(default)s)")
    parser.add_argument("--go", nargs="?", const=1, type=int, metavar="CORES",
                        help="run it here with snakemake, on so many cores")
    parser.add_argument("--one", type=int, metavar="K", help=argparse.SUPPRESS)
    parser.add_argument("--gather", action="store_true",
                        help="only make table.csv and sweep.png of --out anew")
    args = parser.parse_args()
    if not args.case and args.one is None and not args.gather:
        parser.print_help()
        sys.exit(1)
    if (args.one is not None or args.gather) and not args.out:
        parser.error("--out is missing")
    if args.case and not args.vary:
        parser.error("nothing is varied; --vary KEY=VALUES")
    if args.threads < 1 or (args.go is not None and args.go < 1):
        parser.error("threads and cores are 1 or more")
    return args


# --- the plan ---

def with_unit(text, key):
    found = NUMBER.match(text)
    if not found:
        raise BadFile(f"--vary {key}: '{text}' is not a number with its unit")
    return float(found[1]), found[2]


def as_text(value, unit):
    return f"{value:.10g} {unit}".strip()


def read_vary(text):
    """KEY, and its values as texts or its range (low, high, step or None, unit)."""
    key, equals, values = text.partition("=")
    key, values = key.strip(), values.strip()
    if not equals or not key or not values:
        raise BadFile(f"--vary {text}: not KEY=VALUES")
    if ":" not in values:
        return key, [value.strip() for value in values.split(",")]
    parts = [with_unit(part, key) for part in values.split(":")]
    units = {unit for _, unit in parts} - {""}
    if len(parts) not in (2, 3) or len(units) > 1:
        raise BadFile(f"--vary {key}: {values} is not LOW:HIGH:STEP in one unit")
    low, high, step = parts[0][0], parts[1][0], parts[2][0] if len(parts) == 3 else None
    if not low < high or (step is not None and not 0 < step <= high - low):
        raise BadFile(f"--vary {key}: {values} goes from no lower to a higher value by steps")
    return key, (low, high, step, "".join(units))


def grid(varied):
    """All combinations, the first key slowest."""
    levels = []
    for key, values in varied:
        if isinstance(values, tuple):
            low, high, step, unit = values
            if step is None:
                raise BadFile(f"--vary {key}: a grid needs the step of a range, LOW:HIGH:STEP")
            count = int((high - low) / step * (1 + 1e-12)) + 1
            values = [as_text(low + k * step, unit) for k in range(count)]
        levels.append(values)
    keys = [key for key, _ in varied]
    return [dict(zip(keys, combination)) for combination in itertools.product(*levels)]


def sample(varied, how, seed):
    """A Latin hypercube: each of N equal parts of every range is met once (McKay et al. 1979)."""
    found = re.fullmatch(r"lhs:(\d+)", how)
    if not found or int(found[1]) < 2:
        raise BadFile(f"--sample {how}: not lhs:N with N of 2 or more")
    n, random, columns = int(found[1]), np.random.default_rng(seed), {}
    for key, values in varied:
        share = (random.permutation(n) + random.random(n)) / n
        if isinstance(values, tuple):
            low, high, _, unit = values
            columns[key] = [as_text(float(f"{low + (high - low) * s:.6g}"), unit) for s in share]
        else:
            columns[key] = [values[int(s * len(values))] for s in share]
    return [dict(zip(columns, row)) for row in zip(*columns.values())]


def command(plan, k, folder, *options):
    sets = [f"{key}={value}" for key, value in plan["runs"][k].items()] + plan["sets"]
    until = ["--until", plan["until"]] if plan["until"] else []
    return [plan["program"], plan["case"],
            *itertools.chain.from_iterable(("--set", s) for s in sets), *until,
            "--threads", str(plan["threads"]), "--out", str(folder), *options]


def forecast(plan):
    """Wall time (s) and memory (MB) of a run each, foreseen by --explain for some of them; and a
    sentence. A case that is wrong is refused here, before anything is written."""
    n = len(plan["runs"])
    picked = sorted({round(k * (n - 1) / max(1, min(n, MOST_FORECASTS) - 1)) for k in
                     range(min(n, MOST_FORECASTS))})
    seconds, memory = [], []
    for k in picked:
        said = subprocess.run(command(plan, k, "unused", "--explain"), capture_output=True,
                              text=True)
        if said.returncode:
            raise BadFile(f"run {k}: "
                          f"{said.stderr.strip().splitlines()[-1].removeprefix('sphfsi: ')}")
        found = re.search(r"([\d.e+-]+) (s|min|h) on this machine when idle, "
                          r"memory ([\d.e+-]+) (MB|GB)", said.stdout)
        if found:
            seconds.append(float(found[1]) * {"s": 1, "min": 60, "h": 3600}[found[2]])
            memory.append(float(found[3]) * {"MB": 1, "GB": 1000}[found[4]])
    if not seconds:
        return None, None, f"{n} runs; what they cost cannot be foreseen"
    whole = sum(seconds) / len(seconds) * n
    return max(seconds), max(memory), (f"{n} runs of {min(seconds):.3g} to {max(seconds):.3g} s on "
                                       f"{plan['threads']} thread(s) of this machine when idle, "
                                       f"{whole / 3600:.3g} h one after the other")


SNAKEFILE = """# Written by tools/sweep.py; sweep.json beside it holds the runs.
import json
plan = json.load(open("sweep.json"))
tool = plan["tool"] + " --out ."
localrules: all, gather

rule all:
    input: "table.csv", "sweep.png"

# The mark is the output, not the folder: what a job that was killed has left is gone on from.
rule run:
    output: touch("runs/{k}.done")
    log: "runs/{k}.log"
    threads: plan["threads"]
    resources: mem_mb=plan["mem_mb"], runtime=plan["minutes"]
    shell: tool + " --one {wildcards.k} >{log} 2>&1"

rule gather:
    input: expand("runs/{k}.done", k=range(len(plan["runs"])))
    output: "table.csv", "sweep.png"
    shell: tool + " --gather"
"""


def write_plan(args, out):
    case = Path(args.case).resolve()
    if not case.is_file():
        raise BadFile(f"cannot read {args.case}: no such file")
    varied = [read_vary(text) for text in args.vary]
    runs = sample(varied, args.sample, args.seed) if args.sample else grid(varied)
    plan = {"case": str(case), "program": str(Path(args.program).resolve()), "sets": args.set,
            "until": args.until, "threads": args.threads, "metric": args.metric, "runs": runs,
            "tool": shlex.join([sys.executable, str(Path(__file__).resolve())])}
    old = out / "sweep.json"
    if old.exists():
        before = json.loads(runfiles.read_text(old))
        if any(before[key] != plan[key] for key in ("case", "sets", "until", "runs")):
            raise BadFile(f"{out} holds another sweep; choose another --out or remove it")
    seconds, memory, sentence = forecast(plan)
    # Jobs get thrice the time and twice the memory that is foreseen for the dearest.
    plan["minutes"] = int(3 * (seconds or 3600) / 60) + 5
    plan["mem_mb"] = int(2 * (memory or 1000)) + 200
    (out / "runs").mkdir(parents=True, exist_ok=True)
    old.write_text(json.dumps(plan, indent=1) + "\n", encoding="utf-8")
    (out / "Snakefile").write_text(SNAKEFILE, encoding="utf-8")
    return sentence


def snakemake():
    """The program: named by SNAKEMAKE, beside this Python, or in the path; None where there is
    none."""
    beside = Path(sys.executable).parent / "snakemake"
    named = os.environ.get("SNAKEMAKE")
    return named or (str(beside) if beside.is_file() else shutil.which("snakemake"))


# --- a run ---

def run_one(out, k):
    """Runs number k, from its checkpoint where there is one. A run that a guard stops is a result,
    too."""
    plan = json.loads(runfiles.read_text(out / "sweep.json"))
    folder = out / "runs" / str(k)
    summary = folder / "summary.json"
    if summary.exists() and runfiles.Run(folder).summary.get("exit_reason") in ("finished",
                                                                                "guard"):
        return 0
    if not any(folder.glob("*.ckpt")) and folder.exists():
        shutil.rmtree(folder)  # nothing to go on from
    again = ["--restart"] if folder.exists() else []
    child = subprocess.Popen(command(plan, k, folder, "--quiet", *again))
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda n, _: child.send_signal(n))
    status = child.wait()
    return 0 if status == 2 and runfiles.Run(folder).summary.get("exit_reason") == "guard" \
        else status


# --- what came out ---

def outcome(run):
    """Measures of every probe column, {"M1_dx_m:largest": value}."""
    found = {}
    try:
        curves = run.curves()
    except BadFile:
        return found
    for column, (_, values) in curves.items():
        values = values[np.isfinite(values)]
        if len(values):
            found.update((f"{column}:{name}", float(f(values))) for name, f in METRICS.items())
    return found


def read_rows(out, plan):
    rows = []
    for k, values in enumerate(plan["runs"]):
        row = {"run": k, **values, "exit_reason": "missing", "wall_seconds": float("nan")}
        folder = out / "runs" / str(k)
        if folder.is_dir():
            run = runfiles.Run(folder)
            row["exit_reason"] = run.summary.get("exit_reason", "running")
            row["wall_seconds"] = run.summary.get("wall_seconds", float("nan"))
            row.update(outcome(run))
        rows.append(row)
    return rows


def cell(value):
    text = f"{value:.9g}" if isinstance(value, float) else str(value)
    return f'"{text}"' if "," in text else text


def write_table(path, rows):
    names = list(dict.fromkeys(name for row in rows for name in row))
    lines = [",".join(names)] + [",".join(cell(row.get(name, "")) for name in names)
                                 for row in rows]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def numbers(rows, key):
    """Values of a key and its unit; of words their places in the order in which they come."""
    texts = [row[key] for row in rows]
    found = [NUMBER.match(text) for text in texts]
    units = {match[2] for match in found if match}
    if all(found) and len(units) == 1:
        return np.array([float(match[1]) for match in found]), units.pop()
    words = list(dict.fromkeys(texts))
    return np.array([words.index(text) for text in texts], float), ", ".join(words)


def swings(keys, inputs, result):
    """What the result changes by when a value goes from its lowest to its highest, the others held:
    slopes of the plane of least squares times the ranges."""
    ranges = [np.ptp(inputs[key]) or 1.0 for key in keys]
    columns = [(inputs[key] - inputs[key].mean()) / width for key, width in zip(keys, ranges)]
    plane = np.column_stack([np.ones(len(result)), *columns])
    return dict(zip(keys, np.linalg.lstsq(plane, result, rcond=None)[0][1:]))


def draw(path, plan, rows):
    keys = list(plan["runs"][0])
    metric = plan["metric"] or next((name for row in rows for name in row
                                     if name.endswith(":largest")), None)
    if metric and not any(metric in row for row in rows):
        known = sorted({name for row in rows for name in row if ":" in name})
        raise BadFile(f"no run has {metric}; there are {', '.join(known)}")
    good = [row for row in rows if row["exit_reason"] == "finished" and metric in row]
    figure, axes = plt.subplots(1, 1 + len(keys), figsize=(2.6 * (1 + len(keys)), 2.6),
                                squeeze=False,
                                layout="constrained")
    if good:
        result = np.array([row[metric] for row in good])
        inputs = {key: numbers(good, key) for key in keys}
        swing = swings(keys, {key: values for key, (values, _) in inputs.items()}, result)
        order = sorted(keys, key=lambda key: abs(swing[key]))
        axes[0, 0].barh(order, [swing[key] for key in order],
                        left=[result.mean() - swing[key] / 2 for key in order], color=COLOURS[0])
        axes[0, 0].axvline(result.mean(), color="0.4", linewidth=0.8)
        axes[0, 0].set_xlabel(metric)
        axes[0, 0].use_sticky_edges = False
        axes[0, 0].margins(x=0.05)
        axes[0, 1].set_ylabel(metric)
        for place, key in zip(axes[0, 1:], keys):
            place.plot(inputs[key][0], result, "o", color=COLOURS[1], markersize=4)
            place.set_xlabel(f"{key} ({inputs[key][1]})" if inputs[key][1] else key)
    axes[0, 0].set_title(f"change from lowest to highest value\n{len(good)} of {len(rows)} runs "
                         f"finished")
    runfiles.save(figure, path)


def gather(out):
    plan = json.loads(runfiles.read_text(out / "sweep.json"))
    rows = read_rows(out, plan)
    write_table(out / "table.csv", rows)
    draw(out / "sweep.png", plan, rows)
    bad = [row for row in rows if row["exit_reason"] != "finished"]
    print(f"written {out / 'table.csv'}: {len(rows)} runs" +
          "".join(f"; run {row['run']}: {row['exit_reason']}" for row in bad))


def main():
    args = arguments()
    out = Path(args.out or Path("sweeps") / Path(args.case).stem)
    if args.one is not None:
        return run_one(out, args.one)
    if args.gather:
        return gather(out)
    print(write_plan(args, out))
    # The program refuses a folder in which another works, so that no lock beside it is needed.
    run = [snakemake() or "snakemake", "-d", str(out), "-s", str(out / "Snakefile"),
           "--rerun-incomplete",
           "--nolock", "--cores", str(args.go or 1)]
    if args.go is None:
        print("written " + str(out) + "; run it, and go on with it after a kill, with\n  " +
              shlex.join(run))
        return 0
    if not snakemake():
        raise BadFile(f"snakemake is missing; {shlex.quote(sys.executable)} -m pip install "
                      f"snakemake")
    return subprocess.run([*run, "--quiet"]).returncode


if __name__ == "__main__":
    runfiles.run_tool(main)
