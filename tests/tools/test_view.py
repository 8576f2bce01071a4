#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The page that tools/view.py writes holds the run: its numbers are checked here, its script runs
in node, the whole page in a headless Chromium, as far as these are installed. Exit 77: a package is
missing."""

import base64
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from scripts import PROGRAM, TOOLS, packages
import chromium
with packages():
    from PIL import Image
    import h5py  # noqa: F401
    import matplotlib  # noqa: F401
    import numpy as np

CASE = """
title = A film <of> water
dp = 1 cm
end_time = 0.02 s
gravity = 0, -9.81
[fluid water]
shape = box 0, 0, 0.1, 0.1
sound_speed = 20
artificial_viscosity = 0.05
density_diffusion = 0.1
surface = 0.1
[wall tank]
shape = box -0.03, 0, 0, 0.15
shape = box -0.03, -0.03, 0.5, 0
[solid gate]
shape = box 0.1, 0, 0.13, 0.15
clamp = box 0.1, 0.12, 0.13, 0.15
density = 1100
young = 1e6
poisson = 0.4
[output]
snapshot_interval = 5 ms
[probe M1]
body = gate
point = 0.13, 0
"""
NODE = """
const fs = require("fs"), zlib = require("zlib"), view = require(process.argv[2]);
const film = JSON.parse(fs.readFileSync(process.argv[3])), bytes = fs.readFileSync(process.argv[4]);
for (const g of Object.values(film.groups)) g.frames = view.frames_of(g, new Uint8Array(bytes));
const last = film.times.length - 1, fluid = view.frame_at(film.groups.fluid, last);
const out = { places: [], values: [] };
for (let i = 0; i < fluid.n; i++) {
  out.places.push(view.place(film, fluid, i));
  out.values.push(view.value(film.groups.fluid.fields[0], fluid.fields[0][i]));
}
const hit = view.nearest(film, last, out.places[7][0], out.places[7][1], film.dp);
out.hit = [hit.name, hit.i, view.nearest(film, last, 5, 5, film.dp) === null,
           view.nearest_index(film.times, 0.011)];
console.log(JSON.stringify(out));
"""


def part(page, name):
    return re.search(rf'<script type="[^"]*" id="{name}">(.*?)</script>', page, re.S)[1]


def decode(film, data, kind, index):
    """Positions and bytes of the fields of a frame, by the words of view.py."""
    group = film["groups"][kind]
    width = 4 + len(group["fields"])
    index = min(index, len(group["counts"]) - 1)
    at, n = group["offset"] + width * sum(group["counts"][:index]), group["counts"][index]
    rows = np.frombuffer(data, np.uint8, width * n, at).reshape(width, n).astype(float)
    x0, x1, y0, y1 = film["window"]
    return (np.stack([x0 + (x1 - x0) * (256 * rows[0] + rows[1]) / 65535,
                      y0 + (y1 - y0) * (256 * rows[2] + rows[3]) / 65535], axis=1), rows[4:])


def check_numbers(folder, film, data):
    from sphfsi.snapshots import Snapshots
    file = Snapshots(folder / "fields.vtkhdf")
    assert np.allclose(film["times"], file.times)
    fine = (film["window"][1] - film["window"][0]) / 65535
    for step in range(len(file.times)):
        points, kinds = file.load(step, "Points")[:, :2], file.load(step, "kind")
        for kind, number in (("fluid", 0), ("wall", 1), ("solid", 2)):
            places, values = decode(film, data, kind, step)
            assert np.abs(places - points[kinds == number]).max() <= fine, kind
    pressure = film["groups"]["fluid"]["fields"][0]
    assert pressure["label"] == "pressure" and pressure["unit"] in ("Pa", "kPa")
    _, values = decode(film, data, "fluid", step)
    factor = {"Pa": 1, "kPa": 1e-3}[pressure["unit"]]
    shown = pressure["low"] + (pressure["high"] - pressure["low"]) * values[0] / 255
    true = np.clip(factor * file.load(step, "pressure")[kinds == 0], pressure["low"],
                   pressure["high"])
    assert np.abs(shown - true).max() <= (pressure["high"] - pressure["low"]) / 500
    assert len(film["groups"]["wall"]["counts"]) == 1  # at rest: once
    assert [probe["label"] for probe in film["probes"]][0].startswith("M1 horizontal displacement")
    return places, shown


def check_node(folder, film, data):
    (folder / "film.json").write_text(json.dumps(film))
    (folder / "frames").write_bytes(data)
    (folder / "look.js").write_text(NODE)
    said = subprocess.run(["node", folder / "look.js", TOOLS / "view.js", folder / "film.json",
                           folder / "frames"], check=True, capture_output=True, text=True).stdout
    out = json.loads(said)
    places, values = decode(film, data, "fluid", len(film["times"]) - 1)
    field = film["groups"]["fluid"]["fields"][0]
    assert np.allclose(out["places"], places)
    assert np.allclose(out["values"],
                       field["low"] + (field["high"] - field["low"]) * values[0] / 255)
    assert out["hit"] == ["fluid", 7, True, 2], out["hit"]


def check_mouse(page, film):
    """A line drawn with the mouse has the length of its pixels times the scale of the picture; a
    double click takes it away. The wheel enlarges about the mouse."""
    left, top, wide, tall = page.run("(r => [r.x, r.y, r.width, "
                                     "r.height])(over.getBoundingClientRect())")
    x0, x1, y0, y1 = film["window"]
    scale = max((x1 - x0) / wide, (y1 - y0) / tall)  # metres of a pixel
    middle = (left + wide / 2, top + tall / 2)
    end = (middle[0] + 60, middle[1] - 30)
    page.drag(middle, end)
    length = float(page.run("document.body.dataset.length"))
    assert abs(length - scale * np.hypot(60, 30)) < scale, (length, scale)
    assert page.run("getComputedStyle(over).cursor") == "crosshair"
    drawn = "over.getContext('2d').getImageData(0, 0, over.width, over.height).data.some(v => v)"
    assert page.run(drawn)
    where = page.run("document.getElementById('where').textContent")
    x, y = ((x0 + x1) / 2 + 60 * scale, (y0 + y1) / 2 + 30 * scale)
    said = [float(v) for v in re.search(r"x = (\S+) m, y = (\S+) m", where).groups()]
    assert np.allclose(said, (x, y), atol=scale), (where, x, y)
    page.mouse("mouseWheel", *middle, deltaX=0, deltaY=-400)
    page.drag(middle, end)
    enlarged = float(page.run("document.body.dataset.length"))
    assert abs(enlarged - length / np.exp(0.6)) < scale, (enlarged, length)
    page.mouse("mousePressed", *middle, clickCount=2)
    page.mouse("mouseReleased", *middle, clickCount=2)
    assert not page.run(drawn)


def check_controls(page, film):
    """Another field has another range; the scrubber and a click on the curve go to a time; it
    plays."""
    before = page.run("document.getElementById('fluid-range').textContent")
    page.run("fluid.value = 1; fluid.dispatchEvent(new Event('change'))")
    assert page.run("document.getElementById('fluid-range').textContent") != before
    page.run("scrub.value = 3; scrub.dispatchEvent(new Event('input'))")
    assert page.run("document.body.dataset.frame") == "3"
    assert page.run("document.getElementById('time').textContent") == "t = 0.015 s"
    assert "at 0.015 s" in page.run("document.getElementById('reading').textContent")
    left, top, tall = page.run("(r => [r.x, r.y, r.height])(curve.getBoundingClientRect())")
    for what in ("mousePressed", "mouseReleased"):
        page.mouse(what, left + 66, top + tall / 2)
    assert page.run("document.body.dataset.frame") == "0"
    page.run("document.getElementById('play').click()")
    page.wait("document.body.dataset.frame === '2'", 20)
    page.run("document.getElementById('play').click()")


def check_browser(folder, film, path):
    with chromium.Browser(folder) as page:
        page.open(f"file://{path}")
        page.wait("document.body.dataset.ready === 'yes'")
        check_mouse(page, film)
        check_controls(page, film)
        page.screenshot(folder / "film.png")
        kept = os.environ.get("PICTURE")
        if kept:
            shutil.copy(folder / "film.png", kept)
        colours = np.asarray(Image.open(folder / "film.png").convert("RGB"), float)
        assert (np.ptp(colours, axis=2) > 40).mean() > 0.02, "the particles have no colour"
        assert not page.said, page.said


def main():
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        folder = Path(name)
        (folder / "film.cfg").write_text(CASE)
        subprocess.run([PROGRAM, "film.cfg", "--out", "run", "--quiet", "--threads", "1"],
                       check=True,
                       cwd=folder, stderr=subprocess.DEVNULL)
        tool = [sys.executable, TOOLS / "view.py"]
        said = subprocess.run([*tool, folder / "run"], check=True, capture_output=True,
                              text=True).stdout
        assert "5 frames" in said, said
        page = folder / "run" / "film.html"
        text = page.read_text()
        assert "A film &lt;of&gt; water" in text and not re.search(r"@[A-Z]+@|https?://", text)
        film = json.loads(part(text, "film"))
        data = zlib.decompress(base64.b64decode(part(text, "frames")))
        check_numbers(folder / "run", film, data)
        done = ["its numbers"]
        if shutil.which("node"):
            check_node(folder, film, data)
            done.append("its script in node")
        if chromium.program():
            check_browser(folder, film, page)
            done.append("the page in a browser")
        few = subprocess.run([*tool, folder / "run", "--every", "2", "--out", folder / "few.html"],
                             check=True, capture_output=True, text=True).stdout
        assert "3 frames" in few, few
        bad = subprocess.run([*tool, folder / "none"], capture_output=True, text=True)
        assert bad.returncode == 1 and "no such folder" in bad.stderr
    print("looked at:", ", ".join(done))


if __name__ == "__main__":
    main()
