/* SPDX-License-Identifier: MIT
 * Springs and mooring lines of beams: frequency, energy through large motions and through slack,
 * damping, the force that a probe has, and input that is refused. */
#include "rig.h"
#include "beam/beam.h"
#include "geometry/scene_points.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

/* A bar of one metre, 1 kg and no bending, 0.1 m of it an element. */
#define BAR(rest)                                                                    \
    "dp = 10 cm\nend_time = 1e6\n[numerics]\nfixed_step = 0.005\n[beam b]\n"         \
    "shape = polyline: 0, 0; 1, 0\naxial_stiffness = 1e6\nbending_stiffness = 1e6\n" \
    "mass = 1\n" rest
#define SPRING(name, rest) "[spring " name "]\nbody = b\nstiffness = 40\n" rest

static double total(void)
{
    const struct ledger row = simulation_ledger(&rig.sim);
    return row.kinetic + row.elastic + row.potential;
}

/* Along the bar, which moves as a whole. */
static void test_a_bar_on_a_spring_has_its_period(void)
{
    rig_open(&rig, BAR("velocity = 1e-3, 0\n") SPRING("s", "from = 0, 0\nto = -1, 0\n"), NULL);
    const double period = 2 * PI / sqrt(40.0);
    rig_run(&rig, 10 * period);
    const struct beam_state *const s = &rig.sim.beams.state[0];
    assert_near(3e-4 * 1e-3, 1e-3, s->v[0], "velocity after ten periods");
    assert_near(2e-3 * 1e-3 / sqrt(40.0) * 10, 0, s->x[0], "place after ten periods");
}

/* Two lines that only pull: the bar swings and turns between them, and both become slack. */
static void test_slack_lines_keep_the_energy(void)
{
    rig_open(&rig,
             BAR("velocity = 0.5 - 3*y, 3*x\n")
                 SPRING("s", "from = 0, 0\nto = -1, 0.2\nslack = on\n")
                     SPRING("t", "from = 1, 0\nto = 1.8, 0.3\nlength = 0.7\nslack = on\n"),
             NULL);
    const double start = total();
    double force[2];
    int slack = 0;
    for (int k = 0; k < 4000; k++) {
        rig_steps(&rig, 1, 1e6);
        assert_near(1e-8 * start, start, total(), "energy");
        TEST_ASSERT_TRUE(beam_spring_force(&rig.sim.beams, 0, force));
        slack += force[0] == 0 && force[1] == 0;
    }
    char found[40];
    snprintf(found, sizeof found, "%d slack", slack);
    TEST_ASSERT_TRUE_MESSAGE(slack > 100 && slack < 3900, found);
}

static void test_a_damper_takes_what_theory_says(void)
{
    rig_open(&rig,
             BAR("velocity = 1e-3, 0\n") SPRING("s", "from = 0, 0\nto = -1, 0\ndamping = 0.8\n"),
             NULL);
    const double rate = 0.4, omega = sqrt(40 - rate * rate), time = 6 * 2 * PI / omega;
    rig_run(&rig, time);
    const double left = exp(-rate * time);
    assert_near(3e-3 * left, left, rig.sim.beams.state[0].v[0] / 1e-3, "velocity");
}

/* Of its own weight: what the end in place carries. */
static void test_a_hanging_bar_pulls_with_its_weight(void)
{
    rig_open(&rig,
             BAR("mass_damping = 5\n") SPRING("s", "from = 0.5, 0\nto = 0.5, 1\ndamping = 5\n"),
             "gravity=0, -2", NULL);
    double force[2];
    rig_run(&rig, 10);
    TEST_ASSERT_TRUE(beam_spring_force(&rig.sim.beams, 0, force));
    assert_near(1e-6, 0, force[0], "force across");
    assert_near(1e-6, -2, force[1], "weight");
    assert_near(1e-6, -2.0 / 40, rig.sim.beams.state[5].x[1], "displacement");
}

/* A cantilever of bending stiffness 1 N m and 1 kg/m, which springs hold at 0.5 m and at its end:
 * periods of its first mode, by the rising zeros of the displacement at 0.25 m. */
#define FLEXIBLE                                                                                 \
    "dp = 5 cm\nend_time = 1e6\n[beam b]\nshape = polyline: 0, 0; 1, 0\naxial_stiffness = 1e6\n" \
    "bending_stiffness = 1\nmass = 1\n"
#define CANTILEVER FLEXIBLE "clamp = 0, 0\nvelocity = 0, 1e-4*x^2*(0.5-x)*(1-x)*(1-x/2)\n"
#define HELD(name, at, rest) "[spring " name "]\nbody = b\nfrom = " at "\n" rest
#define ACROSS(name, at) HELD(name, at ", 0", "to = " at ", -1\nstiffness = 1e7\n")
/* Two that pull against each other hold it across by their tension, 5000 N/m^2 each. */
#define TAUT "length = 0.5\nstiffness = 1e4\n"
#define ALONG(name, at, left, right)                    \
    HELD(name "l", at ", 0", "to = " left ", 0\n" TAUT) \
    HELD(name "r", at ", 0", "to = " right ", 0\n" TAUT)
static double sprung_period(const char *scene, const char *step)
{
    enum { PERIODS = 10 };
    rig_open(&rig, scene, step, NULL);
    const double start = total();
    double first = 0, x_old = -1, t_old = 0;
    for (int n = -1; n < PERIODS;) {
        rig_steps(&rig, 1, 1e6);
        const double x = rig.sim.beams.state[5].x[1], t = rig.sim.state.time;
        assert_near(1e-6 * start, start, total(), "energy");
        if (x_old < 0 && x >= 0 && ++n == 0) first = t_old + (t - t_old) * x_old / (x_old - x);
        if (n == PERIODS) first = (t_old + (t - t_old) * x_old / (x_old - x) - first) / PERIODS;
        x_old = x;
        t_old = t;
    }
    rig_close(&rig);
    return first;
}

static void test_stiff_springs_shorten_the_step(void)
{
    static const char *const scene[] = {CANTILEVER ACROSS("s", "0.5") ACROSS("t", "1"),
                                        CANTILEVER ALONG("s", "0.5", "-0.5", "1.5")
                                            ALONG("t", "1", "0", "2")};
    for (int k = 0; k < 2; k++) {
        const double exact = sprung_period(scene[k], "numerics.fixed_step=2e-4");
        assert_near(0.01 * exact, exact, sprung_period(scene[k], "numerics.cfl=0.2"), "period");
    }
}

/* Free ends bend with 22.37 rad/s, hinged ones with 9.87 rad/s; no bending is slower. The bound is
 * within 1 % of the frequency, and 20 elements within 1 %. */
static void test_free_beams_on_stiff_springs_take_the_step_of_bending(void)
{
    rig_open(&rig, FLEXIBLE ACROSS("s", "0") ACROSS("t", "1"), NULL);
    const double step = 2 * PI / 22.37 / 100;
    assert_near(0.02 * step, step, rig.sim.dt_lone_solid, "step");
}

/* The residual of a step is at least the round-off of the spring. */
static void test_a_very_stiff_spring_is_solved_to_its_rounding(void)
{
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n[beam b]\nclamp = 0.3, 0\n"
             "shape = polyline: 0.3, 0; 0.3, 0.1\nthickness = 4 mm\nyoung = 1e7\n"
             "density = 1000\n" HELD("s", "0.3, 0.1", "to = 0.39, 0.1\nstiffness = 1e10\n"),
             NULL);
    rig_steps(&rig, 50, 1);
    assert_near(1e-8, 0, rig.sim.beams.state[rig.sim.beams.n_nodes - 1].x[0], "end");
}

/* One sentence says all. */
static void refuses_by_one(const char *spring, const char *why)
{
    struct scene scene;
    struct diag d = {0};
    char text[400];
    snprintf(text, sizeof text, BAR("") "%s", spring);
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, scene_load_text(&scene, text, "t.cfg", 0, NULL, &d));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(d.text, why), d.text);
    TEST_ASSERT_NULL_MESSAGE(strchr(d.text, '\n'), d.text);
}

/* A law of a spring shortens the solid's step only where it is stiffer than at the start. */
static void test_laws_of_springs_beside_a_dry_solid(void)
{
    static const char scene[] =
        "dp = 1 cm\nend_time = 1\n[solid a]\nshape = box 0, 0, 0.1, 0.04\nyoung = 1e6\n"
        "density = 1000\npoisson = 0\n[beam b]\nshape = polyline: 0, 1; 0, 1.1\n"
        "thickness = 4 mm\nyoung = 1e7\ndensity = 1000\nclamp = 0, 1\n"
        "[spring s]\nbody = b\nfrom = 0, 1.1\nto = 1, 1.1\n";
    double step[2];
    for (int k = 0; k < 2; k++) {
        char text[600];
        snprintf(text, sizeof text, "%s%s\n", scene, k ? "force = 100*e" : "stiffness = 100");
        rig_close(&rig);
        rig_open(&rig, text, NULL);
        rig_steps(&rig, 3, 1);
        step[k] = rig.sim.state.dt;
    }
    assert_near(1e-12 * step[0], step[0], step[1], "step with the same spring as a law");
}

static void test_bad_input_is_refused(void)
{
    rig_refuses(BAR("") SPRING("s", "from = 0, 0.2\nto = 0, 1\n"),
                "[spring s] from = 0, 0.2 is 0.2 m from [beam b]; move it onto its line");
    rig_refuses(
        BAR("") SPRING(
            "s",
            "from = 0, 0\nto = 0, 1\nother = r\n") "[rigid r]\nshape = box 0, 1, 1, 2\nmass = 1\n",
        "leave `other` out");
    rig_refuses(BAR("") "[spring s]\nbody = c\nstiffness = 1\nto = 0, 1\n",
                "there is no [rigid] or [beam] of that name");
    refuses_by_one("[spring s]\nbody = b\nother = b\nstiffness = 1\nto = 0, 1\n",
                   "other = b: there is no [rigid] of that name");
    refuses_by_one("[spring s]\nstiffness = 1\nto = 0, 1\n", "[spring s] lacks `body`");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_bar_on_a_spring_has_its_period);
    RUN_TEST(test_slack_lines_keep_the_energy);
    RUN_TEST(test_a_damper_takes_what_theory_says);
    RUN_TEST(test_a_hanging_bar_pulls_with_its_weight);
    RUN_TEST(test_stiff_springs_shorten_the_step);
    RUN_TEST(test_free_beams_on_stiff_springs_take_the_step_of_bending);
    RUN_TEST(test_a_very_stiff_spring_is_solved_to_its_rounding);
    RUN_TEST(test_laws_of_springs_beside_a_dry_solid);
    RUN_TEST(test_bad_input_is_refused);
    return UNITY_END();
}
