# SPDX-License-Identifier: MIT
"""The sections of the validation report on water alone and on solids alone."""

import os
import re
import subprocess
from pathlib import Path

import metrics
from sphfsi.draw_ledger import read_ledger
from common import COLOURS, ROOT, WIDTH, BadFile, check_increasing, np, plt, read_table
from validation_measures import G, Missing, front_of, number, rest, turning
from validation_report import COST, STEPS, cost, paragraph, series
from validation_runs import BY_NAME

REFERENCES = ROOT / "cases" / "reference"
BUILD = Path(os.environ.get("BUILD") or ROOT / "build/release").resolve()


def scheme(run):
    keys = next((keys for kind, _, keys in run.case() if kind == "fluid"), None)
    if keys is None:
        raise BadFile(f"{run.folder / 'case.cfg'}: no section [fluid ...]")
    return keys


# --- water alone ---
def still(report):
    def cells(run):
        error, energy, slope = rest(run)
        return [f"{100 * error:.2f}", f"{energy:.1e}", f"{slope:.4f}",
                str(run.summary["fluid_left_domain"]), *cost(run)]
    for name, words in (("still-10mm-printed-1.35", "Eq. 6 and h/dp = 1.35 as in the paper"),
                        ("still-10mm-c20-1.5", "Fourtakas, h/dp = 1.5, c0 = 20 sqrt(gH)")):
        def error(name=name):
            found = rest(report.run(name))[0]
            return f"{100 * found:.2f} %", found <= 0.01

        def energy(name=name):
            found = rest(report.run(name))[1]
            return f"{found:.1e}", found < 1e-6
        report.target("still water, 10 s", f"pressure error (L2) at most 1 %, {words}", error)
        report.target("still water, 10 s", f"kinetic energy below 1e-6 of the potential, {words}",
                      energy)
    return [*report.table(["pressure error, L2 (%)", "kinetic over potential", "slope over rho g",
                           "left the domain", *STEPS], "still", cells), paragraph("still"), ""]


def beat(run):
    """Frequency over that of linear theory and decay of a standing wave, from the momentum in x."""
    ledger = read_ledger(run)
    height, width = number(run, "H"), number(run, "W")
    k = np.pi / width
    omega = float(np.sqrt(G * k * np.tanh(k * height)))
    found, decay = metrics.damped_sine(ledger["time"], ledger["momentum_x"], omega)
    damping = float(scheme(run)["artificial_viscosity"]) * number(run, "h_over_dp") * \
        run.spacing() * run.summary["derived"]["c0"] / 8
    return found / omega, decay, 2 * damping * k * k


def wave(report):
    def cells(run):
        ratio, decay, exact = beat(run)
        stiff = metrics.lattice_shear(float(number(run, "h_over_dp")))
        return [f"{ratio:.4f}", f"{stiff:+.4f}", f"{decay:.3f}", f"{exact:.3f}", *cost(run)]

    def finest(smoothing):
        name = report.first(f"wave-40-{smoothing}", f"wave-20-{smoothing}")
        ratio = beat(report.run(name))[0]
        return f"{100 * (ratio - 1):+.2f} % ({BY_NAME[name].words})", abs(ratio - 1) <= 0.01

    def converges(smoothing="1.5"):
        names = report.has(*(f"wave-{n}-{smoothing}" for n in (10, 20, 40)))
        if len(names) < 2:
            raise Missing("fewer than two resolutions")
        runs = [report.run(name) for name in names]
        errors = [beat(run)[0] - 1 for run in runs]
        slope = metrics.order([run.spacing() for run in runs], errors)
        words = ", ".join(BY_NAME[name].words.split(",")[0] for name in names)
        return f"{slope:.2f} (over {words})", slope >= 1
    report.target("standing wave", "frequency within 1 %, h/dp = 1.5", lambda: finest("1.5"))
    report.target("standing wave", "frequency within 1 %, h/dp = 1.35 as in the paper",
                      lambda: finest("1.35"))
    report.target("standing wave", "order of convergence at least 1", converges)
    return [
        paragraph("wave"), "",
        *report.table(["frequency over theory", "shear stiffness of the lattice (p/rho)",
                       "decay (1/s)", "2 nu k^2 (1/s)", *COST], "wave", cells),
        paragraph("wave 2"), "", *shear_line(report)]


def shear_line(report):
    """How the frequency follows the lattice's stiffness, over the runs that differ in nothing
    else."""
    names = report.has(*(f"wave-{n}-{h}" for n in (20, 40) for h in (1.35, 1.5, 1.6, 1.7, 1.8, 2)))
    if len(names) < 4:
        return []
    runs = [report.run(name) for name in names]
    stiff = [metrics.lattice_shear(float(number(run, "h_over_dp"))) for run in runs]
    off = [100 * (beat(run)[0] - 1) for run in runs]
    slope, rest = np.polyfit(stiff, off, 1)
    return [paragraph("shear line", runs=len(runs), off=np.corrcoef(stiff, off)[0, 1],
                      slope=slope / 100, rest=rest), ""]


def fade(run):
    """Decay rate of kinetic energy between a tenth of a second and the end over the exact one, and
    the energy at 0.25 s and 1 s over the exact one."""
    ledger = read_ledger(run)
    time, energy = ledger["time"], ledger["kinetic"]
    rate = 16 * np.pi ** 2 * number(run, "nu") / number(run, "L") ** 2
    own = -np.polyfit(time[time > 0.1], np.log(energy[time > 0.1]), 1)[0]
    shares = [float(np.interp(t, time, energy) / energy[0] / np.exp(-rate * t))
              for t in (0.1, 0.25, 1.0)]
    return own / rate, shares


def vortices(report):
    def cells(run):
        rate, shares = fade(run)
        return [f"{rate:.3f}", *(f"{share:.3f}" for share in shares), *cost(run)]
    return [
        "Periodic square, Re = 100. Kinetic energy should fall as exp(-16 pi^2 nu t/L^2).", "",
        *report.table(["rate over exact", "energy over exact at 0.1 s", "at 0.25 s", "at 1 s",
                       *STEPS], "taylor", cells),
        paragraph("vortices"), ""]


def front_places():
    path = REFERENCES / "dam_break_martin_moyce_1952.csv"
    table, _ = read_table(path)
    if set(table) != {"time_nd", "front_nd"}:
        raise BadFile(f"{path}: columns are {', '.join(table)}; they must be time_nd, front_nd")
    check_increasing(path, "time_nd", table["time_nd"])
    return table["time_nd"], table["front_nd"]


def front(report):
    seen = {}  # a front's path needs many snapshots

    def curve(run, scale):
        width = number(run, "a")
        time, way = seen[run.name] = seen.get(run.name) or tuple(map(np.array, front_of(run)))
        return time * np.sqrt(scale * G / width), way / width

    def off(run, scale, shift=0.0):
        (known_t, known_x), (time, way) = front_places(), curve(run, scale)
        return np.interp(known_t + shift, time, way, right=np.nan) / known_x - 1

    def aligned(run, scale):
        """The shift in time that fits best, and the largest deviation with it."""
        shifts = np.linspace(-1, 1, 401)
        best = min(shifts, key=lambda s: np.nan_to_num(np.abs(off(run, scale, s)), nan=9).max())
        return best, float(np.abs(off(run, scale, best)).max())

    def cells(run):
        rows = []
        for scale in (2, 1):
            plain, (shift, left) = off(run, scale), aligned(run, scale)
            rows += [f"{100 * plain.min():+.0f} to {100 * plain.max():+.0f}",
                     f"{100 * left:.1f} ({shift:+.2f})"]
        return [*rows, *cost(run)]

    def close(names, scale):
        largest = float(np.abs(off(report.run(report.first(*names)), scale)).max())
        return f"{100 * largest:.1f} %", largest <= 0.05

    def moved(names):
        shift, left = aligned(report.run(report.first(*names)), 1)
        return f"{100 * left:.1f} % (shift {shift:+.2f})", left <= 0.05
    tall, square = ("front-80", "front-40", "front-20"), ("front-40-square",)
    words = "the same table read as a square column, t sqrt(g/a)"
    later = "after a shift of the time's origin"
    for what, judge in (
            ("front within 5 % of Martin-Moyce, column of height 2a, t sqrt(2g/a)",
             lambda: close(tall, 2)),
            (words, lambda: close(square, 1)), (f"{words}, {later}", lambda: moved(square)),
            (f"the same table read as t sqrt(g/a) of a column of height 2a, {later}",
             lambda: moved(tall))):
        report.target("dry dam break", what, judge)
    return [paragraph("front"), "",
            *report.table(["t sqrt(2g/a)", "shifted", "t sqrt(g/a)", "shifted", *STEPS], "front",
                          cells),
            *front_figure(report, *front_places(), curve), paragraph("front 2"), ""]


def front_figure(report, known_t, known_x, curve):
    lines = [(name, 2, r"height 2a, $t\sqrt{2g/a}$, " + BY_NAME[name].words)
             for name in report.has("front-80", "front-40", "front-20")[:1]]
    lines += [(name, 1, r"square, $t\sqrt{g/a}$, a/dp = 40")
              for name in report.has("front-40-square")]
    if not lines:
        return ["*No figure: no run of the front has finished.*", ""]
    figure, axes = plt.subplots(figsize=(0.6 * WIDTH, 3), layout="constrained")
    axes.plot(known_t, known_x, "o", color="black", markersize=3.5,
              label="Martin and Moyce 1952, as tabulated")
    for colour, (name, scale, words) in zip(COLOURS, lines):
        axes.plot(*curve(report.run(name), scale), color=colour, label=words)
    axes.set(xlabel="Time, made dimensionless", ylabel="Front x/a", xlim=(0, 2.2), ylim=(1, 3.6))
    axes.legend(fontsize=7)
    return report.save(figure, "front", "Front of the dam break against Martin and Moyce 1952")


def impact_figure(report, sensors, curve):
    names = report.has("impact-60-2", "impact-60-1.35", "impact-30-2")
    if not names:
        return ["*No figure: no run of the impact has finished.*", ""]
    figure, axes = plt.subplots(1, 3, figsize=(WIDTH, 2.6), layout="constrained", sharey=True)
    for place, (probe, height, top) in zip(axes, sensors):
        place.axhline(top, color="black", linestyle=(0, (5, 2)), linewidth=0.9,
                      label="measured peak")
        for colour, name in zip(COLOURS, names):
            place.plot(*curve(report.run(name), probe, 5), color=colour, linewidth=0.8,
                       label=BY_NAME[name].words)
        place.set(title=f"{1e3 * height:.0f} mm above the floor", xlabel=r"$t\sqrt{g/H}$",
                  xlim=(2, 4.5), ylim=(-0.5, 4.5))
    axes[0].set_ylabel(r"$p/(\rho g H)$")
    axes[2].legend(fontsize=7)
    return report.save(figure, "impact", "Pressures at the far wall, mean over 5 ms; the dashed "
                                         "line is the measured peak, at 80 mm that of the later "
                                         "wave")


def impact_sensors():
    table, _ = read_table(REFERENCES / "dam_break_lobovsky_2014.csv")
    if set(table) != {"height_m", "peak_nd"} or len(table["peak_nd"]) != 3:
        raise BadFile("dam_break_lobovsky_2014.csv: three rows of height_m, peak_nd are needed")
    return list(zip(("P1", "P3", "P4"), table["height_m"], table["peak_nd"]))


def impact(report):
    def curve(run, probe, mean=1):
        height = number(run, "H")
        time, p = series(run, f"{probe}_p_Pa")
        return metrics.running_mean(time, mean) * np.sqrt(G / height), \
            metrics.running_mean(p, mean) / (1000 * G * height)

    def cells(run):
        row = []
        for probe, _, _ in impact_sensors():
            row += [f"{curve(run, probe)[1].max():.2f}", f"{curve(run, probe, 5)[1].max():.2f}"]
        time, p = curve(run, "P1", 5)
        return [*row, f"{time[np.argmax(p)]:.2f}", *cost(run)]

    def peak(kernel):
        name = report.first(f"impact-60-{kernel}", f"impact-30-{kernel}")
        found, short, row = (float(curve(report.run(name), "P1", n)[1].max()) for n in (5, 2, 1))
        low = impact_sensors()[0][2]
        words = (f"{found:.2f} rho g H, measured {low:g} ({short:.2f} over 2 ms, "
                 f"{row:.2f} over 1 ms)")
        return words, abs(found / low - 1) <= 0.25
    for kernel, words in ("2", "h/dp = 2"), ("1.35", "h/dp = 1.35 as in the paper"):
        report.target("dry dam break", "impact peak at the lowest sensor within 25 % of the "
                                       f"measured one, mean over 5 ms, {words}",
                      lambda kernel=kernel: peak(kernel))
    sensors = impact_sensors()
    head = [f"{words} {height * 1e3:.0f} mm" for _, height, _ in sensors
            for words in ("peak", "mean of 5 ms,")]
    return [
        "p/(rho g H); measured peaks (Lobovsky et al. 2014): " +
        ", ".join(f"{top:g} at {1e3 * height:.0f} mm" for _, height, top in sensors) +
        paragraph("impact"), "",
        *report.table([*head, "time of the first", *STEPS], "impact", cells),
        *impact_figure(report, sensors, curve), paragraph("impact 2"), ""]


# --- solids alone ---
def beam(report):
    def measure(run):
        length = number(run, "L")
        time, dx = series(run, "M1_dx_m")
        _, dy = series(run, "M1_dy_m")
        late = time >= 0.8 * time[-1]  # two periods
        x, y = metrics.elastica(number(run, "load"))
        off = np.hypot(dx[late].mean() / length + 1 - x, dy[late].mean() / length - y)
        return dx[late].mean() / length, dy[late].mean() / length, x - 1, y, off, \
            np.ptp(dy[late]) / length

    def cells(run):
        dx, dy, x, y, off, left = measure(run)
        return [f"{dx:.4f}, {dy:.4f}", f"{x:.4f}, {y:.4f}", f"{100 * off:.2f}", f"{left:.1e}",
                *cost(run)]
    return [paragraph("beam"), "",
            *report.table(["tip", "elastica", "error (% of L)", "remaining motion", *STEPS],
                          "elastica", cells)]


def patch(report):
    program = BUILD / "tests" / "converge" / "test_solid_patch"

    def error():
        try:
            done = subprocess.run([str(program)], capture_output=True, text=True, check=False)
        except OSError:
            raise Missing("not built: make validate builds it") from None
        found = re.search(r"linear field: largest error of the gradient (\S+)",
                          done.stdout + done.stderr)
        return float(found[1]) if found and not done.returncode else float("inf")
    report.target("patch test", "a linear field is exact to round-off",
                  lambda: (f"{error():.1e}", error() < 1e-13))
    return [f"Largest error of the displacement gradient of a linear field, corners included, both "
            f"gradients, three bodies: {error():.1e} (of gradients up to 0.5).", ""]


def spin(run):
    """Relative change of the angular momentum, elastic over kinetic energy, error of the corner."""
    ledger = read_ledger(run)
    side, omega = number(run, "L"), number(run, "omega")
    time, dx = series(run, "corner_dx_m")
    exact = side / 2 * (np.cos(omega * time) - np.sin(omega * time) - 1)
    strain = ledger["elastic"] + ledger["hourglass"]
    return (turning(run)[0],
            float((strain / ledger["kinetic"]).max()),
            float(np.abs(dx - exact).max() / side))


def block(report):
    def cells(run):
        momentum, strain, corner = spin(run)
        return [f"{momentum:+.1e}", f"{strain:.1e}", f"{corner:.1e}", *cost(run)]

    def target():
        momentum, strain, _ = spin(report.run(report.first("block-20", "block-10")))
        return f"{momentum:+.1e}; {strain:.1e}", abs(momentum) < 1e-6 and strain < 1e-3
    report.target("free rotation", "angular momentum conserved to 1e-6; strain energy below 1e-3 "
                                   "of the kinetic energy", target)
    return [paragraph("block"), "",
            *report.table(["angular momentum", "strain over kinetic energy",
                           "error of the corner (of L)", *STEPS], "block", cells)]


def bar(report):
    def measure(run):
        time, dy = series(run, "M1_dy_m")
        length, speed = number(run, "L"), number(run, "c")
        static = -G * length ** 2 / (2 * speed ** 2)
        turns = metrics.crossings(time, dy - static)
        return (dy.mean() / static - 1, 2 * np.diff(turns).mean() / (4 * length / speed) - 1,
                run.summary["references"]["exact"]["rms_relative"])

    def cells(run):
        mean, period, rms = measure(run)
        return [f"{100 * mean:+.2f}", f"{100 * period:+.2f}", f"{100 * rms:.2f}", *cost(run)]
    return [paragraph("bar"), "",
            *report.table(["mean stretch (%)", "period (%)", "RMS (%)", *STEPS], "bar", cells)]
