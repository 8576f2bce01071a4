/* SPDX-License-Identifier: MIT
 * Solids push rigid bodies back (T-102a): momentum, energy, rest, friction and light bodies. */
#include "rig.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>

static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                          "integrator=leapfrog"};
static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

#define FREE "dp = 1 cm\nend_time = 1\n[domain]\nlower = -20, -20\nupper = 20, 20\n"
#define MATERIAL "density = 1000\nyoung = 1e6\npoisson = 0.3\n"
#define BLOCK MATERIAL "artificial_viscosity = 0\n"

static const struct rigid_state *state(void) { return rig.sim.rigid.state; }

static double angular_momentum(void)
{
    const struct particles *const p = &rig.sim.particles[KIND_SOLID];
    double sum = 0;
    for (int64_t i = 0; i < p->n; i++)
        sum += rig.sim.solid.body[p->body[i]].mass * (p->x[i] * p->vy[i] - p->y[i] * p->vx[i]);
    for (int k = 0; k < rig.sim.rigid.n; k++) {
        const struct rigid_mass *const m = &rig.scene.rigid_mass[k];
        const struct rigid_state *const s = &state()[k];
        const double x = m->centre[0] + s->x[0], y = m->centre[1] + s->x[1];
        sum += m->inertia * s->v[2] + m->mass * (x * s->v[1] - y * s->v[0]);
    }
    return sum;
}

/* A block hits a box off its centre: the box moves and turns, and momentum stays. Half of
 * the block's width meets the box. */
static void test_a_block_hits_a_free_box(void)
{
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig,
                 FREE "[solid s]\nshape = box 0, 0, 0.06, 0.06\nvelocity = 1, 0\n" MATERIAL
                      "[rigid r]\nshape = box 0.1, 0.03, 0.16, 0.09\nmass = 2\n"
                      "[contact c]\nbetween = s, r\ndamping = 0\n",
                 integrators[k], NULL);
        const double turning = angular_momentum();
        rig_run(&rig, 0.1);
        const struct ledger row = simulation_ledger(&rig.sim);
        assert_near(3.6e-10, 3.6, row.momentum_x, "momentum, x");
        assert_near(3.6e-10, 0, row.momentum_y, "momentum, y");
        assert_near(1e-4 * 3.6 * 0.06, turning, angular_momentum(), "angular momentum");
        /* The solid's viscosity damps what the impact shakes. */
        assert_near(0.05 * 1.8, 0.05 * 1.8, row.dissipated, "dissipated");
        TEST_ASSERT_TRUE(state()->v[0] > 0.5);
        TEST_ASSERT_TRUE(fabs(state()->v[2]) > 1);
    }
}

/* A block falls on a box that stands on the bed, and rests there. */
static void test_a_block_rests_on_a_box(void)
{
    rig_open(&rig,
             "gravity = 0, -9.81\n" FREE "[wall bed]\nshape = box -0.5, -0.04, 0.5, 0\n"
             "[rigid r]\nshape = box -0.06, 0, 0.06, 0.06\nmass = 0.5\n"
             "[solid s]\nshape = box -0.03, 0.07, 0.03, 0.13\n" BLOCK,
             NULL);
    rig_run(&rig, 1);
    assert_near(1e-6, 0, state()->x[1], "y of the box");
    assert_near(1e-4, 0, state()->v[1], "vy of the box");
    TEST_ASSERT_EQUAL_INT(0, rig.diag.code);
}

/* A box of a thousandth of the block's mass leaves it at about twice its speed. */
static void test_a_light_box_is_pushed_away(void)
{
    rig_open(&rig,
             FREE "[solid s]\nshape = box 0, 0, 0.06, 0.06\nvelocity = 1, 0\n" BLOCK
                  "[rigid r]\nshape = box 0.1, 0, 0.16, 0.06\nmass = 0.0036\n"
                  "[contact c]\nbetween = s, r\ndamping = 0\n",
             NULL);
    rig_run(&rig, 0.1);
    const struct ledger row = simulation_ledger(&rig.sim);
    assert_near(3.6e-10, 3.6, row.momentum_x, "momentum, x");
    assert_near(1e-3, 0, state()->v[2], "spin");
    assert_near(0.2, 2, state()->v[0], "velocity");
    assert_near(2e-4 * 1.8, 0, row.dissipated, "dissipated");
}

/* Friction acts on both: a block that slides along a free bar drags it, and keeps to it. */
static void test_friction_drags_a_bar(void)
{
    rig_open(&rig,
             "gravity = 0, -9.81\n" FREE "[wall bed]\nshape = box -0.5, -0.04, 1, 0\n"
             "[rigid r]\nshape = box 0, 0, 0.4, 0.04\nmass = 3.6\n"
             "[solid s]\nshape = box 0, 0.04, 0.06, 0.1\nvelocity = 0.5, 0\n" BLOCK
             "[contact c]\nbetween = s, r\nfriction = 0.5\n",
             NULL);
    rig_run(&rig, 0.2);
    assert_near(3.6 * 0.5e-8, 3.6 * 0.5, simulation_ledger(&rig.sim).momentum_x, "momentum, x");
    assert_near(0.01, 0.25, state()->v[0], "velocity of the bar");
    assert_near(1e-3, 0, state()->v[2], "spin of the bar");
}

/* A block falls on a floating box, 22 times lighter than it: both float as deep as Archimedes says,
 * within a spacing while they still heave. */
static void test_a_light_float_carries_a_block(void)
{
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig,
                 "dp = 2 cm\nend_time = 2\nscheme = standard\ngravity = 0, -9.81\n"
                 "[fluid w]\nshape = box 0, 0, 0.8, 0.4\nminus = box 0.2, 0.2, 0.6, 0.6\n"
                 "surface = 0.4\nsound_speed = 30\n"
                 "[wall tank]\nshape = polyline: 0, 0.9; 0, 0; 0.8, 0; 0.8, 0.9\n"
                 "[rigid r]\nshape = box 0.2, 0.2, 0.6, 0.6\ndensity = 20\n"
                 "[solid s]\nshape = box 0.3, 0.62, 0.5, 0.82\ndensity = 1800\nyoung = 1e6\n"
                 "poisson = 0.3\n",
                 integrators[k], NULL);
        rig_run(&rig, 0.8);
        assert_near(0.02, 0.2 - 75.2 / 1000 / 0.4, state()->x[1], integrators[k]);
        assert_near(0.02, 0, state()->x[2], "roll");
    }
}

/* A block falls on a raft, which begins too deep. Most is gained with leapfrog: 0.25 %. */
static void test_a_raft_gains_no_energy_from_its_load(void)
{
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig,
                 "dp = 2 cm\nend_time = 2\nscheme = standard\ngravity = 0, -9.81\n"
                 "[fluid w]\nshape = box 0, 0, 1.6, 0.5\nminus = box 0.5, 0.4, 1.1, 0.6\n"
                 "surface = 0.5\nsound_speed = 25\n"
                 "[wall tank]\nshape = polyline: 0, 0.9; 0, 0; 1.6, 0; 1.6, 0.9\n"
                 "[rigid raft]\nshape = box 0.5, 0.4, 1.1, 0.52\ndensity = 300\n"
                 "[solid s]\nshape = box 0.7, 0.54, 0.9, 0.64\ndensity = 900\nyoung = 1e6\n"
                 "poisson = 0.3\n",
                 integrators[k], NULL);
        energy_begin(&rig.sim);
        rig_run(&rig, 0.3);
        assert_at_most(0.005, rig.sim.state.gain_share, integrators[k]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_block_hits_a_free_box);
    RUN_TEST(test_a_block_rests_on_a_box);
    RUN_TEST(test_a_light_box_is_pushed_away);
    RUN_TEST(test_friction_drags_a_bar);
    RUN_TEST(test_a_light_float_carries_a_block);
    RUN_TEST(test_a_raft_gains_no_energy_from_its_load);
    return UNITY_END();
}
