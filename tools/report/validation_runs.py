# SPDX-License-Identifier: MIT
"""The runs of the validation: the table of them, which are to do, and running them."""

import re
from pathlib import Path

from common import ROOT, BadFile, Run, sentence
from runs import Job
from validation_kept import check_ended
from validation_measures import NotRun

TABLE = Path(__file__).with_name("validation_runs.txt")
FOLDER = ROOT / "runs" / "validation"


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
BY_NAME = {job.name: job for job in JOBS}


def chosen(only, quick):
    """The runs to do, in order."""
    jobs, found = [job for job in JOBS if job.quick or not quick], {}
    for name in only.split(","):
        wanted = [job for job in jobs if (job.name == name[1:] if name.startswith("=")
                                          else job.name.startswith(name))]
        if not wanted:
            raise BadFile(f"--only {name}: no run of the selection has this name; {TABLE.name} has "
                          "the names")
        found.update(dict.fromkeys(wanted))
    return list(found)


def say(text):
    print(text, flush=True)


class Runner:
    """Runs what is not up to date, each on one thread: it gives the same bits on any number of
    threads, and separate runs share no barrier. `again`: also what is kept; `keep`: the results of
    the longer runs are kept as they end."""

    def __init__(self, kept, any_version=False, again=False, keep=False):
        self.kept, self.any_version, self.again, self.keep = kept, any_version, again, keep
        self.failed = {}

    def is_kept(self, job):
        try:
            return bool(self.kept.find(job))
        except NotRun:
            return False

    def run(self, job):
        try:
            before = job.record(self.any_version).get("outcome")
            if before not in ("finished", "unstable") and not self.again and self.is_kept(job):
                return
            record = job.run(say, any_program=self.any_version)
            if record["outcome"] in ("refused", "failed"):
                raise BadFile(record["message"])
            try:
                check_ended(Run(job.folder))
            except BadFile as problem:
                say(f"{job.name} is damaged: {problem}")
                job.run(say, anew=True)
            self.store(job)
        except Exception as problem:  # the other runs go on
            self.failed[job.name] = sentence(problem)
            say(f"{job.name} failed: {self.failed[job.name]}")

    def store(self, job):
        """Keeps the result of a longer run that has ended, if that is wanted."""
        if self.keep and not job.quick and job.record(self.any_version):
            say(f"kept {job.name}: {self.kept.store(job).stat().st_size / 1000:.0f} kB")
