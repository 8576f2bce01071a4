# SPDX-License-Identifier: MIT
"""The folder of a run, finished or not: probes, ledger, snapshots, pictures."""
from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterable, Sequence

import numpy as np

from . import files
from .files import BadFile
from .snapshots import FIELDS, KINDS, Snapshots

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _frame(columns: dict[str, np.ndarray]) -> Any:
    """A pandas DataFrame where pandas is there, else a structured array; the first column is the
    time."""
    try:
        import pandas
    except ImportError:
        table = np.empty(len(next(iter(columns.values()))), [(name, float) for name in columns])
        for name, values in columns.items():
            table[name] = values
        return table
    return pandas.DataFrame(columns)


class Group:
    """The particles of one kind in a snapshot: `group["pressure"]`, `group.x`."""

    def __init__(self, arrays: dict[str, np.ndarray]):
        self._arrays = arrays

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._arrays:
            raise BadFile(f"the snapshot has no field {name}; it has {', '.join(self._arrays)}")
        return self._arrays[name]

    def __getattr__(self, name: str) -> np.ndarray:
        if name.startswith("_") or name not in self._arrays:
            raise AttributeError(name)
        return self._arrays[name]

    def __iter__(self):
        return iter(self._arrays)

    def __len__(self) -> int:
        """Number of particles."""
        return len(self._arrays["x"])


class Snapshot:
    """All particles at an instant: `time` (s) and the groups `fluid`, `wall`, `solid` with the
    arrays of fields.vtkhdf (docs/formats.md has the units) and the positions x, y (m)."""

    fluid: Group
    wall: Group
    solid: Group

    def __init__(self, file: Snapshots, step: int):
        self.time = float(file.times[step])
        points, kinds = file.load(step, "Points"), file.load(step, "kind")
        arrays = {name: file.load(step, name) for name in file.root["PointData"]}
        for name, number in KINDS.items():
            here = kinds == number
            group = {"x": points[here, 0], "y": points[here, 1]}
            group.update((field, values[here]) for field, values in arrays.items())
            setattr(self, name, Group(group))

    def __repr__(self) -> str:
        return (f"<snapshot at {self.time:g} s: {len(self.fluid)} fluid, {len(self.wall)} wall, "
                f"{len(self.solid)} solid particles>")


class Run(files.Run):
    """The folder of a run. Files are read when they are asked for, so that a run that goes on can
    be watched; `refresh` reads the summary anew."""

    def refresh(self) -> Run:
        """Reads summary.json anew."""
        self.__init__(self.folder)
        return self

    @property
    def status(self) -> str:
        """How it ended: "finished", "guard", "interrupted", ...; "running" also after a kill."""
        return self.summary.get("exit_reason", "running")

    @property
    def is_running(self) -> bool:
        """Whether a process is at work in the folder now."""
        import fcntl
        try:
            with (self.folder / ".lock").open() as lock:
                fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
        except OSError:
            return False
        return False

    def probes(self, name: str | None = None) -> Any:
        """What the probes recorded so far, SI units: a pandas DataFrame where pandas is there, else
        a structured array, with columns time_s and <probe>_<quantity>_<unit>. `name`: of one probe
        alone, which may have a file and a rate of its own."""
        own = self.folder / f"probes_{name}.csv"
        if name is not None and own.exists():
            return _frame(self.table(own.name))
        table = self.table("probes.csv")
        if name is not None:
            found = {key: table[key] for key in table if key.startswith(name + "_")}
            if not found:
                raise BadFile(f"{self.folder / 'probes.csv'}: no column of a probe {name}; "
                              f"there are {', '.join(list(table)[1:])}")
            table = {"time_s": table["time_s"], **found}
        return _frame(table)

    def ledger(self) -> Any:
        """Energies (J/m), momenta (N s/m), mass (kg/m), time step (s) and extremes over time so
        far, in the form of `probes`."""
        return _frame(self.table("ledger.csv"))

    def _snapshots(self) -> Snapshots:
        return Snapshots(self.folder / "fields.vtkhdf")

    @property
    def times(self) -> np.ndarray:
        """Times of the snapshots so far, s."""
        with self._snapshots() as file:
            return file.times

    def snapshot(self, time: float) -> Snapshot:
        """The snapshot nearest to a time (s)."""
        with self._snapshots() as file:
            return Snapshot(file, file.nearest(time))

    def plot_probes(self, columns: str | Sequence[str] = (), **options: Any) -> Figure:
        """`sphfsi.plot_probes` of this run."""
        return plot_probes(self, columns, **options)

    def plot_fields(self, times: float | Sequence[float] = (), **options: Any) -> Figure:
        """`sphfsi.plot_fields` of this run."""
        return plot_fields(self, times, **options)

    def animate(self, out: str | os.PathLike | None = None, **options: Any) -> Path:
        """`sphfsi.animate` of this run."""
        return animate(self, out, **options)

    def __repr__(self) -> str:
        time = self.summary.get("time")
        return f"<run {self.folder}: {self.status}{'' if time is None else f' at {time:g} s'}>"


def open(folder: str | os.PathLike) -> Run:
    """The run in a folder, finished or going on."""
    return Run(folder)


def _runs(runs: Run | str | os.PathLike | Iterable[Run | str | os.PathLike]) -> list[Run]:
    if isinstance(runs, (Run, str, os.PathLike)):
        runs = [runs]
    found = [run if isinstance(run, Run) else Run(run) for run in runs]
    files.make_names_differ(found)
    return found


def _style():
    try:
        import matplotlib.pyplot as plt
    except ImportError as missing:
        raise files.Error(f"{missing.name} is missing; pip install {missing.name}") from None
    from .style import STYLE
    return plt.rc_context(STYLE)


def plot_probes(runs, columns: str | Sequence[str] = (), *, references: bool = True,
                out: str | os.PathLike | None = None) -> Figure:
    """Draws what probes of one or several runs recorded against time, with the references of their
    case: a panel for each unit, displacements above forces.

    `columns`: such as "M1_dx_m" (default: all); `out`: also a picture file."""
    with _style():
        from . import draw_probes
        runs = _runs(runs)
        tables = [run.curves() for run in runs]
        refs = draw_probes.case_references(runs) if references else []
        asked = [columns] if isinstance(columns, str) else list(columns)
        chosen = draw_probes.all_columns(runs, tables, refs, asked)
        figure, _ = draw_probes.draw_panels(chosen, draw_probes.curves_of(runs, tables, chosen),
                                            refs)
        if out is not None:
            figure.savefig(out)
    return figure


def _entry(kind: str, name: str) -> tuple:
    if name not in FIELDS[kind]:
        raise BadFile(f"there is no {kind} field {name} to draw; it is one of "
                      f"{', '.join(FIELDS[kind])}")
    return FIELDS[kind][name]


def plot_fields(runs, times: float | Sequence[float] = (), *, field: str = "pressure",
                solid: str = "von_mises", window: Sequence[float] | None = None,
                ranges: dict[str, Sequence[float]] | None = None,
                out: str | os.PathLike | None = None) -> Figure:
    """Draws snapshots of one or several runs, to scale: a row for each time (s), a column for each
    run.

    `field`: pressure, velocity, vorticity or density of the fluid; `solid`: von_mises, stress_xx,
    displacement or pressure; `window`: x0, x1, y0, y1 (m); `ranges`: {"fluid": (low, high),
    "solid": ...} of the colours in SI units; `out`: also a picture file."""
    with _style():
        from . import draw_fields
        runs = _runs(runs)
        found = [run._snapshots() for run in runs]
        entries = {"fluid": _entry("fluid", field), "solid": _entry("solid", solid)}
        instants = draw_fields.instants(found, list(np.atleast_1d(np.asarray(times, float))))
        panels = [draw_fields.load_panel(run, file, time, entries) for time in instants
                  for run, file in zip(runs, found)]
        scales = draw_fields.common_scales(panels, entries, ranges or {})
        figure = draw_fields.draw_rows(runs, panels, scales, window or draw_fields.frame(panels))
        for file in found:
            file.file.close()
        if out is not None:
            figure.savefig(out)
    return figure


def animate(runs, out: str | os.PathLike | None = None, *, field: str = "pressure",
            solid: str = "von_mises",
            window: Sequence[float] | None = None, ranges: dict[str, Sequence[float]] | None = None,
            fps: float = 10.0, dpi: float = 150.0) -> Path:
    """Writes a film of all snapshots, .mp4 (needs ffmpeg) or .gif, of several runs side by side;
    returns its path (default: fields.mp4 or fields.gif in the first run's folder). The rest is as
    in `plot_fields`."""
    with _style():
        from . import draw_fields
        runs = _runs(runs)
        found = [run._snapshots() for run in runs]
        entries = {"fluid": _entry("fluid", field), "solid": _entry("solid", solid)}
        path = Path(out) if out is not None else draw_fields.film_path(runs[0])
        draw_fields.film(runs, found, entries, ranges or {}, path, window=window, fps=fps, dpi=dpi)
        for file in found:
            file.file.close()
    return path
