/* SPDX-License-Identifier: MIT
 * Friction and rebound of rigid bodies (T-102b): a disc that rolls and one that slides, a box at
 * rest on a slope and one that slides, a moving belt, two discs, a bounce, and energy. */
#include "rig.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>

static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

#define FREE "dp = 3 cm\nend_time = 2\n[domain]\nlower = -20, -20\nupper = 20, 20\n"
#define SLOPE "gravity = 0, -10\n" FREE "[wall slope]\nshape = polygon -4, -3; 4, 3; 4, -3\n"

static const struct rigid_state *state(void) { return rig.sim.rigid.state; }

/* A slope of 3 in 4: g sin = 6, g cos = 8. Above a coefficient of tan/3 = 0.25 a disc rolls with
 * 2/3 g sin; with 0.1 it slides with g (sin - 0.1 cos), and turns with 2 x 0.1 g cos/r. */
static void test_a_disc_on_a_slope(void)
{
    static const char *const friction[] = {"c.friction=0.3", "c.friction=0.1"};
    static const double along[] = {4, 5.2}, turning[] = {4 / 0.3, 1.6 / 0.3};
    for (int k = 0; k < 2; k++) {
        rig_open(&rig,
                 SLOPE "[rigid a]\nshape = circle -0.18, 0.24, 0.3\nmass = 3\n"
                       "[contact c]\nbetween = a, slope\n",
                 friction[k], NULL);
        rig_run(&rig, 0.5);
        const double way = 0.125 * along[k];
        assert_near(1e-6, -0.8 * way, state()->x[0], "x");
        assert_near(1e-6, -0.6 * way, state()->x[1], "y");
        assert_near(1e-5, 0.125 * turning[k], state()->x[2], "angle");
        const double slid = k ? way - 0.3 * 0.125 * turning[k] : 0;
        assert_near(1e-4, 3 * 0.8 * slid, simulation_ledger(&rig.sim).dissipated, "dissipated");
    }
}

/* Above tan = 0.75 a box stays where it is; with 0.5 it slides with g (sin - 0.5 cos). */
static void test_a_box_on_a_slope(void)
{
    static const char *const friction[] = {"c.friction=0.8", "c.friction=0.5"};
    for (int k = 0; k < 2; k++) {
        rig_open(&rig,
                 SLOPE "[rigid a]\nshape = polygon 0, 0; 0.4, 0.3; 0.1, 0.7; -0.3, 0.4\nmass = 3\n"
                       "[contact c]\n",
                 friction[k], NULL);
        rig_run(&rig, 0.5);
        const double way = k ? 0.125 * 2 : 0;
        assert_near(1e-6, -0.8 * way, state()->x[0], "x");
        assert_near(1e-6, -0.6 * way, state()->x[1], "y");
        assert_near(1e-6, 0, state()->x[2], "angle");
    }
}

/* A belt of 0.5 m/s takes a box along with mu g until both are equally fast, and does the work. */
static void test_a_belt_takes_a_box_along(void)
{
    rig_open(&rig,
             "gravity = 0, -10\n" FREE "[wall belt]\nshape = box -1, -0.12, 3, 0\nmotion = m\n"
             "[motion m]\nx = 0.5*t\n"
             "[rigid a]\nshape = box 0, 0, 0.3, 0.3\nmass = 3\n"
             "[contact c]\nbetween = a, belt\nfriction = 0.2\n",
             NULL);
    rig_run(&rig, 0.2);
    assert_near(1e-6, 0.4, state()->v[0], "vx in flight");
    rig_run(&rig, 0.6);
    assert_near(1e-6, 0.5, state()->v[0], "vx");
    assert_near(1e-3, 0.0625 + 0.35 * 0.5, state()->x[0], "x");
    assert_near(1e-3, 6 * 0.25 * 0.5, rig.sim.state.wall_work, "work of the belt");
    assert_near(1e-3, 0.375, simulation_ledger(&rig.sim).dissipated, "dissipated");
}

/* A spinning disc that hits another without friction keeps its spin. With much friction both leave
 * with equal speeds where they touch. Momentum and angular momentum stay. */
static void test_a_spinning_disc_hits_another(void)
{
    static const char *const friction[] = {"c.friction=0", "c.friction=5"};
    for (int k = 0; k < 2; k++) {
        rig_open(&rig,
                 FREE "[rigid a]\nshape = circle 0, 0, 0.2\nmass = 2\nvelocity = 1, 0\nspin = 4\n"
                      "[rigid b]\nshape = circle 0.5, 0, 0.2\nmass = 1\n"
                      "[contact c]\nbetween = b, a\nrestitution = 0.5\n",
                 friction[k], NULL);
        const double spin_of_a = 0.5 * 2 * 0.04 * 4;
        rig_run(&rig, 0.3);
        const struct rigid_state *const s = state();
        assert_near(1e-9, 2, 2 * s[0].v[0] + s[1].v[0], "momentum, x");
        assert_near(1e-9, 0, 2 * s[0].v[1] + s[1].v[1], "momentum, y");
        assert_near(1e-7, 0.5, s[1].v[0] - s[0].v[0], "speed at which they part");
        double turning = 0;
        for (int b = 0; b < 2; b++) {
            const struct rigid_mass *const m = &rig.scene.rigid_mass[b];
            const double x = m->centre[0] + s[b].x[0], y = m->centre[1] + s[b].x[1];
            turning += m->inertia * s[b].v[2] + m->mass * (x * s[b].v[1] - y * s[b].v[0]);
        }
        assert_near(1e-4, spin_of_a, turning, "angular momentum");
        if (k == 0) assert_near(1e-9, 4, s[0].v[2], "spin");
        /* Where they touch: 0.2 (spin of a + spin of b) + vy of a - vy of b. */
        if (k == 1)
            assert_near(1e-2, 0, 0.2 * (s[0].v[2] + s[1].v[2]) + s[0].v[1] - s[1].v[1], "slip");
    }
}

/* A disc that falls 0.8 m at 4 m/s returns to e^2 of that height. */
static void test_a_disc_bounces(void)
{
    rig_open(&rig,
             "gravity = 0, -10\n" FREE "[wall bed]\nshape = box -1, -0.12, 1, 0\n"
             "[rigid a]\nshape = circle 0, 0.95, 0.15\nmass = 3\n"
             "[contact c]\nbetween = a, bed\nrestitution = 0.5\n",
             NULL);
    rig_run(&rig, 0.6);
    assert_near(2e-3, -0.6, state()->x[1], "y at its top");
    assert_near(2e-2, 0, state()->v[1], "vy at its top");
    rig_run(&rig, 1.9);
    assert_near(1e-3, -0.8, state()->x[1], "y at rest");
}

/* A [contact] may leave out a pair. */
static void test_contact_of_a_pair_may_be_off(void)
{
    rig_open(&rig,
             "gravity = 0, -10\n" FREE "[wall bed]\nshape = box -1, -0.12, 1, 0\n"
             "[rigid a]\nshape = box 0, 0, 0.3, 0.3\nmass = 3\n"
             "[contact c]\nbetween = a, bed\nenabled = off\n",
             NULL);
    rig_run(&rig, 0.3);
    assert_near(1e-9, -0.45, state()->x[1], "y");
}

static void test_bad_input_is_refused(void)
{
    rig_refuses(FREE "[wall a]\nshape = box 0, 0, 1, 1\n[wall b]\nshape = box 2, 0, 3, 1\n"
                     "[rigid c]\nshape = box 4, 0, 5, 1\ndensity = 1\n"
                     "[contact d]\nbetween = a, b\n",
                "one of the two must be a [solid], [rigid] or [beam]");
    rig_refuses(FREE "[solid a]\nshape = box 0, 0, 1, 1\ndensity = 1000\nyoung = 1e6\n"
                     "poisson = 0.3\n[contact d]\nrestitution = 0.5\n",
                "has a `restitution`, which only a [rigid] uses");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_disc_on_a_slope);
    RUN_TEST(test_a_box_on_a_slope);
    RUN_TEST(test_a_belt_takes_a_box_along);
    RUN_TEST(test_a_spinning_disc_hits_another);
    RUN_TEST(test_a_disc_bounces);
    RUN_TEST(test_contact_of_a_pair_may_be_off);
    RUN_TEST(test_bad_input_is_refused);
    return UNITY_END();
}
