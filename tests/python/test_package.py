#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The Python package: cases, runs, simulations, forces and motions of the program, mistakes. It is
that of the clone, or with SPHFSI_PACKAGE=installed the one that is installed. Exit 77: a package is
missing."""

import contextlib
import io
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import warnings
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import PROGRAM, ROOT, packages
with packages():
    import cffi  # noqa: F401  the package needs it
    import h5py  # noqa: F401
    import matplotlib
    import numpy as np

matplotlib.use("Agg")
os.environ.setdefault("OMP_NUM_THREADS", "1")
import sphfsi  # noqa: E402

TINY = ROOT / "tests" / "fault" / "tiny.cfg"
DROP = """dp = 2 mm
end_time = 1
[fluid water]
shape = box 0, 0, 20 mm, 20 mm
sound_speed = 10
artificial_viscosity = 0.1
[domain]
lower = -0.1, -0.1
upper = 0.1, 0.1
"""
PISTON = """dp = 5 mm
end_time = 1
gravity = 0, -9.81
[fluid water]
shape = box 0, 0, 0.1, 0.05
max_speed = 1
surface = 0.05
[wall floor]
shape = box -0.1, -20 mm, 0.3, 0
[wall piston]
shape = box -20 mm, 0, 0, 0.1
motion = push
[motion push]
[domain]
lower = -0.2, -0.1
upper = 0.4, 0.3
"""

JOINT = """dp = 5 cm
end_time = 0.5
gravity = 0, -9.81
[beam flap]
shape = polyline: 0, 0; 0.5, 0
axial_stiffness = 1e6
bending_stiffness = 100
mass = 1
[rigid bob]
shape = box 0.5, -0.1, 0.7, 0.1
mass = 1
[probe end]
quantity = displacement
body = flap
point = 0.5, 0
[probe bob]
quantity = pose
body = bob
"""


def raises(kind, words, function, *args, **options):
    try:
        function(*args, **options)
    except kind as problem:
        assert words in str(problem), problem
        return problem
    raise AssertionError(f"no {kind.__name__}")


def test_values():
    case = sphfsi.Case(TINY, dp="5 mm", gate={"young": 2e6}, output={"probe_interval": 1e-3},
                       gravity=(0, -5.5))
    text = case.effective()
    for line in ("dp = 0.005 m", "young = 2000000 Pa", "probe_interval = 0.001 s", "-5.5 m/s^2"):
        assert line in text, (line, text)
    again = case.with_changes(gate={"poisson": 0.3}).effective()
    assert "young = 2000000 Pa" in again and "poisson = 0.3" in again
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "push.csv").write_text("0, -9\n1, -10\n", encoding="utf-8-sig")
        here = Path(folder, "case.cfg")
        here.write_text(DROP + "[table push]\nfile = push.csv\n", encoding="utf-8-sig")
        text = sphfsi.Case(here, gravity="0, push(t)").effective()
        assert sphfsi.Case(text=text).explain()
    assert set(sphfsi.templates()) >= {"tank", "gate"}
    assert "end_time" in sphfsi.new("tank")
    raises(sphfsi.InputError, "there is no template 'tanc'", sphfsi.new, "tanc")


def test_before_a_run():
    case = sphfsi.Case(TINY)
    assert case.preview().svg.startswith("<svg")
    plan = case.explain(threads=1)
    assert plan["particles"] == {"fluid": 100, "wall": 204, "solid": 45}, plan["particles"]
    assert "100 particles" in str(plan) and plan["cost"]["threads"] == 1
    assert any("3 particles thick" in one for one in plan["warnings"]), plan["warnings"]
    bounds = plan["time_step_bounds"]
    assert bounds[plan["time_step_bound"]] == min(bounds.values())
    assert plan["parameters"]["solid"]["gate"]["poisson"] == 0.4
    assert any("2012" in line for line in case.cite()), case.cite()


def test_views():
    simulation = sphfsi.Case(TINY).simulation(threads=1)
    simulation.advance(0.002)
    assert simulation.time == 0.002 and simulation.steps > 1 and simulation.dt > 0
    fluid = simulation.fluid
    x = fluid.x
    assert len(fluid) == 100 == len(x) and x.dtype == np.float64 and fluid.id.dtype == np.int64
    assert x.__array_interface__["data"] == fluid["x"].__array_interface__["data"]  # no copy
    assert not x.flags.writeable
    raises(ValueError, "read-only", x.__setitem__, 0, 1.0)
    assert {"velocity", "pressure", "density", "vx", "p"} <= set(fluid.fields)
    assert simulation.solid["stress"].shape == (45, 6) and fluid.unit("velocity") == "m/s"
    assert np.array_equal(fluid["velocity"][:, 0], fluid.vx)
    raises(sphfsi.InputError, "did you mean `vx`", fluid.__getitem__, "vxx")
    raises(AttributeError, "no field 'stress'", getattr, fluid, "stress")
    assert np.isnan(simulation.probe("M1")[2:]).all() and \
        np.isfinite(simulation.probe("M1")[:2]).all()
    kept = x.copy()
    del simulation, fluid
    assert np.array_equal(x, kept)  # a view keeps what it shows


def test_forces():
    simulation = sphfsi.Case(text=DROP).simulation(threads=1)
    seen = []

    def weight(particles):
        seen.append((threading.get_ident(), len(particles.x)))
        return np.full(len(particles.x), 1.0), -5.0

    simulation.set_force("fluid", weight)
    simulation.advance(0.05)
    assert set(seen) == {(threading.get_ident(), 100)}
    assert np.allclose(simulation.fluid.vx, 0.05) and np.allclose(simulation.fluid.vy, -0.25)
    simulation.set_force("fluid", None)
    calls = len(seen)
    simulation.advance(0.051)
    assert len(seen) == calls
    raises(sphfsi.InputError, "not on wall", simulation.set_force, "wall", weight)
    raises(sphfsi.InputError, "there is no kind 'water'", simulation.set_force, "water", weight)


def test_a_force_that_fails():
    simulation = sphfsi.Case(text=DROP).simulation(threads=1)
    simulation.set_force("fluid", lambda particles: 1 / 0)
    problem = raises(sphfsi.Error, "has failed", simulation.step)
    assert isinstance(problem.__cause__, ZeroDivisionError)
    raises(sphfsi.Error, "cannot go on", simulation.step)


def test_motions():
    simulation = sphfsi.Case(text=PISTON).simulation(threads=1)
    simulation.set_motion("push", lambda t: ((1.5 * t * t, 0), (3 * t, 0), (3, 0)))
    simulation.advance(0.02)
    piston = simulation.wall.body == 1
    assert abs(simulation.wall.x[piston].min() - (-0.02 + 0.0025 + 1.5 * 0.02**2)) < 1e-12
    assert simulation.fluid.vx.max() > 0.02
    raises(sphfsi.InputError, "did you mean `push`", simulation.set_motion, "pusch", None)
    simulation.set_motion("push", lambda t: ((float("nan"), 0), (0, 0), (0, 0)))
    raises(sphfsi.Guard, "[motion push]", simulation.step)


def test_joints():
    """A joint of a beam is a tuple, with the name of a body: the flap swings with the body that is
    clamped to it; hinged to each other, but to nothing else, both fall."""
    for keys in ({"hinge": (0, 0), "clamp": (0.5, 0, "bob")}, {"hinge": (0.5, 0, "bob")}):
        p = sphfsi.Case(text=JOINT, flap=keys).run(f"runs/{len(keys)}", threads=1,
                                                   progress=False).probes()
        angle = p["bob_angle_rad"]
        for axis, at, arm in (("x", 0.5, -0.1 * np.cos(angle)), ("y", 0, -0.1 * np.sin(angle))):
            assert abs(p[f"bob_c{axis}_m"] + arm - at - p[f"end_d{axis}_m"]).max() < 1e-9
        assert angle[-1] < -1 if "clamp" in keys else abs(angle).max() < 1e-9
        fallen = -p["end_dy_m"][-1]
        assert "clamp" in keys or abs(fallen - 0.5 * 9.81 * 0.5**2) < 1e-6, fallen
    raises(sphfsi.InputError, "bib is no [wall], [rigid] or other [beam]",
           sphfsi.Case(text=JOINT, flap={"hinge": (0.5, 0, "bib")}).simulation)


def test_runs():
    case = sphfsi.Case(TINY, output={"snapshot_interval": "5 ms"})
    said = io.StringIO()
    with contextlib.redirect_stderr(said):
        run = case.run("runs/a", threads=1)
    assert run.status == "finished" and run.failure() is None and not run.is_running
    assert "%" in said.getvalue() and "t 0.02" in said.getvalue(), said.getvalue()
    raises(sphfsi.InputError, "runs/a", case.run, "runs/a")
    probes, ledger = run.probes(), run.ledger()
    assert probes["time_s"][0] == 0 and len(probes["time_s"]) > 100 and \
        "kinetic_J_per_m" in dir_of(ledger)
    assert dir_of(run.probes("M1")) == ["time_s", "M1_dx_m", "M1_dy_m"]
    raises(sphfsi.BadFile, "no column of a probe M7", run.probes, "M7")
    late = np.array(run.times) - [0, 0.005, 0.01, 0.015, 0.02]
    assert np.all((late >= 0) & (late < run.summary["time_step"]["largest"])), run.times
    shot = run.snapshot(0.011)
    assert shot.time == run.times[2] and len(shot.fluid) == 100 and len(shot.solid) == 45
    assert shot.fluid["velocity"].shape == (100, 3) and shot.solid.x.min() > 0.09
    if PROGRAM.is_file():
        subprocess.run([PROGRAM, TINY, "--set", "output.snapshot_interval=5 ms", "--out", "runs/b",
                        "--quiet", "--threads", "1"], check=True, stderr=subprocess.DEVNULL)
        other = sphfsi.open("runs/b")
        assert other.summary["state_hash"] == run.summary["state_hash"]
        assert np.array_equal(other.snapshot(0.02).fluid.pressure,
                              run.snapshot(0.02).fluid.pressure)
        sphfsi.plot_fields([run, other], 0.01, field="velocity", out="two.png")
        sphfsi.plot_probes(["runs/a", "runs/b"], "M1_dx_m", out="two-probes.png")
        assert Path("two.png").stat().st_size > 1000 and \
            Path("two-probes.png").stat().st_size > 1000
        panels = [axes.get_ylabel() for axes in other.plot_probes().axes]
        assert panels == ["displacement (mm)"], panels
    raises(sphfsi.BadFile, "no fluid field speed", run.plot_fields, field="speed")
    raises(sphfsi.BadFile, "no such folder", sphfsi.open, "runs/none")


def dir_of(table):
    return list(getattr(table, "columns", None) if hasattr(table, "columns") else table.dtype.names)


CHILD = """
import signal, sphfsi, sys, warnings
warnings.simplefilter("ignore")
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job has it ignored
try:
    sphfsi.Case(sys.argv[1], end_time="2 s").run("runs/stopped", progress=False, threads=1)
except sphfsi.Interrupted as stop:
    print("stopped:", stop)
"""


def test_interrupt():
    path = [str(Path(sphfsi.__file__).resolve().parents[1]),
            *filter(None, [os.environ.get("PYTHONPATH")])]
    child = subprocess.Popen([sys.executable, "-c", CHILD, str(TINY)], stdout=subprocess.PIPE,
                             text=True,
                             env={**os.environ, "PYTHONPATH": os.pathsep.join(path)})
    folder = Path("runs/stopped")
    for _ in range(600):  # until it has written some rows
        time.sleep(0.05)
        if (folder / "probes.csv").is_file() and (folder / "probes.csv").stat().st_size > 2000:
            break
    going = sphfsi.open(folder)
    assert going.is_running and going.status == "running" and len(going.probes()["time_s"]) > 5
    child.send_signal(signal.SIGINT)
    said, _ = child.communicate(timeout=60)
    assert "stopped: stopped by signal 2" in said and child.returncode == 0, said
    run = going.refresh()
    assert run.status == "interrupted" and not run.is_running and list(folder.glob("*.ckpt"))
    # What goes on from there has the bits of a run that was not stopped.
    until = float(f"{run.summary['time'] + 0.002:.3f}")
    case = sphfsi.Case(TINY, end_time="2 s")
    onward = case.run(folder, restart=True, until=until, progress=False, threads=1)
    whole = case.run("runs/whole", until=until, progress=False, threads=1)
    assert onward.summary["state_hash"] == whole.summary["state_hash"]


def test_errors():
    raises(sphfsi.InputError, "unknown key `yung`", sphfsi.Case(TINY, gate={"yung": 1}).simulation)
    for words, changes in {
        "gate: unknown key `pressure` of [solid]; it has like, shape,": {"gate": {"pressure": 1}},
        "of [output]; did you mean `probe_interval`?": {"output": {"probe_intervall": 1}},
        "solid gate: young = -1.0: give a number above 0 Pa": {"solid gate": {"young": -1.0}},
        "gate: poisson = 0.5: give a number below 0.5: Poisson": {"gate": {"poisson": 0.5}},
        "gate: law = 3: give one of paper, svk, neo_hookean: stress law": {"gate": {"law": 3}},
        "top: gravity = (0, 1, 2): give two numbers": {"gravity": (0, 1, 2)},
        "top: dp = None: give a number": {"dp": None},
        "top: dp = nan: give a number": {"dp": float("nan")},
        "output: snapshot_compression = 1.5: give a whole number":
            {"output": {"snapshot_compression": 1.5}},
    }.items():
        raises(sphfsi.InputError, words, sphfsi.Case(TINY, **changes).effective)
    raises(sphfsi.InputError, "nowhere.cfg", sphfsi.Case("nowhere.cfg").effective)
    raises(sphfsi.InputError, "case_path or case_text", sphfsi.Case().effective)
    raises(OSError, "", sphfsi.Case(TINY).preview, "/nowhere/x.svg")
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        sphfsi.Case(TINY).simulation(threads=1)
    thin = [w for w in seen if "only 3 particles thick" in str(w.message)]
    assert thin and thin[0].filename == __file__, "a warning names the caller's line"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        raises(sphfsi.CaseWarning, "only 3 particles thick", sphfsi.Case(TINY).simulation,
               threads=1)


def test_a_folder_with_results_is_kept_and_the_arguments_are_named():
    raises(sphfsi.InputError, "continue it with restart=True, choose another folder with out=...",
           sphfsi.Case(TINY).run, "runs/a", progress=False, threads=1)


def test_pictures_without_matplotlib_are_refused_with_a_sentence():
    code = ("import sys; sys.modules['matplotlib'] = None\nimport sphfsi\nrun = "
            "sphfsi.open('runs/a')\n"
            "for draw in run.plot_probes, run.plot_fields, run.animate:\n"
            "    try: draw()\n"
            "    except sphfsi.Error as e: assert 'pip install matplotlib' in str(e)\n"
            "    else: raise SystemExit('matplotlib?')\n")
    path = str(Path(sphfsi.__file__).resolve().parents[1])
    subprocess.run([sys.executable, "-c", code], check=True, env={**os.environ, "PYTHONPATH": path})


def test_reading_needs_no_library():
    """Neither cffi nor the library, and without pandas structured arrays."""
    code = ("import sys; sys.modules['cffi'] = None; sys.modules['pandas'] = None\n"
            "import sphfsi\nrun = sphfsi.open('runs/a')\n"
            "assert run.probes().dtype.names[0] == 'time_s' and len(run.snapshot(0).fluid) == 100\n"
            "try: sphfsi.Case('x')\nexcept sphfsi.Error as e: assert 'cffi is missing' in str(e)\n"
            "else: raise SystemExit('cffi?')\n")
    path = str(Path(sphfsi.__file__).resolve().parents[1])
    subprocess.run([sys.executable, "-c", code], check=True, env={**os.environ, "PYTHONPATH": path})


def main():
    warnings.simplefilter("ignore", sphfsi.CaseWarning)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name, test in list(globals().items()):
            if name.startswith("test_"):
                test()
        os.chdir(ROOT)
    print(f"the package of {Path(sphfsi.__file__).parent} does what it says")


if __name__ == "__main__":
    main()
