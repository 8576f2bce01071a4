#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The first cases of tests/fault/random_cases.py: threads, kills, restarts and forks change no
bit."""
import os
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import PROGRAM, ROOT, packages
with packages():
    import h5py  # noqa: F401  the snapshots are compared with it

count = os.environ.get("RANDOM_CASES", "6")
SOLIDS_THAT_MEET = "25"  # a check of the account falls on the step of a checkpoint
command = [sys.executable, ROOT / "tests/fault/random_cases.py", "--builds", f"gcc={PROGRAM}",
           "--no-record"]
sys.exit(max(subprocess.run([*command, *more]).returncode
             for more in (["--count", count], ["--seed", SOLIDS_THAT_MEET])))
