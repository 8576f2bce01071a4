#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The validation: its measures against curves of known answer, what it repeats and what it does
not, and what it says of runs and references that are missing or broken. Exit 77: a package is
missing."""

import json
import math
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import ROOT, packages
with packages():
    import tomllib
    import h5py  # noqa: F401  the snapshots need it
    import numpy as np
    import metrics
    import validation
    from runs import Job, program_hash
    from runfiles import BadFile, Reference, Run, read_table


def refuses(words, function, *arguments):
    """The function complains in a sentence that has all the words in it."""
    try:
        function(*arguments)
    except BadFile as problem:
        assert all(word in str(problem) for word in words), (words, str(problem))
        return
    raise AssertionError(f"accepted, though {' '.join(words)}")


def near(found, wanted, tolerance):
    assert abs(found - wanted) <= tolerance, (found, wanted)


def test_oscillation():
    """Period, drift and loss of a damped sine that is 1 % slow; the sampling bounds what is
    found."""
    time = np.linspace(0, 1, 2001)
    value = 0.02 * np.exp(-0.02 * time) * np.sin(2 * np.pi * time / 0.2525)
    found = metrics.oscillation(time, value, 0.25)
    near(found["first"], 0.2525, 1e-5)
    near(found["mean"], 0.2525, 1e-5)
    near(found["drift"], 360 * (found["mean"] / 0.25 - 1) * 3.5, 0.05)  # seven crossings in 1 s
    near(found["loss"], 1 - math.exp(-0.02), 2e-4)
    near(found["amplitude"], 0.02, 1e-4)
    try:
        metrics.oscillation(time[:300], value[:300], 0.25)
        raise AssertionError("half a period has no period")
    except BadFile:
        pass


def test_fits():
    time = np.linspace(0, 5, 501)
    omega, decay = metrics.damped_sine(time, 3 * np.exp(-0.1 * time) * np.cos(5.4 * time + 1), 5.2)
    near(omega, 5.4, 1e-3)
    near(decay, 0.1, 2e-3)
    near(metrics.strongest(time, 2 + np.sin(2 * np.pi * 7 * time)), 7, 0.05)


def relaxed_elastica(load, n=200):
    """Tip of a cantilever of length 1 that carries the weight `load` = w L^3/D, spread evenly and
    always downwards: theta'' = -load (1 - s) cos theta, theta(0) = theta'(1) = 0, by central
    differences and Newton's method."""
    s, step, angle = np.linspace(0, 1, n + 1), 1 / n, np.zeros(n + 1)
    for _ in range(30):
        rest, slope = np.zeros(n + 1), np.zeros((n + 1, n + 1))
        rest[0], slope[0, 0] = angle[0], 1
        for k in range(1, n + 1):
            right = angle[k + 1] if k < n else angle[n - 1]  # theta'(1) = 0
            rest[k] = angle[k - 1] - 2 * angle[k] + right + \
                step**2 * load * (1 - s[k]) * np.cos(angle[k])
            slope[k, k] = -2 - step**2 * load * (1 - s[k]) * np.sin(angle[k])
            slope[k, k - 1] += 1
            slope[k, min(k + 1, 2 * n - k - 1)] += 1
        angle -= np.linalg.solve(slope, rest)
    middle = 0.5 * (angle[1:] + angle[:-1])
    return np.cos(middle).sum() * step, -np.sin(middle).sum() * step


def test_exact_solutions():
    """Stoker's bore of Sec. 3.4; the elastica of the accuracy study by another solution,
    which is held against the linear beam."""
    depth, speed = metrics.wet_bed_bore(0.15, 0.03)
    near(depth, 0.0762, 5e-5)
    near(speed, 1.150, 5e-4)
    x, y = relaxed_elastica(0.01)
    near(y, -0.01 / 8, 1e-7)
    near(x, 1, 1e-5)
    errors = tomllib.loads((ROOT / "tools/report/accuracy.toml").read_text())["case"]["elastica"]
    wanted = next(error for error in errors["error"] if error["kind"] == "tip")
    x, y = relaxed_elastica(5, n=800)
    near(x, wanted["x"], 1e-6)
    near(y, wanted["y"], 1e-6)


def test_distances():
    random = np.random.default_rng(2)
    a, b = random.uniform(0, 1, (300, 2)), random.uniform(0.5, 1.5, (400, 2))
    plain = np.minimum(0.2, np.hypot(*(a[:, None] - b[None]).transpose(2, 0, 1)).min(axis=1))
    assert np.array_equal(metrics.nearest(a, b, 0.2), plain)
    x = np.array([[0.05, 0.1], [0.05, 0.3], [0.45, 0.2]])
    assert metrics.surface_height(x, 0.1, np.array([0.05, 0.25, 0.45])).tolist() == [0.35, 0, 0.25]


def test_tables(folder):
    """What is no number is refused with its place, in references and probes; references go on in
    time, as all shipped ones do, unless their points are to be sorted. What a guard stopped may end
    with nan."""
    path, summary = folder / "probes.csv", folder / "summary.json"

    def curve(**options):
        return Reference("", path, "lab", "lab", **options)
    for value in ("nan", "inf", "-inf"):
        path.write_text(f"# made up\ntime_s,value\n0,1\n0.1,{value}\n")
        for function, *arguments in ((read_table, path), (curve,),
                                     (Run(folder).table, "probes.csv")):
            refuses(["probes.csv, line 4", f"value is {value}", "finite"], function, *arguments)
    summary.write_text('{"exit_reason": "guard"}')
    assert np.isinf(Run(folder).table("probes.csv")["value"][-1])
    for rows in ("0.2,1\n0.1,2\n", "0.1,1\n0.1,2\n"):
        path.write_text("time_s,value\n" + rows)
        refuses(["probes.csv, row 2", "time_s is 0.1 after 0."], curve)
        assert curve(sort=True).time[0] == 0.1
    for shipped in validation.REFERENCES.glob("*.csv"):
        table, _ = read_table(shipped)
        if "time_s" in table and len(table) == 2:
            Reference("", shipped, shipped.stem, shipped.stem)


def test_runner(folder):
    """Finished runs of the same case stay; another setting runs anew; an interrupted one goes
    on; what is kept of a run counts until its case changes."""
    job = Job(folder / "sluice-tiny", ROOT / "cases" / "still_water.cfg",
              ["dp=2 cm", "wall=8 cm", "end_time=20 ms"])
    validation.FIGURES["sluice"] = lambda run: {"rows": len(run.table("ledger.csv")["time_s"])}
    found = validation.run_job(job)
    assert found["outcome"] == "finished" and found["rows"] > 1 and found["steps"] > 1, found
    summary = job.folder / "summary.json"

    def edit(**more):
        job.store({**json.loads(job.record_path.read_text()), **more})
    before = summary.stat().st_mtime_ns
    assert validation.run_job(job) == found and summary.stat().st_mtime_ns == before
    edit(program="older")
    assert not job.record()
    edit(program=program_hash(), outcome="started")
    assert validation.run_job(job)["outcome"] == "finished" and \
        json.loads(summary.read_text())["restarted_from"]
    job.sets[2] = "end_time=1 ms"
    assert not job.record() and validation.definition_hash(job) != found["definition"]
    validation.run_job(job)
    assert 1e-3 <= json.loads(summary.read_text())["time"] < 2e-3
    job.sets.append("water.no_such_key=1")
    assert validation.run_job(job) is None


def test_report(folder):
    """Without runs every section stands and says so; a run that a guard stopped is shown as
    stopped; what is measured is judged."""
    validation.REPORT = folder / "validation.md"
    exact = validation.deflections()[0]
    stopped = {"name": "gate", "version": "v", "outcome": "unstable", "message": "too fast",
               "time": 0.25}
    plate = {"name": "plate", "version": "v", "outcome": "finished", "mean": 1.05 * exact,
             "std": -0.019 * exact, "half": -0.06 * exact, "fast": 1e-9, "peak": 2 * exact,
             "peak_at": 0.01, "frequency": 270.0, "steps": 5, "solid_substeps": 50,
             "wall_seconds": 1.0, "threads": 1, "play": 80.0, "lost": 1.0, "gain": 0.1,
             "momentum_x": 0.0, "momentum_y": 0.0, "mass": 0.0, "density": 0.01}
    fine = {**plate, "name": "plate-3.125mm-leapfrog", "mean": 1.01 * exact}
    validation.write_report({row["name"]: row for row in (stopped, plate, fine)})
    text = validation.REPORT.read_text()
    for title in validation.SECTIONS:
        assert f"## {title}" in text, title
    assert "stopped at t = 0.25 s: too fast" in text and "*Not run.*" in text
    for row in ("within 4 % of 2-D elasticity, symplectic | +5.00 % | **missed**",
                "2 % (standard deviation), symplectic | 1.81 % | met",
                "2 % (half of the range), symplectic | 5.71 % | **missed**",
                "closer to 2-D elasticity at half the spacing | +1.00 % |",
                "no water pressed into bodies or walls, dp = 1 mm, Verlet | baffle-verlet has not"):
        assert row in text, (row, text)


def main():
    test_oscillation()
    test_fits()
    test_exact_solutions()
    test_distances()
    with tempfile.TemporaryDirectory() as folder:
        for name in ("report", "tables"):
            (Path(folder) / name).mkdir()
        test_tables(Path(folder) / "tables")
        test_runner(Path(folder))
        test_report(Path(folder) / "report")
    print("the validation measures what it says and shows what is missing")


if __name__ == "__main__":
    main()
