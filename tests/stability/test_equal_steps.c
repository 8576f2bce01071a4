/* SPDX-License-Identifier: MIT
 * Steps that change in a pattern feed oscillations that each of them alone would keep. Steps up to
 * an output time are therefore equal. */
#include "rig.h"
#include "time/timestep.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

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
    const struct particles *const particles = &rig.sim.kind[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++)
        of_solid += 0.5 * rig.sim.solid.body[0].mass *
                    (particles->vx[i] * particles->vx[i] + particles->vy[i] * particles->vy[i]);
    return of_solid;
}

/* Energy after 200 rounds of nine steps and two others, over that at the start. */
static double after_pattern(double first, double second)
{
    rig_open(&rig, beam, NULL);
    struct particles *const particles = &rig.sim.kind[KIND_SOLID];
    uint64_t seed = 5;
    for (int64_t i = 0; i < particles->n; i++)
        particles->vy[i] = 1e-4 * particles->free[i] * noise(&seed);
    const double start = energy();
    for (int k = 0; k < 200; k++) {
        solid_advance(&rig.sim.solid, particles, first * rig.sim.dt_solid, 9, true);
        solid_advance(&rig.sim.solid, particles, second * rig.sim.dt_solid, 2, true);
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

/* Rows every 0.75 ms, at which no step goes evenly: with either integrator and rate nothing grows
 * beyond what the weight does at the start. */
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

/* --- outputs at two intervals (T-34d) --- */

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

/* Rows of one file every 0.3 ms and of another every 0.5 ms. Without a common grid the steps
 * between them are 0.15 and 0.1 ms long, and after 48 ms the plate has 12 times the energy that it
 * was given. */
static void test_rows_at_two_intervals_do_not_feed_the_solid(void)
{
    rig_open(&rig, plate, "output.ledger_interval=0.3 ms", "output.probe_interval=0.5 ms", NULL);
    assert_near(1e-12, 1e-4, rig.sim.output_grid, "grid");
    double least = INFINITY, most = 0;
    for (int k = 1; k <= 570; k++) {
        if (k % 3 && k % 5) continue;
        while (rig.sim.state.time < k * 1e-4) {
            rig_steps(&rig, 1, k * 1e-4);
            least = fmin(least, rig.sim.state.dt);
            most = fmax(most, rig.sim.state.dt);
        }
    }
    assert_near(1e-9, 1, least / most, "smallest over largest step");
    assert_at_most(0.01, rig.sim.state.gain_share, "gain");
}

/* The grid is the divisor of all intervals; of those below 64 and 16 steps, if it is too fine. */
static void test_the_grid_of_outputs(void)
{
    static const struct {
        const char *ledger, *probe, *snapshot;
        double grid;
    } row[] = {
        {"0.5 ms", "1 ms", "10 ms", 0},      /* one of the intervals */
        {"0.6 ms", "1 ms", "10 ms", 2e-4},   /* 0.2 ms */
        {"0.6 ms", "1 ms", "9.1 ms", 1e-4},  /* half a step */
        {"0.6 ms", "1 ms", "9.15 ms", 2e-4}, /* 46 steps: left out */
        {"0.5 ms", "0.5 ms", "3.55 ms", 0},  /* 18 steps: left out */
    };
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        char set[3][64];
        snprintf(set[0], sizeof set[0], "output.ledger_interval=%s", row[k].ledger);
        snprintf(set[1], sizeof set[1], "output.probe_interval=%s", row[k].probe);
        snprintf(set[2], sizeof set[2], "output.snapshot_interval=%s", row[k].snapshot);
        rig_open(&rig, plate, set[0], set[1], set[2], NULL);
        assert_near(1e-6 * row[k].grid, row[k].grid, rig.sim.output_grid, row[k].snapshot);
    }
}

/* Before t = 0, while rest is sought, no step ends at the grid, and late in a run times have 12
 * digits only. Intervals that drift apart have no grid. */
static void test_times_on_the_grid(void)
{
    rig_open(&rig, plate, "output.ledger_interval=0.3 ms", "output.probe_interval=0.5 ms", NULL);
    rig.sim.state.time = -0.5;
    TEST_ASSERT_TRUE(timestep_stop(&rig.sim, 1) == 1);
    rig.sim.state.time = 2.00000e5;
    assert_near(1e-9, 2e5 + 1e-4, timestep_stop(&rig.sim, 2e5 + 3e-4), "next");
    for (int k = 0; k < 3; k++) {
        rig.sim.state.time = 2e5 + 1e-4 * k + 1e-7 * (k - 1);
        const double limit = 2e5 + 1e-4 * (k + 1);
        TEST_ASSERT_TRUE(timestep_stop(&rig.sim, limit) == limit);
    }
    rig_open(&rig, plate, "output.ledger_interval=0.3 ms", "output.probe_interval=0.50000005 ms",
             NULL);
    TEST_ASSERT_TRUE(rig.sim.uneven == 2);
}

/* Below half a step there is no grid: the solid takes half of its steps. With whole ones the plate
 * has 12 times its energy after 160 ms. */
static void test_outputs_without_a_grid_halve_the_steps_of_the_solid(void)
{
    rig_open(&rig, plate, "output.ledger_interval=0.5 ms", "output.probe_interval=0.5 ms", NULL);
    const double whole = rig.sim.dt_solid;
    rig_open(&rig, plate, "output.ledger_interval=0.37 ms", "output.probe_interval=0.5 ms", NULL);
    TEST_ASSERT_TRUE(rig.sim.uneven == 2 &&
                     rig.sim.output_grid == 0); /* the second that is considered */
    assert_near(1e-12 * whole, 0.5 * whole, rig.sim.dt_solid, "step of the solid");
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_a_pattern_of_steps_grows);
    RUN_TEST(test_output_times_do_not_feed_the_solid);
    RUN_TEST(test_steps_are_equal);
    RUN_TEST(test_rows_at_two_intervals_do_not_feed_the_solid);
    RUN_TEST(test_the_grid_of_outputs);
    RUN_TEST(test_times_on_the_grid);
    RUN_TEST(test_outputs_without_a_grid_halve_the_steps_of_the_solid);
    return UNITY_END();
}
