#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The quick form of the hard cases: each does what the table says."""
import subprocess
import sys
from pathlib import Path

TOOL = Path(__file__).resolve().parent.parent.parent / "tools" / "stability.py"
sys.exit(subprocess.run([sys.executable, str(TOOL), "--quick"], check=False).returncode)
