/* SPDX-License-Identifier: MIT
 * Fluid and structure: equal and opposite forces (Eq. 21), and what follows for momentum. */
#include "rig.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>

static struct rig rig;
static struct particles *fluid, *solid;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

static void open(const char *text, const char *set, const char *another)
{
    rig_open(&rig, text, set, another, NULL);
    fluid = &rig.sim.particles[KIND_FLUID];
    solid = &rig.sim.particles[KIND_SOLID];
}

/* A fluid particle of rho = 1010 beside one solid particle, h = 1 m apart, no gravity: the solid
 * takes the fluid's pressure P = 1030.5050301001436 Pa and density, m_H = m = 640 kg/m, and
 *   F = m_H m 2 P/rho^2 |grad W| = 640^2 * 2 * 1030.505/1010^2 * 0.34815 = 288.1147585563459 N/m,
 * away from the fluid; the fluid's acceleration is F/640 the other way. */
static void test_pair_by_hand(void)
{
    open("dp = 0.8\nend_time = 1\nprecision = double\n[numerics]\nh_over_dp = 1.25\nskin = 0.5\n"
         "[domain]\nlower = -20, -20\nupper = 20, 20\n"
         "[fluid w]\nshape = box 0, 0, 0.8, 0.8\nsound_speed = 10\nartificial_viscosity = 1\n"
         "[solid s]\nshape = box 4, 0, 6.4, 2.4\ndensity = 3000\nyoung = 1e6\npoisson = 0.3\n",
         NULL, NULL);
    TEST_ASSERT_TRUE(fluid->n == 1 && solid->n == 9);
    for (int64_t i = 0; i < 9; i++) solid->x[i] = 15;
    fluid->x[0] = fluid->y[0] = 0;
    solid->x[4] = 0.6;
    solid->y[4] = 0.8;
    fluid->dens[0] = 0.01;
    fluid->vx[0] = 2; /* approaching: no viscosity between them all the same */
    rig_sort(&rig);
    rig_evaluate(&rig);
    assert_near(1e-9, 1030.5050301001436, solid->p[4], "P_s");
    assert_near(1e-14, 0.01, solid->dens[4], "rho_s/rho0 - 1");
    assert_near(1e-10, 0.6 * 288.1147585563459, solid->fx[4], "fx");
    assert_near(1e-10, 0.8 * 288.1147585563459, solid->fy[4], "fy");
    assert_near(1e-12, -0.6 * 288.1147585563459 / 640, fluid->ax[0], "ax");
    assert_near(1e-12, -0.8 * 288.1147585563459 / 640, fluid->ay[0], "ay");
    TEST_ASSERT_TRUE(solid->fx[0] == 0 && solid->p[0] == 0);
}

/* Fluid around a corner of a structure, all disordered. */
static const char touching[] =
    "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"
    "[fluid water]\nshape = box 0, 0, 0.3, 0.2\nminus = box 0.1, 0, 0.18, 0.12\nsound_speed = 20\n"
    "artificial_viscosity = 0.1\ndensity_diffusion = 0.1\n"
    "[solid block]\nshape = box 0.1, 0, 0.18, 0.12\ndensity = 1500\nyoung = 1e6\npoisson = 0.4\n"
    "viscosity_form = symmetric\n";

static void disorder(void)
{
    uint64_t seed = 3;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        struct particles *const particles = &rig.sim.particles[kind];
        for (int64_t i = 0; i < particles->n; i++) {
            particles->x[i] += 0.002 * noise(&seed);
            particles->y[i] += 0.002 * noise(&seed);
            particles->vx[i] = noise(&seed);
            particles->vy[i] = noise(&seed);
            if (kind == KIND_FLUID) particles->dens[i] = 0.02 + 0.01 * noise(&seed);
            if (kind == KIND_SOLID) particles->wx[i] = noise(&seed);
            if (kind == KIND_SOLID) particles->ax[i] = 30 * noise(&seed);
        }
    }
    rig_sort(&rig);
}

static void carry_off(void *context, double time, const struct particles *particles, double *ax,
                      double *ay)
{
    (void)context, (void)time, (void)particles, (void)ax, (void)ay;
    for (int64_t i = 0; i < fluid->n; i++) fluid->x[i] += 1;
}

/* Nothing of the fluid is left on a structure that it has gone from by the time of sorting. */
static void test_what_is_dry_is_forgotten(void)
{
    open(touching, "integrator=leapfrog", "domain.upper=3, 3");
    TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_set_force_hook(&rig.sim, KIND_FLUID, carry_off, NULL,
                                                            &rig.diag));
    rig.sim.sorting.skin_left = 0;
    rig_steps(&rig, 1, 1);
    for (int64_t i = 0; i < solid->n; i++) {
        TEST_ASSERT_TRUE(solid->p[i] == 0 && solid->dens[i] == 0);
        TEST_ASSERT_TRUE(solid->fx[i] == 0 && solid->fy[i] == 0);
    }
}

/* Total force on the fluid (less gravity) and on the solid, over the sum of sizes. Each pair is
 * computed twice from the same lanes, so that only the rounding of the sums is left. */
static void check_balance(double tolerance)
{
    disorder();
    rig_evaluate(&rig);
    const double mass = rig.sim.fluid.k.mass;
    double sum_x = 0, sum_y = 0, size = 0, on_solid = 0;
    for (int64_t i = 0; i < fluid->n; i++) {
        sum_x += mass * fluid->ax[i];
        sum_y += mass * (fluid->ay[i] + 9.81);
        size += mass * hypot(fluid->ax[i], fluid->ay[i] + 9.81);
    }
    for (int64_t i = 0; i < solid->n; i++) {
        sum_x += solid->fx[i];
        sum_y += solid->fy[i];
        size += hypot(solid->fx[i], solid->fy[i]);
        on_solid += hypot(solid->fx[i], solid->fy[i]);
    }
    TEST_ASSERT_TRUE(on_solid > 1e-2 * size);
    assert_near(tolerance * size, 0, sum_x, "sum of forces, x");
    assert_near(tolerance * size, 0, sum_y, "sum of forces, y");
}

static void test_forces_balance_in_double(void)
{
    open(touching, "precision=double", NULL);
    check_balance(1e-12);
}

static void test_forces_balance_in_mixed(void)
{
    open(touching, "precision=mixed", NULL);
    check_balance(1e-6);
}

/* The solid's acceleration is its own plus f/m_s, once: switching the fluid's force off takes just
 * that away. */
static void test_force_enters_the_solid_once(void)
{
    open(touching, "precision=double", NULL);
    disorder();
    rig_evaluate(&rig);
    enum { MOST = 200 };
    double with[MOST], force[MOST];
    TEST_ASSERT_TRUE(solid->n < MOST);
    solid_stress(&rig.sim.solid, solid);
    solid_forces(&rig.sim.solid, solid);
    for (int64_t i = 0; i < solid->n; i++) {
        with[i] = solid->sx[i];
        force[i] = solid->fx[i];
        solid->fx[i] = 0;
    }
    solid_forces(&rig.sim.solid, solid);
    for (int64_t i = 0; i < solid->n; i++)
        assert_near(1e-12 * fabs(with[i]) + 1e-12, force[i] / (1500 * 1e-4), with[i] - solid->sx[i],
                    "f/m_s");
}

/* A block of fluid hits a free block of solid; no walls, no gravity. */
static const char impact[] =
    "dp = 1 cm\nend_time = 1\n"
    "[fluid water]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\nartificial_viscosity = 0.1\n"
    "density_diffusion = 0.1\nvelocity = 2, -0.5\n"
    "[solid block]\nshape = box 0.11, -0.02, 0.15, 0.09\ndensity = 1200\nyoung = 2e7\npoisson = "
    "0.4\n"
    "viscosity_form = symmetric\nvelocity = -1, 0.3\n"
    "[domain]\nlower = -0.5, -0.5\nupper = 0.8, 0.6\n";

static void check_momentum(const char *precision, const char *rate, double tolerance)
{
    rig_open(&rig, impact, "integrator=symplectic", precision, rate, NULL);
    const struct ledger start = simulation_ledger(&rig.sim);
    rig_run(&rig, 0.04);
    const struct ledger end = simulation_ledger(&rig.sim);
    const double exchanged = rig.sim.state.exchanged;
    TEST_ASSERT_EQUAL_INT64(0, rig.sim.state.lost);
    /* They have met: the impulse is a good part of the fluid's momentum of 10 kg/m * 2 m/s. */
    TEST_ASSERT_TRUE(exchanged > 2);
    assert_near(tolerance * exchanged, start.momentum_x, end.momentum_x, "momentum, x");
    assert_near(tolerance * exchanged, start.momentum_y, end.momentum_y, "momentum, y");
    TEST_ASSERT_TRUE(end.dissipated > 0);
}

static void test_momentum_of_an_isolated_system_in_double(void)
{
    check_momentum("precision=double", "numerics.multirate=off", 1e-12);
    TEST_ASSERT_TRUE(rig.sim.state.solid_substeps == rig.sim.state.steps);
    check_momentum("precision=double", "numerics.multirate=on", 1e-12);
    TEST_ASSERT_TRUE(rig.sim.state.solid_substeps > rig.sim.state.steps);
}

/* Leapfrog: the fluid's momentum half a step behind, and the structure's less the half of a step
 * that its extrapolated force is ahead of the kicks (T-36a). */
static double momentum_of_kicks(int axis)
{
    double sum = 0;
    for (int64_t i = 0; i < fluid->n; i++)
        sum += rig.sim.fluid.k.mass * (axis ? fluid->vy_half[i] : fluid->vx_half[i]);
    for (int64_t i = 0; i < solid->n; i++)
        sum += rig.sim.solid.body[0].mass * (axis ? solid->vy[i] : solid->vx[i]) -
               0.5 * rig.sim.state.dt * (axis ? solid->mean_fy[i] : solid->mean_fx[i]);
    for (int64_t i = 0; solid->interface_impulse_x && i < solid->n; i++) /* T-35b */
        sum -= axis ? solid->interface_impulse_y[i] : solid->interface_impulse_x[i];
    return sum;
}

static void test_momentum_with_leapfrog(void)
{
    static const char *const rates[] = {"numerics.multirate=off", "numerics.multirate=on"};
    for (int k = 0; k < 4; k++) {
        rig_open(&rig, impact, k / 2 ? "precision=double" : "precision=mixed", rates[k % 2],
                 "integrator=leapfrog", NULL);
        fluid = &rig.sim.particles[KIND_FLUID];
        solid = &rig.sim.particles[KIND_SOLID];
        const double start[2] = {momentum_of_kicks(0), momentum_of_kicks(1)};
        for (double t = 0.001; t < 0.04; t += 0.0013) rig_run(&rig, t); /* uneven steps */
        const double exchanged = rig.sim.state.exchanged;
        TEST_ASSERT_TRUE(exchanged > 2);
        const double tolerance = (k / 2 ? 1e-12 : 1e-6) * exchanged;
        assert_near(tolerance, start[0], momentum_of_kicks(0), "momentum, x");
        assert_near(tolerance, start[1], momentum_of_kicks(1), "momentum, y");
    }
}

static void test_momentum_of_an_isolated_system_in_mixed(void)
{
    check_momentum("precision=mixed", "numerics.multirate=off", 1e-6);
    check_momentum("precision=mixed", "numerics.multirate=on", 1e-6);
}

/* A structure that has left the fluid feels no force of it. */
static void test_no_force_out_of_touch(void)
{
    open(impact, "precision=double", NULL);
    for (int64_t i = 0; i < fluid->n; i++) fluid->dens[i] = 0.05;
    for (int64_t i = 0; i < solid->n; i++) solid->fx[i] = solid->p[i] = 17;
    /* The fluid flies off to the left. */
    for (int64_t i = 0; i < fluid->n; i++) fluid->x[i] -= 0.3;
    rig_steps(&rig, 1, 1);
    for (int64_t i = 0; i < solid->n; i++) TEST_ASSERT_TRUE(solid->fx[i] == 0 && solid->p[i] == 0);
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_pair_by_hand);
    RUN_TEST(test_forces_balance_in_double);
    RUN_TEST(test_forces_balance_in_mixed);
    RUN_TEST(test_what_is_dry_is_forgotten);
    RUN_TEST(test_force_enters_the_solid_once);
    RUN_TEST(test_momentum_of_an_isolated_system_in_double);
    RUN_TEST(test_momentum_of_an_isolated_system_in_mixed);
    RUN_TEST(test_momentum_with_leapfrog);
    RUN_TEST(test_no_force_out_of_touch);
    return UNITY_END();
}
