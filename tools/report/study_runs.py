# SPDX-License-Identifier: MIT
"""Runs points of a study and keeps what they gave and took."""

import json
import os
import shlex
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from resource import RLIMIT_CPU, setrlimit
from signal import SIGXCPU

from study_points import PROGRAM, ROOT, cached_record, complain, repeats_of, set_arguments
from study_results import machine

KEEP = ("probes.csv", "ledger.csv", "summary.json", "case.cfg", "fields.vtkhdf")
POWERCAP = Path("/sys/class/powercap")


def joules():
    """Counters of the processor packages in J, or None where there are none."""
    zones = list(POWERCAP.glob("intel-rapl:?"))
    try:
        return sum(int((zone / "energy_uj").read_text())
                   for zone in zones) * 1e-6 if zones else None
    except (OSError, ValueError):
        return None


def timed(command, threads, limit):
    """Runs it: exit status or None for too long, its timing (s, J), stderr. The limit is of CPU
    time, so that a busy machine, or one where each run waits for its turn, changes nothing."""
    environment = dict(os.environ, OMP_NUM_THREADS=str(threads))
    with tempfile.TemporaryFile("w+", errors="replace") as stderr:
        load, energy, start = os.getloadavg()[0], joules(), time.monotonic()
        process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL,
                                   stderr=stderr,
                                   preexec_fn=lambda: setrlimit(RLIMIT_CPU, (limit, limit + 5)))
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = status = os.waitstatus_to_exitcode(status)
        wall, after = time.monotonic() - start, joules()
        stderr.seek(0)
        said = stderr.read()
    timing = {"cpu": round(usage.ru_utime + usage.ru_stime, 3), "wall": round(wall, 3),
              "joules": None if energy is None or after is None else after - energy,
              "load": round(load, 2)}
    return None if status in (-SIGXCPU, 128 + SIGXCPU) else status, timing, said.strip()


def run_once(folder, p, study):
    """A run in its folder: how it ended, its summary, and its timing."""
    shutil.rmtree(folder, ignore_errors=True)
    command = [*shlex.split(study["prefix"]), str(PROGRAM),
               str(ROOT / study["case"][p["case"]]["file"]),
               "--quiet", "--out", str(folder), *set_arguments(p["set"])]
    limit = study["study"].get("time_limit", 600)
    status, timing, said = timed(command, study["study"].get("threads", 1), limit)
    timing["beside"] = study["jobs"] - 1
    message = said.splitlines()[-1] if said else f"exit status {status}"
    if status is None:
        message = f"more than {limit} s of CPU time"
    try:
        summary = json.loads((folder / "summary.json").read_text())
    except (OSError, ValueError):
        summary = {}
    guard = summary.get("exit_reason") == "guard"
    outcome = "too slow" if status is None else \
        {0: "finished", 1: "refused", 2: "unstable" if guard else "failed"}.get(status, "failed")
    if summary and status is not None:
        # Without waiting for its turn.
        timing["wall"] = round(summary.get("wall_seconds", timing["wall"]), 3)
    return outcome, message if outcome != "finished" else "", summary, timing


def record_of(p, outcome, message, summary):
    counters = summary.get("counters", {})
    return dict(p, outcome=outcome, message=message, version=summary.get("version", ""),
                dp=summary.get("parameters", {}).get("dp"), steps=summary.get("steps"),
                solid_steps=summary.get("solid_substeps"), particles=summary.get("particles"),
                particle_steps=counters.get("particle_steps"),
                evaluations=(counters.get("evaluations") or 0) +
                (counters.get("solid_evaluations") or 0),
                hash=summary.get("state_hash"))


def write_json(path, data):
    part = path.with_suffix(".part")
    part.write_text(json.dumps(data, indent=1))
    part.replace(path)


def run_point(p, study, runs, again=False):
    """Runs a point unless it is cached; `again` adds timings to a finished one."""
    folder = runs / p["key"]
    folder.mkdir(parents=True, exist_ok=True)
    before = cached_record(runs, p["key"])
    if before and not (again and before["outcome"] == "finished"):
        return before
    run = folder / "run"
    outcome, message, summary, timing = run_once(run, p, study)
    record = dict(record_of(p, outcome, message, summary), timing=[timing],
                  program=study["program"])
    if outcome == "finished":
        record["timing"] += [run_once(run, p, study)[3]
                             for _ in range(repeats_of(timing["cpu"], study["study"]) - 1)]
    else:
        complain(f"{p['name']}: {outcome}: {message}")
    for file in list(run.glob("*")) if run.is_dir() else []:
        if file.name not in KEEP:
            file.unlink()
    record["machine"] = machine(ROOT)
    write_json(folder / "result.json", record)
    return record
