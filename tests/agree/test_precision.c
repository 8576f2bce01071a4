/* SPDX-License-Identifier: MIT
 * Mixed against double precision: what float lanes cost, and that it does not grow with the
 * distance from the origin. */
#include "rig.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>

static const char scene[] =
    "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"
    "[constants]\nX = 0 m\n"
    "[fluid water]\nshape = box X, 0, X + 0.2, 0.2\nsound_speed = 28\nsurface = 0.2\n"
    "artificial_viscosity = 0.05\ndensity_diffusion = 0.1\n"
    "[wall tank]\nshape = box X - 0.03, -0.03, X + 0.6, 0\nshape = box X - 0.03, 0, X, 0.25\n"
    "[domain]\nlower = X - 0.1, -0.1\nupper = X + 0.8, 0.5\n";

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

enum { MOST = 400 };
struct picture {
    double x[MOST], y[MOST], ax[MOST], ay[MOST];
};

/* Fields by id, since the fluid is sorted. */
static void take(struct picture *q)
{
    const struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    TEST_ASSERT_EQUAL_INT64(MOST, particles->n);
    for (int64_t i = 0; i < particles->n; i++) {
        q->x[particles->id[i]] = particles->x[i];
        q->y[particles->id[i]] = particles->y[i];
        q->ax[particles->id[i]] = particles->ax[i];
        q->ay[particles->id[i]] = particles->ay[i];
    }
}

/* A dam breaks for 0.1 s in both precisions. Each step's error of some 1e-6 of the forces, rho g H/
 * (rho dp) = 200 m/s^2, would by itself have moved a particle by 1e-6 * 200 * t^2/2 = 1e-6 m, a
 * ten-thousandth of dp; neighbours that part amplify it. A hundredth of dp on the mean shows that
 * the two are the same flow; a wrong law or a wrong origin of the lanes is off by more than dp. */
static void test_dam_break_is_the_same_flow(void)
{
    static struct picture mixed, both;
    rig_open(&rig, scene, "precision=mixed", NULL);
    rig_run(&rig, 0.1);
    take(&mixed);
    rig_open(&rig, scene, "precision=double", NULL);
    rig_run(&rig, 0.1);
    take(&both);
    double sum = 0, moved = 0;
    for (int i = 0; i < MOST; i++) {
        sum += hypot(mixed.x[i] - both.x[i], mixed.y[i] - both.y[i]);
        moved = fmax(moved, mixed.x[i]);
    }
    TEST_ASSERT_TRUE(moved > 0.25);
    TEST_ASSERT_TRUE(sum > 0);
    assert_at_most(0.01 * 0.01, sum / MOST, "mean distance between the flows, m");
}

/* Lanes hold offsets from a cell's centre: a kilometre from the origin the accelerations are off by
 * the round-off of the positions themselves, 1e-13 m/h, and not by that of floats, 6e-5 m/h. The
 * start is a lattice, whose offsets round differently in other cells: 2e-6 of the sizes
 * (test_twin.c). */
static void test_far_from_the_origin(void)
{
    static struct picture near, far;
    const char *const precision[] = {"precision=mixed", "precision=double"};
    const double tolerance[] = {2e-6, 1e-9};
    for (int k = 0; k < 2; k++) {
        rig_open(&rig, scene, precision[k], NULL);
        rig_evaluate(&rig);
        take(&near);
        rig_open(&rig, scene, precision[k], "constants.X=1 km", NULL);
        rig_evaluate(&rig);
        take(&far);
        double size = 0, top = 0;
        for (int i = 0; i < MOST; i++) {
            assert_near(1e-12, near.x[i], far.x[i] - 1000, "x");
            size = fmax(size, hypot(near.ax[i], near.ay[i]));
            top = fmax(top, hypot(near.ax[i] - far.ax[i], near.ay[i] - far.ay[i]));
        }
        assert_at_most(tolerance[k], top / size, precision[k]);
    }
}

/* Small pressure survives in mixed precision: rho itself is never held in a float. A depth of one
 * particle under c0 = 1000 m/s has dens = 5e-8, below the last digit of a float's 1. */
static void test_tiny_densities_keep_their_digits(void)
{
    static struct picture mixed, both;
    rig_open(&rig, scene, "precision=mixed", "water.sound_speed=1000", NULL);
    rig_evaluate(&rig);
    take(&mixed);
    rig_open(&rig, scene, "precision=double", "water.sound_speed=1000", NULL);
    rig_evaluate(&rig);
    take(&both);
    double size = 0, top = 0;
    for (int i = 0; i < MOST; i++) {
        size = fmax(size, hypot(both.ax[i], both.ay[i]));
        top = fmax(top, hypot(mixed.ax[i] - both.ax[i], mixed.ay[i] - both.ay[i]));
    }
    assert_at_most(2e-6, top / size, "acceleration");
}

/* Two drops approach each other from cells that do not touch, over others between them. Lanes that
 * fill up a pack with candidates of the next cell must not show them to the bound of Eq. 28b: it
 * would depend on how many lanes there are, 16 floats and 8 doubles here. */
static void test_the_bound_does_not_depend_on_lanes(void)
{
    static const char drops[] =
        "dp = 0.1\nend_time = 10\n[domain]\nlower = 0, 0\nupper = 1.2, 1.2\n"
        "[fluid a]\nshape = box 0.2, 0, 0.3, 0.1\nsound_speed = 3\nvelocity = 2.9, 0\n"
        "[fluid b]\nshape = box 0.6, 0, 0.7, 0.1\nsound_speed = 3\nvelocity = -2.9, 0\n"
        "[fluid c]\nshape = box 0.3, 0.2, 0.6, 0.4\nshape = box 0.4, 0.4, 0.5, 0.5\n"
        "sound_speed = 3\n";
    double rate[2];
    for (int k = 0; k < 2; k++) {
        rig_open(&rig, drops, k ? "precision=double" : "precision=mixed", NULL);
        rig_evaluate(&rig);
        rate[k] = rig.sim.fluid.extremes.approach;
    }
    TEST_ASSERT_TRUE(rate[1] > 0);
    assert_near(1e-6 * rate[1], rate[1], rate[0], "rate of approach");
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_dam_break_is_the_same_flow);
    RUN_TEST(test_far_from_the_origin);
    RUN_TEST(test_tiny_densities_keep_their_digits);
    RUN_TEST(test_the_bound_does_not_depend_on_lanes);
    return UNITY_END();
}
