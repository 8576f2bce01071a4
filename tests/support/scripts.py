# SPDX-License-Identifier: MIT
"""What tests in Python share: where the project and its program are, its tools as modules, and the
end of a test for which a package is missing."""

import contextlib
import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TOOLS = ROOT / "tools"
PYTHON = ROOT / "python"  # the package
PACKAGES = ("cffi", "h5py", "matplotlib", "numpy", "PIL", "tomllib")
PROGRAM = Path(os.environ.get("SPHFSI", ROOT / "sphfsi")).resolve()

sys.dont_write_bytecode = True
sys.path[:0] = map(str, (TOOLS, TOOLS / "report", TOOLS / "dev"))
if os.environ.get("SPHFSI_PACKAGE") != "installed":
    sys.path.insert(0, str(PYTHON))


@contextlib.contextmanager
def packages():
    """Around imports: a package that is not there ends the test as skipped, naming it; a module of
    the project that is not there fails it."""
    try:
        yield
    except ModuleNotFoundError as missing:
        if missing.name in PACKAGES:
            print(f"{missing.name} is missing")
            sys.exit(77)
        raise
    except SystemExit as end:
        if "is missing; pip install" in str(end.code):  # so a tool ends without its packages
            print(end.code)
            sys.exit(77)
        raise
