#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Nothing switches at the density of water: a gate and a plate between waters move by at most 1e-6
of their largest displacement more or less when their density is 1e-6 below or above it."""
import csv
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import PROGRAM, ROOT

CASES = (("gate.cfg", "gate", ("E=0.5 MPa",)),
         ("thin.cfg", "plate", ("right=0.05", "end_time=0.05")))
SHARE = 1e-6  # of the largest displacement: no more than the change itself


def motion(case, integrator, scheme, settings):
    with tempfile.TemporaryDirectory() as folder:
        command = [str(PROGRAM), str(ROOT / "tests/stability" / case), "--quiet", "--threads", "1",
                   "--out",
                   f"{folder}/run", "--set", f"integrator={integrator}", "--set",
                   f"scheme={scheme}"]
        for setting in settings:
            command += ["--set", setting]
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
        with open(f"{folder}/run/probes.csv", encoding="utf-8") as file:
            return [float(row["M1_dx_m"]) for row in csv.DictReader(file)]


failed = 0
for case, body, settings in CASES:
    for integrator in ("symplectic", "verlet", "leapfrog"):
        for scheme in ("paper", "standard"):
            runs = [motion(case, integrator, scheme, (*settings, f"{body}.density={density}"))
                    for density in (999.999, 1000, 1000.001)]
            largest = max(map(abs, runs[1]))
            below, above = (max(abs(a - b) for a, b in zip(run, runs[1])) / largest
                            for run in (runs[0], runs[2]))
            print(f"{case}, {integrator}, {scheme}: {below:.2g} below, {above:.2g} above")
            failed += not (0 < below < SHARE and 0 < above < SHARE)
sys.exit(failed > 0)
