#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the hard cases of tests/stability/suite.toml and says which pass.

  tools/report/stability.py --quick     coarse and short; exit status 1 if a scene deviates from the
                                        table
  tools/report/stability.py --report    the long form; writes docs/results/stability.md (make
                                        stability)

Names that a criterion can use:
  finished      the run reached its end; otherwise a guard stopped it
  gain          the largest spurious energy over the largest kinetic plus strain energy
  drift         the same, gained or lost, over the kinetic plus strain energy at the start
  resting       mean kinetic energy of the last fifth over the largest of the first
  dens, lowest_density   largest |rho/rho0 - 1|, smallest rho/rho0 - 1
  lost, crossed          particles out of the domain; whether fluid entered a wall or solid
  peak(c), settled(c, s) largest |value| of a probe's column; whether its last fifth stays within
                         the share s of its mean
  mean(c), lowest(c)     mean of the column's last fifth; its smallest value
  apart(c, d)            the largest difference of two columns
"""
import re
import sys
import tempfile
import tomllib
from pathlib import Path

import stability_map
from common import OUT, ROOT, Run, options, read_table, run_tool, table, write
from runs import Job

SUITE = ROOT / "tests" / "stability"
REPORT = OUT / "stability.md"


def measure(folder, log):
    """The names that a criterion can use."""
    summary = Run(folder).summary
    ledger, probes = (read_table(folder / name, torn=True, finite=False)[0]
                      if (folder / name).exists() else {} for name in ("ledger.csv", "probes.csv"))
    kinetic, missing = ledger["kinetic_J_per_m"], ledger["dissipated_J_per_m"]
    active = sum((ledger[f"{name}_J_per_m"] for name in ("internal", "elastic", "hourglass")),
                 kinetic)
    top = active.max() or 1.0
    fifth = max(1, len(kinetic) // 5)

    def tail(column):
        values = probes[column]
        return values[int(0.8 * len(values)):]

    def mean(column):
        return tail(column).mean()

    return {
        "finished": summary["exit_reason"] == "finished", "time": summary["time"],
        "gain": max(0.0, -missing.min()) / top, "drift": abs(missing).max() / (active[0] or top),
        "resting": kinetic[-fifth:].mean() / (kinetic[:fifth].max() or 1.0),
        "dens": ledger["dens_extreme_1"].max(),
        "lowest_density": summary["extremes"].get("density_lowest", 0.0),
        "lost": summary["fluid_left_domain"], "crossed": log.count("has entered a wall or solid"),
        "peak": lambda column: abs(probes[column]).max(), "mean": mean,
        "settled": lambda column, share:
            abs(tail(column) - mean(column)).max() <= share * abs(mean(column)),
        "apart": lambda column, other: abs(probes[column] - probes[other]).max(),
        "lowest": lambda column: probes[column].min(),
        "message": summary["message"], "version": summary["version"],
    }


def job_of(scene, form, top):
    """One form of a scene in the folder `top`."""
    name = re.sub("[^a-z0-9]+", "-", f"{scene['name']} {form}".lower())
    return Job(top / name, SUITE / scene["case"], scene.get("set", []) + scene.get(form, []))


def measured(job):
    """Measures and user time, of an hour at most."""
    record = job.run(lambda text: None, limit=3600)
    if record["outcome"] not in ("finished", "unstable", "too slow"):
        sys.exit(f"stability: {job.case} {' '.join(job.sets)}: {record['message']}")
    return measure(job.folder, record["log"]), record["timing"]["cpu"]


def holds(criterion, found):
    return bool(eval(criterion, {"__builtins__": {}}, found))  # the table is our own


def words(found):
    """The numbers behind a verdict."""
    text = [f"gain {found['gain']:.2g}", f"drift {found['drift']:.2g}",
            f"density {found['dens']:.2g}"]
    if not found["finished"]:
        text.insert(0, f"stopped at {found['time']:.3g} s: {found['message'].split(': ', 1)[-1]}")
    if found["crossed"]:
        text.append("single particles entered a body")
    return ", ".join(text)


def run_suite(scenes, form, top):
    """Rows of (scene, whether the criterion holds, whether that is as expected, measures, seconds,
    form)."""
    rows = []
    for scene in scenes:
        if scene.get("only", form) != form:
            continue
        found, seconds = measured(job_of(scene, form, top))
        good = holds(scene["criterion"], found)
        as_said = good != (scene.get("fails", False) in (True, form))
        rows.append((scene, good, as_said, found, seconds, form))
        print(f"{'ok  ' if as_said else 'NOT '} {seconds:6.1f} s  {scene['name']}: "
              f"{'passes' if good else 'fails'} ({words(found)})", flush=True)
    return rows


def summary(rows):
    """Sentences that say whether the hard cases are stable."""
    good = {row[0]["name"]: row[1] for row in rows}
    scenes = [row[0] for row in rows if "settings" not in row[0] and "without" not in row[0]]
    failed = [scene for scene in scenes if not good[scene["name"]]]
    cured = [scene for scene in failed if good.get(scene.get("remedy"))]
    odd = [row[0]["name"] for row in rows if not row[2]]
    last = "No run deviates from what the suite expects." if not odd else \
        f"{len(odd)} runs deviate from what the suite expects: {', '.join(odd)}."
    return (f"**Do the hard cases stay stable?** Of {len(scenes)} scenes "
            f"{len(scenes) - len(failed)} pass with defaults, {len(cured)} need a setting,\n"
            f"and {len(failed) - len(cured)} have no remedy. {len(rows) - len(scenes)} more runs "
            f"show settings, or what happens without a remedy\nthat is on by default. {last}")


# Parts of a criterion that say that a run is stable; the others compare its result with something.
STABLE = re.compile(r"^(finished|gain|drift|dens|lowest_density)\b")


def verdict_of(scene, found, stable):
    """`yes` or `no` and the part of the criterion; a dash where it says nothing in this form."""
    said = [part for part in scene["criterion"].split(" and ")
            if bool(STABLE.match(part)) == stable and
            not (part.startswith("(time") and holds(part.split(" or ")[0][1:], found))]
    if not said:
        return "-"
    text = " and ".join(said).replace("|", "\\|")
    return f"{'yes' if all(holds(part, found) for part in said) else '**no**'}: `{text}`"


def scene_row(row):
    scene, good, as_said, found, seconds, form = row
    verdict = "passes" if good else "expected failure"
    if not as_said:
        verdict = "**unexpected pass**" if good else "**unexpected failure**"
    elif not good and scene["fails"] == form:
        verdict += " in this form"
    right = verdict_of(scene, found, False)
    against = "-" if right == "-" else scene.get("against", "-")
    return [scene["name"], f"{scene['about']} (`{scene['case']}`)", verdict_of(scene, found, True),
            right, against, verdict, form, words(found), f"{seconds:.1f}"]


def write_report(rows, form):
    scenes = [row[0] for row in rows]
    limits = [f"* {scene['name']}: {scene['limit']}." for scene in scenes if "limit" in scene]
    limits += [f"* {row[0]['name']}: unexpected; {row[3]['message'] or 'criterion'}"
               for row in rows if not row[2]]
    write(REPORT, "stability.md", summary=summary(rows), form=form,
          version=rows[0][3]["version"], map=stability_map.report(stability_map.load()),
          scenes=table(["scene", "what it is", "stable", "right", "against", "result", "form",
                        "measured", "s"], map(scene_row, rows)),
          settings="\n".join(f"* {scene['name']}: {scene['settings']}" for scene in scenes
                             if "settings" in scene),
          limits="\n".join(limits))


def main():
    parser = options(__doc__)
    parser.add_argument("--quick", action="store_true", help="coarse and short")
    parser.add_argument("--report", action="store_true", help="write docs/results/stability.md")
    parser.add_argument("--keep", action="store_true", help="keep the runs in build/stability and "
                        "do not repeat those that are there")
    parser.add_argument("--only", default="", help="only scenes whose name contains this")
    args = parser.parse_args()
    scenes = tomllib.loads((SUITE / "suite.toml").read_text(encoding="utf-8"))["scene"]
    scenes = [scene for scene in scenes if args.only in scene["name"]]
    form = "quick" if args.quick else "long"
    with tempfile.TemporaryDirectory() as scratch:
        top = ROOT / "build" / "stability" if args.keep else Path(scratch)
        rows = run_suite(scenes, form, top)
        bad = [row[0]["name"] for row in rows if not row[2]]
        if bad:
            print(f"not as the table expects: {', '.join(bad)}")
        if args.report:
            write_report(rows, form)
        return bool(bad) and not args.report


if __name__ == "__main__":
    run_tool(main)
