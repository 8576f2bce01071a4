#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The lattice-Boltzmann reference of a cylinder: in a wide stream at Re = 20 the drag is near that
of Dennis and Chang (1970), and there is no lift. Exit 77: a package is missing."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "support"),
                str(Path(__file__).resolve().parents[2] / "cases" / "reference")]
from scripts import packages
with packages():
    import cylinder_lattice_boltzmann as lattice


def main():
    t, drag, lift = lattice.run(20, 6, 8, 20, 20, 45)
    late = t > 38
    print(f"drag {drag[late].mean():.3f} +- {drag[late].std():.3f}, lift {lift[late].mean():.3f}")
    assert abs(drag[late].mean() / 2.05 - 1) < 0.1
    assert abs(lift[late].mean()) < 0.01
    print("ok")


if __name__ == "__main__":
    main()
