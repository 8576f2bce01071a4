/* SPDX-License-Identifier: MIT
 * Rigid bodies: mass from shapes, free motion, exchange of momentum with the fluid, light
 * bodies, and a body that floats as deep as Archimedes says. */
#include "rig.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                          "integrator=leapfrog"};
static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

#define FREE "dp = 3 cm\nend_time = 1\n[domain]\nlower = -20, -20\nupper = 20, 20\n"

static const struct rigid_state *state(void) { return rig.sim.rigid.state; }

/* A frame, 0.4 m x 0.2 m less a hole of 0.2 m x 0.1 m in its right half; and a disc. */
static void test_mass_is_that_of_the_shapes(void)
{
    rig_open(&rig,
             FREE "[rigid frame]\nshape = box 0, 0, 0.4, 0.2\nminus = box 0.2, 0.05, 0.4, 0.15\n"
                  "density = 100\n"
                  "[rigid disc]\nshape = circle 1, 1, 0.3\nmass = 7\n",
             NULL);
    const struct rigid_mass *const m = rig.scene.rigid_mass;
    const double area = 0.06, x = (0.08 * 0.2 - 0.02 * 0.3) / area;
    const double about_origin =
        0.4 * 0.2 * (0.16 + 0.04) / 3 - 0.02 * (0.04 + 0.01) / 12 - 0.02 * (0.3 * 0.3 + 0.1 * 0.1);
    assert_near(1e-11, 6, m[0].mass, "mass of the frame");
    assert_near(1e-12, x, m[0].centre[0], "centre, x");
    assert_near(1e-12, 0.1, m[0].centre[1], "centre, y");
    assert_near(1e-12, 100 * (about_origin - area * (x * x + 0.01)), m[0].inertia, "inertia");
    assert_near(1e-12, 7, m[1].mass, "mass of the disc");
    assert_near(1e-6, 0.5 * 7 * 0.09, m[1].inertia, "inertia of the disc");
}

static void test_a_body_falls_and_spins_exactly(void)
{
    rig_open(&rig,
             "gravity = 0.5, -9.81\n" FREE "[rigid a]\nshape = box 0, 0, 0.4, 0.2\ndensity = 500\n"
             "velocity = 1, 2\nspin = 3\n",
             NULL);
    rig_run(&rig, 1);
    const double *const v = state()->v, *const x = state()->x;
    assert_near(1e-9, 1.25, x[0], "x");
    assert_near(1e-9, 2 - 4.905, x[1], "y");
    assert_near(1e-9, 3, x[2], "angle");
    assert_near(1e-9, 2 - 9.81, v[1], "vy");
    assert_near(1e-9, 0, simulation_ledger(&rig.sim).dissipated, "dissipated");
}

/* A bar on a hinge at its end, from rest when horizontal: after a quarter of a swing it hangs with
 * omega^2 = 2 m g r/I, and the hinge carries m (g + omega^2 r). */
static void test_a_bar_swings_about_its_hinge(void)
{
    rig_open(&rig,
             "gravity = 0, -9.81\n" FREE "[rigid a]\nshape = box 0, -0.05, 1, 0.05\nmass = 50\n"
             "hinge = 0, 0\n",
             NULL);
    const double inertia = 50 * (1 + 0.01) / 12 + 50 * 0.25;
    while (state()->x[2] > -0.5 * acos(-1)) rig_steps(&rig, 1, 1);
    const double omega2 = 2 * 50 * 9.81 * 0.5 / inertia;
    assert_near(1e-6 * omega2, omega2, square(state()->v[2]), "omega^2");
    assert_near(2e-3 * 490, 50 * (9.81 + 0.5 * omega2), state()->reaction[1], "reaction, y");
    assert_near(2, 0, state()->reaction[0], "reaction, x");
    assert_near(1e-3, -0.5, state()->x[1], "y of the centre");
    assert_near(1e-7 * 245, 0, simulation_ledger(&rig.sim).dissipated, "dissipated");
}

/* Two bodies on a spring: the period is that of the reduced mass, momentum stays, and so does
 * energy. A guided body moves along its line only. */
static void test_springs_and_guides(void)
{
    rig_open(&rig,
             FREE "[rigid a]\nshape = box 0, 0, 0.1, 0.1\nmass = 2\nvelocity = 0.3, 0\n"
                  "[rigid b]\nshape = box 1, 0, 1.1, 0.1\nmass = 4\n"
                  "[rigid c]\nshape = box 0, 3, 0.1, 3.1\nmass = 1\nguide = 1, 1\n"
                  "velocity = 1, 0\nturns = off\n"
                  "[spring s]\nbody = a\nfrom = 0.1, 0.05\nother = b\nto = 1, 0.05\n"
                  "stiffness = 100\n",
             NULL);
    const double omega = sqrt(100 / (2 * 4 / 6.0));
    rig_run(&rig, 0.2);
    assert_near(1e-6, 0.1 * 0.2 + 0.2 / omega * sin(omega * 0.2), state()[0].x[0], "x of a");
    assert_near(1e-6, 0.1 * 0.2 - 0.1 / omega * sin(omega * 0.2), state()[1].x[0], "x of b");
    assert_near(1e-9, 0.1, state()[2].x[0], "x of c");
    assert_near(1e-9, 0.1, state()[2].x[1], "y of c");
    const struct ledger row = simulation_ledger(&rig.sim);
    assert_near(1e-9, 0.6 + 0.5, row.momentum_x, "momentum");
    assert_near(1e-6, 0, row.dissipated, "dissipated");
}

/* A line that is longer than the distance does not act; a damper takes energy. */
static void test_a_mooring_pulls_only(void)
{
    rig_open(&rig,
             FREE "[rigid a]\nshape = box 0, 0, 0.1, 0.1\nmass = 2\nvelocity = -1, 0\n"
                  "[spring s]\nbody = a\nfrom = 0.1, 0.05\nto = 1.1, 0.05\nlength = 1.1\n"
                  "stiffness = 1000\ndamping = 20\nslack = on\n",
             NULL);
    rig_run(&rig, 0.09);
    assert_near(1e-12, -1, state()->v[0], "velocity while slack");
    rig_run(&rig, 1);
    TEST_ASSERT_TRUE(state()->v[0] > 0.3 && state()->v[0] < 0.9);
    assert_near(1e-9, 1 - square(state()->v[0]), simulation_ledger(&rig.sim).dissipated,
                "dissipated");
}

/* Without gravity and walls, what the body loses the fluid has, or has still to receive. */
static void test_momentum_is_exchanged(void)
{
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig,
                 FREE
                 "[fluid w]\nshape = box 0, 0, 0.6, 0.6\nsound_speed = 20\n"
                 "[rigid a]\nshape = box -0.3, 0.12, 0, 0.3\ndensity = 100\nvelocity = 0.5, 0\n",
                 integrators[k], NULL);
        rig_run(&rig, 0.02);
        const struct ledger row = simulation_ledger(&rig.sim);
        const double all = 100 * 0.3 * 0.18 * 0.5;
        assert_at_most(0.45, state()->v[0], "velocity after the impact");
        /* Verlet's two solutions have the momentum in their mean. */
        assert_near(k == 1 ? 0.02 * all : 1e-5 * all, all, row.momentum_x, "momentum, x");
        assert_near(k == 1 ? 0.02 * all : 1e-5 * all, 0, row.momentum_y, "momentum, y");
    }
}

#define TANK                                                                                 \
    "dp = 2 cm\nend_time = 2\ngravity = 0, -9.81\nprecision = double\n"                      \
    "[fluid w]\nshape = box 0, 0, 0.8, 0.4\nminus = box 0.2, 0.2, 0.6, 0.6\nsurface = 0.4\n" \
    "sound_speed = 30\n[wall tank]\nshape = polyline: 0, 0.9; 0, 0; 0.8, 0; 0.8, 0.9\n"

/* A hundredth of the density of water, dropped from the place of a body half as dense: it leaps,
 * and no step or guard has to prevent more. */
static void test_a_light_body_is_stable(void)
{
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig, TANK "[rigid a]\nshape = box 0.2, 0.2, 0.6, 0.6\ndensity = 10\n",
                 integrators[k], NULL);
        rig_run(&rig, 0.02);
        /* The surface is that of twice the mass of fluid per area; a fluid of four bodies' width
         * moves with it: the body follows with less than g. */
        assert_at_most(9.81 * 0.02 * 4, state()->v[1], "velocity upwards");
        TEST_ASSERT_TRUE(state()->v[1] > 0);
        rig_run(&rig, 0.3);
        TEST_ASSERT_TRUE(isfinite(state()->x[1]));
    }
}

/* Half as dense as water, from its floating position: it stays within a quarter of a spacing. */
static void test_a_stiff_spring_between_bodies_is_followed(void)
{
    static const char *const beside[] = {
        "[fluid a]\nshape = box -9, 0, -8.9, 0.1\nsound_speed = 20\n",
        "[solid a]\nshape = box -9, 0, -8.9, 0.1\ndensity = 1000\nyoung = 1e5\npoisson = 0.3\n"};
    for (size_t k = 0; k < 2 * COUNT_OF(integrators); k++) {
        char text[1000];
        snprintf(text, sizeof text,
                 FREE "%s[rigid b]\nshape = box 0, 0, 0.4, 0.2\ndensity = 500\nvelocity = 1, 0\n"
                      "[rigid c]\nshape = box 1, 0, 1.4, 0.2\ndensity = 500\n"
                      "[spring d]\nbody = b\nother = c\nfrom = 0.4, 0.1\nto = 1, 0.1\n"
                      "stiffness = 1e9\n",
                 beside[k % 2]);
        rig_open(&rig, text, integrators[k / 2], NULL);
        rig_run(&rig, 0.1);
        const double apart = 1 - sqrt(20 / 1e9); /* of the centres: half of the speed is theirs */
        assert_near(1.01 * (1 - apart), 0, state()[1].x[0] - state()[0].x[0], "elongation");
        assert_near(1e-6, 1, state()[0].v[0] + state()[1].v[0], "momentum");
    }
}

static void test_a_body_floats(void)
{
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig, TANK "[rigid a]\nshape = box 0.2, 0.2, 0.6, 0.6\ndensity = 500\n",
                 integrators[k], NULL);
        rig_run(&rig, 0.5);
        assert_near(0.005, 0, state()->x[1], "heave");
        assert_near(0.002, 0, state()->x[0], "sway");
        assert_near(0.02, 0, state()->x[2], "roll");
    }
}

static char said[2000];

static void hear(void *context, const char *text)
{
    (void)context;
    snprintf(said, sizeof said, "%s", text);
}

/* What has passed into a wall is warned of, by both names: contact ends a quarter of a spacing
 * inside. */
static void test_a_body_in_a_wall_is_warned_of(void)
{
    rig_open(&rig,
             "gravity = 0, -9.81\n" FREE "[wall floor]\nshape = box -1, -0.12, 1, 0\n"
             "[rigid a]\nshape = box 0, 0.3, 0.3, 0.6\ndensity = 500\nspin = 0.5\n",
             NULL);
    rig.diag.warn = hear;
    said[0] = '\0';
    rig_run(&rig, 0.2);
    TEST_ASSERT_EQUAL_STRING("", said);
    rig.sim.rigid.state->x[1] = -0.35;
    rig_run(&rig, 0.3);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, "[rigid a] has entered [wall floor] near"), said);
}

/* A box that falls on a floor drawn as a line stays on it, and a disc rolls on beside it. */
static void test_bodies_rest_on_the_floor(void)
{
    rig_open(&rig,
             "gravity = 0, -9.81\n" FREE "[wall tank]\nshape = polyline: -2, 0; 0.5, 0; 3, 0\n"
             "[rigid a]\nshape = box 0, 0.3, 0.3, 0.6\ndensity = 500\n"
             "[rigid b]\nshape = circle 1.2, 0.45, 0.15\ndensity = 500\nvelocity = 0.4, 0\n"
             "spin = -0.5\n",
             NULL);
    rig.diag.warn = hear;
    said[0] = '\0';
    rig_run(&rig, 1);
    const struct rigid_state *const a = &state()[0], *const b = &state()[1];
    const double lost = 500 * 9.81 * 0.3 * (0.09 + acos(-1) * 0.15 * 0.15);
    assert_near(1e-9, -0.3, a->x[1], "y of the box");
    assert_near(1e-9, 0, a->x[0], "x of the box");
    assert_near(1e-9, 0, a->x[2], "angle of the box");
    assert_near(1e-9, 0, a->v[1], "vy of the box");
    assert_near(1e-9, -0.3, b->x[1], "y of the disc");
    assert_near(1e-9, 0.4, b->x[0], "x of the disc");
    assert_near(1e-9, -0.5, b->x[2], "angle of the disc");
    assert_near(1e-3 * lost, lost, simulation_ledger(&rig.sim).dissipated, "dissipated");
    TEST_ASSERT_EQUAL_STRING("", said);
}

/* An overlap at the start stays: to part the bodies would lift one, with energy that nothing
 * supplies. */
static void test_a_body_rests_in_an_overlap(void)
{
    static const char *const depth[] = {"1e-9", "1e-6", "1e-3", "-1e-3"};
    for (size_t k = 0; k < COUNT_OF(depth); k++) {
        char text[600];
        snprintf(text, sizeof text,
                 "gravity = 0, -9.81\n" FREE "[constants]\ndeep = %s\n"
                 "[wall floor]\nshape = box -1, -0.12, 1, 0\n"
                 "[rigid a]\nshape = box 0, -deep, 0.3, 0.3\ndensity = 500\n",
                 depth[k]);
        rig_open(&rig, text, NULL);
        rig.diag.warn = hear;
        said[0] = '\0';
        rig_run(&rig, 0.1);
        TEST_ASSERT_EQUAL_STRING("", said);
        assert_near(1e-12, min2(0, atof(depth[k])), state()->x[1], depth[k]);
    }
}

/* Inelastic: momentum and angular momentum stay, and the corner that was hit moves with the other
 * body. */
static void test_two_boxes_collide(void)
{
    rig_open(&rig,
             FREE "[rigid a]\nshape = box 0, 0, 0.3, 0.3\nmass = 2\nvelocity = 1, 0\n"
                  "[rigid b]\nshape = box 0.45, 0, 0.75, 0.3\nmass = 4\n"
                  "[rigid c]\nshape = box 0, 2, 0.3, 2.3\nmass = 2\nvelocity = 1, 0\n"
                  "[rigid d]\nshape = box 0.45, 2.21, 0.75, 2.51\nmass = 4\n",
             NULL);
    rig_run(&rig, 0.3);
    const struct rigid_state *const s = state();
    assert_near(1e-7, 1 / 3.0, s[0].v[0], "velocity of a");
    assert_near(1e-7, 1 / 3.0, s[1].v[0], "velocity of b");
    assert_near(1e-5, -0.15, s[1].x[0] - s[0].x[0], "distance of a and b");
    assert_near(1e-12, 2, 2 * s[2].v[0] + 4 * s[3].v[0], "momentum of c and d");
    double turning = 2 * 2.15;
    for (int k = 2; k < 4; k++) {
        const struct rigid_mass *const m = &rig.scene.rigid_mass[k];
        const double x = m->centre[0] + s[k].x[0], y = m->centre[1] + s[k].x[1];
        turning += m->inertia * s[k].v[2] + m->mass * (x * s[k].v[1] - y * s[k].v[0]);
    }
    assert_near(1e-5, 0, turning, "angular momentum of c and d");
    TEST_ASSERT_TRUE(fabs(s[2].v[2]) > 0.1);
}

/* Without friction a box on a slope of 3 in 4 slides with 0.6 g. */
static void test_a_box_slides_down_a_slope(void)
{
    rig_open(&rig,
             "gravity = 0, -10\n" FREE "[wall slope]\nshape = polygon -4, -3; 4, 3; 4, -3\n"
             "[rigid a]\nshape = polygon 0, 0; 0.4, 0.3; 0.1, 0.7; -0.3, 0.4\nmass = 3\n",
             NULL);
    rig_run(&rig, 0.5);
    assert_near(1e-6, -6 * 0.5 * 0.8, state()->v[0], "vx");
    assert_near(1e-6, -6 * 0.5 * 0.6, state()->v[1], "vy");
    assert_near(1e-6, 0, state()->x[2], "angle");
    assert_near(1e-6, -0.75 * 0.8, state()->x[0], "x");
    assert_near(1e-3, 0, simulation_ledger(&rig.sim).dissipated, "dissipated");
}

/* Discs of many corners that touch each other: contact that the memory does not hold stops the run,
 * and is not dropped. */
static void test_too_many_corners_are_refused(void)
{
    enum { CORNERS = 200 };
    char text[3 * 30 * CORNERS + 400];
    size_t used = (size_t)snprintf(text, sizeof text, "%s", FREE);
    for (int k = 0; k < 3; k++) {
        used += (size_t)snprintf(text + used, sizeof text - used,
                                 "[rigid r%d]\nmass = 1\nshape = polygon ", k);
        for (int n = 0; n < CORNERS; n++) {
            const double angle = 2 * acos(-1) * (n + 0.5) / CORNERS;
            used += (size_t)snprintf(text + used, sizeof text - used, "%.6f, %.6f%s",
                                     0.1 * cos(angle) + (k == 2 ? 0.1 : 0.2 * k),
                                     0.1 * sin(angle) + (k == 2 ? 0.1733 : 0),
                                     n + 1 < CORNERS ? "; " : "\n");
        }
    }
    rig_open(&rig, text, NULL);
    enum err e = ERR_OK;
    for (int n = 0; n < 3 && e == ERR_OK; n++) e = simulation_step(&rig.sim, 1, &rig.diag);
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, e);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, "draw polygons with fewer points"),
                                 rig.diag.text);
}

/* A wall that rises lifts a body and does the work. */
static void test_a_moving_wall_lifts_a_body(void)
{
    rig_open(&rig,
             "gravity = 0, -10\n" FREE "[wall lift]\nshape = box -1, -0.12, 1, 0\nmotion = m\n"
             "[motion m]\ny = 0.5*t\n"
             "[rigid a]\nshape = box 0, 0, 0.3, 0.3\nmass = 3\n",
             NULL);
    rig_run(&rig, 0.4);
    assert_near(1e-9, 0.2, state()->x[1], "y");
    assert_near(1e-9, 0.5, state()->v[1], "vy");
    assert_near(1e-2, 3 * 10 * 0.2 + 2 * 0.5 * 3 * 0.25, rig.sim.state.wall_work,
                "work of the wall");
}

/* Half as dense again as water, it sinks and stays on the floor, with each integrator; a layer of
 * water is left under it. */
static void test_a_body_sinks_to_the_floor(void)
{
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig,
                 "dp = 2 cm\nend_time = 2\ngravity = 0, -9.81\nscheme = standard\n"
                 "[fluid w]\nshape = box 0, 0, 1.2, 0.4\nminus = box 0.4, 0.08, 0.8, 0.2\n"
                 "surface = 0.4\nsound_speed = 30\n"
                 "[wall tank]\nshape = polyline: 0, 1; 0, 0; 1.2, 0; 1.2, 1\n"
                 "[rigid a]\nshape = box 0.4, 0.08, 0.8, 0.2\ndensity = 1500\n",
                 integrators[k], NULL);
        rig_run(&rig, 0.8);
        assert_near(0.002, -0.06, state()->x[1], integrators[k]);
        assert_near(0.02, 0, state()->v[1], "velocity");
    }
}

static void test_bad_input_is_refused(void)
{
    rig_refuses(FREE "[rigid a]\nshape = box 0, 0, 1, 1\n", "needs `density` or `mass`");
    rig_refuses(FREE "[rigid a]\nshape = box 0, 0, 1, 1\ndensity = 1\nmass = 1\n",
                "has both `density` and `mass`");
    rig_refuses(FREE "[rigid a]\ndensity = 1\n", "[rigid a] lacks `shape`");
#define BOX "[rigid a]\nshape = box 0, 0, 1, 1\ndensity = 1\n"
    rig_refuses(FREE BOX "hinge_friction = 1\n", "but no `hinge`");
    rig_refuses(FREE BOX "hinge = 0, 0\nhinge = 1, 1\n", "second `hinge`");
    rig_refuses(FREE BOX "hinge = 0, 0\nguide = 1, 0\n", "leave one out");
    rig_refuses(FREE BOX "[solid b]\nshape = box 2, 0, 3, 1\ndensity = 1\nyoung = 1e6\n"
                         "poisson = 0.3\n[rigid c]\nshape = box 4, 0, 5, 1\ndensity = 1\n"
                         "hinge = 0, 0, b\n",
                "b is no [wall] and no other [rigid]");
    rig_refuses(FREE BOX "[spring s]\nbody = b\nstiffness = 1\nto = 1, 1\n",
                "there is no [rigid] or [beam] of that name");
    rig_refuses(FREE BOX "[spring s]\nbody = a\nother = a\nstiffness = 1\nto = 1, 1\n",
                "to itself");
    rig_refuses(FREE BOX "[spring s]\nbody = a\nstiffness = 1\n", "no direction");
    rig_refuses(FREE BOX "[spring s]\nbody = a\nto = 1, 1\n",
                "needs `stiffness`, `force` or `damping`");
    rig_refuses(FREE BOX "[probe p]\nquantity = reaction\nbody = a\n", "holds a, but nothing does");
    rig_refuses(FREE "[wall a]\nshape = box 3, 3, 4, 4\n"
                     "[rigid a]\nshape = box 0, 0, 1, 1\ndensity = 1\n",
                "has the name of [wall a]");
    rig_refuses(FREE "[wall w]\nshape = box 0, 0, 1, 1\n"
                     "[rigid a]\nshape = box 0.5, 0, 1.5, 1\ndensity = 1\n",
                "[rigid a]");
    rig_refuses("dp = 0.1\nend_time = 1\n[domain]\nlower = 0, 0\nupper = 1, 1\nperiodic = x\n"
                "[fluid w]\nshape = box 0, 0, 1, 0.5\nsound_speed = 1\n"
                "[rigid a]\nshape = box 0, 0.5, 0.5, 1\ndensity = 1\n",
                "periodic");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_mass_is_that_of_the_shapes);
    RUN_TEST(test_a_body_falls_and_spins_exactly);
    RUN_TEST(test_a_bar_swings_about_its_hinge);
    RUN_TEST(test_springs_and_guides);
    RUN_TEST(test_a_mooring_pulls_only);
    RUN_TEST(test_momentum_is_exchanged);
    RUN_TEST(test_a_light_body_is_stable);
    RUN_TEST(test_a_stiff_spring_between_bodies_is_followed);
    RUN_TEST(test_a_body_floats);
    RUN_TEST(test_a_body_in_a_wall_is_warned_of);
    RUN_TEST(test_a_body_sinks_to_the_floor);
    RUN_TEST(test_bodies_rest_on_the_floor);
    RUN_TEST(test_a_body_rests_in_an_overlap);
    RUN_TEST(test_two_boxes_collide);
    RUN_TEST(test_a_box_slides_down_a_slope);
    RUN_TEST(test_a_moving_wall_lifts_a_body);
    RUN_TEST(test_too_many_corners_are_refused);
    RUN_TEST(test_bad_input_is_refused);
    return UNITY_END();
}
