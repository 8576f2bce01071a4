#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Results of the validation that are kept: the report has the same numbers without the run, a
result of another case or a damaged one is not used, and which runs there are to do. Exit 77: a
package is missing."""

import contextlib
import io
import json
import shutil
import sys
import tempfile
import zipfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import packages
with packages():
    import h5py  # noqa: F401  the snapshots need it
    import validation_kept
    import validation_report
    import validation_runs
    from common import program_version
    from runfiles import BadFile
VERSION = program_version()
NAME = "block-20"  # its section reads probes, ledger and snapshots
SHORT = ["ratio=10", "turns=0.05"]


class Bench:
    """A place for runs, kept results and a report of its own."""

    def __init__(self, folder):
        self.folder, self.spec = folder, validation_runs.BY_NAME[NAME]
        for spec in validation_runs.JOBS:
            spec.folder = folder / "runs" / spec.name
        self.spec.sets = list(SHORT)
        self.archive = folder / "kept" / f"{NAME}.zip"

    def kept(self):
        return validation_kept.Kept(self.folder / "kept")

    def run(self, **options):
        runner = validation_runs.Runner(self.kept(), **options)
        with contextlib.redirect_stdout(io.StringIO()) as said:
            runner.run(self.spec)
        return said.getvalue(), runner

    def report(self):
        """The report, and what was printed beside the names of its sections."""
        with contextlib.redirect_stdout(io.StringIO()) as said:
            validation_report.write_report(self.folder, {}, self.kept())
        lines = [line for line in said.getvalue().splitlines()
                 if not line.startswith(("section", "written"))]
        return (self.folder / "validation.md").read_text(), lines

    def rewrite(self, name, change):
        """Changes the text of one file of the archive; change(text) of None removes it."""
        with zipfile.ZipFile(self.archive) as file:
            texts = {n: file.read(n).decode() for n in file.namelist()}
        texts[name] = change(texts.get(name, ""))
        self.archive.write_bytes(validation_kept.archive({n: t for n, t in texts.items()
                                                          if t is not None}))


def rows(text):
    """The rows of the run in all tables, and the targets that it decides."""
    return [line for line in text.splitlines()
            if line.startswith((f"| {NAME} ", "| L/dp = 20 ", "| free rotation"))]


def test_same_numbers(bench):
    """Kept twice: the same bytes. Without the run: the same numbers, and nothing is run."""
    said, runner = bench.run(keep=True)
    assert not runner.failed and f"kept {NAME}: " in said, said
    text, lines = bench.report()
    assert "0 of the 1 runs are kept" in text and not lines, lines
    first = bench.archive.read_bytes()
    assert len(first) <= validation_kept.LARGEST
    assert str(bench.folder).encode() not in b"".join(
        zipfile.ZipFile(bench.archive).read(n) for n in zipfile.ZipFile(bench.archive).namelist())
    bench.archive.unlink()
    bench.run(keep=True)
    assert bench.archive.read_bytes() == first
    shutil.rmtree(bench.spec.folder)
    said, _ = bench.run(keep=True)
    assert said == "" and not bench.spec.folder.exists()
    again, lines = bench.report()
    assert "1 of the 1 runs are kept" in again and not lines
    assert len(rows(text)) == 3 and "not run" not in "".join(rows(text)), rows(text)
    assert rows(again) == rows(text), (rows(again), rows(text))


def test_version(bench):
    """A kept result of another version is used, and the report says of which it is."""
    whole = bench.archive.read_bytes()
    text = rows(bench.report()[0])
    bench.rewrite("summary.json", lambda old: old.replace(VERSION, "0.0.1+old"))
    other, _ = bench.report()
    assert "Program 0.0.1+old (1 runs)" in other and rows(other) == text
    bench.run(again=True)
    newer, _ = bench.report()
    assert f"Program {VERSION} (1 runs)" in newer and "0.0.1+old" not in newer
    shutil.rmtree(bench.spec.folder)
    # One that a guard ended is a result, too, though without numbers.
    bench.rewrite("summary.json", lambda old: old.replace('"finished"', '"guard"'))
    bench.rewrite("measured.json", lambda old: "{}")
    halted, lines = bench.report()
    assert "*failed at t = " in halted and f"unfinished or failed (1): {NAME}" in halted and \
        not lines, lines
    said, _ = bench.run()
    assert said == "", said
    found = {"0.0.1+old": ["a"], "1.0": ["b", "c"]}
    lines = validation_report.what_was_run(validation_report.Report(bench.folder, {}, bench.kept()),
                                           dict(sorted(found.items(), reverse=True)))
    assert "* finished (2): b, c" in lines and "* finished, by 0.0.1+old (1): a" in lines, lines
    bench.archive.write_bytes(whole)


def test_unfinished(bench):
    """The kept result stands in for a run that has not ended; one that has ended comes first."""
    bench.run(again=True)
    summary = bench.spec.folder / "summary.json"
    data = json.loads(summary.read_text())
    data["wall_seconds"] = 4711.0
    summary.write_text(json.dumps(data))
    assert "4711 (1)" in bench.report()[0]
    summary.write_text(json.dumps({**data, "exit_reason": "interrupted"}))
    bench.spec.store({**bench.spec.record(), "outcome": "started"})
    text, _ = bench.report()
    assert "4711 (1)" not in text and "1 of the 1 runs are kept" in text
    said, runner = bench.run(keep=True)
    assert said == "" and not runner.failed
    # Nor is what has not ended, or is quick, kept.
    summary.write_text(json.dumps(data))
    bench.archive.unlink()
    bench.spec.quick = True
    bench.run(keep=True)
    assert not bench.archive.exists()
    bench.spec.quick = False
    summary.write_text(json.dumps({**data, "exit_reason": "interrupted"}))
    try:
        bench.kept().store(bench.spec)
        raise AssertionError("kept, though it has not ended")
    except BadFile as problem:
        assert "exit_reason is interrupted" in str(problem) and NAME in str(problem), problem
    bench.run(keep=True)
    shutil.rmtree(bench.spec.folder)


def test_stale(bench):
    bench.spec.sets = ["ratio=10", "turns=0.04"]
    text, lines = bench.report()
    assert "(what is kept of it is of another case)" in text and "0 of the 0 runs" in text
    assert len(lines) == 1 and f"{NAME}.zip: of another case" in lines[0], lines
    said, _ = bench.run()
    assert f"{NAME}.zip: of another case" in said and f"runs {NAME}" in said, said
    shutil.rmtree(bench.spec.folder)
    bench.spec.sets = list(SHORT)


def test_older(bench):
    """A key that came later, or held what is no longer known, stands at its default in what is
    kept: the result is used. With another value it is of another case."""
    whole = bench.archive.read_bytes()
    for key, line, used in (("suction", None, True), ("sides", "kernel = stamped", True),
                            ("suction", "suction = on", False),
                            ("sides", "interface = auto", True),
                            ("sides", "interface = impedance", True),
                            ("sides", "interface = held", False)):
        def edit(text):
            lines = [old for old in text.splitlines() if not old.startswith(key)]
            assert len(lines) == len(text.splitlines()) - 1, key
            if line:
                lines.insert(lines.index("[numerics]") + 1, line)
            return "\n".join([*lines, ""])
        bench.rewrite("case.cfg", edit)
        text, lines = bench.report()
        assert (lines == []) == used and ("is of another case" in text) != used, (line, lines)
        bench.archive.write_bytes(whole)
    # Which of them had the force held over sub-steps is said.
    for effects, held in (([], False), (["MULTIRATE"], True), (["MULTIRATE", "IMPEDANCE"], False)):
        bench.rewrite("summary.json",
                      lambda text: json.dumps({**json.loads(text), "effects": effects}))
        text, _ = bench.report()
        assert (f"the default of earlier versions (1): {NAME}" in text) == held, effects
        bench.archive.write_bytes(whole)


def test_damage(bench):
    """Whatever is wrong with the archive: one line that names it, and the report goes on
    without."""
    whole = bench.archive.read_bytes()

    def summary(**edit):
        return lambda: bench.rewrite("summary.json",
                                     lambda t: json.dumps({**json.loads(t), **edit}))

    flipped = bytearray(whole)
    flipped[whole.index(b"PK\1\2") // 2] ^= 0x55
    for damage, words in (
            (lambda: bench.archive.write_bytes(whole[:len(whole) // 2]), "not a readable archive"),
            (lambda: bench.archive.write_bytes(bytes(flipped)), "not a readable archive"),
            (lambda: bench.archive.write_bytes(b""), "not a readable archive"),
            (lambda: bench.rewrite("case.cfg", lambda t: None), "holds ledger.csv, measured.json"),
            (lambda: bench.rewrite("../away", lambda t: "x"), "holds ../away"),
            (lambda: bench.rewrite("summary.json", lambda t: t[:99]),
             "summary.json: not valid JSON"),
            (summary(steps="many"), "summary.json: steps is 'many'"),
            (summary(wall_seconds=None), "wall_seconds is None"),
            (lambda: bench.rewrite("summary.json", lambda t: t.replace('"steps"', '"pace"')),
             "steps is 'missing'"),
            (lambda: bench.rewrite("ledger.csv", lambda t: t[:len(t) // 2]),
             "ledger.csv: ends at t = "),
            (summary(exit_reason="running"), "exit_reason is running"),
            (lambda: bench.rewrite("ledger.csv", lambda t: t + "wet\n"), "ledger.csv, line"),
            (lambda: bench.rewrite("measured.json", lambda t: "[" + t),
             "measured.json: not valid JSON")):
        bench.archive.write_bytes(whole)
        damage()
        text, lines = bench.report()
        assert len(lines) == 1 and words in lines[0] and f"{NAME}.zip" in lines[0], (words, lines)
        assert "(what is kept of it is damaged)" in text and "## Bar stretched" in text, words
    assert not (bench.folder / "away").exists()
    said, runner = bench.run()
    assert f"runs {NAME}" in said and not runner.failed, said
    shutil.rmtree(bench.spec.folder)
    bench.archive.write_bytes(whole)


def test_picture(bench):
    """Fields are drawn of snapshots only; without them the picture that there is stays, with its
    origin."""
    def draw(image):
        report = validation_report.Report(bench.folder, {}, bench.kept())
        return " ".join(report.draw("plot_fields", [NAME], image, "Fields", "--time", 0))
    assert "snapshots are not kept" in draw("fields")
    bench.run(again=True)
    path = bench.folder / "img" / "validation-fields.png"
    assert "an earlier picture" not in draw("fields") and path.is_file()
    shutil.rmtree(bench.spec.folder)
    before = path.read_bytes()
    assert f"an earlier picture, of {NAME} by {VERSION}" in draw("fields")
    assert path.read_bytes() == before


def test_thinning():
    """Too large an archive loses rows of a ledger, or columns of probes, that the report does not
    read."""
    table = "time_s,M1_dx_m,M1_dy_m\n" + "".join(f"{k},{k ** 0.5},{k ** 0.3}\n"
                                                 for k in range(4000))

    def packed(name, ledger):
        data = validation_kept.pack(name, {"probes.csv": table, "ledger.csv": ledger})
        with zipfile.ZipFile(io.BytesIO(data)) as file:
            return len(data), file.read("probes.csv").decode(), file.read("ledger.csv").decode()
    size, probes, ledger = packed("sluice", table * 2)
    assert probes == table and len(ledger) < len(table) / 8
    assert ledger.splitlines()[-1] == table.splitlines()[-1]
    size, probes, ledger = packed("gate", table)
    assert size > validation_kept.LARGEST and (probes, ledger) == (table, table)
    size, probes, ledger = packed("plate", table)
    assert probes.startswith("time_s,M1_dy_m\n0,0.0\n1,1.0\n") and probes.count("\n") == 4001
    small = table[:table.index("\n99,") + 1]
    with zipfile.ZipFile(io.BytesIO(validation_kept.pack("plate", {"probes.csv": small}))) as file:
        assert file.read("probes.csv").decode() == small


def test_archive():
    """Its bytes depend on names and texts only: neither on their order nor on the clock."""
    data = validation_kept.archive({"b": "1", "a": "2"})
    assert data == validation_kept.archive({"a": "2", "b": "1"})
    with zipfile.ZipFile(io.BytesIO(data)) as file:
        assert [(e.filename, e.date_time[0]) for e in file.infolist()] == [("a", 1980), ("b", 1980)]


def test_choice():
    """--only: beginnings, or one run with `=`; without it the longest runs come first."""
    def names(only, quick=False):
        return [spec.name for spec in validation_runs.chosen(only, quick)]
    assert names("=gate") == ["gate"] and len(names("gate")) > 10
    assert names("=plate,gate-1mm-k,=plate") == ["plate", "gate-1mm-kappa10"]
    for only, quick in (("=gat", False), ("nothing", False), ("=gate", True)):
        try:
            names(only, quick)
            raise AssertionError(f"{only} names no run")
        except BadFile as problem:
            assert only in str(problem), problem
    quick = names("", True)
    # both integrators of the paper
    for case in ("cantilever", "plate", "gate", "baffle", "sluice"):
        texts = [" ".join(validation_runs.BY_NAME[name].sets) for name in quick
                 if name.startswith(case)]
        assert any("symplectic" in text for text in texts), case
        plain = "integrator" if case == "cantilever" else "="  # its file says Verlet
        assert any("verlet" in text or plain not in text for text in texts), case


def test_what_is_meant():
    """Of an effective case counts what results depend on."""
    case = "# 0.1.0\ntitle = a\ndp = 0.001 m\n[numerics]\nskin = 0.15\ncfl = 0.4\n"
    same = validation_kept.physics(case)
    assert same == ["dp = 0.001 m", "[numerics]", "cfl = 0.4"], same
    assert validation_kept.physics(case.replace("0.15", "0.6").replace("= a", "= b")) == same
    assert validation_kept.physics(case.replace("cfl = 0.4", "cfl = 0.2")) != same


def main():
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(Path(folder))
        for test in (test_same_numbers, test_version, test_unfinished, test_stale, test_older,
                     test_damage,
                     test_picture):
            test(bench)
    test_thinning()
    test_archive()
    test_choice()
    test_what_is_meant()
    print("kept results stand for their runs, and damaged or stale ones do not")


if __name__ == "__main__":
    main()
