/* SPDX-License-Identifier: MIT
 * A stiff plate under water: implicit steps beside each integrator give the deflection, the
 * exchange and the account of energy of explicit sub-steps. */
#include "rig.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

static const char plate[] =
    "dp = 25 mm\nend_time = 10\ngravity = 0, -9.81\n"
    "[fluid water]\nshape = box 0, 0, 0.5, 0.5\nsurface = 0.5\nartificial_viscosity = 0.1\n"
    "density_diffusion = 0.1\nsound_speed = 22\n"
    "[wall tank]\nshape = box -0.1, -0.1, 0, 0.6\nshape = box 0.5, -0.1, 0.6, 0.6\n"
    "[solid plate]\nshape = box -0.1, -0.1, 0.6, 0\nclamp = box -0.1, -0.1, 0, 0\n"
    "clamp = box 0.5, -0.1, 0.6, 0\ndensity = 2700\nyoung = 2 GPa\npoisson = 0.34\n"
    "artificial_viscosity = 0.03\n[contact none]\nenabled = off\n";

static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

struct result {
    double deflection, impulse, dissipated, gain_share, substeps;
};

/* Means over the last 0.4 s of 0.6 s. */
static struct result run(const char *integrator, const char *scheme, const char *steps)
{
    struct result r = {0};
    int count = 0;
    rig_open(&rig, plate, integrator, scheme, steps, NULL);
    const struct particles *const p = &rig.sim.particles[KIND_SOLID];
    while (rig.sim.state.time < 0.6) {
        rig_steps(&rig, 1, 0.6);
        if (rig.sim.state.time < 0.2) continue;
        for (int64_t i = 0; i < p->n; i++)
            if (fabs(p->X[i] - 0.25) < 0.02) r.deflection += p->uy[i];
        count++;
    }
    r.deflection /= count;
    r.impulse = rig.sim.state.exchanged;
    r.dissipated = simulation_ledger(&rig.sim).dissipated;
    r.gain_share = rig.sim.state.gain_share;
    r.substeps = (double)rig.sim.state.solid_substeps / (double)rig.sim.state.steps;
    return r;
}

static void test_implicit_steps_agree_with_substeps(void)
{
    static const char *const integrators[] = {"integrator=symplectic", "integrator=leapfrog",
                                              "integrator=verlet"};
    static const char *const schemes[] = {"scheme=paper", "scheme=standard"};
    for (int k = 0; k < 6; k++) {
        const char *const by = integrators[k / 2], *const scheme = schemes[k % 2];

        const struct result substeps = run(by, scheme, "numerics.solid_steps=explicit");
        const struct result implicit = run(by, scheme, "numerics.solid_steps=implicit");
        char what[80];
        snprintf(what, sizeof what, "%s, %s", by, scheme);
        assert_near(1e-3 * -substeps.deflection, substeps.deflection, implicit.deflection, what);
        assert_near(1e-4 * substeps.impulse, substeps.impulse, implicit.impulse, what);
        assert_near(4.5e-3, substeps.dissipated, implicit.dissipated, what);
        assert_near(0, 0, implicit.gain_share, what);
        TEST_ASSERT_TRUE(substeps.substeps > 20);
        TEST_ASSERT_TRUE(implicit.substeps == 1);
    }
}

/* Implicit where it costs less than 10 + 2 x 4 sub-steps (T-94), and where the case allows it. */
static void test_auto_chooses_by_cost(void)
{
    static const struct {
        const char *set, *other;
        bool implicit;
    } row[] = {
        {"integrator=leapfrog", "plate.young=2 GPa", true},
        {"integrator=leapfrog", "plate.young=20 MPa", false},
        {"integrator=verlet", "plate.young=20 GPa", true},
        {"numerics.solid_steps=explicit", "plate.young=20 GPa", false},
        {"numerics.multirate=off", "plate.young=20 GPa", false},
        {"numerics.solid_precision=single", "plate.young=20 GPa", false},
        {"plate.hourglass_form=printed", "plate.young=20 GPa", false},
    };
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        rig_open(&rig, plate, row[k].set, row[k].other, NULL);
        TEST_ASSERT_EQUAL_MESSAGE(row[k].implicit, rig.sim.solid.implicit != NULL, row[k].set);
        TEST_ASSERT_EQUAL_MESSAGE(row[k].implicit, (rig.sim.effects & FX_IMPLICIT) != 0,
                                  row[k].other);
        rig_steps(&rig, 3, 1);
        if (row[k].implicit) TEST_ASSERT_EQUAL_INT(1, rig.sim.substeps);
    }
}

/* Without viscosity the plate's energy is what the account says it has received. */
static void test_account_of_the_solid_is_exact(void)
{
    static const char *const integrators[] = {"integrator=symplectic", "integrator=leapfrog",
                                              "integrator=verlet"};
    for (int k = 0; k < 3; k++) {
        rig_open(&rig, plate, integrators[k], "numerics.solid_steps=implicit",
                 "plate.artificial_viscosity=0", "plate.law=svk", NULL);
        energy_begin(&rig.sim);
        const struct particles *const p = &rig.sim.particles[KIND_SOLID];
        const struct energy_entry *const entry =
            &rig.sim.state.energy.entry[energy_entry(KIND_SOLID, 0)];
        const double before = entry->supplied, mass = rig.sim.solid.body[0].mass;
        rig_run(&rig, 0.03);
        double elastic, hourglass, det, energy = 0;
        simulation_refresh(&rig.sim);
        solid_energy(&rig.sim.solid, p, SOLID_ALL, &elastic, &hourglass, &det);
        for (int64_t i = 0; i < p->n; i++)
            energy += mass * (0.5 * (square(p->vx[i]) + square(p->vy[i])) + 9.81 * p->y[i]);
        TEST_ASSERT_TRUE(elastic > 1e-3);
        assert_near(1e-4 * elastic, entry->supplied - before, energy + elastic + hourglass - before,
                    integrators[k]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_implicit_steps_agree_with_substeps);
    RUN_TEST(test_auto_chooses_by_cost);
    RUN_TEST(test_account_of_the_solid_is_exact);
    return UNITY_END();
}
