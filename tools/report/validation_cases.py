# SPDX-License-Identifier: MIT
"""The sections of the validation report on the paper's five cases, and on the solid's sub-steps."""

import metrics
from common import COLOURS, ROOT, WIDTH, BadFile, Reference, np, plt
from sphfsi.draw_ledger import read_ledger
from sphfsi.draw_probes import peak
from validation_measures import Missing, bore, contact, front_speed, pressed_in
from validation_report import COST, cost, ledgers, paragraph, series
from validation_runs import BY_NAME

REFERENCES = ROOT / "cases" / "reference"
PERIOD, AMPLITUDE = 0.25515, 0.02302   # cantilever: linear 2-D elasticity, converged FE
DRY = 269.0                            # Hz: plate without water, first mode, FE
G = 9.81


def reference(name):
    return Reference("", REFERENCES / f"{name}.csv", name, name)


def rms_against(time, value, ref):
    inside = (ref.time >= time[0]) & (ref.time <= time[-1])
    if not inside.any():
        raise BadFile(f"{ref.path}: no time in common with the run")
    return float(np.sqrt(np.mean((np.interp(ref.time[inside], time, value) -
                                  ref.value[inside]) ** 2)))


def rms_text(run, column, *references):
    return [f"{1e3 * rms_against(*series(run, column), ref):.2f}" for ref in references]


# --- 3.1 ---
def swing(run):
    return metrics.oscillation(*series(run, "M1_dy_m"), PERIOD)


def cantilever(report):
    plate, elastic = reference("cantilever_thin_plate"), reference("cantilever_elasticity")

    def cells(run):
        o = swing(run)
        return [f"{o['first']:.4f}", f"{100 * (o['first'] / PERIOD - 1):+.2f}",
                f"{100 * (o['mean'] / PERIOD - 1):+.2f}", f"{o['drift']:+.1f}",
                f"{1e3 * o['amplitude']:.2f}", f"{100 * o['loss']:.2f}",
                *rms_text(run, "M1_dy_m", elastic, plate), *cost(run)[1:]]

    def table_one(ratio, kappa):
        """Errors of the paper's Table 1."""
        try:
            run = report.run(f"cantilever-{ratio}" + ("" if kappa == 50 else f"-kappa{kappa}"))
            return " / ".join(rms_text(run, "M1_dy_m", plate, elastic)) + \
                f" ({100 * (swing(run)['mean'] / PERIOD - 1):+.2f} %)"
        except (Missing, BadFile) as problem:
            return f"*{problem}*"

    for ratio, limit in ((20, 1.0), (40, 0.5), (80, 0.25)):
        def period(name=f"cantilever-{ratio}", limit=limit):
            error = 100 * (swing(report.run(name))["mean"] / PERIOD - 1)
            return f"{error:+.2f} %", abs(error) <= limit
        report.target("cantilever", f"period within {limit:g} % of {PERIOD} s at ts/dp = {ratio}",
                      period)

    def loss():
        found = report.first("cantilever-80", "cantilever-40", "cantilever-20")
        share = 100 * swing(report.run(found))["loss"]
        return f"{share:.2f} % ({BY_NAME[found].words})", share <= 1
    report.target("cantilever", "amplitude loss at most 1 % a second", loss)
    head = ["period (s)", "error (%)", "mean period, error (%)", "phase at the end (deg)",
            "amplitude (mm)", "loss (%/s)", "RMSE, elasticity (mm)", "RMSE, thin plate (mm)",
            *COST[1:]]
    kappas, printed = (0, 1, 10, 50), {20: "3.76", 40: "1.71", 80: "1.68"}
    return [
        paragraph("cantilever", period=PERIOD, amplitude=1e3 * AMPLITUDE), "",
        *report.table(head, "cantilever", cells, without="kappa"),
        "### Table 1 of the paper", "", paragraph("table one"), "",
        "| ts/dp | paper | " + " | ".join(f"kappa = {k}" for k in kappas) + " |", "|---" * 6 + "|",
        *("| " + " | ".join([str(ratio), printed.get(ratio, ""),
                             *(table_one(ratio, kappa) for kappa in kappas)]) + " |"
          for ratio in (10, 20, 40, 80)), "",
        *report.draw("plot_m1", ["cantilever-20", "cantilever-20-symplectic", "cantilever-40",
                                 "cantilever-80"], "cantilever-m1",
                     "Deflection of the free end, and its difference from the references"),
        *report.draw("plot_fields", ["cantilever-20", "cantilever-20-symplectic"],
                     "cantilever-fields",
                     "Von Mises stress at 0.57 s and 0.70 s, Verlet and symplectic (ts/dp = 20)",
                     "--time", 0.57, 0.7),
        *ledgers(report, "cantilever-")]


# --- 3.2 ---
def settled(run):
    """Mean deflection after 0.5 s, its standard deviation, half range and fast part."""
    time, dy = series(run, "M1_dy_m", 0.5)
    if time[-1] < 0.9:
        raise Missing(f"ends at {time[-1]:.2g} s")
    fast = dy[12:-12] - metrics.running_mean(dy, 25)  # faster than 5 ms
    return {"mean": dy.mean(), "std": dy.std(), "half": 0.5 * np.ptp(dy), "fast": fast.std()}


def deflections():
    """Deflections by two-dimensional elasticity and by the thin plate, with the plate's own weight,
    m."""
    return [float(reference(f"hydrostatic_plate_{name}").value[-1])
            for name in ("elasticity", "thin_plate")]


def plate_targets(report, sides):
    def off(name):
        return settled(report.run(name))["mean"] / deflections()[0] - 1

    def close(name):
        return f"{100 * off(name):+.2f} %", abs(off(name)) <= 0.04

    def closer():
        """The error at half the paper's spacing, and whether it is smaller than at the paper's."""
        coarse = report.first("plate-leapfrog", "plate-verlet")
        fine = off("plate-3.125mm-leapfrog")
        return f"{100 * fine:+.2f} %", abs(fine) < abs(off(coarse))

    def steady(name, what):
        s = settled(report.run(name))
        return f"{-100 * s[what] / s['mean']:.2f} %", -s[what] / s["mean"] < 0.02
    case, words = "hydrostatic plate", "fluctuation after 0.5 s below 2 %"
    for name, side in sides:
        report.target(case, f"settled deflection within 4 % of 2-D elasticity, {side}",
                      lambda name=name: close(name))
        for what, measure in (("std", "standard deviation"), ("half", "half of the range")):
            report.target(case, f"{words} ({measure}), {side}",
                          lambda name=name, what=what: steady(name, what))
    report.target(case, "deflection closer to 2-D elasticity at half the spacing", closer)
    report.target(case, f"{words} (standard deviation), half the spacing",
                  lambda: steady("plate-3.125mm-leapfrog", "std"))


def plate(report):
    sides = ("plate", "symplectic"), ("plate-verlet", "Verlet")
    plate_targets(report, sides)
    exact, thin = deflections()

    def cells(run):
        s, (time, dy) = settled(run), series(run, "M1_dy_m")
        early = (time > 0.002) & (time < 0.022)
        top = peak(time, dy, -1.0)
        return [f"{1e5 * s['mean']:.3f}", f"{100 * (s['mean'] / exact - 1):+.2f}",
                f"{100 * (s['mean'] / thin - 1):+.2f}", f"{100 * s['std'] / -s['mean']:.2f}",
                f"{100 * s['half'] / -s['mean']:.2f}", f"{100 * s['fast'] / -s['mean']:.4f}",
                f"{1e5 * top[1]:.2f} at {1e3 * top[0]:.1f}",
                f"{metrics.strongest(time[early], dy[early]):.0f}", *cost(run)]

    head = ["deflection (1e-5 m)", "from elasticity (%)", "from thin plate (%)",
            "standard deviation (%)", "half range (%)", "faster than 5 ms (%)",
            "first peak (1e-5 m, ms)", "first frequency (Hz)", *COST]
    return [
        paragraph("plate", exact=1e5 * exact, thin=1e5 * thin, dry=DRY), "",
        *report.table(head, "plate", cells), *both_integrators(report, sides),
        *plate_figure(report, exact, thin),
        *report.draw("plot_fields", ["plate-verlet", "plate"], "plate-fields",
                     "Pressure and stress at 0.3 s, Verlet and symplectic (dp = 6.25 mm)", "--time",
                     0.3),
        paragraph("plate 2"), "", paragraph("plate 3"), "", *ledgers(report, "plate")]


def both_integrators(report, sides):
    try:
        a, b = (settled(report.run(name)) for name, _ in sides)
    except (Missing, BadFile) as problem:
        return [f"*What symplectic gives over Verlet: {problem}.*", ""]
    ratio = b["fast"] / a["fast"]
    verdict = ("Verlet's is the larger, as the paper says" if ratio > 1.2 else
               "the paper's claim that symplectic is steadier is not confirmed here" if ratio > 0.8
               else "symplectic's is the larger, against the paper's claim")
    return [paragraph("both integrators", mean=100 * abs(b["mean"] / a["mean"] - 1),
                      std=-100 * a["std"] / a["mean"], std_2=-100 * b["std"] / b["mean"],
                      fast=-100 * a["fast"] / a["mean"], fast_2=-100 * b["fast"] / b["mean"],
                      verdict=verdict), ""]


def plate_figure(report, exact, thin):
    names = report.has("plate", "plate-verlet", "plate-h1.5", "plate-leapfrog")
    if not names:
        return ["*No figure: no run of the plate has finished.*", ""]
    figure, (whole, early) = plt.subplots(1, 2, figsize=(WIDTH, 2.9), width_ratios=[2, 1],
                                          layout="constrained")
    for axes, end in ((whole, 1.0), (early, 0.03)):
        for k, (colour, name) in enumerate(zip(COLOURS, names)):
            time, dy = series(report.run(name), "M1_dy_m")
            # The last line does not hide the first.
            axes.plot(time[time <= end], 1e5 * dy[time <= end], color=colour,
                      linewidth=2.2 - 0.5 * k, label=BY_NAME[name].words)
        axes.axhline(1e5 * exact, color="0.2", linestyle=(0, (5, 2)), linewidth=1,
                     label="2-D elasticity")
        axes.axhline(1e5 * thin, color="0.5", linestyle=(0, (1.5, 1.5)), linewidth=1,
                     label="thin plate")
        axes.set(xlabel="Time (s)", xlim=(0, end))
    whole.set(ylabel=r"M1 deflection ($10^{-5}$ m)", ylim=(-8.5, -5.5))
    whole.legend(ncol=2, fontsize=7)
    return report.save(figure, "plate-m1", "Mid-span deflection; right: the first 30 ms")


# --- 3.3 ---
def gate(report):
    def numbers(run):
        across, down = reference("gate_antoci_2007_x"), reference("gate_antoci_2007_y")
        time, dx = series(run, "M1_dx_m")
        k = int(np.argmax(dx))
        return {"peak": 1e3 * dx[k], "at": time[k], "late": 1e3 * float(np.interp(0.36, time, dx)),
                "rms": 1e3 * rms_against(time, dx, across),
                "rms_y": 1e3 * rms_against(*series(run, "M1_dy_m"), down),
                "short": 1e3 * (across.value.max() - dx[k])}

    def cells(run):
        n = numbers(run)
        return [f"{n['peak']:.1f}", f"{n['at']:.3f}", f"{n['late']:.1f}", f"{n['rms']:.1f}",
                f"{n['rms_y']:.1f}", *cost(run)]

    def judge(name, key, limit, unit):
        value = numbers(report.run(name))[key]
        return f"{value:.1f} {unit}", abs(value) <= limit

    for name in ("gate", "gate-verlet", "gate-leapfrog", "gate-0.25mm-leapfrog"):
        words = BY_NAME[name].words
        report.target("gate", "RMS against the measured horizontal curve at most 3.5 mm, " + words,
                      lambda name=name: judge(name, "rms", 3.5, "mm"))
        report.target("gate", f"peak within 3 mm of the measured one, {words}",
                      lambda name=name: judge(name, "short", 3, "mm short"))
    dry_targets(report, "gate", "gate", "gate-verlet", "gate-leapfrog")
    top = 1e3 * reference("gate_antoci_2007_x").value.max()
    fine = report.has("gate", "gate-verlet")
    show = [*(fine if len(fine) == 2 else ["gate-1mm", "gate-1mm-verlet"]), "gate-leapfrog",
            "gate-1mm-plane-stress"]
    return [
        paragraph("gate", top=top), "",
        *report.table(["peak (mm)", "at (s)", "at 0.36 s (mm)", "RMS x (mm)", "RMS y (mm)", *COST],
                      "gate", cells),
        paragraph("gate 2"), "", *gate_reading(report, numbers),
        *report.draw("plot_m1", show, "gate-m1", "Displacement of the free end, and its difference "
                                                 "from the measured one"),
        *report.draw("plot_fields", report.has("gate-verlet", "gate") and ["gate-verlet", "gate"]
                     or ["gate-1mm-verlet", "gate-1mm"], "gate-fields",
                     "Pressure and von Mises stress, Verlet (left) and symplectic", "--time", 0.08,
                     0.16, 0.24, 0.36, "--window", -0.01, 0.35, -0.01, 0.165),
        *report.draw("plot_ledger", [report.first("gate", "gate-verlet", "gate-leapfrog",
                                                  "gate-1mm-leapfrog")], "gate-ledger",
                     "Energy, momentum, extremes and time step of the gate"),
        *interface(report, "gate", "gate-verlet", "gate-leapfrog", "gate-1mm", "gate-1mm-verlet"),
        *ledgers(report, "gate")]


def gate_reading(report, numbers):
    """What moves the curve, by the runs at 1 mm."""
    lines = [paragraph("gate reading"), ""]
    try:
        base = numbers(report.run("gate-1mm-leapfrog"))
    except (Missing, BadFile) as problem:
        return [f"*What moves the curve: gate-1mm-leapfrog, to compare with: {problem}.*", ""]
    for name, words in (("gate-leapfrog", "half the spacing"),
                        ("gate-0.25mm-leapfrog", "a quarter of the spacing"),
                        ("gate-1mm", "symplectic for leapfrog"),
                        ("gate-1mm-verlet", "Verlet for leapfrog"),
                        ("gate-1mm-cfl0.2", "C_CFL = 0.2 for the default"),
                        ("gate-1mm-h1.5", "h/dp = 1.5 for 1.35"),
                        ("gate-1mm-alpha0.05", "alpha = 0.05 for 0.01"),
                        ("gate-1mm-kappa10", "kappa = 10 for 50"),
                        ("gate-1mm-neo-hookean", "neo-Hookean for the paper's law"),
                        ("gate-1mm-plane-stress", "plane stress for plane strain"),
                        ("gate-1mm-printed", "Eqs. 13, 17 and 18 as printed")):
        try:
            n = numbers(report.run(name))
            lines.append(f"* {words}: {n['peak'] - base['peak']:+.1f} and "
                         f"{n['late'] - base['late']:+.1f}, RMS {n['rms']:.1f} instead of "
                         f"{base['rms']:.1f}")
        except (Missing, BadFile) as problem:
            lines.append(f"* {words}: {problem}")
    return [*lines, "", paragraph("gate reading 2"), ""]


# --- interfaces, 3.4, 3.5 ---
def interface(report, *names):
    """Gaps and penetration between water and structure over the snapshots."""
    def cells(run):
        closest, median, gaps = contact(run)
        bodies, walls, share = pressed_in(run)
        return [f"{closest:.2f}", f"{median:.2f}", f"{100 * gaps:.1f}", f"{bodies}, {walls}",
                f"{100 * share:.0f}"]
    return ["### Interface", "", paragraph("interface"), "", *report.rows(
        ["run", "closest", "median, wetted surface", "surface with a gap (%)",
         "pressed into bodies, walls", "snapshots with any (%)"],
        [(BY_NAME[name].words, name) for name in names], cells)]


def dry_targets(report, case, *names):
    """No water inside bodies or walls, for the runs at the paper's spacing."""
    for name in names:
        def dry(name=name):
            bodies, walls, share = pressed_in(report.run(name))
            return f"{bodies} in bodies, {walls} in walls, {100 * share:.0f} % of the snapshots", \
                share == 0
        report.target(case, f"no water pressed into bodies or walls, {BY_NAME[name].words}", dry)


def contact_time(run, least=2e-4):
    """First instant at which M1 has moved by more than `least` (m) from its position at rest."""
    time, dx = series(run, "M1_dx_m")
    moved = np.flatnonzero(np.abs(dx) > least)
    if not len(moved):
        raise Missing(f"M1 never moves by {1e3 * least:g} mm")
    return float(time[moved[0]])


def in_air(length, young):
    """First frequency (Hz) of the baffle or the gate without water, as their cases say."""
    return metrics.beam_frequency(young, 0.4, 1250, 0.007, length)


def about_mean(time, value, since):
    fast_time, fast = metrics.about_running_mean(time, value, 0.2)
    late = fast_time > since
    return [f"{metrics.mean_frequency(fast_time[late], fast[late]):.1f}",
            f"{1e3 * fast[late].std():.2f}"]


def movement(run):
    """First contact, largest displacement and its time; the rows."""
    time, dx = series(run, "M1_dx_m")
    k = int(np.argmax(np.abs(dx)))
    return [f"{contact_time(run):.3f}", f"{1e3 * dx[k]:.1f}", f"{time[k]:.3f}"], time, dx


def resolutions(report, name, coarsest):
    """Names of the runs of all spacings and integrators, those of the coarser figure and of the
    pictures of fields."""
    families = (name, f"{name}-2.5mm", f"{name}-{coarsest}mm")
    names = [family + end for family in families for end in ("", "-verlet", "-leapfrog")]
    coarse = report.coarse(*families[1:])
    return [*names[:3], f"{name}-2mm-leapfrog", *names[3:]], coarse, report.shown(name, coarse)


def named(names):
    return "; ".join(BY_NAME[name].words for name in names)


def baffle(report):
    depth, speed = metrics.wet_bed_bore(0.15, 0.03)

    def cells(run):
        moved, time, dx = movement(run)
        height, fast = bore(run)
        return [f"{1e3 * height:.1f} ({100 * (height / depth - 1):+.0f} %)",
                f"{fast:.2f} ({100 * (fast / speed - 1):+.0f} %)", *moved,
                *about_mean(time, dx, 0.7), f"{1e3 * dx[time > 0.7].mean():.1f}", *cost(run)]
    dry_targets(report, "wet baffle", "baffle", "baffle-verlet", "baffle-leapfrog")
    names, coarse, shown = resolutions(report, "baffle", 4)
    return [
        paragraph("baffle", depth=1e3 * depth, speed=speed, in_air=in_air(0.08, 5.7e6),
                  in_air_2=in_air(0.064, 5.7e6), about_mean=paragraph("about mean")), "",
        *report.table(["bore depth (mm)", "bore speed (m/s)", "first contact (s)",
                       "largest M1 (mm)", "at (s)", "frequency after 0.7 s (Hz)", "RMS (mm)",
                       "mean after 0.7 s (mm)", *COST], "baffle", cells),
        *report.draw("plot_m1", ["baffle-verlet", "baffle", "baffle-leapfrog",
                                 "baffle-2mm-leapfrog", *coarse],
                     "baffle-m1", "Horizontal displacement of the tip", "--column", "M1_dx_m"),
        *report.draw("plot_m1", ["baffle-2mm-leapfrog", "baffle-2mm-embedded", "baffle-2mm-slow",
                                 "baffle-2mm-fast"], "baffle-sensitivity",
                     "What the assumptions do: free length, speed of the plate",
                     "--column", "M1_dx_m"),
        *report.draw("plot_fields", shown, "baffle-fields", "Pressure and von Mises stress, " +
                     named(shown), "--time", 0.3, 0.4, 0.6, 1.0, "--window", 0.6, 1.1, -0.01, 0.24),
        *interface(report, *names), *ledgers(report, "baffle")]


def sluice(report):
    ritter = 2 * np.sqrt(G * 0.2)

    def cells(run):
        moved, time, dx = movement(run)
        late = time > 1.0
        fast, = front_speed(run)
        return [f"{fast:.2f} ({100 * fast / ritter:.0f} %)", *moved, f"{1e3 * dx[late].mean():.1f}",
                f"{1e3 * dx[late].std():.2f}", *about_mean(time, dx, 1.0), *cost(run)]
    dry_targets(report, "sluice gate", "sluice", "sluice-verlet", "sluice-leapfrog")
    names, coarse, shown = resolutions(report, "sluice", 5)
    window = ("--window", 0.55, 1.15, -0.01, 0.24)
    return [
        paragraph("sluice", ritter=ritter, in_air=in_air(0.125, 4e6),
                  about_mean=paragraph("about mean")), "",
        *report.table(["front (m/s, of Ritter's)", "first contact (s)", "largest M1 (mm)", "at (s)",
                       "mean after 1 s (mm)", "deviation after 1 s (mm)",
                       "frequency after 1 s (Hz)", "RMS (mm)", *COST], "sluice", cells),
        *report.draw("plot_m1", ["sluice-verlet", "sluice", "sluice-leapfrog",
                                 "sluice-2mm-leapfrog", *coarse], "sluice-m1",
                     "Horizontal displacement of the gate's lower end", "--column", "M1_dx_m"),
        *report.draw("plot_m1", ["sluice-2mm-leapfrog", "sluice-2mm-opening10",
                                 "sluice-2mm-opening40", "sluice-2mm-slow", "sluice-2mm-viscous"],
                     "sluice-sensitivity",
                     "What the assumptions do: opening, speed of the plate; and what alpha does",
                     "--column", "M1_dx_m"),
        *report.draw("plot_fields", shown, "sluice-fields", "Pressure and von Mises stress, " +
                     named(shown), "--time", 0.3, 0.5, 1.0, 1.5, *window),
        *report.draw("plot_fields", shown, "sluice-vorticity", "Vorticity after 1 s, " +
                     named(shown), "--time", 1.1, 1.3, 1.5, 1.7, "--field", "vorticity", *window),
        *interface(report, *names), *ledgers(report, "sluice")]


# --- sub-steps ---
# Runs with them, what is compared, and the same run at another spacing as the measure.
PAIRS = [("gate, dp = 1 mm, symplectic", "gate-1mm", "gate", "M1_dx_m"),
         ("gate, dp = 1 mm, Verlet", "gate-1mm-verlet", "gate-verlet", "M1_dx_m"),
         ("plate, dp = 12.5 mm, symplectic", "plate-12.5mm", "plate", "M1_dy_m"),
         ("plate, dp = 12.5 mm, Verlet", "plate-12.5mm-verlet", "plate-verlet", "M1_dy_m")]


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


def rates(report):
    def compare(single, name, finer, column):
        """In metres: difference from a single rate, from the finer run; the largest displacement;
        and the gains of energy."""
        many, end = report.run(name), series(single, column)[0][-1]
        off, top = apart(single, many, column)
        try:
            limit = apart(many, report.run(finer), column)[0]
        except (Missing, BadFile) as problem:
            limit = problem
        return many, off, limit, top, [gained(run, end) for run in (many, single)]

    def cells(single):
        pair = next(pair for pair in PAIRS if single.name == f"single-{pair[1]}")
        many, off, limit, top, gains = compare(single, *pair[1:])
        return [f"{many.summary['solid_substeps'] / many.summary['steps']:.0f}",
                *(f"*{x}*" if isinstance(x, Exception) else
                  f"{1e6 * x:.3g} ({100 * x / top:.2g} %)" for x in (off, limit)),
                *(f"{gain:.3g}" for gain in gains), f"{single.summary['steps']:,}"]

    for words, *pair in PAIRS:
        def close(pair=pair):
            _, off, limit, *_ = compare(report.run(f"single-{pair[0]}"), *pair)
            if isinstance(limit, Exception):
                raise limit
            return f"{1e6 * off:.3g} um, limit {1e6 * limit:.3g} um", off <= limit

        def gains(pair=pair):
            *_, (many, one) = compare(report.run(f"single-{pair[0]}"), *pair)
            return f"{many:.3g} J/m, limit {one:.3g} J/m", many <= one
        report.target("sub-steps", "M1 differs less from a single rate than from the finer "
                                   f"spacing, {words}", close)
        report.target("sub-steps", f"no more spurious energy than by a single rate, {words}", gains)
    return [paragraph("rates 2"), "",
            *report.rows(paragraph("rates").strip("| ").split(" | "),
                         [(words, f"single-{name}") for words, name, *_ in PAIRS], cells),
            paragraph("rates 3"), ""]
