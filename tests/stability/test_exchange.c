/* SPDX-License-Identifier: MIT
 * What the extrapolated velocity of an oscillating structure adds to the exchange of energy (T-35,
 * T-46e). */
#include <complex.h>
#include <math.h>

#include "rig.h"
#include "time/energy.h"
#include "coupling/coupling.h"
#include "time/advance.h"
#include "unity.h"

/* A stiff plate beside water: a coupled scene with sub-steps, h/c0 = 0.0135/20 s. */
static const char coupled[] =
    "dp = 1 cm\nend_time = 1\n"
    "[fluid water]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\n"
    "[solid plate]\nshape = box 0.1, 0, 0.14, 0.1\nclamp = box 0.1, 0, 0.14, 0.02\n"
    "density = 1000\nyoung = 1e8\npoisson = 0.3\n";

static const double complex i_unit = CMPLX(0, 1);
static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

/* The velocity that the fluid uses over the true one, for the velocity exp(i z t/dt), where it is
 * evaluated: the equations of T-35. */
static double complex velocity_ratio(double z)
{
    const bool corrector = rig.sim.scene->top.integrator == INTEGRATOR_SYMPLECTIC;
    const double complex before = cexp(-i_unit * z), mean = (1 - before) / (i_unit * z);
    const double complex more = 0.5 * 0.2 / (1 - 0.8 * before) * (1 - before);
    return corrector ? (mean + 2 * more) / cexp(0.5 * i_unit * z) : mean + more;
}

/* Of the energy that the fluid receives, the fraction that the structure has not lost. */
static double excess(double z) { return 1 - creal(1 / velocity_ratio(z)); }

static const struct {
    const char *name;
    double fastest; /* times the step; modes below this are damped */
} row[] = {{"integrator=leapfrog", 3.54},
           {"integrator=verlet", 3.54},
           {"integrator=symplectic", 1.75}};

static void test_short_steps_have_the_excess_of_the_theory(void)
{
    static const double of_square[] = {25.0 / 12, 25.0 / 12, 107.0 / 24};
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        rig_open(&rig, coupled, row[k].name, NULL);
        for (double z = 1e-3; z < 0.01; z *= 2)
            assert_near(2e-2 * z * z, of_square[k] * z * z, excess(z), row[k].name);
    }
}

static void test_the_structure_is_damped(void)
{
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        rig_open(&rig, coupled, row[k].name, NULL);
        for (double z = 0.01; z < row[k].fastest; z += 0.01)
            TEST_ASSERT_TRUE_MESSAGE(excess(z) < 1, row[k].name);
    }
}

/* Where T-35d sets the steps, no integrator has a larger excess than leapfrog. */
static void test_light_bodies_have_no_larger_excess_with_another_integrator(void)
{
    double first = 0;
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        rig_open(&rig, coupled, row[k].name, "plate.density=20", NULL);
        const double time = averaging_time(&rig.sim.coupling);
        int lightest;
        const double step = coupling_added_mass_step(&rig.sim.coupling, &lightest);
        const double most = excess(2 * step / time);
        if (k == 0) first = most;
        assert_at_most(1.01 * first, most, row[k].name);
    }
}

/* A plate of 0.3 times the fluid's density between two bodies of water, shaken at 1 kHz: sound goes
 * two spacings in a period, and the fluid receives more than the plate has given (T-46d). */
static const char shaken[] =
    "integrator = leapfrog\ndp = 10 mm\nend_time = 1\ngravity = 0, -9.81\n"
    "[fluid left]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\nartificial_viscosity = "
    "0.1\nsurface = 0.1\n"
    "[fluid right]\nlike = left\nshape = box 0.13, 0, 0.23, 0.06\nsurface = 0.06\n"
    "[wall tank]\nshape = polyline thickness -0.04: 0, 0.2; 0, 0; 0.1, 0\n"
    "shape = polyline thickness -0.04: 0.13, 0; 0.23, 0; 0.23, 0.2\n"
    "[solid plate]\nshape = box 0.1, -0.04, 0.13, 0.12\nclamp = box 0.1, -0.04, 0.13, 0\n"
    "density = 300\nyoung = 1.48e6\npoisson = 0.3\n"
    "[load hit]\nbody = plate\nshape = box 0.1, 0.09, 0.14, 0.13\nforce = 300*sin(2000*pi*t), 0\n";

/* The gain of the exchange over 6 ms and the largest available energy. Limits end a step every
 * `rows`. */
static double gain_of_exchange(const char *step, double rows)
{
    rig_open(&rig, shaken, "numerics.multirate=on", step, NULL);
    rig_ignore_gains(&rig);
    energy_begin(&rig.sim);
    for (int k = 1; k <= round(6e-3 / rows); k++) rig_run(&rig, k * rows);
    simulation_refresh(&rig.sim);
    energy_find_gain(&rig.sim);
    const struct energy_account *const a = &rig.sim.state.energy;
    return a->most[TERM_INTERFACE] / a->largest_available;
}

/* It falls by 6 with a quarter of the step. It is the same whether the case or outputs set the step
 * (T-35e): with the longest possible step for the time of the exchange it is 0.27 with outputs
 * every 0.05 ms. */
static void test_a_shaken_plate(void)
{
    assert_at_most(0.1, gain_of_exchange("numerics.fixed_step=1e-4", 1e-3), "0.1 ms");
    const double coarse = gain_of_exchange("numerics.fixed_step=5e-5", 1e-3);
    assert_at_most(0.1, coarse, "0.05 ms");
    assert_at_most(coarse / 6, gain_of_exchange("numerics.fixed_step=1.25e-5", 1e-3), "0.0125 ms");
    assert_near(0.1 * coarse, coarse, gain_of_exchange(NULL, 5e-5), "by outputs");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_short_steps_have_the_excess_of_the_theory);
    RUN_TEST(test_the_structure_is_damped);
    RUN_TEST(test_light_bodies_have_no_larger_excess_with_another_integrator);
    RUN_TEST(test_a_shaken_plate);
    return UNITY_END();
}
