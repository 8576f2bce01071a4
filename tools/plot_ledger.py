#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws a run's ledger: shares of the energy, momentum, extremes and the time step.

example: tools/plot_ledger.py runs/gate --out ledger.pdf"""

import runfiles
from runfiles import np
from sphfsi.draw_ledger import draw, energy_shares, read_ledger


def arguments():
    parser = runfiles.options(__doc__)
    parser.add_argument("run", nargs="?", metavar="RUN", help="folder of a run")
    parser.add_argument("--out", metavar="FILE", help="picture, .png or .pdf "
                        "(default: ledger.png in the run's folder)")
    return runfiles.parse(parser)


def main():
    args = arguments()
    run = runfiles.make_runs([args.run])[-1]
    ledger = read_ledger(run)
    shares, total = energy_shares(ledger)
    print(f"{run.label()}: t = {ledger['time'][-1]:g} s, energy {total:.6g} J/m, at the end: " +
          ", ".join(f"{name} {values[-1]:.3g} %" for name, values in shares.items()))
    print(f"mass changed by {ledger['mass'][-1] / ledger['mass'][0] - 1:+.3g}, largest density "
          f"deviation {np.nanmax(ledger['dens_extreme']):.3g}, smallest det F "
          f"{np.nanmin(ledger['det_low']):.4g}, time step {np.nanmin(ledger['dt']):.3g} to "
          f"{np.nanmax(ledger['dt']):.3g} s")
    runfiles.save(draw(run, ledger), args.out or run.folder / "ledger.png")


if __name__ == "__main__":
    runfiles.run_tool(main)
