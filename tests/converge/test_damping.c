/* SPDX-License-Identifier: MIT
 * Kelvin-Voigt damping: a uniform rate of strain by hand, balances, the exact decay of a vibrating
 * bar, and the step that it allows. */
#include "rig.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

static struct rig rig;
static struct particles *p;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

static void open(const char *text, const char *set, const char *another)
{
    rig_open(&rig, text, "precision=double", set, another, NULL);
    p = &rig.sim.particles[KIND_SOLID];
}

static const char block[] = "dp = 1 cm\nend_time = 1\n[solid b]\nshape = box 0, 0, 0.13, "
                            "0.06\ndensity = 1000\nyoung = 2e6\n"
                            "poisson = 0.25\nartificial_viscosity = 0\ndamping_time = 1 ms\n";

/* lambda = mu = 0.4 E. Undeformed, dv_x/dX = 3/s and dv_x/dY = 2/s: S_xx = tau (lambda + 2 mu) 3,
 * S_yy = tau lambda 3, S_xy = tau 2 mu (2/2). Turned by 90 degrees, P = F S is S with its rows
 * turned. */
static void test_uniform_rate_by_hand(void)
{
    const double mu = 8e5, tau = 1e-3;
    for (int turned = 0; turned < 2; turned++) {
        open(block, "b.law=svk", "b.plane=strain");
        for (int64_t i = 0; i < p->n; i++) {
            const double v = 3 * p->X[i] + 2 * p->Y[i];
            *(turned ? &p->vy[i] : &p->vx[i]) = v;
            if (turned) p->ux[i] = -p->Y[i] - p->X[i], p->uy[i] = p->X[i] - p->Y[i];
        }
        solid_stress(&rig.sim.solid, p);
        for (int64_t i = 0; i < p->n; i++) {
            const double *const first = turned ? p->Pyx : p->Pxx, *const other =
                                                                      turned ? p->Pxy : p->Pyy;
            const double sign = turned ? -1 : 1;
            assert_near(1e-6, tau * 3 * mu * 3, first[i], "P_xx");
            assert_near(1e-6, sign * tau * mu * 3, other[i], "P_yy");
            assert_near(1e-6, sign * tau * 2 * mu, turned ? p->Pxx[i] : p->Pyx[i], "P_yx");
        }
    }
}

/* Without a pattern: forces and torques close, and what the forces take from the motion is the rate
 * of strain times the viscous stress, which is never negative. */
static void test_balances(void)
{
    open(block, "b.damping_time=0.1 s", "b.hourglass=0");
    uint64_t seed = 5;
    for (int64_t i = 0; i < p->n; i++) {
        p->ux[i] = 0.1 * p->X[i] + 3e-4 * noise(&seed);
        p->uy[i] = -0.2 * p->X[i] + 3e-4 * noise(&seed);
        p->vx[i] = noise(&seed);
        p->vy[i] = noise(&seed);
    }
    double force[2][2] = {{0}}, torque[2] = {0}, power[2] = {0}, size = 0;
    for (int k = 0; k < 2; k++) {
        rig.sim.solid.kelvin_voigt = k == 0;
        solid_stress(&rig.sim.solid, p);
        solid_forces(&rig.sim.solid, p);
        for (int64_t i = 0; i < p->n; i++) {
            force[k][0] += p->sx[i];
            force[k][1] += p->sy[i];
            torque[k] += (p->X[i] + p->ux[i]) * p->sy[i] - (p->Y[i] + p->uy[i]) * p->sx[i];
            power[k] += p->sx[i] * p->vx[i] + p->sy[i] * p->vy[i];
            size = fmax(size, hypot(p->sx[i], p->sy[i]));
        }
    }
    assert_at_most(1e-11 * size, hypot(force[0][0], force[0][1]), "force");
    assert_at_most(1e-11 * size, fabs(torque[0]), "torque");
    TEST_ASSERT_TRUE(power[0] - power[1] < -0.1 * size);
}

/* A free bar, nu = 0, in its first mode u = A cos(pi x/L): w = pi c/L, share of the critical
 * damping z = tau w/2, u(0, t) = A exp(-z w t) (cos(wd t) + z w/wd sin(wd t)), wd = w sqrt(1 -
 * z^2). Largest error over three periods. */
static double error_of_decay(const char *dp, const char *tau_text, double tau)
{
    static const char bar[] =
        "dp = 1 cm\nend_time = 1\n[solid b]\nshape = box 0, 0, 0.4, 0.04\ndensity = 1000\n"
        "young = 1e6\npoisson = 0\nlaw = svk\nartificial_viscosity = 0\n";
    open(bar, dp, tau_text);
    const double A = 1e-6, w = M_PI * sqrt(1e6 / 1000) / 0.4, z = 0.5 * tau * w;
    const double wd = w * sqrt(1 - z * z), period = 2 * M_PI / w;
    for (int64_t i = 0; i < p->n; i++) p->ux[i] = A * cos(M_PI * p->X[i] / 0.4);
    double worst = 0;
    for (int k = 1; k <= 60; k++) {
        const double t = k * period / 20;
        rig_run(&rig, t);
        double mode = 0, norm = 0;
        for (int64_t i = 0; i < p->n; i++) {
            mode += p->ux[i] * cos(M_PI * p->X[i] / 0.4);
            norm += square(cos(M_PI * p->X[i] / 0.4));
        }
        const double exact = A * exp(-z * w * t) * (cos(wd * t) + z * w / wd * sin(wd * t));
        worst = fmax(worst, fabs(mode / norm - exact) / A);
    }
    return worst;
}

/* Measured: 0.6 % of the amplitude at 4 particles across, 0.16 % at 8: of second order. */
static void test_decay_of_a_bar(void)
{
    const double tau = 0.2 / (M_PI * sqrt(1000.0) / 0.4); /* z = 0.1 */
    char text[64];
    snprintf(text, sizeof text, "b.damping_time=%.17g s", tau);
    assert_at_most(0.008, error_of_decay("dp=1 cm", text, tau), "error of 4 particles across");
    assert_at_most(0.002, error_of_decay("dp=5 mm", text, tau), "error of 8 particles across");
}

/* Damping that bounds the step: noise dies out at that step, and at 1.5 times that step it grows.
 */
static void test_stable_step(void)
{
    const double factors[] = {1, 1.5};
    for (int k = 0; k < 2; k++) {
        open(block, "b.damping_time=1 ms", "integrator=verlet");
        const struct solid *const solid = &rig.sim.solid;
        TEST_ASSERT_TRUE(solid->stable_step < 0.5 * solid_step_of(square(solid->omega_max), 0));
        uint64_t seed = 3;
        for (int64_t i = 0; i < p->n; i++)
            p->vx[i] = 1e-3 * noise(&seed), p->vy[i] = 1e-3 * noise(&seed);
        double before = 0, after = 0;
        for (int64_t i = 0; i < p->n; i++) before += square(p->vx[i]) + square(p->vy[i]);
        rig.sim.solid.centred = false;
        solid_advance(&rig.sim.solid, p, factors[k] * rig.sim.dt_solid, 400);
        for (int64_t i = 0; i < p->n; i++) after += square(p->vx[i]) + square(p->vy[i]);
        TEST_ASSERT_TRUE(k ? !(after < 1e3 * before) : after < 0.1 * before);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_uniform_rate_by_hand);
    RUN_TEST(test_balances);
    RUN_TEST(test_decay_of_a_bar);
    RUN_TEST(test_stable_step);
    return UNITY_END();
}
