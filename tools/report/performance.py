#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures the cost of the program and writes bench/<processor>.csv and docs/performance.md.

Four parts: the bench program (nanoseconds by phase, one thread and all; a million particles, too),
the longest stable step of each integrator (a dam break against a wall), whole runs, and all of that
against the targets there are (performance_targets.py).
Every figure is of this machine as it is loaded now, which the report states. `--bench` runs the
bench only, prints the change against the file there was, and writes it anew.

Example: tools/report/performance.py --bench
"""

import csv
import os
import re
import subprocess
from pathlib import Path

from common import (ROOT, BadFile, in_scratch, np, options, program_version, run_tool, table,
                    words_of, write)
from performance_targets import bench_rows, run_rows

# As the Makefile says where another build folder is measured (B=...).
BUILD = Path(os.environ.get("BUILD") or ROOT / "build/release").resolve()
paragraph = words_of("performance_words.md")
STEPS = {"symplectic": (0.1, 0.2, 0.3, 0.4), "verlet": (0.1, 0.2, 0.3),
         "leapfrog": (0.2, 0.3, 0.4, 0.5, 0.6)}
PARTS = ["sort", "packed", "wall", "fluid", "update", "all"]
# Arithmetic of a pack of pairs in the loop with viscosity and diffusion, sums of both sides,
# counted in the source.
OPERATIONS = 46
# And of a solid's pair in the default form, its three loops together, displacements in two parts.
SOLID_OPERATIONS = 56


def arguments():
    parser = options(__doc__)
    parser.add_argument("--bench", action="store_true", help="the bench only")
    parser.add_argument("--reps", type=int, default=5, help="repetitions, of which the median "
                                                            "counts")
    parser.add_argument("--large", action="store_true",
                        help="with --bench: a million particles as well, as there are without it")
    return parser.parse_args()


def run_bench(args):
    """What the two programs print: comment lines, and rows of a table."""
    def ask(name, *more):
        return subprocess.run([str(BUILD / name), "--reps", str(args.reps), *more], check=True,
                              text=True, capture_output=True).stdout
    return ask("bench_bench", *["--large"] * (args.large or not args.bench)) + \
        ask("bench_neighbours")


def parse(text):
    """Comment lines, and rows by (what, variant, particles, threads, part)."""
    lines = text.splitlines()
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return [line[2:] for line in lines if line.startswith("#")], {
        (row["what"], row["variant"], int(row["particles"]), int(row["threads"]), row["part"]): row
        for row in rows}


def bench_file(notes):
    name = re.sub(r"[^a-z0-9]+", "-", notes[0].split(",")[0].lower()).strip("-")
    return ROOT / "bench" / f"{name}.csv"


def compare(rows, path):
    if not path.exists():
        print(f"{path.relative_to(ROOT)} does not exist yet: nothing to compare with")
        return
    before = parse(path.read_text())[1]
    for key, row in rows.items():
        if key not in before:
            continue
        old, new = float(before[key]["median"]), float(row["median"])
        print(f"{' '.join(map(str, key)):60s} {old:10.4g} -> {new:10.4g} {row['unit']:24s} "
              f"{100 * (new / old - 1) if old else 0:+6.1f} %")


def run_case(case, sets, *more, threads=0):
    """The summary of a run, and M1's rows where there are any; of one without result None."""
    try:
        return in_scratch(lambda run: (run.summary, run.table()), ROOT / case, sets, *more,
                          threads=threads)
    except BadFile:
        return None, None


def step_study():
    """Rows of the table: integrator, C, steps, seconds, extremes of density, how it ended."""
    for integrator, factors in STEPS.items():
        for factor in factors:
            summary, _ = run_case("cases/verify/dam_break_impact.cfg", [
                "ratio=40", f"integrator={integrator}", f"numerics.cfl={factor}"], threads=1)
            row = [integrator, factor, *"----", "no result"]
            if summary:
                low, high = (f"{100 * summary['extremes'][f'density_{end}']:+.1f}"
                             for end in ("lowest", "highest"))
                row[2:] = [summary["steps"], f"{summary['wall_seconds']:.1f}", low, high,
                           summary["exit_reason"]]
            print("  ", *row, flush=True)
            yield row


# case, --set arguments, words, whether on one thread as well
WORK = [
    ("cases/gate.cfg", ["dp=1 mm", "integrator=leapfrog"], "gate, dp = 1 mm, leapfrog", True),
    ("cases/gate.cfg", ["dp=1 mm", "integrator=verlet"], "gate, dp = 1 mm, Verlet", False),
    ("cases/gate.cfg", ["dp=1 mm", "integrator=symplectic"], "gate, dp = 1 mm, symplectic", False),
    ("cases/gate.cfg", ["integrator=leapfrog"], "gate, dp = 0.5 mm, leapfrog", False),
    ("cases/cantilever.cfg", ["ratio=10"], "cantilever, ts/dp = 10", False),
    ("cases/cantilever.cfg", ["ratio=20"], "cantilever, ts/dp = 20", False),
    ("cases/hydrostatic_plate.cfg", ["integrator=leapfrog"], "hydrostatic plate, leapfrog", False),
]


def work_runs(threads):
    """Rows of the table, and {words: numbers} of the runs on all threads."""
    rows, numbers = [], {}
    for case, sets, words, alone in WORK:
        for n in sorted({1, threads} if alone else {threads}):
            summary, m1 = run_case(case, sets, threads=n)
            if summary is None:
                rows.append((words, n, *"-------"))
                continue
            phases, wall = summary["phase_seconds"], summary["wall_seconds"]
            of = numbers[words] = {"seconds": wall, "phases": phases,
                                   "ms": 1e3 * wall / summary["steps"],
                                   "rate": 1e-6 * summary["particle_steps_per_second"]}
            whole = sum(phases.values()) or 1
            peak = max((np.max(np.abs(c)) for name, c in m1.items() if name.startswith("M1_d") and
                        len(c)), default=float("nan"))
            rows.append((words, n, summary["steps"], summary["solid_substeps"], f"{wall:.1f}",
                         f"{of['ms']:.3g}", f"{of['rate']:.3g}", f"{1e3 * peak:.4g}",
                         ", ".join(f"{k} {100 * v / whole:.0f}" for k, v in phases.items())))
            print("  ", *rows[-1], flush=True)
    return rows, numbers


def shared_work(threads):
    """The speed-up of all threads on a moving gate, in words; and the factors."""
    seconds = {1: [], threads: []}
    for _ in range(5):
        for n, found in seconds.items():
            summary, _ = run_case("cases/gate.cfg", ["integrator=leapfrog"], "--until", "0.02",
                                  threads=n)
            if summary is None:
                return "The gate with dp = 0.5 mm did not run.", {}
            phases = summary["phase_seconds"]
            found.append((summary["wall_seconds"], sum(phases.values()) - phases["output"]))
    (one, steps_one), (many, steps_many) = (np.median(found, axis=0) for found in seconds.values())
    particles = sum(summary["particles"].values())
    return (paragraph("shared work", particles=particles, one=one, many=many, threads=threads,
                      many_2=one / many, steps_one=steps_one, steps_many=steps_many,
                      steps_many_2=steps_one / steps_many),
            {"with output": one / many, "steps alone": steps_one / steps_many})


def neighbour_words(value, n):
    """Clusters in chunks and without, against a tile and a neighbour list (bench/neighbours.c)."""
    def of(variant, part):
        return value("neighbours", variant, n, 1, part)
    swept = {"clusters, pairs once": of("chunk", "list and sweep"),
             "clusters": of("cluster", "list and sweep"), "tile": of("tile", "copy and sweep"),
             "list": of("list", "sweep")}
    return paragraph("neighbour words", n=n, swept=swept["clusters, pairs once"],
                     pairs=of("chunk", "pairs"), clusters=swept["clusters"],
                     pairs_2=of("cluster", "pairs"), tile=swept["tile"], list=swept["list"],
                     build=of("list", "build"), entries=4 * of("list", "entries"),
                     swept_2=min(swept, key=swept.get))


def value_of(rows):
    """value(what, variant, particles or None for any, threads, part), nan where there is none."""
    def value(what, variant, particles, threads, part):
        return next((float(row["median"]) for key, row in rows.items()
                     if key[:2] + key[3:] == (what, variant, threads, part)
                     and particles in (None, key[2])), float("nan"))
    return value


def sizes_of(rows, what="fluid"):
    return sorted({key[2] for key in rows if key[0] == what})


def sweep_tables(rows, value):
    sizes, threads = sizes_of(rows), sorted({key[3] for key in rows})
    variants = list(dict.fromkeys(key[1] for key in rows if key[0] == "fluid"))
    each = [(v, n, t) for v in variants for n in sizes for t in threads]

    def cells(at, parts):
        return [f"{value('fluid', *at, part):.1f}" for part in parts]

    def whole(at, parts):
        return [f"{value('fluid', *at, part):.0f}" for part in parts]
    yield "Time in ns per fluid particle and force evaluation, by phase:\n\n" + table(
        ["kernel", "particles", "threads", *PARTS, "bytes/particle"],
        [(*at, *cells(at, PARTS), *whole(at, ["memory"])) for at in each])
    yield "Time in ns per solid particle and step:\n\n" + table(
        ["form", "threads", "ns"],
        [(key[1], key[3], f"{float(row['median']):.1f}") for key, row in rows.items()
         if key[0] == "solid" and key[4] == "step"])
    written = [(*at, *whole(at, ["snapshot", "checkpoint"])) for at in each
               if ("fluid", *at, "snapshot") in rows]
    if written:
        yield "Time in ns per fluid particle of a snapshot and of a checkpoint, with sync of " \
            "files and folder:\n\n" + \
            table(["kernel", "particles", "threads", "snapshot", "checkpoint"], written)
    counted = [f"{whole((v, n, t), ['instructions'])[0]} ({v}, {n} particles)" for v, n, t in each
               if t == 1 and ("fluid", v, n, t, "instructions") in rows]
    yield "Instructions a particle and evaluation: " + (", ".join(counted) or
        "not measured, because this machine has no counter. [absence.md](absence.md) has counts by "
        "valgrind") + "."


def bench_tables(rows):
    value, sizes, threads = value_of(rows), sizes_of(rows), sorted({key[3] for key in rows})
    text = list(sweep_tables(rows, value))
    if sizes_of(rows, "neighbours"):
        text.append(neighbour_words(value, sizes_of(rows, "neighbours")[0]))
    peak = value("machine", "fma", 0, 1, "float")
    rich = next((key[1] for key in rows if key[1].startswith("dam_break (mixed")), None)
    slots, step = (value("solid", "default (mixed)", None, 1, part) for part in ("slots", "step"))
    n = sizes[-1]
    if rich:
        met, ns, bytes_each, whole = (value("fluid", rich, n, 1, part)
                                      for part in ("pairs", "fluid", "memory", "all"))
        rate, copy = met * OPERATIONS / ns, value("machine", "copy", 0, 1, "read + write")
        text.append(paragraph("bench tables", peak=peak, rich=rich, n=n, rate=rate,
                              rate_2=100 * rate / peak, met=met, operations=OPERATIONS))
    if slots == slots:
        rate = slots * SOLID_OPERATIONS / step
        text.append(paragraph("bench tables 2", rate=rate, rate_2=100 * rate / peak, peak=peak,
                              slots=slots, solid_operations=SOLID_OPERATIONS))
    if rich:
        text.append(paragraph("bench tables 3", ns=bytes_each / whole,
                              bytes_each=100 * bytes_each / whole / copy, copy=copy))
    if len(threads) > 1 and rich:
        one, many = threads[0], threads[-1]
        speed = {p: value("fluid", rich, n, one, p) / value("fluid", rich, n, many, p)
                 for p in PARTS}
        serial = max(0.0, (many / speed["all"] - 1) / (many - 1))
        text.append(f"Speed-up of {many} threads over one, {n} particles: " + ", ".join(
            f"{p} {s:.2f}" for p, s in speed.items()) +
            f". By Amdahl's law {100 * serial:.1f} % of the work is serial.")
    return "\n\n".join(text)


def target_rows(rows, numbers, speed):
    """Rows of the table of targets."""
    shares = {words: of["phases"] for words, of in numbers.items()
              if words.startswith("gate") and words.endswith("leapfrog")}
    return [*run_rows(numbers), *bench_rows(value_of(rows), sizes_of(rows), shares, speed)]


def summary(targets, numbers, speed):
    """Three sentences: targets met, the cost of a gate, the speed-up."""
    missed = [row[0] for row in targets if row[-1] != "met"]
    gate = numbers.get("gate, dp = 0.5 mm, leapfrog")
    text = f"**How fast is it?** {len(targets) - len(missed)} of {len(targets)} targets are met" + \
        (f"; missed: {'; '.join(missed)}. " if missed else ". ")
    if gate:
        text += (f"The elastic gate with dp = 0.5 mm takes {gate['seconds']:.3g} s, "
                 f"{gate['ms']:.3g} ms a step of the fluid and {gate['rate']:.3g} million particle "
                 "steps a second. ")
    return text + (f"All threads make its steps {speed['steps alone']:.2f} times as fast as one."
                   if speed else "The speed-up by threads was not measured.")


def other_processors(own):
    """Rows of what was measured elsewhere, or with an earlier program, from the committed files."""
    columns = [("machine", "fma", "float"), ("machine", "copy", "read + write"),
               ("solid", "default (double)", "step"), ("fluid", "bare (mixed)", "fluid"),
               ("fluid", "dam_break (mixed)", "fluid"), ("fluid", "dam_break (mixed)", "all")]
    for path in sorted((ROOT / "bench").glob("*.csv")):
        if path != own:
            notes, rows = parse(path.read_text())
            value, largest = value_of(rows), sizes_of(rows)[-1]
            yield (f"[{notes[0].split(',')[0]}](../bench/{path.name})", *(
                f"{value(what, variant, largest if what == 'fluid' else None, 1, part):.3g}"
                for what, variant, part in columns))


def main():
    args = arguments()
    text = run_bench(args)
    notes, rows = parse(text)
    path = bench_file(notes)
    compare(rows, path)
    path.write_text(text)
    if args.bench:
        return
    threads = max(key[3] for key in rows)
    print("longest steps:", flush=True)
    steps = list(step_study())
    print("whole runs:", flush=True)
    whole, numbers = work_runs(threads)
    shared, speed = shared_work(threads) if threads > 1 else ("", {})
    targets = target_rows(rows, numbers, speed)
    write(ROOT / "docs/performance.md", "performance.md",
          summary=summary(targets, numbers, speed), version=program_version(), processor=notes[0],
          note=notes[1], load=os.getloadavg()[0], reps=args.reps, file=path.name, shared=shared,
          targets=paragraph("target words") + "\n\n" + table(
              ["work", "other programs", "target", "measured", ""], targets),
          bench=bench_tables(rows),
          steps=table(["integrator", "cfl", "steps", "seconds", "lowest density, %", "highest, %",
                       "ended"], steps),
          work=table(["work", "threads", "fluid steps", "solid steps", "seconds", "ms a step",
                      "million particle steps a second", "displacement, mm",
                      "share of phases, %"], whole),
          others=table(["processor", "fma, 1e9/s", "copy, GB/s", "solid in double, ns",
                        "bare sweep, ns", "dam_break sweep, ns", "dam_break all, ns"],
                       other_processors(path)))


if __name__ == "__main__":
    run_tool(main)
