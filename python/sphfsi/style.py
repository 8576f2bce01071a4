# SPDX-License-Identifier: MIT
"""What all figures share: colours, style, units that read well."""
from __future__ import annotations

# Okabe and Ito's palette without black, which is kept for measurements, and without yellow, which
# is too faint for lines on white.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00"]
STYLE = {
    "figure.dpi": 100, "savefig.dpi": 300,
    "font.size": 9, "axes.labelsize": 9, "axes.titlesize": 9, "legend.fontsize": 8,
    "xtick.labelsize": 8, "ytick.labelsize": 8, "mathtext.fontset": "dejavusans",
    "lines.linewidth": 1.3, "axes.linewidth": 0.7, "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5), "axes.formatter.use_mathtext": True,
    "xtick.direction": "in", "ytick.direction": "in", "xtick.top": True, "ytick.right": True,
    "legend.frameon": False, "legend.handlelength": 2.4, "pdf.fonttype": 42,
}
WIDTH = 7.2  # inches: the text width of a two-column journal page


def scaled_unit(unit, size):
    """Factor and name of the unit in which values of about this size (SI) read well."""
    scales = {"m": [(1e6, "µm", 2e-4), (1e3, "mm", 1.0)], "Pa": [(1, "Pa", 2e2), (1e-3, "kPa", 5e5),
              (1e-6, "MPa", 5e8), (1e-9, "GPa", float("inf"))]}
    return next(((f, name) for f, name, limit in scales.get(unit, []) if size < limit), (1.0, unit))
