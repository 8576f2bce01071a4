/* SPDX-License-Identifier: MIT
 * The cost of a run: its parts, bytes of its files; and how costs are measured. The linker puts
 * these in between:
 * --wrap: thread_clock phase_clock simulation_step probes_sample sort_particles
 */
#include "app/session.h"
#include "output/probes.h"
#include "time/advance.h"
#include "time/energy.h"

#include "rig.h"
#include "tiny.h"
#include "unity.h"

static struct session session;
static struct simulation *const sim = &session.simulation;
static struct diag diag;

static void open_case(const char *text, const char *set)
{
    const struct sphfsi_options o = {.case_text = text,
                                     .threads = 1,
                                     .sets = &set,
                                     .n_sets = set != NULL};
    session_close(&session);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, session_open(&session, &o, &diag), diag.text);
}

void setUp(void)
{
    rig_one_thread();
    open_case(tiny_case, NULL);
}

void tearDown(void) { session_close(&session); }

/* Five snapshots of 140 bytes a particle twice, two checkpoints of all arrays, and rows of 18 bytes
 * a number: 20 of the ledger with 12, 200 of the three probes with 7. */
static void check_bytes(const struct forecast *f)
{
    double state = 0;
    for (int k = 0; k < KIND_COUNT; k++) state += (double)particles_bytes(&sim->particles[k]);
    const double particles = 100 + 45 + (double)sim->particles[KIND_WALL].n;
    const double fields = 2 * 5 * 140 * particles + 2 * state, rows = 18 * (20 * 12 + 200 * 7);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, fields + rows, f->disk);
}

/* --- measurement --- */

static double clock_step, now; /* each reading of the clock takes this time, s */
static double longer;          /* takes each eighth step */
static double late;            /* takes each step in the second half of the run */
static double tick;            /* takes each reading of the clock of phases */
static int steps;

double __real_thread_clock(void);
double __wrap_thread_clock(void);
double __wrap_thread_clock(void)
{
    now += clock_step;
    return clock_step > 0 || tick > 0 ? now : __real_thread_clock();
}

double __real_phase_clock(void);
double __wrap_phase_clock(void);
double __wrap_phase_clock(void)
{
    now += tick;
    return tick > 0 ? now : __real_phase_clock();
}

enum err __real_simulation_step(struct simulation *s, double limit, struct diag *d);
enum err __wrap_simulation_step(struct simulation *s, double limit, struct diag *d);
enum err __wrap_simulation_step(struct simulation *s, double limit, struct diag *d)
{
    if (clock_step > 0 && ++steps % 8 == 0) now += longer;
    if (s->state.time > 0.5 * s->scene->top.end_time) now += late;
    return __real_simulation_step(s, limit, d);
}

static double sorting; /* what a sort takes, s */

enum err __real_sort_particles(struct simulation *s, struct diag *d);
enum err __wrap_sort_particles(struct simulation *s, struct diag *d);
enum err __wrap_sort_particles(struct simulation *s, struct diag *d)
{
    now += sorting;
    return __real_sort_particles(s, d);
}

static double reading; /* what a reading of probes takes in the second half of the run, s */

void __real_probes_sample(const struct probes *probes, struct simulation *s, int file, bool means,
                          double *row, double *rate);
void __wrap_probes_sample(const struct probes *probes, struct simulation *s, int file, bool means,
                          double *row, double *rate);
void __wrap_probes_sample(const struct probes *probes, struct simulation *s, int file, bool means,
                          double *row, double *rate)
{
    now += s->state.time > 0.5 * s->scene->top.end_time ? reading : 0;
    __real_probes_sample(probes, s, file, means, row, rate);
}

/* By clocks that count readings, from now on. */
static struct forecast foresee(const char *text, const char *set)
{
    const struct sphfsi_options o = {.case_text = text,
                                     .threads = 1,
                                     .sets = &set,
                                     .n_sets = set != NULL};
    struct forecast f;
    open_case(text, set);
    now = 0;
    steps = 0;
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, forecast_run(&f, &session, &o, &diag), diag.text);
    clock_step = longer = late = tick = sorting = reading = 0;
    return f;
}

/* With rows in them. */
static double seconds_of_steps(const struct forecast *f)
{
    return f->seconds - f->files - session.opening;
}

/* Steps of all particles; rows of probes and ledger; snapshots and checkpoints; the opening. */
static void test_seconds(void)
{
    clock_step = 1e-4;
    const struct forecast f = foresee(tiny_case, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * f.evaluations, 0.02 / f.dt, f.evaluations);
    TEST_ASSERT_TRUE(f.steps == ceil(0.02 / f.dt * (1 - 1e-9)));
    TEST_ASSERT_TRUE(f.fluid > 0 && f.solid > 0 && f.rows > 0 && f.files > 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * f.seconds,
                              f.evaluations * 100 * f.fluid + f.substeps * 45 * f.solid + f.rows +
                                  f.files + session.opening,
                              f.seconds);
    check_bytes(&f);
}

/* By a clock of 1 ms a reading: five snapshots and a checkpoint. */
static void test_files_are_measured(void)
{
    clock_step = 1e-3;
    assert_near(1e-9, 6e-3, foresee(tiny_case, NULL).files, "s");
}

/* The most probes that a case may have, each with the most columns, in one file. */
static void test_widest_rows_are_measured(void)
{
    static char text[16384];
    int at = snprintf(text, sizeof text, "%s", tiny_case);
    for (int k = 3; k < SCENE_MAX_SECTIONS; k++)
        at += snprintf(text + at, sizeof text - (size_t)at,
                       "[probe S%d]\nquantity = stress\nbody = gate\npoint = 0.11, 0.04\n", k);
    TEST_ASSERT_TRUE(at < (int)sizeof text);
    TEST_ASSERT_TRUE(foresee(text, NULL).rows > foresee(tiny_case, NULL).rows);
}

/* By a clock that goes on by 0.1 ms each time it is read: the first 21 steps are not measured; then
 * steps with a reading each, until 0.2 s or the run are over, and a run of at most 0.5 s. */
static void test_all_steps_are_measured(void)
{
    clock_step = 1e-4;
    const struct forecast f = foresee(tiny_case, NULL);
    TEST_ASSERT_TRUE(f.fluid > 0 && f.solid > 0 && f.evaluations > 0);
    TEST_ASSERT_TRUE(steps > 21 + 20);
    TEST_ASSERT_TRUE(now < 0.4);
}

/* A step in eight that takes 8 ms more counts as 1 ms in each. */
static void test_work_of_some_steps_counts(void)
{
    clock_step = 1e-4;
    tick = 1e-7; /* shares of phases, too, by a clock that other programs do not disturb */
    longer = 8e-3;
    const struct forecast f = foresee(tiny_case, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.4e-3, 1.1e-3, seconds_of_steps(&f) / f.steps);
}

/* A column of water that falls on its bed, and rows that take no part of it. */
#define COLUMN                                                                 \
    "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"                            \
    "[fluid w]\nshape = box 0, 0, 0.1, 0.2\nsurface = 0.2\nsound_speed = 20\n" \
    "[wall tank]\nshape = polyline: 0, 0.3; 0, 0; 0.4, 0; 0.4, 0.3\n"

/* What a step takes after the trial is found at twice the spacing: 1 ms more in the second half of
 * the run. */
static void test_later_steps_count(void)
{
    double each[2];
    for (int k = 0; k < 2; k++) {
        tick = 1e-5;
        clock_step = 5e-4;
        late = k * 1e-3;
        const struct forecast f = foresee(COLUMN, NULL);
        assert_near(1e-9, 0.02, f.coarse_dp, "the spacing of the coarse run");
        each[k] = seconds_of_steps(&f) / f.steps;
    }
    assert_near(0.05e-3, 0.5e-3, each[1] - each[0], "s a step");
}

/* Readings of probes later in the run, too: of 10 ms in its second half, on both sides of each of
 * 50 rows. */
static void test_rows_of_later_states_count(void)
{
    double rows[2];
    for (int k = 0; k < 2; k++) {
        tick = 1e-5;
        reading = k * 1e-2;
        rows[k] = foresee(COLUMN "[probe p]\nquantity = front\n"
                                 "[output]\nprobe_interval = 0.01\nledger_interval = 0.01\n",
                          NULL)
                      .rows;
    }
    assert_near(0.2, 1, rows[1] - rows[0], "s");
}

/* Rows that are rarer than the trial is long: of 10 ms, on both sides of one at 0.6 s. */
static void test_rare_rows_count(void)
{
    tick = 2e-5;
    reading = 1e-2;
    const struct forecast f = foresee(COLUMN "[probe p]\nquantity = front\n"
                                             "[output]\nprobe_interval = 0.6\n"
                                             "ledger_interval = 0.6\n",
                                      NULL);
    assert_near(10e-3, 20e-3, f.rows, "s");
}

/* Sorts of water that flows, although the trial has none: by a run, each of 1 ms. */
static void test_sorts_of_the_flow_count(void)
{
    tick = 2e-5;
    sorting = 1e-3;
    const struct forecast f = foresee(COLUMN, "output.ledger_interval=0.1");
    assert_near(1e-9, 0.02, f.coarse_dp, "the spacing of the coarse run");
    const double seconds = f.phase_fraction[PHASE_sort] * f.fluid * f.evaluations * 200;
    struct rig rig = {0};
    rig_open(&rig, COLUMN, NULL);
    rig_run(&rig, 1);
    const double sorts = (double)rig.sim.state.sorts;
    rig_close(&rig);
    assert_near(0.1 * sorts, sorts, seconds / 1e-3, "sorts");
}

/* Without a skin each step sorts, and no step more than once. */
static void test_sorts_without_a_skin(void)
{
    clock_step = 1e-3;
    const struct forecast f = foresee(COLUMN, "numerics.skin=0");
    TEST_ASSERT_TRUE(isfinite(f.fluid) && isfinite(f.seconds));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_seconds);
    RUN_TEST(test_files_are_measured);
    RUN_TEST(test_widest_rows_are_measured);
    RUN_TEST(test_all_steps_are_measured);
    RUN_TEST(test_work_of_some_steps_counts);
    RUN_TEST(test_later_steps_count);
    RUN_TEST(test_rows_of_later_states_count);
    RUN_TEST(test_rare_rows_count);
    RUN_TEST(test_sorts_of_the_flow_count);
    RUN_TEST(test_sorts_without_a_skin);
    return UNITY_END();
}
