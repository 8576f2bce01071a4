/* SPDX-License-Identifier: MIT
 * Mass damping against exact decays (T-77); and a start from static equilibrium (T-78): the
 * elongation of a hanging bar by hand, and no motion afterwards. */
#include "rig.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define REST "[numerics]\nstart = equilibrium\n"
#define HEAD "dp = 1 cm\nend_time = 1\nprecision = double\n"
#define BODY "density = 1000\nyoung = 1e6\npoisson = 0\nlaw = svk\n"
static const char loose[] =
    HEAD "[solid b]\nshape = box 0, 0, 0.06, 0.04\nmass_damping = 20\n" BODY;
static const char hanging[] =
    HEAD "gravity = 0, -9.81\n" REST "[solid b]\nshape = box 0, 0, 0.04, 0.4\n"
         "clamp = box 0, 0.38, 0.04, 0.4\nartificial_viscosity = 0\n" BODY;
static struct rig rig;
static struct particles *p;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

/* v' = -beta v without any other force. */
static void test_motion_dies_away(void)
{
    const char *const integrators[] = {"integrator=leapfrog", "integrator=symplectic"};
    for (int k = 0; k < 2; k++) {
        RIG_OPEN_SOLID(loose, integrators[k]);
        for (int64_t i = 0; i < p->n; i++) p->vx[i] = 2;
        rig_run(&rig, 0.1);
        for (int64_t i = 0; i < p->n; i++) {
            assert_near(2e-3, 2 * exp(-20 * 0.1), p->vx[i], "vx");
            assert_near(1e-9, 0, p->vy[i], "vy");
        }
    }
}

/* One evaluation by hand: -20/s times the velocity of each particle, whatever its neighbours do. */
static void test_force_by_hand(void)
{
    RIG_OPEN_SOLID(loose, "b.artificial_viscosity=0");
    for (int64_t i = 0; i < p->n; i++) p->vx[i] = 3 + p->X[i], p->vy[i] = -0.5;
    solid_stress(&rig.sim.solid, p);
    solid_forces(&rig.sim.solid, p);
    for (int64_t i = 0; i < p->n; i++) {
        assert_near(1e-9, -20 * (3 + p->X[i]), p->sx[i], "sx");
        assert_near(1e-9, 10, p->sy[i], "sy");
    }
}

/* Damping that bounds the step: at that step a velocity dies out. */
static void test_step_holds_for_it(void)
{
    RIG_OPEN_SOLID(loose, "b.mass_damping=1e6");
    TEST_ASSERT_TRUE(rig.sim.dt_solid * 1e6 < 2);
    for (int64_t i = 0; i < p->n; i++) p->vx[i] = 1;
    rig_steps(&rig, 4, 1);
    for (int64_t i = 0; i < p->n; i++) assert_at_most(1e-3, fabs(p->vx[i]), "vx");
}

static double end_of_bar(void)
{
    double sum = 0;
    for (int64_t i = 0; i < p->n; i++) sum += p->X[i] < 0.01 && p->Y[i] < 0.01 ? p->uy[i] : 0;
    return sum;
}

/* The particle at Y = 5 mm sinks by rho g (L^2 - Y^2)/(2 E) below the clamp at 0.38 m, whose
 * particles' last row ends half a spacing further down: L = 0.38 m to 0.385 m. */
static void test_hanging_bar(void)
{
    RIG_OPEN_SOLID(hanging, NULL);
    const double found = end_of_bar();
    const double exact = -1000 * 9.81 * (0.38 * 0.38 - 0.005 * 0.005) / (2 * 1e6);
    assert_near(0.02 * -exact, exact, found, "elongation");
    double lowest = found, highest = found;
    for (int k = 1; k <= 40; k++) { /* a period of 4 L/c = 0.049 s */
        rig_run(&rig, 0.05 * k / 40);
        lowest = fmin(lowest, end_of_bar());
        highest = fmax(highest, end_of_bar());
    }
    assert_at_most(0.002 * -exact, highest - lowest, "motion after rest was found");
    const struct ledger end = simulation_ledger(&rig.sim);
    assert_at_most(1e-3 * end.elastic, fabs(end.dissipated), "energy since the start");
}

/* Loads are as at t = 0, and moving clamps begin with their velocity. */
static void test_forces_are_those_at_the_start(void)
{
    RIG_OPEN_SOLID(HEAD REST "[solid b]\nshape = box 0, 0, 0.2, 0.04\nvelocity = 1, 0\n"
                             "clamp = box 0, 0, 0.02, 0.04\nclamp_motion = m\n" BODY
                             "[load l]\nbody = b\nforce = 0, 5\nshape = box 0.19, 0, 0.2, 0.04\n"
                             "history = sqrt(t)\n[motion m]\nx = t\n",
                   NULL);
    for (int64_t i = 0; i < p->n; i++) TEST_ASSERT_TRUE(p->ux[i] == 0 && p->uy[i] == 0);
    for (int64_t i = 0; i < p->n; i++) TEST_ASSERT_TRUE(p->vx[i] == (p->X[i] < 0.02 ? 1 : 0));
}

/* The bar stays where it was found, also in the scheme with velocities half a step behind. */
static void test_rest_lasts(void)
{
    RIG_OPEN_SOLID(hanging, "integrator=verlet");
    const double found = end_of_bar();
    rig_run(&rig, 0.05);
    assert_near(2e-5, found, end_of_bar(), "a period later");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_motion_dies_away);
    RUN_TEST(test_force_by_hand);
    RUN_TEST(test_step_holds_for_it);
    RUN_TEST(test_hanging_bar);
    RUN_TEST(test_forces_are_those_at_the_start);
    RUN_TEST(test_rest_lasts);
    return UNITY_END();
}
