#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs small scenes with open boundaries and says how far each is off (make verify-open, some minutes on
one core): a vortex that leaves, a weir with given discharge, a flow that reverses periodically.

examples:
  tools/verify_open.py                  writes docs/open_verification.md
  tools/verify_open.py --only weir      runs these scenes only; writes no report

The scenes are cases/verify/open_*.cfg."""
import argparse
import math
import sys
import tempfile

import numpy as np

import runfiles  # finds the package of the clone
import verify_runs
from sphfsi.snapshots import KINDS, Snapshots
from verify_runs import ROOT, case_of, cell, kept, number, program_version

REPORT = ROOT / "docs" / "open_verification.md"
G = 9.81


class Run(verify_runs.Run):
    """A finished run with the motion of its fluid."""

    def __init__(self, scene, settings, folder):
        super().__init__(case_of(scene, folder), settings, folder)
        if self.stopped:
            sys.exit(f"verify_open: a guard stopped {scene} {' '.join(settings)}")

    def fluid(self):
        """Times, and for each the positions and velocities of the fluid."""
        shots = Snapshots(self.folder / "fields.vtkhdf")
        for step, time in enumerate(shots.times):
            water = shots.load(step, "kind") == KINDS["fluid"]
            yield (time, shots.load(step, "Points")[water, :2],
                   shots.load(step, "velocity")[water, :2])


def on_grid(points, x, values, reach):
    """Means of values at points, weighted by (1 - r/reach)^2."""
    out = np.empty((len(points), values.shape[1]))
    for k, point in enumerate(points):
        r = np.hypot(*(x - point).T) / reach
        weight = np.where(r < 1, (1 - r) ** 2, 0)
        out[k] = weight @ values / weight.sum()
    return out


def measure_vortex(ratio):
    """Beside a channel twice as long, over 1.3 m that end 0.1 m before the outlet; per cent of the swirl."""
    dp, swirl = 1 / ratio, 0.3
    grid = np.array([(x, y) for x in np.arange(-0.6, 0.701, 0.05) for y in np.arange(-0.4, 0.41, 0.05)])
    with tempfile.TemporaryDirectory() as folder:
        runs = [Run("open_vortex", [f"ratio={ratio}", f"length={length} m"], f"{folder}/{length}")
                for length in (1.6, 3.2)]
        most, left, left_long = 0.0, 0.0, 0.0
        for (t, x, v), (_, far_x, far_v) in zip(runs[0].fluid(), runs[1].fluid()):
            if t < 0.49:
                continue
            near, far = on_grid(grid, x, v, 2 * dp), on_grid(grid, far_x, far_v, 2 * dp)
            most = max(most, float(np.sqrt(((near - far) ** 2).sum(axis=1).mean())))
            if t > 1.99:
                left = float(np.hypot(*(near - (1, 0)).T).max())
                left_long = float(np.hypot(*(far - (1, 0)).T).max())
    return [("RMS difference from a channel twice as long, largest in time, % of the swirl",
             100 * most / swirl, 5),
            ("largest velocity beside the stream's, 2.2 s, % of the swirl", 100 * left / swirl, None),
            ("the same in the long channel", 100 * left_long / swirl, None)], \
        sum(run.seconds for run in runs)


def measure_weir(ratio):
    """Means of the last two seconds."""
    q, crest = 0.05, 0.1
    with tempfile.TemporaryDirectory() as folder:
        run = Run("open_weir", [f"ratio={ratio}"], f"{folder}/run")
        p = run.table()
        late = p["time_s"] > p["time_s"][-1] - 2
        names = {key: next(c for c in p if c.startswith(key)) for key in ("head", "over")}
        level, over = (float(p[names[key]][late].mean()) for key in ("head", "over"))
    head = level - crest + (q / level) ** 2 / (2 * G)
    wanted = 1.5 * (q * q / G) ** (1 / 3)
    return [("head over the crest, % too high", 100 * (head / wanted - 1), 5),
            ("discharge over the crest, % too high", 100 * (abs(over) / q - 1), 2)], run.seconds


def womersley(y, time):
    """Velocity at y (m, -0.5 to 0.5) of the flow of open_reversal.cfg."""
    omega = 2 * math.pi / 4
    k = (1 + 1j) * 0.5 * math.sqrt(omega / (2 * 0.05))
    return (-1j * (1 - np.cosh(k * 2 * y) / np.cosh(k)) * np.exp(1j * omega * time)).real


def measure_reversal(ratio):
    """The second period; profile halfway between the boundaries, pressure between 0.4 and 1.6 m. Particles of
    the buffers do not count: the last row of each comes and goes."""
    omega = 2 * math.pi / 4
    with tempfile.TemporaryDirectory() as folder:
        run = Run("open_reversal", [f"ratio={ratio}"], f"{folder}/run")
        off, size, count = [], [], []
        for t, x, v in run.fluid():
            count.append(int(((x[:, 0] > 0) & (x[:, 0] < 2)).sum()))
            if t < 3.99:
                continue
            middle = abs(x[:, 0] - 1) < 0.1
            exact = womersley(x[middle, 1], t)
            off.append(((v[middle, 0] - exact) ** 2).mean())
            size.append((exact ** 2).mean())
        p = run.table()
        t = p["time_s"]
        late = t >= 4
        basis = np.stack([np.cos(omega * t[late]), np.sin(omega * t[late])], axis=1)
        drop = (p["ahead_p_Pa"] - p["behind_p_Pa"])[late]
        c, s = np.linalg.lstsq(basis, drop, rcond=None)[0]
        noise = float(np.std(drop - basis @ (c, s)))
    wanted = 1000 * omega * 1.2
    return [("RMS error of the velocity, % of its RMS", 100 * math.sqrt(sum(off) / sum(size)), 2),
            ("amplitude of the pressure difference, % too high",
             100 * (math.hypot(c, s) / wanted - 1), 2),
            ("its phase, degrees late", math.degrees(math.atan2(s, c)), 2),
            ("rest of it, % of the amplitude", 100 * noise / wanted, None),
            ("change of the number of particles between the lines, %",
             100 * max(abs(n / count[0] - 1) for n in count), 2)], run.seconds


RUNS = [("vortex, 30 spacings over the channel", measure_vortex, 30),
        ("vortex, 60 spacings", measure_vortex, 60),
        ("weir, 10 spacings high", measure_weir, 10), ("weir, 20 spacings high", measure_weir, 20),
        ("reversal, 20 spacings across", measure_reversal, 20),
        ("reversal, 40 spacings across", measure_reversal, 40)]


def report(rows, seconds, version):
    limited = [r for r in rows if r[3] is not None]
    missed = [r for r in limited if not kept(r[2], r[3])]
    text = f"{len(limited) - len(missed)} of {len(limited)} limits are kept."
    if missed:
        text += " Those missed are in brackets."
    lines = ["# Verification of open boundaries", "", text, "",
             f"Written by `make verify-open`; do not edit. {version} One thread. The scenes are "
             "`cases/verify/open_*.cfg`; `tools/verify_open.py` says how each figure is measured. "
             "Poiseuille flow, a pulse of sound, a channel with a level and a flow that reverses "
             "abruptly are tests: `tests/converge/test_open_channel.c`, `tests/fluid/test_open.c`. The "
             "vortex meets a line of constant pressure without velocity along it, and has neither (T-51). "
             "Its error is the same with `shifting = 2` instead of 10.", "",
             "| scene | figure | found | limit |", "|---|---|---|---|"]
    for scene, what, found, limit in rows:
        most = "" if limit is None else number(limit)
        lines.append(f"| {scene} | {what} | {cell(found, limit)} | {most} |")
    lines += ["", "| scene | processor time, s |", "|---|---|"]
    lines += [f"| {name} | {used:.0f} |" for name, used in seconds.items()] + [""]
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="part of a scene's name; writes no report")
    chosen = parser.parse_args()
    rows, seconds = [], {}
    for name, measure, ratio in RUNS:
        if chosen.only not in name:
            continue
        found, seconds[name] = measure(ratio)
        rows += [(name, *figure) for figure in found]
        for what, value, _ in found:
            print(name, what, number(value), flush=True)
    if rows and not chosen.only:
        REPORT.write_text(report(rows, seconds, program_version() + "."), encoding="utf-8")


if __name__ == "__main__":
    main()
