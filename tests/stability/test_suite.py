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
        first, _ = stability.Run(scene, "quick", Path(top)).measure()
        assert stability.Run(scene, "quick", Path(top)).known()
        scene["quick"] = ["end_time=0.002 s"]
        assert not stability.Run(scene, "quick", Path(top)).known()
        second, _ = stability.Run(scene, "quick", Path(top)).measure()
        assert (first["time"], second["time"]) == (0.001, 0.002), (first["time"], second["time"])


os.environ["SPHFSI"] = str(PROGRAM)
test_kept()
sys.exit(subprocess.run([sys.executable, str(TOOLS / "report/stability.py"), "--quick"],
                        check=False).returncode)
