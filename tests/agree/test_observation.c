/* SPDX-License-Identifier: MIT
 * Observation of a run must not change it: ledgers, hashes and checkpoints between two steps, and
 * output times that nearly meet. */
#include "rig.h"
#include "time/energy.h"

#include "unity.h"
#include "geometry/scene_points.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

/* A piston that speeds up, so that where the wall stands depends on the time it is asked for. */
static const char piston[] = "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81 m/s^2\n"
                             "[fluid water]\nshape = box 0, 0, 0.3, 0.2\nsound_speed = 20\n"
                             "artificial_viscosity = 0.1\nsurface = 0.2\n"
                             "[wall tank]\nshape = box -0.1, -0.04, 0.6, 0\n"
                             "[wall piston]\nshape = box -0.04, 0, 0, 0.3\nmotion = push\n"
                             "[motion push]\nx = t*(0.5 + 15*t)\n"
                             "[domain]\nlower = -0.3, -0.2\nupper = 0.8, 0.6\n";

static uint64_t hash_after(const char *integrator, const char *scheme, bool look)
{
    struct rig rig = {0};
    rig_open(&rig, piston, integrator, scheme, NULL);
    struct diag d = {0};
    for (int k = 0; k < 500; k++) {
        TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_step(&rig.sim, 1, &d));
        if (look) simulation_ledger(&rig.sim);
    }
    TEST_ASSERT_TRUE(rig.sim.state.sorts > 2);
    const uint64_t hash = simulation_hash(&rig.sim);
    rig_close(&rig);
    return hash;
}

static void test_ledgers_leave_no_trace(void)
{
    static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                              "integrator=leapfrog"};
    static const char *const schemes[] = {"scheme=paper", "scheme=standard"};
    for (size_t k = 0; k < COUNT_OF(integrators); k++)
        for (size_t m = 0; m < COUNT_OF(schemes); m++)
            TEST_ASSERT_EQUAL_HEX64(hash_after(integrators[k], schemes[m], false),
                                    hash_after(integrators[k], schemes[m], true));
}

/* Two output times 1e-12 s apart make a tiny step, which is no collapse. */
static void test_output_times_that_nearly_meet(void)
{
    static const char block[] =
        "dp = 1 cm\nend_time = 1\n"
        "[solid bar]\nshape = box 0, 0, 0.2, 0.1\nclamp = box 0, 0, 0.04, 0.1\n"
        "density = 1000\nyoung = 1 MPa\npoisson = 0.3\n";
    struct rig rig = {0};
    rig_open(&rig, block, NULL);
    struct diag d = {0};
    const double times[] = {1e-3, 1e-3 + 1e-12, 2e-3};
    for (int k = 0; k < 3; k++)
        while (rig.sim.state.time < times[k])
            TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, simulation_step(&rig.sim, times[k], &d), d.text);
    rig_close(&rig);
}

/* Walls that the fluid has left keep nothing of it, least of all across a restart. */
static void test_walls_forget_the_fluid(void)
{
    struct rig rig = {0};
    rig_open(&rig, piston, NULL);
    struct particles *const fluid = &rig.sim.particles[KIND_FLUID], *const wall =
                                                                        &rig.sim
                                                                             .particles[KIND_WALL];
    double top = 0;
    for (int64_t i = 0; i < wall->n; i++) top = fmax(top, wall->p[i]);
    TEST_ASSERT_TRUE(top > 1000);
    for (int64_t i = 0; i < fluid->n; i++) {
        fluid->x[i] += 0.3;
        fluid->y[i] += 0.3;
    }
    rig_sort(&rig);
    struct diag d = {0};
    TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_resume(&rig.sim, &d));
    for (int64_t i = 0; i < wall->n; i++) TEST_ASSERT_TRUE(wall->p[i] == 0 && wall->dens[i] == 0);
    rig_close(&rig);
}

/* A step of the solid that would go thousands of times into the fluid's is refused, not counted in
 * an int. The remedy names what may cause it. */
static void refuses_ratio(const char *young, const char *more)
{
    char text[600];
    snprintf(text, sizeof text,
             "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81 m/s^2\n"
             "[fluid water]\nshape = box 0, 0, 0.2, 0.1\nsound_speed = 20\n"
             "[solid plate]\nshape = box 0, -0.04, 0.2, 0\nclamp = box 0, -0.04, 0.02, 0\n"
             "density = 1000\npoisson = 0.3\nyoung = %s\n%s",
             young, more);
    struct scene scene;
    struct simulation sim;
    struct diag d = {0};
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, scene_load_text(&scene, text, "plate.cfg", 0, NULL, &d),
                                  d.text);
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, simulation_create(&sim, &scene, &d));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(d.text,
                                        "sub-steps per fluid step, more than the limit of 10000"),
                                 d.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(d.text, ". Reduce young or damping_time of the [solid], or fixed_step"), d.text);
    scene_free(&scene);
}

static void test_absurd_ratio_of_steps_is_refused(void)
{
#define EXPLICIT "[numerics]\nsolid_steps = explicit\n"
    refuses_ratio("1e15 Pa", EXPLICIT);
    refuses_ratio("1 MPa", EXPLICIT "fixed_step = 10\n");
    refuses_ratio("1 MPa", "damping_time = 10\n" EXPLICIT);
#undef EXPLICIT
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_ledgers_leave_no_trace);
    RUN_TEST(test_walls_forget_the_fluid);
    RUN_TEST(test_absurd_ratio_of_steps_is_refused);
    RUN_TEST(test_output_times_that_nearly_meet);
    return UNITY_END();
}
