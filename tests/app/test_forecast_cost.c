/* SPDX-License-Identifier: MIT
 * The cost of a run from given costs of a step: threads, spacing, files. */
#include "app/forecast.h"

#include "rig.h"
#include "tiny.h"
#include "unity.h"

static struct rig rig;
static const struct unit_costs costs = {.fluid = 1e-6, .solid = 1e-7, .evaluations = 2};

void setUp(void)
{
    rig_one_thread();
    rig_open(&rig, tiny_case, NULL);
}

void tearDown(void) { rig_close(&rig); }

static struct forecast of(int threads, double scale)
{
    return forecast_run(&costs, &rig.sim, threads, scale);
}

/* Each thread beyond the first adds 93 % of one. */
static void test_threads_share_the_work(void)
{
    const struct forecast one = of(1, 1);
    const double evaluations = one.evaluations + 0.02 / 1e-3;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2 * one.steps, one.evaluations);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * one.seconds,
                              evaluations * 100 * 1e-6 + one.substeps * 45 * 1e-7, one.seconds);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, one.seconds / 1.93, of(2, 1).seconds);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, one.seconds / (1 + 7 * 0.93), of(8, 1).seconds);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)rig.sim.fluid.thread_bytes,
                              of(2, 1).memory - one.memory);
}

/* Twice the spacing: a quarter of the particles, fewer steps unless outputs end them. */
static void test_spacing(void)
{
    const struct forecast own = of(1, 1), coarse = of(1, 2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, own.particles / 4, coarse.particles);
    TEST_ASSERT_TRUE(coarse.steps <= own.steps && coarse.seconds <= own.seconds / 4);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.02, coarse.steps * coarse.dt);
    const double thread = (double)rig.sim.fluid.thread_bytes;
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, (own.memory - thread) / 4, coarse.memory - thread);
}

/* Five snapshots of 140 bytes a particle twice, two checkpoints of all arrays, and rows of 18 bytes a number:
 * 20 of the ledger with 12, 200 of the three probes with 7. */
static void test_bytes_of_the_files(void)
{
    double state = 0;
    for (int k = 0; k < KIND_COUNT; k++) state += (double)particles_bytes(&rig.sim.kind[k]);
    const double particles = 100 + 45 + (double)rig.sim.kind[KIND_WALL].n;
    const double fields = 2 * 5 * 140 * particles + 2 * state, rows = 18 * (20 * 12 + 200 * 7);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, fields + rows, of(1, 1).disk);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, fields / 4 + rows, of(1, 2).disk);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_threads_share_the_work);
    RUN_TEST(test_spacing);
    RUN_TEST(test_bytes_of_the_files);
    return UNITY_END();
}
