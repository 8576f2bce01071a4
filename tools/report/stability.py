#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the hard cases of tests/stability/suite.toml and says which pass.

  tools/report/stability.py --quick     coarse and short; exit status 1 if a scene deviates from the
  table
  tools/report/stability.py --report    the long form; writes docs/stability.md (make stability)

Names that a criterion can use:
  finished      the run reached its end; otherwise a guard stopped it
  gain          the largest spurious energy over the largest kinetic plus strain energy
  drift         the same, gained or lost, over the kinetic plus strain energy at the start
  resting       mean kinetic energy of the last fifth over the largest of the first
  dens, lowest_density   largest |rho/rho0 - 1|, smallest rho/rho0 - 1
  lost, crossed          particles out of the domain; whether fluid entered a wall or solid
  peak(c), settled(c, s) largest |value| of a probe's column; whether its last fifth stays within
  the share
                         s of its mean
  mean(c), lowest(c)     mean of the column's last fifth; its smallest value
  apart(c, d)            the largest difference of two columns
"""
import argparse
import csv
import hashlib
import json
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import stability_map
import stability_substeps
from common import PROGRAM, ROOT, cpu_seconds, settings, table, write

SUITE = ROOT / "tests" / "stability"
REPORT = ROOT / "docs" / "stability.md"


# Steps of the comparison of the integrators, over the limit; the first run finds the limit.
FACTORS = [None, 0.5, 0.75, 0.9, 1.0, 1.1, 1.25, 1.5]


def columns(path):
    with open(path, encoding="utf-8") as file:
        rows = list(csv.reader(file))
    names, values = rows[0], [[float(v) for v in row] for row in rows[1:]
                              if len(row) == len(rows[0])]
    return dict(zip(names, zip(*values))) if values else {name: (0.0,) for name in names}


def tail(values, share):
    return values[int((1 - share) * len(values)):] or values[-1:]


def measure(folder, log):
    """The names that a criterion can use."""
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    ledger = columns(folder / "ledger.csv")
    probes = columns(folder / "probes.csv") if (folder / "probes.csv").exists() else {}
    kinetic = ledger["kinetic_J_per_m"]
    active = [sum(parts) for parts in zip(kinetic, ledger["internal_J_per_m"],
                                          ledger["elastic_J_per_m"], ledger["hourglass_J_per_m"])]
    missing = ledger["dissipated_J_per_m"]
    top = max(active) or 1.0

    def peak(column):
        return max(abs(v) for v in probes[column])

    def settled(column, share):
        last = tail(probes[column], 0.2)
        centre = sum(last) / len(last)
        return max(abs(v - centre) for v in last) <= share * abs(centre)

    def mean(column):
        last = tail(probes[column], 0.2)
        return sum(last) / len(last)

    def apart(column, other):
        return max(abs(a - b) for a, b in zip(probes[column], probes[other]))

    fifth = max(1, len(kinetic) // 5)
    return {
        "finished": summary["exit_reason"] == "finished", "time": summary["time"],
        "gain": max(0.0, -min(missing)) / top,
        "drift": max(abs(v) for v in missing) / (active[0] or top),
        "resting": sum(kinetic[-fifth:]) / fifth / (max(kinetic[:fifth]) or 1.0),
        "dens": max(ledger["dens_extreme_1"]),
        "lowest_density": summary["extremes"].get("density_lowest", 0.0),
        "lost": summary["fluid_left_domain"], "crossed": log.count("has entered a wall or solid"),
        "peak": peak, "settled": settled, "mean": mean, "apart": apart,
        "lowest": lambda column: min(probes[column]),
        "message": summary["message"], "version": summary["version"],
        "guarded": summary["exit_reason"] == "guard",
        "solid_bound": (summary["time_step"].get("solid") or 0.0) /
                       summary["parameters"]["numerics"]["solid_safety"],
    }


def run(command, folder, minutes):
    """The output of the program, and its user time. A run that takes longer is stopped."""
    begin = cpu_seconds()
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True) as process:
        try:
            log = process.communicate(timeout=60 * minutes)[0]
        except subprocess.TimeoutExpired:
            process.terminate()  # the program leaves a checkpoint and a summary
            log = process.communicate()[0]
    if process.returncode not in (0, 2, 143) or not (folder / "summary.json").exists():
        sys.exit(f"stability: {' '.join(command)}: exit status {process.returncode}: {log}")
    return log, cpu_seconds() - begin


class Run:
    """One form of a scene in the folder `top`; what the same program has done with the same
    settings is kept."""

    def __init__(self, scene, form, top):
        self.folder = top / re.sub("[^a-z0-9]+", "-", f"{scene['name']} {form}".lower())
        self.command = [str(PROGRAM), str(SUITE / scene["case"]),
                        "--out", str(self.folder), "--quiet", "--threads", "1",
                        *settings(scene.get("set", []) + scene.get(form, []))]
        self.record = top / (self.folder.name + ".json")

    def program(self):
        files = [Path(name).read_bytes() for name in self.command[:2]]
        return hashlib.sha256(b"".join(files)).hexdigest()

    def known(self):
        if not self.record.exists():
            return None
        known = json.loads(self.record.read_text(encoding="utf-8"))
        same = known["command"][1:] == self.command[1:] and known["program"] == self.program()
        return known if same else None

    def measure(self, minutes=60):
        """Measures and user time."""
        known = self.known()
        if not known:
            shutil.rmtree(self.folder, ignore_errors=True)  # of other settings or another program
            log, seconds = run(self.command, self.folder, minutes)
            known = {"command": self.command, "program": self.program(), "log": log,
                     "seconds": seconds}
            self.record.write_text(json.dumps(known), encoding="utf-8")
        return measure(self.folder, known["log"]), known["seconds"]


def words(found):
    """The numbers behind a verdict."""
    text = [f"gain {found['gain']:.2g}", f"drift {found['drift']:.2g}",
            f"density {found['dens']:.2g}"]
    if not found["finished"]:
        text.insert(0, f"stopped at {found['time']:.3g} s: {found['message'].split(': ', 1)[-1]}")
    if found["crossed"]:
        text.append("fluid entered a body")
    return ", ".join(text)


def chosen(scene, form, top):
    """The form that is run, or None; `kept`: the long one where there is a run of it, or else the
    quick one."""
    if form == "kept":
        form = "long" if Run(scene, "long", top).known() else "quick"
    return form if scene.get("only", form) == form else None


def fails(scene, form):
    """Whether the table says that the criterion does not hold in this form."""
    return scene.get("fails", False) in (True, form)


def run_suite(scenes, form, top, minutes):
    """Rows of (scene, whether the criterion holds, whether that is as expected, measures, seconds,
    form)."""
    rows = []
    for scene in scenes:
        this = chosen(scene, form, top)
        if not this:
            continue
        found, seconds = Run(scene, this, top).measure(minutes)
        holds = bool(eval(scene["criterion"], {"__builtins__": {}}, found))  # the table is our own
        as_said = holds != fails(scene, this)
        rows.append((scene, holds, as_said, found, seconds, this))
        print(f"{'ok  ' if as_said else 'NOT '} {seconds:6.1f} s  {scene['name']}: "
              f"{'passes' if holds else 'fails'} ({words(found)})", flush=True)
    return rows


def integrators(top):
    """Rows (multiple of the solid's limit, result of the plate with each integrator)."""
    plate = {"name": "plate", "case": "plate.cfg",
             "set": ["numerics.multirate=off", "end_time=5 ms"]}
    rows = []
    for factor in FACTORS:
        cells = []
        for integrator in ("symplectic", "verlet", "leapfrog"):
            scene = dict(plate, set=plate["set"] + [f"integrator={integrator}"])
            if factor is not None:
                scene["set"] += [f"numerics.fixed_step={factor * bound:.9g}"]
            scene["name"] = f"plate {integrator} {factor}"
            found, _ = Run(scene, "quick", top).measure()
            cells.append(f"gain {found['gain']:.1e}" if found["finished"] else
                         f"stopped at {1e3 * found['time']:.2g} ms")
        if factor is None:
            bound = found["solid_bound"]
            continue
        rows.append((factor, cells))
        print(f"step {factor:g} of the limit: {', '.join(cells)}", flush=True)
    return rows


FORM = {"quick": "quick (coarse and short, as in `make test`; `make stability` runs the long form)",
        "long": "long",
        "kept": "as each row says; `make test` runs the quick form, which is coarse and short; "
                "`make stability` runs the long form of all"}


def summary(rows):
    """Sentences that say whether the hard cases are stable."""
    holds = {row[0]["name"]: row[1] for row in rows}
    scenes = [row[0] for row in rows if "settings" not in row[0] and "without" not in row[0]]
    failed = [scene for scene in scenes if not holds[scene["name"]]]
    cured = [scene for scene in failed if holds.get(scene.get("remedy"))]
    odd = [row[0]["name"] for row in rows if not row[2]]
    last = "No run deviates from what the suite expects." if not odd else \
        f"{len(odd)} runs deviate from what the suite expects: {', '.join(odd)}."
    passed = len(scenes) - len(failed)
    return (f"**Do the hard cases stay stable?** Of {len(scenes)} scenes {passed} pass with "
            f"defaults, "
            f"{len(cured)} need a setting,\nand {len(failed) - len(cured)} have no remedy. "
            f"{len(rows) - len(scenes)} more runs show settings, or what happens without a remedy\n"
            f"that is on by default. {last}")


# Parts of a criterion that say that a run is stable; the others compare its result with something.
STABLE = re.compile(r"^(finished|gain|drift|dens|lowest_density)\b")


def verdict_of(scene, found, stable):
    """`yes` or `no` and the part of the criterion; a dash where it says nothing in this form."""
    parts = [part for part in scene["criterion"].split(" and ")
             if bool(STABLE.match(part)) == stable]

    def holds(part):
        return bool(eval(part, {"__builtins__": {}}, found))  # the table is our own

    said = [part for part in parts
            if not (part.startswith("(time") and holds(part.split(" or ")[0][1:]))]
    if not said:
        return "-"
    text = " and ".join(said).replace("|", "\\|")
    return f"{'yes' if all(map(holds, said)) else '**no**'}: `{text}`"


def scene_row(row):
    scene, holds, as_said, found, seconds, form = row
    verdict = "passes" if holds else "expected failure"
    if not as_said:
        verdict = "**unexpected pass**" if holds else "**unexpected failure**"
    elif not holds and scene["fails"] == form:
        verdict += " in this form"
    measured = f"gain {found['gain']:.1e}, density {found['dens']:.1e}"
    if found["crossed"]:
        measured += "; single particles entered a body"
    if not found["finished"]:
        by = "a guard" if found["guarded"] else "the limit of minutes"
        measured = f"stopped by {by} at {found['time']:.3g} s; {measured}"
    right = verdict_of(scene, found, False)
    against = "-" if right == "-" else scene.get("against", "-")
    return [scene["name"], f"{scene['about']} (`{scene['case']}`)", verdict_of(scene, found, True),
            right,
            against, verdict, form, measured, f"{seconds:.1f}"]


def write_report(rows, integrators, form, command):
    scenes = [row[0] for row in rows]
    limits = [f"* {scene['name']}: {scene['limit']}." for scene in scenes if "limit" in scene]
    limits += [f"* {row[0]['name']}: unexpected; {row[3]['message'] or 'criterion'}"
               for row in rows if not row[2]]
    write(REPORT, "stability.md", summary=summary(rows), command=command, form=FORM[form],
          version=rows[0][3]["version"], map=stability_map.report(stability_map.load()),
          scenes=table(["scene", "what it is", "stable", "right", "against", "result", "form",
                        "measured",
                        "s"], map(scene_row, rows)),
          settings="\n".join(f"* {scene['name']}: {scene['settings']}" for scene in scenes
                             if "settings" in scene),
          limits="\n".join(limits), **stability_substeps.values(),
          integrators=table(["step over the limit", "symplectic", "Verlet", "leapfrog"],
                            [[f"{factor:g}", *cells] for factor, cells in integrators]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="coarse and short")
    parser.add_argument("--report", action="store_true", help="write docs/stability.md")
    parser.add_argument("--keep", action="store_true",
                        help="keep the runs in build/stability and do not repeat those that are "
                             "there")
    parser.add_argument("--kept", action="store_true",
                        help="the long form of scenes whose long run is kept, the quick form of "
                             "others")
    parser.add_argument("--minutes", type=float, default=60, help="stop a run that takes longer "
                                                                  "(60)")
    parser.add_argument("--only", default="", help="only scenes whose name contains this")
    args = parser.parse_args()
    scenes = tomllib.loads((SUITE / "suite.toml").read_text(encoding="utf-8"))["scene"]
    scenes = [scene for scene in scenes if args.only in scene["name"]]
    form = "quick" if args.quick else "kept" if args.kept else "long"
    with tempfile.TemporaryDirectory() as scratch:
        top = ROOT / "build" / "stability" if args.keep or args.kept else Path(scratch)
        top.mkdir(parents=True, exist_ok=True)
        return work(scenes, form, top, args)


def work(scenes, form, top, args):
    rows = run_suite(scenes, form, top, args.minutes)
    bad = [row[0]["name"] for row in rows if not row[2]]
    if bad:
        print(f"not as the table expects: {', '.join(bad)}")
    if args.report:
        command = {"quick": "tools/report/stability.py --quick --report", "long": "make stability",
                   "kept": "tools/report/stability.py --kept --report"}[form]
        write_report(rows, integrators(top), form, command)
    return 1 if bad and not args.report else 0


if __name__ == "__main__":
    sys.exit(main())
