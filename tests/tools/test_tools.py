#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the drawing tools on a small run that is made up here. Exit 77: a package is missing."""

import csv
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import TOOLS, packages
with packages():
    import h5py
    import matplotlib  # noqa: F401  the tools need it
    import numpy as np

END, STEPS, HEIGHT = 0.4, 5, 0.14


def lattice(x0, x1, y0, y1, dp):
    x, y = np.meshgrid(np.arange(x0 + dp / 2, x1, dp), np.arange(y0 + dp / 2, y1, dp))
    return np.stack([x.ravel(), y.ravel()], axis=1)


def tip(t):
    """Displacement of the free end, m."""
    return 0.046 * np.sin(np.pi * t / 0.3), 0.017 * np.sin(np.pi * t / 0.3) ** 2


def scene(dp, t):
    """Points and PointData of a column of water behind a gate at time t."""
    spread = 1 + 2 * t / END
    fluid = lattice(0, 0.1 * spread, 0, HEIGHT / spread, dp)
    walls = [lattice(-4 * dp, 0.4, -4 * dp, 0, dp), lattice(-4 * dp, 0, 0, 0.16, dp),
             lattice(0.1, 0.105, 0.079, 0.16, dp)]
    gate = lattice(0.1, 0.105, 0, 0.079, dp)
    # A beam: its centre line is bent to a parabola, its cross-sections turn with it.
    down, across = (0.079 - gate[:, 1]) / 0.079, gate[:, 0] - 0.1025
    share, turn = down ** 2, np.arctan(2 * down * tip(t)[0] / 0.079)
    moved = np.stack([share * tip(t)[0] + across * (np.cos(turn) - 1),
                      share * tip(t)[1] + across * np.sin(turn)], axis=1)
    sizes = [len(fluid), *map(len, walls), len(gate)]
    n, solid = sum(sizes), slice(sum(sizes) - len(gate), None)
    points = np.zeros((n, 3))
    points[:, :2] = np.concatenate([fluid, *walls, gate + moved])
    data = {"velocity": np.zeros((n, 3)), "density": np.full(n, 1000.0), "pressure": np.zeros(n),
            "von_mises": np.zeros(n), "det_F": np.ones(n), "displacement": np.zeros((n, 3)),
            "stress": np.zeros((n, 9)), "id": np.arange(n),
            "kind": np.repeat([0, 1, 1, 1, 2], sizes).astype(np.uint8),
            "body": np.repeat([0, 0, 1, 2, 0], sizes).astype(np.int32)}
    data["pressure"][:len(fluid)] = 9810 * (HEIGHT / spread - fluid[:, 1])
    data["velocity"][:len(fluid), :2] = (fluid * [20, -60]) ** 2
    data["displacement"][solid, :2] = moved
    data["stress"][solid, 0] = 3e5 * t / END * across / 0.0025 * (1 - share)
    data["von_mises"][solid] = np.abs(data["stress"][solid, 0])
    return points, data


def write_fields(path, dp, six_components=False):
    times = np.linspace(0, END, STEPS)
    scenes = [scene(dp, t) for t in times]
    counts = [len(points) for points, _ in scenes]
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root["Points"] = np.concatenate([points for points, _ in scenes])
        root["NumberOfPoints"] = counts
        for name in scenes[0][1]:
            values = np.concatenate([data[name] for _, data in scenes])
            if name == "stress" and six_components:
                values = values[:, [0, 4, 8, 1, 5, 2]]
            root["PointData/" + name] = values
        root["Steps/Values"] = times
        root["Steps/PointOffsets"] = np.cumsum(counts) - counts


def write_run(folder, dp=0.004, until=END, reason="finished", bias=0.0, **fields):
    """A run whose probe is `bias` m off the reference."""
    folder.mkdir(parents=True)
    t = np.linspace(0, until, 101)
    dx, dy = tip(t)
    np.savetxt(folder / "probes.csv", np.stack([t, dx + bias, dy], axis=1), delimiter=",",
               header="time_s,M1_dx_m,M1_dy_m", comments="")
    with open(folder / "probes.csv", "a") as file:
        file.write("0.5,0.0")  # as a run leaves it that is killed while it writes
    names = ["time_s", *(f"{e}_J_per_m" for e in ("kinetic", "potential", "internal", "elastic",
             "hourglass", "dissipated")), "momentum_x_Ns_per_m", "momentum_y_Ns_per_m",
             "mass_kg_per_m", "dens_extreme_1", "det_low_1", "dt_s"]
    fall, one = 5 * t / END, np.ones_like(t)
    rows = [t, 0.7 * fall, 9.6 - fall, 0.01 * fall, 0.05 * fall, 1e-3 * fall, 0.239 * fall,
            fall, -0.2 * fall, 14.4 * one, 0.004 * one + 1e-3 * fall, 1 - 0.01 * fall,
            1e-5 * one]
    np.savetxt(folder / "ledger.csv", np.stack(rows, axis=1), delimiter=",",
               header=",".join(names), comments="")
    (folder / "summary.json").write_text(json.dumps({"exit_reason": reason}))
    for name, k, at in (("lab", 0, np.linspace(0.02, 0.36, 18)), ("other", 0, t),
                        ("lab_y", 1, np.linspace(0.04, 0.36, 9))):
        kind = "NUMERICAL: made up" if name == "other" else "MEASURED: made up"
        np.savetxt(folder / f"{name}.csv", np.stack([at, tip(at)[k]], axis=1), delimiter=",",
                   header=f"# {kind}\ntime_s,value", comments="")
    (folder / "case.cfg").write_text(
        f"title = \"a # b\"\ndp = {dp} m  # spacing\n\n[probe M1]\nbody = gate\n"
        "[reference lab]\nprobe = M1_dx_m\nfile = lab.csv\n"
        "label = \"Experiment, Somebody et al. (2007)\"\n"
        "[reference other]\nprobe = M1_dx_m\nfile = other.csv\n"
        "label = \"Another SPH code, Somebody Else (2018)\"\n"
        "[reference lab_y]\nprobe = M1_dy_m\nfile = lab_y.csv\n"
        "label = \"Experiment, Somebody et al. (2007)\"\n")
    write_fields(folder / "fields.vtkhdf", dp, **fields)
    return folder


def tool(name, *args):
    """Runs a tool: exit status, standard output, standard error."""
    env = dict(os.environ, PYTHONDONTWRITEBYTECODE="1")
    done = subprocess.run([sys.executable, str(TOOLS / f"{name}.py"), *map(str, args)],
                          capture_output=True, text=True, env=env)
    return done.returncode, done.stdout, done.stderr


def draws(picture, name, *args):
    status, out, err = tool(name, *args)
    assert status == 0, err
    assert picture.stat().st_size > 10000, picture
    picture.unlink()
    return out


def refuses(word, name, *args):
    """The tool ends with 1 and one sentence that has `word` in it."""
    status, _, err = tool(name, *args)
    assert status == 1 and word in err and err.count("\n") == 1, (status, err)


def test_m1(tmp, good, halted):
    out = draws(tmp / "m1.png", "plot_m1", good, halted, "--out", tmp / "m1.png",
                "--csv", tmp / "m1.csv")
    assert "(stopped: guard)" in out and "lab_y" in out, out
    with open(tmp / "m1.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 6, rows
    rms = {(row["run"], row["reference"]): float(row["rms"]) for row in rows}
    assert abs(rms["halted (stopped: guard)", "lab"] - 1e-3) < 2e-5, rms
    assert rms["good", "lab"] < 2e-5, rms
    peak = next(row for row in rows if (row["run"], row["reference"]) == ("good", "other"))
    assert abs(float(peak["peak"]) - 0.046) < 1e-4, peak
    assert abs(float(peak["peak_time_s"]) - 0.15) < 5e-3, peak
    draws(good / "m1.png", "plot_m1", good, "--column", "M1_dy_m", "--reference",
          good / "lab_y.csv")
    refuses("no such folder", "plot_m1", tmp / "absent")
    refuses("no column", "plot_m1", good, "--column", "M2_dx_m")
    bad = tmp / "bad.csv"
    bad.write_text("time_s,value\n0,one\n")
    refuses("bad.csv, line 2", "plot_m1", good, "--reference", bad)
    out = draws(good / "m1.png", "plot_m1", good, "--name", "as measured", "--from", 0.2)
    peak = next(line.split() for line in out.splitlines() if "as measured" in line)
    assert float(peak[peak.index("mm") + 3]) >= 0.2, out
    refuses("ends before 99 s", "plot_m1", good, "--from", 99)
    from sphfsi.draw_probes import spread
    ends = [0.5, 0.5, 0.02, 0.5, 0.9]  # labels stay near their curves, in order, without overlap
    places = spread(ends, [1, 2, 1, 1, 1], 0.05)
    assert np.allclose(places, [0.425, 0.5, 0.025, 0.575, 0.9]), places
    assert np.allclose(spread([2, -1], [1, 1], 0.1), [0.95, 0.05])
    status, out, _ = tool("plot_m1")
    assert status == 1 and "example" in out, out


def test_probes(tmp):
    """All columns, those of one unit in one panel, displacements first, axes fitted to the data."""
    run = write_run(tmp / "panels")
    t = np.linspace(0.1, END, 101)
    rows = np.stack([t, 1e3 * t, -t, 50 + t, 3 + 0 * t], axis=1)
    np.savetxt(run / "probes_load.csv", rows, delimiter=",", comments="",
               header="time_s,load_fx_N_per_m,load_fy_N_per_m,P_p_Pa,wave_front_m")
    out = draws(run / "probes.png", "plot_probes", run)
    assert "lab_y" in out, out
    draws(tmp / "two.png", "plot_probes", run, good_copy(tmp), "--column", "M1_dx_m", "--out",
          tmp / "two.png")
    refuses("no column", "plot_probes", run, "--column", "M2_dx_m")
    from sphfsi import draw_probes
    from sphfsi.files import make_runs
    runs = make_runs([run])
    tables = [r.curves() for r in runs]
    columns = draw_probes.all_columns(runs, tables, [])
    assert draw_probes.panels_of(["load_fx_N_per_m", *columns])[0] == ["M1_dx_m",
                                                                       "M1_dy_m"], columns
    figure, units = draw_probes.draw_panels(columns, draw_probes.curves_of(runs, tables, columns),
                                            [])
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels == ["displacement (mm)", "P pressure (Pa)", "wave front (m)",
                      "force (N/m)"], labels
    assert units["M1_dy_m"] == (1e3, "mm") and units["load_fx_N_per_m"] == (1, "N/m"), units
    many = [f"p{k}_vx_m_per_s" for k in range(8)] + ["p_angle_rad"]
    turning = np.where(t < 0.2, 3.1, -3.1)
    panels, _ = draw_probes.draw_panels(many, {name: [(runs[0], t, turning)] for name in many}, [])
    looks = {(line.get_color(), line.get_linestyle()) for line in panels.axes[0].get_lines()[:8]}
    assert len(looks) == 8, looks
    speed, angle = (axes.get_lines()[0].get_ydata() for axes in panels.axes)
    assert np.isnan(angle).sum() == 1 and not np.isnan(speed).any()
    mixed = {"a_level_m": "level", "b_front_m": "front", "c_cx_m": "position", "c_cy_m": "position",
             "s_sxx_Pa": "stress", "s_sxy_Pa": "stress", "s_mises_Pa": "stress",
             "P_p_Pa": "pressure",
             "post_elastic_J_per_m": "energy", "e_Exx_SI": "strain", "e_Eyy_SI": "strain",
             "p_angle_rad": "rotation"}
    for column, kind in mixed.items():
        assert draw_probes.kinds_of([column, column]) == kind, column
    assert draw_probes.kinds_of(list(mixed)[:4]) == "level, front, position"
    low, high = figure.axes[1].get_ylim()
    assert 50 < low < 50.2 and 50.3 < high < 50.5, (low, high)
    assert figure.axes[1].get_xlim() == (0.1, END), figure.axes[1].get_xlim()


def test_refinement(tmp):
    """The folder of tools/refine.py: its resolutions, coarsest first; of one run, the finest."""
    study = tmp / "study"
    for dp in ("0.0025", "0.01", "0.005"):
        shutil.copytree(write_run(tmp / "one"), study / f"dp-{dp}")
        shutil.rmtree(tmp / "one")
    from sphfsi.files import make_runs
    names = [run.name for run in make_runs([study])]
    assert names == ["dp-0.01", "dp-0.005", "dp-0.0025"], names
    draws(study / "probes.png", "plot_probes", study)
    draws(study / "ledger.png", "plot_ledger", study, "--out", study / "ledger.png")


def good_copy(tmp):
    return write_run(tmp / "other")


def test_fields(tmp, good, halted):
    out = draws(good / "fields.png", "plot_fields", good)
    assert out.count("step") == 4, out
    out = draws(tmp / "f.pdf", "plot_fields", good, halted, "--time", 0.11, 0.3, "--field",
                "vorticity", "--solid", "stress_xx", "--window", -0.02, 0.2, 0, 0.15,
                "--out", tmp / "f.pdf")
    assert "t = 0.1 s (asked for 0.11 s)" in out, out
    draws(tmp / "f.png", "plot_fields", halted, "--field", "density", "--solid", "pressure",
          "--name", "stopped run", "--range", 900, 1100, "--out", tmp / "f.png")
    broken = tmp / "broken"
    write_run(broken)
    with h5py.File(broken / "fields.vtkhdf", "a") as file:
        del file["VTKHDF/PointData/von_mises"]
    refuses("no field von_mises", "plot_fields", broken)
    (broken / "fields.vtkhdf").write_text("no HDF5")
    refuses("not a temporal VTKHDF file", "plot_fields", broken)


def test_beams(tmp):
    """A beam is drawn along the places of its dummies, row after row, as thick as it is."""
    from sphfsi import draw_fields
    from sphfsi.run import Run
    from sphfsi.snapshots import Snapshots
    folder = write_run(tmp / "beam")
    row = np.linspace(0.1, 0.2, 11)
    with h5py.File(folder / "fields.vtkhdf", "a") as file:
        root = file["VTKHDF"]
        walls = np.flatnonzero(root["PointData/kind"][:] == 1)[:33]
        points = root["Points"][:]
        points[walls, :2] = np.stack([np.tile(row, 3), np.full(33, 0.3)], axis=1)
        root["Points"][...] = points
        root["PointData/thickness"] = np.where(np.isin(np.arange(len(points)), walls), 0.006, 0)
    panel = draw_fields.load_panel(Run(folder), Snapshots(folder / "fields.vtkhdf"), 0, {})
    (x, thickness), = panel["beams"]
    assert len(x) == 33 and not (panel["wall"]["x"][:, 1] > 0.2).any()
    axes = matplotlib.figure.Figure().add_subplot()
    draw_fields.draw_beam(axes, x, thickness)
    drawn = np.concatenate([path.vertices for path in axes.collections[0].get_paths()])
    assert np.allclose([drawn.min(axis=0), drawn.max(axis=0)], [[0.1, 0.297], [0.2, 0.303]])


def test_animate(tmp, good, halted):
    out = draws(good / "fields.gif", "animate", good, "--out", good / "fields.gif", "--dpi", 60)
    assert f"{STEPS} frames" in out and "t = 0 to 0.4 s" in out, out
    status, out, err = tool("animate", good, halted, "--field", "vorticity", "--out",
                            tmp / "both.mp4", "--dpi", 60)
    if shutil.which("ffmpeg"):
        assert status == 0 and (tmp / "both.mp4").stat().st_size > 3000, err
    else:
        assert status == 1 and "ffmpeg" in err and err.count("\n") == 1, err
    refuses("neither .mp4 nor .gif", "animate", good, "--out", tmp / "film.avi")


def test_rates(tmp):
    """A probe with a rate of its own stands in a file of its own, and is drawn all the same."""
    run = write_run(tmp / "rates")
    t = np.linspace(0, END, 1001)
    np.savetxt(run / "probes_load.csv", np.stack([t, 1e3 * t, -t, 0 * t], axis=1), delimiter=",",
               header="time_s,load_fx_N_per_m,load_fy_N_per_m,load_mz_Nm_per_m", comments="")
    draws(run / "m1.png", "plot_m1", run, "--column", "load_fx_N_per_m", "--column", "M1_dx_m")
    refuses("load_mz_Nm_per_m", "plot_m1", run, "--column", "load_mz")
    from sphfsi.draw_probes import column_words
    assert column_words("a_b_mz_Nm_per_m", 1.0) == ("a_b moment (N m/m)", 1.0, "N m/m")
    assert column_words("gauge_level_m", 0.1)[0] == "gauge water level (mm)"
    assert column_words("front_front_m", 1.0)[0] == "front (m)"
    assert column_words("far_front_front_m", 1.0)[0] == "far_front (m)"
    assert column_words("Q_q_m2_per_s", 1.0)[2] == "m²/s"


def test_case_sections(good):
    """Sections with and without a name."""
    from runfiles import read_case
    path = good / "sections.cfg"
    path.write_text("dp = 1\n[constants]\nH = 2 m # high\n[ probe M1 ]\nbody = gate\n")
    assert read_case(path) == [("top", "", {"dp": "1"}), ("constants", "", {"H": "2 m"}),
                               ("probe", "M1", {"body": "gate"})], read_case(path)


def test_vorticity():
    """Exact for a linear velocity, at a free surface and out of order too; none in a row."""
    from sphfsi.snapshots import vorticity
    random = np.random.default_rng(1)
    x = lattice(-1, 1, -0.5, 0.5, 0.05)
    x = random.permutation(x + random.uniform(-0.01, 0.01, x.shape))
    got = vorticity(x, np.stack([3 * x[:, 1] + x[:, 0], -2 * x[:, 0]], axis=1), 0.05)
    assert np.abs(got + 5).max() < 1e-9, got
    row = lattice(0, 1, 0, 0.05, 0.05)
    assert not vorticity(row, row[:, ::-1], 0.05).any()


def test_ledger(tmp, good):
    out = draws(good / "ledger.png", "plot_ledger", good)
    assert "kinetic 70 %" in out and "dissipated 23.9 %" in out, out
    ledger = good / "ledger.csv"
    head, *rows = ledger.read_text().splitlines()
    fields = [row.split(",") for row in rows]
    without = [",".join([*row[:-2], "inf", row[-1]]) for row in fields]  # as a fluid alone has it
    ledger.write_text("\n".join([head, *without, ""]))
    draws(good / "ledger.png", "plot_ledger", good)
    from sphfsi.draw_ledger import draw, read_ledger
    from sphfsi.files import Run
    run = Run(good)
    run.summary["title"] = "A dam break"
    assert draw(run, read_ledger(run)).axes[0].get_title() == "A dam break"
    (tmp / "empty").mkdir()
    refuses("cannot read", "plot_ledger", tmp / "empty")


def main():
    with tempfile.TemporaryDirectory() as folder:
        tmp = Path(folder)
        good = write_run(tmp / "good")
        halted = write_run(tmp / "halted", until=0.2, reason="guard", bias=1e-3,
                            six_components=True)
        test_vorticity()
        test_case_sections(good)
        test_m1(tmp, good, halted)
        test_fields(tmp, good, halted)
        test_beams(tmp)
        test_animate(tmp, good, halted)
        test_probes(tmp)
        test_refinement(tmp)
        test_rates(tmp)
        test_ledger(tmp, good)
    print("the tools draw what they are given and refuse what is broken")


if __name__ == "__main__":
    main()
