/* SPDX-License-Identifier: MIT
 * Bodies and walls at any angle: lattices turned with them and fitted to their edges, layers along
 * walls. */
#include "particles/particles.h"
#include "case/scene.h"
#include "check/check.h"
#include "geometry/scene_points.h"
#include "geometry/thin.h"
#include "rig.h"
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
    const enum err e = scene_load_text(&scene, text, "lattice.cfg", set != NULL, &set, &diag);
    return e ? e : check_scene(&scene, &diag);
}

static void must_read(const char *text, const char *set)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, read(text, set), diag.text);
}

void setUp(void) {}
void tearDown(void) { scene_free(&scene); }

static const double pi = 3.14159265358979323846;

#define RUBBER "density = 1000\nyoung = 1e6\npoisson = 0.3\n"

/* A bar of 50 x 8 mm, held at its lower end by a box of 4 mm, in a tank with water, all turned. */
static const char turned[] =
    "dp = 1 mm\nend_time = 1 s\n[constants]\na = 0\nc = cos(a)\nq = sin(a)\n"
    "[fluid w]\nsound_speed = 20\nshape = polygon 0, 0; 20 mm*c, 20 mm*q; "
    "20 mm*c - 30 mm*q, 20 mm*q + 30 mm*c; -30 mm*q, 30 mm*c\n"
    "[wall t]\nshape = polyline thickness -4 mm: -40 mm*q, 40 mm*c; 0, 0; 28 mm*c, 28 mm*q\n"
    "[solid b]\n" RUBBER
    "shape = polygon 20 mm*c + 4 mm*q, 20 mm*q - 4 mm*c; 28 mm*c + 4 mm*q, 28 mm*q - 4 mm*c; "
    "28 mm*c - 46 mm*q, 28 mm*q + 46 mm*c; 20 mm*c - 46 mm*q, 20 mm*q + 46 mm*c\n"
    "clamp = polygon 20 mm*c + 4 mm*q, 20 mm*q - 4 mm*c; 28 mm*c + 4 mm*q, 28 mm*q - 4 mm*c; "
    "28 mm*c, 28 mm*q; 20 mm*c, 20 mm*q\n";

/* Every particle is where that of the upright scene is, turned. */
static void test_a_turned_scene_is_the_scene_turned(void)
{
    static double x[3][2000], y[3][2000];
    static const char *const angles[] = {"a=0",      "a=15 deg",  "a=26.565 deg",
                                         "a=45 deg", "a=-30 deg", "a=90 deg"};
    static const double value[] = {0, 15, 26.565, 45, -30, 90};
    int64_t n[3];
    for (size_t k = 0; k < COUNT_OF(angles); k++) {
        must_read(turned, angles[k]);
        TEST_ASSERT_EQUAL_STRING("", warnings);
        for (int kind = 0; kind < KIND_COUNT; kind++) {
            const struct scene_points *const p = &scene.points[kind];
            const double c = cos(value[k] * pi / 180), s = sin(value[k] * pi / 180);
            if (k == 0) n[kind] = p->n;
            TEST_ASSERT_EQUAL_INT64_MESSAGE(n[kind], p->n, angles[k]);
            for (int64_t i = 0; i < p->n; i++) {
                const double X = c * p->x[i] + s * p->y[i], Y = c * p->y[i] - s * p->x[i];
                if (k == 0) x[kind][i] = X, y[kind][i] = Y;
                double nearest = HUGE_VAL;
                for (int64_t j = 0; j < p->n; j++)
                    nearest = min2(nearest, hypot(X - x[kind][j], Y - y[kind][j]));
                TEST_ASSERT_TRUE_MESSAGE(nearest < 1e-9, angles[k]);
            }
        }
    }
    TEST_ASSERT_EQUAL_INT64(600, n[KIND_FLUID]);
    TEST_ASSERT_EQUAL_INT64(400, n[KIND_SOLID]);
}

static void test_lattice_angle_overrides(void)
{
    must_read(turned, "b.lattice_angle=30 deg");
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, pi / 6, scene.solid_lattice[0].angle);
    must_read(turned, "numerics.lattice_angle=10 deg");
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, pi / 18, scene.lattice.angle);
    TEST_ASSERT_TRUE(scene.solid_lattice[0].angle == 0);
}

/* No direction has more than half of the outline: the lattice is not turned, and stays symmetric.
 */
static void test_shapes_without_a_main_direction(void)
{
    must_read("dp = 1 mm\nend_time = 1\n[solid b]\n" RUBBER
              "shape = polygon -20 mm, 10 mm; 0, 0; 20 mm, 10 mm; 20 mm, 20 mm; 0, 10 mm; "
              "-20 mm, 20 mm\n",
              NULL);
    TEST_ASSERT_TRUE(scene.solid_lattice[0].angle == 0);
    must_read("dp = 1 mm\nend_time = 1\n[solid b]\n" RUBBER "shape = circle 0, 0, 10 mm\n", NULL);
    TEST_ASSERT_TRUE(scene.solid_lattice[0].angle == 0 && !scene.solid_lattice[0].fitted);
}

/* 10.4 x 53.7 spacings become 10 x 54 cells that cover the bar. */
static void test_cells_fit_a_bar(void)
{
    static const char bar[] =
        "dp = 1 mm\nend_time = 1\n[constants]\na = 0\nc = cos(a)\nq = sin(a)\n[solid b]\n" RUBBER
        "shape = polygon 0, 0; 53.7 mm*c, 53.7 mm*q; 53.7 mm*c - 10.4 mm*q, "
        "53.7 mm*q + 10.4 mm*c; -10.4 mm*q, 10.4 mm*c\n";
    static const char *const angles[] = {"a=0", "a=33 deg", "a=45 deg"};
    for (size_t k = 0; k < COUNT_OF(angles); k++) {
        must_read(bar, angles[k]);
        TEST_ASSERT_EQUAL_STRING_MESSAGE("", warnings, angles[k]);
        TEST_ASSERT_EQUAL_INT64(540, scene.points[KIND_SOLID].n);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 53.7e-3 * 10.4e-3, 540 * square(scene_solid_dp(&scene, 0)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 53.7e-3 * 10.4e-3, scene.solid_lattice[0].area);
    }
}

/* Off the lattice along one side only: cells of two lengths, and a spacing of their mean area. */
static void test_cells_fit_one_side(void)
{
    must_read("dp = 1 mm\nend_time = 1\n[solid b]\n" RUBBER "shape = box 0, 0, 53.7 mm, 10 mm\n",
              NULL);
    const struct scene_lattice *const l = &scene.solid_lattice[0];
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 53.7e-3 / 54, l->spacing[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1e-3, l->spacing[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, sqrt(l->spacing[0] * l->spacing[1]), l->dp);
}

/* Two halves are one bar: the joint is no edge that the cells would be fitted to. */
static void test_cells_ignore_a_joint(void)
{
    must_read("dp = 1 mm\nend_time = 1\n[solid b]\n" RUBBER
              "shape = box 0, 0, 20.5 mm, 10 mm\nshape = box 20.5 mm, 0, 50 mm, 10 mm\n",
              NULL);
    TEST_ASSERT_EQUAL_INT64(500, scene.points[KIND_SOLID].n);
    TEST_ASSERT_FALSE(scene.solid_lattice[0].fitted);
}

/* A shape within another of the body adds nothing, and its edges are none. */
static void test_a_shape_within_another(void)
{
    must_read("dp = 1 mm\nend_time = 1\n[solid b]\n" RUBBER
              "shape = box 0, 0, 50 mm, 10 mm\nshape = box 20.3 mm, 2.4 mm, 30.6 mm, 7.7 mm\n",
              NULL);
    TEST_ASSERT_EQUAL_INT64(500, scene.points[KIND_SOLID].n);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 500e-6, scene.solid_lattice[0].area);
    TEST_ASSERT_FALSE(scene.solid_lattice[0].fitted);
}

/* A bar with a round end has the area of a bar and half a circle, at any angle. */
static void test_area_of_a_round_end(void)
{
    static const char bar[] =
        "dp = 1 mm\nend_time = 1\n[constants]\na = 0\nc = cos(a)\nq = sin(a)\n[solid b]\n" RUBBER
        "shape = polygon 0, 0; 50 mm*c, 50 mm*q; 50 mm*c - 10 mm*q, 50 mm*q + 10 mm*c; "
        "-10 mm*q, 10 mm*c\nshape = circle 50 mm*c - 5 mm*q, 50 mm*q + 5 mm*c, 5 mm\n";
    static const char *const angles[] = {"a=0", "a=33 deg", "a=-80 deg"};
    for (size_t k = 0; k < COUNT_OF(angles); k++) {
        must_read(bar, angles[k]);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.2e-6, 500e-6 + 12.5e-6 * pi,
                                          scene.solid_lattice[0].area, angles[k]);
    }
}

/* Bodies that nothing joins have each a lattice of their own. */
static void test_each_body_has_its_lattice(void)
{
    must_read("dp = 1 mm\nend_time = 1\n[solid a]\n" RUBBER "shape = box 0, 0, 10 mm, 10 mm\n"
              "[solid b]\n" RUBBER "shape = box 20.3 mm, 0.4 mm, 30.3 mm, 10.4 mm\n",
              NULL);
    const struct scene_lattice *const l = scene.solid_lattice;
    double cells;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, remainder(l[0].origin[0], 1e-3));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.3, modf(l[1].origin[0] / 1e-3, &cells));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.4, modf(l[1].origin[1] / 1e-3, &cells));
    TEST_ASSERT_EQUAL_INT64(200, scene.points[KIND_SOLID].n);
}

/* An arch: rows of two legs below rows of one beam. */
static void test_area_of_an_arch(void)
{
    must_read("dp = 1 mm\nend_time = 1\n[solid b]\n" RUBBER
              "shape = polygon 0, 0; 10 mm, 0; 10 mm, 30 mm; 40 mm, 30 mm; 40 mm, 0; 50 mm, 0; "
              "50 mm, 40 mm; 0, 40 mm\n",
              NULL);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1100e-6, scene.solid_lattice[0].area);
}

/* The lattice is fitted to the free part: from where the clamp ends to the tip. */
static void test_cells_begin_at_a_clamp(void)
{
    static const char bar[] =
        "dp = 1 mm\nend_time = 1\n[constants]\nat = 5.3 mm\n[solid b]\n" RUBBER
        "shape = box 0, 0, 50 mm, 10 mm\nclamp = box 0, 0, at, 10 mm\n";
    static const char *const sets[] = {"at=5 mm", "at=5.3 mm", "at=5.5 mm", "at=5.8 mm"};
    static const double value[] = {5e-3, 5.3e-3, 5.5e-3, 5.8e-3};
    for (size_t k = 0; k < COUNT_OF(sets); k++) {
        must_read(bar, sets[k]);
        const struct scene_points *const p = &scene.points[KIND_SOLID];
        double held = 0, tip = 0, free = HUGE_VAL;
        for (int64_t i = 0; i < p->n; i++) {
            tip = max2(tip, p->x[i]);
            if (p->clamped[i])
                held = max2(held, p->x[i]);
            else
                free = min2(free, p->x[i]);
        }
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-9, value[k], 0.5 * (held + free), sets[k]);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-9, 50e-3, tip + 0.5 * (free - held), sets[k]);
        /* So the free part has its area, which is what bends, though the whole has not: no warning.
         */
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, scene.solid_lattice[0].area_error);
        TEST_ASSERT_EQUAL_STRING("", warnings);
    }
}

/* Held by a circle, rows are cut where its arc lies on average: 0.1411 mm short of its radius. */
static void test_cells_begin_at_a_curved_clamp(void)
{
    must_read("dp = 1 mm\nend_time = 1\n[solid b]\n" RUBBER
              "shape = box -10 mm, -5 mm, 50.4 mm, 5 mm\nclamp = circle -29.9 mm, 0, 30 mm\n",
              NULL);
    const struct scene_lattice *const l = &scene.solid_lattice[0];
    const double cells = (-0.0411e-3 - l->origin[0]) / l->spacing[0];
    TEST_ASSERT_DOUBLE_WITHIN(0.01, round(cells), cells);
    const double tip = (50.4e-3 - l->origin[0]) / l->spacing[0];
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, round(tip), tip);
}

static void test_area_is_told(void)
{
    must_read("dp = 2 mm\nend_time = 1\n[solid b]\n" RUBBER "shape = circle 0, 0, 23 mm\n", NULL);
    const double ratio = (double)scene.points[KIND_SOLID].n * 4 / (pi * 529);
    TEST_ASSERT_TRUE(fabs(ratio - 1) > 0.005);
    char expected[64];
    snprintf(expected, sizeof expected, "cover %.2g %% %s than the shape there",
             100 * fabs(ratio - 1), ratio > 1 ? "more" : "less");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, expected), warnings);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "so a thin body is about"), warnings);
}

/* --- layers --- */

/* A ramp, a bent band, a post and a cavity, with fluid beside them. */
static const char slopes[] =
    "dp = 1 mm\nend_time = 1\n"
    "[fluid w]\nsound_speed = 20\nshape = polygon 0, 0; 50 mm, 0; 110 mm, 30 mm; 0, 30 mm\n"
    "minus = circle 30 mm, 15 mm, 6 mm\n"
    "[wall t]\nshape = polyline thickness -4 mm: 0, 50 mm; 0, 0; 120 mm, 0; 120 mm, 50 mm\n"
    "shape = polygon 50 mm, 0; 120 mm, 35 mm; 120 mm, 0\n"
    "[wall post]\nshape = circle 30 mm, 15 mm, 6 mm\n"
    "[wall bed]\nshape = polyline thickness -3.6 mm: 150 mm, 30 mm; 160 mm, 0; 180 mm, -10 mm; "
    "210 mm, 2 mm; 216 mm, 30 mm\n"
    "[fluid v]\nlike = w\nshape = polygon 150 mm, 30 mm; 160 mm, 0; 180 mm, -10 mm; 210 mm, 2 mm; "
    "216 mm, 30 mm\n"
    "[wall cave]\nshape = box 240 mm, -20 mm, 280 mm, 20 mm\nminus = circle 260 mm, 0, 12 mm\n"
    "[fluid u]\nlike = w\nshape = circle 260 mm, 0, 12 mm\n";

static double to_segment(double x, double y, const double a[2], const double b[2])
{
    const double dx = b[0] - a[0], dy = b[1] - a[1];
    const double s = ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy);
    const double on = min2(max2(s, 0), 1);
    return hypot(x - a[0] - on * dx, y - a[1] - on * dy);
}

/* The first layer lies half a spacing from the face, all along it. */
static void test_layers_follow_faces(void)
{
    must_read(slopes, NULL);
    static const double faces[][2][2] = {{{50e-3, 0}, {120e-3, 35e-3}},
                                         {{150e-3, 30e-3}, {160e-3, 0}},
                                         {{160e-3, 0}, {180e-3, -10e-3}},
                                         {{180e-3, -10e-3}, {210e-3, 2e-3}}};
    const struct scene_points *const p = &scene.points[KIND_WALL];
    for (size_t k = 0; k < COUNT_OF(faces); k++) {
        const double *a = faces[k][0], *b = faces[k][1], length = hypot(b[0] - a[0], b[1] - a[1]);
        const double spacing = k == 0 ? 1e-3 : 0.9e-3;
        int first = 0;
        for (int64_t i = 0; i < p->n; i++) {
            const double d = to_segment(p->x[i], p->y[i], a, b);
            const double s = ((p->x[i] - a[0]) * (b[0] - a[0]) + (p->y[i] - a[1]) * (b[1] - a[1])) /
                             square(length);
            if (s < 0.1 || s > 0.9) continue;
            TEST_ASSERT_TRUE_MESSAGE(d > 0.499 * spacing, "nearer to the face");
            if (d > 0.9 * spacing) continue;
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.01 * spacing, 0.5 * spacing, d, "first layer");
            first++;
        }
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1.5, 0.8 * length / 1e-3, first, "points of a layer");
    }
}

/* A valley with two equal sides: for each particle one on the other side, also round the corner. */
static void test_layers_are_even(void)
{
    must_read("dp = 1 mm\nend_time = 1\n[wall bed]\n"
              "shape = polyline thickness -4 mm: -20.3 mm, 11.1 mm; 0, 0; 20.3 mm, 11.1 mm\n"
              "[fluid w]\nsound_speed = 20\n"
              "shape = polygon -20.3 mm, 11.1 mm; 0, 0; 20.3 mm, 11.1 mm\n",
              NULL);
    const struct scene_points *const p = &scene.points[KIND_WALL];
    TEST_ASSERT_TRUE(p->n > 150);
    for (int64_t i = 0; i < p->n; i++) {
        double nearest = HUGE_VAL;
        for (int64_t j = 0; j < p->n; j++)
            nearest = min2(nearest, hypot(p->x[i] + p->x[j], p->y[i] - p->y[j]));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, nearest);
    }
}

/* Wendland's kernel summed over the cells of all particles: 1 where space is filled. */
static double filled(double x, double y)
{
    const double h = scene.h;
    double sum = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const struct scene_points *const p = &scene.points[kind];
        for (int64_t i = 0; i < p->n; i++) {
            const double q = hypot(p->x[i] - x, p->y[i] - y) / h;
            if (q < 2) sum += 7 / (4 * pi * h * h) * square(square(1 - q / 2)) * (2 * q + 1);
        }
    }
    return sum * square(scene.top.dp);
}

/* Neither holes nor doubled particles, within walls and where they meet fluid. */
static void test_space_is_filled(void)
{
    must_read(slopes, NULL);
    const double dp = scene.top.dp;
    double least = HUGE_VAL, mean = 0;
    int64_t n = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const struct scene_points *const p = &scene.points[kind];
        for (int64_t i = 0; i < p->n; i++)
            for (int other = 0; other < KIND_COUNT; other++)
                for (int64_t j = 0; j < scene.points[other].n; j++)
                    if (other != kind || i != j)
                        least = min2(least, hypot(p->x[i] - scene.points[other].x[j],
                                                  p->y[i] - scene.points[other].y[j]));
    }
    TEST_ASSERT_TRUE(least > 0.64 * dp);
    const struct scene_points *const p = &scene.points[KIND_FLUID];
    for (int64_t i = 0; i < p->n; i++) {
        if (p->y[i] > (p->x[i] < 0.12 ? 0.026 : 0.02))
            continue; /* free surfaces and the bed's rim */
        const double sum = filled(p->x[i], p->y[i]);
        TEST_ASSERT_TRUE(sum > 0.80 && sum < 1.2);
        mean += sum;
        n++;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1, mean / (double)n);
}

/* The particles of water beside slopes and a hump have its area, of water around a cylinder also.
 * With `scheme = paper` those too near to a wall are missing. */
static void test_fluid_beside_slopes_has_its_area(void)
{
    static const char slope[] = "scheme = standard\ndp = 1 mm\nend_time = 1\n[constants]\na = 30 "
                                "deg\nL = 10 mm/tan(a)\nw = 60 mm\n"
                                "[fluid w]\nsound_speed = 20\nshape = polygon 0, 0; 15 mm, 0; 15 "
                                "mm + L, 10 mm; w, 10 mm; w, 20 mm; "
                                "0, 20 mm\n"
                                "[wall t]\nshape = polyline thickness -5 mm: 0, 28 mm; 0, 0; 15 "
                                "mm, 0; 15 mm + L, 10 mm; w, 10 mm; "
                                "w, 28 mm\n[numerics]\nlattice_angle = 0\n";
    static const char *const angles[] = {"a=15 deg", "a=20 deg", "a=30 deg", "a=45 deg",
                                         "a=60 deg"};
    static const double value[] = {15, 20, 30, 45, 60};
    for (size_t k = 0; k < COUNT_OF(angles); k++) {
        must_read(slope, angles[k]);
        const double L = 10 / tan(value[k] * pi / 180), area = 20 * 60 - 10 * (45 - 0.5 * L);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1, area, (double)scene.points[KIND_FLUID].n, angles[k]);
    }
    must_read(slope, "scheme=paper");
    TEST_ASSERT_TRUE(scene.points[KIND_FLUID].n < 834); /* of 836.6 */
}

/* A slope along the diagonal of the lattice: no water moves up it into the air, whatever dp is. */
static void test_settled_water_keeps_below_its_surface(void)
{
    static const double spacing[] = {4e-3, 5e-3, 7.5e-3, 10e-3, 15e-3, 20e-3, 30e-3};
    for (size_t k = 0; k < COUNT_OF(spacing); k++) {
        char text[400];
        snprintf(text, sizeof text,
                 "dp = %g\nend_time = 1\ngravity = 0, -9.81\n[fluid water]\nsound_speed = 40\n"
                 "shape = polygon 0, 0; 0.6, 0; 0.9, 0.3; 0, 0.3\nsurface = 0.3\n[wall tank]\n"
                 "shape = polyline thickness -0.06: 0, 0.4; 0, 0; 0.6, 0; 1, 0.4\n",
                 spacing[k]);
        must_read(text, NULL);
        const struct scene_points *const w = &scene.points[KIND_FLUID];
        for (int64_t i = 0; i < w->n; i++) TEST_ASSERT_TRUE(w->y[i] < 0.3);
        TEST_ASSERT_DOUBLE_WITHIN(1, 0.225 / square(spacing[k]), (double)w->n);
        scene_free(&scene);
    }
}

/* A uniform pressure pushes no particle of the water around a cylinder: the kernel's gradient sums
 * to nearly nothing, also beyond those that were moved. No two particles are near to each other. */
static void test_fluid_around_a_cylinder_is_settled(void)
{
    must_read("scheme = standard\ndp = 1 mm\nend_time = 1\n[fluid w]\nsound_speed = 20\n"
              "shape = box 0, 0, 40 mm, 40 mm\nminus = circle 20.3 mm, 19.6 mm, 6.4 mm\n"
              "[wall c]\nshape = circle 20.3 mm, 19.6 mm, 6.4 mm\n",
              NULL);
    const double dp = scene.top.dp, h = scene.h;
    const struct scene_points *const p = &scene.points[KIND_FLUID];
    TEST_ASSERT_DOUBLE_WITHIN(1, 1600 - pi * square(6.4), (double)p->n);
    int64_t beside = 0;
    for (int64_t i = 0; i < p->n; i++) {
        double sum[2] = {0, 0};
        const double away = hypot(p->x[i] - 0.0203, p->y[i] - 0.0196) / dp;
        TEST_ASSERT_TRUE(away > 6.4);
        if (away > 6.4 + 3) continue;
        for (int kind = 0; kind < KIND_COUNT; kind++)
            for (int64_t j = 0; j < scene.points[kind].n; j++) {
                const double dx = p->x[i] - scene.points[kind].x[j],
                             dy = p->y[i] - scene.points[kind].y[j], r = hypot(dx, dy);
                if (r == 0 || r >= 2 * h) continue;
                TEST_ASSERT_TRUE(r > 0.8 * dp);
                const double slope = 35 / (4 * pi * pow(h, 4)) * pow(1 - 0.5 * r / h, 3);
                sum[0] += square(dp) * slope * dx;
                sum[1] += square(dp) * slope * dy;
            }
        TEST_ASSERT_TRUE(h * hypot(sum[0], sum[1]) < 1e-3);
        beside++;
    }
    TEST_ASSERT_TRUE(beside > 100);
}

/* Of a line of many short parts most are not tested: the result is that of a test of all. The ends
 * of an arc within a wall continue there, further than its parts are long. */
static void test_connections_across_an_arc(void)
{
    must_read("dp = 10 mm\nend_time = 1\ngravity = 0, -9.81\n[fluid w]\nsound_speed = 20\n"
              "shape = box 0, 0, 0.2, 0.1\nsurface = 0.1\n[wall tank]\n"
              "shape = polyline thickness -0.05: 0, 0.2; 0, 0; 0.2, 0; 0.2, 0.2\n[wall a]\n"
              "shape = arc: 0.1, 0, 0.06, 0, 180 deg\n",
              NULL);
    const struct scene_thin_line *const line = &scene.thin[0];
    uint64_t state = 1;
    int crossed = 0;
    TEST_ASSERT_TRUE(line->n > 100 && line->extend[0] > 0.01);
    for (int n = 0; n < 100000; n++) {
        const double from[2] = {0.1 + 0.1 * noise(&state), 0.05 + 0.1 * noise(&state)},
                     offset[2] = {0.03 * noise(&state), 0.03 * noise(&state)};
        bool odd = false;
        for (int k = 0; k + 1 < line->n; k++) {
            const double *const a = line->seen[k], *const b = line->seen[k + 1];
            odd ^= crosses_piece(offset, (const double[]){a[0] - from[0], a[1] - from[1]},
                                 (const double[]){b[0] - from[0], b[1] - from[1]});
        }
        const double to[2] = {from[0] + offset[0], from[1] + offset[1]};
        TEST_ASSERT_EQUAL_INT(odd, geometry_between(&scene, from, to));
        crossed += odd;
    }
    TEST_ASSERT_TRUE(crossed > 1000);
}

static void test_a_periodic_domain_is_not_turned(void)
{
    static const char text[] =
        "dp = 1 mm\nend_time = 1\n[fluid w]\nsound_speed = 20\nshape = box 0, 0, 10 mm, 10 mm\n"
        "[numerics]\nlattice_angle = 20 deg\n"
        "[domain]\nperiodic = x\nlower = 0, -1\nupper = 10 mm, 1\n";
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, read(text, NULL));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, "lattice_angle"), diag.text);
    must_read(text, "numerics.lattice_angle=0");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_turned_scene_is_the_scene_turned);
    RUN_TEST(test_lattice_angle_overrides);
    RUN_TEST(test_shapes_without_a_main_direction);
    RUN_TEST(test_cells_fit_a_bar);
    RUN_TEST(test_cells_fit_one_side);
    RUN_TEST(test_cells_ignore_a_joint);
    RUN_TEST(test_a_shape_within_another);
    RUN_TEST(test_area_of_a_round_end);
    RUN_TEST(test_each_body_has_its_lattice);
    RUN_TEST(test_area_of_an_arch);
    RUN_TEST(test_cells_begin_at_a_clamp);
    RUN_TEST(test_cells_begin_at_a_curved_clamp);
    RUN_TEST(test_area_is_told);
    RUN_TEST(test_layers_follow_faces);
    RUN_TEST(test_layers_are_even);
    RUN_TEST(test_space_is_filled);
    RUN_TEST(test_fluid_beside_slopes_has_its_area);
    RUN_TEST(test_settled_water_keeps_below_its_surface);
    RUN_TEST(test_fluid_around_a_cylinder_is_settled);
    RUN_TEST(test_connections_across_an_arc);
    RUN_TEST(test_a_periodic_domain_is_not_turned);
    return UNITY_END();
}
