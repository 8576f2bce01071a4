/* SPDX-License-Identifier: MIT
 * When the gradients of the density of Antuono et al. 2010 are found again (L-5a). */
#include "particles/kernel.h"

#include "rig.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

static const char tank[] =
    "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\nprecision = double\nscheme = standard\n"
    "[fluid water]\nshape = box 0, 0, 0.2, 0.1\nsound_speed = 20\nsurface = 0.1\n"
    "velocity = sin(40*x)*cos(30*y), sin(30*x)*cos(20*y)\n"
    "[wall tank]\nshape = polyline thickness -0.05: 0, 0.15; 0, 0; 0.2, 0; 0.2, 0.15\n";

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

/* Those of one particle, wherever it is sorted to. */
static double slope_of(int64_t id)
{
    const struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    for (int64_t i = 0; i < particles->n; i++)
        if (particles->id[i] == id) return particles->slope_x[i] + 2 * particles->slope_y[i];
    TEST_FAIL_MESSAGE("the particle is gone");
    return 0;
}

/* How often they change in 100 steps, the longest time for which they do not, and the start of the
 * last step. */
static int found_again(const char *integrator, double *longest, double *last)
{
    rig_open(&rig, tank, integrator, NULL);
    const int64_t id = rig.sim.particles[KIND_FLUID].id[70];
    double before = 0, since = 0;
    int times = 0;
    *longest = 0;
    for (int k = 0; k < 100; k++) {
        const double time = *last = rig.sim.state.time;
        rig_steps(&rig, 1, 1);
        const double now = slope_of(id);
        if (now == before) continue;
        if (times++ > 0) *longest = fmax(*longest, time - since);
        since = time;
        before = now;
    }
    return times;
}

static void test_once_while_sound_crosses_the_kernel(void)
{
    static const char *const integrators[] = {"integrator=leapfrog", "integrator=symplectic"};
    for (int k = 0; k < 2; k++) {
        double longest, last;
        const int times = found_again(integrators[k], &longest, &last);
        const double interval = KERNEL_REACH * rig.sim.fluid.k.h / rig.sim.fluid.k.c0;
        /* A step that begins on a multiple, as the first does, may be followed by another. */
        const int least = 1 + (int)floor(last / interval);
        TEST_ASSERT_TRUE(times == least || times == least + 1);
        TEST_ASSERT_TRUE(times > 3 && times < 30);
        assert_at_most(interval + rig.sim.state.dt_max, longest, "time between two");
    }
}

/* Steps that divide the interval: round-off decides on which side of a multiple a step begins.
 * Five intervals and more were left out where the step before was taken to begin at the time
 * less dt. */
static void test_no_interval_is_left_out(void)
{
    static const struct {
        int sound, steps;
    } cases[] = {{45, 8}, {21, 7}, {42, 7}, {20, 8}};
    for (size_t k = 0; k < COUNT_OF(cases); k++) {
        const double interval = 2 * 0.02 / cases[k].sound;
        char step[64], sound[64];
        snprintf(step, sizeof step, "numerics.fixed_step=%.17g", interval / cases[k].steps);
        snprintf(sound, sizeof sound, "water.sound_speed=%d", cases[k].sound);
        rig_open(&rig, tank, step, sound, NULL);
        double since = 0;
        for (int n = 0; n < 2000; n++) {
            const double time = rig.sim.state.time;
            rig_steps(&rig, 1, 1);
            if (!rig.sim.fluid.keeps_slopes) since = time;
            assert_at_most(1.001 * interval, time - since, "time since the gradients were found");
        }
        rig_close(&rig);
    }
}

static void test_in_each_step_of_verlet(void)
{
    double longest, last;
    TEST_ASSERT_EQUAL_INT(100, found_again("integrator=verlet", &longest, &last));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_once_while_sound_crosses_the_kernel);
    RUN_TEST(test_no_interval_is_left_out);
    RUN_TEST(test_in_each_step_of_verlet);
    return UNITY_END();
}
