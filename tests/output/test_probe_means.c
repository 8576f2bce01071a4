/* SPDX-License-Identifier: MIT
 * Probes: means in time, over a restart as well; what is refused. */
#include "output/checkpoint.h"
#include "output/rows.h"
#include "rig.h"
#include "tiny.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct rig rig;
static struct arena arena;
static struct probes probes;
static struct row_files means;
static char text[4096];

/* The tiny scene with further lines behind it. */
static void open_with(const char *more, const char *set)
{
    snprintf(text, sizeof text, "%s%s", tiny_case, more);
    rig_open(&rig, text, "precision=double", set, NULL);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, probes_create(&probes, &rig.sim, &arena, &rig.diag),
                                  rig.diag.text);
    TEST_ASSERT_EQUAL_INT(ERR_OK, rows_create(&means, &probes, &rig.sim, false, &arena, &rig.diag));
}

void setUp(void) {}

void tearDown(void)
{
    rig_close(&rig);
    arena_free(&arena);
}

/* The values of the last probe of the scene. */
static const double *last_values(void)
{
    static double row[PROBE_MAX_COLUMNS];
    probes_values(&probes, &rig.sim, probes.n - 1, row);
    return row;
}

/* --- means in time --- */

static const char averaged[] =
    "[probe I]\nquantity = force\nbody = gate\n"
    "[probe N]\nquantity = force\nbody = gate\ninterval = 2 ms\naverage = 2 ms\n";

/* Steps to the time, and adds up the trapezoids of the present force from `from` on. */
static double follow(double from, double until)
{
    double before[3], now[3], sum = 0;
    while (rig.sim.state.time < until) {
        const double time = rig.sim.state.time;
        probes_values(&probes, &rig.sim, probes.n - 2, before);
        rig_steps(&rig, 1, until);
        probes_values(&probes, &rig.sim, probes.n - 2, now);
        if (time >= from) sum += 0.5 * (before[0] + now[0]) * (rig.sim.state.time - time);
    }
    return sum / (until - from);
}

static void mean_over_the_whole_interval(void)
{
    open_with(averaged, NULL);
    rows_follow(&means, &rig.sim);
    double first[3], second;
    memcpy(first, last_values(), sizeof first);
    double now[3];
    probes_values(&probes, &rig.sim, probes.n - 2, now);
    TEST_ASSERT_TRUE(first[0] == now[0]); /* nothing before the start */
    const double one = follow(0, 0.002);
    assert_near(1e-12 * fabs(one), one, last_values()[0], "first mean");
    const double two = follow(0.002, 0.004);
    second = last_values()[0];
    assert_near(1e-12 * fabs(two), two, second, "second mean");
    TEST_ASSERT_TRUE(fabs(one - two) > 1e-3 * fabs(one));
}

/* 0.7 ms before the row lies within a step: the straight line between its ends holds there. */
static void mean_over_a_part_of_the_interval(void)
{
    open_with(averaged, "N.average=0.7 ms");
    rows_follow(&means, &rig.sim);
    const double begin = 0.002 - 0.0007;
    double sum = 0, before[3], now[3], time = 0;
    probes_values(&probes, &rig.sim, probes.n - 2, before);
    while (rig.sim.state.time < 0.002) {
        const double last = time;
        rig_steps(&rig, 1, 0.002);
        time = rig.sim.state.time;
        probes_values(&probes, &rig.sim, probes.n - 2, now);
        const double from = fmax(last, begin);
        const double at_from = before[0] + (now[0] - before[0]) * (from - last) / (time - last);
        if (time > begin) sum += 0.5 * (at_from + now[0]) * (time - from);
        memcpy(before, now, sizeof before);
    }
    assert_near(1e-12 * fabs(sum / 0.0007), sum / 0.0007, last_values()[0], "mean");
    TEST_ASSERT_TRUE(fabs(last_values()[0] - now[0]) > 1e-4 * fabs(now[0]));
}

static void mean_after_a_restart(void)
{
    struct checkpoint image = {0};
    open_with(averaged, NULL);
    rows_follow(&means, &rig.sim);
    follow(0, 0.002);
    follow(0.002, 0.0031);
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_capture(&image, &rig.sim, "", "test", &rig.diag));
    follow(0.0031, 0.004);
    double whole[3];
    memcpy(whole, last_values(), sizeof whole);
    const uint64_t hash = simulation_hash(&rig.sim);
    tearDown();
    open_with(averaged, NULL);
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_apply(&image, &rig.sim, &rig.diag));
    rows_follow(&means, &rig.sim);
    follow(0.0031, 0.004);
    TEST_ASSERT_EQUAL_MEMORY(whole, last_values(), sizeof whole);
    TEST_ASSERT_TRUE(hash == simulation_hash(&rig.sim));
    checkpoint_free(&image);
}

/* --- what is refused --- */

static void refused_probes(void)
{
    static const char *const wrong[][2] = {
        {"[probe Z]\nquantity = pressure\npoint = 0, 0\non = gat\n",
         "on = gat: there is no [solid] or [wall]"},
        {"[probe Z]\nquantity = flux\non = gate\npoint = 0, 0\nto = 1, 0\n",
         "only for pressure, level, velocity and surface pressure"},
        {"[probe Z]\nbody = gate\npoint = 0.13, 0\naverage = 1 ms\n", "`interval` to 0.001 s"},
        {"[probe Z]\nquantity = force\nbody = gate, tan\n", "body = tan: there is no"},
        {"[probe Z]\nquantity = force\nbody = gate, gate\n", "is listed twice"},
        {"[probe Z]\nquantity = force\nbody = gate,\n", "there is no [solid] or [wall]"},
        {"[solid post]\nlike = gate\nshape = box 0.3, 0, 0.33, 0.1\n"
         "[probe Z]\nquantity = reaction\nbody = post\n",
         "give it a `clamp`"},
    };
    for (size_t k = 0; k < COUNT_OF(wrong); k++) {
        snprintf(text, sizeof text, "%s%s", tiny_case, wrong[k][0]);
        rig_refuses(text, wrong[k][1]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    rig_one_thread();
    RUN_TEST(mean_over_the_whole_interval);
    RUN_TEST(mean_over_a_part_of_the_interval);
    RUN_TEST(mean_after_a_restart);
    RUN_TEST(refused_probes);
    return UNITY_END();
}
