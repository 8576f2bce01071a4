# SPDX-License-Identifier: MIT
"""The section of the validation report on the solid's sub-steps: gate and plate with and without
them."""

from sphfsi.draw_ledger import read_ledger
from common import BadFile, np
from validation_measures import Missing
from validation_report import series, paragraph

PAIRS = [("gate, dp = 1 mm, symplectic", "gate-1mm", "M1_dx_m"),
         ("gate, dp = 1 mm, Verlet", "gate-1mm-verlet", "M1_dx_m"),
         ("plate, dp = 12.5 mm, symplectic", "plate-12.5mm", "M1_dy_m"),
         ("plate, dp = 12.5 mm, Verlet", "plate-12.5mm-verlet", "M1_dy_m")]
CLOSE = "M1 differs less from a single rate than from the finer spacing"
# The same runs at another spacing, which the difference is compared with.
FINER = {"gate-1mm": "gate", "gate-1mm-verlet": "gate-verlet", "plate-12.5mm": "plate",
         "plate-12.5mm-verlet": "plate-verlet"}


def apart(run, other, column):
    """RMS difference of two runs over their common time, and the largest displacement in it, m."""
    time, value = series(run, column)
    other_time, other_value = series(other, column)
    both = time <= min(time[-1], other_time[-1])
    difference = np.interp(time[both], other_time, other_value) - value[both]
    return float(np.sqrt(np.mean(difference ** 2))), float(np.abs(value[both]).max())


def gained(run, until):
    """The largest spurious energy up to an instant, J/m."""
    ledger = read_ledger(run)
    lost = ledger["dissipated"][ledger["time"] <= until + 1e-9]
    return float(np.max(np.maximum.accumulate(lost) - lost))


def row(report, name, column):
    many, single = report.run(name), report.run(f"single-{name}")
    off, top = apart(single, many, column)
    cells = [f"{1e6 * off:.3g} ({100 * off / top:.2g} %)"]
    try:
        finer = apart(many, report.run(FINER[name]), column)[0]
        cells.append(f"{1e6 * finer:.3g} ({100 * finer / top:.2g} %)")
    except (Missing, BadFile) as problem:
        finer, cells = float("nan"), [*cells, f"*{problem}*"]
    end = series(single, column)[0][-1]
    gains = [gained(run, end) for run in (many, single)]
    ratio = many.summary["solid_substeps"] / many.summary["steps"]
    return off, finer, gains, [f"{ratio:.0f}", *cells, *(f"{gain:.3g}" for gain in gains),
                               f"{single.summary['steps']:,}"]


def rates(report):
    lines = [paragraph("rates"), "|---" * 7 + "|"]
    for words, name, column in PAIRS:
        try:
            off, finer, gains, cells = row(report, name, column)
        except (Missing, BadFile) as problem:
            lines.append(f"| {words} | *{problem}* | | | | | |")
            report.target("sub-steps", f"{CLOSE}, {words}", str(problem), None)
            continue
        lines.append(f"| {words} | " + " | ".join(cells) + " |")
        report.target("sub-steps", f"{CLOSE}, {words}",
                      f"{1e6 * off:.3g} um, limit {1e6 * finer:.3g} um", off <= finer)
        report.target("sub-steps", f"no more spurious energy than by a single rate, {words}",
                      f"{gains[0]:.3g} J/m, limit {gains[1]:.3g} J/m", gains[0] <= gains[1])
    return [paragraph("rates 2"), "",
            *lines, "", "Velocities and forces at the interface are extrapolated to the instant at "
                        "which "
                        "they are used (docs/theory.md, Sec. 7). The energies are in the ledgers "
                        "of 3.2 "
                        "and 3.3.",
            ""]
