#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the blocks of python/TUTORIAL.md, one after the other, and looks at what they leave. Exit
77: a package is missing."""

import contextlib
import io
import os
import re
import sys
import tempfile
import warnings
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import ROOT, packages
with packages():
    import cffi  # noqa: F401  the package needs it
    import h5py  # noqa: F401
    import matplotlib
    import numpy  # noqa: F401

matplotlib.use("Agg")
os.environ.setdefault("OMP_NUM_THREADS", "1")


def blocks(path):
    """The Python blocks of a text with their first lines."""
    text = path.read_text(encoding="utf-8")
    for found in re.finditer(r"^```python\n(.*?)^```$", text, re.S | re.M):
        yield text[:found.start()].count("\n") + 2, found[1]


def main():
    import sphfsi
    path = ROOT / "python" / "TUTORIAL.md"
    names, said = {}, io.StringIO()
    warnings.simplefilter("error", sphfsi.CaseWarning)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for line, block in blocks(path):
            with contextlib.redirect_stdout(said):
                exec(compile("\n" * (line - 1) + block, str(path), "exec"), names)
        for name in ("post.svg", "tip.png", "fields.png", "post.gif", "runs/post/summary.json"):
            assert Path(name).stat().st_size > 500, name
        os.chdir(ROOT)
    text = said.getvalue()
    print(text)
    assert "finished" in text and "1000000 Pa" in text and "paddle at -0.025" in text, text
    assert "unknown key `yung`" in text and "young" in text, text
    assert names["simulation"].time == 0.1
    print("the tutorial runs")


if __name__ == "__main__":
    main()
