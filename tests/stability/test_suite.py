#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The quick form of the hard cases: each does what the table says. And runs that are kept are done
anew where the table has changed."""
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import PROGRAM, TOOLS
import stability


def test_kept():
    scene = {"name": "a beam", "case": "beam.cfg", "quick": ["end_time=0.001 s"]}
    with tempfile.TemporaryDirectory() as top:
        job = stability.job_of(scene, "quick", Path(top))
        first, _ = stability.measured(job)
        assert job.record()
        scene["quick"] = ["end_time=0.002 s"]
        job = stability.job_of(scene, "quick", Path(top))
        assert not job.record()
        second, _ = stability.measured(job)
        # A run ends with the first step at or after its end; a step is just below 1 ms.
        assert 0.001 <= first["time"] < 0.002 <= second["time"] < 0.003, (first, second)


os.environ["SPHFSI"] = str(PROGRAM)
test_kept()
sys.exit(subprocess.run([sys.executable, str(TOOLS / "report/stability.py"), "--quick"],
                        check=False).returncode)
