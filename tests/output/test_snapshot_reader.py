#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Readers that know nothing of sphfsi open fields.vtkhdf: h5py, and VTK's own reader, which is
ParaView's. Exit 77 where neither is installed."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

try:
    import h5py
    import numpy as np
except ImportError:
    h5py = None
try:
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError:
    vtk = None

SPHFSI = os.environ.get("SPHFSI", "./sphfsi")
CASE = "tests/fault/tiny.cfg"
STILL = "tests/fault/still.cfg"
FIELDS = {"velocity": ("f4", 3), "density": ("f4", 1), "pressure": ("f4", 1), "kind": ("i1", 1),
          "id": ("i8", 1), "body": ("i4", 1), "stress": ("f4", 6), "von_mises": ("f4", 1),
          "displacement": ("f4", 3), "det_F": ("f4", 1)}


def run(out, *options, case=CASE):
    subprocess.run([SPHFSI, case, "--out", str(out), "--quiet", *options], check=True,
                   stderr=subprocess.DEVNULL)


def check_layout(path):
    """The datasets add up; returns times and numbers of points."""
    with h5py.File(path, "r") as file:
        root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
        assert root.attrs["Type"] == b"UnstructuredGrid", root.attrs["Type"]
        assert root.attrs["Version"][0] == 2
        assert "title" in file["sphfsi"].attrs and file["sphfsi"].attrs["dp"] > 0
        n = int(steps.attrs["NSteps"])
        counts = root["NumberOfPoints"][:]
        assert len(counts) == n == len(steps["Values"]), (n, len(counts))
        assert np.all(np.diff(steps["Values"][:]) > 0)
        starts = np.cumsum(counts) - counts
        for name in ("PointOffsets", "CellOffsets", "ConnectivityIdOffsets"):
            assert np.array_equal(steps[name][:], starts), name
        assert np.array_equal(steps["PartOffsets"][:], np.arange(n))
        assert len(root["Points"]) == counts.sum() == len(root["Types"])
        assert len(root["Offsets"]) == counts.sum() + n
        for name, (kind, width) in FIELDS.items():
            data = root["PointData"][name]
            assert data.dtype == np.dtype("<" + kind) or data.dtype == np.dtype(kind), name
            assert data.shape == ((counts.sum(), width) if width > 1 else (counts.sum(),)), name
            assert np.array_equal(steps["PointDataOffsets"][name][:], starts), name
        return steps["Values"][:], counts


def check_numbers(path):
    """The first snapshot is the case: places, kinds, hydrostatic pressure, nothing bent."""
    with h5py.File(path, "r") as file:
        root = file["VTKHDF"]
        n = root["NumberOfPoints"][0]
        x, data = root["Points"][:n], {name: root["PointData"][name][:n] for name in FIELDS}
    fluid, solid = data["kind"] == 0, data["kind"] == 2
    assert fluid.sum() == 100 and solid.sum() == 45 and n > 145
    assert np.all(x[:, 2] == 0) and len(set(data["id"])) == n
    assert np.all((x[fluid] > -1e-12) & (x[fluid] < 0.1))
    deep = 1000 * 9.81 * (0.1 - x[fluid, 1])
    assert np.all(np.abs(data["pressure"][fluid] - deep) < 0.05 * deep.max())
    assert np.allclose(data["density"][solid], 1100) and np.allclose(data["det_F"], 1)
    assert not data["stress"].any() and not data["displacement"].any()


def check_beam(folder):
    """Fields of beams are there if the case has one, and zero elsewhere."""
    run(folder, "--until", "0.02", case="cases/templates/thin_plate.cfg")
    with h5py.File(folder / "fields.vtkhdf", "r") as file:
        root = file["VTKHDF"]
        n = root["NumberOfPoints"][0]
        x, data = root["Points"][:n], root["PointData"]
        plate = data["thickness"][:n] > 0
        assert plate.any() and np.allclose(x[plate, 0], 1.1)
        assert np.allclose(data["thickness"][:n][plate], 4e-3)
        for name in ("axial_force", "shear_force", "moment", "curvature"):
            assert not data[name][:n][~plate].any(), name


def check_restart(folder, whole):
    """Ended between two snapshots and continued: the same snapshots, without that of the end."""
    run(folder, "--until", "0.012")
    run(folder, "--restart")
    with h5py.File(folder / "fields.vtkhdf") as a, h5py.File(whole) as b:
        for name in ("Steps/Values", "NumberOfPoints", "Points"):
            assert np.array_equal(a["VTKHDF"][name][:], b["VTKHDF"][name][:]), name


def check_repacked(folder, whole):
    """A restart with another compression keeps that of the file, and the snapshots in it
    readable."""
    for first, then in ((2, 0), (0, 2)):
        place = folder / str(first)
        run(place, "--until", "0.012", "--set", f"output.snapshot_compression={first}")
        with h5py.File(place / "fields.vtkhdf") as a:
            for name in ("Points", "PointData/pressure"):
                assert a["VTKHDF"][name].compression == ("gzip" if first else None), name
                assert a["VTKHDF"][name].compression_opts == (first or None), name
                assert a["VTKHDF"][name].shuffle == (first > 0), name
        run(place, "--restart", "--set", f"output.snapshot_compression={then}")
        with h5py.File(place / "fields.vtkhdf") as a, h5py.File(whole) as b:
            n = b["VTKHDF/NumberOfPoints"][0]
            for name in ("Points", "PointData/pressure", "Connectivity"):
                assert np.array_equal(a["VTKHDF"][name][:n], b["VTKHDF"][name][:n]), (first, name)
                assert len(a["VTKHDF"][name][:]) > n


def check_dropped(folder):
    """A restart from an earlier checkpoint drops the snapshots behind it and makes them anew."""
    options = ["--set", "output.checkpoint_interval=0.009"]
    run(folder, *options)
    before = (folder / "fields.vtkhdf").read_bytes()
    times, counts = check_layout(folder / "fields.vtkhdf")
    first = sorted(folder.glob("*.ckpt"))[0]
    run(folder, *options, "--restart", str(first))
    again, recounts = check_layout(folder / "fields.vtkhdf")
    assert np.array_equal(times, again) and np.array_equal(counts, recounts)
    assert before and not (folder / "fields.vtkhdf.spare").exists()


def check_killed(folder):
    """Killed at any moment, also while it writes: the snapshots before stay readable."""
    for attempt in range(6):
        out = folder / str(attempt)
        process = subprocess.Popen([SPHFSI, STILL, "--out", str(out), "--quiet", "--set",
                                    "output.snapshot_interval=1e-3"], stderr=subprocess.DEVNULL)
        while not (out / "fields.vtkhdf").exists() and process.poll() is None:
            time.sleep(0.01)
        time.sleep(0.1 + 0.037 * attempt)
        process.send_signal(signal.SIGKILL)
        process.wait()
        times, _ = check_layout(out / "fields.vtkhdf")
        assert len(times) > 0


def check_times(times, folder):
    """Snapshots are of the first state at or after their times."""
    longest = json.loads((folder / "summary.json").read_text())["time_step"]["largest"]
    late = np.array(times) - 0.005 * np.arange(5)
    assert np.all((late >= 0) & (late < longest)) and late[0] == 0, times


def check_vtk(path, folder):
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    assert reader.CanReadFile(str(path))
    reader.UpdateInformation()
    key = vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()
    times = reader.GetOutputInformation(0).Get(key)
    assert reader.GetNumberOfSteps() == len(times) == 5, times
    check_times(times, folder)
    for step in range(len(times)):
        reader.SetStep(step)
        reader.Update()
        grid = reader.GetOutputAsDataSet()
        n = grid.GetNumberOfPoints()
        assert n > 145 and grid.GetNumberOfCells() == n
        assert grid.GetCell(n - 1).GetPointIds().GetId(0) == n - 1
        assert grid.GetCellType(n - 1) == vtk.VTK_VERTEX
        data = grid.GetPointData()
        for name, (_, width) in FIELDS.items():
            assert data.GetArray(name).GetNumberOfComponents() == width, name
            assert data.GetArray(name).GetNumberOfTuples() == n, name
        if h5py is None:
            continue
        with h5py.File(path, "r") as file:
            start = file["VTKHDF/Steps/PointOffsets"][step]
            for name, array in [("Points", grid.GetPoints().GetData())] + \
                    [("PointData/" + name, data.GetArray(name)) for name in FIELDS]:
                expected = file["VTKHDF/" + name][start:start + n]
                assert np.array_equal(vtk_to_numpy(array), expected), name


def main():
    if h5py is None and vtk is None:
        print("neither h5py nor vtk is installed")
        return 77
    with tempfile.TemporaryDirectory() as top:
        folder = Path(top)
        run(folder / "whole")
        path = folder / "whole/fields.vtkhdf"
        if h5py is not None:
            times, _ = check_layout(path)
            check_times(times, folder / "whole")
            check_numbers(path)
            check_restart(folder / "cut", path)
            check_beam(folder / "beam")
            check_repacked(folder / "packed", path)
            check_dropped(folder / "dropped")
            check_killed(folder / "killed")
        if vtk is not None:
            check_vtk(path, folder / "whole")
    print("read with " + " and ".join(m.__name__ for m in (h5py, vtk) if m is not None))
    return 0


if __name__ == "__main__":
    sys.exit(main())
