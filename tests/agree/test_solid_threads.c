/* SPDX-License-Identifier: MIT
 * Several threads step a solid with the bits of one: every form of the laws, bodies that are
 * joined, a structure in water, and pushes from outside. */
#include "rig.h"
#include "unity.h"

#include <stdio.h>

#define BAR                                                                    \
    "[solid bar]\nshape = box 0, 0, 1.5, 0.08\nclamp = box 0, 0, 0.02, 0.08\n" \
    "density = 1100\nyoung = 2e6\npoisson = 0.4\nvelocity = 0, 20 s^-1*max(x, 0)\n"
static const char bar[] = "dp = 1 cm\nend_time = 1\n" BAR;

/* Upright, of two materials, with viscosities of their own. */
static const char joined[] =
    "dp = 1 cm\nend_time = 1\n"
    "[solid mast]\nshape = box 0, 0, 0.08, 0.9\nclamp = box 0, 0, 0.08, 0.02\ndensity = 1100\n"
    "young = 2e6\npoisson = 0.4\nvelocity = 20 s^-1*max(y, 0), 0\nartificial_viscosity = 0.05\n"
    "[solid top]\nshape = box 0, 0.9, 0.08, 1.6\ndensity = 2700\nyoung = 5e6\npoisson = 0.3\n"
    "velocity = 20 s^-1*y, 0\nartificial_viscosity = 0.02\njoined = mast\n";

static const char water[] =
    "dp = 5 mm\nend_time = 1\ngravity = 0, -9.81\n"
    "[fluid water]\nshape = box 0, 0, 0.1, 0.3\nsound_speed = 20\nsurface = 0.3\n"
    "[wall bed]\nshape = box -0.02, -0.02, 0.2, 0\n"
    "[solid gate]\nshape = box 0.1, 0, 0.12, 0.8\nclamp = box 0.1, 0.75, 0.12, 0.8\n"
    "density = 1100\nyoung = 4e7\npoisson = 0.4\n[contact none]\nenabled = off\n";

static struct rig rig;
static int threads_before;

void setUp(void) { threads_before = thread_count(); }

void tearDown(void)
{
    thread_use(threads_before);
    rig_close(&rig);
}

/* The hash after some steps. */
static uint64_t run(const char *text, int threads, const char *set, const char *other)
{
    thread_use(threads);
    rig_open(&rig, text, set, other, NULL);
    rig.sim.solid.threads = threads;
    rig_steps(&rig, 20, 1);
    TEST_ASSERT_EQUAL_INT(threads, rig.sim.solid.threads);
    return simulation_hash(&rig.sim);
}

static void compare(const char *text, int most, const char *set, const char *other)
{
    const uint64_t expected = run(text, 1, set, other);
    for (int threads = 2; threads <= most; threads++) {
        char what[160];
        snprintf(what, sizeof what, "%d threads, %s, %s", threads, set, other);
        TEST_ASSERT_EQUAL_HEX64_MESSAGE(expected, run(text, threads, set, other), what);
    }
}

static void test_default_laws(void)
{
    compare(bar, 5, "precision=mixed", "bar.hourglass=50");
    compare(bar, 3, "precision=double", "bar.hourglass=50");
}

static void test_printed_laws(void)
{
    compare(bar, 3, "bar.hourglass_form=printed", "bar.gradient=linear");
    compare(bar, 3, "precision=double", "bar.hourglass_form=printed");
    compare(bar, 3, "bar.hourglass=0", "bar.viscosity_form=printed");
}

static void test_damped(void)
{
    compare(bar, 3, "bar.damping_time=1 ms", "precision=mixed");
    compare(bar, 2, "bar.damping_time=1 ms", "bar.hourglass_form=printed");
}

/* Neighbours three columns away. */
static void test_a_wide_kernel(void)
{
    compare(bar, 3, "numerics.h_over_dp=1.8", "precision=mixed");
}

static void test_joined_bodies(void) { compare(joined, 4, "precision=mixed", "title=mast"); }

static void test_structure_in_water(void)
{
    compare(water, 3, "integrator=leapfrog", "numerics.multirate=on");
    compare(water, 2, "integrator=symplectic", "numerics.multirate=on");
}

/* The matrix is of one thread, its forces of all. */
static void test_implicit_steps(void)
{
    compare(bar, 4, "numerics.solid_steps=implicit", "numerics.fixed_step=0.5 ms");
    compare(joined, 3, "numerics.solid_steps=implicit", "numerics.fixed_step=0.5 ms");
    compare(water, 3, "integrator=leapfrog", "numerics.solid_steps=implicit");
}

/* Pushes from outside, numbers of sub-steps, and results read between them. */
static uint64_t push(int threads)
{
    thread_use(threads);
    rig_open(&rig, bar, "precision=mixed", NULL);
    struct solid *const solid = &rig.sim.solid;
    struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    solid->threads = threads;
    double force[2][1200];
    TEST_ASSERT_TRUE(particles->n <= 1200);
    for (int64_t i = 0; i < particles->n; i++) force[0][i] = force[1][i] = (double)i;
    for (int round = 0; round < 4; round++) {
        solid->centred = round % 2;
        solid_advance(solid, particles, rig.sim.dt_solid, 7);
        solid->force_hook = &(struct force_hook){.ax = force[0], .ay = force[1]};
        solid_advance(solid, particles, rig.sim.dt_solid, 5);
        solid->force_hook = NULL;
        if (round == 2) simulation_hash(&rig.sim);
    }
    solid_write_stress(solid, particles);
    uint64_t shown = HASH_START;
    const double *const fields[] = {particles->Uxx, particles->Uyx, particles->Pxy, particles->sx,
                                    particles->sy};
    for (int k = 0; k < (int)COUNT_OF(fields); k++)
        shown = hash_bytes(shown, fields[k], (size_t)particles->n * sizeof(double));
    return simulation_hash(&rig.sim) ^ shown;
}

static void test_pushes_from_outside(void)
{
    const uint64_t expected = push(1);
    TEST_ASSERT_EQUAL_HEX64(expected, push(2));
    TEST_ASSERT_EQUAL_HEX64(expected, push(4));
}

/* Below 2048 particles one thread steps a solid, from there on all do. */
static void test_small_bodies_have_one_thread(void)
{
    static const char block[] = "dp = 1 cm\nend_time = 1\n[solid block]\n"
                                "shape = box 0, 0, length, 0.32\nclamp = box 0, 0, 0.32, 0.02\n"
                                "density = 1100\nyoung = 2e6\npoisson = 0.4\n"
                                "[constants]\nlength = 0.63\n";
    thread_use(3);
    rig_open(&rig, block, NULL);
    TEST_ASSERT_EQUAL_INT(1, rig.sim.solid.threads);
    rig_open(&rig, block, "length=0.64", NULL);
    TEST_ASSERT_EQUAL_INT(3, rig.sim.solid.threads);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_default_laws);
    RUN_TEST(test_printed_laws);
    RUN_TEST(test_damped);
    RUN_TEST(test_a_wide_kernel);
    RUN_TEST(test_joined_bodies);
    RUN_TEST(test_structure_in_water);
    RUN_TEST(test_implicit_steps);
    RUN_TEST(test_pushes_from_outside);
    RUN_TEST(test_small_bodies_have_one_thread);
    return UNITY_END();
}
