/* SPDX-License-Identifier: MIT
 * Beams in fluid: a plate below a column of water, a light one, momentum that is exchanged, and
 * still water on both sides. */
#include "output/point_data.h"
#include "rig.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                          "integrator=leapfrog"};
static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

static const struct beam_state *state(int node) { return &rig.sim.beams.state[node]; }

#define COLUMN                                                                            \
    "scheme = standard\ndp = 5 cm\nend_time = 1\ngravity = 0, -9.81\n"                    \
    "[fluid w]\nshape = box 0, 0, 1, 1\nsound_speed = 40\nsurface = 1\n"                  \
    "particle_mass = hydrostatic\ndensity_diffusion = 0.1\nartificial_viscosity = 0.05\n" \
    "[wall side]\nshape = polyline: 0, 2; 0, -0.2\nshape = polyline: 1, -0.2; 1, 2\n"     \
    "[beam b]\nshape = polyline: 0, -0.025; 1, -0.025\n"                                  \
    "clamp = 0, -0.025\nclamp = 1, -0.025\nyoung = 1e9\n"                                 \
    "thickness = 5 cm\n"

/* w L^4/(384 EI) + w L^2/(8 GA), with the plate's own weight; light and heavy plates. */
static void test_a_plate_carries_the_water(void)
{
    static const double density[] = {10, 1000, 8000};
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        char set[40];
        snprintf(set, sizeof set, "b.density=%g", density[k]);
        rig_open(&rig, COLUMN, set, integrators[k], NULL);
        const double w = 9.81 * (1000 + density[k] * 0.05), EI = 1e9 * 1.25e-4 / 12,
                     GA = 5.0 / 12 * 1e9 * 0.05, expected = w / 384 / EI + w / 8 / GA;
        rig_run(&rig, 0.6);
        double mean = 0;
        for (int n = 1; n <= 40; n++) {
            rig_run(&rig, 0.6 + 0.01 * n);
            mean -= state(10)->x[1] / 40;
        }
        assert_near(0.01 * expected, expected, mean, "deflection at mid-span");
    }
}

/* Without gravity, what the beam loses the fluid has, or has still to receive. */
static void test_momentum_is_exchanged(void)
{
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig,
                 "dp = 3 cm\nend_time = 1\n[domain]\nlower = -5, -5\nupper = 5, 5\n"
                 "[fluid w]\nshape = box 0.03, 0, 0.6, 0.6\nsound_speed = 20\n"
                 "[beam b]\nshape = polyline: 0, -0.1; 0, 0.6\nthickness = 5 mm\nyoung = 1e8\n"
                 "density = 2000\nvelocity = 1, 0\n",
                 integrators[k], NULL);
        rig_run(&rig, 0.06);
        const struct ledger row = simulation_ledger(&rig.sim);
        const double all = 2000 * 5e-3 * 0.7;
        assert_at_most(0.7, state(12)->v[0], "velocity after the impact");
        /* The pressure that returns the impulse acts on a wetted surface that changes meanwhile.
         * Verlet's two solutions have the momentum in their mean. */
        assert_near(k == 1 ? 0.03 * all : 3e-4 * all, all, row.momentum_x, "momentum, x");
        assert_near(k == 1 ? 0.03 * all : 3e-4 * all, 0, row.momentum_y, "momentum, y");
    }
}

/* A dam break hits a plate of a quarter of the mass of a layer of water. */
static void test_a_violent_exchange_gains_little(void)
{
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig,
                 "dp = 20 mm\nend_time = 0.5\ngravity = 0, -9.81\n"
                 "[fluid w]\nshape = box 0, 0, 0.6, 0.4\nsound_speed = 40\nsurface = 0.4\n"
                 "[wall tank]\nshape = polyline: 0, 0.8; 0, 0; 1.2, 0; 1.2, 0.8\n"
                 "[beam b]\nshape = polyline: 0.8, 0; 0.8, 0.3\nclamp = 0.8, 0\nyoung = 1e9\n"
                 "poisson = 0.3\ndensity = 1200\nthickness = 4 mm\n",
                 integrators[k], NULL);
        rig_run(&rig, 0.5);
        assert_at_most(k == 1 ? 0.02 : 0.01, rig.sim.state.gain_share, "gain");
    }
}

/* Plates in still water that a spring of the water along them would tear: one of the water's
 * density stands, one of a hundredth of it floats. */
static void test_light_plates_in_still_water(void)
{
    static const char *const scene[] = {
        "shape = box 0, 0, 1, 0.5\nsurface = 0.5\n"
        "[wall tank]\nshape = polyline: 0, 0.7; 0, 0; 1, 0; 1, 0.7\n"
        "[beam b]\nshape = polyline: 0.5, 0; 0.5, 0.3\nclamp = 0.5, 0\nthickness = 5 mm\n"
        "mass = 5\nbending_stiffness = 482\nshear_stiffness = 9.6e7\naxial_stiffness = 5.8e5\n",
        "shape = box 0, -0.5, 1, 0\nsurface = 0\n"
        "[wall tank]\nshape = polyline: 0, 0.25; 0, -0.5; 1, -0.5; 1, 0.25\n"
        "[beam b]\nshape = polyline: 0.0125, 0; 0.9875, 0\nthickness = 1.25 mm\n"
        "mass = 0.0125\nbending_stiffness = 239\nshear_stiffness = 7.6e8\n"
        "axial_stiffness = 2.9e5\n"};
    for (size_t k = 0; k < COUNT_OF(scene); k++) {
        char text[1000];
        snprintf(text, sizeof text,
                 "dp = 25 mm\nend_time = 1\ngravity = 0, -9.81\n[fluid w]\nsound_speed = 100\n"
                 "%sgravity = off\n"
                 "[load l]\nbody = b\nshape = box 0, -0.1, 1, 0.31\ntraction = 20*y, 2*x\n",
                 scene[k]);
        rig_open(&rig, text, "numerics.cfl=0.4", NULL);
        rig_run(&rig, 0.05);
        assert_at_most(1e-3, rig.sim.state.gain_share, "gain");
    }
}

/* A soft and light plate between hinges in still water. Its shortest waves, which no step resolves,
 * change sign from step to step, and fluid answers a step late: without T-104d the run was stopped
 * at 0.05 s. */
static void test_waves_that_no_step_resolves(void)
{
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig,
                 "dp = 10 mm\nend_time = 1\ngravity = 0, -9.81\nscheme = standard\n"
                 "[fluid w]\nshape = box 0, 0, 0.4, 0.2\nsurface = 0.2\nsound_speed = 20\n"
                 "[wall tank]\nshape = polyline: 0, 0.4; 0, 0; 0.4, 0; 0.4, 0.4\n"
                 "[beam b]\nshape = polyline: 0.05, 0.1; 0.35, 0.1\nhinge = 0.05, 0.1\n"
                 "hinge = 0.35, 0.1\nmass = 0.04\naxial_stiffness = 8000\nshear_stiffness = 3333\n"
                 "bending_stiffness = 0.01067\n",
                 integrators[k], NULL);
        rig_run(&rig, 0.08);
        assert_at_most(1e-3, rig.sim.state.gain_share, "gain");
    }
}

/* A beam that is bent to a curvature of k: each dummy of its line has the moment E' t^3/12 k. */
static void test_snapshots_have_what_is_in_the_section(void)
{
    const double k = 1e-5, t = 0.05;
    rig_open(&rig, COLUMN, "b.density=1000", NULL);
    for (int n = 0; n < rig.sim.beams.n_nodes; n++) {
        const double x = rig.sim.beams.node[n].X[0];
        rig.sim.beams.state[n].x[1] = k * x * x / 2;
        rig.sim.beams.state[n].x[2] = k * x;
    }
    const struct particles *const walls = &rig.sim.particles[KIND_WALL];
    const struct thin_line *const line = rig.sim.beams.line[0];
    for (int64_t i = 0; i < walls->n; i++) {
        const int on = i >= line->first && i < line->first + line->given->n_dummies;
        double value[D_COUNT];
        for (int what = D_THICKNESS; what <= D_CURVATURE; what++)
            value[what] = snapshot_value((enum data)what, &rig.sim, KIND_WALL, i, 0);
        TEST_ASSERT_EQUAL_DOUBLE(on * t, value[D_THICKNESS]);
        assert_near(1e-6 * k, on * k, value[D_CURVATURE], "curvature");
        assert_near(1e-6 * 1e9 * t * t * t / 12 * k, on * 1e9 * t * t * t / 12 * k, value[D_MOMENT],
                    "moment");
        assert_near(1e-6 * 1e9 * t * k, 0, value[D_SHEAR_FORCE], "shear force");
    }
}

/* A sheet of nearly no stiffness is unstable in still water, unless it has the damping_time that
 * the message names. */
static void test_a_soft_sheet_needs_damping(void)
{
    static const char sheet[] =
        "dp = 20 mm\nend_time = 1\ngravity = 0, -9.81\n"
        "[fluid w]\nshape = box 0, 0, 0.6, 0.4\nsurface = 0.4\nsound_speed = 25\n"
        "[wall tank]\nshape = polyline: 0, 0.6; 0, 0; 0.6, 0; 0.6, 0.6\n"
        "[beam b]\nshape = polyline: 0.1, 0.2; 0.5, 0.2\nhinge = 0.1, 0.2\nhinge = 0.5, 0.2\n"
        "thickness = 2 mm\ndensity = 1000\naxial_stiffness = 1e5\nbending_stiffness = 0.01\n";
    rig_open(&rig, sheet, NULL);
    rig.diag = (struct diag){0};
    while (rig.sim.state.time < 0.1 && !simulation_step(&rig.sim, 0.1, &rig.diag)) {
    }
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, "damping_time = 0.0054 s in each [beam]"),
                                 rig.diag.text);
    rig_open(&rig, sheet, "b.damping_time=5.4 ms", NULL);
    rig_run(&rig, 0.1);
}

static void test_one_side_is_refused(void)
{
    rig_refuses(COLUMN "[numerics]\nsides = one\n", "would gain energy in fluid with");
}

/* A hull with round edges floats: its inside stays dry as fluid settles. Ten particles had passed
 * the line, which stood up to 0.16 m above the water. */
static void test_settling_does_not_pass_a_line(void)
{
#define EDGE(x, sign)                                                        \
#x sign "d, 0.4 + d; " #x sign "d, 0.4; " #x sign "c, 0.4 - a; " #x sign \
            "b, 0.4 - b; " #x sign "a, 0.4 - c; "
#define HULL                                                                                     \
    EDGE(0.6, "-")                                                                               \
    "0.6, 0.4 - d; 1, 0.4 - d; 1 + a, 0.4 - c; 1 + b, 0.4 - b; 1 + c, 0.4 - a; 1 + d, 0.4; 1 + " \
    "d, 0.4 + d\n"
    rig_open(&rig,
             "dp = 12.5 mm\nend_time = 1\ngravity = 0, -9.81\n[numerics]\nh_over_dp = 2.5\n"
             "[constants]\nd = 37.5 mm\na = 14.3505 mm\nb = 26.516625 mm\nc = 34.6455 mm\n"
             "[fluid w]\nshape = box 0, 0, 1.6, 0.4\nminus = polygon " HULL
             "surface = 0.4\nsound_speed = 20\n"
             "[wall tank]\nshape = polyline: 0, 0.8; 0, 0; 1.6, 0; 1.6, 0.8\n"
             "[beam b]\nshape = polyline: " HULL
             "bending_stiffness = 50\naxial_stiffness = 1e6\nmass = 37.5\n",
             NULL);
    const struct particles *const fluid = &rig.sim.particles[KIND_FLUID];
    for (int64_t i = 0; i < fluid->n; i++) {
        TEST_ASSERT_TRUE(fluid->y[i] < 0.4);
        TEST_ASSERT_FALSE(fluid->x[i] > 0.6 && fluid->x[i] < 1 && fluid->y[i] > 0.3625);
    }
}

/* An end that a clamp, a hinge or a rigid body holds stays at its moving wall, also in the
 * predictor, which places wall and line by different laws. */
static void test_a_held_end_stays_at_its_wall(void)
{
    static const char *const scenes[] = {
        "[wall bed]\nshape = box -0.2, -0.1, 0.6, 0\nmotion = m\n[motion m]\n"
        "y = 0.01*sin(20*t)\n[beam line]\nshape = polyline: 0.3, 0; 0.3, 0.1\nthickness = 4 mm\n"
        "young = 1e7\ndensity = 1000\nclamp = 0.3, 0, bed\n",
        "[wall bed]\nshape = box -0.2, -0.1, 0.6, 0\n[rigid line]\nshape = polyline thickness 0: "
        "0.3, 0; 0.3, 0.1\nmass = 2\ninertia = 0.01\ncentre = 0.3, 0.05\nhinge = 0.3, 0, bed\n"
        "spin = 1\n",
    };
    for (size_t k = 0; k < 2 * COUNT_OF(scenes); k++) {
        char text[800];
        snprintf(text, sizeof text,
                 "dp = 10 mm\nend_time = 1\ngravity = 0, -9.81\n[fluid w]\nsound_speed = 15\n"
                 "shape = box 0, 0, 0.2, 0.1\nsurface = 0.1\n%s",
                 scenes[k / 2]);
        rig_open(&rig, text, k % 2 ? "integrator=leapfrog" : "integrator=symplectic", NULL);
        rig_steps(&rig, 20, 1);
        const struct thin_line *const line = &rig.sim.fluid.lines.line[0];
        TEST_ASSERT_TRUE(line->given->extend[0] > 0);
        TEST_ASSERT_FALSE_MESSAGE(line->tip[0], scenes[k / 2]);
        TEST_ASSERT_TRUE(line->extend[0] == line->given->extend[0]);
    }
}

/* T-111b: below an end that rises from the bed fluid sees fluid. All of the line in the bed hid it,
 * and slowed what ran out below a gate. */
static void test_an_end_leaves_its_wall(void)
{
    rig_open(&rig,
             "dp = 20 mm\nend_time = 1\ngravity = 0, -9.81\n[fluid w]\n"
             "shape = box -0.4, 0, 0, 0.2\nsound_speed = 20\nsurface = 0.2\n[wall tank]\n"
             "shape = polyline: -0.4, 0.6; -0.4, 0; 0.6, 0\n[beam b]\nshape = polyline: 0, 0.3; "
             "0, 1 mm\nclamp = 0, 0.3\nyoung = 1e7\ndensity = 1100\nthickness = 5 mm\n",
             NULL);
    struct beams *const beams = &rig.sim.beams;
    const double h = rig.scene.h, dp = rig.scene.top.dp, way[2] = {0.5 * dp, 0};
    for (double rise = 0; rise < 2; rise += 0.25) {
        const double from[2] = {-0.25 * dp, 1e-3 + (rise - 0.1) * dp};
        beams->state[beams->n_nodes - 1].x[1] = rise * dp;
        beams_place(beams, 0);
        const double seen = rise > 0 ? min2(1, rise + 0.05 * dp / h) : 0;
        assert_near(1e-6, seen,
                    lines_seen(&rig.sim.fluid.lines, &rig.sim.cells, 2 * h, from, way, 0, 1),
                    "weight");
    }
}

/* A stiff float with upright edges, turned in still water, swings as a rigid line of its shape and
 * mass. */
static void test_a_float_with_edges_turns_as_a_rigid_one(void)
{
    static const char *const kind[] = {
        "[rigid f]\nshape = polyline thickness 0: 0.3, 0.525; 0.3, 0.325; 0.9, 0.325; 0.9, 0.525\n"
        "mass = 45\ncentre = 0.6, 0.365\ninertia = 2.598\nspin = 1\n",
        "[beam f]\nshape = polyline: 0.3, 0.525; 0.3, 0.325; 0.9, 0.325; 0.9, 0.525\n"
        "bending_stiffness = 1e5\naxial_stiffness = 1e7\nmass = 45\n"
        "velocity = -(y - 0.365 m), x - 0.6 m\n"};
    double swing[2] = {0};
    for (int k = 0; k < 2; k++) {
        char text[1024];
        snprintf(text, sizeof text,
                 "scheme = standard\ndp = 25 mm\nend_time = 1\ngravity = 0, -9.81\n"
                 "[fluid w]\nshape = box 0, 0, 1.2, 0.4\nminus = box 0.3, 0.325, 0.9, 0.4\n"
                 "sound_speed = 20\nsurface = 0.4\n"
                 "[wall t]\nshape = polyline: 0, 0.8; 0, 0; 1.2, 0; 1.2, 0.8\n%s",
                 kind[k]);
        rig_open(&rig, text, NULL);
        for (int n = 1; n <= 20; n++) {
            rig_run(&rig, 0.02 * n);
            swing[k] = fmax(swing[k], k ? state(rig.sim.beams.n_nodes / 2)->x[2]
                                        : rig.sim.rigid.state[0].x[2]);
        }
    }
    assert_near(0.2 * swing[0], swing[0], swing[1], "largest angle");
}

/* Beams whose mass is given have no rotary inertia; the node that a clamp or hinge holds carries
 * them. */
static void test_a_held_beam_of_given_mass(void)
{
    static const char *const held[] = {"clamp", "hinge"};
    for (size_t k = 0; k < COUNT_OF(held); k++) {
        char text[1024];
        snprintf(text, sizeof text,
                 "scheme = standard\ndp = 25 mm\nend_time = 1\ngravity = 0, -9.81\n"
                 "[fluid w]\nshape = box 0, 0, 0.5, 0.2\nsound_speed = 20\nsurface = 0.2\n"
                 "[wall t]\nshape = polyline: 0, 0.4; 0, 0; 0.5, 0\n"
                 "[beam b]\nshape = polyline: 0.5, 0; 0.5, 0.4\nbending_stiffness = 1e5\n"
                 "axial_stiffness = 1e7\nmass = 10\n%s = 0.5, 0\n",
                 held[k]);
        rig_open(&rig, text, NULL);
        rig_run(&rig, 0.02);
        const struct beam_state *const end = state(rig.sim.beams.n_nodes - 1);
        TEST_ASSERT_TRUE_MESSAGE(end->x[0] > 0 && end->x[0] < 0.1, held[k]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_plate_carries_the_water);
    RUN_TEST(test_momentum_is_exchanged);
    RUN_TEST(test_snapshots_have_what_is_in_the_section);
    RUN_TEST(test_a_violent_exchange_gains_little);
    RUN_TEST(test_light_plates_in_still_water);
    RUN_TEST(test_waves_that_no_step_resolves);
    RUN_TEST(test_a_soft_sheet_needs_damping);
    RUN_TEST(test_one_side_is_refused);
    RUN_TEST(test_settling_does_not_pass_a_line);
    RUN_TEST(test_an_end_leaves_its_wall);
    RUN_TEST(test_a_held_end_stays_at_its_wall);
    RUN_TEST(test_a_float_with_edges_turns_as_a_rigid_one);
    RUN_TEST(test_a_held_beam_of_given_mass);
    return UNITY_END();
}
