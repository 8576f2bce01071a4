/* SPDX-License-Identifier: MIT
 * Loads and moving clamps: by hand, their work, exact stretches, and that nothing changes without
 * them. */
#include "output/checkpoint.h"
#include "coupling/coupling.h"
#include "solid/loads.h"
#include "time/energy.h"
#include "rig.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct rig rig;
static struct particles *p;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

#define BAR                                                                                        \
    "dp = 1 cm\nend_time = 10\n[solid bar]\nshape = box 0, 0, 0.2, 0.04\ndensity = 1000\nyoung = " \
    "1e6\n"                                                                                        \
    "poisson = 0\nlaw = svk\nartificial_viscosity = 0\n"

static void accelerations(double time)
{
    rig.sim.solid.time = time;
    solid_stress(&rig.sim.solid, p);
    solid_forces(&rig.sim.solid, p);
}

/* m = 0.1 kg/m a particle. A point load; 30 N/m over the four particles of an end; a traction of
 * which each carries dp; a ramp; an expression in place and time. */
static void test_loads_by_hand(void)
{
    static const char text[] = BAR
        "[load point]\nbody = bar\nshape = circle 0.105, 0.005, 2 mm\nforce = 3, -2\n"
        "[load end]\nbody = bar\nshape = box 0.19, 0, 0.2, 0.04\nforce = 30, 0\nhistory = t/0.5\n"
        "[load top]\nbody = bar\nshape = box 0, 0.03, 0.1, 0.04\n"
        "traction = 0, 1000*x\nhistory = sin(2*t)\n";
    RIG_OPEN_SOLID(text, "dp=1 cm");
    accelerations(0.2);
    int loaded = 0;
    for (int64_t i = 0; i < p->n; i++) {
        double ax = 0, ay = 0;
        if (fabs(p->X[i] - 0.105) < 1e-9 && fabs(p->Y[i] - 0.005) < 1e-9) ax = 30, ay = -20;
        if (p->X[i] > 0.19) ax += 0.4 * 7.5 / 0.1;
        if (p->Y[i] > 0.03 && p->X[i] < 0.1) ay += 1000 * p->X[i] * sin(0.4) * 0.01 / 0.1;
        assert_near(1e-11, ax, p->sx[i], "ax");
        assert_near(1e-11, ay, p->sy[i], "ay");
        loaded += ax != 0 || ay != 0;
    }
    TEST_ASSERT_EQUAL_INT(1 + 4 + 10, loaded);
}

/* Force and traction as functions of place and time: the work is that of the same load by
 * `history`. */
static void test_loads_in_time(void)
{
    static const char *const loads[] = {
        "force = 0, 20*sin(300*t)*(1 + x)\n",
        "force = 0, 20*(1 + x)\nhistory = sin(300*t)\n",
        "traction = 0, 500*sin(300*t)*(1 + x)\n",
    };
    double uy[3], work[3];
    for (int k = 0; k < 3; k++) {
        char text[1024];
        snprintf(text, sizeof text,
                 BAR "[load end]\nbody = bar\nshape = box 0.19, 0, 0.2, 0.04\n%s", loads[k]);
        RIG_OPEN_SOLID(text, "dp=1 cm");
        rig_run(&rig, 0.02);
        uy[k] = p->uy[p->n - 1];
        work[k] = rig.sim.state.wall_work;
    }
    for (int k = 1; k < 3; k++) {
        assert_near(1e-9 * fabs(uy[0]), uy[0], uy[k], "displacement");
        assert_near(1e-9 * fabs(work[0]), work[0], work[k], "work");
    }
    TEST_ASSERT_TRUE(fabs(uy[0]) > 1e-6);
}

/* A free bar pushed at one end: momentum is the impulse, and the energy that the load has put in is
 * that of motion and strain. */
static void test_work_of_a_load(void)
{
    const char *const integrators[] = {"integrator=symplectic", "integrator=verlet"};
    for (int k = 0; k < 2; k++) {
        RIG_OPEN_SOLID(
            BAR "[load end]\nbody = bar\nshape = box 0.19, 0, 0.2, 0.04\nforce = 0, 20\nhistory = "
                "min(t/0.02, 1)\n",
            integrators[k]);
        rig_run(&rig, 0.05);
        const struct ledger row = simulation_ledger(&rig.sim);
        const double late =
            k ? 0.5 * rig.sim.dt_solid * 20 : 0; /* Euler takes the force before the step */
        /* The kink of the ramp within a step costs slope dt^2/8. */
        const double kink = 1000 * square(rig.sim.dt_solid) / 8;
        assert_near(1e-12 + kink + late, 20 * 0.02 / 2 + 20 * 0.03, row.momentum_y, "momentum");
        TEST_ASSERT_TRUE(rig.sim.state.wall_work > 0.1);
        assert_at_most(2e-3 * rig.sim.state.wall_work, fabs(row.dissipated), "missing energy");
    }
}

/* nu = 0, at rest by its damping: the end of a bar of length L from the clamp moves by traction
 * L/E, and by less than half a percent of the square of the strain, 1e-4. */
static void test_bar_under_traction(void)
{
    RIG_OPEN_SOLID(BAR
                   "clamp = box 0, 0, 0.02, 0.04\ndamping_time = 5 ms\n"
                   "[load end]\nbody = bar\nshape = box 0.19, 0, 0.2, 0.04\ntraction = 100, 0\n",
                   NULL);
    rig_run(&rig, 0.25);
    for (int64_t i = 0; i < p->n; i++) {
        if (p->X[i] < 0.19) continue;
        /* The clamp's edge lies at 0.02 m, within dp/2 = 2.8 % of the length; the end's centre is
         * dp/2 short of the end. */
        assert_near(0.03 * 1e-4 * 0.175, 1e-4 * 0.175, p->ux[i], "stretch");
    }
}

/* Cells of 1.075 x 1.04 mm: a traction acts on the length of the side that it is drawn on. */
static void test_traction_on_fitted_cells(void)
{
    static const char *const sides[] = {"box 0, 9 mm, 43 mm, 11 mm", "box 42 mm, 0, 44 mm, 11 mm"};
    const double length[] = {43e-3, 10.4e-3};
    for (int k = 0; k < 2; k++) {
        char text[512];
        snprintf(text, sizeof text,
                 "dp = 1.1 mm\nend_time = 1\n[solid bar]\nshape = box 0, 0, 43 mm, 10.4 mm\n"
                 "density = 1000\nyoung = 1e5\npoisson = 0\n"
                 "[load side]\nbody = bar\nshape = %s\ntraction = 0, 100\n",
                 sides[k]);
        RIG_OPEN_SOLID(text, NULL);
        double force = 0;
        for (int64_t n = 0; n < rig.sim.solid.loads->n_loaded; n++)
            force += rig.sim.solid.loads->loaded[n].f[1];
        assert_near(1e-9, 100 * length[k], force, sides[k]);
    }
}

#define SHAKEN BAR "clamp = box 0, 0, 0.03, 0.04\nclamp_motion = shake\n[motion shake]\n"

/* A clamp that moves takes the body along; a steady motion is no motion to the body itself. */
static void test_clamp_moves_the_body(void)
{
    RIG_OPEN_SOLID(SHAKEN "x = 0.5*t\ny = -0.2*t\n", "bar.velocity=0.5, -0.2");
    rig_run(&rig, 0.1);
    for (int64_t i = 0; i < p->n; i++) {
        assert_near(1e-12, 0.05, p->ux[i], "ux");
        assert_near(1e-12, -0.02, p->uy[i], "uy");
    }
    assert_near(1e-9, 0, rig.sim.state.wall_work, "work");
}

/* From rest with 10 m/s^2: the clamp's work is the energy of the bar, part of which is motion. */
static void test_work_of_a_clamp(void)
{
    const char *const integrators[] = {"integrator=symplectic", "integrator=verlet"};
    for (int k = 0; k < 2; k++) {
        RIG_OPEN_SOLID(SHAKEN "y = 5*t^2\n", integrators[k]);
        rig_run(&rig, 0.05);
        const struct ledger row = simulation_ledger(&rig.sim);
        TEST_ASSERT_TRUE(rig.sim.state.wall_work > 0.1);
        assert_at_most(2e-3 * rig.sim.state.wall_work, fabs(row.dissipated), "missing energy");
        for (int64_t i = 0; i < p->n; i++)
            if (p->X[i] < 0.03) {
                assert_near(1e-12, 5 * square(0.05), p->uy[i], "place of the clamp");
                assert_near(1e-12, 10 * 0.05, p->vy[i], "speed of the clamp");
            }
    }
}

static uint64_t bits_after(const char *text, const char *integrator, const char *velocity)
{
    RIG_OPEN_SOLID(text, integrator, velocity);
    rig_run(&rig, 0.01);
    /* But for who is called free. */
    for (int64_t i = 0; i < p->n; i++) p->free[i] = 1;
    return particles_hash(p, 1);
}

/* A clamp that moves by nothing and a load of nothing leave the bits of a clamp at rest and no
 * load. */
static void test_zero_changes_no_bit(void)
{
    const char *const integrators[] = {"integrator=symplectic", "integrator=verlet"};
    for (int k = 0; k < 2; k++) {
        const uint64_t plain =
            bits_after(BAR "clamp = box 0, 0, 0.03, 0.04\n", integrators[k], "bar.velocity=x, 3*x");
        const uint64_t driven = bits_after(SHAKEN "x = 0\n[load n]\nbody = bar\nforce = 0, 0\n"
                                                  "shape = box 0.1, 0, 0.2, 0.02\n",
                                           integrators[k], "bar.velocity=x, 3*x");
        TEST_ASSERT_EQUAL_HEX64(plain, driven);
    }
}

static const char both[] =
    SHAKEN "y = t*(0.1 + 5*t)\n[load end]\nbody = bar\nshape = box 0.19, 0, 0.2, 0.04\n"
           "force = 20, 0\nhistory = sin(300*t)\n";

static void test_restart_and_threads(void)
{
    const char *const integrators[] = {"integrator=symplectic", "integrator=verlet"};
    for (int k = 0; k < 2; k++) {
        struct checkpoint image = {0};
        RIG_OPEN_SOLID(both, integrators[k]);
        rig_run(&rig, 0.01);
        TEST_ASSERT_EQUAL_INT(ERR_OK,
                              checkpoint_capture(&image, &rig.sim, "case", "test", &rig.diag));
        checkpoint_seal(&image);
        rig_run(&rig, 0.02);
        const uint64_t whole = simulation_hash(&rig.sim);
        RIG_OPEN_SOLID(both, integrators[k]);
        rig.sim.solid.threads = 3;
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, checkpoint_apply(&image, &rig.sim, &rig.diag),
                                      rig.diag.text);
        rig_run(&rig, 0.02);
        TEST_ASSERT_EQUAL_HEX64(whole, simulation_hash(&rig.sim));
        checkpoint_free(&image);
    }
}

static void test_bad_input(void)
{
#define LOAD BAR "[load l]\n"
    rig_refuses(LOAD "force = 1, 0\nshape = box 0, 0, 0.1, 0.1\n", "lacks `body`");
    rig_refuses(LOAD "body = baa\nforce = 1, 0\nshape = box 0, 0, 0.1, 0.1\n",
                "did you mean `bar`");
    rig_refuses(LOAD "body = bar\nforce = 1, 0\n", "lacks `shape`");
    rig_refuses(LOAD "body = bar\nshape = box 0, 0, 0.1, 0.1\n", "either `force` or `traction`");
    rig_refuses(LOAD "body = bar\nforce = 1, 0\nshape = box 1, 0, 2, 0.1\n",
                "contains no particle");
    rig_refuses(BAR "velocity = t, 0\n", "`t`");
    rig_refuses(BAR "clamp = box 0, 0, 0.02, 0.04\nclamp_motion = m\n", "no [motion] of that name");
    rig_refuses(BAR "clamp_motion = m\n[motion m]\nx = t\n", "no `clamp`");
}

/* Normals of the surface towards the fluid go where a clamp moves, and stay elsewhere. */
static void test_normals_of_driven_particles(void)
{
    RIG_OPEN_SOLID(
        "dp = 1 cm\nend_time = 1\n[fluid w]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\n"
        "[motion m]\nx = 0.1*t\n[solid gate]\nshape = box 0.1, 0, 0.13, 0.2\n"
        "clamp = box 0.1, 0.17, 0.13, 0.2\nclamp_motion = m\ndensity = 1100\nyoung = 1e6\n"
        "poisson = 0.4\n",
        "integrator=leapfrog");
    TEST_ASSERT_NOT_NULL(p->face_x);
    for (int64_t i = 0; i < p->n; i++) p->wet_x[i] = p->wet_y[i] = 1;
    impulse_begin(&rig.sim.coupling, 1e-3);
    int cleared = 0;
    for (int64_t i = 0; i < p->n; i++) {
        const bool driven = p->Y[i] > 0.17;
        TEST_ASSERT_TRUE((p->face_x[i] == 0) == driven && (p->face_y[i] == 0) == driven);
        cleared += driven;
    }
    TEST_ASSERT_EQUAL_INT(9, cleared);
}

/* A centre belongs to a region by its place, to a millionth of dp. */
static void test_edges_of_a_region(void)
{
    static const struct {
        double from;
        int columns;
    } row[] = {{0.1751, 2}, {0.17501, 2}, {0.1749, 3}, {0.175, 3}};
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        char text[1000];
        snprintf(text, sizeof text,
                 BAR "[load end]\nbody = bar\nshape = box %.9g, 0, 0.2, 0.04\nforce = 3, 0\n",
                 row[k].from);
        RIG_OPEN_SOLID(text, NULL);
        TEST_ASSERT_EQUAL_INT64(4 * row[k].columns, rig.sim.solid.loads->n_loaded);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_loads_by_hand);
    RUN_TEST(test_loads_in_time);
    RUN_TEST(test_work_of_a_load);
    RUN_TEST(test_bar_under_traction);
    RUN_TEST(test_traction_on_fitted_cells);
    RUN_TEST(test_clamp_moves_the_body);
    RUN_TEST(test_work_of_a_clamp);
    RUN_TEST(test_zero_changes_no_bit);
    RUN_TEST(test_restart_and_threads);
    RUN_TEST(test_bad_input);
    RUN_TEST(test_normals_of_driven_particles);
    RUN_TEST(test_edges_of_a_region);
    return UNITY_END();
}
