#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the film of a run as one HTML file that any browser shows: particles coloured by a field
that one picks, probe curves with a cursor, measuring with the mouse.

example: tools/view.py runs/gate --every 2 --out gate.html"""

import base64
import html
import json
import zlib
from pathlib import Path

import runfiles
from runfiles import BadFile
from sphfsi.page import make_film

HERE = Path(__file__).resolve().parent
LARGEST = 20e6  # bytes of the page


def arguments():
    parser = runfiles.options(__doc__)
    parser.add_argument("run", nargs="?", metavar="RUN", help="folder of a run")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="every N-th snapshot "
                                                                          "(%(default)s)")
    parser.add_argument("--window", nargs=4, type=float, metavar=("X0", "X1", "Y0", "Y1"),
                        help="part of the plane, m (default: all but single drops)")
    parser.add_argument("--out", metavar="FILE", help="(default: film.html in the run's folder)")
    args = runfiles.parse(parser)
    if args.every < 1:
        parser.error("--every is 1 or more")
    return args


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
