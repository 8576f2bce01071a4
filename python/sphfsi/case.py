# SPDX-License-Identifier: MIT
"""A case: what it would be and cost, and its runs."""
from __future__ import annotations

import json
import os
import signal
import sys
import tempfile
import threading
import warnings
from pathlib import Path
from typing import Any, Callable, Mapping, Sequence, TextIO

from .budget import find_dp
from .keys import check_changes
from .library import Call, check, ffi, lib, log, text
from .refine import Refinement
from .run import Run
from .simulation import Simulation


def _value(value: Any) -> str:
    """A value as a case file has it."""
    if isinstance(value, (tuple, list)):
        return ", ".join(_value(item) for item in value)
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, (int, str)):
        return str(value)
    return repr(float(value))


def _sets(changes: Mapping[str, Any]) -> list[str]:
    sets = []
    for key, value in changes.items():
        if isinstance(value, Mapping):
            sets += [f"{key}.{name}={_value(item)}" for name, item in value.items()]
        else:
            sets.append(f"{key}={_value(value)}")
    return sets


class Preview:
    """The drawing of a scene; notebooks show it."""

    def __init__(self, svg: str):
        self.svg = svg

    def save(self, path: str | os.PathLike) -> None:
        """Writes it as SVG."""
        Path(path).write_text(self.svg, encoding="utf-8")

    def _repr_svg_(self) -> str:
        return self.svg


class Explanation(dict):
    """What a case would be and what it would cost; docs/formats.md lists the keys. `text` is the
    same in lines, and `print` shows it."""

    text: str

    def __str__(self) -> str:
        return self.text


class _Progress:
    """A bar in one line on a terminal, a line for every tenth elsewhere."""

    def __init__(self, out: TextIO):
        self.out, self.live, self.tenth, self.open = out, out.isatty(), 0, False

    def __call__(self, p: Any) -> None:
        way = p.end_time - p.start_time
        share = min(1.0, (p.time - p.start_time) / way) if way > 0 else 1.0
        if not self.live and int(10 * share) <= self.tenth:
            return
        self.tenth = int(10 * share)
        left = f"{p.seconds_left:.0f} s left" if p.seconds_left >= 0 else ""
        bar = "#" * int(30 * share)
        line = (f"{100 * share:5.1f} % |{bar:<30}| t {p.time:.4g} s, dt {p.dt:.3g} s "
                f"({text(p.bound)}), "
                f"{1e-6 * p.particle_steps_per_second:.3g} M particle steps/s, {left}")
        self.out.write(f"\r{line}\033[K" if self.live else line + "\n")
        self.out.flush()
        self.open = self.live

    def close(self) -> None:
        if self.open:
            self.out.write("\n")
            self.open = False


class Case:
    """A case file, or the text of one, with values in effect over it.

        Case("cases/gate.cfg", dp="1 mm", gate={"young": "8 MPa"}, output={"probe_interval": 1e-3})

    Keys are those of the case file (docs/cases.md): at the top or named constants as they are,
    those of a section in a mapping under its name. Values are text with units, or numbers in SI
    units."""

    def __init__(self, path: str | os.PathLike | None = None, *, text: str | None = None,
                 **changes: Any):
        self.path = None if path is None else Path(path)
        self.text = text
        self.changes = changes

    def with_changes(self, **changes: Any) -> Case:
        """The same case with further values in effect; those of a section are added to it."""
        merged = dict(self.changes)
        for key, value in changes.items():
            before = merged.get(key)
            both = isinstance(before, Mapping) and isinstance(value, Mapping)
            merged[key] = {**before, **value} if both else value
        return Case(self.path, text=self.text, **merged)

    def _call(self, **options: Any) -> Call:
        if self.text is not None:
            check_changes(self.changes, self.text)
        elif self.path is not None and self.path.is_file():
            check_changes(self.changes, self.path.read_text(encoding="utf-8", errors="replace"))
        return Call(case_path=self.path, case_text=self.text, sets=_sets(self.changes), **options)

    def effective(self, *, until: float = 0.0) -> str:
        """The case in effect, every default spelled out in SI units, with absolute names of
        files."""
        call = self._call(until=until)
        with tempfile.TemporaryFile("w+", encoding="utf-8") as out:
            call.finish(lib.sphfsi_effective(call.options, os.fsencode(f"/dev/fd/{out.fileno()}")))
            return out.read()

    def write_effective(self, path: str | os.PathLike, *, until: float = 0.0) -> str:
        """Writes the case in effect to a file; names of files in it are relative to that file."""
        call = self._call(until=until)
        call.finish(lib.sphfsi_effective(call.options, os.fsencode(path)))
        return Path(path).read_text(encoding="utf-8")

    def preview(self, path: str | os.PathLike | None = None) -> Preview:
        """Draws the scene as it would start; writes it to `path` (SVG), if there is one."""
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "preview.svg"
            call = self._call(out=out)
            call.finish(lib.sphfsi_preview(call.options))
            preview = Preview(out.read_text(encoding="utf-8"))
        if path is not None:
            preview.save(path)
        return preview

    def explain(self, *, until: float = 0.0, threads: int = 0) -> Explanation:
        """What would be simulated and what it would cost on this machine: particles, effects with
        what calls for them, bounds of the time step (s), wall time (s), memory and disk (bytes),
        all values in effect."""
        lines: list[str] = []
        call = self._call(until=until, threads=threads, notes=lines.append)
        call.finish(lib.sphfsi_explain(call.options))
        found: list[str] = []
        with warnings.catch_warnings():  # the first call has said them
            warnings.simplefilter("ignore")
            call = self._call(until=until, threads=threads, notes=found.append)
            call.finish(lib.sphfsi_explain_json(call.options))
        explanation = Explanation(json.loads(found[-1]))
        explanation.text = "\n".join(lines)
        return explanation

    def cite(self) -> list[str]:
        """Where the methods that the case uses come from, a line each."""
        lines: list[str] = []
        call = self._call(notes=lines.append)
        call.finish(lib.sphfsi_cite(call.options))
        return lines

    def simulation(self, *, threads: int = 0) -> Simulation:
        """A simulation in memory at time zero, to be stepped; no file is written. `threads`: 0 for
        as many as are useful."""
        return Simulation(self._call(threads=threads))

    def folder(self, *, fork: bool = False) -> Path:
        """Folder of the results where `run` is given none."""
        name = self.path.name.removesuffix(".cfg") if self.path is not None else "case"
        return Path("runs") / (name + "-fork" * fork)

    def run(self, out: str | os.PathLike | None = None, *, progress: bool = True,
            restart: bool = False,
            fork: str | os.PathLike | None = None, until: float = 0.0, threads: int = 0,
            notes: Callable[[str], None] | None = None) -> Run:
        """Runs the case to its end, or to `until` (s), and returns its results.

        `out`: folder of the results (default: runs/NAME, of a fork runs/NAME-fork); `restart`: go
        on from its newest checkpoint; `fork`: begin with the state of another run; `notes`: called
        with each line that the program would print. Ctrl-C leaves a checkpoint and raises
        `Interrupted`."""
        folder = Path(out) if out is not None else self.folder(fork=fork is not None)
        bar = _Progress(sys.stderr) if progress else None
        # The callback is also where Python gets to see a signal.
        call = self._call(out=folder, restart=int(restart), fork=fork, until=until, threads=threads,
                          notes=notes, progress=bar or (lambda _: None), progress_interval=0.1)
        with _Stopping(call):
            status = lib.sphfsi_run(call.options)
        if bar:
            bar.close()
        call.finish(status)
        return Run(folder)

    def refinement(self, out: str | os.PathLike | None = None, *, runs: int = 3,
                   ratio: float | None = None, until: float = 0.0, threads: int = 0,
                   start: float | None = None, without: Sequence[str] = (), repeats: int = 3,
                   notes: Callable[[str], None] | None = None) -> Refinement:
        """A plan of runs over spacing, kernel, speed of sound and step, and its cost: `runs`
        spacings that grow by `ratio` (None: the largest of 2, 1.5 and 1.25 that fits). `without`:
        directions to leave out, of kernel, sound, step, repeats. `start`: all measures are of the
        time from here on. `notes`: called with a line on each run."""
        return Refinement(self, Path(out) if out is not None else self.folder(), runs, ratio, until,
                          threads, start, without, repeats, notes or log.info)

    def refine(self, out: str | os.PathLike | None = None, *, progress: bool = False,
               results: Callable[[str], None] | None = None, **plan: Any) -> dict:
        """Carries out a `refinement` and returns what probes and energies converge to, with bands
        of 90 %: refine.json of docs/formats.md. Finished runs are not run again. `results`: called
        with the lines of the table."""
        study = self.refinement(out, **plan)
        study.run(progress)
        return study.report(results or log.info)

    def budget(self, seconds: float, *, until: float = 0.0, threads: int = 0,
               notes: Callable[[str], None] | None = None) -> float | None:
        """The finest round dp (m) that runs within so many seconds of wall time and fits all bodies
        to the lattice, or None. `notes`: called with lines on the costs of several dp and on the
        errors to expect."""
        return find_dp(self, seconds, until, threads, notes or log.info)

    def __repr__(self) -> str:
        changes = "".join(f", {item}" for item in _sets(self.changes))
        return f"<case {self.path or 'of a text'}{changes}>"


class _Stopping:
    """While it holds, SIGINT (Ctrl-C) or SIGTERM asks the run to write a checkpoint and stop; a
    second one is an exception."""

    def __init__(self, call: Call):
        self.call, self.before = call, {}

    def _stop(self, number: int, frame: Any) -> None:
        if self.call.requests.stop:
            raise KeyboardInterrupt
        self.call.requests.stop = number

    def __enter__(self) -> None:
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                self.before[number] = signal.signal(number, self._stop)

    def __exit__(self, *_: Any) -> None:
        for number, action in self.before.items():
            signal.signal(number, action)


def templates() -> list[str]:
    """Names of the commented cases to start from."""
    names = []
    while (name := lib.sphfsi_template_name(len(names))) != ffi.NULL:
        names.append(text(name))
    return names


def new(template: str) -> str:
    """The text of a commented case to start from."""
    found = lib.sphfsi_template(template.encode())
    if found == ffi.NULL:
        check(lib.SPHFSI_INPUT)
    return text(found)
