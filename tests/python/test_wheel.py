#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Builds the wheel, installs it in a fresh virtual environment and tests it there. Exit 77: no
network, or no pip, no cmake."""

import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PIP = ["-m", "pip", "--disable-pip-version-check", "--quiet", "--retries", "1", "--timeout", "15"]
NEEDS = ["scikit-build-core>=0.8", "numpy", "h5py", "cffi", "matplotlib"]


def skip(why):
    print(why)
    sys.exit(77)


def main():
    if not shutil.which("cmake"):
        skip("cmake is missing")
    with tempfile.TemporaryDirectory() as folder:
        python = Path(folder, "venv", "bin", "python")
        made = subprocess.run([sys.executable, "-m", "venv", Path(folder, "venv")],
                              capture_output=True,
                              text=True)
        if made.returncode:
            skip("no virtual environment can be made here: " +
                 made.stdout.strip().replace("\n", " ")[:80])
        got = subprocess.run([python, *PIP, "install", "--only-binary", ":all:", *NEEDS],
                             capture_output=True, text=True)
        if got.returncode:
            skip("pip reaches no package index")
        wheels = Path(folder, "wheels")
        jobs = {**os.environ, "CMAKE_BUILD_PARALLEL_LEVEL": "2"}
        subprocess.run([python, *PIP, "wheel", "--no-build-isolation", "--no-deps", "-w", wheels,
                        "-C",
                        f"build-dir={folder}/build", ROOT], check=True, env=jobs)
        wheel, = wheels.glob("sphfsi-*.whl")
        names = zipfile.ZipFile(wheel).namelist()
        assert "-py3-none-" in wheel.name, wheel.name
        assert "sphfsi/_lib/libsphfsi.so" in names and "sphfsi/_lib/sphfsi.h" in names, names
        assert "sphfsi/py.typed" in names and not any("test" in name for name in names), names
        subprocess.run([python, *PIP, "install", "--no-deps", wheel], check=True)
        env = {key: value for key, value in os.environ.items()
               if key not in ("SPHFSI_LIBRARY", "PYTHONPATH")}
        env["SPHFSI_PACKAGE"] = "installed"
        for test in ("test_package.py", "test_tutorial.py"):
            subprocess.run([python, ROOT / "tests" / "python" / test], check=True, env=env)
        subprocess.run([python.parent / "sphfsi", "--version"], check=True)


if __name__ == "__main__":
    main()
