# SPDX-License-Identifier: MIT
"""The shared library, called through cffi as include/sphfsi.h declares it."""
from __future__ import annotations

import logging
import os
import re
import sys
import warnings
from pathlib import Path
from typing import Any, Callable

from .files import Error

try:
    import cffi
except ImportError:
    raise Error("cffi is missing; pip install cffi") from None

log = logging.getLogger("sphfsi")


class InputError(Error, ValueError):
    """The case, a file that it names, or an argument is wrong; nothing was started."""


class Guard(Error, ArithmeticError):
    """The numerical state is no longer valid: the run or simulation was stopped."""


class Interrupted(KeyboardInterrupt):
    """A run was stopped by Ctrl-C; its folder holds a checkpoint, from which `restart=True` goes
    on."""


class CaseWarning(UserWarning):
    """What the program warns of: consequence and remedy are in the sentence."""


def _level_of_caller() -> int:
    """The stack level, as warnings.warn counts it, of the first caller outside this package."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back and Path(frame.f_code.co_filename).parent == Path(__file__).parent:
        level, frame = level + 1, frame.f_back
    return level


def _declarations(header: str) -> str:
    """What cffi takes of the header: no comments, no preprocessor, no attributes."""
    text = re.sub(r"/\*.*?\*/", " ", header, flags=re.S)
    text = re.sub(r"^#ifdef __cplusplus\n.*?^#endif\n", "", text, flags=re.S | re.M)
    text = re.sub(r"^\s*#.*(?:\\\n.*)*$", "", text, flags=re.M)
    return "typedef int sig_atomic_t;\n" + text.replace("SPHFSI_API", "")


def _places() -> list[tuple[Path, Path]]:
    """Where library and header may be: named by SPHFSI_LIBRARY, in the package, in a clone."""
    here = Path(__file__).resolve().parent
    clone = here.parents[1]
    suffix = "dylib" if sys.platform == "darwin" else "so"
    places = [(here / "_lib" / f"libsphfsi.{suffix}", here / "_lib" / "sphfsi.h"),
              (clone / "build" / "release" / "libsphfsi.so", clone / "include" / "sphfsi.h")]
    named = os.environ.get("SPHFSI_LIBRARY")
    if named:
        places.insert(0, (Path(named), next((h for _, h in places if h.is_file()), places[0][1])))
    return places


def _load() -> tuple[cffi.FFI, Any]:
    ffi = cffi.FFI()
    for library, header in _places():
        if not library.is_file() or not header.is_file():
            continue
        ffi.cdef(_declarations(header.read_text(encoding="utf-8")))
        try:
            return ffi, ffi.dlopen(str(library))
        except OSError as problem:
            raise Error(f"{library}: cannot be loaded: {problem}") from None
    raise Error("there is no libsphfsi.so here; run `make` in the clone, or `pip install .`")


ffi, lib = _load()


def text(pointer) -> str:
    """A text of the library."""
    return ffi.string(pointer).decode("utf-8", "replace")


def version() -> str:
    """Version of the library, such as "0.1.0+abcdef"."""
    return text(lib.sphfsi_version())


# Options of the command line in sentences of the program, and what they are called here.
_ARGUMENTS = {"--restart": "restart=True", "--out": "out=...", "--fork": "fork=..."}


def check(status: int) -> None:
    """Raises what a failure stands for, with the sentence of the program."""
    if status == lib.SPHFSI_OK:
        return
    sentence = text(lib.sphfsi_error())
    for option, argument in _ARGUMENTS.items():
        sentence = sentence.replace(option, argument)
    kinds = {lib.SPHFSI_INPUT: InputError, lib.SPHFSI_MEMORY: MemoryError, lib.SPHFSI_IO: OSError,
             lib.SPHFSI_GUARD: Guard, lib.SPHFSI_INTERRUPT: Interrupted}
    raise kinds.get(status, Error)(sentence)


def _bytes(value: str | os.PathLike) -> bytes:
    return os.fsencode(os.fspath(value))


class Call:
    """Options of one call of the library, with its callbacks. An exception in one of them is raised
    when the call is over."""

    def __init__(self, *, notes: Callable[[str], None] | None = None,
                 progress: Callable[[Any], None] | None = None, **options: Any):
        self.problem: BaseException | None = None
        self.requests = ffi.new("struct sphfsi_requests *")
        self.options = ffi.new("struct sphfsi_options *")
        self._kept: list[Any] = []
        self._notes, self._progress = notes, progress
        self.options.message = self._callback("void(*)(void *, enum sphfsi_message, const char *)",
                                              self._on_message)
        if progress:
            self.options.progress = self._callback(
                "void(*)(void *, const struct sphfsi_progress *)", self._on_progress)
        self.options.requests = self.requests
        for name, value in options.items():
            if value is not None:
                setattr(self.options, name, self._value(value))

    def _value(self, value: Any) -> Any:
        if isinstance(value, list):
            items = [ffi.new("char[]", _bytes(item)) for item in value]
            array = ffi.new("const char *[]", items)
            self.options.n_sets = len(items)
            self._kept += [items, array]
            return array
        if isinstance(value, (str, os.PathLike)):
            kept = ffi.new("char[]", _bytes(value))
            self._kept.append(kept)
            return kept
        return value

    def _callback(self, signature: str, function: Callable) -> Any:
        def guarded(_, *args):
            if self.problem is None:
                try:
                    function(*args)
                except BaseException as problem:
                    self.problem = problem
                    self.requests.stop = 1
        kept = ffi.callback(signature, guarded)
        self._kept.append(kept)
        return kept

    def _on_message(self, kind: int, message: Any) -> None:
        if kind == lib.SPHFSI_WARNING:
            warnings.warn(text(message), CaseWarning, stacklevel=_level_of_caller())
        elif self._notes:
            self._notes(text(message))
        else:
            log.info("%s", text(message))

    def _on_progress(self, progress: Any) -> None:
        assert self._progress is not None
        self._progress(progress)

    def finish(self, status: int) -> None:
        """Raises what went wrong in a callback or in the call."""
        if self.problem is not None:
            raise self.problem
        check(status)
