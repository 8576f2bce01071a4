#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The benchmark of Turek and Hron (2006): runs its cases, reads drag, lift and the displacement of
A, finds out whether they rest, repeat themselves or do neither yet, and writes
docs/results/turek_hron.md.

examples:
  tools/report/turek_hron.py run fsi2 --across 10        runs the case into runs/turek_hron/fsi2-10
  tools/report/turek_hron.py keep runs/turek_hron/*      adds it to docs/results/turek_hron.json
  tools/report/turek_hron.py report                      writes docs/results/turek_hron.md from it
  tools/report/turek_hron.py picture                     draws docs/img/turek_hron_cost.png
"""
import json
import math
import os
from pathlib import Path

from common import (COLOURS, IMAGES, OUT, ROOT, Run, load, np, options, plt, run_tool, store, table,
                    write)
from palette import save
from runs import Job

CASES = ROOT / "cases" / "turek_hron"
KEPT = ROOT / "docs" / "results" / "turek_hron.json"
PAGE = OUT / "turek_hron.md"

# Mean, amplitude and frequency (Hz) in mm and N/m; amplitude and frequency None: steady. Turek and
# Hron (2006) for CSM, CFD and FSI1; the finest levels quoted by the verification pages of
# solids4foam for FSI2; Turek et al. (2010) for FSI3.
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
# Case, quantity, part of it, and the largest error in per cent of the finest run (cost:
# core-hours).
TARGETS = [
    ("cfd1", "drag", "mean", 2),
    ("cfd2", "drag", "mean", 2),
    ("cfd3", "drag", "mean", 3), ("cfd3", "lift", "amplitude", 10),
    ("cfd3", "lift", "frequency", 2),
    ("fsi1", "ux", "mean", 5), ("fsi1", "uy", "mean", 5), ("fsi1", "drag", "mean", 5),
    ("fsi1", "lift", "mean", 5),
    ("fsi2", "uy", "amplitude", 3), ("fsi2", "uy", "frequency", 2), ("fsi2", "run", "cost", 2),
    ("fsi3", "uy", "amplitude", 5), ("fsi3", "uy", "frequency", 2), ("fsi3", "run", "cost", 4),
]
# Settings beside the defaults, as a picture names them.
WORDS = {"numerics.sides=both": "both sides", "sound=40": "c0 = 40 m/s"}
PERIODS = 6      # at the end that mean and amplitude are taken of, at least
HARMONICS = 4    # that make up a period
# of the size of a period: its trend over half of the periods, and its standard error
SAME = 0.05
# of the mean of a series at rest: its trend over a quarter of the run, and its error
REST = 0.02
STARTS = ("ramp", "kick", "tilt")  # constants of the start of a run only
PARTS = 24       # of the last half of a run, whose means judge whether it rests
ALONE = 8        # parts without correlation that those of a series at rest stand for, at least


def columns(folder):
    """Times and the series of a run in mm and N/m."""
    probes, series = Run(folder).table("probes.csv"), {}
    if "A_dx_m" in probes:
        series["ux"], series["uy"] = 1e3 * probes["A_dx_m"], 1e3 * probes["A_dy_m"]
    if "cylinder_fx_N_per_m" in probes:
        for name, axis in (("drag", "x"), ("lift", "y")):
            series[name] = probes[f"cylinder_f{axis}_N_per_m"] + probes[f"bar_f{axis}_N_per_m"]
    return probes["time_s"], series


def fit(times, values, frequency):
    """Least squares of a mean and the harmonics of a frequency: coefficients and mean square
    left."""
    angle = 2 * np.pi * frequency * times[:, None] * np.arange(1, HARMONICS + 1)
    base = np.hstack([np.ones((len(times), 1)), np.cos(angle), np.sin(angle)])
    found, *_ = np.linalg.lstsq(base, values, rcond=None)
    return found, float(np.mean((base @ found - values) ** 2))


def frequency_of(times, values):
    """The frequency whose harmonics leave least of a series: near the highest line of its
    spectrum."""
    length, step = times[-1] - times[0], (times[-1] - times[0]) / (len(times) - 1)
    drift = np.polyval(np.polyfit(times, values, 1), times)
    lines = np.abs(np.fft.rfft((values - drift) * np.hanning(len(values)), 8 * len(values)))
    best, width = np.argmax(lines) / (8 * len(values) * step), 0.5 / length
    if best <= width or 4 * HARMONICS * best * step > 1:
        return None  # it does not swing, or is not sampled finely enough
    for _ in range(12):  # five trials, each time in half of the width
        trial = best + width * np.linspace(-1, 1, 5)
        best = trial[np.argmin([fit(times, values, f)[1] for f in trial])]
        width *= 0.5
    return best


def windows(times, frequency, count):
    """The last periods of a series, as slices of it."""
    edges = np.searchsorted(times, times[-1] - np.arange(count, -1, -1) / frequency)
    return [slice(a, b) for a, b in zip(edges[:-1], edges[1:])]


def settled(sizes, same):
    """Whether sizes of one sign show no trend: over half of them it is below a share of their mean,
    or over all of them not larger than twice the error that their scatter gives it. The standard
    error of their mean must not exceed that share either."""
    count, whole = len(sizes), abs(np.mean(sizes))
    order = np.arange(count) - 0.5 * (count - 1)
    slope = float(order @ sizes / (order @ order))
    scatter = math.sqrt(np.sum((sizes - np.mean(sizes) - slope * order) ** 2) / (count - 2))
    error = scatter / math.sqrt(order @ order)
    return (min(sizes) * max(sizes) > 0 and scatter / math.sqrt(count) <= same * whole
            and count * abs(slope) <= max(2 * same * whole, 2 * count * error))


def trendless(values):
    """Whether the slope of a few values is at most twice the error that their scatter gives it."""
    order = np.arange(len(values)) - 0.5 * (len(values) - 1)
    slope = float(order @ values / (order @ order))
    left = values - np.mean(values) - slope * order
    return abs(slope) <= 2 * math.sqrt(left @ left / (len(values) - 2) / (order @ order))


def swings(times, values):
    """Whether one frequency and its harmonics make up half of the variance or more."""
    frequency = frequency_of(times, values)
    return bool(frequency) and fit(times, values, frequency)[1] <= 0.5 * np.var(values)


def rest(times, late):
    """State of the last half of a run without a period, its mean and the standard error of the
    mean. It is steady within its noise if it does not swing and neither the means of its parts nor
    the scatter in them have a trend. The correlation of neighbouring parts makes them stand for
    fewer: ALONE at least."""
    pieces = np.array_split(late, min(PARTS, len(late)))
    parts, scatter = np.array([p.mean() for p in pieces]), np.array([p.std() for p in pieces])
    off, count = parts - parts.mean(), len(parts)
    alike = min(max(off[1:] @ off[:-1] / max(off @ off, 1e-300) + 1 / count, 0), 0.99)
    alone = count * (1 - alike) / (1 + alike)
    state = ("steady" if settled(parts, REST) else
             "steady within its noise" if alone >= ALONE and trendless(parts) and trendless(scatter)
             and not swings(times, late) else
             "neither steady nor periodic yet")
    return state, float(parts.mean()), float(np.std(parts, ddof=1) / math.sqrt(alone))


def sizes_of(times, values, frequency, count):
    """The first harmonic of each of the last periods, in phase with that of all of them together.
    So noise makes it neither larger nor smaller on average."""
    late = times >= times[-1] - count / frequency
    whole = first(fit(times[late], values[late], frequency)[0])
    own = [first(fit(times[s], values[s], frequency)[0]) for s in windows(times, frequency, count)]
    return np.array([(c * whole.conjugate()).real / abs(whole) for c in own])


def first(coefficients):
    """The first harmonic as a complex number."""
    return complex(coefficients[1], -coefficients[1 + HARMONICS])


def period(times, values):
    """Frequency and number of the periods at the end that repeat themselves, or none: as many as
    there are in the last half of the run, or fewer, but six at least."""
    late = times >= 0.5 * times[-1]
    frequency = frequency_of(times[late], values[late])
    if not frequency:
        return None
    count = max(PERIODS, int(0.5 * times[-1] * frequency))
    while count >= PERIODS:
        late = times >= times[-1] - count / frequency
        own = frequency_of(times[late], values[late])
        if own and (count + 1) / own <= times[-1] and settled(sizes_of(times, values, own, count),
                                                              SAME):
            return own, count
        count = count * 3 // 4
    return None


def middle_and_size(coefficients):
    """Middle and half the distance of the largest and least values of a mean with harmonics."""
    angle = np.linspace(0, 2 * np.pi, 361)[:, None] * np.arange(1, HARMONICS + 1)
    values = coefficients[0] + np.hstack([np.cos(angle), np.sin(angle)]) @ coefficients[1:]
    return 0.5 * (values.max() + values.min()), 0.5 * (values.max() - values.min())


def summary(times, values, found):
    """Mean, amplitude (of the largest and least values of the mean period), their standard errors
    and the frequency; without a period: the mean and the scatter of the last half."""
    if found:
        frequency, count = found
        own = np.array([fit(times[s], values[s], frequency)[0]
                        for s in windows(times, frequency, count)])
        middle, size = middle_and_size(own.mean(axis=0))
        # Jackknife: how the result moves as one period after the other is left out.
        left = np.array([middle_and_size(np.delete(own, k, axis=0).mean(axis=0))
                         for k in range(count)])
        errors = np.sqrt((count - 1) * left.var(axis=0))
        strongest = np.argmax(np.hypot(*own.mean(axis=0)[1:].reshape(2, HARMONICS))) + 1
        return {"state": "periodic", "mean": middle, "amplitude": size, "mean_error": errors[0],
                "amplitude_error": errors[1], "frequency": float(strongest * frequency),
                "periods": count}
    late = times >= 0.5 * times[-1]
    state, mean, off = rest(times[late], values[late])
    return {"state": state, "mean": mean, "amplitude": float(np.std(values[late])),
            "frequency": None,
            "mean_error": off}


def read(folder):
    folder = Path(folder)
    times, series = columns(folder)
    found = period(times, series["uy"] if "uy" in series else series["lift"])
    run, record = Run(folder).summary, load(folder.with_name(folder.name + ".json"), {})
    name, across = folder.name.split("-")[:2]
    return {"case": name, "across": int(across), "time": times[-1], "exit": run["exit_reason"],
            "particles": run["particles"], "steps": run["steps"], "version": run["version"],
            "cpu_seconds": record.get("cpu"),
            "settings": [s for s in record.get("sets", []) if not s.startswith(("across=",
                                                                                "end_time="))],
            "series": {k: summary(times, v, found) for k, v in series.items()}}


def error(found, wanted, scatter=None):
    """Of a value, in per cent of the one wanted, with the standard error of the value."""
    if not wanted:
        return ""
    share = 100 * abs((scatter or 0) / wanted)
    known = f" ± {share:.1f}" if share >= 0.05 else ""
    return f" ({100 * (found / wanted - 1):+.1f}{known} %)"


def show(quantity, found, wanted):
    text = f"{found['mean']:.4g}{error(found['mean'], wanted[0], found.get('mean_error'))}"
    if found["state"] == "periodic":
        size = error(found["amplitude"], wanted[1], found.get("amplitude_error"))
        text += f" ± {found['amplitude']:.4g}{size} {UNIT[quantity]}, {found['frequency']:.4g} Hz"
        if wanted[2]:
            own = found["frequency"] * round(wanted[2] / found["frequency"])
            text += error(own, wanted[2]) if own else ""
    else:
        text += f" {UNIT[quantity]}, scatter {found['amplitude']:.3g}, {found['state']}"
    return text


def run_case(args):
    name = "-".join([args.case, str(args.across), *constants({"settings": args.set})])
    job = Job(ROOT / "runs" / "turek_hron" / name.replace(" ", "_"),
              CASES / f"{args.case}.cfg", [f"across={args.across}", *args.set,
                                           *([f"end_time={args.end}"] if args.end else [])])
    record = job.run(threads=args.threads)
    # What was computed before an interruption is not known.
    job.store({**record, "sets": job.sets,
               "cpu": None if record.get("resumed") else record["timing"]["cpu"]})
    print(json.dumps(read(job.folder), indent=2))
    return record["outcome"] != "finished"


def keep(folders):
    kept = load(KEPT, [])

    def place(run):
        return run["case"], run["across"], constants(run)

    for new in map(read, folders):
        kept = [k for k in kept if place(k) != place(new)] + [new]
    store(KEPT, sorted(kept, key=lambda k: (k["case"], len(constants(k)), k["across"])))


def constants(run):
    """Those that differ from the case's and do not only make the start shorter."""
    return sorted(s for s in run.get("settings", []) if s.split("=")[0] not in STARTS)


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
        word = "met" if used <= limit else "**missed**"
        return f"{used:.2g} core-hours | {limit} core-hours | {word}"
    found, wanted = best["series"][quantity], REFERENCE[best["case"]][quantity]
    if found["state"] == "periodic" or found["state"].startswith("steady") and part == "mean":
        size = wanted[("mean", "amplitude", "frequency").index(part)]
        off, known = 100 * (found[part] / size - 1), 200 * abs(found.get(f"{part}_error", 0) / size)
        word = ("met" if abs(off) + known <= limit else "**missed**" if abs(off) - known > limit
                else "undecided: noise")
        return f"{off:+.1f}{f' ± {0.5 * known:.1f}' if known else ''} % | {limit} % | {word}"
    return f"{found['state']} | {limit} % | not shown"


def headline(kept):
    """The targets, and what the finest run of each case shows of them, with each set of its
    constants."""
    finest = {(k["case"], *constants(k)): k for k in kept}  # sorted by resolution
    lines = ["| case | across | target | found | asked | |", "|---|---|---|---|---|---|"]
    for of_case in dict.fromkeys(t[0] for t in TARGETS):
        for best in (k for k in finest.values() if k["case"] == of_case):
            lines += [f"| {of_case.upper()} | {best['across']}{changed(best)} | {quantity} {part} "
                      f"| {judged(best, quantity, part, limit)} |"
                      for case, quantity, part, limit in TARGETS if case == of_case]
    missing = [c.upper() for c in REFERENCE if c not in {k[0] for k in finest}]
    return lines + (["", f"Not run yet: {', '.join(missing)}."] if missing else [])


def rows_of(run):
    """A row for each quantity of a run."""
    particles = run["particles"]
    for quantity, wanted in REFERENCE[run["case"]].items():
        found = run["series"].get(quantity)
        if found:
            reference = f"{wanted[0]:g}" + (f" ± {wanted[1]:g}, {wanted[2]:g} Hz" if wanted[1]
                                            else "")
            yield (run["case"].upper(), f"{run['across']}{changed(run)}", run["version"],
                   f"{run['time']:.4g}", run["exit"],
                   f"{particles['fluid']}, {particles['solid']}", cost_of(run), quantity,
                   show(quantity, found, wanted), reference)


def report():
    kept = load(KEPT)
    head = ["case", "across", "version", "simulated s", "end", "particles (fluid, solid)",
            "CPU s | CPU s a second", "quantity", "found", "reference"]
    write(PAGE, "turek_hron.md", headline="\n".join(headline(kept)),
          runs=table(head, (row for run in kept for row in rows_of(run))).replace(
              "|---|\n", "|---|---|\n", 1),
          others="\n".join(f"| {n} | {e:+.1f} | {c:.0f} | {s} |" for n, e, c, s in OTHERS))


def picture():
    """Error of the amplitude of uy against core-seconds, from the kept runs."""
    fig, ax = plt.subplots(figsize=(6, 3.6))
    for case, mark in (("fsi2", "o"), ("fsi3", "s")):
        wanted = REFERENCE[case]["uy"][1]
        own = [(k["cpu_seconds"], abs(100 * (k["series"]["uy"]["amplitude"] / wanted - 1)),
                f"{k['across']} across" +
                "".join(f",\n{WORDS.get(c, c)}" for c in constants(k)))
               for k in load(KEPT)
               if k["case"] == case and k["series"]["uy"]["state"] == "periodic" and
               k["cpu_seconds"]]
        other = [(cost, abs(off)) for name, off, cost, _ in OTHERS if name.endswith(case.upper())]
        ax.loglog(*zip(*other), mark, mfc="none", color="0.4")
        ax.annotate("OpenFOAM", max(other), ha="center", va="bottom", xytext=(0, 5),
                    textcoords="offset points", fontsize=9, color="0.4")
        colour = COLOURS[0 if case == "fsi2" else 1]
        for cost, off, name in own:
            ax.loglog(cost, off, mark, color=colour)
            left = cost < 200  # the range of SPHinXsys is to the right
            ax.annotate(name, (cost, off), fontsize=9, color=colour, textcoords="offset points",
                        xytext=(-7 if left else 7, -3 if "," in name else 6), va="top",
                        ha="right" if left else "left")
    # Twenty seconds of FSI2, 77 to 81 mm beside 81.6 mm (timed on two cores).
    ax.loglog([200, 200], [0.7, 5.6], "-", color="0.4")
    ax.annotate("SPHinXsys, FSI2,\n10 across", (200, 1), fontsize=9, color="0.4",
                xytext=(-5, 0), textcoords="offset points", ha="right")
    ax.set(xlabel="CPU time of all cores (s)", ylabel="error of the tip's amplitude, uy (%)",
           xlim=(1, 1e8), ylim=(0.3, 25))
    ax.set_yticks([0.5, 1, 2, 5, 10, 20], ["0.5", "1", "2", "5", "10", "20"])
    ax.minorticks_off()
    ax.set_title("Flag behind a cylinder. Circles: FSI2; squares: FSI3", fontsize=10, loc="left")
    save(fig, IMAGES / "turek_hron_cost.png", dpi=150, bbox_inches="tight")


def main():
    parser = options(__doc__)
    sub = parser.add_subparsers(dest="command")
    run = sub.add_parser("run", help="run a case")
    run.add_argument("case", choices=sorted(REFERENCE))
    run.add_argument("--across", type=int, default=10)
    run.add_argument("--end", type=float, help="end at this time instead, s")
    run.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                     help="change a constant of the case; the report names it")
    run.add_argument("--threads", type=int, default=os.cpu_count())
    sub.add_parser("keep", help="keep what runs show").add_argument("runs", nargs="+", type=Path)
    sub.add_parser("report", help="write docs/results/turek_hron.md")
    sub.add_parser("picture", help="draw error against cost")
    args = parser.parse_args()
    if args.command == "run":
        return run_case(args)
    if args.command == "keep":
        keep(args.runs)
    elif args.command == "picture":
        picture()
    else:
        report()
    return 0


if __name__ == "__main__":
    run_tool(main)
