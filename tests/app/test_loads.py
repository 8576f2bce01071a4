#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The loads of summary.json, computed again from the rows of the probes."""
import csv
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import PROGRAM

JET = ["cases/verify/open_jet.cfg", "--set", "across=5", "--until", "0.06", "--quiet",
       "--threads", "1", "--set", "plate.load_window=12 ms", "--set"]


def close(a, b):
    return math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-12)


def run(folder, interval):
    subprocess.run([PROGRAM, *JET, f"output.probe_interval={interval}", "--out", folder],
                   check=True, stderr=subprocess.DEVNULL)
    summary = json.loads((folder / "summary.json").read_text())
    rows = list(csv.reader(open(folder / "probes.csv")))
    return summary["loads"], {name: [float(row[k]) for row in rows[1:]]
                              for k, name in enumerate(rows[0])}


def integral(t, v):
    return sum(0.5 * (b - a) * (x + y) for a, b, x, y in zip(t, t[1:], v, v[1:]))


def check(loads, table, windows):
    t = table["time_s"]
    for name in ("plate_fx_N_per_m", "plate_fy_N_per_m", "plate_mz_Nm_per_m"):
        load, v = loads[name], table[name]
        assert load["window"] == [1e-3, 5e-3, 20e-3, 12e-3], load
        assert close(load["impulse_of_run"], integral(t, v)), load
        top = max(range(len(v)), key=lambda k: abs(v[k]))
        assert load["largest_single_row"] == v[top] and load["largest_single_row_time"] == t[top]
        for k, n in enumerate(windows):
            if n is None:
                assert load["largest_mean"][k] is None and load["impulse"][k] is None, load
                continue
            means = [integral(t[i:i + n + 1], v[i:i + n + 1]) / (t[i + n] - t[i])
                     for i in range(len(t) - n)]
            best = max(range(len(means)), key=lambda i: abs(means[i]))
            assert close(load["largest_mean"][k], means[best]), (name, n, load, means[best])
            assert load["from"][k] == t[best], (name, n)
            assert close(load["impulse"][k], means[best] * load["window"][k]), (name, n)


def main():
    with tempfile.TemporaryDirectory() as top:
        loads, table = run(Path(top) / "fine", "0.5 ms")
        check(loads, table, (2, 10, 40, 24))
        # Between rows of 2 ms a window of 1 ms is not known; one of 5 ms becomes two rows.
        loads, table = run(Path(top) / "coarse", "2 ms")
        check(loads, table, (None, 2, 10, 6))
    return 0


if __name__ == "__main__":
    sys.exit(main())
