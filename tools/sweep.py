#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs a case over a grid or a sample of values: writes folders and a Snakemake workflow, which
runs locally or on a cluster and continues after a kill, and gathers one table and one plot."""

import argparse
import itertools
import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
import warnings
from pathlib import Path

import runfiles
from runfiles import BadFile
from sphfsi.sweep import METRICS, draw, grid, read_rows, read_vary, sample, write_table

ROOT = Path(__file__).resolve().parent.parent
EXAMPLE = """examples (PY=$(cat build/python)):
  $PY tools/sweep.py cases/gate.cfg --vary dp=2mm,1mm --vary gate.young=8MPa:14MPa:2MPa --go
  $PY tools/sweep.py cases/gate.cfg --vary gate.young=8MPa:14MPa \\
      --vary water.artificial_viscosity=0.01:0.05 --sample lhs:50 --metric M1_dx_m:largest \\
      --out sweeps/gate-sample
On a cluster: snakemake -d DIR -s DIR/Snakefile --executor slurm --jobs 20 --rerun-incomplete
(with snakemake-executor-plugin-slurm; threads, memory and time of a job stand in the workflow)."""
MOST_FORECASTS = 16


def arguments():
    parser = runfiles.options(__doc__, EXAMPLE)
    parser.add_argument("case", nargs="?", help="case file")
    parser.add_argument("--vary", action="append", default=[], metavar="KEY=VALUES",
                        help="values A,B,C or a range LOW:HIGH:STEP (of a sample LOW:HIGH); may be "
                             "repeated")
    parser.add_argument("--sample", metavar="lhs:N", help="N runs by Latin hypercube instead of "
                                                          "the grid")
    parser.add_argument("--seed", type=int, default=1, help="of the sample (%(default)s)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                        help="in every run")
    parser.add_argument("--until", type=runfiles.until, default=0.0, metavar="TIME",
                        help="end of every run, in s or as 50ms")
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

def settings(plan, k):
    return [f"{key}={value}" for key, value in plan["runs"][k].items()] + plan["sets"]


def command(plan, k, folder, *options):
    until = ["--until", repr(plan["until"])] if plan["until"] else []
    return [plan["program"], plan["case"],
            *itertools.chain.from_iterable(("--set", s) for s in settings(plan, k)), *until,
            "--threads", str(plan["threads"]), "--out", str(folder), *options]


def forecast(plan):
    """The largest wall time (s) and memory (MB) of a run, foreseen for some of them; and a
    sentence. A case that is wrong is refused here, before anything is written."""
    n = len(plan["runs"])
    picked = sorted({round(k * (n - 1) / max(1, min(n, MOST_FORECASTS) - 1)) for k in
                     range(min(n, MOST_FORECASTS))})
    warnings.simplefilter("ignore")  # each run says its own
    costs = [runfiles.make_case(plan["case"], settings(plan, k)).explain(
        until=plan["until"], threads=plan["threads"])["cost"] for k in picked]
    seconds = [cost["wall_seconds"] for cost in costs]
    whole = sum(seconds) / len(seconds) * n
    return (max(seconds), max(cost["memory_bytes"] for cost in costs) / 1e6,
            f"{n} runs of {min(seconds):.3g} to {max(seconds):.3g} s on {plan['threads']} thread(s)"
            f" of this machine when idle, {whole / 3600:.3g} h one after the other")


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
    plan["minutes"] = int(3 * seconds / 60) + 5
    plan["mem_mb"] = int(2 * memory) + 200
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

def gather(out):
    plan = json.loads(runfiles.read_text(out / "sweep.json"))
    rows = read_rows(out / "runs", plan["runs"])
    write_table(out / "table.csv", rows)
    runfiles.save(draw(plan, rows), out / "sweep.png")
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
