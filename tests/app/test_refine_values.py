#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What tools/refine.py reports, computed again from the files of its runs; and what it leaves when
they are lost."""
import csv
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import packages
with packages():
    import cffi  # noqa: F401  the package needs it
    import numpy  # noqa: F401

RATIO = 1.5
PLATE = ["cases/cantilever.cfg", "--set", "ratio=8", "--until", "0.02"]


def refine(out, *more, status=0):
    done = subprocess.run([sys.executable, "tools/refine.py", "-n", "3", "--ratio", str(RATIO),
                           *PLATE, "--threads", "1",
                           "--quiet", "--out", str(out), *more], capture_output=True, text=True)
    assert done.returncode == status, (done.returncode, done.stderr)
    return done


def columns(path):
    rows = list(csv.reader(open(path)))
    return {name: [float(row[k]) for row in rows[1:]] for k, name in enumerate(rows[0])}


def close(a, b):
    return math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-15)


def mean(table, name, end):
    """Trapezoidal mean of the last quarter of the time."""
    rows = [(t, v) for t, v in zip(table["time_s"], table[name]) if 0.75 * end <= t <= end]
    whole = sum(0.5 * (t - s) * (v + w) for (s, v), (t, w) in zip(rows, rows[1:]))
    return whole / (rows[-1][0] - rows[0][0])


def check(folder, said):
    report = json.loads((folder / "refine.json").read_text())
    dp = report["dp"]
    assert len(dp) == 3 and close(dp[1] / dp[0], RATIO) and close(dp[2] / dp[1], RATIO), dp
    runs = [folder / f"dp-{d:.6g}" for d in dp]
    steps = [runs[1], folder / "step-0.707", folder / "step-0.5"]
    assert all(run.is_dir() for run in runs + steps), list(folder.iterdir())
    checked = extrapolated = 0
    for file, results in (("probes.csv", report), ("ledger.csv", report["ledger"])):
        tables = [columns(run / file) for run in runs + steps]
        end = min(table["time_s"][-1] for table in tables)
        for name, of_column in results.items():
            if name not in tables[0] or "mean" not in of_column:
                continue
            got = of_column["mean"]
            fine, middle, coarse, _, longer, shorter = (mean(table, name, end) for table in tables)
            assert all(map(close, got["values"], (fine, middle, coarse))), (name, got)
            total = math.hypot(got["spacing"]["band"], got["step"]["band"])
            assert close(got["band"], total) and got["scatter"] == 0, (name, got)
            if got["band"] > abs(fine) or got["spacing"]["order"] is None:
                assert got["extrapolated"] is None, (name, got)
            limit = fine
            for part, (a, b, c), ratio in ((got["spacing"], (fine, middle, coarse), RATIO),
                                           (got["step"], (shorter, longer, middle), 2**0.5)):
                if part["order"] is None:
                    assert part["why_no_order"], (name, part)
                    continue
                order = math.log((c - b) / (b - a)) / math.log(ratio)
                assert math.isclose(part["order"], order, rel_tol=1e-9), (name, part, order)
                limit += a - (a if part is got["spacing"] else c) + (a - b) / (ratio**order - 1)
            if got["spacing"]["order"] is not None:
                order = got["spacing"]["order"]
                error = (2.45 - 0.425 * order) * abs(middle - fine) / (RATIO**order - 1)
                assert math.isclose(got["spacing"]["band"], 1.645 / 1.960 * error,
                                    rel_tol=1e-9), (name, got)
            if got["extrapolated"] is not None:
                assert math.isclose(got["extrapolated"], limit, rel_tol=1e-9), (name, got, limit)
                extrapolated += 1
            checked += 1
    assert checked >= 4 and extrapolated, checked
    # The table is the same, rounded.
    lines = said.splitlines()
    at = lines.index("M1_dy_m")
    for line in lines[at + 1:at + 3]:
        word, coarse, middle, fine, limit = line.split()[:5]
        of = report["M1_dy_m"][word]
        assert [float(fine), float(middle), float(coarse)] == [float(f"{v:.5g}")
                                                               for v in of["values"]], line
        none = of["extrapolated"] is None
        assert limit == ("none" if none else f"{of['extrapolated']:.5g}"), line
        assert line.endswith("; no result") == (of["band"] > abs(of["values"][0])), line
    assert report["off_lattice"] == any("off the lattice" in line for line in lines)
    return report


def check_without_library(folder):
    """One sentence, not a traceback, where nothing is built."""
    for part in "tools", "python":
        shutil.copytree(part, folder / part, ignore=shutil.ignore_patterns("_lib"))
    named = {k: v for k, v in os.environ.items() if k not in ("SPHFSI_LIBRARY", "PYTHONPATH")}
    said = subprocess.run([sys.executable, folder / "tools" / "refine.py", PLATE[0]],
                          capture_output=True, text=True, env=named)
    assert said.returncode == 1 and said.stderr.startswith("refine: there is no libsphfsi.so")
    assert said.stderr.count("\n") == 1, said.stderr


def main():
    with tempfile.TemporaryDirectory() as top:
        folder = Path(top) / "r"
        report = check(folder, refine(folder).stdout)
        # Nothing is run again, and nothing changes.
        again = refine(folder)
        assert json.loads((folder / "refine.json").read_text()) == report
        # A file that is lost: refused by name, and no half of a report is left.
        lost = sorted(folder.glob("dp-*"))[0] / "ledger.csv"
        kept = lost.read_bytes()
        before = (folder / "refine.json").read_bytes()
        lost.unlink()
        said = refine(folder, status=2).stderr
        assert str(lost) in said, said
        assert (folder / "refine.json").read_bytes() == before
        assert not list(folder.glob("*.part")), list(folder.glob("*.part"))
        lost.write_bytes(kept)
        assert refine(folder).stdout == again.stdout
        check_without_library(Path(top))
    return 0


if __name__ == "__main__":
    sys.exit(main())
