/* SPDX-License-Identifier: MIT
 * A solid finer than the fluid: sampling, its forces, the fluid's force on it, momentum. */
#include "rig.h"
#include "time/energy.h"
#include "unity.h"
#include "geometry/scene_points.h"

#include <math.h>
#include <string.h>

static struct rig rig;
static struct particles *p;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

static const char *const spacings[] = {"floor.dp=10 mm", "floor.dp=5 mm", "floor.dp=10 mm/3",
                                       "floor.dp=2.5 mm"};

/* Water 0.2 m deep over a floor of 0.4 m that is a solid. */
static const char tank[] =
    "dp = 10 mm\nend_time = 1\ngravity = 0, -10\nprecision = double\n"
    "[fluid water]\nshape = box 0, 0, 0.4, 0.2\nsound_speed = 20\nsurface = 0.2\n"
    "[wall sides]\nshape = box -0.03, -0.03, 0, 0.3\nshape = box 0.4, -0.03, 0.43, 0.3\n"
    "[solid floor]\nshape = box 0, -0.03, 0.4, 0\nclamp = box 0, -0.03, 0.4, 0\n"
    "density = 2000\nyoung = 1e7\npoisson = 0.3\n";

/* Weight of the water 800 N/m; measured 769, 777 and 777 on the whole floor, 389, 394 and 394 of
 * 400 on its middle half: the fluid's own discretisation, to which the floor's spacing adds a
 * percent. */
static void test_force_of_still_water(void)
{
    double coarse[2] = {0};
    for (int k = 0; k < 3; k++) {
        RIG_OPEN_SOLID(tank, spacings[k]);
        TEST_ASSERT_EQUAL_INT64(120 * (k + 1) * (k + 1), p->n);
        rig_evaluate(&rig);
        double fx = 0, fy = 0, middle = 0;
        for (int64_t i = 0; i < p->n; i++) {
            fx += p->fx[i];
            fy += p->fy[i];
            if (fabs(p->X[i] - 0.2) < 0.1) middle += p->fy[i];
        }
        if (k == 0) coarse[0] = fy, coarse[1] = middle;
        assert_near(0.04 * 800, -800, fy, "force on the floor");
        assert_near(0.03 * 400, -400, middle, "force on its middle half");
        assert_near(0.012 * 800, coarse[0], fy, "beside that at the fluid's spacing");
        assert_near(0.012 * 400, coarse[1], middle, "beside that at the fluid's spacing");
        assert_at_most(1e-12 * 800, fabs(fx), "sideways");
    }
}

/* Fluid at rest stands half of both spacings away: nothing pushes it back, and no bit of a force
 * changes. One that is nearer than 0.8 of that is pushed. */
static void test_repulsion_begins_nearer(void)
{
    for (int k = 0; k < 3; k++) {
        double force[2], near[2];
        for (int on = 0; on < 2; on++) {
            RIG_OPEN_SOLID(tank, spacings[k],
                           on ? "water.wall_repulsion=1" : "water.wall_repulsion=0");
            rig_evaluate(&rig);
            force[on] = near[on] = 0;
            for (int64_t i = 0; i < p->n; i++) force[on] += p->fy[i];
            struct particles *const water = &rig.sim.particles[KIND_FLUID];
            for (int64_t i = 0; i < water->n; i++) water->y[i] -= 0.0025 * (1 + 1.0 / (k + 1));
            rig_evaluate(&rig);
            for (int64_t i = 0; i < p->n; i++) near[on] += p->fy[i];
        }
        TEST_ASSERT_TRUE(force[0] == force[1]);
        TEST_ASSERT_TRUE(near[1] < 2 * near[0]);
    }
}

/* The same body at another spacing: mass, stable step in proportion, and weights of its own. */
static void test_mass_and_step(void)
{
    double step[3], mass[3];
    for (int k = 0; k < 3; k++) {
        RIG_OPEN_SOLID(
            "dp = 10 mm\nend_time = 1\n[solid floor]\nshape = box 0, -0.03, 0.4, 0\n"
            "clamp = box 0, -0.03, 0.04, 0\ndensity = 2000\nyoung = 1e7\npoisson = 0.3\n",
            spacings[k]);
        step[k] = rig.sim.solid.stable_step * (k + 1);
        mass[k] = rig.sim.solid.body[0].mass * (double)p->n;
    }
    for (int k = 1; k < 3; k++) {
        assert_near(0.1, 1, step[k] / step[0], "stable step over spacing");
        assert_near(1e-9, mass[0], mass[k], "mass");
    }
}

/* A drop hits a free plate of half the spacing: both together keep their momentum to the round-off
 * of pairs in double precision. */
static void momentum_with(const char *set)
{
    RIG_OPEN_SOLID("dp = 10 mm\nend_time = 1\nprecision = double\nintegrator = symplectic\n"
                   "[fluid drop]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\nvelocity = 1, 0.1\n"
                   "[solid plate]\nshape = box 0.11, -0.05, 0.13, 0.15\ndp = 5 mm\n"
                   "density = 2000\nyoung = 1e6\npoisson = 0.3\nviscosity_form = symmetric\n"
                   "[domain]\nlower = -0.2, -0.2\nupper = 0.4, 0.3\n",
                   "plate.gravity=off", set);
    const struct ledger before = simulation_ledger(&rig.sim);
    rig_run(&rig, 0.03);
    const struct ledger after = simulation_ledger(&rig.sim);
    double plate = 0;
    for (int64_t i = 0; i < p->n; i++) plate += rig.sim.solid.body[0].mass * p->vx[i];
    TEST_ASSERT_TRUE(plate > 0.1 * before.momentum_x);
    assert_at_most(1e-12 * before.momentum_x,
                   hypot(after.momentum_x - before.momentum_x,
                         after.momentum_y - before.momentum_y),
                   "momentum");
}

static void test_momentum(void)
{
    momentum_with("drop.wall_repulsion=0");
    momentum_with("drop.wall_repulsion=1");
    momentum_with("numerics.sides=one");
}

static void test_bad_input(void)
{
    static const char *const wrong[] = {"floor.dp=11 mm", "floor.dp=2.4 mm"};
    for (int k = 0; k < 2; k++) {
        struct scene scene;
        struct diag d = {0};
        TEST_ASSERT_EQUAL_INT(ERR_INPUT, scene_load_text(&scene, tank, "t.cfg", 1, &wrong[k], &d));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(d.text,
                                            "must be between a quarter of the dp at the top"),
                                     d.text);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_force_of_still_water);
    RUN_TEST(test_repulsion_begins_nearer);
    RUN_TEST(test_mass_and_step);
    RUN_TEST(test_momentum);
    RUN_TEST(test_bad_input);
    return UNITY_END();
}
