/* SPDX-License-Identifier: MIT
 * Sampling of shapes: neither a gap nor a double particle, whatever the lattice and the shapes. */
#include "particles/particles.h"
#include "case/scene.h"
#include "check/check.h"
#include "geometry/scene_points.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct scene scene;
static struct diag diag;
static char warnings[8192];

static void note(void *context, const char *text)
{
    (void)context;
    const size_t n = strlen(warnings);
    snprintf(warnings + n, sizeof warnings - n, "%s\n", text);
}

static enum err read(const char *text, const char *set)
{
    scene_free(&scene);
    warnings[0] = '\0';
    diag = (struct diag){.warn = note};
    const enum err e = scene_load_text(&scene, text, "geometry.cfg", set != NULL, &set, &diag);
    return e ? e : check_scene(&scene, &diag);
}

static void must_read(const char *text, const char *set)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, read(text, set), diag.text);
}

static int64_t count(enum kind kind) { return scene.points[kind].n; }

static int64_t total(void) { return count(KIND_FLUID) + count(KIND_WALL) + count(KIND_SOLID); }

/* Smallest distance between any two points, in dp, by brute force. */
static double nearest(void)
{
    static double x[20000], y[20000];
    int64_t n = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        for (int64_t k = 0; k < count((enum kind)kind); k++) {
            TEST_ASSERT_TRUE(n < (int64_t)COUNT_OF(x));
            x[n] = scene.points[kind].x[k];
            y[n++] = scene.points[kind].y[k];
        }
    }
    double least = HUGE_VAL;
    for (int64_t i = 0; i < n; i++)
        for (int64_t j = 0; j < i; j++)
            least = min2(least, square(x[i] - x[j]) + square(y[i] - y[j]));
    return sqrt(least) / scene.top.dp;
}

void setUp(void) {}

void tearDown(void) { scene_free(&scene); }

static const char tank[] =
    "dp = 2 mm\nend_time = 1 s\n[constants]\nwall = 8 mm\n"
    "[fluid w]\nshape = box 0, 0, 60 mm, 40 mm\nsound_speed = 20\n"
    "[wall tank]\n"
    "shape = polyline thickness -wall: 0, 60 mm; 0, 0; 60 mm, 0; 60 mm, 60 mm\n";

static void test_a_tank_is_filled_without_gap(void)
{
    must_read(tank, NULL);
    TEST_ASSERT_EQUAL_STRING("", warnings);
    TEST_ASSERT_EQUAL_INT64(30 * 20, count(KIND_FLUID));
    TEST_ASSERT_EQUAL_INT64(2 * 4 * 34 + 30 * 4, count(KIND_WALL));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1, nearest());
}

static void test_fluid_comes_row_by_row(void)
{
    must_read(tank, NULL);
    const struct scene_points *p = &scene.points[KIND_FLUID];
    for (int64_t k = 0; k < p->n; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2e-3 * (double)(k % 30) + 1e-3, p->x[k]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2e-3 * (double)(k / 30) + 1e-3, p->y[k]);
    }
}

/* Boxes that share edges cover what their union covers, wherever the lattice lies. */
static void test_shapes_that_abut(void)
{
    static const char text[] =
        "dp = 1 mm\nend_time = 1 s\n[constants]\na = 7 mm\nb = 13 mm\nox = 0 mm\noy = 0 mm\n"
        "[numerics]\nlattice_origin = ox, oy\n"
        "[fluid w]\nsound_speed = 20\nshape = box 0, 0, a, b\nshape = box a, 0, 20 mm, b\n"
        "shape = box 0, b, a, 20 mm\nshape = polygon a, b; 20 mm, b; 20 mm, 20 mm\n"
        "shape = polygon a, b; 20 mm, 20 mm; a, 20 mm\n";
    static const char *const sets[] = {"a=7 mm",         "a=7.5 mm",    "a=6.4999999 mm",
                                       "a=6.5000001 mm", "b=9.5 mm",    "b=3.3 mm",
                                       "ox=0.5 mm",      "ox=0.25 mm",  "oy=0.3 mm",
                                       "ox=1e-10 mm",    "oy=-1e-11 mm"};
    for (size_t k = 0; k < COUNT_OF(sets); k++) {
        must_read(text, sets[k]);
        TEST_ASSERT_EQUAL_INT64_MESSAGE(400, total(), sets[k]);
        TEST_ASSERT_TRUE_MESSAGE(nearest() > 0.99, sets[k]);
    }
}

static void test_regions_that_abut_share_no_particle(void)
{
    static const char text[] =
        "scheme = paper\ndp = 1 mm\nend_time = 1 s\n[constants]\ntilt = 3.3 mm\n"
        "[fluid w]\nsound_speed = 20\nshape = polygon 0, 0; 20 mm, tilt; 20 mm, 30 mm; 0, 30 mm\n"
        "[wall bed]\nshape = polygon 0, 0; 20 mm, tilt; 20 mm, -10 mm; 0, -10 mm\n";
    static const char *const sets[] = {"tilt=0", "tilt=20 mm", "tilt=10 mm", "tilt=1 mm",
                                       "tilt=0.5 mm"};
    static const double tilt[] = {0, 20, 10, 1, 0.5}; /* mm */
    for (size_t k = 0; k < COUNT_OF(sets); k++) {
        must_read(text, sets[k]);
        /* The wall has no particles deeper than 2.7 mm: none in 14 columns from 7 mm on upwards,
         * below level ground 14 times 4. */
        const double deep = 14 * (0.5 * tilt[k] + 7 - 2.7 * hypot(1, tilt[k] / 20));
        const int64_t kept = 800 - (k == 0 ? 14 * 4 : (int64_t)deep);
        /* Layers along the slope meet the fluid's lattice: where that leaves too little space,
         * fluid is left out, a tenth of a layer of 20 on average. */
        TEST_ASSERT_INT64_WITHIN_MESSAGE(k == 0 ? 0 : 12, kept, total(), sets[k]);
        TEST_ASSERT_TRUE_MESSAGE(nearest() > (k == 0 ? 0.99 : 0.64), sets[k]);
    }
}

/* Walls have particles as deep as the kernel's reach of 2.7 mm, from all of their edges: in rows of
 * 0.5, 1.5 and 2.5 mm, of a shape less a hole. The interior of a fluid stays. */
static void test_walls_are_shells(void)
{
    static const char text[] =
        "scheme = paper\ndp = 1 mm\nend_time = 1 s\n[numerics]\nh_over_dp = 1.35\n"
        "[fluid w]\nsound_speed = 20\nshape = box 0, 0, 20 mm, 10 mm\n"
        "[wall bed]\nshape = box 0, -30 mm, 40 mm, 0\nminus = box 15 mm, -20 mm, 25 mm, -10 mm\n";
    must_read(text, NULL);
    TEST_ASSERT_EQUAL_INT64(20 * 10, count(KIND_FLUID));
    const struct scene_points *p = &scene.points[KIND_WALL];
    TEST_ASSERT_TRUE(p->n > 0);
    int at_hole = 0, at_edge = 0;
    for (int64_t k = 0; k < p->n; k++) {
        const double x = 1e3 * p->x[k], y = 1e3 * p->y[k];
        const double edge = fmin(fmin(x, 40 - x), fmin(-y, 30 + y));
        const double hole = hypot(fmax(0, fabs(x - 20) - 5), fmax(0, fabs(y + 15) - 5));
        TEST_ASSERT_TRUE(edge < 2.7 || hole < 2.7);
        at_edge += edge < 2.7;
        at_hole += hole < 2.7;
    }
    TEST_ASSERT_EQUAL_INT(40 * 30 - 34 * 24, at_edge);
    TEST_ASSERT_EQUAL_INT(4 * 3 * 10 + 4 * 6, at_hole); /* in a corner 6 of 9 are within reach */
}

/* A clamp that moves leaves a hollow in the wall: its faces have particles, wherever they are. */
static void test_the_place_of_a_clamp_has_faces(void)
{
    static const char text[] =
        "scheme = paper\ndp = 1 mm\nend_time = 1 s\n[numerics]\nh_over_dp = 1.35\n"
        "[wall bed]\nshape = box 0, -30 mm, 40 mm, 0\n"
        "[solid plug]\nshape = box 15 mm, -20 mm, 25 mm, 10 mm\nclamp = box 15 mm, -20 mm, "
        "25 mm, 0\ndensity = 1000\nyoung = 1e6\npoisson = 0.3\n";
    must_read(text, NULL);
    const struct scene_points *p = &scene.points[KIND_WALL];
    int below = 0;
    for (int64_t k = 0; k < p->n; k++)
        below += fabs(1e3 * p->x[k] - 20) < 5 && fabs(1e3 * p->y[k] + 21.35) < 1.35;
    TEST_ASSERT_EQUAL_INT(10 * 3, below);
}

static void test_slanted_band_has_its_area(void)
{
    static const char band[] =
        "dp = 1 mm\nend_time = 1 s\n[fluid w]\nsound_speed = 20\n"
        "shape = polyline thickness 10 mm: 0, 0; 40 mm, 13 mm; 80 mm, 0; 120 mm, 50 mm\n";
    double length = 2 * hypot(40, 13) + hypot(40, 50), area = 10 * length;
    /* Each mitre adds or takes a kite of thickness^2 tan(half the turn). */
    const double down = 2 * atan2(13, 40), up = atan2(50, 40) + atan2(13, 40);
    area += 100 * (tan(down / 2) - tan(up / 2));
    must_read(band, "scheme=paper");
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * area, area, (double)total());
    TEST_ASSERT_TRUE(nearest() > 0.99);
    must_read(band, "scheme=standard"); /* settled */
    TEST_ASSERT_DOUBLE_WITHIN(1, area, (double)total());
    TEST_ASSERT_TRUE(nearest() > 0.8);
}

static void test_closed_polyline_and_circle(void)
{
    must_read("dp = 1 mm\nend_time = 1 s\n[fluid w]\nsound_speed = 20\nshape = circle 0, 0, 20 mm\n"
              "[wall ring]\nshape = polyline thickness 5 mm: -30 mm, -30 mm; -30 mm, 30 mm; "
              "30 mm, 30 mm; 30 mm, -30 mm; -30 mm, -30 mm\n",
              NULL);
    TEST_ASSERT_DOUBLE_WITHIN(20, 3.14159265 * 400, (double)count(KIND_FLUID));
    TEST_ASSERT_EQUAL_INT64(70 * 70 - 60 * 60, count(KIND_WALL));
}

static const char gate[] =
    "dp = 1 mm\nend_time = 1 s\n[constants]\nx0 = 20 mm\n"
    "[wall top]\nshape = box 10 mm, 30 mm, 40 mm, 36 mm\nshape = box 30 mm, 30 mm, 50 mm, 34 mm\n"
    "[solid gate]\nshape = box x0, 0, x0 + 5 mm, 33 mm\nclamp = box x0, 30 mm, x0 + 5 mm, 33 mm\n"
    "density = 1100\nyoung = 7.8 MPa\npoisson = 0.4\n";

static void test_clamp_takes_the_place_of_the_wall(void)
{
    must_read(gate, NULL);
    TEST_ASSERT_EQUAL_STRING("", warnings);
    TEST_ASSERT_EQUAL_INT64(5 * 33, count(KIND_SOLID));
    TEST_ASSERT_EQUAL_INT64(30 * 6 + 10 * 4 - 5 * 3, count(KIND_WALL));
    const struct scene_points *p = &scene.points[KIND_SOLID];
    int held = 0;
    for (int64_t k = 0; k < p->n; k++) {
        held += p->clamped[k];
        TEST_ASSERT_EQUAL_INT(p->y[k] > 0.030, p->clamped[k]);
        TEST_ASSERT_TRUE(k == 0 || p->y[k] > p->y[k - 1] || p->x[k] > p->x[k - 1]);
    }
    TEST_ASSERT_EQUAL_INT(15, held);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1e-3, p->y[1] - p->y[0]);
    TEST_ASSERT_TRUE(nearest() > 0.99);
}

static void test_a_solid_off_the_lattice_keeps_its_corner(void)
{
    must_read(gate, "x0=20.3 mm");
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "[solid"),
                             warnings); /* harmless; --explain says it */
    TEST_ASSERT_TRUE(scene.off_lattice);
    TEST_ASSERT_EQUAL_INT64(5 * 33, count(KIND_SOLID));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 20.8e-3, scene.points[KIND_SOLID].x[0]);
    TEST_ASSERT_TRUE(nearest() > 0.69);
}

static void test_off_lattice_edges_are_told(void)
{
    must_read("dp = 0.5 mm\nend_time = 1 s\n[fluid w]\nsound_speed = 20\n"
              "shape = box 0, 0, 5.3 mm, 5 mm\n",
              NULL);
    TEST_ASSERT_EQUAL_STRING("geometry.cfg:5: [fluid w] edge at x = 0.0053 m is off the lattice of "
                             "dp = 0.0005 m; x = 0.0055 m would fit\n",
                             warnings);
    TEST_ASSERT_EQUAL_INT64(11 * 10, total());
    /* Far from the origin of a lattice that is not at zero either. */
    must_read("dp = 0.5 mm\nend_time = 1 s\n[numerics]\nlattice_origin = 0.1 mm, 0\n"
              "[fluid w]\nsound_speed = 20\nshape = box -4 mm, 5.3 mm, 5.2 mm, 10 mm\n",
              NULL);
    TEST_ASSERT_EQUAL_STRING("geometry.cfg:7: [fluid w] edge at y = 0.0053 m is off the lattice of "
                             "dp = 0.0005 m; y = 0.0055 m would fit\n"
                             "geometry.cfg:7: [fluid w] edge at x = 0.0052 m is off the lattice of "
                             "dp = 0.0005 m; x = 0.0051 m would fit\n",
                             warnings);
    must_read("dp = 0.5 mm\nend_time = 1 s\n[fluid w]\nsound_speed = 20\n"
              "shape = box 0, 0, 0.6 mm, 5 mm\n",
              NULL);
    TEST_ASSERT_NOT_NULL(strstr(warnings, "edge at x = 0.0006 m is off the lattice"));
    TEST_ASSERT_TRUE(scene.off_lattice);
    must_read("dp = 0.5 mm\nend_time = 1 s\n[fluid w]\nsound_speed = 20\n"
              "shape = polygon 0, 0; 5.3 mm, 0; 5.3 mm, 5 mm; 0, 5 mm\n",
              NULL);
    TEST_ASSERT_TRUE(scene.off_lattice);
    must_read("dp = 0.5 mm\nend_time = 1 s\n[fluid w]\nsound_speed = 20\n"
              "shape = box 0, 0, 5.5 mm, 5 mm\n",
              NULL);
    TEST_ASSERT_FALSE(scene.off_lattice);
}

/* Faces of a solid with a lattice of its own: only fluid that starts under pressure expands into
 * the gap beside them. */
static void test_wet_faces_off_the_lattice_are_told(void)
{
    static const char leaflet[] =
        "dp = 1 mm\nend_time = 1 s\n[constants]\nx0 = 4 mm\n[fluid w]\nsound_speed = 20\n"
        "shape = box 0, 0, 10 mm, 10 mm\nminus = box x0, 0, x0 + 2 mm, 10 mm\npressure = 50\n"
        "[solid leaflet]\nshape = box x0, 0, x0 + 2 mm, 10 mm\nclamp = box x0, 0, x0 + 2 mm, 1 mm\n"
        "density = 1100\nyoung = 7.8 MPa\npoisson = 0.4\ndp = 0.25 mm\n";
    static const char told[] =
        "[solid leaflet] edge at x = 0.0065 m is off the lattice of dp = 0.001";
    must_read(leaflet, NULL);
    TEST_ASSERT_NULL(strstr(warnings, "off the lattice"));
    must_read(leaflet, "x0=4.5 mm");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, told), warnings);
}

static void test_thin_walls_and_slits_are_told(void)
{
    must_read("dp = 1 mm\nend_time = 1 s\n[fluid w]\nsound_speed = 20\n"
              "shape = box 0, 0, 5 mm, 5 mm\nshape = box 0, -5 mm, 5 mm, -2 mm\n"
              "[wall a]\nshape = box 0, -2 mm, 5 mm, 0\n"
              "[wall b]\nshape = box 5.4 mm, -5 mm, 10 mm, 5 mm\n",
              NULL);
    TEST_ASSERT_NOT_NULL(strstr(warnings, "[wall a] is 0.002 m thick, less than the kernel's reach "
                                          "2 h = 0.004 m"));
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(warnings, "m is 0.0004 m wide, and closed by sampling, so no fluid passes"),
        warnings);
}

/* Nothing is behind the outermost walls of a channel, nor of a tank; something is behind a weir. */
static void test_thin_outermost_walls_are_not(void)
{
    static const char top[] = "dp = 5 mm\nend_time = 1 s\n[fluid w]\nsound_speed = 20\n"
                              "shape = box 0, 0, 0.1, 0.1\n";
    char text[1000];
    snprintf(text, sizeof text, "%s%s", top,
             "[domain]\nlower = 0, -0.05\nupper = 0.1, 0.15\nperiodic = x\n[wall c]\n"
             "shape = box 0, -0.01, 0.1, 0\nshape = polyline thickness 10 mm: 0, 0.1; 0.1, 0.1\n");
    must_read(text, NULL);
    TEST_ASSERT_EQUAL_STRING("", warnings);
    static const char bath[] =
        "[wall c]\nshape = polyline thickness -10 mm: 0, 0.2; 0, 0; 0.3, 0; 0.3, 0.2\n";
    snprintf(text, sizeof text, "%s%s", top, bath);
    must_read(text, NULL);
    TEST_ASSERT_EQUAL_STRING("", warnings);
    snprintf(text, sizeof text, "%s%s[wall d]\nshape = box 0.1, 0, 0.11, 0.1\n", top, bath);
    must_read(text, NULL);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "[wall d] is 0.01 m thick"), warnings);
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "[wall c]"), warnings);
}

static void test_thin_solids_are_told(void)
{
    must_read("dp = 1 mm\nend_time = 1 s\n[fluid w]\nsound_speed = 20\n"
              "shape = box 0, 0, 5 mm, 5 mm\n[solid s]\nshape = box 5 mm, 0, 8 mm, 20 mm\n"
              "density = 1000\nyoung = 1e6\npoisson = 0.3\n[numerics]\nh_over_dp = 2\n",
              NULL);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings,
                                        "geometry.cfg:6: [solid s] is 0.003 m thick, less "
                                        "than the kernel's reach 2 h = 0.004 m"),
                                 warnings);
}

/* Far from the origin of coordinates, whose digits they have left. */
static void test_shapes_far_away(void)
{
    must_read("dp = 1 m\nend_time = 1 s\n[fluid w]\nsound_speed = 20\n"
              "shape = box 8e8, 0, 8e8 + 20, 20\n",
              NULL);
    TEST_ASSERT_EQUAL_INT64(400, count(KIND_FLUID));
}

static void test_domain_holds_moving_walls(void)
{
    must_read("dp = 1 mm\nend_time = 1 s\n[fluid w]\nsound_speed = 20\n"
              "shape = box 0, 0, 5 mm, 5 mm\n[wall a]\nshape = box 0, -4 mm, 5 mm, 0\nmotion = m\n"
              "[motion m]\nx = -3*t\ny = 2*t\n",
              NULL);
    TEST_ASSERT_TRUE(scene.domain_lower[0] < -3 && scene.domain_upper[1] > 2);
    TEST_ASSERT_TRUE(scene.domain_upper[0] > 0.005 && scene.domain_lower[1] < -0.004);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_tank_is_filled_without_gap);
    RUN_TEST(test_fluid_comes_row_by_row);
    RUN_TEST(test_shapes_that_abut);
    RUN_TEST(test_regions_that_abut_share_no_particle);
    RUN_TEST(test_walls_are_shells);
    RUN_TEST(test_the_place_of_a_clamp_has_faces);
    RUN_TEST(test_slanted_band_has_its_area);
    RUN_TEST(test_closed_polyline_and_circle);
    RUN_TEST(test_clamp_takes_the_place_of_the_wall);
    RUN_TEST(test_a_solid_off_the_lattice_keeps_its_corner);
    RUN_TEST(test_off_lattice_edges_are_told);
    RUN_TEST(test_wet_faces_off_the_lattice_are_told);
    RUN_TEST(test_thin_walls_and_slits_are_told);
    RUN_TEST(test_thin_outermost_walls_are_not);
    RUN_TEST(test_thin_solids_are_told);
    RUN_TEST(test_shapes_far_away);
    RUN_TEST(test_domain_holds_moving_walls);
    return UNITY_END();
}
