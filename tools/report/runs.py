# SPDX-License-Identifier: MIT
"""Runs that are kept in folders: made once, continued after a kill, made anew when their case or
the program has changed. A record beside the folder, NAME.json, says how a run ended."""

import functools
import hashlib
import json
import os
import re
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from resource import RLIMIT_CPU, setrlimit
from signal import SIGXCPU

from common import PROGRAM, ROOT, ask, load, program_version, settings

# Sources that no run comes by: they look ahead, list, or hold what reports have measured.
ASIDE = re.compile(r"(evidence|presets|citations|template|embedded|explain|forecast|"
                   r"manual\w*|preview|inspect)\.\w+")
# What the program says once more of a folder that it does not go on from.
NO_RESTART = re.compile(r"checkpoint|\.ckpt")


@functools.cache
def program_hash():
    """Hash of everything in the program that results can depend on."""
    total = hashlib.sha256()
    for path in sorted([*ROOT.glob("src/*/*"), *ROOT.glob("include/*")]):
        if path.suffix in (".c", ".h", ".def") and not ASIDE.fullmatch(path.name):
            total.update(path.name.encode() + b"\0" + path.read_bytes())
    flags = ROOT / "build" / "release" / "flags"
    if flags.exists():
        total.update(re.sub(r"\S*/\S*", "", flags.read_text()).encode())
    return total.hexdigest()[:16]


def case_hash(text):
    """Hash of an effective case but for its words and references."""
    text = re.sub(r"(?ms)^\[reference .*?(?=^\[|\Z)", "", text)
    return hashlib.sha256(re.sub(r"(?m)^(#|title|source).*\n", "", text).encode()).hexdigest()[:16]


def definition_hash(job):
    """Hash of what a run is defined by: the text of its case but for comments, and its settings."""
    text = re.sub(r"\s*#.*", "", job.case.read_text(encoding="utf-8"))
    return hashlib.sha256("\n".join([text, *job.sets]).encode()).hexdigest()[:16]


@functools.cache
def effective(*arguments):
    return ask("--effective", *arguments)


def timed(command, threads, limit=None):
    """Runs it: exit status or None for too long, its timing (s), stderr. The limit is of CPU time,
    so that a busy machine, or one where each run waits for its turn, changes nothing."""
    environment = dict(os.environ, OMP_NUM_THREADS=str(threads))
    with tempfile.TemporaryFile("w+", errors="replace") as stderr:
        busy, start = os.getloadavg()[0], time.monotonic()
        process = subprocess.Popen(
            command, env=environment, stdout=subprocess.DEVNULL, stderr=stderr,
            preexec_fn=limit and (lambda: setrlimit(RLIMIT_CPU, (limit, limit + 5))))
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = status = os.waitstatus_to_exitcode(status)
        wall = time.monotonic() - start
        stderr.seek(0)
        said = stderr.read().strip()
    timing = {"cpu": round(usage.ru_utime + usage.ru_stime, 3), "wall": round(wall, 3),
              "load": round(busy, 2)}
    return None if status in (-SIGXCPU, 128 + SIGXCPU) else status, timing, said


class Job:
    """A run to keep: its folder, case, the settings over it, what is different about it in words,
    and whether it belongs to a quick selection."""

    def __init__(self, folder, case, sets=(), words="", quick=False):
        self.folder, self.case, self.sets = Path(folder), Path(case), list(sets)
        self.name, self.words, self.quick = self.folder.name, words, quick

    def arguments(self):
        return [str(self.case), *settings(self.sets)]

    def effective(self):
        return effective(*self.arguments())

    @property
    def record_path(self):
        return self.folder.with_name(self.folder.name + ".json")

    def record(self):
        """How the run ended that is kept, or is under way; {} if there is none of this case."""
        try:
            found = load(self.record_path, {})
        except ValueError:
            return {}
        same = found.get("case") == case_hash(self.effective()) and \
            found.get("program") == program_hash() and self.folder.is_dir()
        return found if same else {}

    def run(self, say=print, threads=1, limit=None, anew=False):
        """The record, after a run if there is none of one that ended; an interrupted run goes on
        unless it is to be `anew`."""
        before = self.record()
        if before.get("outcome", "started") not in ("started", "failed") and not anew:
            return before
        goes_on = before and not anew and any(self.folder.glob("*.ckpt"))
        say(f"{'continues' if goes_on else 'runs'} {self.name}: {self.words}")
        if not goes_on:
            shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True, exist_ok=True)
        record = {"case": case_hash(self.effective()), "program": program_hash(),
                  "version": program_version(), "outcome": "started"}
        self.store(record)
        command = [str(PROGRAM), *self.arguments(), "--quiet", "--threads", str(threads),
                   "--out", str(self.folder)]
        status, timing, said = timed([*command, "--restart"] if goes_on else command, threads,
                                     limit)
        if goes_on and status == 1 and NO_RESTART.search(said):
            say(f"{self.name}: {said.splitlines()[-1]}")
            return self.run(say, threads, limit, anew=True)
        record.update(timing=timing, log=said, resumed=bool(goes_on),
                      **outcome(self.folder, status, said, limit))
        self.store(record)
        return record

    def store(self, record):
        part = self.record_path.with_suffix(".part")
        part.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
        part.replace(self.record_path)


def outcome(folder, status, said, limit):
    """How a run ended, and why."""
    if status is None:
        return {"outcome": "too slow", "message": f"more than {limit} s of CPU time"}
    if status == 0:
        return {"outcome": "finished", "message": ""}
    try:
        guard = load(folder / "summary.json", {}).get("exit_reason") == "guard"
    except ValueError:
        guard = False
    word = {1: "refused", 2: "unstable" if guard else "failed"}.get(status, "failed")
    return {"outcome": word,
            "message": said.splitlines()[-1] if said else f"exit status {status}"}
