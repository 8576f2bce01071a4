#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the article's five cases and writes docs/results/validation.md.

What is measured on a run is kept in docs/results/validation.json. It counts, whatever the version
of the program, until the text of its case or its settings change. An interrupted run goes on from
its checkpoint. All resolutions take many hours; QUICK=1 runs the coarsest of each case. Examples:

  tools/report/validation.py --only gate,=plate       runs whose names begin so, and this one alone
  tools/report/validation.py --again --jobs 2         all once more, two at a time
  tools/report/validation.py --no-run                 the report from what is kept
"""
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import metrics
import validation_measures as of
from common import (IMAGES, OUT, QUICK, ROOT, BadFile, Reference, Run, last_line, load, machine,
                    np, options, run_tool, store_rows, table, words_of)
from palette import shrink
from runs import Job, definition_hash
from sphfsi.draw_probes import peak

RESULTS = OUT / "validation.json"
REPORT = OUT / "validation.md"
FOLDER = ROOT / "runs" / "validation"
TABLE = Path(__file__).with_name("validation_runs.txt")
REFERENCES = ROOT / "cases" / "reference"
PERIOD, AMPLITUDE = 0.25515, 0.02302   # cantilever: linear 2-D elasticity, converged FE
DRY = 269.0                            # Hz: plate without water, first mode, FE
MISSED = "**missed**"
paragraph = words_of("validation_words.md")


def jobs_of(text):
    """The runs of the table; its head explains the format."""
    named, jobs = {}, []
    for line in text.replace("\\\n", "").splitlines():
        if line.startswith("@"):
            name, words = line.split(" = ", 1)
            named[name] = words
        elif "|" in line and not line.startswith("#"):
            line = re.sub(r"@\w+", lambda hit: named[hit[0]], line)
            lists = [found.split(",") for found in re.findall(r"\{([^}]+)\}", line)] or [[""]]
            for k, first in enumerate(lists[0]):
                own = iter([entries[k] for entries in lists])
                one = re.sub(r"\{(.*?)\}", lambda hit: next(own) if hit[1] else first.strip("*"),
                             line)
                name, case, sets, words = (part.strip() for part in one.split("|"))
                jobs.append(Job(FOLDER / name.replace("*", ""), ROOT / "cases" / f"{case}.cfg",
                                re.split(r"; *", sets), words, "*" in name))
    return jobs


JOBS = jobs_of(TABLE.read_text(encoding="utf-8"))
WORDS = {job.name: job.words for job in JOBS}


def chosen(only):
    """The runs to do, in order."""
    jobs, found = [job for job in JOBS if job.quick or not QUICK], {}
    for name in only.split(","):
        wanted = [job for job in jobs if (job.name == name[1:] if name.startswith("=")
                                          else job.name.startswith(name))]
        if not wanted:
            raise BadFile(f"--only {name}: no run of the selection has this name; {TABLE.name} has "
                          "the names")
        found.update(dict.fromkeys(wanted))
    return list(found)


# --- what is kept of a run ---
def reference(name):
    return Reference("", REFERENCES / f"{name}.csv", name, name)


def series(run, column, since=-1.0):
    """Time and a column of probes.csv from an instant on."""
    found = run.table("probes.csv")
    if column not in found:
        raise BadFile(f"{run.folder / 'probes.csv'}: no column {column}")
    time, value = found["time_s"], found[column]
    return time[time >= since], value[time >= since]


def rms_against(run, column, name):
    """Against a reference, over its times, m."""
    (time, value), ref = series(run, column), reference(name)
    inside = (ref.time >= time[0]) & (ref.time <= time[-1])
    if not inside.any():
        raise BadFile(f"{ref.path}: no time in common with the run")
    return float(np.sqrt(np.mean((np.interp(ref.time[inside], time, value) -
                                  ref.value[inside]) ** 2)))


def cantilever_figures(run):
    return metrics.oscillation(*series(run, "M1_dy_m"), PERIOD) | {
        f"rms_{name}": rms_against(run, "M1_dy_m", f"cantilever_{name}")
        for name in ("elasticity", "thin_plate")}


def plate_figures(run):
    """After 0.5 s the mean, its standard deviation, half range and fast part; the first swing."""
    time, dy = series(run, "M1_dy_m")
    late = dy[time >= 0.5]
    fast = late[12:-12] - metrics.running_mean(late, 25)  # faster than 5 ms
    early, top = (time > 0.002) & (time < 0.022), peak(time, dy, -1.0)
    return {"mean": late.mean(), "std": late.std(), "half": 0.5 * np.ptp(late), "fast": fast.std(),
            "peak": top[1], "peak_at": top[0],
            "frequency": metrics.strongest(time[early], dy[early])}


def gate_figures(run):
    time, dx = series(run, "M1_dx_m")
    k = int(np.argmax(dx))
    return {"peak": dx[k], "at": time[k], "late": np.interp(0.36, time, dx),
            "rms_x": rms_against(run, "M1_dx_m", "gate_antoci_2007_x"),
            "rms_y": rms_against(run, "M1_dy_m", "gate_antoci_2007_y"), **of.interface(run)}


def movement(run, since):
    """First contact (M1 has moved by 0.2 mm), the largest displacement and its time; after an
    instant the mean and its deviation, and frequency and RMS about the mean over 0.2 s."""
    time, dx = series(run, "M1_dx_m")
    moved, k = np.flatnonzero(np.abs(dx) > 2e-4), int(np.argmax(np.abs(dx)))
    if not len(moved):
        raise BadFile(f"{run.folder}: M1 never moves by 0.2 mm")
    fast_time, fast = metrics.about_running_mean(time, dx, 0.2)
    late = fast_time > since
    return {"contact": time[moved[0]], "largest": dx[k], "at": time[k],
            "mean": dx[time > since].mean(), "std": dx[time > since].std(),
            "frequency": metrics.mean_frequency(fast_time[late], fast[late]),
            "rms": fast[late].std()}


FIGURES = {"cantilever": cantilever_figures, "plate": plate_figures, "gate": gate_figures,
           "baffle": lambda run: movement(run, 0.7) | of.bore(run) | of.interface(run),
           "sluice": lambda run: movement(run, 1.0) | of.front_speed(run) | of.interface(run)}


def kept_of(job, record, run):
    """What is kept of a run that has ended."""
    found = {"name": job.name, "definition": definition_hash(job), "version": record["version"],
             "outcome": record["outcome"], "message": record["message"],
             "time": run.summary["time"]}
    if record["outcome"] != "finished":
        return found
    figures = FIGURES[job.name.split("-")[0]](run) | of.balance(run)
    return found | {key: run.summary[key] for key in ("steps", "solid_substeps", "wall_seconds",
                                                      "threads")} | \
        {key: value if isinstance(value, int) else float(f"{value:.6g}")
         for key, value in figures.items()}


def run_job(job):
    """None: it could not be run or measured, which is said."""
    try:
        record = job.run(lambda text: print(text, flush=True))
        if record["outcome"] not in ("finished", "unstable"):
            raise BadFile(record["message"])
        return kept_of(job, record, Run(job.folder))
    except BadFile as problem:
        print(f"validate: {job.name}: {problem}", file=sys.stderr)
        return None


# --- the report ---
class Report:
    """What is kept of runs by their names, and the rows of the table of targets."""

    def __init__(self, known):
        self.known, self.targets = known, []

    def finished(self, name):
        return self.known.get(name, {}).get("outcome") == "finished"

    def target(self, case, words, names, judge):
        """A row for the first of the runs that has finished; judge(its figures) gives (text,
        whether it is met)."""
        name = next((name for name in names if self.finished(name)), None)
        found, met = judge(self.known[name]) if name else (f"{names[0]} has not finished", None)
        self.targets.append((case, words, found,
                             "not judged" if met is None else "met" if met else MISSED))

    def table(self, head, prefix, cells):
        """A row for each run whose name begins with the prefix; why there is nothing where it did
        not finish."""
        rows = []
        for job in JOBS:
            found = self.known.get(job.name)
            if found and job.name.startswith(prefix):
                row = cells(found) if self.finished(job.name) else \
                    [f"*stopped at t = {found['time']:.3g} s: {found['message']}*"]
                rows.append([job.words, *row, *[""] * (len(head) - len(row))])
        return [table(["run", *head], rows) if rows else "*Not run.*", ""]

    def appendix(self, prefix, interface=True):
        """Interface and ledger of the runs of a case."""
        def touch(found):
            return [f"{found['closest']:.2f}", f"{found['median']:.2f}",
                    f"{100 * found['gaps']:.1f}",
                    f"{found['pressed_bodies']}, {found['pressed_walls']}",
                    f"{100 * found['pressed_share']:.0f}"]

        def ledger(found):
            return [f"{found['play']:.4g}", f"{found['lost']:.4g}",
                    f"{found['gain']:.2g} ({100 * found['gain'] / found['play']:.2g} %)",
                    f"{found['momentum_x']:.3g}, {found['momentum_y']:.3g}",
                    f"{found['mass']:+.1g}", f"{100 * found['density']:.2g} %"]
        lines = ["### Interface", "", paragraph("interface"), "", *self.table(
            ["closest", "median, wetted surface", "surface with a gap (%)",
             "pressed into bodies, walls", "snapshots with any (%)"],
            prefix, touch)] if interface else []
        return [*lines, "### Ledger", "", *self.table(
            ["available energy (J/m)", "dissipated", "largest spurious gain",
             "momentum x, y at the end (N s/m)", "mass", "density"], prefix, ledger)]


def picture(tool, names, image, caption, *options):
    """A figure of runs whose folders are there; else the one that was drawn when they were."""
    path = IMAGES / f"validation-{image}.png"
    folders = [FOLDER / name for name in names
               if (FOLDER / name / "fields.vtkhdf").is_file()]
    if len(folders) == len(names):
        words = [f"--name={WORDS[name]}" for name in names if tool != "plot_ledger"]
        done = subprocess.run([sys.executable, str(ROOT / "tools" / f"{tool}.py"),
                               *map(str, folders), "--out", str(path), *words,
                               *map(str, options)],
                              capture_output=True, text=True, check=False)
        if done.returncode:
            raise BadFile(f"{path.name}: {last_line(done)}")
        shrink(path)
    shown = os.path.relpath(path, OUT)
    return [f"![{caption}]({shown})", "", f"*{caption}*", ""] if path.is_file() else []


def cost(found):
    return [f"{found['steps']:,}", f"{found['solid_substeps']:,}",
            f"{found['wall_seconds']:.0f} ({found['threads']})"]


COST = ["fluid steps", "solid steps", "s (threads)"]


def percent(value, wanted, digits=2):
    return f"{100 * (value / wanted - 1):+.{digits}f}"


def cantilever(report):
    def cells(found):
        return [f"{found['first']:.4f}", percent(found["first"], PERIOD),
                percent(found["mean"], PERIOD), f"{found['drift']:+.1f}",
                f"{1e3 * found['amplitude']:.2f}", f"{100 * found['loss']:.2f}",
                f"{1e3 * found['rms_elasticity']:.2f}", f"{1e3 * found['rms_thin_plate']:.2f}",
                *cost(found)[1:]]

    def table_one(ratio, kappa):
        """Errors of the paper's Table 1."""
        name = f"cantilever-{ratio}" + ("" if kappa == 50 else f"-kappa{kappa}")
        found = report.known.get(name)
        return "*not run*" if name in WORDS and not found else "" if not found else (
            f"{1e3 * found['rms_thin_plate']:.2f} / {1e3 * found['rms_elasticity']:.2f} "
            f"({percent(found['mean'], PERIOD)} %)")
    for ratio, limit in ((20, 1.0), (40, 0.5), (80, 0.25)):
        report.target("cantilever", f"period within {limit:g} % of {PERIOD} s at ts/dp = {ratio}",
                      [f"cantilever-{ratio}"],
                      lambda found, limit=limit: (percent(found["mean"], PERIOD) + " %", abs(
                          found["mean"] / PERIOD - 1) <= limit / 100))
    report.target("cantilever", "amplitude loss at most 1 % a second",
                  ["cantilever-80", "cantilever-40", "cantilever-20"],
                  lambda found: (f"{100 * found['loss']:.2f} % ({WORDS[found['name']]})",
                                 found["loss"] <= 0.01))
    kappas, printed = (0, 1, 10, 50), {20: "3.76", 40: "1.71", 80: "1.68"}
    return [
        paragraph("cantilever", period=PERIOD, amplitude=1e3 * AMPLITUDE), "",
        *report.table(["period (s)", "error (%)", "mean period, error (%)",
                       "phase at the end (deg)", "amplitude (mm)", "loss (%/s)",
                       "RMSE, elasticity (mm)", "RMSE, thin plate (mm)", *COST[1:]], "cantilever",
                      cells),
        "### Table 1 of the paper", "", paragraph("table one"), "",
        table(["ts/dp", "paper", *(f"kappa = {k}" for k in kappas)],
              [[ratio, printed.get(ratio, ""), *(table_one(ratio, k) for k in kappas)]
               for ratio in (10, 20, 40, 80)]), "",
        *picture("plot_m1", ["cantilever-20", "cantilever-20-symplectic", "cantilever-40",
                             "cantilever-80"], "cantilever-m1",
                 "Deflection of the free end, and its difference from the references"),
        *picture("plot_fields", ["cantilever-20", "cantilever-20-symplectic"], "cantilever-fields",
                 "Von Mises stress at 0.57 s and 0.70 s, Verlet and symplectic (ts/dp = 20)",
                 "--time", 0.57, 0.7, "--window", -0.01, 0.21, -0.04, 0.055),
        *report.appendix("cantilever", interface=False)]


def deflections():
    """By two-dimensional elasticity and by the thin plate, with the plate's own weight, m."""
    return [float(reference(f"hydrostatic_plate_{name}").value[-1])
            for name in ("elasticity", "thin_plate")]


def plate_targets(report, exact):
    def steady(what):
        return lambda found: (f"{-100 * found[what] / found['mean']:.2f} %",
                              -found[what] / found["mean"] < 0.02)

    def closer(found):
        coarse = next((report.known[name] for name in ("plate-leapfrog", "plate-verlet")
                       if report.finished(name)), found)
        return (f"{percent(found['mean'], exact)} %",
                abs(found["mean"] / exact - 1) < abs(coarse["mean"] / exact - 1))
    case, words, fine = "hydrostatic plate", "fluctuation after 0.5 s below 2 %", \
        ["plate-3.125mm-leapfrog"]
    for name, side in (("plate", "symplectic"), ("plate-verlet", "Verlet")):
        report.target(case, f"settled deflection within 4 % of 2-D elasticity, {side}", [name],
                      lambda found: (f"{percent(found['mean'], exact)} %",
                                     abs(found["mean"] / exact - 1) <= 0.04))
        for what, measure in (("std", "standard deviation"), ("half", "half of the range")):
            report.target(case, f"{words} ({measure}), {side}", [name], steady(what))
    report.target(case, "deflection closer to 2-D elasticity at half the spacing", fine, closer)
    report.target(case, f"{words} (standard deviation), half the spacing", fine, steady("std"))


def both_integrators(report):
    if not (report.finished("plate") and report.finished("plate-verlet")):
        return []
    a, b = report.known["plate"], report.known["plate-verlet"]
    ratio = b["fast"] / a["fast"]
    verdict = ("Verlet's is the larger, as the paper says" if ratio > 1.2 else
               "the paper's claim that symplectic is steadier is not confirmed here" if ratio > 0.8
               else "symplectic's is the larger, against the paper's claim")
    return [paragraph("both integrators", mean=100 * abs(b["mean"] / a["mean"] - 1),
                      std=-100 * a["std"] / a["mean"], std_2=-100 * b["std"] / b["mean"],
                      fast=-100 * a["fast"] / a["mean"], fast_2=-100 * b["fast"] / b["mean"],
                      verdict=verdict), ""]


def plate(report):
    exact, thin = deflections()
    plate_targets(report, exact)

    def cells(found):
        return [f"{1e5 * found['mean']:.3f}", percent(found["mean"], exact),
                percent(found["mean"], thin), f"{-100 * found['std'] / found['mean']:.2f}",
                f"{-100 * found['half'] / found['mean']:.2f}",
                f"{-100 * found['fast'] / found['mean']:.4f}",
                f"{1e5 * found['peak']:.2f} at {1e3 * found['peak_at']:.1f}",
                f"{found['frequency']:.0f}", *cost(found)]
    return [
        paragraph("plate", exact=1e5 * exact, thin=1e5 * thin, dry=DRY), "",
        *report.table(["deflection (1e-5 m)", "from elasticity (%)", "from thin plate (%)",
                       "standard deviation (%)", "half range (%)", "faster than 5 ms (%)",
                       "first peak (1e-5 m, ms)", "first frequency (Hz)", *COST], "plate", cells),
        *both_integrators(report),
        *picture("plot_m1", ["plate", "plate-verlet", "plate-h1.5", "plate-leapfrog"], "plate-m1",
                 "Mid-span deflection from 0.03 s on", "--from", 0.03),
        *picture("plot_fields", ["plate-verlet", "plate"], "plate-fields",
                 "Pressure and stress at 0.3 s, Verlet and symplectic (dp = 6.25 mm)", "--time",
                 0.3),
        paragraph("plate 2"), "", paragraph("plate 3"), "",
        *report.appendix("plate", interface=False)]


def dry_targets(report, case, *names):
    """No water inside bodies or walls, for the runs at the paper's spacing."""
    for name in names:
        report.target(case, f"no water pressed into bodies or walls, {WORDS[name]}", [name],
                      lambda found: (f"{found['pressed_bodies']} in bodies, "
                                     f"{found['pressed_walls']} in walls, "
                                     f"{100 * found['pressed_share']:.0f} % of the snapshots",
                                     found["pressed_share"] == 0))


def gate(report):
    top = reference("gate_antoci_2007_x").value.max()

    def cells(found):
        return [f"{1e3 * found['peak']:.1f}", f"{found['at']:.3f}", f"{1e3 * found['late']:.1f}",
                f"{1e3 * found['rms_x']:.1f}", f"{1e3 * found['rms_y']:.1f}", *cost(found)]
    for name in ("gate", "gate-verlet", "gate-leapfrog", "gate-0.25mm-leapfrog"):
        report.target("gate", "RMS against the measured horizontal curve at most 3.5 mm, " +
                      WORDS[name], [name],
                      lambda found: (f"{1e3 * found['rms_x']:.1f} mm", found["rms_x"] <= 3.5e-3))
        report.target("gate", f"peak within 3 mm of the measured one, {WORDS[name]}", [name],
                      lambda found: (f"{1e3 * (top - found['peak']):.1f} mm short",
                                     abs(top - found["peak"]) <= 3e-3))
    dry_targets(report, "gate", "gate", "gate-verlet", "gate-leapfrog")
    return [
        paragraph("gate", top=1e3 * top), "",
        *report.table(["peak (mm)", "at (s)", "at 0.36 s (mm)", "RMS x (mm)", "RMS y (mm)", *COST],
                      "gate", cells),
        paragraph("gate 2"), "", paragraph("gate reading"), "",
        *picture("plot_m1", ["gate", "gate-verlet", "gate-leapfrog", "gate-1mm-plane-stress"],
                 "gate-m1", "Displacement of the free end, and its difference from the measured "
                            "one"),
        *picture("plot_fields", ["gate-verlet", "gate"], "gate-fields",
                 "Pressure and von Mises stress, Verlet (left) and symplectic", "--time", 0.08,
                 0.16, 0.24, 0.36, "--window", -0.01, 0.35, -0.01, 0.165),
        *picture("plot_ledger", ["gate"], "gate-ledger",
                 "Energy, momentum, extremes and time step of the gate"),
        *report.appendix("gate")]


def in_air(length, young):
    """First frequency (Hz) of the baffle or the gate without water, as their cases say."""
    return metrics.beam_frequency(young, 0.4, 1250, 0.007, length)


def baffle(report):
    depth, speed = metrics.wet_bed_bore(0.15, 0.03)

    def cells(found):
        return [f"{1e3 * found['depth']:.1f} ({percent(found['depth'], depth, 0)} %)",
                f"{found['speed']:.2f} ({percent(found['speed'], speed, 0)} %)",
                f"{found['contact']:.3f}", f"{1e3 * found['largest']:.1f}", f"{found['at']:.3f}",
                f"{found['frequency']:.1f}", f"{1e3 * found['rms']:.2f}",
                f"{1e3 * found['mean']:.1f}", *cost(found)]
    dry_targets(report, "wet baffle", "baffle", "baffle-verlet", "baffle-leapfrog")
    return [
        paragraph("baffle", depth=1e3 * depth, speed=speed, in_air=in_air(0.08, 5.7e6),
                  in_air_2=in_air(0.064, 5.7e6), about_mean=paragraph("about mean")), "",
        *report.table(["bore depth (mm)", "bore speed (m/s)", "first contact (s)",
                       "largest M1 (mm)", "at (s)", "frequency after 0.7 s (Hz)", "RMS (mm)",
                       "mean after 0.7 s (mm)", *COST], "baffle", cells),
        *picture("plot_m1", ["baffle-verlet", "baffle", "baffle-leapfrog", "baffle-2mm-leapfrog"],
                 "baffle-m1", "Horizontal displacement of the tip", "--column", "M1_dx_m"),
        *picture("plot_m1", ["baffle-2mm-leapfrog", "baffle-2mm-embedded", "baffle-2mm-slow",
                             "baffle-2mm-fast"], "baffle-sensitivity",
                 "What the assumptions do: free length, speed of the plate", "--column",
                 "M1_dx_m"),
        *picture("plot_fields", ["baffle-verlet", "baffle"], "baffle-fields",
                 "Pressure and von Mises stress, dp = 1 mm, Verlet (left) and symplectic", "--time",
                 0.3, 0.4, 0.6, 1.0, "--window", 0.6, 1.1, -0.01, 0.24),
        *report.appendix("baffle")]


def sluice(report):
    ritter = 2 * np.sqrt(9.81 * 0.2)

    def cells(found):
        return [f"{found['speed']:.2f} ({100 * found['speed'] / ritter:.0f} %)",
                f"{found['contact']:.3f}", f"{1e3 * found['largest']:.1f}", f"{found['at']:.3f}",
                f"{1e3 * found['mean']:.1f}", f"{1e3 * found['std']:.2f}",
                f"{found['frequency']:.1f}", f"{1e3 * found['rms']:.2f}", *cost(found)]
    dry_targets(report, "sluice gate", "sluice", "sluice-verlet", "sluice-leapfrog")
    both, window = ["sluice-verlet", "sluice"], ("--window", 0.55, 1.15, -0.01, 0.24)
    return [
        paragraph("sluice", ritter=ritter, in_air=in_air(0.125, 4e6),
                  about_mean=paragraph("about mean")), "",
        *report.table(["front (m/s, of Ritter's)", "first contact (s)", "largest M1 (mm)", "at (s)",
                       "mean after 1 s (mm)", "deviation after 1 s (mm)",
                       "frequency after 1 s (Hz)", "RMS (mm)", *COST], "sluice", cells),
        *picture("plot_m1", [*both, "sluice-leapfrog", "sluice-2mm-leapfrog"], "sluice-m1",
                 "Horizontal displacement of the gate's lower end", "--column", "M1_dx_m"),
        *picture("plot_m1", ["sluice-2mm-leapfrog", "sluice-2mm-opening10", "sluice-2mm-opening40",
                             "sluice-2mm-slow", "sluice-2mm-viscous"], "sluice-sensitivity",
                 "What the assumptions do: opening, speed of the plate; and what alpha does",
                 "--column", "M1_dx_m"),
        *picture("plot_fields", both, "sluice-fields",
                 "Pressure and von Mises stress, dp = 1 mm, Verlet (left) and symplectic", "--time",
                 0.3, 0.5, 1.0, 1.5, *window),
        *picture("plot_fields", both, "sluice-vorticity",
                 "Vorticity after 1 s, dp = 1 mm, Verlet (left) and symplectic", "--time", 1.1, 1.3,
                 1.5, 1.7, "--field", "vorticity", *window),
        *report.appendix("sluice")]


SECTIONS = {"3.1 Free oscillation of a cantilever": cantilever,
            "3.2 Hydrostatic water column on an elastic plate": plate,
            "3.3 Dam-break wave and elastic gate": gate,
            "3.4 Dam break in a wet bed and an elastic baffle": baffle,
            "3.5 Dam break and an elastic sluice gate": sluice}


def reason(case, words):
    """Where the difference of a missed target comes from: rows `case | part of the target | why`
    of the words, the first that fits."""
    rows = (row.split(" | ") for row in paragraph("reasons").splitlines())
    return next(text for name, part, text in rows
                if case.startswith(name) and (part == "any" or part in words))


def write_report(known):
    report = Report(known)
    body = [line for title, section in SECTIONS.items()
            for line in (f"## {title}", "", *section(report))]
    met, missed = ([row for row in report.targets if row[3] == word] for word in ("met", MISSED))
    rest = [row for row in report.targets if row not in met + missed]
    head = ["case", "target", "found", ""]
    versions = {}
    for found in known.values():
        versions.setdefault(found["version"], []).append(found["name"])
    lines = [
        "# Validation: the article's five cases", "",
        paragraph("head", met=len(met), all=len(report.targets), machine=machine()), "",
        "## Targets", "", table(head, met), "",
        table([*head, "where the difference comes from"],
              [[*row, reason(row[0], row[1])] for row in missed]), "",
        *([table(head, rest), ""] if rest else []), *body, "## What was run", "",
        *(f"* {version} ({len(names)}): {', '.join(names)}" for version, names in versions.items()),
        f"* not run: {', '.join(job.name for job in JOBS if job.name not in known) or 'none'}"]
    REPORT.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")
    print(f"written {os.path.relpath(REPORT, ROOT)}")


def read_kept():
    """What is kept of runs as they are defined now."""
    kept = {row["name"]: row for row in load(RESULTS, {"runs": []})["runs"]}
    return {job.name: kept[job.name] for job in JOBS if job.name in kept and
            kept[job.name]["definition"] == definition_hash(job)}


def main():
    parser = options(__doc__)
    parser.add_argument("--only", default="", metavar="NAME,...", help="only runs whose names "
                        "begin with one of these, in this order; =NAME means that run alone")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1,
                        help="runs at a time, a thread each (default: %(default)s)")
    parser.add_argument("--again", action="store_true", help="run also what is kept")
    parser.add_argument("--no-run", action="store_true", help="only write the report")
    args = parser.parse_args()
    known = read_kept()
    missing = [] if args.no_run else [job for job in chosen(args.only)
                                      if args.again or job.name not in known]
    with ThreadPoolExecutor(max(1, args.jobs)) as pool:
        for found in pool.map(run_job, missing):
            if found:
                known[found["name"]] = found
                store_rows(RESULTS, {"machine": machine()}, "runs", [
                    known[job.name] for job in JOBS if job.name in known])
    write_report(known)
    return any(job.name not in known for job in missing)


if __name__ == "__main__":
    run_tool(main)
