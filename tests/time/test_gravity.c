/* SPDX-License-Identifier: MIT
 * Gravity that varies with time: bodies and fluid that nothing holds follow it, the energy
 * that it gives is booked, and one that is written as an expression but does not vary keeps
 * the bits of a number. */
#include "rig.h"
#include "geometry/motion.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

#define HEAD "dp = 1 cm\nend_time = 1\ngravity = 3*cos(5*t), -9.81 + 20*t\n"
static const char solid[] = HEAD "[solid a]\nshape = box 0, 0, 0.06, 0.04\ndensity = 1100\n"
                                 "young = 1e6\npoisson = 0.4\n";
static const char fluid[] = HEAD "[fluid w]\nshape = box 0, 0, 0.06, 0.04\nsound_speed = 20\n"
                                 "[domain]\nlower = -1, -1\nupper = 1, 1\n";
static const char both[] =
    "dp = 1 cm\nend_time = 1\n[fluid w]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\n"
    "surface = 0.1\n[wall tank]\nshape = polyline thickness -0.03: 0, 0.2; 0, 0; 0.2, 0\n"
    "[solid gate]\nshape = box 0.1, 0, 0.13, 0.2\nclamp = box 0.1, 0.17, 0.13, 0.2\n"
    "density = 1100\nyoung = 1e6\npoisson = 0.4\n";

static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                          "integrator=leapfrog"};
static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

/* All particles have the velocity and the path of a free fall from rest. */
static void falls(enum kind kind, double tolerance)
{
    const struct particles *const particles = &rig.sim.particles[kind];
    const double t = rig.sim.state.time;
    const double v[2] = {0.6 * sin(5 * t), -9.81 * t + 10 * t * t};
    const double d[2] = {0.12 * (1 - cos(5 * t)), -4.905 * t * t + 10.0 / 3 * t * t * t};
    for (int64_t i = 0; i < particles->n; i++) {
        const double X = kind == KIND_SOLID ? particles->X[i] : rig.scene.points[KIND_FLUID].x[0];
        assert_near(tolerance, v[0], particles->vx[i], "vx");
        assert_near(tolerance, v[1], particles->vy[i], "vy");
        if (kind == KIND_SOLID) assert_near(tolerance, d[0], particles->x[i] - X, "x");
        if (kind == KIND_SOLID)
            assert_near(tolerance, d[1], particles->y[i] - particles->Y[i], "y");
    }
}

static void test_bodies_fall_as_gravity_says(void)
{
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig, solid, integrators[k], NULL);
        rig_run(&rig, 0.1);
        falls(KIND_SOLID, 2e-3);
    }
}

static void test_fluid_falls_as_gravity_says(void)
{
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig, fluid, integrators[k], NULL);
        rig_run(&rig, 0.1);
        falls(KIND_FLUID, 5e-3);
    }
}

/* What gravity gives beyond its potential energy at t = 0 is no spurious energy. */
static void test_its_work_is_booked(void)
{
    const char *const scenes[] = {solid, fluid};
    for (size_t k = 0; k < COUNT_OF(scenes); k++) {
        rig_open(&rig, scenes[k], NULL);
        const struct ledger start = simulation_ledger(&rig.sim);
        rig.sim.state.energy_start =
            start.kinetic + start.potential + start.internal + start.elastic + start.hourglass;
        rig_run(&rig, 0.1);
        const struct ledger end = simulation_ledger(&rig.sim);
        assert_at_most(5e-4 * end.kinetic, fabs(end.dissipated), "dissipated");
        TEST_ASSERT_TRUE(fabs(rig.sim.state.wall_work) > 0.05 * end.kinetic);
    }
}

static uint64_t hash_after(const char *gravity, const char *integrator)
{
    rig_open(&rig, both, gravity, integrator, NULL);
    rig_steps(&rig, 60, 1);
    return simulation_hash(&rig.sim);
}

static void test_what_does_not_vary_keeps_its_bits(void)
{
    for (size_t k = 0; k < COUNT_OF(integrators); k++)
        TEST_ASSERT_EQUAL_HEX64(hash_after("gravity=1, -9.81", integrators[k]),
                                hash_after("gravity=1, -9.81 + 0*t", integrators[k]));
}

#define SHAKE                                           \
    "[table gx]\nfile = test_gravity.tmp\ncolumn = 2\n" \
    "[table gy]\nfile = test_gravity.tmp\ncolumn = 3\n"

static void open_with_table(const char *gravity, const char *rows)
{
    FILE *const table = fopen("test_gravity.tmp", "w");
    TEST_ASSERT_NOT_NULL(table);
    fputs(rows, table);
    fclose(table);
    char text[sizeof solid + sizeof SHAKE];
    snprintf(text, sizeof text, "%s%s", solid, SHAKE);
    rig_open(&rig, text, gravity, NULL);
    remove("test_gravity.tmp");
}

/* Straight between rows, which need not begin at zero, and constant outside of them. */
static void test_a_table_between_its_rows(void)
{
    static const double at[][3] = {{0, 2, 1},    {0.1, 2, 1},  {0.125, 1.5, 1.25}, {0.2, 0, 2},
                                   {0.35, 3, 0}, {0.5, 6, -2}, {9, 6, -2}};
    open_with_table("gravity=1 + gx(t), gy(t) - 3", "0.1, 1, 4\n0.2, -1, 5\n0.5, 5, 1\n");
    for (size_t k = 0; k < COUNT_OF(at); k++) {
        double g[2];
        scene_gravity_at(&rig.scene, at[k][0], g);
        assert_near(1e-12, at[k][1], g[0], "gx");
        assert_near(1e-12, at[k][2], g[1], "gy");
    }
}

/* v = 5 t^2 up to 0.05 s, and on with the last row's. */
static void test_a_table_is_added(void)
{
    open_with_table("gravity=gx(t), gy(t) - 1", "# t, gx, gy\n0, 0, 1\n0.05, 0.5, 1\n");
    rig_run(&rig, 0.1);
    const struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++) {
        assert_near(2e-4, 0.5 * 0.05 * 0.5 + 0.5 * 0.05, particles->vx[i], "vx");
        assert_near(1e-12, 0, particles->vy[i], "vy");
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_bodies_fall_as_gravity_says);
    RUN_TEST(test_fluid_falls_as_gravity_says);
    RUN_TEST(test_its_work_is_booked);
    RUN_TEST(test_what_does_not_vary_keeps_its_bits);
    RUN_TEST(test_a_table_between_its_rows);
    RUN_TEST(test_a_table_is_added);
    return UNITY_END();
}
