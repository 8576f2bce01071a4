/* SPDX-License-Identifier: MIT
 * Hinges between rigid bodies (T-99a), and what acts in hinges: a double pendulum against its own
 * equations, a chain, a free pair, springs, dampers, friction, a driven angle. */
#include "rig.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <string.h>

static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

#define FREE "dp = 3 cm\nend_time = 5\n[domain]\nlower = -20, -20\nupper = 20, 20\n"

static const struct rigid_state *state(void) { return rig.sim.rigid.state; }

/* Where a body has a point that begins at (x, y). */
static void place_of(int k, double x, double y, double at[2])
{
    const struct rigid_state *const s = &state()[k];
    const double *const g = rig.scene.rigid_mass[k].centre;
    const double c = cos(s->x[2]), n = sin(s->x[2]);
    at[0] = g[0] + s->x[0] + c * (x - g[0]) - n * (y - g[1]);
    at[1] = g[1] + s->x[1] + n * (x - g[0]) + c * (y - g[1]);
}

static double gap_at(int a, int b, double x, double y)
{
    double p[2], q[2];
    place_of(a, x, y, p);
    place_of(b, x, y, q);
    return hypot(p[0] - q[0], p[1] - q[1]);
}

/* Two bars of mass m, length 1 and inertia I about their centres: angles from horizontal. */
#define BAR_MASS 2.0
#define BAR_INERTIA (BAR_MASS * (1 + 0.01) / 12)
static void rates(const double y[4], double dy[4])
{
    const double m = BAR_MASS, I = BAR_INERTIA, g = 10, c = cos(y[0] - y[1]), s = sin(y[0] - y[1]);
    const double A = I + 0.25 * m + m, B = 0.5 * m * c, D = I + 0.25 * m;
    const double f = -0.5 * m * s * y[3] * y[3] - 1.5 * m * g * cos(y[0]);
    const double h = 0.5 * m * s * y[2] * y[2] - 0.5 * m * g * cos(y[1]);
    dy[0] = y[2];
    dy[1] = y[3];
    dy[2] = (D * f - B * h) / (A * D - B * B);
    dy[3] = (A * h - B * f) / (A * D - B * B);
}

static void integrate(double y[4], double time, int n)
{
    static const double part[] = {0, 0.5, 0.5, 1}, weight[] = {1, 2, 2, 1};
    for (int k = 0; k < n; k++) {
        double d[4] = {0}, sum[4] = {0};
        for (int stage = 0; stage < 4; stage++) {
            double at[4];
            for (int c = 0; c < 4; c++) at[c] = y[c] + part[stage] * time / n * d[c];
            rates(at, d);
            for (int c = 0; c < 4; c++) sum[c] += weight[stage] * d[c];
        }
        for (int c = 0; c < 4; c++) y[c] += time / n / 6 * sum[c];
    }
}

#define PENDULUM                                                                     \
    "gravity = 0, -10\n" FREE "[rigid a]\nshape = box 0, -0.05, 1, 0.05\nmass = 2\n" \
    "hinge = 0, 0\n[rigid b]\nshape = box 1, -0.05, 2, 0.05\nmass = 2\nhinge = 1, 0, a\n"

static void test_a_double_pendulum(void)
{
    double y[4] = {0};
    rig_open(&rig, PENDULUM, NULL);
    rig_run(&rig, 1);
    integrate(y, 1, 20000);
    assert_near(1e-5, y[0], state()[0].x[2], "angle of the first bar");
    assert_near(1e-5, y[1], state()[1].x[2], "angle of the second bar");
    assert_near(1e-11, 0, gap_at(0, 1, 1, 0), "distance in the hinge");
    assert_near(1e-5 * 60, 0, simulation_ledger(&rig.sim).dissipated, "dissipated");
}

/* Where a pendulum hangs, its hinges carry its weight. */
static void test_hinges_carry_a_chain(void)
{
    rig_open(
        &rig,
        "gravity = 0, -10\n" FREE "[rigid a]\nshape = box -0.05, -1, 0.05, 0\nmass = 2\n"
        "hinge = 0, 0\n[rigid b]\nshape = box -0.05, -2, 0.05, -1\nmass = 3\nhinge = 0, -1, a\n"
        "[rigid c]\nshape = box -0.05, -3, 0.05, -2\nmass = 4\nhinge = 0, -2, b\n",
        NULL);
    rig_run(&rig, 0.5);
    assert_near(1e-6, 90, state()[0].reaction[1], "first hinge");
    assert_near(1e-6, 70, state()[1].reaction[1], "second hinge");
    assert_near(1e-6, 40, state()[2].reaction[1], "third hinge");
    assert_near(1e-9, 0, state()[2].x[1], "y");
}

/* Without anything that holds them two bars keep momentum, angular momentum and energy. */
static void test_a_free_pair(void)
{
    rig_open(&rig,
             FREE "[rigid a]\nshape = box 0, -0.05, 1, 0.05\nmass = 2\nspin = 3\n"
                  "[rigid b]\nshape = box 1, -0.05, 2, 0.05\nmass = 1\nspin = -2\nvelocity = 0, 1\n"
                  "hinge = 1, 0, a\n",
             NULL);
    double before[3] = {0};
    for (int turn = 0; turn < 2; turn++) {
        double now[3] = {0};
        for (int k = 0; k < 2; k++) {
            const struct rigid_mass *const m = &rig.scene.rigid_mass[k];
            const struct rigid_state *const s = &state()[k];
            const double x = m->centre[0] + s->x[0], y = m->centre[1] + s->x[1];
            now[0] += m->mass * s->v[0];
            now[1] += m->mass * s->v[1];
            now[2] += m->inertia * s->v[2] + m->mass * (x * s->v[1] - y * s->v[0]);
        }
        for (int c = 0; c < 3 && turn; c++) assert_near(1e-6, before[c], now[c], "momentum");
        memcpy(before, now, sizeof before);
        if (!turn) rig_run(&rig, 2);
    }
    assert_near(1e-11, 0, gap_at(0, 1, 1, 0), "distance in the hinge");
    assert_near(1e-6, 0, simulation_ledger(&rig.sim).dissipated, "dissipated");
}

#define DISC_IN_RING                                                              \
    "[rigid a]\nshape = circle 0, 0, 0.2\nmass = 0.5\ninertia = 0.01\nspin = 4\n" \
    "[rigid b]\nshape = circle 0, 0, 0.5\nminus = circle 0, 0, 0.3\nmass = 1.5\n" \
    "inertia = 0.03\nhinge = 0, 0, a\n"

/* A disc in a ring, the relative angle on a spring of 8 N with the inertias 0.01 and 0.03:
 * they swing at the frequency of the reduced inertia, and a damper of the ratio 0.1 takes energy.
 */
static void test_a_spring_between_two_bodies(void)
{
    static const char *const damping[] = {"c=0", "c=0.0489897949"};
    const double reduced = 0.01 * 0.03 / 0.04, omega = sqrt(8 / reduced), t = 0.3;
    for (int k = 0; k < 2; k++) {
        rig_open(&rig,
                 FREE "[constants]\nc = 0\n" DISC_IN_RING
                      "hinge_stiffness = 8 N\nhinge_damping = c\n",
                 damping[k], NULL);
        rig_run(&rig, t);
        const double z = k ? 0.1 : 0, w = omega * sqrt(1 - z * z);
        const double apart = 4 / w * exp(-z * omega * t) * sin(w * t);
        assert_near(2e-4, apart, state()[0].x[2] - state()[1].x[2], "angle between them");
        assert_near(1e-7, 0.04, 0.01 * state()[0].v[2] + 0.03 * state()[1].v[2], "momentum");
        if (k == 0) assert_near(1e-6, 0, simulation_ledger(&rig.sim).dissipated, "dissipated");
    }
}

/* Friction of 0.03 N stops 4/s between them after 4 x 0.0075/0.03 = 1 s; then they turn
 * together. */
static void test_friction_between_two_bodies(void)
{
    rig_open(&rig, FREE DISC_IN_RING "hinge_friction = 0.03 N\n", NULL);
    rig_run(&rig, 0.5);
    assert_near(1e-4, 2, state()[0].v[2] - state()[1].v[2], "half of the rate");
    rig_run(&rig, 1.5);
    assert_near(1e-9, 1, state()[0].v[2], "spin of a");
    assert_near(1e-9, 1, state()[1].v[2], "spin of b");
    assert_near(1e-4, 0.5 * 0.0075 * 16, simulation_ledger(&rig.sim).dissipated, "dissipated");
}

/* A driven hinge has the angle of its motion, in place and between bodies, and does the work. */
static void test_a_hinge_is_driven(void)
{
    rig_open(&rig,
             FREE "[motion m]\nturn = 0.5*sin(2*pi*t)\ncentre = 9, 9\n"
                  "[rigid a]\nshape = box 0, -0.05, 1, 0.05\nmass = 2\nhinge = 0, 0\n"
                  "hinge_motion = m\n"
                  "[rigid b]\nshape = box 1, -0.05, 2, 0.05\nmass = 1\nhinge = 1, 0, a\n"
                  "hinge_motion = m\n",
             NULL);
    rig_run(&rig, 0.6);
    const double turned = 0.5 * sin(2 * acos(-1) * 0.6);
    assert_near(1e-9, turned, state()[0].x[2], "angle of a");
    assert_near(1e-9, 2 * turned, state()[1].x[2], "angle of b");
    assert_near(1e-11, 0, gap_at(0, 1, 1, 0), "distance in the hinge");
    assert_near(1e-4, 0, simulation_ledger(&rig.sim).dissipated, "dissipated");
}

/* A bar hangs on a carriage that accelerates: it turns by m a s/I of the time squared, over two. */
static void test_a_hinge_on_a_carriage(void)
{
#define CARRIAGE                                                                            \
    "[wall w]\nshape = box -0.1, 0, 0.1, 0.1\nmotion = m\n[motion m]\n"                     \
    "x = 0.05*(1 - cos(4*t))\n[rigid a]\nshape = box -0.05, -0.6, 0.05, 0\ndensity = 600\n" \
    "hinge = 0, 0, w\n"
    rig_open(&rig, FREE CARRIAGE, "motion m.x=0.5*t^2", NULL);
    const double m = 36, s = 0.3, inertia = m * (0.36 + 0.01) / 12 + m * s * s;
    rig_run(&rig, 0.05);
    assert_near(1e-6, -0.5 * m * s / inertia * 0.05 * 0.05, state()->x[2], "angle");
    /* The work of the carriage, and of a drive on it. */
    for (int driven = 0; driven < 2; driven++) {
        rig_open(&rig,
                 driven ? "gravity = 0, -9.81\n" FREE CARRIAGE
                          "hinge_motion = n\n[motion n]\nturn = 0.1*(1 - cos(20*t))\n"
                        : "gravity = 0, -9.81\n" FREE CARRIAGE,
                 NULL);
        energy_begin(&rig.sim);
        rig_run(&rig, 0.8);
        assert_at_most(1e-4, rig.sim.state.gain_share, "gain");
    }
}

/* Three bars and two hinges in place have one angle that is free: a second drive contradicts it. */
static void test_drives_of_a_closed_loop(void)
{
#define LOOP(drive)                                                                               \
    FREE "[motion m]\nturn = 0.2*sin(pi/2*t)\ncentre = 9, 9\n"                                    \
         "[rigid a]\nshape = box -0.06, 0, 0.06, 1\nmass = 2\nhinge = 0, 0\nhinge_motion = m\n"   \
         "[rigid b]\nshape = box 0.06, 0.94, 0.94, 1.06\nmass = 1\nhinge = 0.06, 0.96, a\n" drive \
         "[rigid c]\nshape = box 0.94, 0, 1.06, 1\nmass = 1\nhinge = 0.94, 0.96, b\n"             \
         "hinge = 1, 0\n"
    rig_open(&rig, LOOP(""), NULL);
    rig_run(&rig, 0.2);
    assert_near(1e-9, 0.2 * sin(0.1 * acos(-1)), state()->x[2], "driven angle");
    rig_open(&rig, LOOP("hinge_motion = m\n"), NULL);
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, simulation_step(&rig.sim, 0.2, &rig.diag));
    TEST_ASSERT_NOT_NULL(strstr(rig.diag.text, "a hinge of [rigid b] joins are"));
}

/* A body that falls on the end of a bar on a hinge, and a hinge of both: the impact reaches all. */
static void test_an_impact_passes_through_hinges(void)
{
    rig_open(&rig,
             FREE "[rigid a]\nshape = box 0, -0.05, 1, 0.05\nmass = 2\n"
                  "[rigid b]\nshape = box 1, -0.05, 2, 0.05\nmass = 1\nhinge = 1, 0, a\n"
                  "[rigid c]\nshape = circle 1.5, 0.5, 0.2\nmass = 1\nvelocity = 0, -2\n",
             NULL);
    rig_run(&rig, 0.5);
    double momentum = 0;
    for (int k = 0; k < 3; k++) momentum += rig.scene.rigid_mass[k].mass * state()[k].v[1];
    assert_near(1e-6, -2, momentum, "momentum");
    TEST_ASSERT_TRUE(state()[1].v[1] < -0.1);
    assert_near(1e-11, 0, gap_at(0, 1, 1, 0), "distance in the hinge");
}

/* A wall that turns back at once gives a body hinged at its centre as much energy as it takes, and
 * one that is hinged at its face the energy of the turn. */
static void test_a_hinge_on_a_wall_with_a_kink(void)
{
    for (int face = 0; face < 2; face++) {
        rig_close(&rig);
        rig_open(&rig,
                 "dp = 1 cm\nend_time = 1\n[wall bed]\nshape = box -0.2, -0.05, 0.6, 0\n"
                 "motion = m\n[motion m]\nx = -0.1*abs(t - 0.1)\n[rigid r]\n"
                 "shape = box 0.1, 0.05, 0.2, 0.1\ndensity = 500\nhinge = 0.15, 0.075, bed\n",
                 face ? "r.hinge=0.15,0.05,bed" : NULL, NULL);
        rig_run(&rig, 0.2);
        assert_near(2e-8, 0, simulation_ledger(&rig.sim).dissipated, "dissipated");
    }
}

static void test_bad_input_is_refused(void)
{
#define BOX "[rigid a]\nshape = box 0, 0, 1, 1\ndensity = 1\n"
    rig_refuses(FREE BOX "hinge = 0, 0, a\n", "is no [wall] and no other [rigid]");
    rig_refuses(FREE BOX "hinge = 0, 0, waal\n[wall wall]\nshape = box -2, -2, -1, -1\n",
                "waal is no [wall] and no other [rigid]; did you mean `wall`?");
    rig_refuses(FREE BOX "hinge_motion = m\n[motion m]\nx = t\n", "no `hinge`");
    rig_refuses(FREE BOX "hinge = 0, 0\nhinge_motion = m\nhinge_friction = 1\n"
                         "[motion m]\nturn = t\n",
                "leave one out");
    rig_refuses(FREE BOX "hinge = 0, 0\nhinge_motion = m\n[motion m]\nx = t\n",
                "has the `hinge_motion` m, which has no angle");
    rig_refuses(FREE BOX "hinge = 0, 0\nhinge = 0.5, 0, b\nhinge_motion = m\n"
                         "[rigid b]\nshape = box 2, 0, 3, 1\ndensity = 1\n"
                         "[motion m]\nturn = t\n",
                "has a `hinge_motion` and 2 hinges");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_double_pendulum);
    RUN_TEST(test_hinges_carry_a_chain);
    RUN_TEST(test_a_free_pair);
    RUN_TEST(test_a_spring_between_two_bodies);
    RUN_TEST(test_friction_between_two_bodies);
    RUN_TEST(test_a_hinge_is_driven);
    RUN_TEST(test_a_hinge_on_a_carriage);
    RUN_TEST(test_drives_of_a_closed_loop);
    RUN_TEST(test_an_impact_passes_through_hinges);
    RUN_TEST(test_a_hinge_on_a_wall_with_a_kink);
    RUN_TEST(test_bad_input_is_refused);
    return UNITY_END();
}
