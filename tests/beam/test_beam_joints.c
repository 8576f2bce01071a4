/* SPDX-License-Identifier: MIT
 * Beams that are clamped or hinged to rigid bodies: frequencies with a tip mass, free flight with
 * its energy and momenta, any ratio of masses, hinges, and input that is refused. */
#include "rig.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

/* One metre long, 20 elements, bending stiffness 1 N m, mass 1 kg/m. */
#define BEAM(rest)                                                        \
    "dp = 5 cm\nend_time = 1e6\n[beam b]\nshape = polyline: 0, 0; 1, 0\n" \
    "axial_stiffness = 1e6\nbending_stiffness = 1\nmass = 1\n" rest

static const struct beam_state *state(int node) { return &rig.sim.beams.state[node]; }

/* Period of a velocity, by its rising zeros. */
static double period(const double *velocity, int periods)
{
    double first = 0, v_old = *velocity, t_old = rig.sim.state.time;
    for (int n = -1; n < periods;) {
        rig_steps(&rig, 1, 1e6);
        const double v = *velocity, t = rig.sim.state.time;
        if (v_old < 0 && v >= 0) {
            const double zero = t_old + (t - t_old) * v_old / (v_old - v);
            if (++n == 0) first = zero;
            if (n == periods) return (zero - first) / periods;
        }
        v_old = v;
        t_old = t;
    }
    return 0;
}

/* Of a cantilever with a body of mass M and inertia J whose centre is e beyond its end: zero at a
 * frequency b^2. */
static double frequency_equation(double b, double M, double J, double e)
{
    const double c = cos(b), s = sin(b), C = cosh(b), S = sinh(b), b4 = pow(b, 4);
    const double w[2] = {c - C, s - S}, w1[2] = {-b * (s + S), b * (c - C)},
                 w2[2] = {-b * b * (c + C), -b * b * (s + S)},
                 w3[2] = {b * b * b * (s - S), -b * b * b * (c + C)};
    double shear[2], moment[2];
    for (int k = 0; k < 2; k++) {
        const double force = b4 * M * (w[k] + e * w1[k]);
        shear[k] = w3[k] + force;
        moment[k] = w2[k] - b4 * J * w1[k] - e * force;
    }
    return (shear[0] * moment[1] - shear[1] * moment[0]) / (C * C);
}

static double first_root(double M, double J, double e)
{
    double low = 1e-3, high = low;
    while (frequency_equation(high, M, J, e) * frequency_equation(low, M, J, e) > 0) high += 1e-3;
    low = high - 1e-3;
    for (int n = 0; n < 60; n++) {
        const double b = 0.5 * (low + high);
        const bool below = frequency_equation(b, M, J, e) * frequency_equation(low, M, J, e) > 0;
        *(below ? &low : &high) = b;
    }
    return low;
}

static void test_a_tip_mass_has_the_frequency_of_theory(void)
{
    for (double M = 1e-3; M < 1001; M *= 10) {
        const double J = 0.02 * M, e = 0.1;
        char text[1000], set[60];
        const double expected = 2 * PI / square(first_root(M, J, e));
        snprintf(text, sizeof text,
                 BEAM("clamp = 0, 0\nclamp = 1, 0, tip\nvelocity = 0, 1e-7*x^2*(3-x)\n"
                      "[rigid tip]\nshape = box 1, -0.1, 1.2, 0.1\nmass = %g\ninertia = %g\n"
                      "velocity = 0, 2.3e-7\nspin = 3e-7\n"),
                 M, J);
        snprintf(set, sizeof set, "numerics.fixed_step=%.17g", expected / 200);
        rig_open(&rig, text, set, NULL);
        char name[40];
        snprintf(name, sizeof name, "mass ratio %g", M);
        assert_near(3e-3, 1, period(&rig.sim.rigid.state[0].v[1], 4) / expected, name);
    }
}

/* Momenta, angular momentum about the origin, and energy of beam and bodies. */
static void sums(double sum[4])
{
    const struct beams *const b = &rig.sim.beams;
    const struct rigid *const r = &rig.sim.rigid;
    struct body_energy e = beam_energy(b, 0);
    memset(sum, 0, 4 * sizeof *sum);
    sum[3] = e.kinetic + e.elastic;
    for (int k = 0; k < b->n_nodes; k++) {
        const double *const m = b->node[k].mass, *const v = b->state[k].v;
        const double x = b->node[k].X[0] + b->state[k].x[0], y = b->node[k].X[1] + b->state[k].x[1];
        for (int c = 0; c < 2; c++) sum[c] += m[c] * v[c];
        sum[2] += m[0] * (x * v[1] - y * v[0]) + m[2] * v[2];
    }
    for (int k = 0; k < r->n; k++) {
        const double *const m = r->body[k].mass, *const v = r->state[k].v;
        const double x = r->body[k].centre[0] + r->state[k].x[0],
                     y = r->body[k].centre[1] + r->state[k].x[1];
        e = rigid_energy(r, k, rig.sim.state.dt);
        sum[3] += e.kinetic + e.elastic;
        for (int c = 0; c < 2; c++) sum[c] += m[c] * v[c];
        sum[2] += m[0] * (x * v[1] - y * v[0]) + m[2] * v[2];
    }
}

/* With turns of any size. */
static void fly(const char *joint, double left, double right, int steps)
{
    char text[1000], name[80];
    snprintf(text, sizeof text,
             BEAM("thickness = 5 mm\n%s = 0, 0, l\n%s = 1, 0, r\n"
                  "velocity = 0.3 + y, 3*(x - 0.5) + 2*x*(x - 0.5)*(x - 1)\n"
                  "[rigid l]\nshape = box -0.2, -0.1, 0, 0.1\nmass = %g\nvelocity = 0.3, -1.8\n"
                  "spin = 3\n"
                  "[rigid r]\nshape = box 1, -0.1, 1.2, 0.1\nmass = %g\nvelocity = 0.3, 1.8\n"
                  "spin = 3\n"),
             joint, joint, left, right);
    rig_open(&rig, text, "numerics.fixed_step=0.003", NULL);
    double start[4], now[4], speed = 0;
    rig_steps(&rig, 1, 1e6); /* the velocities of nodes and bodies meet */
    sums(start);
    for (int c = 0; c < 2; c++) speed += fabs(start[c]);
    for (int step = 0; step < steps; step++) {
        rig_steps(&rig, 1, 1e6);
        if (step % 100) continue;
        sums(now);
        for (int c = 0; c < 4; c++) {
            snprintf(name, sizeof name, "%s of %g and %g, sum %d, step %d", joint, left, right, c,
                     step);
            assert_near(c < 3 ? 1e-8 * (speed + fabs(start[2])) : 1e-3 * start[3], start[c], now[c],
                        name);
        }
    }
    int worst = 0;
    const struct rigid *const r = &rig.sim.rigid;
    TEST_ASSERT_TRUE(rigid_hinge_gap(r, &worst) == 0);
    const double *const x = r->state[1].x, *const tip = state(rig.sim.beams.n_nodes - 1)->x;
    const double turned[2] = {-0.1 * cos(x[2]), -0.1 * sin(x[2])};
    assert_near(1e-8, 1.1 + x[0] + turned[0], 1 + tip[0], "place of the node, x");
    assert_near(1e-8, x[1] + turned[1], tip[1], "place of the node, y");
    if (strcmp(joint, "clamp") == 0) assert_near(1e-7, x[2], tip[2], "angle of the node");
}

static void test_free_flight_keeps_energy_and_momenta(void)
{
    static const double ratio[][2] = {{1, 1}, {1e-3, 1}, {1e-3, 1e-3}, {1e3, 1e-3}, {1e3, 1}};
    for (size_t k = 0; k < COUNT_OF(ratio); k++) {
        fly("clamp", ratio[k][0], ratio[k][1], k ? 1000 : 10000); /* 10000: 100 periods */
        fly("hinge", ratio[k][0], ratio[k][1], 1000);
    }
}

/* A heavy body hangs from a wall by a light beam with hinges: a pendulum. */
static void test_a_body_swings_on_a_hinged_beam(void)
{
    rig_open(&rig,
             "dp = 5 cm\nend_time = 1e6\ngravity = 0, -9.81\n[beam b]\n"
             "shape = polyline: 0, 0; 0, -1\naxial_stiffness = 1e6\nbending_stiffness = 1\n"
             "mass = 1e-3\nhinge = 0, 0\nclamp = 0, -1, bob\nvelocity = -1e-4*y, 0\n"
             "[rigid bob]\nshape = box -0.05, -1.1, 0.05, -1\ncentre = 0, -1\nmass = 10\ninertia = "
             "1e-6\n"
             "velocity = 1e-4, 0\nspin = 1e-4\n",
             "numerics.fixed_step=0.005", NULL);
    assert_near(2e-3, 2 * PI / sqrt(9.81), period(&rig.sim.rigid.state[0].v[0], 3), "period");
}

/* A flap: the body turns about a hinge in place, and a beam prolongs it. */
static void test_a_beam_on_a_body_with_a_hinge_in_place(void)
{
    rig_open(&rig,
             "dp = 5 cm\nend_time = 1e6\ngravity = 9.81, 0\n[beam b]\n"
             "shape = polyline: 0.5, 0; 1, 0\naxial_stiffness = 1e6\nbending_stiffness = 1e4\n"
             "mass = 1\nclamp = 0.5, 0, bar\nvelocity = 0, 1e-3*x\n"
             "[rigid bar]\nshape = box 0, -0.05, 0.5, 0.05\nmass = 0.5\ninertia = 0.010416667\n"
             "hinge = 0, 0\nspin = 1e-3\n",
             "numerics.fixed_step=0.002", NULL);
    const double rod = 2 * PI * sqrt(2.0 / 3 / 9.81);
    assert_near(3e-3 * rod, rod, period(&rig.sim.rigid.state[0].v[2], 3), "period of a rod");
    assert_near(1e-6, 0, simulation_ledger(&rig.sim).dissipated / 1e-3, "energy");
}

/* A steel flap that is heavier than the float from which it hangs takes no energy from the water:
 * with all of its force half a step early the run was unstable within 0.25 s. */
static void test_a_heavy_flap_below_a_light_float(void)
{
    rig_open(&rig,
             "dp = 20 mm\nend_time = 1\ngravity = 0, -9.81\n"
             "[fluid water]\nshape = box 0, 0, 1, 0.4\nminus = box 0.4, 0.3, 0.6, 0.5\n"
             "surface = 0.4\ndensity = 1000\nsound_speed = 20\n"
             "[wall tank]\nshape = polyline: 0, 0.8; 0, 0; 1, 0; 1, 0.8\n"
             "[rigid float]\nshape = box 0.4, 0.3, 0.6, 0.5\ndensity = 100\nvelocity = 0, 0.2\n"
             "[beam flap]\nshape = polyline: 0.5, 0.3; 0.5, 0.2\nthickness = 8 mm\n"
             "density = 7800\nyoung = 30 GPa\nvelocity = 0, 0.2\nclamp = 0.5, 0.3, float\n",
             NULL);
    rig_run(&rig, 0.3);
    assert_at_most(0.01, rig.sim.state.gain_share, "gain");
    const struct beam_state *const root = state(0);
    const double *const x = rig.sim.rigid.state[0].x;
    assert_near(1e-7, x[2], root->x[2], "angle of the flap at the float");
}

/* A raft that turns, with a soft flap below it. The shortest waves of the flap took energy from the
 * water until the run was stopped at 0.38 s (T-104d). */
static void test_a_soft_flap_below_a_raft_that_turns(void)
{
    rig_open(&rig,
             "dp = 10 mm\nend_time = 1\ngravity = 0, -9.81\nscheme = standard\n"
             "[fluid water]\nshape = box 0, 0, 0.8, 0.3\nsurface = 0.3\nsound_speed = 20\n"
             "minus = box 0.3, 0.25, 0.5, 0.35\n"
             "[wall tank]\nshape = polyline: 0, 0.6; 0, 0; 0.8, 0; 0.8, 0.6\n"
             "[rigid raft]\nshape = box 0.3, 0.25, 0.5, 0.35\ndensity = 600\nspin = 3\n"
             "[beam flap]\nshape = polyline: 0.4, 0.25; 0.4, 0.1\nthickness = 4 mm\n"
             "density = 1200\nyoung = 20 MPa\nclamp = 0.4, 0.25, raft\n",
             NULL);
    rig_run(&rig, 0.4);
    assert_at_most(1e-3, rig.sim.state.gain_share, "gain");
}

/* A gap that is not finite is no solution, though those after it are closed. */
static void test_a_gap_that_is_not_finite_is_open(void)
{
    const struct beams *const beams = &rig.sim.beams;
    rig_open(&rig, BEAM("clamp = 1, 0, r\n[rigid r]\nshape = box 1, -0.1, 1.2, 0.1\nmass = 1\n"),
             NULL);
    rig_steps(&rig, 1, 1e6);
    TEST_ASSERT_TRUE(beams_stay_joined(beams));
    beams->step[beams->n_nodes - 1].d[0] = (double)NAN;
    TEST_ASSERT_FALSE(beams_stay_joined(beams));
}

static void test_bad_input_is_refused(void)
{
    rig_refuses(BEAM("clamp = 1, 0, r\nhinge = 1, 0\n[rigid r]\nshape = box 1, -1, 2, 1\n"
                     "mass = 1\n"),
                "another `clamp` or `hinge` holds this point");
    rig_refuses(BEAM("clamp = 1, 0, r\n[beam c]\nshape = polyline: 1, 0; 0.5, 0.5\nyoung = 1e6\n"
                     "thickness = 1 cm\ndensity = 1\nclamp = 1, 0, b\nclamp = 1, 0\n"
                     "[rigid r]\nshape = box 1, -1, 2, 1\nmass = 1\n"),
                "t.cfg:15: more than one `clamp` or `hinge` holds the beams that are joined "
                "at 1, 0");
    rig_refuses(BEAM("clamp = 1, 0, r\n[rigid r]\nshape = box 2, -1, 3, 1\nmass = 1\n"),
                "[rigid r] is more than a spacing from it");
}

/* Holds of a place that move alike are one; others contradict each other. */
static void test_holds_that_move_apart_are_refused(void)
{
#define WALLS                                                            \
    "[wall w]\nshape = box -1, -1, -0.5, -0.5\nmotion = m\n[motion m]\n" \
    "x = t\n[wall o]\nshape = box 2, 2, 3, 3\n"                          \
    "motion = n\n[motion n]\ny = t\n"
#define OTHER(rest)                                             \
    "[beam c]\nshape = polyline: 1, 0; 0.5, 0.5\nyoung = 1e6\n" \
    "thickness = 1 cm\ndensity = 1\n" rest
    rig_refuses(BEAM("clamp = 1, 0, w\n") OTHER("clamp = 1, 0, b\nclamp = 1, 0, o\n") WALLS,
                "t.cfg:15: [beam c] is held at 1, 0 with [motion n], but t.cfg:8 holds this point "
                "with [motion m]; leave one");
    rig_refuses(BEAM("hinge = 1, 0, w\nclamp = 1, 0, o\n") WALLS,
                "t.cfg:9: [beam b] is held at 1, 0 with [motion n], but t.cfg:8 holds this point");
    rig_refuses(BEAM("clamp = 1, 0, w\n") OTHER("hinge = 1, 0, b\nclamp = 1, 0\n") WALLS,
                "t.cfg:15: [beam c] is held at 1, 0 with no motion");
    rig_open(&rig, BEAM("clamp = 1, 0, w\n") OTHER("clamp = 1, 0, b\nclamp = 1, 0, w\n") WALLS,
             NULL);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_tip_mass_has_the_frequency_of_theory);
    RUN_TEST(test_free_flight_keeps_energy_and_momenta);
    RUN_TEST(test_a_body_swings_on_a_hinged_beam);
    RUN_TEST(test_a_beam_on_a_body_with_a_hinge_in_place);
    RUN_TEST(test_a_heavy_flap_below_a_light_float);
    RUN_TEST(test_a_soft_flap_below_a_raft_that_turns);
    RUN_TEST(test_a_gap_that_is_not_finite_is_open);
    RUN_TEST(test_bad_input_is_refused);
    RUN_TEST(test_holds_that_move_apart_are_refused);
    return UNITY_END();
}
