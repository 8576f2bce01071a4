/* SPDX-License-Identifier: MIT
 * Steps that change in a pattern feed oscillations that each of them alone would keep. Steps up to an
 * output time are therefore equal. */
#include "rig.h"
#include "time/timestep.h"
#include "unity.h"

#include <math.h>

static const char beam[] = "dp = 5 mm\nend_time = 1\n"
                           "[solid beam]\nshape = box 0, -0.02, 0.2, 0\n"
                           "clamp = box 0, -0.02, 0.02, 0\nclamp = box 0.18, -0.02, 0.2, 0\n"
                           "density = 1200\nyoung = 1e7\npoisson = 0.4\nartificial_viscosity = 0\n";

/* A drop far above the beam makes it a coupled scene. */
static const char coupled[] = "dp = 5 mm\nend_time = 1\ngravity = 0, -9.81\n"
                              "[fluid drop]\nshape = box 0.05, 0.3, 0.06, 0.31\nsound_speed = 30\n"
                              "[solid beam]\nshape = box 0, -0.02, 0.2, 0\n"
                              "clamp = box 0, -0.02, 0.02, 0\nclamp = box 0.18, -0.02, 0.2, 0\n"
                              "density = 1200\nyoung = 1e7\npoisson = 0.4\n"
                              "artificial_viscosity = 0\n[domain]\nlower = -0.2, -0.3\n"
                              "upper = 0.4, 0.4\n";

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

static double energy(void)
{
    const struct ledger row = simulation_ledger(&rig.sim);
    double of_solid = row.elastic + row.hourglass;
    const struct particles *const p = &rig.sim.kind[KIND_SOLID];
    for (int64_t i = 0; i < p->n; i++)
        of_solid += 0.5 * rig.sim.solid.body[0].mass * (p->vx[i] * p->vx[i] + p->vy[i] * p->vy[i]);
    return of_solid;
}

/* Energy after 200 rounds of nine steps and two others, over that at the start. */
static double after_pattern(double first, double second)
{
    rig_open(&rig, beam, NULL);
    struct particles *const p = &rig.sim.kind[KIND_SOLID];
    uint64_t seed = 5;
    for (int64_t i = 0; i < p->n; i++) p->vy[i] = 1e-4 * p->free[i] * noise(&seed);
    const double start = energy();
    for (int k = 0; k < 200; k++) {
        solid_advance(&rig.sim.solid, p, first * rig.sim.dt_solid, 9, true);
        solid_advance(&rig.sim.solid, p, second * rig.sim.dt_solid, 2, true);
    }
    return energy() / start;
}

/* The failure: both steps are below the bound, and stable by themselves. */
static void test_a_pattern_of_steps_grows(void)
{
    assert_at_most(6, after_pattern(1, 1), "full steps");
    assert_at_most(6, after_pattern(0.61, 0.61), "shorter steps");
    TEST_ASSERT_FALSE(after_pattern(1, 0.61) <= 1e3); /* not a number in the end */
    TEST_ASSERT_FALSE(after_pattern(0.767, 0.68) <= 1e3);
}

/* Rows every 0.75 ms, at which no step goes evenly: with either integrator and rate nothing grows beyond
 * what the weight does at the start. */
static void test_output_times_do_not_feed_the_solid(void)
{
    static const char *const settings[][2] = {
        {"integrator=symplectic", "numerics.multirate=auto"},
        {"integrator=symplectic", "numerics.multirate=off"},
        {"integrator=verlet", "numerics.multirate=auto"},
    };
    for (size_t k = 0; k < COUNT_OF(settings); k++) {
        rig_open(&rig, coupled, settings[k][0], settings[k][1], NULL);
        double early = 0, top = 0;
        for (int row = 1; row <= 60; row++) {
            rig_run(&rig, row * 0.75e-3);
            *(row <= 20 ? &early : &top) = fmax(row <= 20 ? early : top, energy());
        }
        assert_at_most(1.5 * early, top, settings[k][1]);
    }
}

/* Steps to a limit differ by round-off. */
static void test_steps_are_equal(void)
{
    rig_open(&rig, coupled, NULL);
    double least = INFINITY, most = 0;
    while (rig.sim.state.time < 0.00075) {
        rig_steps(&rig, 1, 0.00075);
        least = fmin(least, rig.sim.state.dt);
        most = fmax(most, rig.sim.state.dt);
    }
    assert_near(1e-9, 1, least / most, "smallest over largest step");
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_a_pattern_of_steps_grows);
    RUN_TEST(test_output_times_do_not_feed_the_solid);
    RUN_TEST(test_steps_are_equal);
    return UNITY_END();
}
