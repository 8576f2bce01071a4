# SPDX-License-Identifier: MIT
"""Snapshots of a run (fields.vtkhdf) and the fields that are drawn of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .files import BadFile

KINDS = {"fluid": 0, "wall": 1, "solid": 2}

# What can colour the particles. name: (array, unit, label, colour map, whether zero is the middle)
FIELDS = {
    "fluid": {"pressure": ("pressure", "Pa", "pressure", "viridis", False),
              "velocity": ("velocity", "m/s", "speed", "viridis", False),
              "vorticity": ("velocity", "1/s", "vorticity", "RdBu_r", True),
              "density": ("density", "kg/m³", "density", "viridis", False)},
    "solid": {"von_mises": ("von_mises", "Pa", "von Mises stress", "OrRd", False),
              "stress_xx": ("stress", "Pa", "stress $\\sigma_{xx}$", "PuOr_r", True),
              "displacement": ("displacement", "m", "displacement", "OrRd", False),
              "pressure": ("stress", "Pa", "pressure", "OrRd", False)}}


class Snapshots:
    """A temporal VTKHDF file: all steps one behind the other, found through the Steps group."""

    def __init__(self, path: str | Path):
        try:
            import h5py
        except ImportError:
            raise BadFile("h5py is missing; pip install h5py") from None
        self.path = path = Path(path)
        if not path.is_file():
            raise BadFile(f"cannot read {path}: no such file")
        try:
            self.file = h5py.File(path, "r")
            self.root = self.file["VTKHDF"]
            steps = self.root["Steps"]
            self.times = steps["Values"][:]
            counts = self.root["NumberOfPoints"][:]
            # One part for each step, unless the file says which part a step begins with.
            parts = steps["PartOffsets"][:] if "PartOffsets" in steps else np.arange(len(counts))
            self.counts = counts[parts[:len(self.times)]]
            self.starts = steps["PointOffsets"][:] if "PointOffsets" in steps else \
                (np.cumsum(counts) - counts)[parts]
        except (OSError, KeyError, IndexError) as problem:
            raise BadFile(f"{path}: not a temporal VTKHDF file ({problem})") from None
        if not 0 < len(self.times) <= min(len(self.counts), len(self.starts)):
            raise BadFile(f"{path}: no complete snapshot in it")

    def __enter__(self) -> Snapshots:
        return self

    def __exit__(self, *_) -> None:
        self.file.close()

    def nearest(self, time: float) -> int:
        """Index of the snapshot nearest to a time (s)."""
        return int(np.argmin(np.abs(self.times - time)))

    def has(self, name: str) -> bool:
        """Whether there is an array of PointData of this name."""
        return name in self.root["PointData"]

    def load(self, step: int, name: str) -> np.ndarray:
        """The positions ("Points", m) or an array of PointData at a step; docs/formats.md has the
        units."""
        start = self.starts[step]
        if name == "Points":
            data = self.root[name]
        elif self.has(name):
            data = self.root["PointData"][name]
            own = self.root.get("Steps/PointDataOffsets/" + name)
            start = start if own is None else own[step]
        else:
            raise BadFile(f"{self.path}: no field {name}; it has "
                          f"{', '.join(self.root['PointData'])}")
        if start + self.counts[step] > len(data):
            raise BadFile(f"{self.path}: {name} ends before step {step} does")
        return data[start:start + self.counts[step]]


def vorticity(x, v, dp):
    """dv/dx - du/dy from a velocity gradient that is exact for linear fields, also at a surface:
    kernel-weighted moments of the neighbours within 2.7 dp, found through cells of that side."""
    reach = 2.7 * dp
    cell = np.floor((x - x.min(axis=0)) / reach).astype(np.int64) + 1
    row = cell[:, 0].max() + 2  # an empty column at either side keeps rows apart
    key = cell[:, 1] * row + cell[:, 0]
    order = np.argsort(key, kind="stable")
    x, v, key = x[order], v[order], key[order]
    moments = np.zeros((7, len(x)))
    for shift in (-row, 0, row):  # the three cells of a row are one stretch of the sorted list
        first = np.searchsorted(key, key + shift - 1)
        count = np.searchsorted(key, key + shift + 2) - first
        i = np.repeat(np.arange(len(x)), count)
        j = np.arange(len(i)) + np.repeat(first - np.cumsum(count) + count, count)
        d = x[j] - x[i]
        weight = np.clip(1 - np.hypot(d[:, 0], d[:, 1]) / reach, 0, None) ** 3
        near = weight > 0
        i, j, d, weight = i[near], j[near], d[near], weight[near]
        (dx, dy), (du, dv) = d.T, (v[j] - v[i]).T
        for total, term in zip(moments, (dx * dx, dx * dy, dy * dy,
                                         du * dx, du * dy, dv * dx, dv * dy)):
            total += np.bincount(i, weight * term, len(x))
    xx, xy, yy, ux, uy, vx, vy = moments
    det = xx * yy - xy * xy
    # A drop of one or two particles, or a row of them, has no gradient.
    sound = det > 1e-3 * (xx + yy) ** 2
    curl = (vx * yy - vy * xy) - (uy * xx - ux * xy)
    result = np.zeros(len(x))
    result[order] = np.where(sound, curl / np.where(sound, det, 1), 0)
    return result


def field_values(entry, data, x, dp):
    """Values of a field (SI) from the rows of its array that belong to the particles at x."""
    array, _, label, _, _ = entry
    if label == "vorticity":
        return vorticity(x, data[:, :2].astype(float), dp)
    if array in ("velocity", "displacement"):
        return np.hypot(data[:, 0], data[:, 1])
    if array == "stress":
        # Rows of a 3 x 3 matrix, or xx, yy, zz, xy, yz, xz.
        data = data.reshape(len(data), -1)
        normal = data[:, [0, 4, 8]] if data.shape[1] == 9 else data[:, :3]
        return -normal.mean(axis=1) if label == "pressure" else normal[:, 0]
    return data
