#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The stability map: which plates it leaves out, and what its report counts."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import TOOLS
sys.path.insert(0, str(TOOLS))
import stability_map as m


def test_statics():
    # The plate of tests/stability/oneside.cfg has D = 0.458 N m and bends by 8.9 mm; a tenth of it
    # is 12 mm.
    young = 0.458 * 12 * (1 - 0.3**2) / 0.015**3
    assert m.statics(1, 3, 1, young) == ""
    assert m.statics(1, 3, 1, young * 8.9 / 12.2) == "bends"
    assert m.statics(1, 3, 2, young * 8.9 / 12.2) == ""  # water behind it carries a part
    # Greenhill: rho g t L^3 = 7.837 D for a dry column
    heavy = 1e3 * 9.81 * 0.015 * 0.12**3 / m.GREENHILL / 0.458
    assert m.statics(0.99 / heavy, 3, 1, young) == ""
    assert m.statics(1.01 / heavy, 3, 1, young) == "buckles"
    assert m.statics(0.01, 20, 1, 8.5e3) == "is crushed"


def row(result="finished", gain=0.0, in_run=0.0):
    values = (0.3, 5, 1, "verlet", "paper", 2.5, 1e6, result, 0.05, gain, "interface", in_run)
    return dict(zip(m.COLUMNS, values))


def test_report():
    rows = [row(), row(gain=0.02, in_run=0.001), row(gain=0.2, in_run=0.18), row("stopped"),
            row("bends")]
    assert [m.judge(r) for r in rows] == ["passes", "passes", "gains", "stopped", "left out"]
    text = m.report(rows)
    assert "Of 4 plates **1 were stopped, and 1 gained more" in text, text
    assert "1 more gained 1 % of the energy in play" in text, text
    assert "| 0.3 | 5 | 1 | verlet | paper | 2.5 | 18 % | interface |" in text, text
    assert "1 more cannot stand" in text and "1 bend" in text, text


def test_grid():
    kept = m.load()
    keys = {tuple(r[name] for name in m.COLUMNS[:6]) for r in kept}
    assert len(keys) == len(kept) <= m.grid_size()


test_statics()
test_report()
test_grid()
