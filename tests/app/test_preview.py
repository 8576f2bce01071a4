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
y = -0.001*t
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
[probe beside]
body = post
point = 0.222, 0.15
[probe whole]
quantity = energy
body = post
"""
BEAM = """dp = 10 mm
end_time = 1
[beam plate]
shape = polyline: 0, 0; 0.3, 0; 0.4, 0.3
clamp = 0, 0
hinge = 0.4, 0.3, bob
density = 2000
young = 1 GPa
thickness = 4 mm
[rigid bob]
shape = box 0.35, 0.3, 0.45, 0.4
density = 500
[spring line]
body = plate
from = 0.3, 0
to = 0.2, -0.1
stiffness = 100
"""


class Picture:
    """Elements, and the map from pixels to metres that the numbers of the grid give."""

    def __init__(self, path):
        self.root = ET.parse(path).getroot()
        ticks = {"middle": [], "end": []}
        for text in self.texts():
            number = re.fullmatch(r"(-?[\d.]+) m", text.text)
            if number and text.get("class") in ticks:
                place = float(text.get("x")), float(text.get("y"))
                ticks[text.get("class")].append((float(number[1]), *place))
        across, up = ticks["middle"], ticks["end"]
        assert len(across) > 3 and len(up) > 3
        self.scale = (across[-1][1] - across[0][1]) / (across[-1][0] - across[0][0])
        self.x0 = across[0][1] - self.scale * across[0][0]
        self.y0 = up[0][2] - 4 + self.scale * up[0][0]
        for value, x, _ in across:
            assert abs(self.x0 + self.scale * value - x) < 0.2, (value, x)
        for value, _, y in up:  # the text stands 4 pixels below its line
            assert abs(self.y0 - self.scale * value - (y - 4)) < 0.2, (value, y)

    def texts(self):
        return self.root.iter(NAME + "text")

    def metres(self, x, y):
        return (float(x) - self.x0) / self.scale, (self.y0 - float(y)) / self.scale

    def squares(self, fill):
        """Centres in metres of all squares of a class, and their side."""
        found = []
        for path in self.root.iter(NAME + "path"):
            if path.get("class") == f"body {fill}":
                side = float(path.get("stroke-width")) / self.scale
                for piece in path.get("d").split("M")[1:]:
                    found.append((*self.metres(*piece.removesuffix("h.01").split()), side))
        return found

    def places(self, kind):
        """Places in metres along each line of a class."""
        return [[self.metres(*pair.split())
                 for pair in path.get("d").removesuffix("h.01").lstrip("M").split("L") if pair]
                for path in self.root.iter(NAME + "path") if path.get("class") == kind]

    def listed(self, start):
        lines = [text.text for text in self.texts() if re.search(f"  {start}(:|$)", text.text)]
        assert len(lines) == 1, (start, lines)
        return lines[0]


def bounds(squares):
    return [f(p[c] + sign * p[2] / 2 for p in squares)
            for f, sign in ((min, -1), (max, 1)) for c in (0, 1)]


def near(got, want, tolerance):
    assert all(abs(a - b) <= tolerance for a, b in zip(got, want)), (got, want)


def check(picture):
    pixel = 1 / picture.scale
    # A square for each particle, of the spacing; boxes: as the case has them.
    for fill, n in (("fluid", 200), ("moving", 40), ("clamped", 16), ("solid", 60 + 25)):
        squares = picture.squares(fill)
        assert len(squares) == n, (fill, len(squares))
        assert all(abs(one[2] - 0.01) < 0.02 * 0.01 for one in squares), fill
    near(bounds(picture.squares("fluid")), (0, 0, 0.2, 0.1), pixel)
    near(bounds(picture.squares("moving")), (0.1, 0.3, 0.2, 0.34), pixel)
    near(bounds(picture.squares("clamped")), (0.2, -0.04, 0.24, 0), pixel)
    kite = [one for one in picture.squares("solid") if one[0] < 0.19]
    assert len(kite) == 25
    # The corners of its lattice, whose cells lie along the sides of the kite.
    corners = [math.hypot(x - 0.1, y - 0.2) for x, y, _ in kite]
    assert abs(min(corners) - 0.01 / math.sqrt(2)) < 2 * pixel, min(corners)
    slope = [one for one in picture.squares("wall") if one[0] > 0.31]
    assert len(slope) > 30

    texts = [text.text for text in picture.texts()]
    assert texts[0] == "a & b < c", texts[0]
    # The legend numbers bodies and probes, and the number stands in the drawing where each is.
    names = "water tank slope lid post kite tip rise through".split()
    numbered = [t.text for t in picture.texts() if t.get("class") == "label"]
    assert numbered == [str(k + 1) for k in range(len(names))], numbered
    for k, line in enumerate(("fluid water", "wall tank", "wall slope", "wall lid",
                              "solid post: clamped where dark", "solid kite",
                              "probe tip: displacement", "probe rise: level",
                              "probe through: flux"), 1):
        assert picture.listed(line.partition(":")[0]) == f"{k}  {line}", line
    # One number where two would overlap, and none for what has no place.
    assert picture.listed("probe beside") == "7  probe beside: displacement"
    assert picture.listed("probe whole") == "  probe whole: energy"

    points = sum(picture.places("point "), [])
    for place in ((0.22, 0.15), (0.222, 0.15), (0.05, 0), (0.1, 0), (0.15, 0.1)):
        assert any(math.dist(place, c) < pixel for c in points), place
    assert len(points) == 5
    lines = [line for line in picture.places("line ") if len(line) == 2]
    assert len(lines) == 1
    near(sum(lines[0], ()), (0.1, 0, 0.15, 0.1), pixel)
    # Numbers stand beside the last particle of a body and beside probes.
    place = {names[int(t.text) - 1]: picture.metres(t.get("x"), t.get("y"))
             for t in picture.texts() if t.get("class") == "label"}
    for name, corner in (("water", (0.2, 0.1)), ("post", (0.24, 0.15)), ("lid", (0.2, 0.34))):
        assert math.dist(place[name], corner) < 30 * pixel, (name, place[name])
    for name, point in (("rise", (0.05, 0)), ("tip", (0.22, 0.15))):
        assert math.dist(place[name], point) < 20 * pixel, (name, place[name])
    height, width = float(picture.root.get("height")), float(picture.root.get("width"))
    assert all(0 <= float(t.get("x")) <= width and 0 <= float(t.get("y")) <= height
               for t in picture.texts())


def check_beam(picture):
    """A beam without fluid has its line, as thick as it is, points at the ends of its spring, and
    no particles."""
    pixel = 1 / picture.scale
    lines = picture.places("line wall") + picture.places("line moving")
    assert len(lines) == 1, lines
    near(sum(lines[0], ()), (0, 0, 0.3, 0, 0.4, 0.3), pixel)
    style, = (path.get("style") for path in picture.root.iter(NAME + "path") if path.get("style"))
    near((float(style.removeprefix("stroke-width:")) * pixel,), (0.004,), 0.01 * pixel)
    assert [t.text for t in picture.texts() if t.text.endswith("  beam plate")]
    points = sum(picture.places("point "), [])
    assert len(points) == 2, points
    for place in ((0.3, 0), (0.2, -0.1)):
        assert any(math.dist(place, c) < pixel for c in points), place
    assert not any(word in text.text for text in picture.texts() for word in ("inf", "nan"))


def main():
    with tempfile.TemporaryDirectory() as top:
        case, picture = Path(top) / "scene.cfg", Path(top) / "scene.svg"
        for text, check_it in ((CASE, check), (BEAM, check_beam)):
            case.write_text(text)
            subprocess.run([SPHFSI, "--preview", str(case), "--out", str(picture)], check=True,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            check_it(Picture(picture))
    return 0


if __name__ == "__main__":
    sys.exit(main())
