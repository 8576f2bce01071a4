#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The picture of a scene: what is drawn has the places, areas, names and numbers of the case."""
import math
import os
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

SPHFSI = os.environ.get("SPHFSI", "./sphfsi")
NAME = "{http://www.w3.org/2000/svg}"
ANGLE = 0.9272952180016122  # of sides 3, 4, 5
CASE = f"""title = "a & b < c"
dp = 10 mm
end_time = 1
gravity = 0, -9.81
[fluid water]
shape = box 0, 0, 0.2, 0.1
sound_speed = 20
artificial_viscosity = 0.02
surface = 0.1
[wall tank]
shape = polyline thickness -0.04: 0, 0.2; 0, 0; 0.3, 0
[wall slope]
shape = polyline thickness -0.04: 0.34, 0; 0.46, 0.05
[wall lid]
shape = box 0.1, 0.3, 0.2, 0.34
motion = down
[motion down]
velocity = 0, -0.001
[solid post]
shape = box 0.2, -0.04, 0.24, 0.15
clamp = box 0.2, -0.04, 0.24, 0
density = 1100
young = 1 MPa
poisson = 0.4
[solid kite]
shape = polygon 0.1, 0.2; 0.13, 0.24; 0.09, 0.27; 0.06, 0.23
lattice_angle = {ANGLE}
density = 900
young = 1 MPa
poisson = 0.4
[probe tip]
body = post
point = 0.22, 0.15
[probe rise]
quantity = level
point = 0.05, 0
[probe through]
quantity = flux
point = 0.1, 0
to = 0.15, 0.1
"""
COLOURS = {"fluid": "#56B4E9", "wall": "#999999", "moving": "#CC79A7", "solid": "#E69F00",
           "clamp": "url(#clamp)"}


def area(corners):
    return 0.5 * abs(sum(a[0] * b[1] - b[0] * a[1] for a,
                         b in zip(corners, corners[1:] + corners[:1])))


class Picture:
    """Elements, and the map from pixels to metres that the ticks of the axes give."""

    def __init__(self, path):
        self.root = ET.parse(path).getroot()
        ticks = {"middle": [], "end": []}
        for text in self.texts():
            if re.fullmatch(r"-?[\d.]+", text.text) and text.get("class") in ticks:
                place = float(text.get("x")), float(text.get("y"))
                ticks[text.get("class")].append((float(text.text), *place))
        across, up = ticks["middle"], ticks["end"]
        assert len(across) > 5 and len(up) > 5
        self.scale = (across[-1][1] - across[0][1]) / (across[-1][0] - across[0][0])
        self.x0 = across[0][1] - self.scale * across[0][0]
        self.y0 = up[0][2] - 4 + self.scale * up[0][0]
        for value, x, _ in across:
            assert abs(self.x0 + self.scale * value - x) < 0.2, (value, x)
        for value, _, y in up:  # the text stands 4 pixels below its tick
            assert abs(self.y0 - self.scale * value - (y - 4)) < 0.2, (value, y)

    def texts(self):
        return self.root.iter(NAME + "text")

    def metres(self, x, y):
        return (float(x) - self.x0) / self.scale, (self.y0 - float(y)) / self.scale

    def rectangles(self, fill):
        """Corners in metres of all rectangles of this colour."""
        found = []
        for path in self.root.iter(NAME + "path"):
            if path.get("fill") == COLOURS[fill] and "L" in path.get("d"):
                for piece in path.get("d").split("z")[:-1]:
                    found.append([self.metres(*pair.split()) for pair in piece[1:].split("L")])
        return found

    def listed(self, start):
        lines = [text.text for text in self.texts() if text.text.startswith(start + ": ")]
        assert len(lines) == 1, (start, lines)
        return lines[0]


def bounds(rectangles):
    points = [p for one in rectangles for p in one]
    return [f(p[c] for p in points) for f in (min, max) for c in (0, 1)]


def near(got, want, tolerance):
    assert all(abs(a - b) <= tolerance for a, b in zip(got, want)), (got, want)


def check(picture):
    pixel = 1 / picture.scale
    # Areas: number of particles times dp^2; boxes: as the case has them.
    for fill, n in (("fluid", 200), ("moving", 40), ("clamp", 16), ("solid", 60 + 25)):
        got = sum(map(area, picture.rectangles(fill))) / 1e-4
        assert abs(got - n) < 0.02 * n, (fill, got)
    near(bounds(picture.rectangles("fluid")), (0, 0, 0.2, 0.1), pixel)
    near(bounds(picture.rectangles("moving")), (0.1, 0.3, 0.2, 0.34), pixel)
    near(bounds(picture.rectangles("clamp")), (0.2, -0.04, 0.24, 0), pixel)
    kite = [one for one in picture.rectangles("solid") if one[0][0] < 0.19]
    near(bounds(kite), (0.06, 0.2, 0.13, 0.27), 2 * pixel)
    for one in kite:  # its sides lie along the lattice
        turn = math.atan2(one[1][1] - one[0][1], one[1][0] - one[0][0]) - ANGLE
        assert abs(math.remainder(turn, math.pi / 2)) < 0.02, one
    # Particles that lie on no lattice have a square each, of the spacing.
    walls = picture.rectangles("wall")
    slope = [one for one in walls if bounds([one])[0] > 0.305]
    n = int(re.search(r"(\d+) particles", picture.listed("wall slope"))[1])
    assert len(slope) == n > 30 and all(abs(area(one) - 1e-4) < 0.03e-4 for one in slope)
    # One row of the floor in one piece.
    assert any(abs(bounds([one])[0] + 0.04) < pixel and abs(bounds([one])[2] - 0.2) < pixel
               for one in walls)

    texts = [text.text for text in picture.texts()]
    assert texts[0] == "a & b < c", texts[0]
    assert "gravity (0, -9.81) m/s^2, 1 s; domain (-0." in texts[1], texts[1]
    # The legend numbers bodies and probes, and the number stands in the drawing where each is.
    names = "tank slope lid water post kite tip rise through".split()
    numbered = [t.text for t in picture.texts() if t.get("class") == "label"]
    assert numbered == [str(k + 1) for k in range(len(names))], numbered
    for kind, name in zip(["wall"] * 3 + ["fluid"] + ["solid"] * 2 + ["probe"] * 3, names):
        at = texts.index(picture.listed(f"{kind} {name}"))
        assert texts[at - 1] == str(names.index(name) + 1), (name, texts[at - 1])
    assert picture.listed("fluid water") == \
        "fluid water: 0.2 x 0.1 m, 200 particles; 1000 kg/m^3, c0 20 m/s"
    assert picture.listed("wall lid") == "wall lid: 0.1 x 0.04 m, 40 particles; moved by down"
    assert picture.listed("wall tank").endswith("; at rest")
    assert picture.listed("solid post") == ("solid post: 0.04 x 0.19 m, 76 particles; 1100 kg/m^3, "
                                            "E 1e+06 Pa, nu 0.4; 16 clamped (hatched)")
    assert picture.listed("solid kite").startswith("solid kite: 0.05 x 0.05 m at ")
    assert "25 particles; 900 kg/m^3" in picture.listed("solid kite")
    assert picture.listed("solid kite").endswith("; nothing clamped")
    assert picture.listed("probe rise") == "probe rise: level at (0.05, 0) m"
    assert picture.listed("probe through") == "probe through: flux from (0.1, 0) to (0.15, 0.1) m"

    circles = [picture.metres(c.get("cx"), c.get("cy")) for c in picture.root.iter(NAME + "circle")]
    for place in ((0.22, 0.15), (0.05, 0), (0.1, 0)):
        assert any(math.dist(place, c) < pixel for c in circles), place
    assert len(circles) == 6  # and one in the list for each
    lines = [p.get("d") for p in picture.root.iter(NAME + "path") if p.get("class") == "probe"]
    assert len(lines) == 1
    ends = [picture.metres(*pair.split()) for pair in lines[0][1:].split("L")]
    near(ends[0] + ends[1], (0.1, 0, 0.15, 0.1), pixel)
    # Numbers stand in bodies and beside probes.
    place = {names[int(t.text) - 1]: picture.metres(t.get("x"), t.get("y"))
             for t in picture.texts() if t.get("class") == "label"}
    assert 0 < place["water"][0] < 0.2 and 0 < place["water"][1] < 0.1, place
    assert 0.2 < place["post"][0] < 0.24 and -0.04 < place["post"][1] < 0.15, place
    assert 0.1 < place["lid"][0] < 0.2 and 0.29 < place["lid"][1] < 0.34, place
    assert math.dist(place["rise"], (0.05, 0)) < 10 * pixel and math.dist(place["tip"],
                                                                          (0.22, 0.15)) < 10 * pixel
    height, width = float(picture.root.get("height")), float(picture.root.get("width"))
    assert all(0 <= float(t.get("x")) <= width and 0 <= float(t.get("y")) <= height
               for t in picture.texts())


def main():
    with tempfile.TemporaryDirectory() as top:
        case, picture = Path(top) / "scene.cfg", Path(top) / "scene.svg"
        case.write_text(CASE)
        subprocess.run([SPHFSI, "--preview", str(case), "--out", str(picture)], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        check(Picture(picture))
    return 0


if __name__ == "__main__":
    sys.exit(main())
