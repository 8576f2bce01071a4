/* SPDX-License-Identifier: MIT
 * What the extrapolated velocity of an oscillating structure adds to the exchange of energy (T-35,
 * T-46e). */
#include <complex.h>
#include <math.h>

#include "rig.h"
#include "time/energy.h"
#include "coupling/motion.h"
#include "coupling/bounds.h"
#include "time/timestep.h"
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
 * evaluated: the equations of T-35 with the mean of the program. */
static double complex velocity_ratio(double z, double dt)
{
    const bool corrector = rig.sim.scene->top.integrator == INTEGRATOR_SYMPLECTIC;
    const double lag = reduced_averaging_time(&rig.sim.coupling, dt) / dt, weight = 1 / (1 + lag);
    const double complex before = cexp(-i_unit * z), mean = (1 - before) / (i_unit * z);
    const double complex filter = weight / (1 - (1 - weight) * before);
    const double complex a = filter * (1 - before), j = filter * a * (1 - before);
    double complex w = mean + 0.5 * (a + (lag + 0.25) * j);
    if (!corrector) return w;
    w += 0.5 * (a + (lag + 0.75) * j);
    return w / cexp(0.5 * i_unit * z);
}

/* Of the energy that the fluid receives, the fraction that the structure has not lost. */
static double excess(double z, double dt) { return 1 - creal(1 / velocity_ratio(z, dt)); }

static const struct {
    const char *name;
    double most, fastest; /* the default step over h/c0; modes below this are damped */
} row[] = {{"integrator=leapfrog", 0.4, 3.1},
           {"integrator=verlet", 0.4, 3.1},
           {"integrator=symplectic", 0.2, 1.58}};

static void test_small_steps_have_the_excess_of_the_theory(void)
{
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        rig_open(&rig, coupled, row[k].name, NULL);
        const double time = averaging_time(&rig.sim.coupling), dt = 1e-4 * time;
        const double theta = 0.5 * extrapolated_halves(&rig.sim.coupling) * dt;
        for (double of = 0.25; of < 5; of *= 2) { /* the frequency times h/c0 */
            const double wanted = theta / time * 2 * pow(of, 4) / square(1 + of * of);
            assert_near(2e-3 * wanted, wanted, excess(of * dt / time, dt), row[k].name);
        }
    }
}

static void test_the_structure_is_damped(void)
{
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        rig_open(&rig, coupled, row[k].name, NULL);
        const double time = averaging_time(&rig.sim.coupling);
        for (double share = 0.01; share <= 1; share += 0.03)
            for (double z = 0.01; z < row[k].fastest; z += 0.01)
                TEST_ASSERT_TRUE_MESSAGE(excess(z, share * row[k].most * time) < 1, row[k].name);
    }
}

/* The integrators have the same excess where T-35d sets their steps. */
static void test_light_bodies_have_the_same_excess_with_all_integrators(void)
{
    double first = 0;
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        rig_open(&rig, coupled, row[k].name, "plate.density=20", NULL);
        const double time = averaging_time(&rig.sim.coupling);
        int lightest;
        const double step = coupling_added_mass_step(&rig.sim.coupling, &lightest);
        const double most = excess(2 * step / time, step);
        if (k == 0) first = most;
        assert_near(0.05 * first, first, most, row[k].name);
    }
}

/* A plate of 0.3 times the fluid's density between two bodies of water, shaken at 1 kHz: sound goes
 * two spacings in a period, and the fluid receives more than the plate has given (T-46g). */
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

/* It falls by 3 with half of the step. It is the same whether the case or outputs set the step
 * (T-35e): with the longest possible step for the time of the exchange it is 0.27 with outputs
 * every 0.05 ms. */
static void test_a_shaken_plate(void)
{
    const double coarse = gain_of_exchange("numerics.fixed_step=1e-4", 1e-3);
    const double fine = gain_of_exchange("numerics.fixed_step=5e-5", 1e-3);
    assert_at_most(0.2, coarse, "0.1 ms");
    assert_at_most(coarse / 3, fine, "0.05 ms");
    assert_near(0.1 * fine, fine, gain_of_exchange(NULL, 5e-5), "by outputs");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_small_steps_have_the_excess_of_the_theory);
    RUN_TEST(test_the_structure_is_damped);
    RUN_TEST(test_light_bodies_have_the_same_excess_with_all_integrators);
    RUN_TEST(test_a_shaken_plate);
    return UNITY_END();
}
