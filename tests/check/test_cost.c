/* SPDX-License-Identifier: MIT
 * Settings that make a run slow: said where they are, by how much, and not of settings that do not.
 */
#include "check/check.h"
#include "rig.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct rig rig;
static char said[4000];

static void note(void *context, const char *text)
{
    (void)context;
    snprintf(said + strlen(said), sizeof said - strlen(said), "%s\n", text);
}

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

static const char bar[] = "dp = 1 cm\nend_time = 1\n[solid bar]\nshape = box 0, 0, 0.2, 0.04\n"
                          "density = 1000\nyoung = 1e6\npoisson = 0\nartificial_viscosity = 0\n";
static const char water[] = "dp = 1 cm\nend_time = 1\n[fluid w]\nshape = box 0, 0, 0.1, 0.1\n"
                            "sound_speed = 20\n[output]\nledger_interval = 0.1\n"
                            "snapshot_interval = 0.1\nprobe_interval = 0.1\n"
                            "[probe p]\nquantity = pressure\npoint = 0.05, 0.05\n";

static void warn_of(const char *text, const char *set)
{
    rig_open(&rig, text, set, NULL);
    struct diag d = {.warn = note};
    said[0] = '\0';
    rig_steps(&rig, 1, 1);
    check_simulation(&rig.sim, &d);
}

/* Damping by eta = E t of modes of frequency w: a step of dt is stable to (w dt)^2 + 2 zeta w dt =
 * 4, the share of the undamped 2/w falls with t. Said from a half on. */
static void test_damping(void)
{
    char set[64], want[100];
    warn_of(bar, NULL);
    TEST_ASSERT_EQUAL_STRING("", said);
    const double free_step = rig.sim.solid.stable_step;
    bool below = false, above = false;
    for (double t = 1e-6; t < 1; t *= 1.3) {
        snprintf(set, sizeof set, "bar.damping_time=%.6g", t);
        warn_of(bar, set);
        const double share = rig.sim.solid.stable_step / free_step;
        if (fabs(share - 0.5) < 0.02) continue;
        snprintf(want, sizeof want,
                 "--set: [solid bar] damping_time = %g s makes the steps of the solid ", t);
        TEST_ASSERT_EQUAL_INT_MESSAGE(share < 0.5, said[0] != '\0', want);
        if (share < 0.5) {
            TEST_ASSERT_EQUAL_STRING_LEN(want, said, strlen(want));
            TEST_ASSERT_DOUBLE_WITHIN(0.02 / share, 1 / share, strtod(said + strlen(want), NULL));
        }
        below |= share > 0.3 && share < 0.48;
        above |= share > 0.52 && share < 0.7;
    }
    TEST_ASSERT_TRUE(below && above);
}

/* Laminar viscosity bounds the step by 0.125 M h^2/nu; sound alone by C h/c0. */
static void test_bounds(void)
{
    char set[64], want[200];
    warn_of(water, NULL);
    const double h = rig.sim.fluid.k.h, sound = rig.sim.scene->numerics.cfl * h / 20,
                 M = rig.sim.fluid.k.second_moment;
    for (int much = 0; much < 2; much++) {
        const double share = much ? 0.11 : 0.09;
        snprintf(set, sizeof set, "w.laminar_viscosity=%.9g", 0.125 * M * h * h / (share * sound));
        warn_of(water, set);
        TEST_ASSERT_EQUAL_INT_MESSAGE(!much, said[0] != '\0', said);
        if (much) continue;
        snprintf(want, sizeof want,
                 "--set: laminar_viscosity limits the time step to %.3g s, while sound waves would "
                 "allow 11.1 "
                 "times",
                 share * sound);
        TEST_ASSERT_EQUAL_STRING_LEN(want, said, strlen(want));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, "a smaller laminar_viscosity may help"), said);
    }
    snprintf(set, sizeof set, "numerics.fixed_step=%.9g", 0.05 * sound);
    warn_of(water, set);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, "would allow 20 times as much"), said);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, "a larger fixed_step may help"), said);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_damping);
    RUN_TEST(test_bounds);
    return UNITY_END();
}
