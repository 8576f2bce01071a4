/* SPDX-License-Identifier: MIT
 * Beams of any thickness in fluid: what they displace, how water lifts them, rest (T-110f). */
#include "output/probes.h"
#include "rig.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

#define WATER                                                                  \
    "scheme = standard\ndp = 20 mm\nend_time = 9\ngravity = 0, -9.81\n"        \
    "[fluid w]\nshape = box 0, 0, 0.8, 0.4\nsound_speed = 25\nsurface = 0.4\n" \
    "[wall tank]\nshape = polyline: 0, 0.6; 0, 0; 0.8, 0; 0.8, 0.6\n"

/* A beam 0.4 m long is held at the height y. Its faces fit the lattice or, below a spacing, its
 * line does. */
static void open_held(double half, double y)
{
    char text[1000];
    snprintf(text, sizeof text,
             WATER "[beam b]\nshape = polyline: 0.2, %g; 0.4, %g; 0.6, %g\nclamp = 0.4, %g\n"
                   "thickness = %g\nyoung = 1e9\ndensity = 1000\ngravity = off\n",
             y, y, y, y, 2 * half);
    rig_open(&rig, text, NULL);
}

static double lift(void)
{
    const struct particles *const walls = &rig.sim.particles[KIND_WALL];
    double sum = 0;
    simulation_wall_forces(&rig.sim);
    for (int64_t i = 0; i < walls->n; i++) sum += walls->body[i] >= 1 ? walls->fy[i] : 0;
    return sum;
}

static double mean_square_speed(void)
{
    const struct particles *const fluid = &rig.sim.particles[KIND_FLUID];
    double sum = 0;
    for (int64_t i = 0; i < fluid->n; i++) sum += square(fluid->vx[i]) + square(fluid->vy[i]);
    return sum / (double)fluid->n;
}

/* The lift is the weight of the water displaced, within 2 % or the weight of a particle. Fluid
 * beside faces between the lines of the lattice begins out of order. */
static void test_lift_and_rest(void)
{
    static const struct {
        double half, y, speed;
    } scenes[] = {{0.5e-3, 0.2, 0.01},
                  {5e-3, 0.2, 0.02},
                  {10e-3, 0.21, 0.01},
                  {20e-3, 0.2, 0.01},
                  {40e-3, 0.2, 0.01}};
    const double particle = 9.81 * 1000 * square(0.02);
    for (size_t k = 0; k < COUNT_OF(scenes); k++) {
        char what[40];
        double start, mean = 0;
        const double half = scenes[k].half, wanted = 9810 * 2 * half * 0.4;
        snprintf(what, sizeof what, "thickness %g m", 2 * half);
        open_held(half, scenes[k].y);
        start = lift();
        rig_run(&rig, 0.2);
        for (int n = 1; n <= 20; n++) {
            rig_run(&rig, 0.2 + 0.01 * n);
            mean += lift() / 20;
        }
        if (half > 5e-3) assert_near(0.02 * wanted, wanted, start, what);
        assert_near(max2(0.02 * wanted, particle), wanted, mean, what);
        assert_at_most(square(scenes[k].speed), mean_square_speed(), what);
    }
}

/* A beam of half the density of water floats with half of its thickness in it. */
static void test_a_float(void)
{
    rig_open(&rig,
             WATER "[beam b]\nshape = polyline: 0.2, 0.4; 0.6, 0.4\nthickness = 80 mm\n"
                   "young = 1e8\ndensity = 500\n",
             NULL);
    const struct beam_state *const middle = &rig.sim.beams.state[10];
    for (int n = 1; n <= 20; n++) {
        rig_run(&rig, 0.05 * n);
        assert_at_most(0.15 * 0.02, fabs(middle->x[1]), "heave");
        assert_at_most(0.002, fabs(middle->x[2]), "turn");
    }
    assert_at_most(square(0.01), mean_square_speed(), "speed^2");
}

/* The fluid has its area less that of the beam, to a particle, at any place of its faces. */
static void test_what_is_displaced(void)
{
    static const struct {
        const char *line;
        double length, thickness;
    } scenes[] = {{"0.2, 0.2; 0.6, 0.2", 0.4, 0.003},
                  {"0.2, 0.207; 0.6, 0.207", 0.4, 0.02},
                  {"0.35, 0.08; 0.35, 0.32", 0.24, 0.05},
                  {"0.2, 0.1; 0.5, 0.3", 0.36056, 0.03}};
    for (size_t k = 0; k < COUNT_OF(scenes); k++) {
        char text[1000];
        snprintf(text, sizeof text,
                 WATER "[beam b]\nshape = polyline: %s\nthickness = %g\nyoung = 1e9\n"
                       "density = 1000\n",
                 scenes[k].line, scenes[k].thickness);
        rig_open(&rig, text, NULL);
        assert_near(1, (0.8 * 0.4 - scenes[k].length * scenes[k].thickness) / square(0.02),
                    (double)rig.sim.particles[KIND_FLUID].n, scenes[k].line);
    }
}

/* No fluid begins within the thickness, beside a corner of a closed line either. */
static void test_corners_of_a_closed_line(void)
{
    static const double corner[][2] = {{0.3, 0.1}, {0.5, 0.1}, {0.5, 0.3}, {0.3, 0.3}};
    rig_open(&rig,
             WATER "[beam b]\nshape = polyline: 0.3, 0.1; 0.5, 0.1; 0.5, 0.3; 0.3, 0.3; 0.3, 0.1\n"
                   "thickness = 40 mm\nyoung = 1e9\ndensity = 1000\n",
             NULL);
    const struct particles *const fluid = &rig.sim.particles[KIND_FLUID];
    for (size_t k = 0; k < COUNT_OF(corner); k++)
        for (int64_t i = 0; i < fluid->n; i++)
            TEST_ASSERT_TRUE(hypot(fluid->x[i] - corner[k][0], fluid->y[i] - corner[k][1]) > 0.02);
}

/* Water round a curve and under a slanted beam begins half a spacing from its faces or further, and
 * with the force of water at rest. The first hose has corners at its stations. */
static void test_start_beside_curved_and_slanted_faces(void)
{
    static const struct {
        const char *minus, *line;
        double radius, thickness, share; /* share: error of the lift */
    } scenes[] = {
        {"minus = circle 0.4, 0.4, 0.205\n", "arc: 0.4, 0.4, 0.2, 0, 360 deg", 0.2, 0.01, 0.02},
        {"minus = circle 0.4, 0.4, 0.21\n", "arc: 0.4, 0.4, 0.2, 0, 360 deg", 0.2, 0.02, 0.02},
        {"minus = circle 0.4, 0.4, 0.22\n", "arc: 0.4, 0.4, 0.2, 0, 360 deg", 0.2, 0.04, 0.02},
        {"minus = circle 0.4, 0.4, 0.23\n", "arc: 0.4, 0.4, 0.2, 0, 360 deg", 0.2, 0.06, 0.02},
        {"", "polyline: 0.2, 0.1; 0.6, 0.3", 0, 0.02, 0.05},
        {"", "polyline: 0.2, 0.1; 0.6, 0.3", 0, 0.04, 0.05}};
    for (size_t k = 0; k < COUNT_OF(scenes); k++) {
        char text[1000], what[80];
        const double half = 0.5 * scenes[k].thickness, r = scenes[k].radius;
        const double wanted = r > 0 ? 0.5 * PI * 9810 * square(r + half)
                                    : 9810 * scenes[k].thickness * hypot(0.4, 0.2);
        snprintf(what, sizeof what, "%s of %g m", scenes[k].line, scenes[k].thickness);
        snprintf(text, sizeof text,
                 "scheme = standard\ndp = 20 mm\nend_time = 9\ngravity = 0, -9.81\n"
                 "[fluid w]\nshape = box 0, 0, 0.8, 0.4\n%ssound_speed = 25\nsurface = 0.4\n"
                 "[wall tank]\nshape = polyline: 0, 0.6; 0, 0; 0.8, 0; 0.8, 0.6\n"
                 "[beam b]\nshape = %s\nthickness = %g\nyoung = 1e9\ndensity = 1000\n",
                 scenes[k].minus, scenes[k].line, scenes[k].thickness);
        rig_open(&rig, text, NULL);
        const struct particles *const fluid = &rig.sim.particles[KIND_FLUID];
        for (int64_t i = 0; i < fluid->n && r > 0; i++)
            TEST_ASSERT_TRUE_MESSAGE(hypot(fluid->x[i] - 0.4, fluid->y[i] - 0.4) - r > half + 0.009,
                                     what);
        assert_near(scenes[k].share * wanted, wanted, lift(), what);
    }
}

/* The level beside a plate of rows of any depth that stands out of the water. */
static void test_level_beside_faces(void)
{
    static const double thickness[] = {0.001, 0.01, 0.02};
    for (size_t k = 0; k < COUNT_OF(thickness); k++) {
        char text[1000];
        snprintf(text, sizeof text,
                 WATER "[beam b]\nshape = polyline: 0.4, 0; 0.4, 0.55\nclamp = 0.4, 0\n"
                       "thickness = %g\nyoung = 1e11\ndensity = 1000\ngravity = off\n",
                 thickness[k]);
        rig_open(&rig, text, NULL);
        simulation_refresh(&rig.sim);
        assert_near(0.2 * 0.02, 0.4, fluid_level(&rig.sim, 0.415, 0.3), "level");
    }
}

/* Water at rest on both sides of a plate keeps its level, wherever the line goes on into the bed or
 * a side wall: it shares their particles and cells of fluid and air (T-110g). */
static void test_rest_beside_a_line_into_a_wall(void)
{
    static const struct {
        const char *line, *end[2];
        double thickness;
    } scenes[] = {{"0.405, 0; 0.405, 0.55", {"0.405, 0", "0.405, 0.55"}, 0.0005},
                  {"0.41, 0; 0.41, 0.55", {"0.41, 0", "0.41, 0.55"}, 0.0005},
                  {"0.41, 0; 0.41, 0.55", {"0.41, 0", "0.41, 0.55"}, 0.01},
                  {"0.41, 0; 0.41, 0.55", {"0.41, 0", "0.41, 0.55"}, 0.04},
                  {"0, 0.21; 0.4, 0.21", {"0, 0.21", "0.4, 0.21"}, 0.04}};
    for (size_t k = 0; k < COUNT_OF(scenes); k++) {
        char text[1000];
        snprintf(text, sizeof text,
                 WATER "[beam b]\nshape = polyline: %s\nclamp = %s\nclamp = %s\n"
                       "thickness = %g\nyoung = 1e12\ndensity = 1000\ngravity = off\n",
                 scenes[k].line, scenes[k].end[0], scenes[k].end[1], scenes[k].thickness);
        rig_open(&rig, text, NULL);
        const double start = simulation_ledger(&rig.sim).potential;
        rig_run(&rig, 0.6);
        assert_near(5e-4 * start, start, simulation_ledger(&rig.sim).potential, scenes[k].line);
        assert_at_most(square(0.02), mean_square_speed(), scenes[k].line);
    }
}

/* Fluid behind a wall as thin as two spacings is no part of the wall that a line goes on into. */
static void test_a_line_cuts_nothing_but_its_wall(void)
{
    rig_open(&rig,
             "scheme = standard\ndp = 20 mm\nend_time = 1\ngravity = 0, -9.81\n"
             "[fluid w]\nshape = box 0, 0, 0.4, 0.4\n"
             "shape = box 0.44, 0, 0.8, 0.4\nsound_speed = 25\nsurface = 0.4\n"
             "[wall tank]\nshape = polyline: 0, 0.6; 0, 0; 0.8, 0; 0.8, 0.6\n"
             "[wall mid]\nshape = box 0.4, 0, 0.44, 0.6\n"
             "[beam b]\nshape = polyline: 0, 0.21; 0.4, 0.21\nclamp = 0, 0.21\nclamp = 0.4, 0.21\n"
             "thickness = 0.5 mm\nyoung = 1e12\ndensity = 1000\n",
             NULL);
    TEST_ASSERT_EQUAL_INT64(20 * 20 + 18 * 20, rig.sim.particles[KIND_FLUID].n);
}

/* Two beams that meet in a T or an L push the water from their common part once. */
static void test_lift_of_joined_beams(void)
{
    static const struct {
        const char *line, *held, *foot, *other, *joint;
        double area;
    } scenes[] = {{"0.2, 0.28; 0.4, 0.28; 0.6, 0.28", "0.6, 0.28", "0.4, 0.28; 0.4, 0.1",
                   "0.4, 0.1", "0.4, 0.28", 0.4 * 0.08 + 0.14 * 0.08},
                  {"0.2, 0.28; 0.5, 0.28", "0.2, 0.28", "0.5, 0.28; 0.5, 0.1", "0.5, 0.1",
                   "0.5, 0.28", 0.3 * 0.08 + 0.18 * 0.08 - 0.04 * 0.04}};
    for (size_t k = 0; k < COUNT_OF(scenes); k++) {
        char text[1000];
        snprintf(text, sizeof text,
                 WATER "[beam a]\nshape = polyline: %s\nclamp = %s\nthickness = 80 mm\n"
                       "young = 1e12\ndensity = 1000\n"
                       "[beam b]\nshape = polyline: %s\nclamp = %s\nclamp = %s, a\n"
                       "thickness = 80 mm\nyoung = 1e12\ndensity = 1000\n",
                 scenes[k].line, scenes[k].held, scenes[k].foot, scenes[k].other, scenes[k].joint);
        rig_open(&rig, text, NULL);
        const double wanted = 9810 * scenes[k].area;
        assert_near(0.01 * wanted, wanted, lift(), scenes[k].foot);
    }
}

/* How far the outermost dummies of a beam 25 dp thick move when it turns. */
static void test_displacement_of_dummies(void)
{
    rig_open(&rig,
             WATER "[beam b]\nshape = polyline: 2, 0; 3, 0\nthickness = 0.5\nyoung = 1e9\n"
                   "density = 1000\n",
             NULL);
    const struct particles *const walls = &rig.sim.particles[KIND_WALL];
    double before[4000][2], largest = 0;
    TEST_ASSERT_TRUE(walls->n <= 4000);
    for (int64_t i = 0; i < walls->n; i++) before[i][0] = walls->x[i], before[i][1] = walls->y[i];
    for (int k = 0; k < rig.sim.beams.n_nodes; k++) rig.sim.beams.state[k].x[2] += 0.01;
    const double allowed = beams_place(&rig.sim.beams, 0);
    for (int64_t i = 0; i < walls->n; i++)
        largest = max2(largest, hypot(walls->x[i] - before[i][0], walls->y[i] - before[i][1]));
    assert_at_most(allowed, largest, "displacement of a dummy");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_lift_and_rest);
    RUN_TEST(test_a_float);
    RUN_TEST(test_what_is_displaced);
    RUN_TEST(test_corners_of_a_closed_line);
    RUN_TEST(test_start_beside_curved_and_slanted_faces);
    RUN_TEST(test_level_beside_faces);
    RUN_TEST(test_rest_beside_a_line_into_a_wall);
    RUN_TEST(test_a_line_cuts_nothing_but_its_wall);
    RUN_TEST(test_lift_of_joined_beams);
    RUN_TEST(test_displacement_of_dummies);
    return UNITY_END();
}
