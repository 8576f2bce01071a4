#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the film of a run as one HTML file that any browser shows: particles coloured by a field
that one picks, probe curves with a cursor, measuring with the mouse."""

import argparse
import base64
import html
import json
import sys
import zlib
from pathlib import Path

import runfiles
from runfiles import BadFile, np, plt
from sphfsi.draw_fields import colour_scale, frame, load_panel
from sphfsi.draw_probes import column_words
from sphfsi.snapshots import FIELDS, KINDS, Snapshots

HERE = Path(__file__).resolve().parent
LARGEST = 20e6  # bytes of the page
ROWS = 2000     # of a probe's curve


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", nargs="?", metavar="RUN", help="folder of a run")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="every N-th snapshot "
                                                                          "(%(default)s)")
    parser.add_argument("--window", nargs=4, type=float, metavar=("X0", "X1", "Y0", "Y1"),
                        help="part of the plane, m (default: all but single drops)")
    parser.add_argument("--out", metavar="FILE", help="(default: film.html in the run's folder)")
    args = parser.parse_args()
    if not args.run:
        parser.print_help()
        sys.exit(1)
    if args.every < 1:
        parser.error("--every is 1 or more")
    return args


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
    refs, found = runfiles.references(run), []
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


def main():
    args = arguments()
    run = runfiles.make_runs([args.run])[-1]
    film, data = make_film(run, args.every, args.window)
    title = run.summary.get("title") or run.name
    about = f"{run.name}, sphfsi {run.summary.get('version', '')}" + \
        (f", {run.failure()}" if run.failure() else "")
    page = (HERE / "view.html").read_text(encoding="utf-8")
    for name, text in (("TITLE", html.escape(title)), ("ABOUT", html.escape(about)),
                       ("FILM", json.dumps(film, separators=(",", ":")).replace("</", "<\\/")),
                       ("FRAMES", base64.b64encode(zlib.compress(data, 9)).decode()),
                       ("DRAW", (HERE.parent / "web" / "draw.js").read_text(encoding="utf-8")),
                       ("SCRIPT", (HERE / "view.js").read_text(encoding="utf-8"))):
        page = page.replace(f"@{name}@", text)
    if len(page) > LARGEST:
        raise BadFile(f"{run.folder}: the page would have {len(page) / 1e6:.0f} MB, more than "
                      f"{LARGEST / 1e6:.0f}; choose --every "
                      f"{int(len(page) / LARGEST * args.every) + 1}")
    out = Path(args.out or run.folder / "film.html")
    try:
        out.write_text(page, encoding="utf-8")
    except OSError as problem:
        raise BadFile(f"cannot write {out}: {problem.strerror}") from None
    print(f"written {out}: {len(film['times'])} frames, {len(page) / 1e6:.2f} MB")


if __name__ == "__main__":
    runfiles.run_tool(main)
