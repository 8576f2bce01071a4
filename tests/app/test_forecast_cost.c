/* SPDX-License-Identifier: MIT
 * The cost of a run from given costs of a step: threads, spacing, files; and how these costs are measured
 * and kept. The linker puts these in between:
 * --wrap: fopen wall_clock clock_gettime simulation_step */
#include "app/forecast.h"

#include "rig.h"
#include "tiny.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

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

/* Rows of probes and ledger are written by one thread, as many at any spacing. */
static void test_rows(void)
{
    struct unit_costs with = costs;
    with.rows = 3;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 3 + of(4, 2).seconds,
                              forecast_run(&with, &rig.sim, 4, 2).seconds);
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

/* --- calibration --- */

static const char *model; /* what stands in place of /proc/cpuinfo */
static double clock_step, now;
static int steps, readings;

FILE *__real_fopen(const char *path, const char *mode);
FILE *__wrap_fopen(const char *path, const char *mode);
FILE *__wrap_fopen(const char *path, const char *mode)
{
    return __real_fopen(strcmp(path, "/proc/cpuinfo") == 0 && model ? model : path, mode);
}

double __real_wall_clock(void);
double __wrap_wall_clock(void);
double __wrap_wall_clock(void)
{
    now += clock_step;
    return clock_step > 0 ? now : __real_wall_clock();
}

int __real_clock_gettime(clockid_t id, struct timespec *t);
int __wrap_clock_gettime(clockid_t id, struct timespec *t);
int __wrap_clock_gettime(clockid_t id, struct timespec *t)
{
    readings += id == CLOCK_THREAD_CPUTIME_ID;
    return __real_clock_gettime(id, t);
}

enum err __real_simulation_step(struct simulation *s, double limit, struct diag *d);
enum err __wrap_simulation_step(struct simulation *s, double limit, struct diag *d);
enum err __wrap_simulation_step(struct simulation *s, double limit, struct diag *d)
{
    steps++;
    return __real_simulation_step(s, limit, d);
}

/* By a clock of 1 ms a reading each row takes 1 ms: 20 of the ledger, 200 of the probes. */
static void test_rows_are_measured(void)
{
    struct unit_costs c;
    clock_step = 1e-3;
    TEST_ASSERT_EQUAL_INT(ERR_OK, forecast_calibrate(&c, &rig.sim, &rig.diag));
    clock_step = 0;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 220e-3, c.rows);
}

/* Whether costs were kept for this machine, program and scene. */
static bool is_known(const char *cpuinfo)
{
    struct unit_costs c = {0};
    model = cpuinfo;
    steps = readings = 0;
    rig_open(&rig, tiny_case, NULL);
    TEST_ASSERT_EQUAL_INT(ERR_OK, forecast_calibrate(&c, &rig.sim, &rig.diag));
    TEST_ASSERT_TRUE(c.fluid > 0 && c.solid > 0);
    TEST_ASSERT_EQUAL_INT(c.cached, readings == 0);
    return c.cached;
}

static const char *write_model(const char *name, const char *text)
{
    const char *const path = tiny_path(name);
    FILE *file = __real_fopen(path, "w");
    fputs(text, file);
    fclose(file);
    return path;
}

/* Costs are those of one processor: its model, or that it is not known, is part of the key. */
static void test_costs_belong_to_a_processor(void)
{
    clock_step = 1e-3;
    setenv("XDG_CACHE_HOME", tiny_folder(), 1);
    const char *const one = write_model("one", "processor: 0\nmodel name: one\nmodel name: two\n"),
                      *const two = write_model("two", "model name: two\n"),
                      *const none = write_model("none", "processor: 0\n");
    TEST_ASSERT_FALSE(is_known(one));
    TEST_ASSERT_TRUE(is_known(one));
    TEST_ASSERT_FALSE(is_known(two));
    TEST_ASSERT_FALSE(is_known(none));
    TEST_ASSERT_TRUE(is_known(two));
    TEST_ASSERT_TRUE(is_known("/no/such/file"));
    model = NULL;
}

/* Steps are repeated for 5 ms each time, here by a clock that goes on by 0.1 ms each time it is read. A
 * repeat reads the clock of the processor twice. */
static void test_steps_are_measured_in_repeats(void)
{
    setenv("XDG_CACHE_HOME", "/dev/null", 1);
    clock_step = 1e-4;
    now = 0;
    TEST_ASSERT_FALSE(is_known(NULL));
    const double repeats = readings / 2, before = 1 + 20;
    TEST_ASSERT_TRUE(readings % 2 == 0 && repeats > 10);
    TEST_ASSERT_TRUE((steps - before) / repeats >= 1.5);
    setenv("XDG_CACHE_HOME", tiny_folder(), 1);
}

/* What is no line of costs is not believed, and a cache that has grown too large begins anew. */
static void test_lines_that_are_no_costs(void)
{
    static const char *const spoilt[] = {"-1", "inf", "1e9", "x", ""};
    clock_step = 1e-3;
    setenv("XDG_CACHE_HOME", tiny_path("spoilt"), 1);
    TEST_ASSERT_FALSE(is_known(NULL));
    char path[300], key[17] = "", line[1000] = "";
    snprintf(path, sizeof path, "%s/sphfsi/costs", tiny_path("spoilt"));
    FILE *file = __real_fopen(path, "r");
    TEST_ASSERT_NOT_NULL(fgets(line, sizeof line, file));
    fclose(file);
    memcpy(key, line, 16);
    const char *const rest = strchr(line + 17, ' ');
    for (size_t k = 0; k < COUNT_OF(spoilt) + 3; k++) {
        file = __real_fopen(path, "w");
        if (k < COUNT_OF(spoilt))
            fprintf(file, "%s %s%s", key, spoilt[k], rest);
        else if (k == COUNT_OF(spoilt))
            fprintf(file, "%s1e-7%s", key, rest); /* no blank behind the key */
        else if (k == COUNT_OF(spoilt) + 1)
            fprintf(file, "%.*s 7\n", (int)strcspn(line, "\n"), line); /* more than there may be */
        else
            fprintf(file, "%.*s", (int)strcspn(line, "\n"), line); /* cut off */
        fclose(file);
        TEST_ASSERT_FALSE_MESSAGE(is_known(NULL), k < COUNT_OF(spoilt) ? spoilt[k] : "end of line");
        TEST_ASSERT_TRUE(is_known(NULL) || k > COUNT_OF(spoilt) + 1);
    }
    file = __real_fopen(path, "w");
    for (int k = 0; k < 70000; k++) fputs("0123456789abcdef\n", file);
    fclose(file);
    TEST_ASSERT_FALSE(is_known(NULL));
    TEST_ASSERT_TRUE(is_known(NULL));
    file = __real_fopen(path, "r");
    TEST_ASSERT_NOT_NULL(fgets(line, sizeof line, file));
    TEST_ASSERT_NULL(fgets(line, sizeof line, file));
    fclose(file);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_threads_share_the_work);
    RUN_TEST(test_rows);
    RUN_TEST(test_rows_are_measured);
    RUN_TEST(test_spacing);
    RUN_TEST(test_bytes_of_the_files);
    RUN_TEST(test_costs_belong_to_a_processor);
    RUN_TEST(test_steps_are_measured_in_repeats);
    RUN_TEST(test_lines_that_are_no_costs);
    return UNITY_END();
}
