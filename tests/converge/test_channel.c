/* SPDX-License-Identifier: MIT
 * Laminar flow between two plates that starts from rest, against the exact series
 *   u(y, t) = (F/2 nu) y (L - y)
 *     - sum of 4 F L^2/(nu pi^3 (2n + 1)^3) sin((2n + 1) pi y/L) exp(-((2n + 1) pi/L)^2 nu t)
 * (Morris et al. 1997, Eq. 26), and the decay of Taylor-Green vortices in a periodic box. */
#include "rig.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>

static const char channel[] =
    "dp = 0.05 mm\nend_time = 1\ngravity = 1e-4, 0\nprecision = mixed\n"
    "[domain]\nlower = 0, -0.3 mm\nupper = 0.9 mm, 1.3 mm\nperiodic = x\n"
    "[fluid w]\nshape = box 0, 0, 0.9 mm, 1 mm\nsound_speed = 1.25e-4\nlaminar_viscosity = 1e-6\n"
    "[wall plates]\nshape = box 0, -0.3 mm, 0.9 mm, 0\nshape = box 0, 1 mm, 0.9 mm, 1.3 mm\n"
    "slip = none\n";
static const double L = 1e-3, F = 1e-4, nu = 1e-6, top_speed = 1.25e-5;

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

static double exact(double y, double t)
{
    double u = F / (2 * nu) * y * (L - y);
    for (int n = 0; n < 60; n++) {
        const double k = (2 * n + 1) * M_PI / L;
        u -= 4 * F / (nu * k * k * k * L) * sin(k * y) * exp(-k * k * nu * t);
    }
    return u;
}

/* Largest difference from the series, in units of the final top speed. */
static double difference(void)
{
    const struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    double worst = 0;
    for (int64_t i = 0; i < particles->n; i++)
        worst = fmax(worst, fabs(particles->vx[i] - exact(particles->y[i], rig.sim.state.time)));
    return worst / top_speed;
}

/* The profile is right to 0.8 % of the top speed at 20 particles across at all times; half of dp
 * makes the error at least 2.5 times smaller. */
static void test_flow_between_plates(void)
{
    const double times[] = {0.0225, 0.1125, 0.5, 1};
    double error[2][4];
    for (int fine = 0; fine < 2; fine++) {
        rig_open(&rig, channel, fine ? "dp=0.05 mm" : "dp=0.1 mm", NULL);
        for (int k = 0; k < 4; k++) {
            rig_run(&rig, times[k]);
            error[fine][k] = difference();
            if (!fine) continue;
            assert_at_most(0.008, error[1][k], "difference from the series");
            assert_at_most(error[0][k] / 2.5, error[1][k], "error with half of dp");
        }
    }
    TEST_ASSERT_TRUE(rig.sim.state.bound_steps[BOUND_viscous] > 1000);
}

/* Along plates that do not hold it the fluid falls freely: u = F t, to a float's round-off a step.
 */
static void test_plates_without_friction(void)
{
    rig_open(&rig, channel, "plates.slip=free", "dp=0.1 mm", NULL);
    rig_run(&rig, 0.1);
    const struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    for (int64_t i = 0; i < particles->n; i++)
        assert_near(1e-6 * F * 0.1, F * 0.1, particles->vx[i], "speed");
}

#define VORTICES                                            \
    "[domain]\nlower = 0, 0\nupper = 1, 1\nperiodic = xy\n" \
    "[fluid w]\nshape = box 0, 0, 1, 1\n"                   \
    "velocity = -cos(2*pi*x)*sin(2*pi*y), sin(2*pi*x)*cos(2*pi*y)\n"

/* Taylor-Green vortices, L = 1 m, U = 1 m/s, Re = 10: the velocity decays as exp(-8 pi^2 nu t/L^2),
 * to 0.454 in 0.1 s; the rate is right to 2.5 % with h/dp = 1.5, whose lattice gives 0.985 of it
 * (measured 0.989 at 50 particles, 0.974 at 25). Later the particles line up along the stretching
 * streamlines and dissipate more: that is what particle shifting is for. Momentum stays at nothing.
 */
static void test_taylor_green(void)
{
    rig_open(&rig,
             "dp = 0.02\nend_time = 1\nprecision = double\n[numerics]\nh_over_dp = 1.5\n" VORTICES
             "sound_speed = 20\nlaminar_viscosity = 0.1\n"
             "pressure = -250*(cos(4*pi*x) + cos(4*pi*y))\n",
             NULL);
    const double start = simulation_ledger(&rig.sim).kinetic;
    rig_run(&rig, 0.1);
    const struct ledger row = simulation_ledger(&rig.sim);
    const double rate = -0.5 * log(row.kinetic / start) / 0.1;
    assert_near(0.025, 1, rate / (8 * M_PI * M_PI * 0.1), "rate of decay over the exact one");
    assert_at_most(1e-11 * row.mass, fabs(row.momentum_x), "momentum, x");
    assert_at_most(1e-11 * row.mass, fabs(row.momentum_y), "momentum, y");
    TEST_ASSERT_EQUAL_INT64(2500, rig.sim.particles[KIND_FLUID].n);
}

/* At Re = 100 the particles line up and the amplitude, exp(-8 pi^2 0.01 0.4) = 0.729 by theory, is
 * 0.36 at 0.4 s; with shifting 0.52. Held to: at most two thirds of the error are left. */
static void test_shifting_keeps_vortices_alive(void)
{
    double amplitude[2];
    for (int shifted = 0; shifted < 2; shifted++) {
        rig_open(&rig,
                 "dp = 0.02\nend_time = 1\nintegrator = symplectic\n[numerics]\nh_over_dp = "
                 "1.5\n" VORTICES "sound_speed = 10\nlaminar_viscosity = 0.01\n"
                 "pressure = -250*(cos(4*pi*x) + cos(4*pi*y))\n",
                 shifted ? "w.shifting=10" : "w.shifting=0", NULL);
        const double start = simulation_ledger(&rig.sim).kinetic;
        rig_run(&rig, 0.4);
        amplitude[shifted] = sqrt(simulation_ledger(&rig.sim).kinetic / start);
    }
    const double exact = exp(-8 * M_PI * M_PI * 0.01 * 0.4);
    TEST_ASSERT_TRUE(amplitude[1] < exact);
    assert_at_most((exact - amplitude[0]) * 2 / 3, exact - amplitude[1], "missing amplitude");
}

/* In a box without walls the mean density can only be that of the start: without L-9 shifting had
 * raised it by 3 % at 0.4 s at this resolution, with it by 0.3 %. */
static void test_shifting_keeps_the_mean_density(void)
{
    rig_open(&rig,
             "dp = 0.04\nend_time = 1\n[numerics]\nh_over_dp = 1.5\n" VORTICES
             "sound_speed = 10\nlaminar_viscosity = 0.01\nshifting = 10\n"
             "pressure = -250*(cos(4*pi*x) + cos(4*pi*y))\n",
             NULL);
    rig_run(&rig, 0.4);
    const struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    double sum = 0;
    for (int64_t i = 0; i < particles->n; i++) sum += particles->dens[i];
    assert_at_most(0.01, fabs(sum / (double)particles->n), "mean of rho/rho0 - 1");
}

/* As above with h/dp = 2 and the shift at c0/10 for all, which works at the stagnation points where
 * the lattice is torn: kinetic energy 0.957 of the exact one at 0.4 s (0.554 without shifting,
 * 0.747 with each particle's own speed). */
static void test_shifting_at_one_speed_keeps_vortices_whole(void)
{
    rig_open(&rig,
             "dp = 0.02\nend_time = 1\n[numerics]\nh_over_dp = 2\n" VORTICES
             "sound_speed = 10\nlaminar_viscosity = 0.01\ndensity_diffusion = 0.1\n"
             "shifting = 10\nshifting_speed = largest\n"
             "pressure = 1000 - 250*(cos(4*pi*x) + cos(4*pi*y))\n",
             NULL);
    const double start = simulation_ledger(&rig.sim).kinetic;
    rig_run(&rig, 0.4);
    const double share = simulation_ledger(&rig.sim).kinetic / start;
    assert_near(0.06, 1, share / exp(-16 * M_PI * M_PI * 0.01 * 0.4), "energy over the exact one");
}

/* Mean of rho/rho0 - 1 in units of U^2/c0^2, which is the mean pressure over rho U^2. */
static double mean_pressure(void)
{
    const struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    double sum = 0;
    for (int64_t i = 0; i < particles->n; i++) sum += particles->dens[i];
    return 10 * 10 * sum / (double)particles->n;
}

/* 20 s with the standard scheme, long after the vortices have died away (Re = 100). The mean
 * pressure rises once, while the lattice is torn: to 0.41, 0.21 and 0.18 rho U^2 after 1 s with
 * `shifting` 0, 2 and 10. It falls with the flow, to 0.02 at the end. Without L-9 it is 1.1 (2)
 * and 1.7 (10) after 1 s and stays. */
static void test_no_mean_pressure_is_left_of_vortices(void)
{
    static const char *const shifting[] = {"w.shifting=0", "w.shifting=2", "w.shifting=10"};
    for (int k = 0; k < 3; k++) {
        rig_open(&rig,
                 "scheme = standard\ndp = 1/24\nend_time = 20\n" VORTICES
                 "sound_speed = 10\nlaminar_viscosity = 0.01\n"
                 "pressure = -250*(cos(4*pi*x) + cos(4*pi*y))\n",
                 shifting[k], NULL);
        rig_run(&rig, 1);
        assert_at_most(0.6, fabs(mean_pressure()), "mean pressure over rho U^2 after 1 s");
        rig_run(&rig, 20);
        assert_at_most(0.05, fabs(mean_pressure()), "mean pressure over rho U^2 at the end");
    }
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_flow_between_plates);
    RUN_TEST(test_plates_without_friction);
    RUN_TEST(test_taylor_green);
    RUN_TEST(test_shifting_keeps_vortices_alive);
    RUN_TEST(test_shifting_keeps_the_mean_density);
    RUN_TEST(test_shifting_at_one_speed_keeps_vortices_whole);
    RUN_TEST(test_no_mean_pressure_is_left_of_vortices);
    return UNITY_END();
}
