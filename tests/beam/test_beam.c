/* SPDX-License-Identifier: MIT
 * Beams: large deflection, a moment that rolls a beam into a circle, frequencies, energy and
 * momentum, a pendulum, clamps that move, and input that is refused. */
#include "rig.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

/* One metre long, 20 elements, bending stiffness 1 N m. */
#define BEAM(rest)                                                        \
    "dp = 5 cm\nend_time = 100\n[beam b]\nshape = polyline: 0, 0; 1, 0\n" \
    "axial_stiffness = 1e6\nbending_stiffness = 1\nmass = 1\n" rest
/* At rest soon: the steps have the damping of backward Euler's. */
#define STATIC "thickness = 5 mm\nmass_damping = 20\ndamping_time = 0.05\n"
#define AT_END "shape = box 0.99, -0.01, 1.01, 0.01\nhistory = min(t/5, 1)\n"

static const struct beam_state *state(int node) { return &rig.sim.beams.state[node]; }
static const struct beam_state *end(void) { return state(rig.sim.beams.n_nodes - 1); }

/* Elastica under a force across its end: Mattiasson 1981, table 1, P L^2/EI = 1, 5, 10. */
static void test_large_deflection_is_that_of_the_elastica(void)
{
    static const struct {
        const char *force;
        double down, back;
    } known[] = {{"load f.force=0,-1", 0.30172, 0.05643},
                 {"load f.force=0,-5", 0.71379, 0.38763},
                 {"load f.force=0,-10", 0.81061, 0.55500}};
    for (size_t k = 0; k < COUNT_OF(known); k++) {
        rig_open(&rig, BEAM(STATIC "clamp = 0, 0\n[load f]\nbody = b\nforce = 0, 0\n" AT_END),
                 "numerics.fixed_step=0.1", known[k].force, NULL);
        rig_run(&rig, 20);
        assert_near(2e-3 * known[k].down, known[k].down, -end()->x[1], "deflection");
        assert_near(3e-3 * known[k].back, known[k].back, -end()->x[0], "shortening");
    }
}

/* 2 pi EI/L bends a beam into a circle, whatever the number of elements. Without contact, which
 * would keep its ends a thickness apart. */
static void test_a_moment_rolls_the_beam_into_a_circle(void)
{
    rig_open(
        &rig,
        BEAM(STATIC
             "clamp = 0, 0\n[load f]\nbody = b\nmoment = 2*pi\n" AT_END) "[contact off]\nenabled = "
                                                                         "off\n",
        "numerics.fixed_step=0.1", NULL);
    rig_run(&rig, 20);
    assert_near(1e-4, 2 * PI, end()->x[2], "rotation of the end");
    assert_near(1e-4, -1, end()->x[0], "the end is at the clamp, x");
    assert_near(1e-4, 0, end()->x[1], "the end is at the clamp, y");
    const double sum = beam_energy(&rig.sim.beams, 0).elastic;
    assert_near(1e-4 * sum, 0.5 * square(2 * PI), sum, "elastic energy");
    double section[4], force[3];
    beam_section_force(&rig.sim.beams, &(struct beam_place){.element = 7, .part = 0.3}, section);
    beam_reaction(&rig.sim.beams, 0, (double[2]){0, 0}, force);
    assert_near(1e-4, 2 * PI, section[2], "moment");
    assert_near(1e-4, 2 * PI, section[3], "curvature");
    assert_near(1e-3, -2 * PI, force[2], "moment of the clamp");
}

/* Times of the rising zeros of a component of a node's velocity. */
static double period(int node, int component, int periods)
{
    double first = 0, v_old = state(node)->v[component], t_old = 0;
    for (int n = -1; n < periods;) {
        rig_steps(&rig, 1, 1e6);
        const double v = state(node)->v[component], t = rig.sim.state.time;
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

/* The first frequencies of Euler and Bernoulli with 20 elements; the velocity at the start is about
 * that of the mode. */
static void test_frequencies_are_those_of_theory(void)
{
    static const struct {
        const char *name, *supports;
        double kl;
        int node;
    } known[] = {
        {"clamped and free", "clamp = 0, 0\nvelocity = 0, 1e-6*x^2*(6-4*x+x^2)\n", 1.8751041, 20},
        {"hinged", "hinge = 0, 0\nhinge = 1, 0\nvelocity = 0, 1e-6*sin(pi*x)\n", PI, 10},
        {"clamped", "clamp = 0, 0\nclamp = 1, 0\nvelocity = 0, 1e-6*x^2*(1-x)^2\n", 4.7300407, 10},
        {"clamped and hinged", "clamp = 0, 0\nhinge = 1, 0\nvelocity = 0, 1e-6*x^2*(1-x)*(3-2*x)\n",
         3.9266023, 12},
        {"free",
         "velocity = 0, 1e-6*(cos(4.7300407*x) + cosh(4.7300407*x) - 0.982502215*"
         "(sin(4.7300407*x) + sinh(4.7300407*x)))\n",
         4.7300407, 10},
    };
    for (size_t k = 0; k < COUNT_OF(known); k++) {
        char text[1000], set[60];
        const double expected = 2 * PI / square(known[k].kl);
        snprintf(text, sizeof text, BEAM("%s"), known[k].supports);
        snprintf(set, sizeof set, "numerics.fixed_step=%.17g", expected / 200);
        rig_open(&rig, text, set, NULL);
        assert_near(1e-3, 1, period(known[k].node, 1, 4) / expected, known[k].name);
    }
}

/* Large motion of a clamped beam under its weight, 100 periods of its first mode. */
static void test_energy_stays_over_100_periods(void)
{
    rig_open(&rig, BEAM("thickness = 5 mm\nclamp = 0, 0\n"), "gravity=0, -2", NULL);
    double top = 0, lost = 0;
    for (int n = 0; n < 10000; n++) {
        rig_steps(&rig, 1, 1e6);
        if (n % 25) continue;
        const struct ledger row = simulation_ledger(&rig.sim);
        top = max2(top, row.kinetic + row.elastic);
        lost = max2(lost, fabs(row.dissipated));
    }
    assert_at_most(1e-6 * top, lost, "energy that was lost or gained");
    TEST_ASSERT_TRUE(top > 0.2);
}

/* A free beam that flies, turns and bends keeps its momentum and angular momentum. */
static void test_a_free_beam_keeps_its_momenta(void)
{
    rig_open(&rig, BEAM("thickness = 5 mm\nvelocity = 0.3 + y, 4*(x - 0.5)^3 + 6*(x - 0.5)\n"),
             "numerics.fixed_step=0.01", NULL);
    const struct beams *const b = &rig.sim.beams;
    double at_start[4] = {0}, now[4];
    for (int step = 0; step < 500; step++) {
        now[0] = now[1] = now[2] = 0;
        const struct body_energy e = beam_energy(b, 0);
        now[3] = e.kinetic + e.elastic;
        for (int k = 0; k < b->n_nodes; k++) {
            const struct beam_state *const s = &b->state[k];
            const double *const m = b->node[k].mass, *const X = b->node[k].X;
            for (int c = 0; c < 2; c++) now[c] += m[c] * s->v[c];
            now[2] +=
                m[0] * ((X[0] + s->x[0]) * s->v[1] - (X[1] + s->x[1]) * s->v[0]) + m[2] * s->v[2];
        }
        for (int c = 0; c < 4 && step == 0; c++) at_start[c] = now[c];
        for (int c = 0; c < 4; c++)
            assert_near(1e-9, at_start[c], now[c], (const char *[]){"px", "py", "L", "energy"}[c]);
        rig_steps(&rig, 1, 1e6);
    }
    TEST_ASSERT_TRUE(fabs(end()->x[2]) > 6);
}

/* A stiff beam on a hinge is a bar: its speed at the bottom, and the force of the hinge. */
static void test_a_hinged_beam_is_a_pendulum(void)
{
    rig_open(&rig,
             "dp = 5 cm\nend_time = 10\ngravity = 0, -9.81\n[beam b]\n"
             "shape = polyline: 0, 0; 1, 0\naxial_stiffness = 1e8\n"
             "bending_stiffness = 1e7\nmass = 3\nhinge = 0, 0\n"
             "[probe r]\nquantity = reaction\nbody = b\n",
             "numerics.fixed_step=0.0005", NULL);
    while (end()->x[2] > -0.5 * PI) rig_steps(&rig, 1, 1e6);
    const double omega2 = 3 * 9.81, over = -0.5 * PI - end()->x[2];
    assert_near(2e-3 * omega2, omega2 * cos(over), square(end()->v[2]), "omega^2");
    assert_near(1e-6, 0, simulation_ledger(&rig.sim).dissipated, "dissipated");
    double mean = 0, force[3];
    for (int n = 0; n < 40; n++) { /* the bar's own oscillation */
        beam_reaction(&rig.sim.beams, 0, (double[2]){0, 0}, force);
        mean += force[1] / 40;
        rig_steps(&rig, 1, 1e6);
    }
    assert_near(0.03 * 73, 3 * 9.81 * 2.5, mean, "force of the hinge");
}

static void test_a_moving_clamp_does_work(void)
{
    rig_open(&rig,
             BEAM("thickness = 5 mm\nclamp = 0, 0\nmotion = shake\n"
                  "[motion shake]\nturn = sin(2*pi*t)\n"),
             "gravity=0, -9.81", "numerics.fixed_step=0.002", NULL);
    rig_run(&rig, 0.25);
    assert_near(1e-9, 1, state(0)->x[2], "the clamp turns");
    rig_run(&rig, 2);
    const struct ledger row = simulation_ledger(&rig.sim);
    TEST_ASSERT_TRUE(fabs(rig.sim.state.wall_work) > 0.1);
    assert_near(1e-8, 0, row.dissipated, "energy");
}

#define HALVES                                                          \
    "dp = 5 cm\nend_time = 100\n"                                       \
    "[beam a]\nshape = polyline: 0, 0; 0.5, 0\naxial_stiffness = 1e6\n" \
    "bending_stiffness = 1\nmass = 1\n" STATIC "clamp = 0, 0\n"         \
    "[beam b]\nshape = polyline: 0.5, 0; 1, 0\naxial_stiffness = 1e6\n" \
    "bending_stiffness = 1\nmass = 1\n" STATIC

/* Two halves joined by a clamp bend as one beam; a hinge passes no moment. */
static void test_beams_are_joined(void)
{
    rig_open(&rig, HALVES "clamp = 0.5, 0, a\n[load f]\nbody = b\nforce = 0, -5\n" AT_END,
             "numerics.fixed_step=0.1", NULL);
    rig_run(&rig, 20);
    assert_near(2e-3 * 0.71379, 0.71379, -end()->x[1], "deflection");
    rig_open(&rig,
             HALVES "hinge = 0.5, 0, a\nclamp = 1, 0\n[load f]\nbody = a\nforce = 0, -0.001\n"
                    "shape = box 0.49, -0.01, 0.51, 0.01\nhistory = min(t/5, 1)\n",
             "numerics.fixed_step=0.1", NULL);
    rig_run(&rig, 40);
    const int middle = rig.sim.beams.beam[0].end_node - 1;
    /* Two cantilevers, each with half of the force. */
    assert_near(2e-7, 5e-4 * 0.125 / 3, -state(middle)->x[1], "deflection at the hinge");
    assert_near(1e-12, state(middle)->x[1], state(middle + 1)->x[1], "both ends");
    assert_near(2e-7, -state(middle)->x[2], state(middle + 1)->x[2], "angles");
    /* A clamp in place holds both. */
    rig_open(&rig,
             HALVES
             "clamp = 0.5, 0, a\nclamp = 0.5, 0\n[load f]\nbody = b\nforce = 0, -0.001\n" AT_END,
             "numerics.fixed_step=0.1", NULL);
    rig_run(&rig, 40);
    assert_near(0, 0, state(middle)->x[1], "the clamp");
    assert_near(2e-7, 1e-3 * 0.125 / 3, -end()->x[1], "deflection beyond the clamp");
}

/* Each of three beams names the next one: the place and the angle of their joint are common. */
static void test_three_beams_are_joined_in_a_ring(void)
{
#define ARM(name, to, joint)                                                             \
    "[beam " name "]\nshape = polyline: 0, 0; " to "\naxial_stiffness = 1e6\nmass = 1\n" \
    "bending_stiffness = 1\nclamp = 0, 0, " joint "\n" STATIC
    rig_open(&rig,
             "dp = 5 cm\nend_time = 100\n" ARM("a", "-0.5, 0",
                                               "b") "clamp = -0.5, 0\n" ARM("b", "0.5, 0", "c")
                 ARM("c", "0, 0.1", "a") "[load f]\nbody = b\n"
                                         "force = 0, -0.001\nshape = box 0.49, "
                                         "-0.01, 0.51, 0.01\n",
             "numerics.fixed_step=0.1", NULL);
    rig_run(&rig, 40);
    const struct beams *const beams = &rig.sim.beams;
    const struct beam_state *const joint[] = {&beams->state[beams->beam[0].first_node],
                                              &beams->state[beams->beam[1].first_node],
                                              &beams->state[beams->beam[2].first_node]};
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++) assert_near(1e-15, joint[0]->x[c], joint[k]->x[c], "the joint");
    /* A cantilever of 1 m. */
    assert_near(2e-6, 1e-3 / 3, -state(beams->beam[1].end_node - 1)->x[1], "deflection");
    assert_near(1e-6, 1e-3 * 0.375, -joint[0]->x[2], "angle");
}

static void test_bad_input_is_refused(void)
{
#define LINE "dp = 5 cm\nend_time = 1\n[beam b]\nshape = polyline: 0, 0; 1, 0\n"
    rig_refuses(LINE "young = 1e6\nthickness = 1 mm\n", "has no mass");
    rig_refuses(LINE "young = 1e6\nmass = 1\n", "lacks `thickness`");
    rig_refuses(LINE "mass = 1\nbending_stiffness = 1\n", "lacks `axial_stiffness`");
    rig_refuses(BEAM("element = 1 um\n"), "has 1000000 elements; at most 10000");
    rig_refuses(BEAM("thickness = 2\n"), "is a [solid]");
    rig_refuses("dp = 5 cm\nend_time = 1\n[beam b]\nshape = polyline: 0, 0; 1, 0; 0.5, 0\n"
                "mass = 1\naxial_stiffness = 1\nbending_stiffness = 1\n",
                "turns back on itself");
    rig_refuses("dp = 5 cm\nend_time = 1\n[beam b]\nshape = polyline: 0, 0; 1, 0; 1, 1; 0.5, -1\n"
                "mass = 1\naxial_stiffness = 1\nbending_stiffness = 1\n",
                "crosses itself");
    rig_refuses(BEAM("[probe p]\nquantity = stress\nbody = b\npoint = 1, 0\n"),
                "[beam b] has no such quantity");
    rig_refuses(HALVES "clamp = 0.53, 0, a\n", "give both lines a point there");
    rig_refuses(BEAM("hinge = 0.5, 0.2\n"), "hinge = 0.5, 0.2 is 0.2 m from the beam");
    rig_refuses(BEAM("motion = m\n[motion m]\n"), "neither `clamp` nor `hinge`");
    rig_refuses(BEAM("clamp = 0, 0, w\nmotion = m\n[motion m]\n"
                     "[wall w]\nshape = box -1, -1, 0, 1\n"),
                "neither `clamp` nor `hinge` for it to move; add one without NAME");
    rig_refuses(
        BEAM("clamp = 0, 0, flor\n[wall floor]\nshape = box -1, -1, 0, 1\n"),
        "[beam b] clamp: flor is no [wall], [rigid] or other [beam], which may hold a beam; "
        "did you mean `floor`?");
    rig_refuses(BEAM("[load f]\nbody = b\nforce = 0, 1\nshape = box 2, 2, 3, 3\n"),
                "contains no node of [beam b]");
    rig_refuses(BEAM("velocity = 0, 1/(x - 0.5)\n"),
                "[beam b] velocity is not finite at (0.5, 0) m");
    rig_refuses("dp = 5 cm\nend_time = 1\n[beam b]\nshape = box 0, 0, 1, 1\nmass = 1\n"
                "axial_stiffness = 1\nbending_stiffness = 1\n",
                "a beam is a line");
    static const char *const held[][2] = {{"clamp = 0, 1, b\n", "are 1 m apart"},
                                          {"clamp = 0, 1, c\n", "clamp: c is no [wall]"}};
    for (size_t k = 0; k < COUNT_OF(held); k++) {
        char text[400];
        snprintf(text, sizeof text, "%s%s",
                 BEAM("[beam c]\nshape = polyline: 0, 1; 1, 1\nmass = 1\naxial_stiffness = 1\n"
                      "bending_stiffness = 1\n"),
                 held[k][0]);
        rig_refuses(text, held[k][1]);
    }
}

#define BAR_OF(thickness, name, line)                                          \
    "[beam " name "]\nshape = polyline: " line "\nthickness = " thickness "\n" \
    "young = 1e9\ndensity = 1000\n"
#define BAR(name, line) BAR_OF("1 mm", name, line)
#define THICK(name, line) BAR_OF("50 mm", name, line)
#define DRY "dp = 1 cm\nend_time = 1\n"

/* Contact keeps beams on their side of what they meet, so they must begin on one. */
static void test_beams_begin_beside_each_other_and_bodies(void)
{
    static const char *const lies[][2] = {
        {BAR("a", "0, 0; 1, 0") BAR("b", "0.5, -1; 0.5, 1"), "meets [beam a] at (0.5, 0) m"},
        {BAR("a", "0, 0; 1, 0") BAR("b", "0.5, 0; 0.5, 1"), "meets [beam a] at (0.5, 0) m"},
        {BAR("a", "0, 0; 1, 0") BAR("b", "0.2, 0; 1.4, 0"), "meets [beam a]"},
        {BAR("a", "0, 0; 1, 0") "[rigid r]\nshape = box 0.2, -0.1, 0.21, 0.1\ndensity = 1\n",
         "lies in [rigid r] or on its face, at (0.2"},
        {BAR("a", "0, 0; 1, 0") "[rigid r]\nshape = circle 0.5, 0, 1 cm\ndensity = 1\n",
         "lies in [rigid r]"},
        {BAR("a", "0, 0; 1, 0") "[rigid r]\nshape = box 0.2, 0, 0.4, 0.1\ndensity = 1\n",
         "lies in [rigid r] or on its face"},
        {BAR("a", "0, 0; 1, 0") "[wall w]\nshape = box -1, -1, 2, 1\n", "lies in [wall w]"},
        {BAR("a", "0, 0; 1, 0") "[wall w]\nshape = box 1, -1, 2, 1\n",
         "touches [wall w] with a free point, at (1, 0) m"},
        {BAR("a", "0, 0; 1, 0") "[wall w]\nshape = polyline thickness 0: 0.5, -1; 0.5, 1\n",
         "meets the line of [wall w] at (0.5, 0) m"},
        {BAR("a", "0, 0; 1, 0") "[solid s]\nshape = box 0.2, -0.5, 0.8, 0.5\nyoung = 1e6\n"
                                "poisson = 0\ndensity = 1000\n",
         "lies in [solid s]"},
        {THICK("a", "0, 0.005; 1, 0.005") "[wall w]\nshape = box -1, -1, 2, 0\n",
         "lies 0.02 m deep in [wall w] by its thickness of 0.05 m, at ("},
        {THICK("a", "0, 0.02; 1, 0.02") "[wall w]\nshape = polyline thickness 0: -1, 0; 2, 0\n",
         "the lines are 0.02 m apart there, and their thicknesses need 0.025 m"},
        {THICK("a", "0, 0; 1, 0") THICK("b", "0.2, 0.02; 0.8, 0.02"),
         "the lines are 0.02 m apart there, and their thicknesses need 0.05 m"},
    };
    static const char *const lie_beside[] = {
        THICK("a", "0, 0.025; 1, 0.025") "[wall w]\nshape = box -1, -1, 2, 0\n",
        THICK("a", "0, 0; 1, 0.7") "clamp = 0, 0\n[wall w]\nshape = box -1, -1, 0, 1\n",
        THICK("a", "0, 0; 1, 0") THICK("b", "0.01, 0; 0.01, 0.02; 0.5, 0.5") "hinge = 0.01, 0, a\n",
        THICK("a", "0, 0; 1, 0") THICK("b", "0, 0.05; 1, 0.05"),
        BAR("a", "0, 0; 1, 0") BAR("b", "0.5, -1; 0.5, 1") "hinge = 0.5, 0, a\n",
        BAR("a", "0, 0; 1, 0") BAR("b", "0.5, -1; 0.5, 1") "[contact c]\nbetween = a, b\n"
                                                           "enabled = off\n",
        BAR("a", "0, 0; 1, 0; 1, 1; 0, 1; 0, 0") BAR("b", "0.5, 0.1; 0.5, 0.9"),
        BAR("a", "0, 0; 1, 0") "clamp = 1, 0\n[wall w]\nshape = box 1, -1, 2, 1\n",
        BAR("a", "0, 0; 1, 0") "[wall w]\nshape = box 0.4, -1, 0.6, 1\n"
                               "minus = box 0.3, -0.1, 0.7, 0.1\n",
        BAR("a", "0, 0; 1, 0") "[wall w]\nshape = box -1, -1, 2, -0.001\n",
    };
    for (size_t k = 0; k < COUNT_OF(lies); k++) {
        char text[1024];
        snprintf(text, sizeof text, DRY "%s", lies[k][0]);
        rig_refuses(text, lies[k][1]);
    }
    for (size_t k = 0; k < COUNT_OF(lie_beside); k++) {
        char text[1024];
        snprintf(text, sizeof text, DRY "%s", lie_beside[k]);
        rig_open(&rig, text, NULL);
    }
}

/* A line without much bending stiffness falls about its end: its axial force N, of some 100 N/m,
 * buckles elements longer than sqrt(EI/N). The run stops and says so, and shorter ones go on. */
static void test_a_line_needs_short_elements(void)
{
    static const char line[] =
        "dp = 0.05\nend_time = 2\ngravity = 0, -9.81\n[beam b]\nshape = polyline: 0, 0; 1, 0\n"
        "hinge = 0, 0\nmass = 10\naxial_stiffness = 1e6\nbending_stiffness = 0.3\n"
        "[contact off]\nenabled = off\n";
    enum err e = ERR_OK;
    rig_open(&rig, line, NULL);
    while (rig.sim.state.time < 2 && e == ERR_OK) e = simulation_step(&rig.sim, 2, &rig.diag);
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, e);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, "shorter than sqrt(EI/N)"), rig.diag.text);
    rig_open(&rig, line, "beam b.element=0.025", NULL);
    rig_run(&rig, 2);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_large_deflection_is_that_of_the_elastica);
    RUN_TEST(test_a_moment_rolls_the_beam_into_a_circle);
    RUN_TEST(test_frequencies_are_those_of_theory);
    RUN_TEST(test_energy_stays_over_100_periods);
    RUN_TEST(test_a_free_beam_keeps_its_momenta);
    RUN_TEST(test_a_hinged_beam_is_a_pendulum);
    RUN_TEST(test_a_moving_clamp_does_work);
    RUN_TEST(test_beams_are_joined);
    RUN_TEST(test_three_beams_are_joined_in_a_ring);
    RUN_TEST(test_bad_input_is_refused);
    RUN_TEST(test_beams_begin_beside_each_other_and_bodies);
    RUN_TEST(test_a_line_needs_short_elements);
    return UNITY_END();
}
