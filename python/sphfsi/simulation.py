# SPDX-License-Identifier: MIT
"""A simulation in memory that a program steps itself."""
from __future__ import annotations

from typing import Any, Callable, Iterator, NamedTuple, Sequence

import numpy as np

from .library import Call, Error, InputError, check, ffi, lib, text

TYPES = {0: np.dtype(np.float64), 1: np.dtype(np.int64), 2: np.dtype(np.int32)}
KINDS = {"fluid": 0, "wall": 1, "solid": 2}


class Seen(NamedTuple):
    """Particles as a force sees them; the arrays are views that hold during the call."""

    time: float       #: s
    id: np.ndarray    #: stable numbers
    body: np.ndarray  #: index of the section among those of its kind
    x: np.ndarray     #: m
    y: np.ndarray     #: m
    vx: np.ndarray    #: m/s
    vy: np.ndarray    #: m/s


#: Takes the particles, returns their accelerations (ax, ay) in m/s^2: arrays or numbers.
Force = Callable[[Seen], "tuple[Any, Any]"]
#: Takes the time in s, returns displacement (m), velocity (m/s) and acceleration (m/s^2), two
# numbers each.
Motion = Callable[[float], "tuple[Sequence[float], Sequence[float], Sequence[float]]"]


def _array(pointer: Any, dtype: np.dtype, shape: tuple[int, ...]) -> np.ndarray:
    size = int(np.prod(shape)) * dtype.itemsize
    array = np.frombuffer(ffi.buffer(pointer, size), dtype).reshape(shape)
    array.flags.writeable = False
    return array


class Particles:
    """The particles of one kind. Fields are numpy views of the simulation's memory, without a copy,
    read only: `fluid.x` or `fluid["x"]`. A view shows the state of when it was taken until the next
    step; take it anew after each. The order of fluid particles changes between steps, their `id`
    stays."""

    def __init__(self, simulation: Simulation, kind: int, name: str):
        self._simulation, self._kind, self._name = simulation, kind, name

    def __len__(self) -> int:
        """Number of particles now."""
        return int(lib.sphfsi_count(self._simulation._handle, self._kind))

    @property
    def fields(self) -> list[str]:
        """Names of the fields that these particles have in this scene."""
        return list(self)

    def __iter__(self) -> Iterator[str]:
        k = 0
        while (name := lib.sphfsi_field_name(self._simulation._handle, self._kind, k)) != ffi.NULL:
            yield text(name)
            k += 1

    def __contains__(self, name: str) -> bool:
        return name in list(self)

    def _view(self, name: str) -> Any:
        view = ffi.new("struct sphfsi_view *")
        check(lib.sphfsi_field(self._simulation._handle, self._kind, name.encode(), view))
        return view

    def __getitem__(self, name: str) -> np.ndarray:
        """A field by its name: shape (n,), of a vector (n, 3), of a stress (n, 6: xx yy zz xy yz
        xz)."""
        view = self._view(name)
        shape = (view.count,) if view.components == 1 else (view.count, view.components)
        dtype = TYPES[view.type]
        if not view.count:
            return np.empty(shape, dtype)
        # The view keeps the simulation alive as long as it is in use.
        owner = self._simulation._handle
        data = ffi.gc(ffi.cast("char *", view.data), lambda _, owner=owner: None)
        return _array(data, dtype, shape)

    def __getattr__(self, name: str) -> np.ndarray:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self[name]
        except InputError as problem:
            raise AttributeError(str(problem)) from None

    def unit(self, name: str) -> str:
        """Unit of a field, such as "m/s"."""
        return text(self._view(name).unit)

    def meaning(self, name: str) -> str:
        """What a field is, in words."""
        return text(self._view(name).meaning)

    def __repr__(self) -> str:
        return f"<{len(self)} {self._name} particles: {', '.join(self)}>"


class Simulation:
    """A simulation in memory; writes no files. `Case.simulation` makes one.

    One thread at a time may use it. What it takes of memory is given back when it and all views of
    its fields are gone."""

    def __init__(self, call: Call):
        made = ffi.new("struct sphfsi_simulation **")
        status = lib.sphfsi_create(made, call.options)
        self._handle = ffi.gc(made[0], lib.sphfsi_free)  # also if a warning is an error
        call.finish(status)
        self._callbacks: dict[Any, Any] = {}
        self._problem: BaseException | None = None
        self.fluid, self.wall, self.solid = (Particles(self, kind, name) for name,
                                             kind in KINDS.items())

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return lib.sphfsi_time(self._handle)

    @property
    def end_time(self) -> float:
        """Time at which the case ends, s."""
        return lib.sphfsi_end_time(self._handle)

    @property
    def dt(self) -> float:
        """Last time step, s; 0 before the first."""
        return lib.sphfsi_time_step(self._handle)

    @property
    def next_output(self) -> float:
        """Time of the next output of a run of the case, s."""
        return lib.sphfsi_next_output(self._handle)

    @property
    def steps(self) -> int:
        """Number of steps taken."""
        return lib.sphfsi_steps(self._handle)

    def _finish(self, status: int) -> None:
        if self._problem is not None:
            raise Error("a force or motion of the program has failed; the simulation "
                        "cannot go on") \
                from self._problem
        check(status)

    def step(self, limit: float | None = None) -> float:
        """Takes one time step; of a solid without fluid, up to 16. Without a limit steps have the
        bits of a run of the case. A limit (s) that is near shortens them. Returns the time, s."""
        self._finish(0)
        self._finish(lib.sphfsi_step(self._handle, np.inf if limit is None else limit))
        return self.time

    def advance(self, time: float | None = None) -> float:
        """Steps until the time is exactly `time` (s; default: the end of the case). Ctrl-C stops it
        after a step. Returns the time, s."""
        limit = self.end_time if time is None else time
        self.step(limit)
        while self.time < limit:
            self.step(limit)
        return self.time

    def probe(self, name: str) -> np.ndarray:
        """Values of a probe of the case now, SI units; docs/cases.md has the columns of each
        quantity. Those that its quantity does not have are NaN."""
        values = ffi.new("double[5]", [np.nan] * 5)
        check(lib.sphfsi_probe(self._handle, name.encode(), values))
        return np.frombuffer(ffi.buffer(values), np.float64).copy()

    def hash(self) -> int:
        """Hash of the whole state; equal for equal bits."""
        self._finish(0)
        return lib.sphfsi_hash(self._handle)

    def _guarded(self, function: Callable) -> Callable:
        """A callback whose exception ends the simulation when the step is over."""
        def guarded(_, *args):
            if self._problem is None:
                try:
                    function(*args)
                except BaseException as problem:
                    self._problem = problem
        return guarded

    def set_force(self, kind: str, force: Force | None) -> None:
        """Sets a force on "fluid" or "solid": a function of the particles (`Seen`) that returns
        their accelerations (ax, ay) in m/s^2. It is called once or twice a step and should depend
        on its argument only; its work is in no ledger. None takes it away."""
        if kind not in KINDS:
            raise InputError(f"force: there is no kind '{kind}'; it is fluid or solid")
        function = ffi.NULL
        if force is not None:
            def call(p, ax, ay):
                n = int(p.n)
                seen = Seen(p.time, *(_array(getattr(p, name), dtype, (n,)) for name, dtype in (
                    ("id", TYPES[1]), ("body", TYPES[2]), ("x", TYPES[0]), ("y", TYPES[0]),
                    ("vx", TYPES[0]), ("vy", TYPES[0]))))
                for out, value in zip((ax, ay), force(seen)):
                    np.frombuffer(ffi.buffer(out, 8 * n), np.float64)[:] += value
            def unless_empty(p, ax, ay):
                if p.n:
                    call(p, ax, ay)
            function = ffi.callback("void(void *, const struct sphfsi_particles *, double *, "
                                    "double *)",
                                    self._guarded(unless_empty))
        check(lib.sphfsi_set_force(self._handle, KINDS[kind], function, ffi.NULL))
        self._callbacks[kind] = function

    def set_motion(self, name: str, motion: Motion | None) -> None:
        """Puts a function of the time (s) in the place of [motion NAME] of the case, from the next
        step on: it returns displacement from the place in the case (m), velocity (m/s) and
        acceleration (m/s^2), each as (x, y). None gives the case's own motion back."""
        function = ffi.NULL
        if motion is not None:
            def call(time, d, v, a):
                for out, value in zip((d, v, a), motion(time)):
                    out[0], out[1] = value
            function = ffi.callback("void(void *, double, double *, double *, double *)",
                                    self._guarded(call))
        check(lib.sphfsi_set_motion(self._handle, name.encode(), function, ffi.NULL))
        self._callbacks["motion", name] = function

    def __repr__(self) -> str:
        return (f"<simulation at {self.time:g} s of {self.end_time:g} s: {len(self.fluid)} fluid, "
                f"{len(self.wall)} wall, {len(self.solid)} solid particles>")
