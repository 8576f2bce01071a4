#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Speed of the page in a headless Chromium over that of one thread of the native program. Both run
the same case in turn. Compared are CPU times, so that other programs on the machine matter little:
those of the native process and of the page's worker, which has the program and hands over its
particles. Drawing is another thread's.

    web/speed.py --program ./sphfsi --page build/web/index.html --rounds 5
"""
import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import build
from build import ROOT, files

sys.path.insert(0, str(ROOT / "tests" / "support"))
import chromium

DONE = "['finished', 'refused', 'stopped'].includes(document.body.dataset.state)"


def native_seconds(program, name, folder):
    """CPU and wall time of a run, s."""
    sets = build.as_sets(build.CASES[name].get("set", {}))
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    with tempfile.TemporaryDirectory(dir=folder) as out:
        subprocess.run([program, ROOT / "cases" / f"{name}.cfg", "--out", f"{out}/run", "--threads",
                        "1",
                        "--quiet", *sets], check=True, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, \
        time.monotonic() - begin


def worker_cpu(browser):
    """CPU time of the threads of workers in all processes below the browser's, s."""
    parents = {}
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            parents[int(status.parent.name)] = int(status.read_text().rpartition(")")[2].split()[1])
        except OSError:  # it has ended
            continue
    ticks = 0
    for pid in parents:
        above = pid
        while above and above != browser:
            above = parents.get(above)
        for task in Path(f"/proc/{pid}/task").glob("*/stat") if above else []:
            name, _, rest = task.read_text().rpartition(")")
            if "DedicatedWorker" in name:
                ticks += sum(map(int, rest.split()[11:13]))
    return ticks / os.sysconf("SC_CLK_TCK")


def page_seconds(page, name):
    """CPU time of the worker and wall time from the click to the end, s."""
    page.run(f"choose('{name}')")
    page.wait("document.body.dataset.state === 'built'")
    before, begin = worker_cpu(page.process.pid), time.monotonic()
    page.run("document.getElementById('run').click()")
    page.wait(DONE, 600)
    if page.run("document.body.dataset.hash") != page.run("state.chosen.hash"):
        raise SystemExit(f"{name}: not the native program's bits")
    return worker_cpu(page.process.pid) - before, time.monotonic() - begin


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, required=True, help="the native program")
    parser.add_argument("--page", type=Path, required=True, help="what `make web` has written")
    parser.add_argument("--case", default="gate", choices=build.CASES, help="(%(default)s)")
    parser.add_argument("--rounds", type=int, default=5, help="(%(default)s)")
    args = parser.parse_args()
    if not chromium.program():
        raise SystemExit("web/speed.py: chromium is missing")
    program, rounds = args.program.resolve(), []
    with (tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name,
          chromium.Browser(Path(name)) as page):
        page.open(f"file://{args.page.resolve()}")
        page.wait("document.body.dataset.state === 'built'")
        for _ in range(args.rounds):
            rounds.append((*native_seconds(program, args.case, name),
                           *page_seconds(page, args.case)))
            print("native {:.2f} s of CPU, {:.2f} s in all; page {:.2f} s, {:.2f} s in all".format(
                *rounds[-1]), flush=True)
        kind = page.run("document.body.dataset.multiply_add")
    native, _, worker, _ = (statistics.median(column) for column in zip(*rounds))
    shares = sorted(row[0] / row[2] for row in rounds)
    print(f"{args.case}, {args.rounds} rounds, multiply-add {kind}: {native:.2f} s of CPU by the "
          f"native thread, {worker:.2f} s by the page; speed {statistics.median(shares):.2f} of "
          f"the native "
          f"thread's ({shares[0]:.2f} to {shares[-1]:.2f})")


if __name__ == "__main__":
    main()
