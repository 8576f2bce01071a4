/* SPDX-License-Identifier: MIT
 * Mass damping against exact decays (T-77); and the search for rest (T-78): the elongation of
 * a hanging bar by hand, no motion afterwards, the clock at zero, the bits of a search that
 * was continued. */
#include "output/checkpoint.h"
#include "rig.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define HEAD "dp = 1 cm\nend_time = 1\nprecision = double\n"
#define BODY "density = 1000\nyoung = 1e6\npoisson = 0\nlaw = svk\n"
static const char loose[] =
    HEAD "[solid b]\nshape = box 0, 0, 0.06, 0.04\nmass_damping = 20\n" BODY;
static const char hanging[] =
    HEAD "gravity = 0, -9.81\n[solid b]\nshape = box 0, 0, 0.04, 0.4\n"
         "clamp = box 0, 0.38, 0.04, 0.4\nartificial_viscosity = 0\n" BODY "[relax]\n";
static const char dam[] = "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"
                          "[fluid w]\nshape = box 0, 0, 0.1, 0.1\nsurface = 0.1\nmax_speed = 1\n"
                          "artificial_viscosity = 0.02\n"
                          "[wall tank]\nshape = polyline thickness -0.04: 0, 0.2; 0, 0; 0.1, 0\n"
                          "[solid gate]\nshape = box 0.1, -0.04, 0.14, 0.2\n"
                          "clamp = box 0.1, -0.04, 0.14, 0\n"
                          "density = 1100\nyoung = 1e6\npoisson = 0.4\n[relax]\n";

/* A search that has begun is not by Newton's method. */
static const double kinetic = 1e-300;

static struct rig rig;
static struct particles *p;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

/* v' = -beta v without any other force. */
static void test_motion_dies_away(void)
{
    const char *const integrators[] = {"integrator=leapfrog", "integrator=symplectic"};
    for (int k = 0; k < 2; k++) {
        RIG_OPEN_SOLID(loose, integrators[k]);
        for (int64_t i = 0; i < p->n; i++) p->vx[i] = 2;
        rig_run(&rig, 0.1);
        for (int64_t i = 0; i < p->n; i++) {
            assert_near(2e-3, 2 * exp(-20 * 0.1), p->vx[i], "vx");
            assert_near(1e-9, 0, p->vy[i], "vy");
        }
    }
}

/* One evaluation by hand: -20/s times the velocity of each particle, whatever its neighbours do. */
static void test_force_by_hand(void)
{
    RIG_OPEN_SOLID(loose, "b.artificial_viscosity=0");
    for (int64_t i = 0; i < p->n; i++) p->vx[i] = 3 + p->X[i], p->vy[i] = -0.5;
    solid_stress(&rig.sim.solid, p);
    solid_forces(&rig.sim.solid, p);
    for (int64_t i = 0; i < p->n; i++) {
        assert_near(1e-9, -20 * (3 + p->X[i]), p->sx[i], "sx");
        assert_near(1e-9, 10, p->sy[i], "sy");
    }
}

/* Damping that bounds the step: at that step a velocity dies out. */
static void test_step_holds_for_it(void)
{
    RIG_OPEN_SOLID(loose, "b.mass_damping=1e6");
    TEST_ASSERT_TRUE(rig.sim.dt_solid * 1e6 < 2);
    for (int64_t i = 0; i < p->n; i++) p->vx[i] = 1;
    rig_steps(&rig, 4, 1);
    for (int64_t i = 0; i < p->n; i++) assert_at_most(1e-3, fabs(p->vx[i]), "vx");
}

static double end_of_bar(void)
{
    double sum = 0;
    for (int64_t i = 0; i < p->n; i++) sum += p->X[i] < 0.01 && p->Y[i] < 0.01 ? p->uy[i] : 0;
    return sum;
}

/* The particle at Y = 5 mm sinks by rho g (L^2 - Y^2)/(2 E) below the clamp at 0.38 m, whose
 * particles' last row ends half a spacing further down: L = 0.38 m to 0.385 m. */
static void test_hanging_bar(void)
{
    RIG_OPEN_SOLID(hanging, "relax.tolerance=0.001");
    TEST_ASSERT_TRUE(rig.sim.state.seeks_rest);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, relax_to_rest(&rig.sim, &rig.diag), rig.diag.text);
    TEST_ASSERT_EQUAL_DOUBLE(0, rig.sim.state.time);
    const double found = end_of_bar();
    const double exact = -1000 * 9.81 * (0.38 * 0.38 - 0.005 * 0.005) / (2 * 1e6);
    assert_near(0.02 * -exact, exact, found, "elongation");
    double lowest = found, highest = found;
    for (int k = 1; k <= 40; k++) { /* a period of 4 L/c = 0.049 s */
        rig_run(&rig, 0.05 * k / 40);
        lowest = fmin(lowest, end_of_bar());
        highest = fmax(highest, end_of_bar());
    }
    assert_at_most(0.002 * -exact, highest - lowest, "motion after rest was found");
    const struct ledger end = simulation_ledger(&rig.sim);
    assert_at_most(1e-3 * end.elastic, fabs(end.dissipated), "energy since the start");
}

/* Loads are as at t = 0, moving walls and clamps at rest, and what is at rest is found at once. */
static void test_forces_are_those_at_the_start(void)
{
    for (int k = 0; k < 2; k++) { /* by Newton's method, and by motion */
        RIG_OPEN_SOLID(HEAD "[solid b]\nshape = box 0, 0, 0.2, 0.04\nclamp = box 0, 0, 0.02, 0.04\n"
                            "clamp_motion = m\n" BODY "[load l]\nbody = b\nforce = 0, 5\n"
                            "shape = box 0.19, 0, 0.2, 0.04\nhistory = sqrt(t)\n"
                            "[motion m]\nx = t\n[relax]\n",
                       NULL);
        if (k) rig.sim.state.time = kinetic;
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, relax_to_rest(&rig.sim, &rig.diag), rig.diag.text);
        TEST_ASSERT_FALSE(rig.sim.state.seeks_rest);
        TEST_ASSERT_TRUE(rig.sim.state.time == 0 && rig.sim.state.steps == 0);
        for (int64_t i = 0; i < p->n; i++) TEST_ASSERT_TRUE(p->ux[i] == 0 && p->uy[i] == 0);
        for (int64_t i = 0; i < p->n; i++) TEST_ASSERT_TRUE(p->vx[i] == (p->X[i] < 0.02 ? 1 : 0));
    }
}

/* Gravity, walls and clamps that follow the time are held while the clock of the search runs. */
static void test_beside_fluid_the_search_has_its_own_clock(void)
{
    static const char motion[] = "[motion m]\nx = 0.1*t\n";
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        char text[1500];
        snprintf(text, sizeof text, "%s%s", dam, motion);
        rig_open(&rig, text, "tank.motion=m", "gate.clamp_motion=m",
                 k ? "gravity=0, -9.81*(1 + t)" : "gravity=0, -9.81", NULL);
        for (int n = 0; n < 20; n++)
            TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, relax_step(&rig.sim, &rig.diag), rig.diag.text);
        TEST_ASSERT_TRUE(rig.sim.state.seeks_rest && rig.sim.state.time > 0);
        TEST_ASSERT_EQUAL_INT64(20, rig.sim.state.steps);
        for (int kind = KIND_WALL; kind < KIND_COUNT; kind++)
            for (int64_t i = 0; i < rig.sim.particles[kind].n; i++)
                if (kind == KIND_WALL || rig.sim.particles[kind].free[i] == 0) {
                    TEST_ASSERT_TRUE(rig.sim.particles[kind].vx[i] == 0);
                }
        hash[k] = particles_hash(&rig.sim.particles[KIND_FLUID], HASH_START);
    }
    TEST_ASSERT_EQUAL_HEX64(hash[0], hash[1]);
}

static void search(struct checkpoint *image, int steps)
{
    rig_open(&rig, dam, NULL);
    if (image->size > 0)
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, checkpoint_apply(image, &rig.sim, &rig.diag),
                                      rig.diag.text);
    while (steps-- > 0 && rig.sim.state.seeks_rest)
        TEST_ASSERT_EQUAL_INT(ERR_OK, relax_step(&rig.sim, &rig.diag));
}

static void test_a_search_can_be_continued(void)
{
    enum { STEPS = 100 };
    struct checkpoint image = {0};
    search(&image, 2 * STEPS);
    const uint64_t whole = simulation_hash(&rig.sim);
    search(&image, STEPS);
    TEST_ASSERT_TRUE(rig.sim.state.relax_peaks > 0);
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_capture(&image, &rig.sim, "case", "test", &rig.diag));
    search(&image, STEPS);
    checkpoint_free(&image);
    TEST_ASSERT_EQUAL_HEX64(whole, simulation_hash(&rig.sim));
}

/* Out of the domain, or through its periodic sides. */
static void test_fluid_that_nothing_holds(void)
{
#define FALLING \
    HEAD "gravity = 0, -9.81\n[fluid w]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\n[relax]\n"
    rig_open(&rig, FALLING, NULL);
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, relax_to_rest(&rig.sim, &rig.diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, ":5: [relax]: [fluid w] has moved further"),
                                 rig.diag.text);
    TEST_ASSERT_TRUE(rig.sim.guard.case_at_fault);
    rig_open(&rig, FALLING "[domain]\nlower = 0, 0\nupper = 0.1, 0.1\nperiodic = xy\n", NULL);
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, relax_to_rest(&rig.sim, &rig.diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, "the size of the domain, 0.141 m"),
                                 rig.diag.text);
#undef FALLING
}

/* Their times are not those of the run. */
static void test_guards_say_the_time_of_the_search(void)
{
    rig_open(&rig, dam, NULL);
    TEST_ASSERT_EQUAL_INT(ERR_OK, relax_step(&rig.sim, &rig.diag));
    rig.sim.particles[KIND_FLUID].vx[7] = (double)NAN;
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, relax_step(&rig.sim, &rig.diag));
    TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE("while rest is sought, after 0.0", rig.diag.text, 31,
                                         rig.diag.text);
}

static void test_no_rest_is_said(void)
{
    rig_open(&rig, hanging, "relax.limit=0.5", NULL);
    rig.sim.state.time = kinetic;
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, relax_to_rest(&rig.sim, &rig.diag));
    TEST_ASSERT_NOT_NULL(strstr(rig.diag.text, "no state of rest within"));
    rig_refuses(HEAD "[solid b]\nshape = box 0, 0, 0.06, 0.04\n" BODY
                     "[relax]\n[motion m]\nstart = -1\nx = t\n",
                "no motion may begin before t = 0");
    rig_refuses(HEAD "[solid b]\nshape = box 0, 0, 0.06, 0.04\n" BODY "[relax]\ntolerance = 0\n"
                     "limit = 3\n",
                "has no effect without RELAX");
}

/* A body that nothing holds is told of when it has fallen as far as the scene is large. */
static void test_a_body_that_falls_has_no_rest(void)
{
    char text[RELAX_TEXT];
    rig_open(&rig,
             HEAD "gravity = 0, -9.81\n[solid b]\nshape = box 0, 0, 0.06, 0.04\n" BODY
                  "[relax]\n[wall aside]\nshape = box 0.1, -0.02, 0.14, 0\n",
             NULL);
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, relax_to_rest(&rig.sim, &rig.diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, "[solid b] has moved further"),
                                 rig.diag.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, "nothing holds it"), rig.diag.text);
    relax_progress(&rig.sim, text);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(text, "and 0 peaks of kinetic energy the speed is 1 of its largest"), text);
}

/* What is said of a search, and that the first velocities of the two-step scheme are those of
 * rest: the bar stays where it was found. */
static void test_verlet_and_what_is_said(void)
{
    char text[RELAX_TEXT];
    RIG_OPEN_SOLID(hanging, "integrator=verlet", "relax.tolerance=0.001");
    rig.sim.state.time = kinetic;
    relax_text(&rig.sim, text);
    TEST_ASSERT_EQUAL_STRING("nothing moves: the state at the start is one of rest", text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, relax_to_rest(&rig.sim, &rig.diag), rig.diag.text);
    const double found = end_of_bar();
    const double exact = -1000 * 9.81 * (0.38 * 0.38 - 0.005 * 0.005) / (2 * 1e6);
    assert_near(0.02 * -exact, exact, found, "elongation");
    rig_run(&rig, 0.05);
    assert_near(0.002 * -exact, found, end_of_bar(), "a period later");
    relax_text(&rig.sim, text);
    double time, span, share;
    long long stops;
    TEST_ASSERT_EQUAL_INT_MESSAGE(
        4,
        sscanf(text,
               "at rest after %lg s and %lld peaks of kinetic energy: over the last %lg s, twice "
               "the longest time between two peaks, the speed stayed below %lg of its largest "
               "value",
               &time, &stops, &span, &share),
        text);
    TEST_ASSERT_EQUAL_INT64(rig.sim.state.relax_peaks, stops);
    assert_near(0.01 * time, rig.sim.state.relax_time, time, "time of the search");
    TEST_ASSERT_TRUE(span > 0 && span < time && share == 0.001);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_motion_dies_away);
    RUN_TEST(test_force_by_hand);
    RUN_TEST(test_step_holds_for_it);
    RUN_TEST(test_hanging_bar);
    RUN_TEST(test_forces_are_those_at_the_start);
    RUN_TEST(test_beside_fluid_the_search_has_its_own_clock);
    RUN_TEST(test_a_search_can_be_continued);
    RUN_TEST(test_no_rest_is_said);
    RUN_TEST(test_fluid_that_nothing_holds);
    RUN_TEST(test_guards_say_the_time_of_the_search);
    RUN_TEST(test_a_body_that_falls_has_no_rest);
    RUN_TEST(test_verlet_and_what_is_said);
    return UNITY_END();
}
