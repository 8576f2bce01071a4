# SPDX-License-Identifier: MIT
"""Reads and draws a run's ledger: shares of the energy, momentum, extremes and the time step."""

import matplotlib.pyplot as plt
import numpy as np

from .files import BadFile
from .style import COLOURS, WIDTH

SHARES = {"kinetic": "kinetic", "potential": "potential, from its lowest",
          "internal": "fluid's compression", "elastic": "solid's strain",
          "hourglass": "hourglass", "contact": "contact", "dissipated": "dissipated"}
SIMPLE = ["time", "momentum_x", "momentum_y", "mass", "dens_extreme", "det_low", "dt"]


def read_ledger(run):
    """Columns by their names without the unit that the file appends."""
    table = run.table("ledger.csv")
    ledger = {}
    for name in [*SHARES, *SIMPLE]:
        column = next((c for c in table if c == name or c.startswith(name + "_")), None)
        if column is None and name == "contact":  # runs of earlier versions lack it
            ledger[name] = 0 * table[next(iter(table))]
            continue
        if column is None:
            raise BadFile(f"{run.folder / 'ledger.csv'}: no column {name}")
        ledger[name] = table[column]
    return ledger


def energy_shares(ledger):
    """Shares of all energy in %, and that energy. Only differences of potential energy mean
    something: it counts from its lowest value in the run."""
    energy = {name: ledger[name].copy() for name in SHARES}
    energy["potential"] -= np.nanmin(energy["potential"])
    # The largest sum, because moving walls may add to it.
    total = np.nanmax(sum(energy.values()))
    if not total > 0:
        total = max(np.nanmax(np.abs(values)) for values in energy.values()) or 1.0
    return {name: 100 * values / total for name, values in energy.items()}, total


def draw(run, ledger):
    figure = plt.figure(figsize=(WIDTH, 6.2))
    grid = figure.add_gridspec(3, 2, height_ratios=[1.5, 1, 1], left=0.09, right=0.975, top=0.955,
                               bottom=0.075, hspace=0.25, wspace=0.26)
    energy = figure.add_subplot(grid[0, :].subgridspec(1, 2, width_ratios=[2, 1])[0])
    momentum, step, density, det = (figure.add_subplot(grid[k]) for k in (2, 3, 4, 5))
    time = ledger["time"]
    shares, total = energy_shares(ledger)
    for colour, (name, values) in zip(COLOURS, shares.items()):
        energy.plot(time, values, color=colour, label=f"{SHARES[name]}: {values[-1]:.3g} %")
    energy.set(ylabel=f"Share of {total:.4g} J/m (%)", title=run.label(run.summary.get("title")))
    energy.legend(title="Energy, its share at the end", loc="center left",
                  bbox_to_anchor=(1.01, 0.5), handlelength=1.6)
    for colour, axis in zip(COLOURS, "xy"):
        momentum.plot(time, ledger["momentum_" + axis], color=colour, label=f"${axis}$")
    momentum.set_ylabel("Momentum (N s/m)")
    momentum.legend(ncol=2)
    step.plot(time, 1e6 * ledger["dt"], color=COLOURS[0])
    step.set(ylabel="Time step (µs)", ylim=(0, None))
    density.plot(time, 100 * ledger["dens_extreme"], color=COLOURS[0])
    density.set(ylabel=r"Largest $|\rho/\rho_0 - 1|$ (%)", ylim=(0, None))
    det.plot(time, ledger["det_low"], color=COLOURS[0])
    det.set_ylabel(r"Smallest det $\mathbf{F}$")
    if not np.isfinite(ledger["det_low"]).any():
        det.text(0.5, 0.5, "no solid", transform=det.transAxes, ha="center", color="0.4")
        det.set_yticks([])
    for axes in (energy, momentum):
        axes.axhline(0, color="0.7", linewidth=0.6, zorder=1)
    for axes in (energy, momentum, step, density, det):
        axes.set_xlim(0, time[-1] or 1)
        axes.locator_params(axis="x", nbins=5)
        axes.set_xlabel("Time (s)" if axes in (density, det) else "")
    figure.align_ylabels([energy, momentum, density])
    figure.align_ylabels([step, det])
    return figure
