/* SPDX-License-Identifier: MIT
 * Steps that change in a pattern feed oscillations that each of them alone would keep (T-34b).
 * Those that the physics sets make no such pattern. */
#include "rig.h"
#include "time/energy.h"
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
    const struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++)
        of_solid += 0.5 * rig.sim.solid.body[0].mass *
                    (particles->vx[i] * particles->vx[i] + particles->vy[i] * particles->vy[i]);
    return of_solid;
}

/* Energy after 200 rounds of nine steps and two others, over that at the start. */
static double after_pattern(double first, double second)
{
    rig_open(&rig, beam, NULL);
    struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    uint64_t seed = 5;
    for (int64_t i = 0; i < particles->n; i++)
        particles->vy[i] = 1e-4 * particles->free[i] * noise(&seed);
    const double start = energy();
    rig.sim.solid.centred = true;
    for (int k = 0; k < 200; k++) {
        solid_advance(&rig.sim.solid, particles, first * rig.sim.dt_solid, 9);
        solid_advance(&rig.sim.solid, particles, second * rig.sim.dt_solid, 2);
    }
    return energy() / start;
}

/* The failure: both steps are below the bound, and stable by themselves. */
static void test_a_pattern_of_steps_grows(void)
{
    assert_at_most(6, after_pattern(1, 1), "full steps");
    assert_at_most(6, after_pattern(0.61, 0.61), "shorter steps");
    TEST_ASSERT_FALSE(after_pattern(1, 0.61) <= 1e3); /* not a number in the end */
    TEST_ASSERT_FALSE(after_pattern(0.907, 0.73) <= 1e3);
}

/* With either integrator and rate nothing grows beyond what the weight does at the start. */
static void test_steps_of_a_run_do_not_feed_the_solid(void)
{
    static const char *const settings[][2] = {
        {"integrator=symplectic", "numerics.multirate=auto"},
        {"integrator=symplectic", "numerics.multirate=off"},
        {"integrator=verlet", "numerics.multirate=auto"},
        {"integrator=leapfrog", "numerics.multirate=auto"},
    };
    for (size_t k = 0; k < COUNT_OF(settings); k++) {
        rig_open(&rig, coupled, settings[k][0], settings[k][1], NULL);
        double early = 0, top = 0;
        while (rig.sim.state.time < 45e-3) {
            rig_steps(&rig, 1, INFINITY);
            double *const of = rig.sim.state.time <= 15e-3 ? &early : &top;
            *of = fmax(*of, energy());
        }
        assert_at_most(1.5 * early, top, settings[k][1]);
    }
}

/* A plate between two bodies of water, with 7 sub-steps in a fluid step of 0.2 ms. */
static const char plate[] =
    "dp = 5 mm\nend_time = 60 ms\ngravity = 0, -9.81\n"
    "[fluid left]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 15\nartificial_viscosity = 0.01\n"
    "surface = 0.1\n[fluid right]\nlike = left\nshape = box 0.12, 0, 0.22, 0.1\nsurface = 0.1\n"
    "[wall tank]\nshape = polyline thickness -0.02: 0, 0.2; 0, 0; 0.1, 0\n"
    "shape = polyline thickness -0.02: 0.12, 0; 0.22, 0; 0.22, 0.2\n"
    "[solid plate]\nshape = box 0.1, -0.02, 0.12, 0.12\nclamp = box 0.1, -0.02, 0.12, 0\n"
    "density = 1100\nyoung = 2 MPa\npoisson = 0.3\n"
    "[load hit]\nbody = plate\nshape = box 0.1, 0.09, 0.12, 0.13\n"
    "force = 40*max(0, sin(pi*min(t/20e-3, 1))), 0\n"
    "[probe top]\nbody = plate\npoint = 0.11, 0.12\n"
    "[output]\nsnapshot_interval = 1\n";

/* Steps that end every 0.3 and every 0.5 ms, 0.15 and 0.1 ms long, give the plate 12 times the
 * energy that it was given. */
static void test_a_plate_between_waters_gains_nothing(void)
{
    rig_open(&rig, plate, NULL);
    while (rig.sim.state.time < 57e-3) rig_steps(&rig, 1, INFINITY);
    assert_at_most(0.01, rig.sim.state.gain_share, "gain");
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_a_pattern_of_steps_grows);
    RUN_TEST(test_steps_of_a_run_do_not_feed_the_solid);
    RUN_TEST(test_a_plate_between_waters_gains_nothing);
    return UNITY_END();
}
