#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The benchmark of Turek and Hron (2006): runs its cases, reads drag, lift and the displacement of A,
finds out whether they rest, repeat themselves or do neither yet, and writes docs/turek_hron.md.

examples:
  tools/turek_hron.py run fsi2 --across 10        runs the case into runs/turek_hron/fsi2-10
  tools/turek_hron.py read runs/turek_hron/*      prints what the runs show
  tools/turek_hron.py keep runs/turek_hron/*      adds it to docs/turek_hron.json
  tools/turek_hron.py report                      writes docs/turek_hron.md from there
  tools/turek_hron.py pictures runs/turek_hron/fsi2-10   draws docs/img/turek_hron_*.png
"""
import argparse
import csv
import json
import math
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CASES = ROOT / "cases" / "turek_hron"
KEPT = ROOT / "docs" / "turek_hron.json"
PAGE = ROOT / "docs" / "turek_hron.md"

# Mean, amplitude and frequency (Hz) in mm and N/m; amplitude and frequency None: steady. Turek and Hron
# (2006) for CSM, CFD and FSI1; the finest levels quoted by the verification pages of solids4foam for FSI2;
# Turek et al. (2010) for FSI3.
REFERENCE = {
    "csm1": {"ux": (-7.187, None, None), "uy": (-66.10, None, None)},
    "csm2": {"ux": (-0.469, None, None), "uy": (-16.97, None, None)},
    "csm3": {"ux": (-14.305, 14.305, 1.0995), "uy": (-63.607, 65.160, 1.0995)},
    "cfd1": {"drag": (14.29, None, None), "lift": (1.119, None, None)},
    "cfd2": {"drag": (136.7, None, None), "lift": (10.53, None, None)},
    "cfd3": {"drag": (439.45, 5.618, 4.3956), "lift": (-11.893, 437.81, 4.3956)},
    "fsi1": {"ux": (0.0227, None, None), "uy": (0.8209, None, None),
             "drag": (14.295, None, None), "lift": (0.7638, None, None)},
    "fsi2": {"ux": (-14.85, 12.70, 3.86), "uy": (1.30, 81.6, 1.93),
             "drag": (215.06, 77.65, 3.86), "lift": (0.61, 237.8, 1.93)},
    "fsi3": {"ux": (-2.88, 2.72, 10.9), "uy": (1.47, 34.99, 5.5),
             "drag": (460.5, 27.74, 10.9), "lift": (2.50, 153.91, 5.5)},
}
UNIT = {"ux": "mm", "uy": "mm", "drag": "N/m", "lift": "N/m"}
# Error of the amplitude of uy in % against core-seconds for a whole run.
OTHERS = [
    ("OpenFOAM (solids4foam), FSI2", -12.4, 4173, "verification pages of solids4foam"),
    ("OpenFOAM (solids4foam), FSI2", -1.3, 28 * 3600, "verification pages of solids4foam"),
    ("OpenFOAM (solids4foam), FSI3", -14.7, 1.4 * 3600, "verification pages of solids4foam"),
    ("OpenFOAM (solids4foam), FSI3", -2.3, 44 * 3600, "verification pages of solids4foam"),
    ("OpenFOAM (solids4foam), FSI3", 3.5, 1306 * 3600, "verification pages of solids4foam"),
]
# Case, quantity, part of it, and the largest error in per cent of the finest run (cost: core-hours).
TARGETS = [
    ("cfd1", "drag", "mean", 2),
    ("cfd2", "drag", "mean", 2),
    ("cfd3", "drag", "mean", 3), ("cfd3", "lift", "amplitude", 10), ("cfd3", "lift", "frequency", 2),
    ("fsi1", "ux", "mean", 5), ("fsi1", "uy", "mean", 5), ("fsi1", "drag", "mean", 5),
    ("fsi1", "lift", "mean", 5),
    ("fsi2", "uy", "amplitude", 3), ("fsi2", "uy", "frequency", 2), ("fsi2", "run", "cost", 2),
    ("fsi3", "uy", "amplitude", 5), ("fsi3", "uy", "frequency", 2), ("fsi3", "run", "cost", 4),
]
PERIODS = 6      # at the end that mean and amplitude are taken of
SAME = 0.05      # their first and second halves agree to this, in length and in size
ALIKE = 0.2      # and each of them differs from their mean by no more than this
SMOOTH = 0.1     # of a period: forces are averaged over this before their largest values are taken
REST = 0.02      # a series whose means of two sixths agree to this, of its size, rests


def columns(folder):
    """Times and the series of a run in mm and N/m."""
    path = Path(folder) / "probes.csv"
    with open(path, encoding="utf-8") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    names, values = rows[0], [[float(v) for v in row] for row in rows[1:]]

    def column(name):
        return [row[names.index(name)] for row in values] if name in names else None

    series = {}
    if column("A_dx_m"):
        series["ux"] = [1e3 * v for v in column("A_dx_m")]
        series["uy"] = [1e3 * v for v in column("A_dy_m")]
    if column("cylinder_fx_N_per_m"):
        for name, axis in (("drag", "x"), ("lift", "y")):
            series[name] = [a + b for a, b in zip(column(f"cylinder_f{axis}_N_per_m"),
                                                  column(f"bar_f{axis}_N_per_m"))]
    return column("time_s"), series


def mean(values):
    return sum(values) / len(values)


def crossings(times, values, middle, margin):
    """Times at which the values pass the middle upwards, having been below it by a margin."""
    found, below = [], False
    for k in range(1, len(values)):
        if values[k] < middle - margin:
            below = True
        if below and values[k - 1] <= middle < values[k]:
            part = (middle - values[k - 1]) / (values[k] - values[k - 1])
            found.append(times[k - 1] + part * (times[k] - times[k - 1]))
            below = False
    return found


def periods(times, values):
    """The last periods as (begin, end), or none where they do not agree."""
    half = [v for t, v in zip(times, values) if t >= 0.5 * times[-1]]
    middle, size = 0.5 * (max(half) + min(half)), 0.5 * (max(half) - min(half))
    up = crossings(times, values, middle, 0.3 * size)[-PERIODS - 1:]
    if size == 0 or len(up) < PERIODS + 1:
        return []
    spans = list(zip(up[:-1], up[1:]))
    sizes = []
    for begin, end in spans:
        inside = [v for t, v in zip(times, values) if begin <= t <= end]
        sizes.append(max(inside) - min(inside))
    lengths = [end - begin for begin, end in spans]
    for agree in (lengths, sizes):
        whole, half = mean(agree), PERIODS // 2
        if abs(mean(agree[:half]) - mean(agree[half:])) > SAME * whole:
            return []
        if max(abs(v - whole) for v in agree) > ALIKE * whole:
            return []
    return spans


def smooth(times, values, width):
    """Running means over a width: forces have the noise of sound in them."""
    step = (times[-1] - times[0]) / (len(times) - 1)
    reach = int(0.5 * width / step)
    return [mean(values[max(0, k - reach):k + reach + 1]) for k in range(len(values))]


def summary(times, values, spans):
    """Mean, amplitude (of the largest and least values) and frequency over periods; None: not periodic."""
    if spans:
        most, least = [], []
        for begin, end in spans:
            inside = [v for t, v in zip(times, values) if begin <= t <= end]
            most.append(max(inside))
            least.append(min(inside))
        high, low = mean(most), mean(least)
        return {"state": "periodic", "mean": 0.5 * (high + low), "amplitude": 0.5 * (high - low),
                "frequency": len(spans) / (spans[-1][1] - spans[0][0])}
    end = times[-1]
    sixth = [[v for t, v in zip(times, values) if end * (6 - k) / 6 <= t <= end * (7 - k) / 6]
             for k in (1, 2)]
    last, before = mean(sixth[0]), mean(sixth[1])
    scatter = math.sqrt(mean([(v - last) ** 2 for v in sixth[0]]))
    steady = abs(last - before) <= REST * max(abs(last), scatter)
    return {"state": "steady" if steady else "neither steady nor periodic yet", "mean": last,
            "amplitude": scatter, "frequency": None}


def smoothed(name, times, values, spans):
    if name not in ("drag", "lift") or not spans:
        return values
    return smooth(times, values, SMOOTH * (spans[-1][1] - spans[-1][0]))


def read(folder):
    folder = Path(folder)
    times, series = columns(folder)
    spans = periods(times, series["uy"] if "uy" in series else series["lift"])
    with open(folder / "summary.json", encoding="utf-8") as file:
        run = json.load(file)
    cost = json.loads((folder / "cost.json").read_text()) if (folder / "cost.json").exists() else {}
    name, _, across = folder.name.rpartition("-")
    return {"case": name, "across": int(across), "time": times[-1], "exit": run["exit_reason"],
            "particles": run["particles"], "steps": run["steps"], "version": run["version"],
            "cpu_seconds": cost.get("cpu_seconds"), "settings": cost.get("settings", []),
            "series": {k: summary(times, smoothed(k, times, v, spans), spans)
                       for k, v in series.items()}}


def error(found, wanted):
    return "" if not wanted else f" ({100 * (found / wanted - 1):+.1f} %)"


def show(quantity, found, wanted):
    text = f"{found['mean']:.4g}{error(found['mean'], wanted[0])}"
    if found["state"] == "periodic":
        text += f" ± {found['amplitude']:.4g}{error(found['amplitude'], wanted[1])} {UNIT[quantity]}"
        text += f", {found['frequency']:.4g} Hz"
        if wanted[2]:
            own = found["frequency"] * round(wanted[2] / found["frequency"])
            text += error(own, wanted[2]) if own else ""
    else:
        text += f" {UNIT[quantity]}, scatter {found['amplitude']:.3g}, {found['state']}"
    return text


def run_case(args):
    folder = ROOT / "runs" / "turek_hron" / f"{args.case}-{args.across}"
    command = [str(args.program.resolve()), str(CASES / f"{args.case}.cfg"), "--out", str(folder),
               "--threads", str(args.threads), "--set", f"across={args.across}"]
    if args.end:
        command += ["--set", f"end_time={args.end}"]
    for setting in args.set:
        command += ["--set", setting]
    begin = time.time()
    status = subprocess.run(command, check=False).returncode
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    (folder / "cost.json").write_text(json.dumps(
        {"cpu_seconds": used.ru_utime + used.ru_stime, "wall_seconds": time.time() - begin,
         "settings": args.set}))
    print(json.dumps(read(folder), indent=2))
    return status


def keep(folders):
    kept = json.loads(KEPT.read_text()) if KEPT.exists() else []
    for folder in folders:
        new = read(folder)
        kept = [k for k in kept if (k["case"], k["across"]) != (new["case"], new["across"])] + [new]
    kept.sort(key=lambda k: (k["case"], k["across"]))
    KEPT.write_text(json.dumps(kept, indent=1) + "\n")


def cost_of(run):
    used = run["cpu_seconds"]
    return f"{used:.0f} | {used / run['time']:.1f}" if used else "not measured | "


def changed(run):
    """Constants that differ from those of the case."""
    return f" ({', '.join(run['settings'])})" if run.get("settings") else ""


def judged(best, quantity, part, limit):
    """What the finest run shows of a target, in words: its error, and whether it is met."""
    if part == "cost":
        used = best["cpu_seconds"] / 3600
        return f"{used:.2g} core-hours | {limit} core-hours | {'met' if used <= limit else '**missed**'}"
    found, wanted = best["series"][quantity], REFERENCE[best["case"]][quantity]
    if found["state"] == "periodic" or found["state"] == "steady" and part == "mean":
        off = 100 * (found[part] / wanted[("mean", "amplitude", "frequency").index(part)] - 1)
        return f"{off:+.1f} % | {limit} % | {'met' if abs(off) <= limit else '**missed**'}"
    return f"{found['state']} | {limit} % | not shown"


def headline(kept):
    """The targets, and what the finest run of each case shows of them."""
    finest = {k["case"]: k for k in kept}  # sorted by resolution
    lines = ["| case | across | target | found | asked | |", "|---|---|---|---|---|---|"]
    for case, quantity, part, limit in TARGETS:
        if case in finest:
            best = finest[case]
            lines.append(f"| {case.upper()} | {best['across']}{changed(best)} | {quantity} {part} | "
                         f"{judged(best, quantity, part, limit)} |")
    missing = [c.upper() for c in REFERENCE if c not in finest]
    if missing:
        lines += ["", f"Not run yet: {', '.join(missing)}."]
    return lines


def report():
    kept = json.loads(KEPT.read_text())
    text = ["# The benchmark of Turek and Hron", "",
            "Written by `tools/turek_hron.py report` from `docs/turek_hron.json`. The first table holds the "
            "finest run of each case. Errors are those against the finest reference.", "",
            *headline(kept), "",
            (ROOT / "docs" / "turek_hron_notes.md").read_text().strip(), "",
            "## Every run", "",
            "| case | across | version | simulated s | end | particles (fluid, solid) | CPU s | "
            "CPU s a second | quantity | found | reference |",
            "|---|---|---|---|---|---|---|---|---|---|---|"]
    for run in kept:
        head = (f"| {run['case'].upper()} | {run['across']}{changed(run)} | {run['version']} | "
                f"{run['time']:.4g} | {run['exit']} | "
                f"{run['particles']['fluid']}, {run['particles']['solid']} | "
                f"{cost_of(run)} |")
        for quantity, wanted in REFERENCE[run["case"]].items():
            found = run["series"].get(quantity)
            if not found:
                continue
            reference = f"{wanted[0]:g}"
            if wanted[1]:
                reference += f" ± {wanted[1]:g}, {wanted[2]:g} Hz"
            text.append(f"{head} {quantity} | {show(quantity, found, wanted)} | {reference} |")
    text += ["", "## What others pay", "",
             "| program | error of the amplitude of uy, % | core-seconds of the run | source |",
             "|---|---|---|---|"]
    text += [f"| {n} | {e:+.1f} | {c:.0f} | {s} |" for n, e, c, s in OTHERS]
    text += ["", "SPHinXsys, `test_2d_fsi2`, 10 across, channel 1.1 m long without an outlet: 8 to 12 CPU "
             "seconds a second, uy 77 to 81 mm, 1.72 to 1.78 Hz (timed on two cores).", ""]
    PAGE.write_text("\n".join(text), encoding="utf-8")


def pictures(run):
    """Error of the amplitude of uy against core-seconds, from the kept runs; histories of a run."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    fig, ax = plt.subplots(figsize=(6, 3.6))
    for case, mark in (("fsi2", "o"), ("fsi3", "s")):
        wanted = REFERENCE[case]["uy"][1]
        own = [(k["cpu_seconds"], abs(100 * (k["series"]["uy"]["amplitude"] / wanted - 1)), k["across"])
               for k in json.loads(KEPT.read_text())
               if k["case"] == case and k["series"]["uy"]["state"] == "periodic" and k["cpu_seconds"]]
        other = [(cost, abs(off)) for name, off, cost, _ in OTHERS if name.endswith(case.upper())]
        ax.loglog(*zip(*other), mark, mfc="none", color="0.4", label=f"OpenFOAM, {case.upper()}")
        if own:
            ax.loglog([k[0] for k in own], [k[1] for k in own], mark, label=f"sphfsi, {case.upper()}")
            for cost, off, across in own:
                ax.annotate(f" D/dp = {across}", (cost, off))
    # Twenty seconds of FSI2, 77 to 81 mm beside 81.6 mm (timed on two cores).
    ax.loglog([200, 200], [0.7, 5.6], "-", color="tab:red", label="SPHinXsys, FSI2, 10 across")
    ax.set(xlabel="core-seconds", ylabel="error of the amplitude of uy, %")
    ax.legend(fontsize=7)
    fig.savefig(ROOT / "docs" / "img" / "turek_hron_cost.png", dpi=100, bbox_inches="tight")
    if not run:
        return
    times, series = columns(run)
    fig, axes = plt.subplots(len(series), 1, figsize=(7, 1.4 * len(series)), sharex=True)
    for axis, (name, values) in zip(axes, series.items()):
        axis.plot(times, values, lw=0.6)
        axis.set_ylabel(f"{name}, {UNIT[name]}")
    axes[-1].set_xlabel("time, s")
    name = Path(run).name.replace("-", "_")
    fig.savefig(ROOT / "docs" / "img" / f"turek_hron_{name}.png", dpi=80, bbox_inches="tight")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    sub = parser.add_subparsers(dest="command", required=True)
    run = sub.add_parser("run", help="run a case")
    run.add_argument("case", choices=sorted(REFERENCE))
    run.add_argument("--across", type=int, default=10)
    run.add_argument("--end", type=float, help="end at this time instead, s")
    run.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                     help="change a constant of the case; the report names it")
    run.add_argument("--threads", type=int, default=os.cpu_count())
    run.add_argument("--program", type=Path, default=ROOT / "sphfsi")
    for name in ("read", "keep"):
        sub.add_parser(name, help=f"{name} what runs show").add_argument("runs", nargs="+", type=Path)
    sub.add_parser("report", help="write docs/turek_hron.md")
    draw = sub.add_parser("pictures", help="draw error against cost, and the histories of a run")
    draw.add_argument("history", nargs="?", type=Path)
    args = parser.parse_args()
    if args.command == "run":
        return run_case(args)
    if args.command == "read":
        for folder in args.runs:
            print(json.dumps(read(folder), indent=2))
    elif args.command == "keep":
        keep(args.runs)
    elif args.command == "pictures":
        pictures(args.history)
    else:
        report()
    return 0


if __name__ == "__main__":
    sys.exit(main())
