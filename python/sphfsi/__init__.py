# SPDX-License-Identifier: MIT
"""Water and elastic structures in two dimensions by smoothed particle hydrodynamics.

    import sphfsi
    case = sphfsi.Case("cases/gate.cfg", dp="1 mm", gate={"young": "8 MPa"})
    run = case.run(until=0.1)
    run.plot_probes()

All numbers are in SI units; extensive quantities are per metre of depth. `sphfsi.open` reads the
folder of a run, finished or not, with numpy and h5py alone; what computes also needs cffi and the
library.
"""
from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from .files import BadFile, Error

if TYPE_CHECKING:
    from .case import Case, Explanation, Preview, new, templates
    from .library import CaseWarning, Guard, InputError, Interrupted, version
    from .run import Run, Snapshot, animate, open, plot_fields, plot_probes
    from .simulation import Particles, Simulation

# Loaded when they are asked for: reading needs no library, drawing needs matplotlib.
_HOME = {
    "case": ("Case", "Explanation", "Preview", "new", "templates"),
    "library": ("CaseWarning", "Guard", "InputError", "Interrupted", "version"),
    "run": ("Run", "Snapshot", "animate", "open", "plot_fields", "plot_probes"),
    "simulation": ("Particles", "Simulation"),
}
_MODULE_OF = {name: module for module, names in _HOME.items() for name in names}
__all__ = ["BadFile", "Error", *_MODULE_OF]


def __getattr__(name: str):
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'sphfsi' has no attribute '{name}'")
    return getattr(import_module("." + _MODULE_OF[name], __name__), name)


def __dir__() -> list[str]:
    return sorted(__all__)
