/* SPDX-License-Identifier: MIT
 * The same bits on any number of threads: fluid, walls that move, a structure, both integrators,
 * both precisions, with and without sub-steps. */
#define _DEFAULT_SOURCE /* syscall */
#include "rig.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

static const char scene[] =
    "dp = 5 mm\nend_time = 1\ngravity = 0, -9.81\n[numerics]\nskin = 0.02\n"
    "[fluid water]\nshape = box 0, 0, 0.2, 0.2\nsound_speed = 20\nsurface = 0.2\n"
    "velocity = 8*y, 0\nartificial_viscosity = 0.05\ndensity_diffusion = 0.1\n"
    "[wall tank]\nshape = polyline thickness -0.02: 0, 0; 0.5, 0; 0.5, 0.25\n"
    "[wall piston]\nshape = box -0.02, 0, 0, 0.25\nmotion = push\n"
    "[motion push]\nx = t*(0.2 + 3*t)\n"
    "[solid gate]\nshape = box 0.2, 0, 0.22, 0.25\nclamp = box 0.2, 0.22, 0.22, 0.25\n"
    "density = 1100\nyoung = 4e6\npoisson = 0.4\n";

static struct rig rig;
static int threads_before;

void setUp(void) { threads_before = thread_count(); }

void tearDown(void)
{
    thread_use(threads_before);
    rig_close(&rig);
}

static uint64_t run(int threads, const char *integrator, const char *precision, const char *rate)
{
    thread_use(threads);
    rig_open(&rig, scene, integrator, precision, rate, NULL);
    rig_steps(&rig, 50, 1);
    return simulation_hash(&rig.sim);
}

static void compare(const char *integrator, const char *precision, const char *rate)
{
    const uint64_t expected = run(1, integrator, precision, rate);
    /* The run sorts more than once, and sub-steps where it is asked to. */
    TEST_ASSERT_TRUE(rig.sim.state.sorts > 1);
    TEST_ASSERT_TRUE(rig.sim.fluid.n_near_fluid[KIND_SOLID] > 8);
    TEST_ASSERT_TRUE(!(rig.sim.effects & FX_MULTIRATE) || rig.sim.substeps > 1);
    const int threads[] = {1, 2, 3, 8};
    for (int k = 0; k < 4; k++) {
        char text[128];
        snprintf(text, sizeof text, "%d threads, %s, %s, %s", threads[k], integrator, precision,
                 rate);
        TEST_ASSERT_EQUAL_HEX64_MESSAGE(expected, run(threads[k], integrator, precision, rate),
                                        text);
    }
}

static void test_symplectic_mixed_with_substeps(void)
{
    compare("integrator=symplectic", "precision=mixed", "numerics.multirate=on");
}

static void test_symplectic_double_with_one_rate(void)
{
    compare("integrator=symplectic", "precision=double", "numerics.multirate=off");
}

static void test_verlet_mixed_with_one_rate(void)
{
    compare("integrator=verlet", "precision=mixed", "numerics.multirate=off");
}

static void test_verlet_double_with_substeps(void)
{
    compare("integrator=verlet", "precision=double", "numerics.multirate=on");
}

static void test_leapfrog_mixed_with_substeps(void)
{
    compare("integrator=leapfrog", "precision=mixed", "numerics.multirate=on");
}

/* A solid alone: its packs are cut the same way whoever sweeps them. */
static void test_lone_solid(void)
{
    static const char lone[] =
        "dp = 5 mm\nend_time = 1\ngravity = 0, -9.81\n"
        "[solid bar]\nshape = box 0, 0, 0.37, 0.06\nclamp = box 0, 0, 0.05, 0.06\n"
        "density = 1000\nyoung = 2e6\npoisson = 0.4\n";
    uint64_t expected = 0;
    for (int integrator = 0; integrator < 2; integrator++) {
        const int threads[] = {1, 2, 3, 8};
        for (int k = 0; k < 4; k++) {
            thread_use(threads[k]);
            rig_open(&rig, lone, integrator ? "integrator=verlet" : "integrator=symplectic", NULL);
            rig_run(&rig, 0.02);
            const uint64_t hash = simulation_hash(&rig.sim);
            if (k == 0) expected = hash;
            TEST_ASSERT_EQUAL_HEX64(expected, hash);
        }
    }
}

/* Particles that are made and ended: their numbers and order, too. */
static void test_open_boundaries(void)
{
    static const char open_ends[] =
        "dp = 5 mm\nend_time = 1\n"
        "[fluid water]\nshape = box 0, 0, 0.2, 0.1\nsound_speed = 20\nvelocity = 1, 0\n"
        "density_diffusion = 0.1\nshifting = 2\n"
        "[wall bed]\nshape = box -0.03, -0.02, 0.23, 0\nshape = box -0.03, 0.1, 0.23, 0.12\n"
        "[inflow in]\nfrom = 0, 0.1\nto = 0, 0\nspeed = 1 + 0.5*sin(100*t) + 20*y*(0.1 - y)\n"
        "[outflow out]\nfrom = 0.2, 0\nto = 0.2, 0.1\npressure = 1000*sin(90*t)\nabsorb = 0.1\n";
    uint64_t expected = 0;
    const int threads[] = {1, 2, 3, 8};
    for (int k = 0; k < 4; k++) {
        thread_use(threads[k]);
        rig_open(&rig, open_ends, NULL);
        rig_steps(&rig, 150, 1);
        TEST_ASSERT_TRUE(rig.sim.open.count[0][OPEN_ENTERED] > 60);
        TEST_ASSERT_TRUE(rig.sim.open.count[1][OPEN_LEFT] > 40);
        const uint64_t hash = simulation_hash(&rig.sim);
        if (k == 0) expected = hash;
        TEST_ASSERT_EQUAL_HEX64(expected, hash);
    }
}

/* Fluid that goes round through periodic sides, over a bed that it sticks to, with a wall that
 * drifts through them; gradients, shifting and what else has sums of its own. */
static void test_periodic_sides(void)
{
    static const char round[] =
        "dp = 5 mm\nend_time = 1\ngravity = 3, -9.81\n[numerics]\nskin = 0.02\nsides = one\n"
        "[domain]\nlower = 0, -0.02\nupper = 0.2, 0.2\nperiodic = x\n"
        "[fluid water]\nshape = box 0, 0, 0.2, 0.1\nminus = box 0.1, 0, 0.12, 0.05\n"
        "sound_speed = 20\nsurface = 0.1\nartificial_viscosity = 0.05\nvelocity = 1 + 8*y, 0\n"
        "laminar_viscosity = 1e-3\ndensity_diffusion = 0.1\ndiffusion_form = antuono\n"
        "shifting = 2\ntensile_control = 0.2\nwall_repulsion = 0.1\n"
        "[wall bed]\nshape = box 0, -0.02, 0.2, 0\nslip = none\n"
        "[wall sill]\nshape = box 0.1, 0, 0.12, 0.05\nmotion = drift\n"
        "[motion drift]\nx = 1.5*t\n";
    uint64_t expected = 0;
    const int threads[] = {1, 2, 3, 8};
    for (int k = 0; k < 4; k++) {
        thread_use(threads[k]);
        rig_open(&rig, round, NULL);
        rig_steps(&rig, 150, 1);
        const uint64_t hash = simulation_hash(&rig.sim);
        if (k == 0) expected = hash;
        TEST_ASSERT_EQUAL_HEX64(expected, hash);
    }
    TEST_ASSERT_TRUE(rig.sim.state.sorts > 5);
    TEST_ASSERT_TRUE(rig.sim.state.periodic_energy > 0);
    TEST_ASSERT_EQUAL_INT64(0, rig.sim.state.lost);
}

#if defined _OPENMP && defined __linux__

enum { TEAM = 8 };

static void find_threads(long id[TEAM])
{
    memset(id, 0, TEAM * sizeof *id);
#pragma omp parallel num_threads(TEAM)
    id[thread_index()] = syscall(SYS_gettid);
}

/* libgomp ends the threads that a smaller team leaves over, and the next large one waits for new
 * ones. */
static void test_threads_outlive_the_steps(void)
{
    static const char *const sizes[] = {"dp=5 mm", "dp=2.5 mm"};
    for (size_t k = 0; k < COUNT_OF(sizes); k++) {
        long before[TEAM], after[TEAM];
        thread_use(TEAM);
        rig_open(&rig, scene, "integrator=leapfrog", sizes[k], NULL);
        find_threads(before);
        rig_steps(&rig, 5, 1);
        find_threads(after);
        for (int t = 0; t < TEAM; t++) TEST_ASSERT_EQUAL_INT64(before[t], after[t]);
        rig_close(&rig);
    }
}

#else

static void test_threads_outlive_the_steps(void)
{
    TEST_IGNORE_MESSAGE("no threads, or no way to tell them apart");
}

#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_threads_outlive_the_steps);
    RUN_TEST(test_symplectic_mixed_with_substeps);
    RUN_TEST(test_symplectic_double_with_one_rate);
    RUN_TEST(test_verlet_mixed_with_one_rate);
    RUN_TEST(test_verlet_double_with_substeps);
    RUN_TEST(test_leapfrog_mixed_with_substeps);
    RUN_TEST(test_lone_solid);
    RUN_TEST(test_open_boundaries);
    RUN_TEST(test_periodic_sides);
    return UNITY_END();
}
