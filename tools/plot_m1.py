#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws what a probe recorded against time, for several runs, with the references of their case.
M1 is the monitored point of the article, a probe of its cases.
Each column has a panel, and below it its difference from the references; tools/plot_probes.py draws
all."""

import plot_probes
import runfiles
from sphfsi import draw_probes

EXAMPLE = """example:
  tools/plot_m1.py runs/gate runs/gate-dp0.5mm --out m1.pdf --csv m1.csv
  tools/plot_m1.py runs/gate --column M1_dy_m --reference lab.csv --label "Lab, test 3"
"""


def main():
    args = plot_probes.arguments(__doc__, EXAMPLE, "those that have references", "m1.png")
    plot_probes.plot(args, draw_probes.choose_columns, draw_probes.draw_figure, "m1.png")


if __name__ == "__main__":
    runfiles.run_tool(main)
