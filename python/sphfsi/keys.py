# SPDX-License-Identifier: MIT
"""The sections and keys of a case file as the program lists them, and a check of values."""
from __future__ import annotations

import difflib
import functools
import json
import re
from collections.abc import Mapping, Sequence
from numbers import Integral, Real
from typing import Any

from .library import Call, InputError, lib


@functools.cache
def sections() -> dict[str, dict]:
    """Sections by kind, "top" for the keys before them: meaning and keys, of each key its type,
    unit, range, default and meaning (docs/formats.md)."""
    found: list[str] = []
    call = Call(notes=found.append)
    call.finish(lib.sphfsi_keys_json(call.options))
    return json.loads(found[-1])["sections"]


def _kind(name: str, case: str) -> str | None:
    """The kind of the section that a change names by its name, its kind, or both."""
    first = name.split()[0] if name.strip() else ""
    if first in sections():
        return first
    return dict((word, kind) for kind, word in re.findall(r"(?m)^\[(\w+) +(\w+) *\]", case)
                ).get(name)


def _range(key: Mapping, value: Real) -> str:
    """What a number has to be instead; "" if it is in its range."""
    unit = f" {key['unit']}" if "unit" in key else ""
    limits = (("minimum", "at least", value >= key.get("minimum", value)),
              ("exclusiveMinimum", "above", value > key.get("exclusiveMinimum", -float("inf"))),
              ("maximum", "at most", value <= key.get("maximum", value)),
              ("exclusiveMaximum", "below", value < key.get("exclusiveMaximum", float("inf"))))
    return next((f"give a number {word} {key[limit]:g}{unit}" for limit, word, kept in limits
                 if not kept), "")


def _wrong(key: Mapping, value: Any) -> str:
    """What has to be given instead of a value that is not a text; "" if it is right."""
    kind = key["type"]
    if kind == "choice":
        return f"give one of {', '.join(key['choices'])}"
    if kind in ("number", "whole number"):
        if not isinstance(value, Integral if kind == "whole number" else Real) or value != value:
            return f"give a {kind}"
        return _range(key, value)
    if kind.startswith("two ") and not (isinstance(value, Sequence) and len(value) == 2):
        return f"give {kind}, such as (0, 1)"
    return ""


def check_changes(changes: Mapping[str, Any], case: str) -> None:
    """Raises InputError for a key that its section does not have and for a Python value that is of
    another type or outside its range. Texts are left to the program, and so are constants."""
    given = [(section, name, value) for section, values in changes.items()
             if isinstance(values, Mapping) for name, value in values.items()]
    given += [("top", name, value) for name, value in changes.items()
              if name in sections()["top"]["keys"]]
    for section, name, value in given:
        kind = _kind(section, case)
        if kind is None:
            continue
        keys = sections()[kind]["keys"]
        if name not in keys:
            near = difflib.get_close_matches(name, keys, 1)
            raise InputError(f"{section}: unknown key `{name}` of [{kind}]"
                             + (f"; did you mean `{near[0]}`?" if near else
                                f"; it has {', '.join(keys)}"))
        wrong = "" if isinstance(value, str) else _wrong(keys[name], value)
        if wrong:
            raise InputError(f"{section}: {name} = {value!r}: {wrong}: {keys[name]['meaning']}")
