/* SPDX-License-Identifier: MIT
 * A disc that oscillates in viscous fluid inside a fixed circle, both without slip: the force in
 * phase with the acceleration (added mass) and with the velocity (drag), against the exact solution
 * of the unsteady Stokes equations (Chen, Wambsganss and Jendrzejczyk 1976). */
#include "rig.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

static const char disc[] =
    "scheme = standard\ndp = 0.1/n\nend_time = 2\n"
    "[constants]\nn = 10\nV = 6e-3\nT = 0.5\n"
    "[numerics]\nh_over_dp = 1.35\nsuction = on\nsides = one\n"
    "[fluid w]\nshape = circle 0, 0, 0.2\nminus = circle 0, 0, 0.05\nsound_speed = 25\n"
    "laminar_viscosity = 1e-3\ndensity_diffusion = 0.1\nwall_repulsion = 0.1\n"
    "[wall round]\nshape = circle 0, 0, 0.2 + 4*dp\nminus = circle 0, 0, 0.2\nslip = none\n"
    "[solid disc]\nshape = circle 0, 0, 0.05\nclamp = box -1, -1, 1, 1\nclamp_motion = up\n"
    "density = 10000\nyoung = 5.6e6\npoisson = 0.4\nslip = none\n"
    "[motion up]\ny = -V*T/(4*pi)*(1 - cos(pi*min(t/T, 1)))*cos(2*pi*t/T)\n"
    "[contact any]\nenabled = off\n";

static const double speed = 6e-3, period = 0.5, rho = 1000;

/* The force per depth is -rho (mass dv/dt + drag v): m^2 and m^2/s, with the radii, the viscosity
 * and the period of the case. The velocity of the fluid is that of a stream function (A r + B/r + C
 * I1(l r) + D K1(l r)) sin(theta), l^2 = i w/nu, whose constants follow from no slip. */
static const double exact_mass = 0.0134456, exact_drag = 0.0679560;

static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

struct response {
    double mass, drag;
};

/* In the third period, when the motion has its full speed and the flow repeats itself. */
static struct response response_of(const char *set)
{
    enum { SAMPLES = 50 };
    const double w = 2 * 3.14159265358979 / period;
    struct response r = {0};
    rig_open(&rig, disc, set, NULL);
    for (int k = 0; k < SAMPLES; k++) {
        const double t = (2 + (k + 1.0) / SAMPLES) * period;
        double force = 0;
        rig_run(&rig, t);
        rig_evaluate(&rig); /* the force of a step is that at its start */
        const struct particles *const particles = &rig.sim.particles[KIND_SOLID];
        for (int64_t i = 0; i < particles->n; i++) force += particles->fy[i];
        r.mass -= 2 * force * cos(w * t) / (SAMPLES * speed * w * rho);
        r.drag -= 2 * force * sin(w * t) / (SAMPLES * speed * rho);
    }
    return r;
}

/* The added mass is too large by the layer of docs/notes/2026-11-26-turek-hron.md, which L-6 and
 * L-6a leave.
 */
static void test_oscillation(void)
{
    const struct response r = response_of("n=10");
    printf("found: added mass %+.2f %%, drag %+.2f %%\n", 100 * (r.mass / exact_mass - 1),
           100 * (r.drag / exact_drag - 1));
    assert_near(0.08 * exact_mass, exact_mass, r.mass, "added mass at 10 across");
    assert_near(0.03 * exact_drag, exact_drag, r.drag, "drag at 10 across");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_oscillation);
    return UNITY_END();
}
