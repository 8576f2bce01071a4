#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs random valid cases with every build and every kind of interruption, and compares all bits.

    tests/fault/random_cases.py --count 1000          1000 cases; outcomes go to
    tests/fault/random.json
    tests/fault/random_cases.py --seed 17 --print     the case of a seed
    tests/fault/random_cases.py --seed 17 --keep DIR  runs it and keeps its folders

A case is a small scene: a tank, a channel with periodic or open sides, or solids that meet, with
random bodies, motions, laws, loads, probes and numerics. It runs some dozen steps with the programs
of --builds (`make random-cases`, or --all-builds, makes those of gcc, clang, AVX2, AVX-512, one
thread and the sanitizers), on other numbers of threads, killed and restarted, stopped and
restarted, and forked without a change. All have to end with the same state, rows and snapshots. A
run that ends well must hold finite numbers and particles that are slower than sound; one that a
guard stops must be stopped at the same step everywhere.
"""
import argparse
import json
import math
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import random_scenes

ROOT = Path(__file__).resolve().parents[2]
KEPT = ROOT / "tests" / "fault" / "random.json"
ENV = {**os.environ, "OMP_WAIT_POLICY": "passive", "UBSAN_OPTIONS": "print_stacktrace=1"}
ENV.pop("OMP_NUM_THREADS", None)


def make_builds():
    """The other builds of the program that this machine can run."""
    builds = {"gcc": ROOT / "sphfsi", "one thread": ROOT / "build/serial/sphfsi",
              "sanitizers": ROOT / "build/sanitize/sphfsi"}
    goals = [["sphfsi"],
             *([f"CONFIG={name}", f"build/{name}/sphfsi"] for name in ("serial", "sanitize"))]
    if shutil.which("clang"):
        builds["clang"] = ROOT / "build/clang/sphfsi"
        goals.append(["CC=clang", "B=build/clang", "build/clang/sphfsi"])
    info = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    for name, flag, arch in (("AVX2", " avx2 ", "x86-64-v3"),
                             ("AVX-512", " avx512vl ", "x86-64-v4")):
        if flag in info:
            builds[name] = ROOT / f"build/{arch}/sphfsi"
            goals.append([f"ARCH={arch}", f"B=build/{arch}", f"build/{arch}/sphfsi"])
    env = {key: value for key, value in os.environ.items() if not key.startswith(("MAKE", "ARGS"))}
    for goal in goals:
        subprocess.run(["make", "-s", "-j2", "SETUP=no", *goal], cwd=ROOT, env=env, check=True)
    return builds


def run(program, folder, out, *more, seconds=120):
    """(exit status, what it said)"""
    words = [program, folder / "case.cfg", "--quiet", "--out", folder / out, *more]
    if "--threads" not in more:
        words += ["--threads", "1"]
    done = subprocess.run(words, env=ENV, capture_output=True, text=True, timeout=seconds)
    return done.returncode, done.stdout + done.stderr


def summary(out):
    path = out / "summary.json"
    return json.loads(path.read_text()) if path.exists() else {}


def rows(out):
    return {path.name: path.read_bytes() for path in sorted(out.glob("*.csv"))}


def first_sentence(said, folder):
    lines = [line for line in said.splitlines() if line.startswith("sphfsi: ")]
    return lines[0].replace(str(folder), "")[:300] if lines else said[-300:]


def snapshots(out):
    """Every dataset of the snapshots but those that say which program wrote them."""
    import h5py
    found = {}
    path = out / "fields.vtkhdf"
    if path.exists():
        with h5py.File(path) as file:
            file.visititems(lambda name, item: found.update(
                {name: item[()].tobytes()} if isinstance(item, h5py.Dataset) else {}))
    return found


def differences(whole, other, forked=False):
    """What of two runs is not the same. A fork counts energies anew; its last snapshot must
    agree."""
    a, b = summary(whole), summary(other)
    names = ["exit_reason"] + ([] if forked else ["state_hash", "steps", "simulated_time"])
    found = [f"{name}: {a.get(name)} and {b.get(name)}" for name in names
             if a.get(name) != b.get(name)]
    if forked:
        mine, others = last_snapshot(whole), last_snapshot(other)
        return found + [f"last snapshot: {name}" for name in mine if mine[name] != others.get(name)]
    mine, others = rows(whole), rows(other)
    found += [name for name in sorted(mine.keys() | others.keys())
              if mine.get(name) != others.get(name)]
    mine, others = snapshots(whole), snapshots(other)
    found += [f"snapshots: {name}" for name in sorted(mine.keys() | others.keys())
              if mine.get(name) != others.get(name)]
    return found


def last_snapshot(out):
    import h5py
    with h5py.File(out / "fields.vtkhdf") as file:
        n = int(file["VTKHDF/NumberOfPoints"][-1])
        found = {name: item[-n:].tobytes() for name, item in file["VTKHDF/PointData"].items()}
        return {**found, "Points": file["VTKHDF/Points"][-n:].tobytes()}


def unsound(out, sound_speed):
    """What is wrong with a run that says that it ended well."""
    found = []
    for name, text in rows(out).items():
        lines = text.decode().splitlines()
        columns = lines[0].split(",")
        for line in lines[1:]:
            values = [float(word) for word in line.split(",")]
            # A front or a level where there is no fluid is no number.
            bad = [c for c, v in zip(columns, values) if not math.isfinite(v)
                   and (name == "ledger.csv" or
                        not any(w in c for w in ("_level", "_front", "_p_")))]
            if bad or len(values) != len(columns):
                found.append(f"{name}: {bad[:3]} at {values[0]} s")
                break
    path = out / "fields.vtkhdf"
    if path.exists():
        import h5py
        with h5py.File(path) as file:
            fastest = abs(file["VTKHDF/PointData/velocity"][()]).max(initial=0)
        if not fastest < sound_speed:
            found.append(f"a speed of {fastest:.3g} m/s, and sound has {sound_speed:.3g}")
    return found


def kill_and_restart(program, folder, dice):
    """A run that is killed outright up to twice, once it has a checkpoint: (kills, status, said)"""
    out, kills, more = folder / "killed", 0, []
    for _ in range(8):
        words = [program, folder / "case.cfg", "--quiet", "--out", out, "--threads", "1", *more]
        with subprocess.Popen(words, env=ENV, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True) as process:
            before = set(out.glob("step-*"))
            while kills < 2 and process.poll() is None and set(out.glob("step-*")) == before:
                time.sleep(0.0005)
            if kills < 2 and process.poll() is None:
                time.sleep(dice.random() * 0.004)
                process.send_signal(signal.SIGKILL)
            said = process.communicate()[0]
            status = process.returncode
        if status != -signal.SIGKILL:
            return kills, status, said
        kills += 1
        if any(out.glob("step-*.ckpt")):
            more = ["--restart"]
        else:
            shutil.rmtree(out, ignore_errors=True)
            more = []
    return kills, status, said


def variants(folder, builds, dice, end):
    """(name, status, what it said, whether it is a fork) of each other way to run the case."""
    for name, program in builds.items():
        if name != "gcc":
            yield (name, *run(program, folder, name), False)
    gcc = builds["gcc"]
    threads = str(dice.choice([2, 3, 4]))
    yield (f"{threads} threads", *run(gcc, folder, f"{threads} threads", "--threads", threads),
           False)
    kills, status, said = kill_and_restart(gcc, folder, dice)
    yield ("killed", status, said, False, kills)
    # At a row: a step ends there anyway.
    cut = f"{end / 10 * dice.randrange(2, 9):.12g}"
    status, said = run(gcc, folder, "cut", "--until", cut)
    if status == 0:
        other = dice.choice([p for p in builds.values()])
        status, said = run(other, folder, "cut", "--restart", "--threads", dice.choice(["1", "2"]))
        yield ("cut", status, said, False)
        run(gcc, folder, "begun", "--until", cut)
        yield ("fork", *run(gcc, folder, "fork", "--fork", folder / "begun"), True)


def one_case(seed, builds, folder):
    """{"outcome": ..., "why": ...} of the case of a seed."""
    scene = random_scenes.make(seed)
    dice = random.Random(seed)
    folder.mkdir(parents=True)
    (folder / "case.cfg").write_text(scene["text"])
    for name, text in scene["files"].items():
        (folder / name).write_text(text)
    status, said = run(builds["gcc"], folder, "gcc")
    if status == 1:
        return {"outcome": "refused", "why": first_sentence(said, folder)}
    if status not in (0, 2):
        return {"outcome": "FAILED", "why": f"exit status {status}: {said[-500:]}"}
    wrong, kills = [], 0
    whole = folder / "gcc"
    if status == 0:
        wrong += unsound(whole, scene["sound_speed"])
    for name, other, text, forked, *killed in variants(folder, builds, dice, scene["end"]):
        kills += sum(killed)
        out = folder / name
        if forked and 2 in (status, other):
            continue  # it may be stopped elsewhere: its energies begin at another time
        if other != status:
            wrong.append(f"{name}: exit status {other}, not {status}: "
                         f"{first_sentence(text, folder)}")
        else:
            wrong += [f"{name}: {what}" for what in differences(whole, out, forked)]
    end = summary(whole)
    return {"outcome": "FAILED" if wrong else "finished" if status == 0 else "stopped by a guard",
            "why": "; ".join(wrong) or (first_sentence(said, folder) if status else ""),
            "kills": kills,
            "steps": end.get("steps", 0), "features": scene["features"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0], epilog=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000, help="valid cases to run")
    parser.add_argument("--seed", type=int, help="the case of this seed alone")
    parser.add_argument("--first", type=int, default=1, help="seed of the first case")
    parser.add_argument("--print", action="store_true", help="print the case of --seed")
    parser.add_argument("--jobs", type=int, default=1, help="cases at a time")
    parser.add_argument("--keep", type=Path, help="keep the folders of the runs here")
    parser.add_argument("--minutes", type=float, default=1e9, help="stop after so long")
    parser.add_argument("--builds", nargs="+", metavar="NAME=PROGRAM", default=["gcc=./sphfsi"])
    parser.add_argument("--all-builds", action="store_true", help="make and run every build")
    parser.add_argument("--no-record", action="store_true", help="leave tests/fault/random.json "
                                                                 "alone")
    args = parser.parse_args()
    if args.print:
        print(random_scenes.make(args.seed or 1)["text"])
        return 0
    builds = make_builds() if args.all_builds else \
        {word.split("=")[0]: Path(word.split("=")[1]).resolve() for word in args.builds}
    start, seed, count, features = time.time(), args.seed or args.first, Counter(), Counter()
    steps = kills = 0
    failures = []
    def try_seed(k):
        folder = (args.keep or Path(top)) / f"seed-{k}"
        try:
            return k, one_case(k, builds, folder)
        except subprocess.TimeoutExpired as late:
            return k, {"outcome": "FAILED", "why": f"does not end: {late.cmd}"}
        finally:
            if not args.keep:
                shutil.rmtree(folder, ignore_errors=True)

    wanted = 1 if args.seed else args.count
    with tempfile.TemporaryDirectory(dir="/dev/shm" if os.access("/dev/shm", os.W_OK)
                                     else None) as top, \
            ThreadPoolExecutor(args.jobs) as pool:
        while (left := wanted - count.total() + count["refused"]) > 0 and \
                time.time() - start < 60 * args.minutes:
            seeds = range(seed, seed + min(left, 10))
            seed = seeds.stop
            for k, result in pool.map(try_seed, seeds):
                count[result["outcome"]] += 1
                features.update(result.get("features", ()))
                steps += result.get("steps", 0)
                kills += result.get("kills", 0)
                if result["outcome"] == "FAILED":
                    failures.append(f"seed {k}: {result['why']}")
                if result["outcome"] != "finished":
                    print(f"seed {k}: {result['outcome']}: {result['why']}", flush=True)
    record = {"cases": count.total() - count["refused"], "outcomes": dict(count), "steps": steps,
              "kills": kills, "features": dict(sorted(features.items())), "builds": sorted(builds),
              "seeds": [args.seed or args.first, seed - 1], "failures": failures,
              "version": subprocess.run([builds["gcc"], "--version"], capture_output=True,
                                        text=True).stdout.strip(),
              "date": time.strftime("%Y-%m-%d"), "seconds": round(time.time() - start)}
    if not args.no_record and not args.seed:
        KEPT.write_text(json.dumps(record, indent=1) + "\n")
    print(f"found: {record['cases']} random cases, {dict(count)}, {kills} kills, {steps} steps")
    return bool(failures)


if __name__ == "__main__":
    sys.exit(main())
