/* SPDX-License-Identifier: MIT
 * Bad case files, and the sentence that each of them is answered with (or how it begins). */
#include "case/params.h"
#include "case/scene.h"
#include "geometry/scene_points.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

#define TOP "dp = 1 mm\nend_time = 1 s\n"
#define SOLID \
    "[solid a]\nshape = box 0, 0, 10 mm, 20 mm\ndensity = 1000\nyoung = 1 MPa\npoisson = 0.3\n"
#define FLUID "[fluid w]\nshape = box 0, 0, 20 mm, 20 mm\nsound_speed = 20\n"

static const struct {
    const char *text, *set, *message;
} bad[] = {
    {"", NULL, "bad.cfg:1: `dp` is missing at the top of the file: particle spacing (m)"},
    {"dp 1 mm\n", NULL, "bad.cfg:1: `dp 1 mm` is neither `key = value` nor `[section]`"},
    {"dp = 1 mm # fine\n= 5\n", NULL,
     "bad.cfg:2: `` is not a valid key: a key has up to 63 letters, digits and _"},
    {"dp =\n", NULL, "bad.cfg:1: `dp` has no value"},
    {"dp = # nothing\n", NULL, "bad.cfg:1: `dp` has no value"},
    {"title = \"open\n", NULL,
     "bad.cfg:1: `title` has a quote that is not closed; end the text with \""},
    {"title = \"a\" b\n", NULL,
     "bad.cfg:1: `title` has text after the closing quote; a comment begins with #"},
    {"2dp = 1\n", NULL,
     "bad.cfg:1: `2dp` is not a valid key: a key has up to 63 letters, digits and _"},
    {"fluid w\n", NULL, "bad.cfg:1: `fluid w` is neither `key = value` nor `[section]`"},
    {TOP "[numerics]\nintegrator = verlet\n" SOLID, NULL,
     "bad.cfg:4: unknown key `integrator` in [numerics]; it belongs at the top of the file"},
    {TOP "friction = 0.3\n" SOLID, NULL,
     "bad.cfg:3: unknown key `friction` at the top of the file; it belongs in [contact]"},
    {TOP SOLID, "young=1", "--set young=1: unknown key or constant `young`; write `a.young`"},
    {TOP "[solids a]\n", NULL, "bad.cfg:3: unknown section [solids]; did you mean `solid`?"},
    {TOP "[zebra]\n", NULL, "bad.cfg:3: unknown section [zebra]; --keys lists them"},
    {TOP SOLID, "a.young=1 Mpa",
     "--set a.young=1 Mpa: young = 1 Mpa: `Mpa` after 1 is not a unit (units: m km cm mm um"},
    {"dp = \xE2\x88\x92"
     "1 mm\n",
     NULL,
     "bad.cfg:1: dp = \xE2\x88\x92"
     "1 mm: a character outside ASCII, such as a no-break space, a typographic minus or a micro "
     "sign, where a value is expected"},
    {"dp = 1\xC2\xA0mm\n", NULL,
     "bad.cfg:1: dp = 1\xC2\xA0mm: a character outside ASCII, such as a no-break space, a "
     "typographic minus or a micro sign, where an operator is expected"},
    {"\xC2\xA0"
     "dp = 1 mm\n",
     NULL,
     "bad.cfg:1: `\xC2\xA0"
     "dp` is not a valid key: a key has up to 63 letters, digits and _"},
    {"dp = 0,005\n", NULL,
     "bad.cfg:1: dp = 0,005: `,` where an operator is expected; a decimal number is written with a "
     "point: 0.005"},
    {TOP "gravity = 0, -9,81\n", NULL,
     "bad.cfg:3: gravity = 0, -9,81: two components are expected, `gravity = X, Y`; there are 3; a "
     "comma separates numbers, and a decimal number is written with a point: 0.005"},
    {TOP SOLID "clamp = box 0, 0, 0,1, 1\n", NULL,
     "bad.cfg:8: clamp = box 0, 0, 0,1, 1: 4 numbers with commas between them are expected; `0, 0, "
     "0,1, 1` has 5; a "
     "comma separates numbers, and a decimal number is written with a point: 0.005"},
    {"dp = 1 mm // spacing\n", NULL,
     "bad.cfg:1: dp = 1 mm // spacing: `//` where a value is expected; a comment begins with #"},
    {"// a comment\n", NULL, "bad.cfg:1: `// a comment` is neither `key = value` nor `[section]`"},
    {TOP SOLID, "a.young=3 kg*m/s^5",
     "--set a.young=3 kg*m/s^5: young = 3 kg*m/s^5: a quantity in kg m/s^5 where a pressure (Pa) "
     "is expected"},
    {TOP SOLID, "a.young=3 N/m",
     "--set a.young=3 N/m: young = 3 N/m: a force per length (N/m) where a pressure (Pa) is "
     "expected"},
    {TOP SOLID, "a.young=3 kg/m/s^3",
     "--set a.young=3 kg/m/s^3: young = 3 kg/m/s^3: a quantity in kg/(m s^3) where a pressure (Pa) "
     "is expected"},
    {TOP FLUID "[wall w]\nshape = polyline thickness 5 mm: 0, 0; 20 mm, 0\n", NULL,
     "bad.cfg:3: 100 particles of [fluid w] lie in [wall w], the first at (0.0005, 0.0005) m: "
     "move one of the shapes, or subtract the overlap with `minus`; if the band of a polyline is "
     "on the wrong side, change the sign of its thickness or, without one, the order of its "
     "points"},
    {TOP "[solid]\n", NULL, "bad.cfg:3: [solid] needs a name: [solid NAME]"},
    {TOP "[numerics fast]\n", NULL, "bad.cfg:3: [numerics] takes no name"},
    {TOP "[solid a/b]\n", NULL,
     "bad.cfg:3: [solid a/b]: a name has up to 63 letters, digits, _ and -"},
    {TOP "[solid a\n", NULL, "bad.cfg:3: `[` without `]`"},
    {TOP "[solid a] b\n", NULL, "bad.cfg:3: text after the section's `]`; a comment begins with #"},
    {TOP SOLID SOLID, NULL,
     "bad.cfg:8: [solid a] is given twice, first in line 3; merge the two or rename one"},
    {TOP "[output]\n[output]\n", NULL,
     "bad.cfg:4: [output] is given twice, first in line 3; merge the two or rename one"},
    {"dp = 1 mm\ntitle = a\x01"
     "b\n",
     NULL, "bad.cfg:2: control byte 1; a case file is plain text"},
    {TOP "[solid a]\nyuong = 1 MPa\n", NULL,
     "bad.cfg:4: unknown key `yuong` in [solid]; did you mean `young`?"},
    {TOP "colour = 3\n" SOLID, NULL, "bad.cfg:3: unknown key `colour` at the top of the file"},
    {TOP "young = 1 MPa\n" SOLID, NULL,
     "bad.cfg:3: unknown key `young` at the top of the file; it belongs in [solid]"},
    {TOP "dp = 2 mm\n" SOLID, NULL,
     "bad.cfg:3: `dp` is given twice, first in line 1; leave one out"},
    {"end_time = 1 s\n" SOLID, NULL,
     "bad.cfg:1: `dp` is missing at the top of the file: particle spacing (m)"},
    {TOP "[solid a]\nshape = box 0, 0, 10 mm, 20 mm\ndensity = 1000\nyoung = 1 MPa\n", NULL,
     "bad.cfg:3: [solid a] lacks `poisson`: Poisson ratio nu"},
    {TOP, NULL,
     "bad.cfg:1: nothing to simulate: the case needs a [fluid NAME], a [solid NAME], a [rigid "
     "NAME] or a [beam NAME] section"},
    {"dp = 0.5 MPa\nend_time = 1 s\n" SOLID, NULL,
     "bad.cfg:1: dp = 0.5 MPa: a pressure (Pa) where a length (m) is expected"},
    {TOP "[solid a]\nshape = box 0, 0, 10 mm, 20 mm\ndensity = 1000\nyoung = 5 mm\npoisson = 0.3\n",
     NULL, "bad.cfg:6: young = 5 mm: a length (m) where a pressure (Pa) is expected"},
    {TOP
     "[solid a]\nshape = box 0, 0, 10 mm, 20 mm\ndensity = 1000\nyoung = 5 foo\npoisson = 0.3\n",
     NULL,
     "bad.cfg:6: young = 5 foo: `foo` after 5 is not a unit (units: m km cm mm um, s min ms us, kg "
     "g, N, Pa kPa MPa GPa, Hz kHz, rad deg, %)"},
    {TOP
     "[solid a]\nshape = box 0, 0, 10 mm, 20 mm\ndensity = 1000\nyoung = 1 MPa\npoisson = 0.5\n",
     NULL, "bad.cfg:7: poisson = 0.5: out of range: it must be at least 0 and below 0.5"},
    {TOP
     "[solid a]\nshape = box 0, 0, 10 mm, 20 mm\ndensity = 1000\nyoung = 1 MPa\npoisson = -0.1\n",
     NULL, "bad.cfg:7: poisson = -0.1: out of range: it must be at least 0 and below 0.5"},
    {"dp = 0\nend_time = 1 s\n" SOLID, NULL,
     "bad.cfg:1: dp = 0: out of range: it must be above 0 m and at most 1000 m"},
    {"dp = 1e999\nend_time = 1 s\n" SOLID, NULL,
     "bad.cfg:1: dp = 1e999: 1e999 is too large; the largest number is 1.8e308"},
    {"dp = nan\nend_time = 1 s\n" SOLID, NULL,
     "bad.cfg:1: dp = nan: unknown name `nan`; define it in [constants]"},
    {"dp = 1/0\nend_time = 1 s\n" SOLID, NULL, "bad.cfg:1: dp = 1/0: division by zero"},
    {"dp = (1 mm\nend_time = 1 s\n" SOLID, NULL, "bad.cfg:1: dp = (1 mm: `(` is not closed"},
    {"dp = 1 mm)\nend_time = 1 s\n" SOLID, NULL, "bad.cfg:1: dp = 1 mm): `)` without `(`"},
    {"dp = 1 mm 2\nend_time = 1 s\n" SOLID, NULL,
     "bad.cfg:1: dp = 1 mm 2: `2` where an operator is expected"},
    {"dp = 1..2\nend_time = 1 s\n" SOLID, NULL, "bad.cfg:1: dp = 1..2: `1..2` is not a number"},
    {"dp = 1 mm + 1 s\nend_time = 1 s\n" SOLID, NULL,
     "bad.cfg:1: dp = 1 mm + 1 s: a length (m) and a time (s) cannot be added or compared"},
    {"dp = sqrt(-1)\nend_time = 1 s\n" SOLID, NULL,
     "bad.cfg:1: dp = sqrt(-1): the result is not a finite number"},
    {"dp = sin(1 mm)\nend_time = 1 s\n" SOLID, NULL,
     "bad.cfg:1: dp = sin(1 mm): sin of a length (m); it needs a number without a unit"},
    {"dp = root(4)\nend_time = 1 s\n" SOLID, NULL,
     "bad.cfg:1: dp = root(4): unknown function `root`"},
    {"dp = max(1 mm)\nend_time = 1 s\n" SOLID, NULL,
     "bad.cfg:1: dp = max(1 mm): max needs two values: max(a, b)"},
    {"dp = x\nend_time = 1 s\n" SOLID, NULL,
     "bad.cfg:1: dp = x: `x` is known only in keys that take an expression in x and y"},
    {"dp = "
     "((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((1))))))))))))))))))))))"
     "))))))))))))))))))))))))))))))))))))))))))))))))\nend_time = 1 s\n" SOLID,
     NULL,
     "bad.cfg:1: dp = ((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((...: parentheses "
     "or signs are nested more than 64 deep"},
    {"dp = thicknes/2\nend_time = 1 s\n[constants]\nthickness = 2 mm\n" SOLID, NULL,
     "bad.cfg:1: dp = thicknes/2: unknown name `thicknes`; did you mean `thickness`?"},
    {"dp = g\nend_time = 1 s\n" SOLID, NULL,
     "bad.cfg:1: dp = g: unknown name `g`; define it in [constants]"},
    {"dp = a\nend_time = 1 s\n[constants]\na = b\nb = a\n" SOLID, NULL,
     "bad.cfg:4: a = b: `a` depends on itself"},
    {TOP "[constants]\nmm = 3\n" SOLID, NULL,
     "bad.cfg:4: a constant cannot be named `mm`: that is a unit"},
    {TOP "[constants]\ndp = 3\n" SOLID, NULL,
     "bad.cfg:4: a constant cannot be named `dp`: that is a key at the top of the file"},
    {TOP "[constants]\na = 3\na = 4\n" SOLID, NULL,
     "bad.cfg:5: `a` is given twice, first in line 4; leave one out"},
    {TOP "[constants]\nunused = 1/0\n" SOLID, NULL, "bad.cfg:4: unused = 1/0: division by zero"},
    {TOP "gravity = 9.81\n" SOLID, NULL,
     "bad.cfg:3: gravity = 9.81: two components are expected, `gravity = X, Y`; there is 1"},
    {TOP "gravity = 0, 1/(t - 0.5)\n" SOLID, NULL,
     "bad.cfg:3: gravity = ..., 1/(t - 0.5): component 2 is not finite at t = 0.5 s; it must be "
     "finite at all times up to end_time"},
    {TOP "gravity = 0, 9.81 m\n" SOLID, NULL,
     "bad.cfg:3: gravity = 0, 9.81 m: a length (m) where an acceleration (m/s^2) is expected"},
    {TOP "integrator = verlett\n" SOLID, NULL,
     "bad.cfg:3: integrator = verlett: did you mean `verlet`? Known: symplectic|verlet|leapfrog"},
    {TOP "integrator = rk4\n" SOLID, NULL,
     "bad.cfg:3: integrator = rk4: unknown choice; known: symplectic|verlet|leapfrog"},
    {TOP "[numerics]\nverlet_reset = 2.5\n" SOLID, NULL,
     "bad.cfg:4: verlet_reset = 2.5: a whole number is expected"},
    {TOP "title = "
         "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"
         "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"
         "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"
         "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\n" SOLID,
     NULL,
     "bad.cfg:3: title = aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa...: the text "
     "is longer than 255 bytes; shorten it"},
    {TOP "title = caf\xE9\n" SOLID, NULL,
     "bad.cfg:3: `title` is not UTF-8 text; save the file as UTF-8"},
    {TOP SOLID "velocity = x\n", NULL,
     "bad.cfg:8: velocity = x: two expressions are expected, with commas between them; there is 1"},
    {TOP SOLID "velocity = x, z\n", NULL,
     "bad.cfg:8: velocity = x, z: unknown name `z`; define it in [constants]"},
    {TOP SOLID "velocity = 1 MPa, 0\n", NULL,
     "bad.cfg:8: velocity = 1 MPa, 0: a pressure (Pa) where a speed (m/s) is expected"},
    {TOP SOLID "velocity = 1/(x - x), 0\n", NULL,
     "bad.cfg:3: [solid a] velocity is not finite at (0.0005, 0.0005) m; change the expression"},
    {TOP SOLID "like = a\n", NULL, "bad.cfg:8: like = a: there is no earlier [solid] of that name"},
    {TOP SOLID "clamp = bix 0, 0, 1, 1\n", NULL,
     "bad.cfg:8: clamp = bix 0, 0, 1, 1: `bix` is not a shape; known: box X0, Y0, X1, Y1; "
     "circle X, Y, R; polygon X, Y; ...; polyline thickness T: X, Y; ...; arc thickness "
     "T: X, Y, R, A, B"},
    {TOP SOLID "clamp = box 0, 0, 1\n", NULL,
     "bad.cfg:8: clamp = box 0, 0, 1: 4 numbers with commas between them are expected; `0, 0, 1` "
     "has 3"},
    {TOP SOLID "clamp = box 1, 0, 0, 1\n", NULL,
     "bad.cfg:8: clamp = box 1, 0, 0, 1: box X0, Y0, X1, Y1 needs X0 < X1 and Y0 < Y1; here X 1 to "
     "0, Y 0 to 1 m"},
    {TOP SOLID "clamp = circle 0, 0, 0\n", NULL,
     "bad.cfg:8: clamp = circle 0, 0, 0: the radius of a circle must be above 0 m"},
    {TOP SOLID "clamp = polygon 0, 0; 1, 1\n", NULL,
     "bad.cfg:8: clamp = polygon 0, 0; 1, 1: 3 points or more are expected, `X, Y; X, Y; ...`; "
     "there are 2"},
    {TOP SOLID "clamp = polygon 0, 0; 1, 1; 2, 2\n", NULL,
     "bad.cfg:8: clamp = polygon 0, 0; 1, 1; 2, 2: the polygon has no area"},
    {TOP SOLID "clamp = polygon 0, 0; 2, 2; 2, 0; 0, 1\n", NULL,
     "bad.cfg:8: clamp = polygon 0, 0; 2, 2; 2, 0; 0, 1: edges 1 and 3 of the polygon cross"},
    {TOP SOLID "clamp = polyline 0, 0; 1, 1\n", NULL,
     "bad.cfg:8: clamp = polyline 0, 0; 1, 1: write `polyline thickness T: X, Y; X, Y; ...`; "
     "`thickness T` may be left out in a `shape` of a [wall]"},
    {TOP SOLID "clamp = polyline thickness 0: 0, 0; 1, 1\n", NULL,
     "bad.cfg:8: clamp = polyline thickness 0: 0, 0; 1, 1: the thickness must be at most 1e9 m, "
     "and 0 only in a `shape` of a [wall] or [rigid]"},
    {TOP SOLID "clamp = polyline thickness 1 mm: 0, 0; 0, 0\n", NULL,
     "bad.cfg:8: clamp = polyline thickness 1 mm: 0, 0; 0, 0: points 1 and 2 are the same"},
    {TOP SOLID "clamp = polyline thickness 1 mm: 0, 0; 1, 0; 0, 0.1\n", NULL,
     "bad.cfg:8: the polyline turns too sharply at its point 2 (1, 0)"},
    {TOP SOLID "clamp = polyline thickness 1 m: 0, 0; 0.1, 0; 0.1, 0.1\n", NULL,
     "bad.cfg:8: segment 1 of the polyline is too short for a thickness of 1 m: the joints at its "
     "ends cross"},
    {TOP SOLID "clamp = box 1, 1, 2, 2\n", NULL,
     "bad.cfg:8: clamp 1 of [solid a] contains no particle; it must cover a part of the body"},
    {TOP "[solid a]\ndensity = 1000\nyoung = 1 MPa\npoisson = 0.3\n", NULL,
     "bad.cfg:3: [solid a] lacks `shape`: elastic body in its reference configuration (m)"},
    {TOP
     "[solid a]\nshape = box 0, 0, 10 mm, 0.3 mm\ndensity = 1000\nyoung = 1 MPa\npoisson = 0.3\n",
     NULL,
     "bad.cfg:4: shape 1 of [solid a] contains no particle, because it is narrower than dp = 0.001 "
     "m or lies between lattice points; enlarge or move it"},
    {TOP "[solid a]\nshape = box 0, 0, 10 mm, 1 mm\ndensity = 1000\nyoung = 1 MPa\npoisson = 0.3\n",
     NULL,
     "bad.cfg:3: [solid a] is 1 particle thick at dp = 0.001 m; bending needs at least 2, better "
     "4"},
    {TOP SOLID "minus = box -1, -1, 1, 1\n", NULL,
     "bad.cfg:3: nothing is left of [solid a] after its `minus`"},
    {"dp = 1e-9 m\nend_time = 1 s\n[solid a]\nshape = box 0, 0, 10 mm, 20 km\ndensity = "
     "1000\nyoung = 1 MPa\npoisson = 0.3\n",
     NULL, "bad.cfg: dp = 1e-09 m gives about 2e+20 particles"},
    {"dp = 1e-300 m\nend_time = 1 s\n" SOLID, NULL,
     "bad.cfg: dp = 1e-300 m gives about inf particles"},
    {TOP FLUID SOLID, NULL,
     "bad.cfg:3: 200 particles of [fluid w] lie in [solid a], the first at (0.0005, 0.0005) m: "
     "move one of the shapes, or subtract the overlap with `minus`"},
    {TOP FLUID "[fluid v]\nlike = w\nshape = box 10 mm, 10 mm, 30 mm, 30 mm\n", NULL,
     "bad.cfg:6: 100 particles of [fluid v] lie in [fluid w], the first at (0.0105, 0.0105) m: "
     "move one of the shapes, or subtract the overlap with `minus`"},
    {TOP SOLID "[solid b]\nlike = a\nshape = box 5 mm, 5 mm, 10 mm, 20 mm\n", NULL,
     "bad.cfg:8: 75 particles of [solid b] lie in [solid a], the first at (0.0055, 0.0055) m: move "
     "one of the shapes, or subtract the overlap with `minus`"},
    {TOP SOLID "[wall w]\nshape = box 0, 15 mm, 10 mm, 30 mm\n", NULL,
     "bad.cfg:8: 50 particles of [wall w] lie in [solid a], the first at (0.0005, 0.0155) m: only "
     "the clamped part of a solid may lie in a wall"},
    {TOP FLUID "[wall w]\nshape = box -5 mm, 15 mm, 10 mm, 30 mm\n", NULL,
     "bad.cfg:3: 50 particles of [fluid w] lie in [wall w], the first at (0.0005, 0.0155) m: move "
     "one of the shapes, or subtract the overlap with `minus`"},
    {TOP "[fluid w]\nshape = box 0, 0, 20 mm, 20 mm\n", NULL,
     "bad.cfg:3: [fluid w] needs `sound_speed`, or `max_speed` and `max_pressure` for Eq. 3"},
    {TOP FLUID "[fluid v]\nlike = w\ndensity = 900\nshape = box 20 mm, 0, 30 mm, 20 mm\n", NULL,
     "bad.cfg:6: [fluid v] and [fluid w] differ in `density`: 900 and 1000; all fluid must have "
     "the same value"},
    {TOP FLUID "[fluid v]\nlike = w\nwall_repulsion = 0.1\nshape = box 20 mm, 0, 30 mm, 20 mm\n",
     NULL,
     "bad.cfg:6: [fluid v] and [fluid w] differ in `wall_repulsion`: 0.1 and 0.3; all fluid must "
     "have the same value"},
    {TOP FLUID "shifting = 1\nshifting_speed = largest\n"
               "[fluid v]\nlike = w\nshifting_speed = own\nshape = box 20 mm, 0, 30 mm, 20 mm\n",
     NULL,
     "bad.cfg:8: [fluid v] and [fluid w] differ in `shifting_speed`: own and largest; all fluid "
     "must have the same value"},
    {TOP FLUID "surface = 20 mm\npressure = 0\n", NULL,
     "bad.cfg:3: [fluid w] has both `surface` and `pressure`; leave one out"},
    {TOP FLUID "[wall w]\nmotion = lift\nshape = box 0, -5 mm, 20 mm, 0\n", NULL,
     "bad.cfg:7: motion = lift: there is no [motion] of that name"},
    {TOP FLUID "[table lift]\nfile = none/such.txt\n", NULL,
     "bad.cfg:7: [table lift] file: none/such.txt: cannot be read: No such file or directory"},
    {TOP FLUID "[motion lift]\nstart = 2\nstop = 1\n", NULL,
     "bad.cfg:6: [motion lift] start = 2 s must come before stop = 1 s"},
    {TOP SOLID "[output]\nsnapshot_fields = a234567890123456789012345678901234567890123456789012345"
               "678901234567890\n",
     NULL,
     "bad.cfg:8: [output] snapshot_fields: there is no field "
     "`a23456789012345678901234567890123456789"
     "012345678901234567890123`. Allowed: all, or any of"},
    {TOP SOLID "[output]\nsnapshot_fields = velocity presure\n", NULL,
     "bad.cfg:8: [output] snapshot_fields: there is no field `presure`; did you mean `pressure`? "
     "Allowed: all, or any of velocity density pressure kind id body stress von_mises displacement "
     "det_F thickness axial_force shear_force moment curvature"},
    {TOP SOLID FLUID "[probe F]\nquantity = force\nbody = aa\n", NULL,
     "bad.cfg:13: body = aa: there is no [solid] or [wall] of that name"},
    {TOP FLUID "[probe F]\nquantity = front\nbody = aa\n", NULL,
     "bad.cfg:6: [probe F] measures front of the fluid, at a fixed point; leave `body` out"},
    {TOP FLUID "density = 1000 kg/m3\n", NULL,
     "bad.cfg:6: density = 1000 kg/m3: unknown name `m3`; define it in [constants]"},
    {TOP FLUID "[probe S]\nquantity = surface_pressure\npoint = 0, 0\nto = 0, 0\n", NULL,
     "bad.cfg:6: [probe S] measures the pressure on the line from `point` to `to`; the two"},
    {TOP FLUID "[probe Q]\nquantity = flux\npoint = 0, 0\nto = 0, 0\n", NULL,
     "bad.cfg:6: [probe Q] measures the flux through the line from `point` to `to`; the two "
     "points"},
    {TOP SOLID "[probe M1]\npoint = 0, 0\n", NULL,
     "bad.cfg:8: [probe M1] needs `body`, the body that is measured"},
    {TOP SOLID "[probe M1]\nbody = aa\npoint = 0, 0\n", NULL,
     "bad.cfg:9: body = aa: there is no [solid] or [beam] of that name"},
    {TOP SOLID "[probe M1]\nbody = a\npoint = 0, 1\n", NULL,
     "bad.cfg:8: [probe M1] point (0, 1) lies about 0.98 m outside of [solid a]"},
    {TOP SOLID "[probe M1]\nquantity = pressure\npoint = 0, 1\n", NULL,
     "bad.cfg:8: [probe M1] measures pressure, but there is no fluid"},
    {TOP FLUID "[probe M1]\nquantity = pressure\npoint = 0, 1\n", NULL,
     "bad.cfg:6: [probe M1] point (0, 1) lies outside of the domain, (-0.0045, -0.0045) to "
     "(0.0245, 0.0435) m"},
    {TOP SOLID "[reference r]\nprobe = M1_dx_m\nfile = a.csv\n", NULL,
     "bad.cfg:9: [reference r] probe = M1_dx_m: no probe has such a column; a column is "
     "PROBE_QUANTITY_UNIT, such as M1_dx_m"},
    {TOP SOLID "[reference r]\nprobe = M1_dx_m\n", NULL,
     "bad.cfg:8: [reference r] needs either `file` or `formula`, and has neither"},
    {TOP SOLID "[domain]\nlower = 0, 0\nupper = 1, 0\n", NULL,
     "bad.cfg:8: [domain] lower must lie below and left of upper; here y is 0 and 0 m"},
    {TOP FLUID "[wall w]\nshape = box 0, -5 mm, 20 mm, 0\nslip = none\n", NULL,
     "bad.cfg:8: [wall w] slip enables the effect NO_SLIP, which needs LAMINAR "
     "(fluid.laminar_viscosity > "
     "0): fluid sticks to surfaces by its laminar viscosity"},
    {TOP SOLID "slip = none\n", NULL,
     "bad.cfg:8: [solid a] slip enables the effect NO_SLIP, which needs LAMINAR"},
    {TOP "integrator = verlet\n" FLUID "laminar_viscosity = 1e-3\n", NULL,
     "bad.cfg:7: [fluid w] laminar_viscosity enables the effect LAMINAR, which excludes VERLET "
     "(enabled by "
     "integrator in line 3): two-step Verlet is unstable with laminar viscosity"},
    {TOP FLUID "density_diffusion = 0\n", "w.diffusion_form=fourtakas",
     "--set: [fluid w] diffusion_form has no effect without DIFFUSION: leave it out, or enable "
     "DIFFUSION by fluid.density_diffusion > 0"},
    {TOP SOLID "hourglass = 0\nhourglass_form = printed\n", NULL,
     "bad.cfg:9: [solid a] hourglass_form has no effect without HOURGLASS: leave it out, or enable "
     "HOURGLASS by solid.hourglass > 0"},
    {TOP SOLID "artificial_viscosity = 0\nviscosity_form = printed\n", NULL,
     "bad.cfg:9: [solid a] viscosity_form has no effect without SOLID_VISCOSITY: leave it out, or "
     "enable SOLID_VISCOSITY by solid.artificial_viscosity > 0"},
    {TOP SOLID "[contact c]\n[solid b]\nlike = a\nshape = box 12 mm, 0, 20 mm, 20 mm\n" FLUID
               "[domain]\nperiodic = x\nlower = -5 mm, 0\nupper = 25 mm, 0.1\n",
     NULL,
     "bad.cfg:8: [contact c] enables the effect CONTACT, which excludes PERIODIC (enabled by "
     "[domain] "
     "periodic in line 16): contact is not computed through periodic sides"},
    {TOP FLUID "[contact c]\n", NULL, "bad.cfg:6: [contact c] needs a [solid]"},
    {TOP FLUID "[load l]\nshape = box 0, 0, 1 mm, 1 mm\nforce = 1, 0\n", NULL, "bad.cfg:6: "},
    {TOP FLUID "[domain]\nperiodic = x\n", NULL,
     "bad.cfg:6: [domain] periodic needs `lower` and `upper`"},
    {TOP FLUID "[domain]\nperiodic = y\nlower = 0, 0\nupper = 0.1, 20.4 mm\n", NULL,
     "bad.cfg:6: [domain] periodic: the period in y, 0.0204 m, is 20.4 times dp = 0.001 m and must "
     "be "
     "a whole number of them; 0.02 m would fit"},
    {TOP SOLID "[domain]\nperiodic = x\nlower = 0, 0\nupper = 0.1, 0.1\n", NULL,
     "bad.cfg:9: [domain] periodic enables the effect PERIODIC, which needs FLUID (a [fluid] "
     "section): only "
     "fluid can pass through periodic sides"},
    {TOP SOLID
     "[fluid w]\nshape = box 0, 30 mm, 11 mm, 50 mm\nsound_speed = 20\n[domain]\nperiodic = x\n"
     "lower = 0, 0\nupper = 11 mm, 0.1\n",
     NULL,
     "bad.cfg:11: [domain] periodic: [solid a] and its own image in x are 0.002 m apart, and "
     "solids "
     "are not bonded through a periodic side: at least 2 h = 0.003 m are needed"},
    {TOP FLUID "[domain]\nperiodic = x\nlower = -1 mm, 0\nupper = 19 mm, 0.1\n", NULL,
     "bad.cfg:6: a fluid particle at (0.0195, 0.0005) m lies outside [domain]; enlarge [domain] or "
     "change the shape"},
    {TOP SOLID "[domain]\nlower = 5 mm, 0\nupper = 1, 1\n", NULL,
     "bad.cfg:8: a solid particle at (0.0005, 0.0005) m lies outside [domain]; enlarge [domain] or "
     "change the shape"},
    {TOP SOLID, "dp", "--set dp: write key=value or section.key=value"},
    {TOP SOLID, "dpp=1 mm", "--set dpp=1 mm: unknown key `dpp`; did you mean `dp`?"},
    {TOP SOLID, "zebra=1", "--set zebra=1: unknown key or constant `zebra`"},
    {TOP SOLID, "dp=1 MPa",
     "--set dp=1 MPa: dp = 1 MPa: a pressure (Pa) where a length (m) is expected"},
    {TOP SOLID, "b.young=1 MPa", "--set b.young=1 MPa: the case has no section `b`"},
    {TOP SOLID, "a.yuong=1 MPa", "--set a.yuong=1 MPa: unknown key `yuong`; did you mean `young`?"},
    {TOP SOLID, "solid a.young=", "--set solid a.young=: `young` has no value"},
    {TOP SOLID "[wall a]\nshape = box 20 mm, 0, 30 mm, 20 mm\n", "a.shape=circle 0, 0, 1",
     "--set a.shape=circle 0, 0, 1: [solid a] and [wall a] both have `shape`; write for "
     "example \"solid a.shape\""},
    {TOP SOLID, "numerics.clf=1", "--set numerics.clf=1: unknown key `clf`; did you mean `cfl`?"},
    {TOP SOLID, "friction=1", "--set friction=1: unknown key `friction`; it belongs in [contact]"},
    {TOP SOLID, "output.young=1",
     "--set output.young=1: unknown key `young`; it belongs in [solid]"},
};

void setUp(void) {}
void tearDown(void) {}

static void test_each_is_refused_with_its_sentence(void)
{
    for (size_t k = 0; k < COUNT_OF(bad); k++) {
        struct scene scene;
        struct diag d = {0};
        const enum err err =
            scene_load_text(&scene, bad[k].text, "bad.cfg", bad[k].set != NULL, &bad[k].set, &d);
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_INPUT, err, bad[k].text);
        d.text[strlen(bad[k].message)] = '\0';
        TEST_ASSERT_EQUAL_STRING_MESSAGE(bad[k].message, d.text, bad[k].text);
    }
    printf("found: %zu bad case files, each refused with its sentence\n", COUNT_OF(bad));
}

/* What is wrong with `*value` for a key of this type, or NULL where every text is right. */
static const char *wrong(const struct param *param, const char **value)
{
    static char why[400];
    switch (param->type) {
    case PARAM_REAL:
    case PARAM_INTEGER: *value = "9e300"; return "out of range: it must be ";
    case PARAM_CHOICE:
        *value = "zebra";
        snprintf(why, sizeof why, "unknown choice; known: %s", param->choices);
        return why;
    case PARAM_VECTOR:
        *value = "1";
        snprintf(why, sizeof why, "two components are expected, `%s = X, Y`; there is 1",
                 param->key);
        return why;
    case PARAM_EXPR: *value = "(1"; return param->count > 1 ? "" : "`(` is not closed";
    case PARAM_HINGES: *value = "1"; return "`X, Y` or `X, Y, NAME` is expected; there is 1";
    case PARAM_SHAPES: *value = "cube 1"; return "";
    case PARAM_TEXT: break;
    }
    return NULL;
}

/* Keys that are added to case/params.def are tried without another line here. */
static void test_each_key_refuses_a_wrong_value_by_name(void)
{
    int tried = 0;
    for (int k = 0; k < PARAM_COUNT; k++) {
        const struct param *param = &param_table[k];
        const struct section_info *section = &section_table[param->section];
        const char *value, *why = wrong(param, &value);
        if (!why) continue;
        char text[1000], message[600], head[100] = "";
        if (param->section != SECTION_top)
            snprintf(head, sizeof head, section->named ? "[%s a]\n" : "[%s]\n", section->word);
        snprintf(text, sizeof text, "%s%s = %s\n", head, param->key, value);
        snprintf(message, sizeof message, "bad.cfg:%d: %s = %s: %s", *head ? 2 : 1, param->key,
                 value, why);
        struct scene scene;
        struct diag d = {0};
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_INPUT,
                                      scene_load_text(&scene, text, "bad.cfg", 0, NULL, &d), text);
        char said[sizeof d.text + sizeof d.more + 1]; /* what is missing in the case is said, too */
        snprintf(said, sizeof said, "%s\n%s", d.text, d.more);
        if (!strstr(said, message)) TEST_ASSERT_EQUAL_STRING_MESSAGE(message, said, text);
        tried++;
    }
    TEST_ASSERT_TRUE(tried > 60);
    printf("found: %d keys, each refuses a wrong value by name\n", tried);
}

/* --- several problems at once --- */

static void refuses_all(const char *text, int n_sets, const char *const *sets, const char *want)
{
    static char said[sizeof((struct diag *)0)->text + sizeof((struct diag *)0)->more];
    struct scene scene;
    struct diag d = {0};
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, scene_load_text(&scene, text, "bad.cfg", n_sets, sets, &d));
    snprintf(said, sizeof said, "%s\n%s", d.text, d.more);
    TEST_ASSERT_EQUAL_STRING(want, said);
}

/* Sorted by line, each once, and nothing that only follows from another: H and `b` are known to be
 * lost, poisson may be what is misspelt, young is given. */
static void test_all_problems_of_a_case_are_reported(void)
{
    static const char *const sets[] = {"output.probe_intervall=1"};
    refuses_all("dp = 1 MPa\nend_time 1 s\n[constant]\nH = 3\n"
                "[solid a]\nshape = bix 0\nyoung = 1/0\ndensity = H\npoison = 0.3\n"
                "[solids b]\nyoung = foo\n[solid c]\nlike = b\n",
                1, sets,
                "--set output.probe_intervall=1: unknown key `probe_intervall`; did you mean "
                "`probe_interval`?\n"
                "bad.cfg:1: dp = 1 MPa: a pressure (Pa) where a length (m) is expected\n"
                "bad.cfg:2: `end_time 1 s` is neither `key = value` nor `[section]`\n"
                "bad.cfg:3: unknown section [constant]; did you mean `constants`?\n"
                "bad.cfg:6: shape = bix 0: `bix` is not a shape; known: box X0, Y0, X1, Y1; "
                "circle X, Y, R; polygon X, Y; ...; polyline thickness T: X, Y; ...; "
                "arc thickness T: X, Y, R, A, B\n"
                "bad.cfg:7: young = 1/0: division by zero\n"
                "bad.cfg:9: unknown key `poison` in [solid]; did you mean `poisson`?\n"
                "bad.cfg:10: unknown section [solids]; did you mean `solid`?\n");
}

/* A constant that is wrong is reported where it stands, not at each use. */
static void test_uses_of_a_wrong_constant_are_not_problems(void)
{
    refuses_all(
        "dp = 1 mm\nend_time = T\n[constants]\nH = 3 foot\nT = 2*H\n" SOLID, 0, NULL,
        "bad.cfg:4: H = 3 foot: `foot` after 3 is not a unit (units: m km cm mm um, s min ms "
        "us, kg g, N, Pa kPa MPa GPa, Hz kHz, rad deg, %)\n");
}

static void test_twenty_problems_are_enough(void)
{
    char text[2000] = TOP;
    for (int k = 0; k < 30; k++) sprintf(text + strlen(text), "bad%d\n", k);
    struct scene scene;
    struct diag d = {0};
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, scene_load_text(&scene, text, "bad.cfg", 0, NULL, &d));
    int lines = 0;
    for (const char *c = d.more; *c; c++) lines += *c == '\n';
    TEST_ASSERT_EQUAL_INT(20, lines);
    TEST_ASSERT_NOT_NULL(strstr(d.more, "`bad19`"));
    TEST_ASSERT_NULL(strstr(d.more, "`bad20`"));
    TEST_ASSERT_NOT_NULL(
        strstr(d.more, "bad.cfg: reading stopped after 20 problems; there may be more\n"));
}

static void read_bytes(const char *bytes, size_t n, const char *message)
{
    const char *path = "test_case_errors.tmp";
    FILE *file = fopen(path, "wb");
    TEST_ASSERT_NOT_NULL(file);
    fwrite(bytes, 1, n, file);
    fclose(file);
    struct scene scene;
    struct diag d = {0};
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, scene_load_text(&scene, NULL, path, 0, NULL, &d));
    remove(path);
    TEST_ASSERT_EQUAL_STRING(message, d.text);
}

static void test_a_zero_byte_is_refused(void)
{
    read_bytes("dp = 1\n\0x", 9,
               "test_case_errors.tmp:2: a byte of value 0; a case file is plain text");
}

static void test_a_file_that_is_not_there(void)
{
    struct scene scene;
    struct diag d = {0};
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, scene_load_text(&scene, NULL, "no/such.cfg", 0, NULL, &d));
    TEST_ASSERT_EQUAL_STRING("no/such.cfg: cannot be opened: No such file or directory", d.text);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_key_refuses_a_wrong_value_by_name);
    RUN_TEST(test_each_is_refused_with_its_sentence);
    RUN_TEST(test_all_problems_of_a_case_are_reported);
    RUN_TEST(test_uses_of_a_wrong_constant_are_not_problems);
    RUN_TEST(test_twenty_problems_are_enough);
    RUN_TEST(test_a_zero_byte_is_refused);
    RUN_TEST(test_a_file_that_is_not_there);
    return UNITY_END();
}
