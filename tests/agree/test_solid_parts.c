/* SPDX-License-Identifier: MIT
 * A solid that is stepped in parts, one by each thread, has the bits of the whole: every form of the laws,
 * bodies that are joined, a structure in water, and changes between parts and whole. */
#include "rig.h"
#include "solid/parts.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

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

/* The hash after some steps; fails unless several threads stepped parts. */
static uint64_t run(const char *text, int threads, const char *set, const char *other)
{
    thread_use(threads);
    rig_open(&rig, text, set, other, NULL);
    rig_steps(&rig, 20, 1);
    TEST_ASSERT_EQUAL_INT(threads, rig.sim.solid.threads);
    TEST_ASSERT_TRUE(threads == 1 || rig.sim.solid.part[threads - 1].sequence > 100);
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

/* Neighbours three columns away, which a part has to copy. */
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

/* The nearest particles of two bodies, one in each part, are 2.002 h apart to the last bit: whether that is
 * within reach, both parts have to find the same. */
static void test_particles_at_the_edge_of_reach(void)
{
    static const char pair[] =
        "dp = 0.01\nend_time = 1\n[numerics]\nh_over_dp = 1.4985014985014957\n"
        "[solid a]\nshape = box 0, 0, 0.33, 0.08\nclamp = box 0, 0, 0.02, 0.08\n"
        "density = 1100\nyoung = 2e6\npoisson = 0.4\nartificial_viscosity = 0.05\n"
        "[solid b]\nlike = a\nshape = box 0.35000000000000003, 0, 0.68, 0.08\n"
        "clamp = box 0.35000000000000003, 0, 0.37, 0.08\n";
    compare(pair, 2, "a.velocity=0, 1", "precision=mixed");
}

/* A body as wide as it is long: too many copies. */
static void test_parts_that_do_not_pay(void)
{
    static const char block[] = "dp = 1 cm\nend_time = 1\n[solid block]\n"
                                "shape = box 0, 0, 0.32, 0.3\nclamp = box 0, 0, 0.32, 0.02\n"
                                "density = 1100\nyoung = 2e6\npoisson = 0.4\n";
    thread_use(5);
    rig_open(&rig, block, NULL);
    TEST_ASSERT_EQUAL_INT(5, rig.sim.solid.threads);
    TEST_ASSERT_NULL(rig.sim.solid.part);
}

/* Sub-steps too few for parts, pushes from outside and looks at the state between those that are in parts. */
static uint64_t change_over(int threads)
{
    thread_use(threads);
    rig_open(&rig, bar, "precision=mixed", NULL);
    struct solid *const s = &rig.sim.solid;
    struct particles *const p = &rig.sim.kind[KIND_SOLID];
    double push[2][1200];
    TEST_ASSERT_TRUE(p->n <= 1200);
    for (int64_t i = 0; i < p->n; i++) push[0][i] = push[1][i] = (double)i;
    for (int round = 0; round < 4; round++) {
        solid_advance(s, p, rig.sim.dt_solid, 7, round % 2);
        TEST_ASSERT_TRUE(s->in_parts == (threads > 1));
        solid_advance(s, p, rig.sim.dt_solid, 2, round % 2);
        TEST_ASSERT_FALSE(s->in_parts);
        s->external[0] = push[0];
        s->external[1] = push[1];
        solid_advance(s, p, rig.sim.dt_solid, 5, round % 2);
        TEST_ASSERT_FALSE(s->in_parts);
        s->external[0] = s->external[1] = NULL;
        if (round == 2) simulation_hash(&rig.sim);
    }
    solid_advance(s, p, rig.sim.dt_solid, 7, false);
    solid_show(s, p);
    double sum = 0; /* what is shown, which the hash finds anew */
    for (int64_t i = 0; i < p->n; i++)
        sum += (double)i * (p->Uxx[i] - p->Uyx[i]) + p->Pxy[i] + p->sx[i] - (double)i * p->sy[i];
    TEST_ASSERT_TRUE(sum != 0);
    solid_advance(s, p, rig.sim.dt_solid, 7, false);
    simulation_refresh(&rig.sim); /* which evaluates the whole, but no accelerations */
    for (int64_t i = 0; i < p->n; i++) sum += p->sx[i] - (double)i * p->sy[i];
    uint64_t shown;
    memcpy(&shown, &sum, sizeof shown);
    return simulation_hash(&rig.sim) ^ shown;
}

static void test_parts_and_whole_in_turn(void)
{
    const uint64_t expected = change_over(1);
    TEST_ASSERT_EQUAL_HEX64(expected, change_over(2));
    TEST_ASSERT_EQUAL_HEX64(expected, change_over(4));
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
    RUN_TEST(test_particles_at_the_edge_of_reach);
    RUN_TEST(test_parts_that_do_not_pay);
    RUN_TEST(test_parts_and_whole_in_turn);
    return UNITY_END();
}
