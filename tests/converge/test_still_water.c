/* SPDX-License-Identifier: MIT
 * Still water in a rigid tank, H = 0.2 m, dp = H/20: the pressure it settles to, and that it comes
 * to rest. */
#include "output/probes.h"
#include "time/energy.h"
#include "rig.h"
#include "unity.h"

#include <math.h>

static const char tank[] =
    "dp = 1 cm\nend_time = 10\ngravity = 0, -9.81\n"
    "[fluid water]\nshape = box 0, 0, 0.1, 0.2\nsound_speed = 20\nartificial_viscosity = 0.1\n"
    "density_diffusion = 0.1\ndiffusion_form = fourtakas\n"
    "[wall tank]\nshape = polyline thickness -0.04: 0, 0.3; 0, 0; 0.1, 0; 0.1, 0.3\n";
static const double H = 0.2, dp = 0.01, rho = 1000, g = 9.81;

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

/* Sum of V (x_b - x_a) . dW/dx over a square lattice: 1 for a perfect quadrature; what the discrete
 * gradient makes of a linear pressure. 0.98283 for h/dp = 1.35, 0.99740 for 1.5. */
static double lattice_gradient(double h)
{
    double sum = 0;
    for (int i = -4; i <= 4; i++) {
        for (int j = -4; j <= 4; j++) {
            const double q = hypot(i, j) / h;
            if (q < 2) sum += i * i * 35 / (4 * M_PI * pow(h, 4)) * pow(1 - q / 2, 3);
        }
    }
    return sum;
}

/* Straight line through the pressures of all particles: pressure[0] + pressure[1] * depth. */
static void fit(const struct particles *particles, double pressure[2], double *scatter)
{
    double n = 0, s = 0, ss = 0, sp = 0, ssp = 0;
    for (int64_t i = 0; i < particles->n; i++) {
        const double depth = H - particles->y[i];
        n += 1;
        s += depth;
        ss += depth * depth;
        sp += rig_pressure(&rig.sim, i);
        ssp += depth * rig_pressure(&rig.sim, i);
    }
    pressure[1] = (n * ssp - s * sp) / (n * ss - s * s);
    pressure[0] = (sp - pressure[1] * s) / n;
    *scatter = 0;
    for (int64_t i = 0; i < particles->n; i++)
        *scatter = fmax(*scatter, fabs(rig_pressure(&rig.sim, i) - pressure[0] -
                                       pressure[1] * (H - particles->y[i])));
}

/* The balance of forces on a lattice is rho g = L dp/dy: at rest the pressure rises by 1/L times
 * rho g a metre, with rho larger by half of g H/c0^2 in the mean. c0 = 60 m/s keeps the lattice
 * even: at 20 the spacing varies by 0.5 % over the depth, which costs up to 2 g H/c0^2 = 1 % of the
 * rise. The two rows at the surface are off the line by up to 0.6 % of rho g H, which turns a line
 * through 20 rows by 0.35 %: the tolerance. (Measured: 1.0165 of 1.0177 for h/dp = 1.35, 1.0013
 * of 1.0029 for 1.5.) The line meets the surface within half a particle, rho g dp/2; no particle is
 * off it by more than 1 % of rho g H, and none rises above the surface. */
static void settle(const char *h_over_dp, double h, const char *integrator, const char *precision)
{
    rig_open(&rig, tank, h_over_dp, integrator, precision, "water.surface=0.2",
             "water.sound_speed=60", NULL);
    const int64_t n = rig.sim.particles[KIND_FLUID].n;
    rig_run(&rig, 0.6);
    simulation_refresh(&rig.sim);
    const struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    double pressure[2], scatter;
    fit(particles, pressure, &scatter);
    const double expected = (1 + 0.5 * g * H / (60 * 60)) / lattice_gradient(h);
    assert_near(0.0035, expected, pressure[1] / (rho * g), "rise of pressure over rho g");
    assert_near(0.5 * rho * g * dp, 0, pressure[0], "pressure at the surface");
    assert_at_most(0.01 * rho * g * H, scatter, "scatter of the pressure");
    TEST_ASSERT_EQUAL_INT64(n, particles->n);
    for (int64_t i = 0; i < particles->n; i++) {
        TEST_ASSERT_TRUE(particles->x[i] > 0 && particles->x[i] < 0.1 && particles->y[i] > 0);
        TEST_ASSERT_TRUE(particles->y[i] < H);
    }
    /* At rest to a thousandth of the speed of a fall through H: kinetic energy 1e-6 of m g H. */
    const struct ledger row = simulation_ledger(&rig.sim);
    assert_at_most(1e-6 * row.mass * g * H, row.kinetic, "kinetic energy");
}

static void test_hydrostatic_pressure(void)
{
    settle("numerics.h_over_dp=1.35", 1.35, "integrator=symplectic", "precision=mixed");
    settle("numerics.h_over_dp=1.5", 1.5, "integrator=verlet", "precision=double");
}

/* With a lattice sum near 1 (h/dp = 1.5) the pressure is within 2 % of rho g (H - y) by itself,
 * more than two particles below the surface, relative to the pressure at the floor. */
static void test_pressure_within_two_percent(void)
{
    rig_open(&rig, tank, "numerics.h_over_dp=1.5", "water.surface=0.2", NULL);
    rig_run(&rig, 1.5);
    simulation_refresh(&rig.sim);
    const struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    for (int64_t i = 0; i < particles->n; i++)
        if (H - particles->y[i] > 2 * dp)
            assert_near(0.02 * rho * g * H, rho * g * (H - particles->y[i]),
                        rig_pressure(&rig.sim, i), "pressure");
    for (double y = 0.02; y < 0.17; y += 0.03)
        assert_near(0.02 * rho * g * H, rho * g * (H - y), fluid_sample(&rig.sim, 0.05, y).pressure,
                    "pressure at a fixed point");
    TEST_ASSERT_TRUE(fluid_sample(&rig.sim, 0.05, 0.25).pressure == 0);
}

/* Let go without pressure the water bounces like a spring and comes to rest: a hundredth of the
 * kinetic energy after 1.8 s; none of it is spurious. */
static void test_kinetic_energy_decays(void)
{
    rig_open(&rig, tank, NULL);
    double early = 0, late = 0, dissipated = 0;
    for (double t = 0.01; t < 0.5; t += 0.01) {
        rig_run(&rig, t);
        early = fmax(early, simulation_ledger(&rig.sim).kinetic);
    }
    for (double t = 1.8; t < 2; t += 0.01) {
        rig_run(&rig, t);
        const struct ledger row = simulation_ledger(&rig.sim);
        late = fmax(late, row.kinetic);
        dissipated = row.dissipated;
    }
    TEST_ASSERT_TRUE(early > 1e-4);
    assert_at_most(0.01 * early, late, "kinetic energy");
    TEST_ASSERT_TRUE(dissipated > 0);
    TEST_ASSERT_EQUAL_INT64(0, rig.sim.state.lost);
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_hydrostatic_pressure);
    RUN_TEST(test_pressure_within_two_percent);
    RUN_TEST(test_kinetic_energy_decays);
    return UNITY_END();
}
