# SPDX-License-Identifier: MIT
"""A run as the data of a page for browsers (tools/view.py): particles of all snapshots in few bytes
each, their colours, the curves of its probes."""
import matplotlib.pyplot as plt
import numpy as np

from .draw_fields import colour_scale, frame, load_panel
from .draw_probes import column_words
from .files import BadFile, references
from .snapshots import FIELDS, KINDS, Snapshots

ROWS = 2000  # of a probe's curve


def stored_fields(file, kind):
    """Fields to colour a kind by whose arrays the file has."""
    arrays = file.root["PointData"]
    return {name: entry for name, entry in FIELDS.get(kind, {}).items() if entry[0] in arrays}


def panels_of(run, file, steps):
    """Panels of all fields: {kind: {field: [panel of each step]}}."""
    fields = {kind: stored_fields(file, kind) for kind in ("fluid", "solid")}
    found = {kind: {} for kind in fields}
    for k in range(max(map(len, fields.values()))):
        names = {kind: list(own)[k] for kind, own in fields.items() if k < len(own)}
        entries = {kind: fields[kind][name] for kind, name in names.items()}
        panels = [load_panel(run, file, file.times[step], entries) for step in steps]
        for kind, name in names.items():
            found[kind][name] = panels
    return found


def as_bytes(values, low, high):
    share = (np.nan_to_num(values, nan=low) - low) / (high - low)
    return np.clip(np.rint(255 * share), 0, 255).astype(np.uint8)


def packed_places(x, window):
    """Positions as 16 bits over the window, high bytes first; what lies outside is moved to its
    edge."""
    low, high = np.array(window[::2]), np.array(window[1::2])
    places = np.clip(np.rint(65535 * (x - low) / (high - low)), 0, 65535).astype(np.uint16)
    parts = []
    for axis in range(2):
        parts += [(places[:, axis] >> 8).astype(np.uint8), (places[:, axis] & 255).astype(np.uint8)]
    return parts


def pack_group(kind, panels, fields, window, offset):
    """A group of particles as the page wants it, and its bytes."""
    first = next(iter(fields.values()), panels)
    at_rest = kind == "wall" and all(np.array_equal(p["wall"]["x"], first[0]["wall"]["x"])
                                     for p in first)
    steps = range(1 if at_rest else len(first))
    scales = {name: colour_scale(own, kind, FIELDS[kind][name], None) for name,
              own in fields.items()}
    scales = {name: scale for name, scale in scales.items() if scale}
    group = {"offset": offset, "counts": [len(first[k][kind]["x"]) for k in steps], "fields": []}
    for name, scale in scales.items():
        unit = scale["label"].rpartition("(")[2].rstrip(")")
        group["fields"].append({"label": FIELDS[kind][name][2].replace("$\\sigma_{xx}$", "xx"),
                                "unit": unit,
                                "low": float(scale["norm"].vmin), "high": float(scale["norm"].vmax),
                                "colours": scale["cmap"]})
    parts = []
    for k in steps:
        parts += packed_places(first[k][kind]["x"], window)
        for name, scale in scales.items():
            values = scale["factor"] * fields[name][k][kind]["value"]
            parts.append(as_bytes(values, scale["norm"].vmin, scale["norm"].vmax))
    return group, b"".join(part.tobytes() for part in parts)


def probe_curves(run):
    """Columns of the probes in units that read well, with the references of the case."""
    try:
        curves = run.curves()
    except BadFile:  # a case without probes
        return []
    refs, found = references(run), []
    for column, (time, value) in curves.items():
        sound = np.isfinite(value)
        time, value = time[sound][::len(time) // ROWS + 1], value[sound][::len(time) // ROWS + 1]
        if not len(value):
            continue
        words, scale, unit = column_words(column, np.abs(value).max())
        numbers = [[float(f"{v:.6g}") for v in values] for values in (time, scale * value)]
        own = [ref for ref in refs if ref.probe == column]
        words = words.replace("$", "").replace("\\sigma", "stress")
        found.append({"label": words, "name": words.removesuffix(f" ({unit})"), "unit": unit,
                      "time": numbers[0], "value": numbers[1],
                      "references": [{"label": ref.label, "measured": ref.measured,
                                      "time": ref.time.tolist(),
                                      "value": (scale * ref.value).tolist()} for ref in own]})
    return found


def palette(name):
    colours = plt.colormaps[name](np.arange(256))[:, :3]
    return np.rint(255 * colours).astype(int).ravel().tolist()


def make_film(run, every, window):
    with Snapshots(run.folder / "fields.vtkhdf") as file:
        steps = range(0, len(file.times), every)
        found = panels_of(run, file, steps)
        times = [float(file.times[step]) for step in steps]
    panels = next(own for kind in found.values() for own in kind.values())
    window = window or frame(panels)
    film = {"times": times, "window": [float(v) for v in window], "dp": run.spacing(), "groups": {},
            "probes": probe_curves(run)}
    data = b""
    for kind in KINDS:
        if len(panels[0][kind]["x"]):
            film["groups"][kind], added = pack_group(kind, panels, found.get(kind, {}), window,
                                                     len(data))
            data += added
    used = {field["colours"] for group in film["groups"].values() for field in group["fields"]}
    film["palettes"] = {name: palette(name) for name in sorted(used)}
    return film, data
