/* SPDX-License-Identifier: MIT
 * The cost of a run from given costs of a step, bytes of its files; and how costs are measured. The
 * linker puts these in between:
 * --wrap: thread_clock simulation_step simulation_ledger probes_sample sort_particles */
#include "app/forecast.h"
#include "output/probes.h"
#include "time/advance.h"
#include "time/energy.h"

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

/* Steps of all particles; rows of probes and ledger; snapshots. */
static void test_seconds(void)
{
    struct unit_costs with = costs;
    const struct forecast own = forecast_run(&costs, &rig.sim);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2 * own.steps, own.evaluations);
    TEST_ASSERT_TRUE(own.steps == ceil(0.02 / own.dt));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * own.seconds,
                              own.evaluations * 100 * 1e-6 + own.substeps * 45 * 1e-7, own.seconds);
    with.rows = 3;
    with.snapshots = 4;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 7 + own.seconds, forecast_run(&with, &rig.sim).seconds);
}

/* Five snapshots of 140 bytes a particle twice, two checkpoints of all arrays, and rows of 18 bytes
 * a number: 20 of the ledger with 12, 200 of the three probes with 7. */
static void test_bytes_of_the_files(void)
{
    double state = 0;
    for (int k = 0; k < KIND_COUNT; k++) state += (double)particles_bytes(&rig.sim.kind[k]);
    const double particles = 100 + 45 + (double)rig.sim.kind[KIND_WALL].n;
    const double fields = 2 * 5 * 140 * particles + 2 * state, rows = 18 * (20 * 12 + 200 * 7);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, fields + rows, forecast_run(&costs, &rig.sim).disk);
}

/* --- measurement --- */

static double clock_step, now, longer; /* longer: each eighth step, by this time, s */
static int steps;

double __real_thread_clock(void);
double __wrap_thread_clock(void);
double __wrap_thread_clock(void)
{
    now += clock_step;
    return clock_step > 0 ? now : __real_thread_clock();
}

enum err __real_simulation_step(struct simulation *sim, double limit, struct diag *d);
enum err __wrap_simulation_step(struct simulation *sim, double limit, struct diag *d);
enum err __wrap_simulation_step(struct simulation *sim, double limit, struct diag *d)
{
    if (clock_step > 0 && ++steps % 8 == 0) now += longer;
    return __real_simulation_step(sim, limit, d);
}

static double sorting; /* what a sort takes, s */

enum err __real_sort_particles(struct simulation *sim, struct diag *d);
enum err __wrap_sort_particles(struct simulation *sim, struct diag *d);
enum err __wrap_sort_particles(struct simulation *sim, struct diag *d)
{
    now += sorting;
    return __real_sort_particles(sim, d);
}

struct ledger __real_simulation_ledger(struct simulation *sim);
struct ledger __wrap_simulation_ledger(struct simulation *sim);
struct ledger __wrap_simulation_ledger(struct simulation *sim)
{
    now += clock_step;
    return __real_simulation_ledger(sim);
}

void __real_probes_sample(const struct probes *probes, struct simulation *sim, int file, bool means,
                          double *row, double *rate);
void __wrap_probes_sample(const struct probes *probes, struct simulation *sim, int file, bool means,
                          double *row, double *rate);
void __wrap_probes_sample(const struct probes *probes, struct simulation *sim, int file, bool means,
                          double *row, double *rate)
{
    now += clock_step;
    __real_probes_sample(probes, sim, file, means, row, rate);
}

/* By a clock of 1 ms a reading each state takes 2 ms, of itself and of the clock: two for each of
 * 20 rows of the ledger; for the 200 of the probes, more than there are steps, one a step. */
static void test_rows_are_measured(void)
{
    struct unit_costs c;
    clock_step = 1e-3;
    TEST_ASSERT_EQUAL_INT(ERR_OK, forecast_measure(&c, &rig.sim, &rig.diag));
    clock_step = 0;
    const double steps_of_run = 0.02 / forecast_run(&c, &rig.sim).dt;
    TEST_ASSERT_TRUE(steps_of_run < 200);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 80e-3 + 2e-3 * steps_of_run, c.rows);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 5e-3, c.snapshots); /* five, of 1 ms each */
}

/* By a clock that goes on by 0.1 ms each time it is read: the first 21 steps are not measured; then
 * steps with three readings each, until 0.2 s or the run are over. */
static void test_all_steps_are_measured(void)
{
    struct unit_costs c;
    clock_step = 1e-4;
    now = 0;
    steps = 0;
    TEST_ASSERT_EQUAL_INT(ERR_OK, forecast_measure(&c, &rig.sim, &rig.diag));
    clock_step = 0;
    TEST_ASSERT_TRUE(c.fluid > 0 && c.solid > 0 && c.evaluations > 0);
    TEST_ASSERT_TRUE(steps > 21 + 20);
    TEST_ASSERT_TRUE(now < 0.4);
}

/* A step in eight that takes 8 ms more counts as 1 ms in each. */
static void test_work_of_some_steps_counts(void)
{
    struct unit_costs c;
    clock_step = 1e-4;
    longer = 8e-3;
    TEST_ASSERT_EQUAL_INT(ERR_OK, forecast_measure(&c, &rig.sim, &rig.diag));
    clock_step = longer = 0;
    const struct forecast f = forecast_run(&c, &rig.sim);
    const double each =
        c.fluid * f.evaluations / f.steps * 100 + c.solid * f.substeps / f.steps * 45;
    TEST_ASSERT_DOUBLE_WITHIN(0.4e-3, 1.1e-3, each);
}

/* Water that starts from rest will flow at 0.75 of 10 m/s, and is sorted when it has crossed the
 * skin, although no trial step does that: a sort takes 10 s. */
static void test_sorts_of_the_flow_count(void)
{
    struct unit_costs c;
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"
             "[fluid w]\nshape = box 0, 0, 0.4, 0.2\nsurface = 0.2\nmax_speed = 10\n"
             "[wall tank]\nshape = polyline: 0, 0.3; 0, 0; 0.4, 0; 0.4, 0.3\n",
             NULL);
    clock_step = 1e-3; /* some 60 steps */
    sorting = 10;
    TEST_ASSERT_EQUAL_INT(ERR_OK, forecast_measure(&c, &rig.sim, &rig.diag));
    clock_step = sorting = 0;
    const struct forecast f = forecast_run(&c, &rig.sim);
    const double sorts = 7.5 / rig.sim.cells.skin;
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * sorts, sorts, c.fluid * f.evaluations * 800 / 10);
}

/* Without a skin each step sorts, and no step more than once. */
static void test_sorts_without_a_skin(void)
{
    struct unit_costs c;
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"
             "[fluid w]\nshape = box 0, 0, 0.4, 0.2\nsurface = 0.2\nmax_speed = 10\n"
             "[wall tank]\nshape = polyline: 0, 0.3; 0, 0; 0.4, 0; 0.4, 0.3\n",
             "numerics.skin=0", NULL);
    clock_step = 1e-3;
    TEST_ASSERT_EQUAL_INT(ERR_OK, forecast_measure(&c, &rig.sim, &rig.diag));
    clock_step = 0;
    TEST_ASSERT_TRUE(isfinite(c.fluid));
}

/* A column of water of a quarter of the tank's breadth is measured as it will lie on its bed, too:
 * a quarter as deep, with its particles scattered by half a spacing. */
static void test_water_is_measured_where_it_will_be(void)
{
    struct unit_costs c;
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"
             "[fluid w]\nshape = box 0, 0, 0.1, 0.2\nsurface = 0.2\nsound_speed = 20\n"
             "[wall tank]\nshape = polyline: 0, 0.3; 0, 0; 0.4, 0; 0.4, 0.3\n",
             NULL);
    clock_step = 1e-2; /* a few steps */
    TEST_ASSERT_EQUAL_INT(ERR_OK, forecast_measure(&c, &rig.sim, &rig.diag));
    clock_step = 0;
    const struct particles *const water = &rig.sim.kind[KIND_FLUID];
    double last = 0, top = 0;
    for (int64_t i = 0; i < water->n; i++) {
        last = fmax(last, water->x[i]);
        top = fmax(top, water->y[i]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.4, last);
    TEST_ASSERT_DOUBLE_WITHIN(0.015, 0.05, top);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_seconds);
    RUN_TEST(test_rows_are_measured);
    RUN_TEST(test_bytes_of_the_files);
    RUN_TEST(test_all_steps_are_measured);
    RUN_TEST(test_work_of_some_steps_counts);
    RUN_TEST(test_sorts_of_the_flow_count);
    RUN_TEST(test_sorts_without_a_skin);
    RUN_TEST(test_water_is_measured_where_it_will_be);
    return UNITY_END();
}
