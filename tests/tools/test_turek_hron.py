#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The reader of the Turek-Hron benchmark: periods, mean and amplitude of series of known answer."""

import os
import sys
from pathlib import Path

# small matrices: threads only wait for each other
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools" / "report"))
import turek_hron


def series(function, end=10.0, step=0.005):
    times = np.arange(0, end + 0.5 * step, step)
    return times, function(times)


def swing(times):
    """From rest to a swing of 1.9 Hz about 1.3, with a part of three times the frequency."""
    return 1.3 + np.minimum(1, times / 4) * (
        80 * np.sin(2 * np.pi * 1.9 * times) + 5 * np.sin(6 * np.pi * 1.9 * times))


def read(function, end=10.0):
    times, values = series(function, end)
    return turek_hron.summary(times, values, turek_hron.period(times, values))


def test_a_swing_that_repeats_itself():
    found = read(swing)
    assert found["state"] == "periodic" and found["periods"] >= turek_hron.PERIODS, found
    top = max(swing(np.linspace(8, 10, 4001)))
    assert abs(found["frequency"] - 1.9) < 1e-4, found
    assert abs(found["mean"] - 1.3) < 1e-3, found
    assert abs(found["amplitude"] - (top - 1.3)) < 0.01, found
    assert found["amplitude_error"] < 0.01, found


def test_noise_hides_neither_the_size_nor_its_error():
    """Noise that is half as large as the swing: 40 trials with seeds of their own. The amplitude
    has no bias, and its standard error is the scatter of the trials."""
    trials = []
    for seed in range(40):
        noise = np.random.default_rng(seed)
        found = read(lambda t, n=noise: swing(t) + n.normal(0, 40, len(t)))
        if found["state"] == "periodic":
            trials.append((found["amplitude"], found["amplitude_error"], found["frequency"]))
    assert len(trials) >= 36, len(trials)  # one in twenty scatters beyond twice its error
    sizes, errors, frequencies = np.array(trials).T
    top = max(swing(np.linspace(8, 10, 4001))) - 1.3
    assert abs(np.mean(sizes) -
               top) < 3 * np.std(sizes) / np.sqrt(len(sizes)) + 0.01 * top, np.mean(sizes)
    assert 0.6 < np.sqrt(np.mean(errors ** 2)) / np.std(sizes) < 1.7, (errors, np.std(sizes))
    assert np.max(abs(frequencies - 1.9)) < 0.01


def test_noise_alone_has_no_period():
    for seed in range(100):
        noise = np.random.default_rng(seed)
        times, values = series(lambda t, n=noise: n.normal(0, 1, len(t)))
        assert turek_hron.period(times, values) is None, seed


def test_the_second_harmonic_has_its_own_frequency():
    """Drag and ux repeat themselves twice in a period of lift and uy."""
    times, values = series(swing)
    drag = 439 + 5.6 * np.cos(4 * np.pi * 1.9 * times)
    found = turek_hron.summary(times, drag, turek_hron.period(times, values))
    assert abs(found["frequency"] - 3.8) < 1e-3 and abs(found["amplitude"] - 5.6) < 0.01, found


def test_a_swing_that_still_grows():
    """By a tenth and more from the first to the last of six periods."""
    for rate, frequency in ((0.4, 0.5), (0.4, 1.9), (0.1, 1.9)):
        found = read(lambda t, r=rate, f=frequency: np.exp(r * t) * np.sin(2 * np.pi * f * t))
        assert found["state"] == "neither steady nor periodic yet", (rate, frequency, found)


def test_what_rests():
    found = read(lambda t: -66.1 * (1 - np.exp(-2 * t)))
    assert found["state"] == "steady" and abs(found["mean"] + 66.1) < 0.01, found
    times, values = series(lambda t: -66.1 + 1e-3 * np.cos(900 * t), end=0.06)  # 13 samples
    found = turek_hron.summary(times, values, turek_hron.period(times, values))
    assert found["state"] == "steady" and abs(found["mean"] + 66.1) < 0.01, found


def correlated(noise, count, memory):
    """Noise of variance one that forgets within some samples."""
    values, keep = noise.normal(0, 1, count), np.exp(-1 / memory)
    for k in range(1, count):
        values[k] = keep * values[k - 1] + np.sqrt(1 - keep**2) * values[k]
    return values


def rest(function):
    times, values = series(function)
    return turek_hron.summary(times, values, None)


def test_noise_about_a_mean_rests():
    """With a standard error of 5 to 40 % of the mean, which the trials scatter by."""
    for memory, size in ((1, 2), (10, 1)):
        ratios = []
        for seed in range(30):
            noise = np.random.default_rng(seed)
            found = rest(lambda t, n=noise, m=memory, s=size: 1 + s * correlated(n, len(t), m))
            assert found["state"] != "steady", found
            if found["state"] == "steady within its noise":
                ratios.append((found["mean"] - 1) / found["mean_error"])
        assert len(ratios) >= 18, len(ratios)  # chance gives the others a trend
        assert 0.6 < np.sqrt(np.mean(np.array(ratios) ** 2)) < 1.7, ratios


def test_noise_hides_no_change():
    """Neither a drift of five standard errors, nor a slow swing or its end, nor noise that dies
    away."""
    for seed in range(10):
        noise = np.random.default_rng(seed)
        for change in (lambda t: t / 2,
                       lambda t: np.sin(2 * np.pi * 0.5 * t), lambda t: np.sin(2 * np.pi * 0.3 * t),
                       lambda t: 5 * np.exp(-t / 3) * np.sin(2 * np.pi * 0.4 * t)):
            found = rest(lambda t, n=noise, c=change: 1 + c(t) + n.normal(0, 0.5, len(t)))
            assert found["state"] == "neither steady nor periodic yet", (seed, found)
        found = rest(lambda t, n=noise: 1 + 100 * np.exp(-t / 3) * n.normal(0, 1, len(t)))
        assert found["state"] == "neither steady nor periodic yet", (seed, found)


def test_a_target_is_met_missed_or_not_shown():
    swing = {"state": "periodic", "mean": 1.3, "amplitude": 81.6 * 1.02, "frequency": 1.93 * 1.05}
    run = {"case": "fsi2", "cpu_seconds": 3600 * 2.5, "series": {"uy": swing}}
    assert turek_hron.judged(run, "uy", "amplitude", 3) == "+2.0 % | 3 % | met"
    assert turek_hron.judged(run, "uy", "frequency", 2) == "+5.0 % | 2 % | **missed**"
    assert turek_hron.judged(run, "run", "cost", 2) == "2.5 core-hours | 2 core-hours | **missed**"
    swing["amplitude_error"] = 81.6 * 0.004
    assert turek_hron.judged(run, "uy", "amplitude", 3) == "+2.0 ± 0.4 % | 3 % | met"
    swing["amplitude_error"] = 81.6 * 0.006
    assert turek_hron.judged(run, "uy", "amplitude", 3) == "+2.0 ± 0.6 % | 3 % | undecided: noise"
    swing["state"] = "steady within its noise"
    assert turek_hron.judged(run, "uy", "mean", 3) == "+0.0 % | 3 % | met"
    swing["state"] = "neither steady nor periodic yet"
    assert turek_hron.judged(run, "uy", "amplitude", 3).endswith("not shown")


def test_other_constants_are_judged_apart():
    """The finest run with the case's constants, and the finest with others; a short start is no
    other."""
    uy = {"state": "periodic", "mean": 1.3, "amplitude": 81.6, "frequency": 1.93, "periods": 6}
    kept = [{"case": "fsi2", "across": across, "settings": settings, "cpu_seconds": 36, "time": 1,
             "series": {"uy": {**uy, "amplitude": size}}}
            for across, settings,
            size in ((10, [], 90), (20, ["ramp=0.3 s", "kick=1.2 m/s"], 85.68),
                                           (20, ["numerics.sides=both"], 82.416))]
    rows = [line for line in turek_hron.headline(kept) if "| uy amplitude |" in line]
    assert len(rows) == 2, rows
    assert "20 (ramp=0.3 s, kick=1.2 m/s)" in rows[0] and "+5.0 % | 3 % | **missed**" in rows[0], \
        rows
    assert "20 (numerics.sides=both)" in rows[1] and "+1.0 % | 3 % | met" in rows[1], rows


def test_every_reference_has_its_case():
    for name in turek_hron.REFERENCE:
        assert (turek_hron.CASES / f"{name}.cfg").is_file(), name


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(f"ok {name}")
