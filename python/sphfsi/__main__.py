# SPDX-License-Identifier: MIT
"""python3 -m sphfsi plot RUN ...: draws what the probes of runs recorded."""
from __future__ import annotations

import argparse
import sys
from pathlib import Path

from .files import Error


def main() -> None:
    parser = argparse.ArgumentParser(prog="python3 -m sphfsi", description=__doc__)
    parser.add_argument("what", choices=["plot"], help="plot: draws a panel for each unit")
    parser.add_argument("run", nargs="+", metavar="RUN", help="folder of a run")
    parser.add_argument("--out", metavar="FILE", help="picture, .png or .pdf "
                        "(default: probes.png in the first run's folder)")
    args = parser.parse_args()
    try:
        import matplotlib
        matplotlib.use("Agg")
        import matplotlib.pyplot as plt

        from . import draw_probes
        from .files import make_runs
        from .style import STYLE
    except ImportError as missing:
        sys.exit(f"sphfsi: {missing.name} is missing; pip install {missing.name}")
    try:
        runs = make_runs(args.run)
        tables = [run.curves() for run in runs]
        refs = draw_probes.case_references(runs)
        columns = draw_probes.all_columns(runs, tables, refs)
        with plt.rc_context(STYLE):
            figure, _ = draw_probes.draw_panels(columns,
                                                draw_probes.curves_of(runs, tables, columns), refs)
            out = Path(args.out) if args.out else runs[0].folder / "probes.png"
            figure.savefig(out)
    except (Error, OSError, ValueError) as problem:
        sys.exit(f"sphfsi: {problem}")
    print(f"written {out}")


if __name__ == "__main__":
    main()
