/* SPDX-License-Identifier: MIT
 * Springs with a force that is no multiple of the elongation: period, energy, the step that they
 * need, tables, and input that is refused. */
#include "rig.h"
#include "beam/beam.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct rig rig;

void setUp(void) { rig_one_thread(); }

void tearDown(void)
{
    rig_close(&rig);
    remove("test_spring_laws.tmp");
}

/* A mass of 2 kg/m on a spring of force K e + C e^3, which begins at e = 0 with a velocity U and
 * comes to e = A: 2 U^2/2 = K A^2/2 + C A^4/4. */
#define K 100.0
#define C 2e5
#define A 0.05
#define LAW "force = 100*e + 2e5*e^3\n"

static double speed(void) { return A * sqrt(0.5 * (K + 0.5 * C * A * A)); }

/* By e = A sin(p): the period is the integral of dp/sqrt((K + C A^2 (1 + sin^2 p)/2)/m) over a
 * turn. */
static double exact_period(void)
{
    enum { PARTS = 200 };
    double sum = 0;
    for (int k = 0; k < PARTS; k++)
        sum += sqrt(2 / (K + 0.5 * C * A * A * (1 + pow(sin(2 * M_PI * k / PARTS), 2))));
    return sum * 2 * M_PI / PARTS;
}

static double total(void)
{
    const struct ledger row = simulation_ledger(&rig.sim);
    return row.kinetic + row.elastic + row.potential;
}

static double place_of_body(void) { return rig.sim.rigid.state[0].x[0]; }
static double place_of_beam(void) { return rig.sim.beams.state[0].x[0]; }

/* The mean of two periods by rising zeros; energy stays within a part of the first one. */
static double period_of(double (*place)(void), double part)
{
    enum { PERIODS = 2 };
    int steps = 0;
    const double start = total();
    double before = place(), then = 0, first = 0;
    for (int n = -1; n < PERIODS;) {
        rig_steps(&rig, 1, 1e6);
        const double now = place(), t = rig.sim.state.time;
        if (steps++ % 50 == 0) assert_near(part * start, start, total(), "energy");
        const double zero = then + (t - then) * before / (before - now);
        if (before < 0 && now >= 0 && ++n == 0) first = zero;
        if (n == PERIODS) first = (zero - first) / PERIODS;
        before = now;
        then = t;
    }
    rig_close(&rig);
    return first;
}

#define BODY                                                                  \
    "dp = 3 cm\nend_time = 100\n[domain]\nlower = -20, -20\nupper = 20, 20\n" \
    "[rigid a]\nshape = box 0, 0, 0.1, 0.1\nmass = 2\nguide = 1, 0\nturns = off\n"
#define SPRING "[spring s]\nbody = a\nfrom = 0, 0.05\nto = -1, 0.05\n"
#define TABLE "[table law]\nfile = test_spring_laws.tmp\n"

static void open_body(const char *spring, const char *set)
{
    char text[1000];
    snprintf(text, sizeof text, BODY "velocity = %.17g, 0\n" SPRING "%s", speed(), spring);
    rig_open(&rig, text, set, NULL);
}

static void write_table(double step)
{
    FILE *const file = fopen("test_spring_laws.tmp", "w");
    TEST_ASSERT_NOT_NULL(file);
    for (double e = -0.06; e < 0.06 + 0.5 * step; e += step)
        fprintf(file, "%.9g, %.9g\n", e, K * e + C * e * e * e);
    fclose(file);
}

static void test_a_hardening_spring_has_its_period(void)
{
    const double exact = exact_period();
    open_body(LAW, NULL);
    assert_near(1e-5 * exact, exact, period_of(place_of_body, 2e-6), "period");
    open_body("other = b\n" LAW "[rigid b]\nshape = box -1.1, 0, -1, 0.1\nmass = 1e9\n", NULL);
    assert_near(1e-5 * exact, exact, period_of(place_of_body, 2e-6), "between two bodies");
}

static void test_a_table_is_the_same_law(void)
{
    static const struct {
        const char *text;
        double step, off;
    } each[] = {{TABLE, 5e-4, 1e-4}, {TABLE "between = cubic\n", 2e-3, 1e-3}};
    for (int k = 0; k < 2; k++) {
        char spring[400];
        write_table(each[k].step);
        snprintf(spring, sizeof spring, "force = law(e)\n%s", each[k].text);
        open_body(spring, NULL);
        const double exact = exact_period();
        assert_near(each[k].off * exact, exact, period_of(place_of_body, 1e-5), "period");
    }
}

/* With water far away, so that the step is that of its sound. */
static void test_each_integrator_beside_water(void)
{
    static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                              "integrator=leapfrog"};
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        open_body("other = b\n" LAW "[rigid b]\nshape = box -1.1, 0, -1, 0.1\nmass = 1e9\n"
                  "[fluid w]\nshape = box 9, 0, 9.1, 0.1\nsound_speed = 20\n",
                  integrators[k]);
        const double exact = exact_period();
        assert_near(5e-3 * exact, exact, period_of(place_of_body, 1e9), integrators[k]);
    }
}

/* A bar of one metre that moves as a whole. */
#define BAR                                                                                \
    "dp = 10 cm\nend_time = 1e6\n[beam a]\nshape = polyline: 0, 0.05; 1, 0.05\nmass = 2\n" \
    "axial_stiffness = 1e7\nbending_stiffness = 1e4\n"

static void test_a_beam_keeps_the_energy_and_has_the_period(void)
{
    char text[1000];
    const double exact = exact_period();
    write_table(5e-4);
    for (int k = 0; k < 2; k++) {
        snprintf(text, sizeof text, BAR "velocity = %.17g, 0\n" SPRING "%s", speed(),
                 k ? "force = law(e)\n" TABLE : LAW);
        rig_open(&rig, text, "numerics.fixed_step=0.002", NULL);
        assert_near(5e-3 * exact, exact, period_of(place_of_beam, k ? 1e-6 : 1e-8), "period");
    }
}

/* A stop that is met on the way, while nothing is stiff at the start: rigid bodies and beams
 * rebound with their energy. */
static void test_a_stop_shortens_the_step(void)
{
    static const char *const stop = "length = 1.02\nforce = -1e5*max(0, -e - 0.1)\n";
    char text[1000];
    for (int k = 0; k < 2; k++) {
        snprintf(text, sizeof text, "%svelocity = -1, 0\n" SPRING "%s", k ? BAR : BODY, stop);
        rig_open(&rig, text, NULL);
        const double before = rig.sim.dt_lone_solid;
        double shortest = 1;
        for (int n = 0; (k ? rig.sim.beams.state[0].v : rig.sim.rigid.state[0].v)[0] < 0.999; n++) {
            TEST_ASSERT_TRUE(n < 20000);
            rig_steps(&rig, 1, 1e6);
            shortest = fmin(shortest, rig.sim.state.dt);
        }
        assert_near(2e-4, 1, total(), "energy");
        assert_at_most(fmin(before, k ? 2 * M_PI * sqrt(2 / 1e5) / 20 : 1e-3 * sqrt(2 / 1e5)),
                       shortest, "shortest step");
        rig_close(&rig);
    }
}

/* A line that only pulls, with a damper, by its stiffness and by its force: the same motion. */
static void test_a_slack_line(void)
{
    double x[2];
    for (int k = 0; k < 2; k++) {
        open_body(k ? "slack = on\ndamping = 3\nforce = 100*e\n"
                    : "slack = on\ndamping = 3\nstiffness = 100\n",
                  NULL);
        rig_run(&rig, 1);
        x[k] = place_of_body();
        rig_close(&rig);
    }
    assert_near(1e-12, x[0], x[1], "place");
}

/* A force whose potential falls below its value at the start is no gain of energy. */
static void test_a_constant_force(void)
{
    rig_open(&rig, BODY SPRING "force = 10\n", NULL);
    const double x = place_of_body();
    rig_run(&rig, 0.1);
    const double t = rig.sim.state.time;
    assert_near(1e-4, 0.5 * (10.0 / 2) * t * t, fabs(place_of_body() - x), "way");
}

/* What a body passes between two rows of a table stays in the energy. */
static void test_a_narrow_feature_of_a_table(void)
{
    FILE *const f = fopen("test_spring_laws.tmp", "w");
    TEST_ASSERT_NOT_NULL(f);
    fprintf(f, "-1, 0\n0.02, 0\n0.025, 50\n0.03, 0\n1, 0\n");
    TEST_ASSERT_EQUAL(0, fclose(f));
    rig_open(&rig, BODY "velocity = 1, 0\n" SPRING "force = law(e)\n" TABLE, NULL);
    const double before = total();
    while (fabs(place_of_body()) < 0.2) {
        rig_steps(&rig, 1, 1e6);
        assert_near(1e-4 * before, before, total(), "energy");
    }
}

/* Forces that jump: of two directions, and many times. */
static void test_jumps_keep_the_energy(void)
{
    static const char *const laws[] = {"force = 10*(e - 1e-4)/abs(e - 1e-4)\n",
                                       "force = 2*round(200*e)\n"};
    for (int k = 0; k < 2; k++) {
        char text[1000];
        snprintf(text, sizeof text, BODY "velocity = 0.3, 0\n" SPRING "%s", laws[k]);
        rig_open(&rig, text, NULL);
        const double before = total();
        while (rig.sim.state.time < 0.2) {
            rig_steps(&rig, 20, 1e6);
            assert_near(1e-4 * before, before, total(), laws[k]);
        }
    }
}

/* An elongation that the check of the case has not reached: bodies in whole and half steps, and
 * Newton's method of a beam. */
static void test_a_force_that_is_not_finite_stops_the_run(void)
{
    static const struct {
        const char *text, *law, *set;
        int line;
    } each[] = {{BODY "velocity = 1, 0\n" SPRING, "e*log(1.1 - e)", "integrator=leapfrog", 16},
                {BODY "velocity = 1, 0\n" SPRING, "e*sqrt(1.1 - e)", NULL, 16},
                {BAR "velocity = 1, 0\n" SPRING, "e*sqrt(1.1 - e)", NULL, 13}};
    for (size_t k = 0; k < COUNT_OF(each); k++) {
        char text[1000], at[100];
        snprintf(text, sizeof text, "%sforce = %s\n", each[k].text, each[k].law);
        rig_open(&rig, text, each[k].set, NULL);
        enum err e = ERR_OK;
        for (int n = 0; n < 200000 && !e; n++) e = simulation_step(&rig.sim, 1e6, &rig.diag);
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_GUARD, e, each[k].law);
        snprintf(at, sizeof at, "rig.cfg:%d: t = ", each[k].line);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, at), rig.diag.text);
        const char *const found = strstr(rig.diag.text, " m; both must be finite");
        TEST_ASSERT_NOT_NULL_MESSAGE(found, rig.diag.text);
        double longer = 0;
        TEST_ASSERT_EQUAL_INT(1, sscanf(strstr(rig.diag.text, "e = "), "e = %lf", &longer));
        assert_near(2e-3, 1.1, longer, "elongation");
        rig_close(&rig);
    }
}

static void test_bad_input_is_refused(void)
{
    rig_refuses(BODY SPRING, "needs `stiffness`, `force` or `damping`");
    rig_refuses(BODY SPRING "stiffness = 2\nforce = e\n", "both `stiffness` and `force`");
    rig_refuses(BODY SPRING "force = 3*x\n", "`x` is known only in keys");
    rig_refuses(BODY SPRING "force = 1/(e - 0.5)\n",
                "force = 1/(e - 0.5) is not finite, or its slope is not, at e = 0.5 m");
    rig_refuses(BODY SPRING "length = 0.05\nforce = sqrt(0.9 - e)\n",
                "force = sqrt(0.9 - e) is not finite, or its slope is not, at e = 0.9");
    rig_refuses(BODY SPRING "slack = on\nforce = e*(0.5 - e)\n",
                "at e = 0.501 m, but slack = on lets the spring only pull");
    rig_refuses(BODY SPRING "force = e, e\n", "one expression is expected");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_hardening_spring_has_its_period);
    RUN_TEST(test_a_table_is_the_same_law);
    RUN_TEST(test_each_integrator_beside_water);
    RUN_TEST(test_a_beam_keeps_the_energy_and_has_the_period);
    RUN_TEST(test_a_stop_shortens_the_step);
    RUN_TEST(test_a_slack_line);
    RUN_TEST(test_a_constant_force);
    RUN_TEST(test_a_narrow_feature_of_a_table);
    RUN_TEST(test_jumps_keep_the_energy);
    RUN_TEST(test_a_force_that_is_not_finite_stops_the_run);
    RUN_TEST(test_bad_input_is_refused);
    return UNITY_END();
}
