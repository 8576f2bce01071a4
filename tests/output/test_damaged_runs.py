#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The validation over damaged folders of runs: each costs its own lines of the report, which name
it, and is run anew; what is interrupted goes on, or begins anew with the reason. Exit 77: a package
is missing."""

import contextlib
import io
import json
import shutil
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import packages
with packages():
    import h5py  # noqa: F401  the snapshots need it
    import validation_cases
    import validation_checks
    import validation_kept
    import validation_report
    import validation_runs
    from runfiles import BadFile, Run
SHORT = {"wave-40-1.5": ["ratio=10", "end_time=0.3"],
         "taylor-green-25": ["ratio=10", "end_time=0.3"],
         "block-20": ["ratio=10", "turns=0.05"]}  # water with probes, water without, a solid
WAVE = "wave-40-1.5"


class Bench:
    """A place for short runs, what is kept of them, and a report."""

    def __init__(self, folder):
        self.folder = folder
        for spec in validation_runs.JOBS:
            spec.folder = folder / "runs" / spec.name
        for name, sets in SHORT.items():
            self.spec(name).sets = list(sets)
            self.run(name)
            shutil.copytree(self.spec(name).folder, folder / "whole" / name)

    def spec(self, name):
        return validation_runs.BY_NAME[name]

    def restore(self, name):
        shutil.rmtree(self.spec(name).folder, ignore_errors=True)
        shutil.copytree(self.folder / "whole" / name, self.spec(name).folder)
        return self.spec(name).folder

    def kept(self):
        return validation_kept.Kept(self.folder / "kept")

    def run(self, name, method="run", **options):
        """What is said, and the runner."""
        runner = validation_runs.Runner(self.kept(), **options)
        with contextlib.redirect_stdout(io.StringIO()) as said:
            getattr(runner, method)(self.spec(name))
        return said.getvalue(), runner

    def report(self):
        """The text, what is wrong, and what stderr says."""
        with contextlib.redirect_stdout(io.StringIO()), \
            contextlib.redirect_stderr(io.StringIO()) as errors:
            wrong = validation_report.write_report(self.folder, {}, self.kept())
        return (self.folder / "validation.md").read_text(), wrong, errors.getvalue()


def edit_summary(change):
    def edit(folder):
        path = folder / "summary.json"
        data = json.loads(path.read_text())
        change(data)
        path.write_text(json.dumps(data))
    return edit


def edit_table(name, change):
    def edit(folder):
        path = folder / name
        path.write_text(change(path.read_text()))
    return edit


def cut(text):
    lines = text.splitlines(keepends=True)
    return "".join(lines[:len(lines) // 2])


DAMAGE = (
    (WAVE, edit_table("probes.csv", cut), "probes.csv: ends at t = "),
    (WAVE, edit_table("ledger.csv", cut), "ledger.csv: ends at t = "),
    (WAVE, lambda folder: (folder / "probes.csv").unlink(), "/probes.csv: No such file"),
    (WAVE, edit_table("ledger.csv", lambda t: t.replace("momentum_x", "impetus_x")),
     "no column momentum_x"),
    (WAVE, edit_table("probes.csv", lambda t: t + t.splitlines()[-2] + "\n"), "must increase"),
    (WAVE, edit_summary(lambda s: s.pop("steps")), "summary.json: steps is 'missing'"),
    (WAVE, edit_summary(lambda s: s.update(wall_seconds=None)), "wall_seconds is None"),
    (WAVE, edit_summary(lambda s: s.update(derived={})), "c0 is missing"),
    (WAVE, edit_summary(lambda s: s.update(exit_reason="guard", time="late")), "time is 'late'"),
    (WAVE, lambda folder: (folder / "summary.json").write_text("{"),
     "summary.json: not valid JSON"),
    ("taylor-green-25",
     edit_table("ledger.csv", lambda t: "".join(t.splitlines(keepends=True)[:3])),
     "ledger.csv: ends at t = "),
    ("block-20", edit_table("case.cfg", lambda t: t + "wet\n"), "case.cfg"))


def test_report(bench):
    """Whatever is wrong with a run: the report names run and file, and nothing else of it
    changes."""
    sound, wrong, errors = bench.report()
    assert not wrong and not errors, (wrong, errors)
    assert "damaged (0): none" in sound and "finished (3)" in sound
    for name, damage, words in DAMAGE:
        damage(bench.spec(name).folder)
        text, wrong, errors = bench.report()
        bench.restore(name)
        assert len(wrong) == 1 and words in wrong[0], (words, wrong)
        assert f"damaged (1): {name} (" in text and "finished (2)" in text, words
        # at its row and in the list
        assert sum(words in line for line in text.splitlines()) >= 2, words
        assert "Traceback" not in errors, errors
        for other in set(SHORT) - {name}:
            rows = [[line for line in t.splitlines()
                     if line.startswith(f"| {bench.spec(other).words} ")]
                    for t in (sound, text)]
            assert rows[0] == rows[1] and "*" not in "".join(rows[0][:1]), (words, rows)


def test_anew(bench):
    """Each of these is run anew, with its reason in one line; so is a folder without its record."""
    for name, damage, words in DAMAGE:
        folder = bench.spec(name).folder
        damage(folder)
        said, runner = bench.run(name)
        assert not runner.failed, (runner.failed, said)
        lines = said.splitlines()
        assert len(lines) == 2 and f"{name} is damaged: " in lines[0] and words in lines[0] and \
            f"runs {name}" in lines[1], said
        validation_kept.check_ended(Run(folder))
        bench.restore(name)
    job = bench.spec(WAVE)
    whole = job.record_path.read_text()
    for text in ("{", "{}"):
        job.record_path.write_text(text)
        assert bench.run(WAVE)[0].startswith(f"runs {WAVE}")
        assert job.record()["outcome"] == "finished" and json.loads(whole)["case"]


def test_interrupted(bench):
    """An interrupted run goes on, unless the program does not take its checkpoint; that of another
    program begins anew."""
    job = bench.spec(WAVE)

    def interrupt(**more):
        edit_summary(lambda s: s.update(exit_reason="interrupted"))(job.folder)
        job.store({**json.loads(job.record_path.read_text()), "outcome": "started", **more})
    interrupt()
    said, runner = bench.run(WAVE)
    assert said.startswith(f"continues {WAVE}") and said.count("\n") == 1 and not runner.failed, \
        said
    assert json.loads((job.folder / "summary.json").read_text())["restarted_from"]
    interrupt()
    for path in job.folder.glob("*.ckpt"):
        path.write_bytes(path.read_bytes()[:200])
    said, runner = bench.run(WAVE)
    lines = said.splitlines()
    assert len(lines) == 3 and "checkpoint" in lines[1], said
    assert lines[2].startswith(f"runs {WAVE}") and not runner.failed, (said, runner.failed)
    interrupt(program="older")
    said, runner = bench.run(WAVE)
    assert said.startswith(f"runs {WAVE}") and not runner.failed, said
    validation_kept.check_ended(Run(job.folder))
    bench.restore(WAVE)


def test_kept(bench):
    """What is damaged is not kept; without its folder what is kept stands for the run."""
    assert f"kept {WAVE}" in bench.run(WAVE, "store", keep=True)[0]
    archive = bench.folder / "kept" / f"{WAVE}.zip"
    whole = archive.read_bytes()
    (bench.spec(WAVE).folder / "summary.json").write_text("{")
    try:
        bench.run(WAVE, "store", keep=True)
        raise AssertionError("kept, though it is damaged")
    except BadFile as problem:
        assert "not valid JSON" in str(problem) and archive.read_bytes() == whole
    shutil.rmtree(bench.spec(WAVE).folder)
    text, wrong, _ = bench.report()
    assert not wrong and "finished (3)" in text and "1 of the 3 runs are kept" in text, wrong
    archive.unlink()
    bench.restore(WAVE)


def test_unforeseen(bench):
    """An error in the program costs a section, a row or a target; the others stand, and it is
    said."""
    whole = validation_checks.spin, validation_cases.plate, validation_report.balance
    try:
        def fails(*_):
            raise KeyError("lost")
        validation_checks.spin = validation_cases.plate = validation_report.balance = fails
        text, wrong, errors = bench.report()
    finally:
        validation_checks.spin, validation_cases.plate, validation_report.balance = whole
    assert "**Not reported: KeyError: 'lost'.**" in text and \
        "| L/dp = 20 | *KeyError: 'lost'* |" in text
    assert "| KeyError: 'lost' | **not judged** |" in text and \
        f"| {WAVE} | *KeyError: 'lost'* |" in text
    assert wrong and "KeyError: 'lost'" in wrong[0] and "Traceback" in errors and \
        "fails" in errors, wrong
    assert "finished (3)" in text


def main():
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(Path(folder))
        for test in (test_report, test_anew, test_interrupted, test_kept, test_unforeseen):
            test(bench)
    print("damaged runs cost their own lines, and are run anew")


if __name__ == "__main__":
    main()
