#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What tools/refine.py reports, computed again from the files of its runs; and what it leaves when
they are lost."""
import csv
import json
import math
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


def measures(table, name):
    """Value at the end, of largest magnitude, and mean of the last quarter of the time."""
    values, times = table[name], table["time_s"]
    late = [v for v, t in zip(values, times) if t >= 0.75 * times[-1]]
    peak = 0.0
    for v in values:
        peak = v if abs(v) > abs(peak) else peak
    return {"final": values[-1], "peak": peak, "settled": sum(late) / len(late)}


def close(a, b):
    return math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-15)


def check(folder, said):
    report = json.loads((folder / "refine.json").read_text())
    dp = report["dp"]
    assert len(dp) == 3 and close(dp[1] / dp[0], RATIO) and close(dp[2] / dp[1], RATIO), dp
    runs = [folder / f"dp-{d:.6g}" for d in dp]
    assert all(run.is_dir() for run in runs), runs
    checked = 0
    for file, results in (("probes.csv", report), ("ledger.csv", report["ledger"])):
        tables = [columns(run / file) for run in runs]
        for name, of_column in results.items():
            if name not in tables[0]:
                continue
            for measure, got in of_column.items():
                values = [measures(table, name)[measure] for table in tables]
                assert all(map(close, got["values"], values)), (name, measure, got["values"],
                                                                values)
                fine, middle, coarse = values
                if got["band"] > abs(fine):  # no result
                    assert got["extrapolated"] is None, (name, measure, got)
                elif got["order"] is None:
                    assert close(got["extrapolated"], fine), (name, measure, got)
                if got["order"] is None:
                    assert got["why_no_order"], (name, measure, got)
                    continue
                order = math.log((coarse - middle) / (middle - fine)) / math.log(RATIO)
                assert math.isclose(got["order"], order, rel_tol=1e-6), (name, measure, got, order)
                trusted = RATIO**min(order, 2) - 1
                if got["extrapolated"] is not None:
                    assert math.isclose(got["extrapolated"], fine + (fine - middle) / trusted,
                                        rel_tol=1e-6)
                assert math.isclose(got["band"], 1.25 * abs(fine - middle) / trusted, rel_tol=1e-6)
            checked += 1
    assert checked >= 12, checked
    # The table is the same, rounded.
    lines = said.splitlines()
    at = lines.index("M1_dy_m")
    for line in lines[at + 1:at + 4]:
        word, coarse, middle, fine, limit = line.split()[:5]
        of = report["M1_dy_m"][word]
        assert [float(fine), float(middle), float(coarse)] == [float(f"{v:.5g}")
                                                               for v in of["values"]], line
        unresolved = of["extrapolated"] is None
        assert limit == ("none" if unresolved else f"{of['extrapolated']:.5g}"), line
        assert line.endswith("; no result") == unresolved, line
    assert report["off_lattice"] == any("off the lattice" in line for line in lines)
    return report


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
    return 0


if __name__ == "__main__":
    sys.exit(main())
