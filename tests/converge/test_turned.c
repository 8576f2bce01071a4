/* SPDX-License-Identifier: MIT
 * A cantilever of 200 x 20 mm with a load at its tip, drawn at an angle, against beam theory with
 * shear.
 *
 * The load is raised over two periods of the first mode, and the deflection is the mean over the
 * next one. Measured over that of theory: 1.0126 at 10 particles across at every angle, 1.035 at 5;
 * the clamped centres lie half a spacing behind the edge, which makes the beam that much longer.
 * With a clamp that is a circle of 30 mm, whose side is 0.57 mm behind the edge on average: 1.0434
 * at 5 across, 1.0207 at 10. */
#include "rig.h"
#include "unity.h"

#include <math.h>

static const char beam[] =
    "dp = thick/across\nend_time = 2\n"
    "[constants]\na = 0\nc = cos(a)\nq = sin(a)\nacross = 5\nL = 200 mm\nthick = 20 mm\n"
    "hold = 4*dp\nE = 2 MPa\nrise = 0.985 s\nP = 3*E*thick^3/12/L^3*2 mm\n"
    "[solid beam]\n"
    "shape = polygon -hold*c, -hold*q; L*c, L*q; L*c - thick*q, L*q + thick*c; "
    "-hold*c - thick*q, -hold*q + thick*c\n"
    "clamp = polygon -hold*c, -hold*q; 0, 0; -thick*q, thick*c; "
    "-hold*c - thick*q, -hold*q + thick*c\n"
    "density = 1000\nyoung = E\npoisson = 0\nlaw = svk\n"
    "[load tip]\nbody = beam\n"
    "shape = polygon (L - dp)*c, (L - dp)*q; L*c, L*q; L*c - thick*q, L*q + thick*c; "
    "(L - dp)*c - thick*q, (L - dp)*q + thick*c\n"
    "force = -q*P, c*P\nhistory = min(t/rise, 1)^3*(10 - 15*min(t/rise, 1) + 6*min(t/rise, 1)^2)\n";

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

/* Mean deflection of the particles that carry the load, over that of theory at their distance. */
static double deflection(double angle, double across)
{
    const struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    const double L = 0.2, thick = 0.02, dp = thick / across, rise = 0.985, period = 0.4925;
    const double E = 2e6, I = thick * thick * thick / 12, P = 3 * E * I / (L * L * L) * 2e-3;
    const double arm = L - 0.5 * dp;
    const double theory = P * (arm * arm * arm) / (3 * E * I) + P * arm / (5.0 / 6 * E / 2 * thick);
    double sum = 0;
    enum { SAMPLES = 40 };
    for (int k = 0; k < SAMPLES; k++) {
        rig_run(&rig, rise + (k + 0.5) * period / SAMPLES);
        double mean = 0;
        int n = 0;
        for (int64_t i = 0; i < particles->n; i++) {
            if (particles->X[i] * cos(angle) + particles->Y[i] * sin(angle) < L - dp) continue;
            mean += particles->uy[i] * cos(angle) - particles->ux[i] * sin(angle);
            n++;
        }
        TEST_ASSERT_EQUAL_INT((int)across, n);
        sum += mean / n;
    }
    return sum / SAMPLES / theory;
}

static void test_beam_theory_at_an_angle(void)
{
    rig_open(&rig, beam, "a=26.565 deg", "across=10", NULL);
    assert_near(0.02, 1, deflection(26.565 * atan(1) / 45, 10), "deflection over theory");
}

static void test_any_angle_gives_the_same(void)
{
    static const char *const sets[] = {"a=0", "a=15 deg", "a=45 deg"};
    const double angles[] = {0, 15, 45};
    double upright = 0;
    for (int k = 0; k < 3; k++) {
        rig_open(&rig, beam, sets[k], NULL);
        const double found = deflection(angles[k] * atan(1) / 45, 5);
        if (k == 0) upright = found;
        assert_near(1e-4, 1, found / upright, sets[k]);
    }
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_beam_theory_at_an_angle);
    RUN_TEST(test_any_angle_gives_the_same);
    return UNITY_END();
}
