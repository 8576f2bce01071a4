/* SPDX-License-Identifier: MIT
 * Plane Poiseuille flow from a parabolic inflow to an outlet of given pressure: u = 4 U y (H -
 * y)/H^2 and a pressure that falls by 8 nu rho U/H^2 a metre, Re = 20 by the mean velocity. */
#include "output/probes.h"
#include "rig.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

static const char channel[] =
    "dp = 1/n\nend_time = 10\n"
    "[constants]\nn = 40\nU = 1.5\nL = 2\nnu = 0.05\nplate = 4/n\nahead = 6/n\n"
    "[numerics]\nsuction = on\nh_over_dp = 1.5\n"
    "[fluid w]\nshape = box 0, 0, L, 1\nsound_speed = 15\nlaminar_viscosity = nu\n"
    "density_diffusion = 0.1\nshifting = 10\nshifting_speed = largest\n"
    "velocity = 4*U*y*(1 - y), 0\npressure = 8*nu*1000*U*(L - x)\n"
    "[wall plates]\nshape = box -ahead, -plate, L + ahead, 0\n"
    "shape = box -ahead, 1, L + ahead, 1 + plate\nslip = none\n"
    "[inflow in]\nfrom = 0, 1\nto = 0, 0\nspeed = 4*U*y*(1 - y)\n"
    "[outflow out]\nfrom = L, 0\nto = L, 1\npressure = 0\nabsorb = 1\n";

static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

struct errors {
    double profile; /* largest of rows, over U */
    double drop;    /* of the pressure from 0.4 to 1.6 m, relative */
};

/* After all fluid but that next to the plates has been replaced: means over a stretch and a second.
 */
static struct errors errors_at(int n, const char *set)
{
    enum { MOST = 64, TIMES = 20 };
    double sum[MOST] = {0}, count[MOST] = {0}, place[MOST] = {0}, drop = 0;
    rig_open(&rig, channel, set, NULL);
    for (int k = 0; k < TIMES; k++) {
        rig_run(&rig, 2 + 0.05 * k);
        const struct particles *const particles = &rig.sim.particles[KIND_FLUID];
        for (int64_t i = 0; i < particles->n; i++) {
            if (particles->x[i] < 1.2 || particles->x[i] > 1.7) continue;
            const int row = (int)fmin(n - 1, fmax(0, particles->y[i] * n));
            sum[row] += particles->vx[i];
            place[row] += 6 * particles->y[i] * (1 - particles->y[i]);
            count[row]++;
        }
        drop += (fluid_sample(&rig.sim, 0.4, 0.5).pressure -
                 fluid_sample(&rig.sim, 1.6, 0.5).pressure) /
                TIMES;
    }
    struct errors e = {0, fabs(drop / (600 * 1.2) - 1)};
    for (int row = 0; row < n; row++)
        e.profile = fmax(e.profile, fabs(sum[row] - place[row]) / count[row] / 1.5);
    return e;
}

static void test_poiseuille(void)
{
    const struct errors coarse = errors_at(20, "n=20"), fine = errors_at(40, "n=40");
    printf("found: profile %.3g %% and %.3g %%, pressure drop %.3g %% and %.3g %% at 20 and 40 "
           "across\n",
           100 * coarse.profile, 100 * fine.profile, 100 * coarse.drop, 100 * fine.drop);
    assert_at_most(0.005, fine.profile, "profile at 40 across, over its top speed");
    assert_at_most(0.7 * coarse.profile, fine.profile, "profile at 40 across beside 20");
    assert_at_most(0.02, fine.drop, "pressure drop at 40 across");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_poiseuille);
    return UNITY_END();
}
