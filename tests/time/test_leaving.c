/* SPDX-License-Identifier: MIT
 * Bodies that leave the domain: one sentence each, once no particle of them is in a cell. */
#include "rig.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

static struct rig rig;
static char warning[600];
static int warnings;

static void note(void *context, const char *text)
{
    (void)context;
    if (!strstr(text, "has left the domain")) return;
    warnings++;
    snprintf(warning, sizeof warning, "%s", text);
}

void setUp(void)
{
    rig_one_thread();
    warnings = 0;
}
void tearDown(void) { rig_close(&rig); }

/* A little water at rest in the middle of a domain of 1 m, no weight. */
#define WATER                                                                     \
    "dp = 2 cm\nend_time = 10\n[fluid w]\nshape = box -0.06, -0.06, 0.06, 0.06\n" \
    "sound_speed = 10\n[domain]\nlower = -0.5, -0.5\nupper = 0.5, 0.5\n"
#define RIGID(v) "[rigid b]\nshape = box 0.2, 0.2, 0.3, 0.3\nmass = 1\nvelocity = " v "\n"
#define SOLID(v)                                                               \
    "[solid b]\nshape = box 0.2, 0.2, 0.3, 0.3\ndensity = 1000\nyoung = 1e5\n" \
    "poisson = 0.3\nvelocity = " v "\n"
#define BEAM(rest)                                                                    \
    "[beam b]\nshape = polyline: 0.2, 0.2; 0.4, 0.2\nyoung = 1e8\nthickness = 5 mm\n" \
    "density = 1000\n" rest

static void run(const char *text, double time)
{
    rig_open(&rig, text, NULL);
    rig.diag = (struct diag){.warn = note};
    rig_run(&rig, time);
}

/* They move by 0.6 m, further than the last cells, after 0.3 s. */
static void test_each_body_is_named_once(void)
{
    static const struct {
        const char *text, *said;
    } left[] = {
        {WATER RIGID("0, 2"), "[rigid b] has left the domain by its upper side, and takes no part"},
        {WATER RIGID("-4, 0"), "[rigid b] has left the domain by its left side"},
        {WATER SOLID("2, 0"), "[solid b] has left the domain by its right side"},
        {WATER BEAM("velocity = 0, -4\n"), "[beam b] has left the domain by its lower side"},
    };
    for (size_t k = 0; k < COUNT_OF(left); k++) {
        warnings = 0;
        run(left[k].text, 0.1);
        TEST_ASSERT_EQUAL_INT(0, warnings);
        rig_run(&rig, 0.5);
        TEST_ASSERT_EQUAL_INT_MESSAGE(1, warnings, left[k].text);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warning, left[k].said), warning);
    }
}

/* Nor what is still in part inside, what comes back through a periodic side, or a driven wall. */
static void test_others_are_not(void)
{
    run(WATER BEAM("clamp = 0.2, 0.2\nvelocity = 0, 20*(x - 0.2)\n"), 0.1);
    run(WATER "periodic = x\n" SOLID("4, 0"), 0.5);
    run(WATER "[wall b]\nshape = box 0.2, 0.2, 0.3, 0.3\nmotion = m\n"
              "[motion m]\ny = 4*t\n",
        0.5);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, warnings, warning);
}

/* A spring brings a body back. Fluid feels it again, since it is in cells. */
static void test_a_body_that_comes_back_is_in_cells(void)
{
    run(WATER RIGID("0, 8") "[spring s]\nbody = b\nfrom = 0.25, 0.25\nto = 0.25, 0\n"
                            "stiffness = 100\n",
        0.15);
    TEST_ASSERT_EQUAL_INT(1, warnings);
    const struct particles *const p = &rig.sim.particles[KIND_WALL];
    TEST_ASSERT_EQUAL_INT(-1, p->cell[0]);
    rig_run(&rig, 0.31);
    for (int64_t i = 0; i < p->n; i++) TEST_ASSERT_GREATER_OR_EQUAL_INT(0, p->cell[i]);
}

/* A tub of 0.36 m that carries water by 0.28 m: the default domain holds its path, as a solid's. */
static void test_the_default_domain_counts_bodies(void)
{
    static const char *const tub[] = {
        "[rigid tub]\nmass = 50\nshape = polyline thickness -0.08: ",
        "[beam tub]\nthickness = 5 mm\nyoung = 2e11\ndensity = 8000\nshape = polyline: ",
    };
    for (size_t k = 0; k < COUNT_OF(tub); k++) {
        char text[600];
        snprintf(text, sizeof text,
                 "dp = 2 cm\nend_time = 1\n[fluid w]\nshape = box 0, 0, 0.2, 0.2\n"
                 "sound_speed = 10\nvelocity = 0.7, 0\n%s0, 0.36; 0, 0; 0.2, 0; 0.2, 0.36\n"
                 "velocity = 0.7, 0\n",
                 tub[k]);
        run(text, 0.4);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, rig.sim.state.lost, tub[k]);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, warnings, warning);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_body_is_named_once);
    RUN_TEST(test_others_are_not);
    RUN_TEST(test_a_body_that_comes_back_is_in_cells);
    RUN_TEST(test_the_default_domain_counts_bodies);
    return UNITY_END();
}
