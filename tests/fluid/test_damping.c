/* SPDX-License-Identifier: MIT
 * Zones of damping: the velocity decays as the rate says, only where the zone is, and the ledger
 * has what it takes. */
#include "rig.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>

static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

#define DROPS                                                                      \
    "dp = 1 cm\nend_time = 1\n[domain]\nlower = -1, -1\nupper = 3, 1\n"            \
    "[fluid a]\nshape = box 0, 0, 0.04, 0.04\nsound_speed = 20\nvelocity = 1, 0\n" \
    "[fluid b]\nlike = a\nshape = box 2, 0, 2.04, 0.04\nvelocity = 0, 1\n"

static void test_the_velocity_decays(void)
{
    static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                              "integrator=leapfrog"};
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig, DROPS "[damping d]\nfrom = 1, 0\nto = 1.5, 0\nrate = 5\n", integrators[k],
                 NULL);
        rig_run(&rig, 0.1);
        const struct particles *const p = &rig.sim.particles[KIND_FLUID];
        for (int64_t i = 0; i < p->n; i++) {
            const bool inside = p->body[i] == 1;
            assert_near(1e-6, inside ? 0 : 1, p->vx[i], "vx");
            assert_near(inside ? 2e-3 : 1e-6, inside ? exp(-0.5) : 0, p->vy[i], "vy");
        }
        const double before = 0.5 * 1000 * 0.04 * 0.04;
        assert_near(4e-3 * before, before * (1 - exp(-1)), simulation_ledger(&rig.sim).damped,
                    "damped");
    }
}

/* A rate that the step of the sound would not follow: the fluid stops and does not swing. */
static void test_a_high_rate_is_followed(void)
{
    static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                              "integrator=leapfrog"};
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig, DROPS "[damping d]\nfrom = 1, 0\nto = 1.5, 0\nrate = 1e5\n", integrators[k],
                 NULL);
        rig_run(&rig, 1e-3);
        const struct particles *const p = &rig.sim.particles[KIND_FLUID];
        for (int64_t i = 0; i < p->n; i++)
            assert_near(1e-3, 0, p->body[i] == 1 ? p->vy[i] : p->vx[i] - 1, "velocity");
    }
}

/* The rate grows as the distance to a power: 5 (0.5)^2 in the middle. */
static void test_the_rate_grows(void)
{
    rig_open(&rig, DROPS "[damping d]\nfrom = 1.02, 0\nto = 3.02, 0\nrate = 5\n", NULL);
    rig_run(&rig, 0.1);
    const struct particles *const p = &rig.sim.particles[KIND_FLUID];
    double mean = 0, n = 0;
    for (int64_t i = 0; i < p->n; i++)
        if (p->body[i] == 1) mean += p->vy[i], n++;
    assert_near(2e-3, exp(-0.1 * 5 * 0.25), mean / n, "mean vy");
}

static void test_bad_input_is_refused(void)
{
    rig_refuses(DROPS "[damping d]\nrate = 5\n", "has no length");
    rig_refuses(DROPS "[damping d]\nto = 1, 0\n", "lacks `rate`");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_velocity_decays);
    RUN_TEST(test_a_high_rate_is_followed);
    RUN_TEST(test_the_rate_grows);
    RUN_TEST(test_bad_input_is_refused);
    return UNITY_END();
}
