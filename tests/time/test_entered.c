/* SPDX-License-Identifier: MIT
 * Fluid inside of walls, solids and beams: at any size, on any side of their particles, and across
 * joined sides. */
#include "time/advance.h"
#include "time/guards.h"
#include "rig.h"
#include "unity.h"

#include <stdio.h>

static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

/* Fluid on four sides of every particle of the bed's upper row, at a share of a spacing. */
static int64_t found(double dp, const char *periodic, double share)
{
    char text[512];
    snprintf(text, sizeof text,
             "dp = %g\nend_time = 1\n[domain]\nlower = 0, %g\nupper = %g, %g\nperiodic = %s\n"
             "[fluid w]\nshape = box 0, 0, %g, %g\nsound_speed = 20\n"
             "[wall bed]\nshape = box 0, %g, %g, 0\n",
             dp, -5 * dp, 40 * dp, 20 * dp, periodic, 40 * dp, 10 * dp, -5 * dp, 40 * dp);
    rig_open(&rig, text, NULL);
    struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    for (int k = 0; k < 160; k++) {
        const int side = k % 4;
        particles->x[k] = (k / 4 + 0.5 + share * (side == 0) - share * (side == 1)) * dp;
        particles->y[k] = (-0.5 + share * (side == 2) - share * (side == 3)) * dp;
    }
    rig_sort(&rig);
    int64_t first;
    return guards_count_entered(&rig.sim, &first);
}

static void test_fluid_in_a_bed(void)
{
    static const char *const periodic[] = {"none", "x"};
    for (int k = 0; k < 2; k++)
        for (double dp = 1e-3; dp < 200; dp *= 1e4) {
            TEST_ASSERT_EQUAL_INT64(160, found(dp, periodic[k], 0.3));
            TEST_ASSERT_EQUAL_INT64(0, found(dp, periodic[k], 0.4));
        }
}

/* A body that is stretched takes more room along and less across: 0.35 spacings of its own. */
static void test_fluid_in_a_stretched_body(void)
{
    static const struct {
        double x, y; /* spacings from a particle */
        int inside;
    } row[] = {{0.5, 0, 1}, {0.55, 0, 0},    {0, 0.26, 1},
               {0, 0.3, 0}, {0.35, 0.15, 1}, {0.4, 0.25, 0}};
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\n[domain]\nlower = -1, -1\nupper = 1, 1\n"
             "[fluid w]\nshape = box 0.3, 0, 0.4, 0.1\nsound_speed = 20\n"
             "[solid s]\nshape = box 0, 0, 0.1, 0.1\ndensity = 1100\nyoung = 1e6\npoisson = 0.4\n",
             NULL);
    struct particles *const particles = &rig.sim.particles[KIND_FLUID],
                            *const s = &rig.sim.particles[KIND_SOLID];
    for (int64_t i = 0; i < s->n; i++) {
        s->x[i] = 1.5 * s->X[i];
        s->y[i] = 0.8 * s->Y[i];
        s->Uxx[i] = 0.5;
        s->Uyy[i] = -0.2;
        s->Uxy[i] = s->Uyx[i] = 0;
    }
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        particles->x[0] = 1.5 * 0.055 + 0.01 * row[k].x;
        particles->y[0] = 0.8 * 0.055 + 0.01 * row[k].y;
        rig_sort(&rig);
        int64_t first;
        char what[64];
        snprintf(what, sizeof what, "(%g, %g)", row[k].x, row[k].y);
        TEST_ASSERT_EQUAL_INT64_MESSAGE(row[k].inside, guards_count_entered(&rig.sim, &first),
                                        what);
        for (int64_t i = 0; i < particles->n; i++) /* sorting has moved it */
            if (particles->x[i] < 0.2) particles->x[i] = 0.5, particles->y[i] = 0.5;
    }
}

/* Of a beam the inside is between its faces: rows of a spacing each, or of half its thickness. */
static void test_fluid_in_a_beam(void)
{
    static const struct {
        double thickness, off, along; /* dp */
        int inside;
    } row[] = {{4, 0.5, 0, 1},   {4, -1.5, 0, 1},   {4, 1.7, 0, 1},     {4, 2.1, 0, 0},
               {1, 0.25, 0, 1},  {1, -0.4, 0, 1},   {1, 0.25, 0.15, 1}, {1, 0.6, 0, 0},
               {0.1, 0.3, 0, 0}, {0.1, -0.3, 0, 0}, {4, 2.6, 0, 0}};
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        char text[500], what[64];
        snprintf(text, sizeof text,
                 "dp = 1 cm\nend_time = 1\n[fluid w]\nshape = box 0, 0, 0.2, 0.2\n"
                 "sound_speed = 20\n[beam b]\nshape = polyline: 0.05, 0.1; 0.15, 0.1\n"
                 "young = 1e9\ndensity = 1000\nthickness = %g cm\n",
                 row[k].thickness);
        rig_open(&rig, text, NULL);
        rig.sim.particles[KIND_FLUID].x[0] = 0.105 + 0.01 * row[k].along;
        rig.sim.particles[KIND_FLUID].y[0] = 0.1 + 0.01 * row[k].off;
        rig_sort(&rig);
        int64_t first;
        snprintf(what, sizeof what, "thickness %g, %g", row[k].thickness, row[k].off);
        TEST_ASSERT_EQUAL_INT64_MESSAGE(row[k].inside, guards_count_entered(&rig.sim, &first),
                                        what);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_fluid_in_a_bed);
    RUN_TEST(test_fluid_in_a_stretched_body);
    RUN_TEST(test_fluid_in_a_beam);
    return UNITY_END();
}
