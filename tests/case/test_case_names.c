/* SPDX-License-Identifier: MIT
 * Names of other sections are checked in the same run as values, and places of probes are
 * needed. */
#include "case/scene.h"
#include "geometry/scene_points.h"
#include "unity.h"

#include <stdio.h>

#define TOP "dp = 1 mm\nend_time = 1 s\n"
#define SOLID \
    "[solid a]\nshape = box 0, 0, 10 mm, 20 mm\ndensity = 1000\nyoung = 1 MPa\npoisson = 0.3\n"
#define FLUID "[fluid w]\nshape = box 0, 0, 20 mm, 20 mm\nsound_speed = 20\n"

void setUp(void) {}
void tearDown(void) {}

static void refuses_all(const char *text, const char *want)
{
    struct scene scene;
    struct diag d = {0};
    char said[sizeof d.text + sizeof d.more];
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, scene_load_text(&scene, text, "bad.cfg", 0, NULL, &d));
    snprintf(said, sizeof said, "%s\n%s", d.text, d.more);
    TEST_ASSERT_EQUAL_STRING(want, said);
}

/* Names and values in one run; what else concerns several values, such as the times of [motion m],
 * when all are right. */
static void test_names_are_checked_beside_wrong_values(void)
{
    refuses_all(
        TOP "[solid a]\nshape = box 0, 0, 10 mm, 20 mm\nyoung = 1 Mpa\nclamp = bix 0\n"
            "clamp_motion = m\n[wall w]\nmotion = mm\n[motion m]\nstop = -1\n"
            "[probe p]\nquantity = reaction\nbody = a\n[probe q]\nbody = b\n"
            "point = 0, 0\n[load l]\nbody = aa\n[contact c]\nbetween = a, v\n",
        "bad.cfg:3: [solid a] lacks `density`: reference density (kg/m^3)\n"
        "bad.cfg:3: [solid a] lacks `poisson`: Poisson ratio nu\n"
        "bad.cfg:5: young = 1 Mpa: `Mpa` after 1 is not a unit (units: m km cm mm um, s min ms "
        "us, kg g, N, Pa kPa MPa GPa, Hz kHz, rad deg, %)\n"
        "bad.cfg:6: clamp = bix 0: `bix` is not a shape; known: box X0, Y0, X1, Y1; "
        "circle X, Y, R; polygon X, Y; ...; polyline thickness T: X, Y; ...; "
        "arc thickness T: X, Y, R, A, B\n"
        "bad.cfg:8: [wall w] lacks `shape`: rigid wall (m)\n"
        "bad.cfg:9: motion = mm: there is no [motion] of that name\n"
        "bad.cfg:16: body = b: there is no [solid] or [beam] of that name\n"
        "bad.cfg:18: [load l] lacks `shape`: region of the body, in the reference "
        "configuration, whose particles carry the load (m)\n"
        "bad.cfg:19: body = aa: there is no [solid] or [beam] of that name\n"
        "bad.cfg:21: between = v: there is no [solid] or [wall] of that name\n");
}

/* What concerns several values is looked at in every section. */
static void test_checks_go_on_after_the_first(void)
{
    refuses_all(
        TOP SOLID "joined = zz\n[probe p]\nbody = zz\n[load l]\nbody = a\n"
                  "[motion m]\nstop = -1\n[contact c]\n[reference r]\n",
        "bad.cfg:8: joined = zz: there is no [solid] of that name\n"
        "bad.cfg:9: [probe p] lacks `point`: quantity = displacement needs the place, two "
        "numbers, in metres\n"
        "bad.cfg:10: body = zz: there is no [solid] or [beam] of that name\n"
        "bad.cfg:11: [load l] lacks `shape`: region of the body, in the reference configuration, "
        "whose particles carry the load (m)\n"
        "bad.cfg:11: [load l] needs either `force` or `traction`, and has neither\n"
        "bad.cfg:13: [motion m] start = 0 s must come before stop = -1 s\n"
        "bad.cfg:16: [reference r] lacks `probe`: column that the reference is compared "
        "with, such as M1_dx_m\n"
        "bad.cfg:16: [reference r] needs either `file` or `formula`, and has neither\n");
}

/* Without them, a line or a place would be at the origin. */
static void test_a_probe_needs_its_place(void)
{
    refuses_all(TOP FLUID "[probe p]\nquantity = flux\npoint = 1 mm, 0\n[probe q]\n"
                          "quantity = surface_pressure\nto = 0, 1 mm\n[probe r]\n"
                          "quantity = level\n[probe s]\nquantity = front\n",
                "bad.cfg:6: [probe p] lacks `to`: quantity = flux needs both ends of its line, "
                "`point` and `to`, in metres\n"
                "bad.cfg:9: [probe q] lacks `point`: quantity = surface_pressure needs both ends "
                "of its line, `point` and `to`, in metres\n"
                "bad.cfg:12: [probe r] lacks `point`: quantity = level needs the place, two "
                "numbers, in metres\n");
}

/* A face that bends is no line. */
static void test_a_line_moves_with_walls_only(void)
{
    refuses_all(
        TOP FLUID "[solid b]\nshape = box 20 mm, 0, 30 mm, 20 mm\ndensity = 1000\n"
                  "young = 1 MPa\npoisson = 0.3\n[probe p]\n"
                  "quantity = surface_pressure\npoint = 20 mm, 0\nto = 20 mm, 9 mm\non = b\n",
        "bad.cfg:11: [probe p] on = b is a solid, which bends; a line moves with walls only. "
        "quantity = force measures the fluid's force on the solid\n");
}

static void test_a_folder_is_no_file(void)
{
    struct scene scene;
    struct diag d = {0};
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, scene_load_text(&scene, NULL, ".", 0, NULL, &d));
    TEST_ASSERT_EQUAL_STRING(".: is a folder; a case is a regular file", d.text);
}

/* What a section lacks that others are like is told of it alone; so is a constant that cannot have
 * its name, without its uses. */
static void test_what_follows_from_a_problem_is_none(void)
{
    refuses_all(TOP "[solid a]\nshape = box 0, 0, 10 mm, 20 mm\n"
                    "density 1000\nyoung = 1 MPa\npoisson = 0.3\n"
                    "[solid b]\nlike = a\nshape = box 0.1, 0, 0.11, 20 mm\n"
                    "[solid c]\nlike = b\nshape = box 0.2, 0, 0.21, 20 mm\n",
                "bad.cfg:5: `density 1000` is neither `key = value` nor `[section]`\n");
    refuses_all(TOP "[constants]\ns = 20 mm\nH = 2*s\n[solid a]\nshape = box 0, 0, 2*s, s\n"
                    "density = 1000\nyoung = 1 MPa\npoisson = 0.3\n",
                "bad.cfg:4: a constant cannot be named `s`: that is a unit; rename it\n");
}

/* Without `dp` nothing is sampled, also where an unknown key may stand for it. */
static void test_shapes_without_their_spacing(void)
{
    refuses_all("tiAtle = x\nend_time = 1\n[fluid w]\nshape = box 0, 0, 20 mm, 20 mm\n"
                "sound_speed = 20\n",
                "bad.cfg:1: unknown key `tiAtle` at the top of the file; did you mean `title`?\n");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_names_are_checked_beside_wrong_values);
    RUN_TEST(test_checks_go_on_after_the_first);
    RUN_TEST(test_a_line_moves_with_walls_only);
    RUN_TEST(test_a_probe_needs_its_place);
    RUN_TEST(test_what_follows_from_a_problem_is_none);
    RUN_TEST(test_a_folder_is_no_file);
    RUN_TEST(test_shapes_without_their_spacing);
    return UNITY_END();
}
