/* SPDX-License-Identifier: MIT
 * The fluid's laws one by one, on pairs of particles with numbers worked out by hand.
 *
 * All pairs: dp = 0.8 m and h_over_dp = 1.25, so that h = 1 m, m = 640 kg/m; rho0 = 1000 kg/m^3,
 * c0 = 10 m/s; a at (0.6, 0.8), b at the origin, so that q = 1 and
 *   grad_a W_ab = -5 * 7/(4 pi) * (1/2)^3 x_ab = -0.3481514380135211 (0.6, 0.8).
 * rho_a = 1010 and rho_b = 1020 kg/m^3 have by Eq. 2 the pressures
 *   P_a = 1e5/7 (1.01^7 - 1) = 1030.5050301001436 Pa, P_b = 2124.080966418286 Pa. */
#include "rig.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

static const char pair[] = "dp = 0.8\nend_time = 1\nprecision = double\n"
                           "[numerics]\nh_over_dp = 1.25\nskin = 0.5\n"
                           "[domain]\nlower = -10, -10\nupper = 10, 10\n"
                           "[fluid w]\nshape = box 0, 0, 1.6, 0.8\nsound_speed = 10\n";

static struct rig rig;
static struct particles *fluid;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

static void place(const char *set, const char *another)
{
    rig_open(&rig, pair, set, another, NULL);
    fluid = &rig.sim.particles[KIND_FLUID];
    TEST_ASSERT_EQUAL_INT64(2, fluid->n);
    const double x[2] = {0.6, 0}, y[2] = {0.8, 0}, dens[2] = {0.01, 0.02};
    for (int64_t i = 0; i < 2; i++) {
        fluid->id[i] = i;
        fluid->x[i] = x[i];
        fluid->y[i] = y[i];
        fluid->dens[i] = dens[i];
        fluid->vx[i] = fluid->vy[i] = 0;
    }
}

/* Where the cells have put a and b. */
static int64_t first, second;

/* Sets the velocities of a and b; evaluates. */
static void evaluate(double ua, double va, double ub, double vb)
{
    fluid->vx[0] = ua;
    fluid->vy[0] = va;
    fluid->vx[1] = ub;
    fluid->vy[1] = vb;
    rig_sort(&rig);
    rig_evaluate(&rig);
    first = fluid->id[0] == 0 ? 0 : 1;
    second = 1 - first;
}

static void check_forces(double magnitude, double gx, double gy)
{
    const double tolerance = 1e-13 * (magnitude + fabs(gx) + fabs(gy));
    assert_near(tolerance, 0.6 * magnitude + gx, fluid->ax[first], "ax of a");
    assert_near(tolerance, 0.8 * magnitude + gy, fluid->ay[first], "ay of a");
    assert_near(tolerance, -0.6 * magnitude + gx, fluid->ax[second], "ax of b");
    assert_near(tolerance, -0.8 * magnitude + gy, fluid->ay[second], "ay of b");
}

/* Eq. 4b: m (P_a + P_b)/(rho_a rho_b) |grad W|
 *   = 640 * 3154.5859965184296/1030200 * 0.3481514380135211 = 0.6822899792818219 m/s^2, apart. */
static void test_pressure(void)
{
    place("w.density=1000", "gravity=0,0");
    evaluate(0, 0, 0, 0);
    check_forces(0.6822899792818219, 0, 0);
    assert_near(1e-10, 1030.5050301001436, rig_pressure(&rig.sim, first), "P_a");
    assert_near(1e-10, 2124.080966418286, rig_pressure(&rig.sim, second), "P_b");
    TEST_ASSERT_TRUE(fluid->ddens[first] == 0);
}

/* Masses of 1.5 and 0.5 m: as test_pressure, of a with the mass of b and of b with that of a,
 *   0.5 * 0.6822899792818219 and 1.5 * 0.6822899792818219 m/s^2: momentum is kept. Eq. 4a likewise
 * has the volumes 1.5 m/rho_a and 0.5 m/rho_b. */
static void test_particles_of_unlike_mass(void)
{
    place("w.particle_mass=hydrostatic", "w.pressure=0");
    fluid->m[0] = 1.5;
    fluid->m[1] = 0.5;
    evaluate(1, 0, -1, 2);
    const double full = 0.6822899792818219;
    assert_near(1e-13, 0.6 * 0.5 * full, fluid->ax[first], "ax of a");
    assert_near(1e-13, -0.8 * 1.5 * full, fluid->ay[second], "ay of b");
    assert_near(1e-11, 0.5 * 88.2529762870353, 1000 * fluid->ddens[first], "drho_a");
    assert_near(1e-11, 1.5 * 90.00921138028774, 1000 * fluid->ddens[second], "drho_b");
    const struct ledger row = simulation_ledger(&rig.sim);
    assert_near(1e-9, 2 * 640, row.mass, "mass");
    assert_near(1e-9, 640 * (1.5 * 0.5 + 0.5 * 0.5 * 5), row.kinetic, "kinetic energy");
    assert_near(1e-9, 640 * (1.5 - 0.5), row.momentum_x, "momentum");
}

/* A column starts with as much mass in each place as the density of its depth says, so that
 * particles fill their places: m/(1 + d) = 1. */
static void test_masses_carry_the_density(void)
{
    rig_open(&rig, pair, "w.particle_mass=hydrostatic", "w.surface=3", "gravity=0,-9.81", NULL);
    fluid = &rig.sim.particles[KIND_FLUID];
    for (int64_t i = 0; i < fluid->n; i++) {
        TEST_ASSERT_TRUE(fluid->dens[i] > 0.1);
        assert_near(1e-15, 1, fluid->m[i] / (1 + fluid->dens[i]), "volume over dp^2");
    }
}

/* T-9a: where dens is 0.004 and -0.001 above its value with delay, 1000 * 10^2 * 0.003 = 300 Pa are
 * added to the sum of both pressures, 3154.5859965184296 Pa. The pressure of the state stays as it
 * is. */
static void test_acoustic_damper(void)
{
    place("w.acoustic_damper=4", "gravity=0,0");
    fluid->dens_slow[0] = fluid->dens[0] - 0.004;
    fluid->dens_slow[1] = fluid->dens[1] + 0.001;
    evaluate(1, 0, -1, 2);
    check_forces(0.6822899792818219 * (1 + 300 / 3154.5859965184296), 0, 0);
    assert_near(1e-10, 1030.5050301001436, rig_pressure(&rig.sim, first), "P_a");
}

/* T-9b, h/c0 = 0.1 s: after 0.1 s with alpha_D = 4 a fifth of the difference is left out, 0.1/(0.1
 * + 0.4). */
static void test_damper_follows_density(void)
{
    place("w.acoustic_damper=4", "gravity=0,0");
    fluid->dens[0] = 0.02;
    fluid->dens_slow[0] = 0.01;
    fluid_follow_density(&rig.sim.fluid, fluid, 0.1);
    assert_near(1e-15, 0.012, fluid->dens_slow[0], "dens with delay");
}

static void test_gravity_is_added(void)
{
    place("gravity=1,-9.81", "w.density=1000");
    evaluate(0, 0, 0, 0);
    check_forces(0.6822899792818219, 1, -9.81);
    assert_near(1e-12,
                square(0.6 * -0.6822899792818219 + 1) + square(-0.8 * 0.6822899792818219 - 9.81),
                rig.sim.fluid.extremes.acceleration2, "largest |a|^2");
}

/* Eq. 4a with v_ab = (2, -2): v_ab . grad W = -0.348151438 * (1.2 - 1.6) = 0.1392605752 1/s;
 *   drho_a = 1010 * 640/1020 * 0.13926 = 88.2529762870353 kg/(m^3 s), drho_b = 90.00921138028774.
 * Eq. 28b: |v.x|/(r^2 + 0.01) = 0.4/1.01. */
static void test_continuity(void)
{
    place("w.density=1000", "gravity=0,0");
    evaluate(1, 0, -1, 2);
    assert_near(1e-11, 88.2529762870353, 1000 * fluid->ddens[first], "drho_a");
    assert_near(1e-11, 90.00921138028774, 1000 * fluid->ddens[second], "drho_b");
    assert_near(1e-14, 0.4 / 1.01, rig.sim.fluid.extremes.approach, "rate of approach");
    check_forces(0.6822899792818219, 0, 0);
}

/* Eq. 7 with alpha = 0.1 and v.x = -0.4: Pi = 0.1 * 10/1015 * 0.4/1.01, which adds
 *   640 * Pi * 0.3481514 = 0.08694022155924634 m/s^2. Nothing for the same pair on its way apart.
 */
static void test_viscosity_acts_on_approaching_pairs(void)
{
    place("w.artificial_viscosity=0.1", "gravity=0,0");
    evaluate(1, 0, -1, 2);
    check_forces(0.6822899792818219 + 0.08694022155924634, 0, 0);
    place("w.artificial_viscosity=0.1", "gravity=0,0");
    evaluate(-1, 0, 1, -2);
    check_forces(0.6822899792818219, 0, 0);
    assert_near(1e-11, -88.2529762870353, 1000 * fluid->ddens[first], "drho_a");
}

/* L-1 with nu = 0.3 m^2/s, M = 0.966540345811312 and v_ab = (2, -2): 2 nu rho0 m/(rho_a rho_b) |x .
 * grad W|/M = 600 * 640/1030200 * 0.3481514/M = 0.13426347546303982 1/s against the velocity, on
 * its way together and apart, where Eq. 7 has two laws. */
static void test_laminar_viscosity(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        place("w.laminar_viscosity=0.3", "gravity=0,0");
        evaluate(sign, 0, -sign, 2 * sign);
        const double drag = 2 * sign * 0.13426347546303982;
        assert_near(1e-13, 0.6 * 0.6822899792818219 - drag, fluid->ax[first], "ax of a");
        assert_near(1e-13, 0.8 * 0.6822899792818219 + drag, fluid->ay[first], "ay of a");
        assert_near(1e-13, -0.6 * 0.6822899792818219 + drag, fluid->ax[second], "ax of b");
        assert_near(1e-13, -0.8 * 0.6822899792818219 - drag, fluid->ay[second], "ay of b");
    }
}

/* Viscosity that vanishes leaves the bits of a scene without: 1e-30 m^2/s is not zero but nothing.
 */
static void test_no_viscosity_is_the_limit(void)
{
    double ax[2], ay[2];
    for (int k = 0; k < 2; k++) {
        place(k ? "w.laminar_viscosity=1e-30" : "w.laminar_viscosity=0", "gravity=0,-9.81");
        evaluate(1, 0, -1, 2);
        TEST_ASSERT_TRUE(k == !!(rig.sim.effects & FX_LAMINAR));
        ax[k] = fluid->ax[first];
        ay[k] = fluid->ay[first];
    }
    TEST_ASSERT_TRUE(ax[0] == ax[1] && ay[0] == ay[1]);
}

/* Eq. 6 with delta = 0.1: D_a = 0.1 * 10 * 640/1020 * 2 * 10/1.01 * 0.3481514 =
 * 4.325702200129168 kg/(m^3 s); of b, less dense a: -4.368530934783912. */
static void test_diffusion_levels_densities(void)
{
    place("w.density_diffusion=0.1", "gravity=0,0");
    evaluate(0, 0, 0, 0);
    assert_near(1e-12, 4.325702200129168, 1000 * fluid->ddens[first], "D_a");
    assert_near(1e-12, -4.368530934783912, 1000 * fluid->ddens[second], "D_b");
    check_forces(0.6822899792818219, 0, 0);
}

/* Fourtakas et al. 2019: b lies 0.8 m lower and is to be denser by rho0 g 0.8/c0^2 = 78.48 kg/m^3;
 * it is so by 10, so that a loses: 4.3257022 * (10 - 78.48)/10 = -29.622408666484546. A pair with
 * just the hydrostatic difference does not diffuse. */
static void test_diffusion_spares_the_hydrostatic_part(void)
{
    place("w.density_diffusion=0.1", "w.diffusion_form=fourtakas");
    evaluate(0, 0, 0, 0);
    assert_near(1e-12, 4.325702200129168, 1000 * fluid->ddens[first], "no gravity: as Eq. 6");
    rig_open(&rig, pair, "gravity=0,-9.81", "w.density_diffusion=0.1", "w.diffusion_form=fourtakas",
             NULL);
    fluid = &rig.sim.particles[KIND_FLUID];
    for (int64_t i = 0; i < 2; i++) {
        fluid->id[i] = i;
        fluid->x[i] = i ? 0 : 0.6;
        fluid->y[i] = i ? 0 : 0.8;
        fluid->dens[i] = i ? 0.02 : 0.01;
    }
    evaluate(0, 0, 0, 0);
    assert_near(1e-11, -29.622408666484546, 1000 * fluid->ddens[first], "D_a");
    fluid->dens[first] = 0.02 - 0.07848;
    rig_evaluate(&rig);
    assert_near(1e-14, 0, fluid->ddens[first], "hydrostatic difference");
}

/* Antuono et al. 2010: a density that rises linearly is taken out of the difference exactly, at the
 * free surface and among disordered particles as well: dens = 0.01 + 0.02 x - 0.03 y. A disordered
 * one diffuses without making mass: the sum of V D vanishes. */
static void disordered_block(const char *form, bool linear)
{
    rig_open(&rig, pair, "dp=0.2", "numerics.h_over_dp=1.35", "gravity=0, 0",
             "w.density_diffusion=0.1", form, NULL);
    fluid = &rig.sim.particles[KIND_FLUID];
    uint64_t seed = 19;
    for (int64_t i = 0; i < fluid->n; i++) {
        fluid->x[i] += 0.03 * noise(&seed);
        fluid->y[i] += 0.03 * noise(&seed);
        fluid->dens[i] =
            linear ? 0.01 + 0.02 * fluid->x[i] - 0.03 * fluid->y[i] : 0.05 * noise(&seed);
    }
    rig_sort(&rig);
    rig_evaluate(&rig);
}

static void test_diffusion_spares_linear_densities(void)
{
    disordered_block("w.diffusion_form=molteni", true);
    double most = 0;
    for (int64_t i = 0; i < fluid->n; i++) most = fmax(most, fabs(fluid->ddens[i]));
    disordered_block("w.diffusion_form=antuono", true);
    for (int64_t i = 0; i < fluid->n; i++) {
        assert_near(1e-13, 0.02, fluid->slope_x[i], "gradient, x");
        assert_near(1e-13, -0.03, fluid->slope_y[i], "gradient, y");
        assert_near(1e-12 * most, 0, fluid->ddens[i], "rate of density");
    }
    disordered_block("w.diffusion_form=antuono", false);
    double sum = 0, size = 0;
    for (int64_t i = 0; i < fluid->n; i++) {
        sum += fluid->ddens[i] / (1 + fluid->dens[i]);
        size += fabs(fluid->ddens[i]);
    }
    TEST_ASSERT_TRUE(size > 0.1 * most);
    assert_near(1e-13 * size, 0, sum, "sum of V D");
}

/* L-5b: v.x = 0.003 m^2/s is a rate of strain of 0.003/1.01 1/s along the pair. So the diffusivity
 * is (6*2)^2 * 0.003/1.01 = 0.4277228 m^2/s instead of 0.1 * 10 = 1: D_a = 1.8502011 kg/(m^3 s).
 * Eq. 4a adds 0.003/0.4 times the 88.252976 of above. */
static void test_diffusion_is_limited_by_the_strain(void)
{
    static const struct {
        double u, v, drho;
        const char *what;
    } motions[] = {
        {0, 0, 0, "at rest"},
        {-1.6, 1.2, 0, "turning"},
        {0.005, 0, 1.8502013370849513 - 0.6618973221527648, "slowly apart"},
        {-0.005, 0, 1.8502013370849513 + 0.6618973221527648, "slowly together"},
        {-2, 2, 4.325702200129168 - 88.2529762870353, "fast"},
    };
    for (size_t k = 0; k < COUNT_OF(motions); k++) {
        place("w.density_diffusion=0.1", "w.diffusion_limiter=strain");
        evaluate(motions[k].u, motions[k].v, 0, 0);
        assert_near(1e-11, motions[k].drho, 1000 * fluid->ddens[first], motions[k].what);
    }
}

/* Neighbours that all but lie on a line with the particle: the gradient is exact down to a
 * determinant of a thousandth of the trace squared, and 0 below, where it would be noise. Here that
 * ratio is 0.08 and 6e-4. */
static void test_gradient_of_neighbours_almost_on_a_line(void)
{
    static const double height[] = {0.25, 0.02};
    for (int k = 0; k < 2; k++) {
        rig_open(&rig, pair, "w.shape=box 0, 0, 2.4, 0.8", "gravity=0, 0",
                 "w.density_diffusion=0.1", "w.diffusion_form=antuono", NULL);
        fluid = &rig.sim.particles[KIND_FLUID];
        TEST_ASSERT_EQUAL_INT64(3, fluid->n);
        for (int i = 0; i < 3; i++) {
            fluid->id[i] = i;
            fluid->x[i] = 0.8 * (i - 1);
            fluid->y[i] = i == 1 ? 0 : height[k];
            fluid->dens[i] = 0.02 * fluid->x[i] - 0.01 * fluid->y[i];
        }
        rig_sort(&rig);
        rig_evaluate(&rig);
        int64_t middle = 0;
        while (fluid->id[middle] != 1) middle++;
        const double exact = k == 0;
        assert_near(1e-14, 0.02 * exact, fluid->slope_x[middle], "gradient, x");
        assert_near(1e-14, -0.01 * exact, fluid->slope_y[middle], "gradient, y");
    }
}

/* Two particles span no plane: no gradient, and the pair diffuses by Eq. 6 as it stands. */
static void test_gradient_of_a_pair_is_none(void)
{
    place("w.density_diffusion=0.1", "w.diffusion_form=antuono");
    evaluate(0, 0, 0, 0);
    TEST_ASSERT_TRUE(fluid->slope_x[first] == 0 && fluid->slope_y[second] == 0);
    assert_near(1e-12, 4.325702200129168, 1000 * fluid->ddens[first], "D_a");
}

/* Diffusion that vanishes leaves the bits of a scene without. */
static void test_no_diffusion_is_the_limit(void)
{
    double rate[2];
    for (int k = 0; k < 2; k++) {
        rig_open(&rig, pair, "dp=0.2", "numerics.h_over_dp=1.35",
                 k ? "w.density_diffusion=1e-300" : "w.density_diffusion=0",
                 k ? "w.diffusion_form=antuono" : "w.diffusion_form=molteni", "w.velocity=y, x*x",
                 NULL);
        fluid = &rig.sim.particles[KIND_FLUID];
        rig_evaluate(&rig);
        rate[k] = fluid->ddens[5];
    }
    TEST_ASSERT_TRUE(rate[0] == rate[1] && rate[0] != 0);
}

/* Beyond 2h = 2 m there is nothing, whatever the cells hold. */
static void test_nothing_beyond_the_support(void)
{
    place("w.artificial_viscosity=0.1", "w.density_diffusion=0.1");
    fluid->x[0] = 2.0000001;
    fluid->y[0] = 0;
    evaluate(-1, 0, 1, 0);
    TEST_ASSERT_TRUE(fluid->ax[first] == 0 && fluid->ay[first] == 0 && fluid->ddens[first] == 0);
    fluid->x[first] = fluid->x[second] + 1.999;
    rig_sort(&rig);
    rig_evaluate(&rig);
    TEST_ASSERT_TRUE(fluid->ax[first] > 0 || fluid->ax[second] > 0);
}

/* Two particles on the same spot, and one alone: finite, and no force. */
static void test_coincident_and_lone_particles(void)
{
    place("w.artificial_viscosity=0.1", "w.density_diffusion=0.1");
    fluid->x[0] = fluid->x[1];
    fluid->y[0] = fluid->y[1];
    evaluate(1, 0, -1, 0);
    for (int64_t i = 0; i < 2; i++)
        TEST_ASSERT_TRUE(fluid->ax[i] == 0 && fluid->ay[i] == 0 && fluid->ddens[i] == 0);
    fluid->x[0] = -8;
    rig_sort(&rig);
    rig_evaluate(&rig);
    TEST_ASSERT_TRUE(fluid->ax[0] == 0 && fluid->ddens[0] == 0);
    TEST_ASSERT_TRUE(isfinite(rig.sim.fluid.extremes.approach));
}

/* Monaghan 2000 with epsilon = 0.2: rho = 990 and 1020 kg/m^3 have P_a = 1e5/7 (0.99^7 - 1) =
 * -970.4950, P_b = 2124.0810 Pa. W(1)/W(0.8) = ((1/2)^4 3)/((0.6)^4 2.6) = 0.55644587, to the
 * fourth 0.09587198, so that 0.2 * 970.4950 * 0.09587198 = 18.608656 Pa are added to P_a + P_b =
 * 1153.5859 Pa. */
static void test_tension_is_pushed_against(void)
{
    double ax[2];
    for (int k = 0; k < 2; k++) {
        place(k ? "w.tensile_control=0.2" : "w.tensile_control=0", "gravity=0,0");
        fluid->dens[0] = -0.01;
        evaluate(0, 0, 0, 0);
        ax[k] = fluid->ax[first];
        assert_near(1e-13, -ax[k], fluid->ax[second], "ax of b");
    }
    const double pa = 1e5 / 7 * (pow(0.99, 7) - 1), f = 3.0 / 16 / (pow(0.6, 4) * 2.6);
    const double push = 640 * 0.2 * -pa * pow(f, 4) / (990 * 1020.0) * 0.3481514380135211;
    TEST_ASSERT_TRUE(push > 3e-3);
    assert_near(1e-13, 0.6 * push, ax[1] - ax[0], "push");
}

/* No tension, no bit changed; nor where epsilon vanishes. */
static void test_no_tension_is_the_limit(void)
{
    double ax[4];
    const char *const control[4] = {"0", "0.2", "0", "1e-300"};
    for (int k = 0; k < 4; k++) {
        char set[64];
        snprintf(set, sizeof set, "w.tensile_control=%s", control[k]);
        place(set, "gravity=0,0");
        if (k > 1) fluid->dens[0] = -0.01;
        evaluate(1, 0, -1, 2);
        ax[k] = fluid->ax[first];
    }
    TEST_ASSERT_TRUE(ax[0] == ax[1] && ax[2] == ax[3] && ax[0] != ax[2]);
}

static double closest_after(const char *control)
{
    rig_open(&rig,
             "dp = 0.1\nend_time = 9\nprecision = double\nintegrator = symplectic\n"
             "[domain]\nlower = 0, 0\nupper = 1, 1\nperiodic = xy\n"
             "[fluid w]\nshape = box 0, 0, 1, 1\nsound_speed = 10\npressure = -1000\n"
             "artificial_viscosity = 0.1\n",
             control, NULL);
    fluid = &rig.sim.particles[KIND_FLUID];
    uint64_t seed = 3;
    for (int64_t i = 0; i < fluid->n; i++) fluid->x[i] += 0.002 * noise(&seed);
    rig_run(&rig, 1.5);
    double closest = 1;
    for (int64_t i = 0; i < fluid->n; i++)
        for (int64_t j = 0; j < i; j++)
            closest =
                fmin(closest,
                     hypot(cells_minimum_image(&rig.sim.cells, 0, fluid->x[i] - fluid->x[j]),
                           cells_minimum_image(&rig.sim.cells, 1, fluid->y[i] - fluid->y[j])));
    return closest / 0.1;
}

/* Stretched fluid at -1000 Pa, a lattice disturbed by 2 % of dp, clumps within 1.5 s: its closest
 * pair is 0.67 dp apart. With epsilon = 0.2 the lattice stays, 0.98 dp. */
static void test_stretched_fluid_does_not_clump(void)
{
    assert_at_most(0.75, closest_after("w.tensile_control=0"), "closest pair over dp, without");
    assert_at_most(-0.95, -closest_after("w.tensile_control=0.2"), "closest pair over dp, less");
}

/* Lind et al. 2012, on b: grad C = m/rho_a grad_b W = 640/1010 * 0.3481514380135211 (0.6, 0.8), and
 * the divergence of the positions 640/1010 * 0.3481514 |x|^2 = 0.2206108122065876: too little for a
 * shift. */
static void test_concentration_by_hand(void)
{
    place("w.shifting=2", "gravity=0,0");
    evaluate(1, 0, -1, 2);
    const double size = 0.2206108122065876;
    assert_near(1e-14, 0.6 * size, fluid->grad_c_x[second], "gradient, x");
    assert_near(1e-14, 0.8 * size, fluid->grad_c_y[second], "gradient, y");
    assert_near(1e-14, size, fluid->div_r[second], "divergence");
    const double x = fluid->x[second];
    TEST_ASSERT_TRUE(fluid_shift(&rig.sim.fluid, fluid, 0.1) == 0 && fluid->x[second] == x);
}

static const char block[] = "dp = 0.1\nend_time = 1\nprecision = double\n"
                            "[domain]\nlower = -2, -2\nupper = 4, 4\n"
                            "[fluid w]\nshape = box 0, 0, 2, 2\nsound_speed = 10\nshifting = 2\n";

/* Inside of a lattice all is even and nothing is shifted; a particle that is out of its place by
 * 0.01 = 0.1 dp goes back by A h |v| dt |grad C|; one at the surface stays. |v| is `counts` where
 * particles move at `moves`. */
static void shift_evens_out(const char *whose, double moves, double counts)
{
    rig_open(&rig, block, whose, NULL);
    fluid = &rig.sim.particles[KIND_FLUID];
    for (int64_t i = 0; i < fluid->n; i++) fluid->vx[i] = moves;
    rig_evaluate(&rig);
    for (int64_t i = 0; i < fluid->n; i++) {
        const double edge =
            fmin(fmin(fluid->x[i], 2 - fluid->x[i]), fmin(fluid->y[i], 2 - fluid->y[i]));
        if (edge < 0.3) continue;
        assert_near(1e-12, 0, hypot(fluid->grad_c_x[i], fluid->grad_c_y[i]), "gradient inside");
        /* The lattice's quadrature of 2: 1.96566 for h/dp = 1.35. */
        assert_near(1e-3, 1.9657, fluid->div_r[i], "divergence inside");
    }
    int64_t out = 0, corner = 0;
    for (int64_t i = 0; i < fluid->n; i++) {
        if (hypot(fluid->x[i] - 1.05, fluid->y[i] - 1.05) < 0.01) out = i;
        if (hypot(fluid->x[i] - 0.05, fluid->y[i] - 0.05) < 0.01) corner = i;
    }
    fluid->x[out] += 0.01;
    rig_evaluate(&rig);
    const double x = fluid->x[out], y = fluid->y[out], at = fluid->x[corner];
    const double fade = (fluid->div_r[out] - 1.5) / 0.5;
    const double expected = 2 * 0.135 * counts * 0.02 * fade * fluid->grad_c_x[out];
    TEST_ASSERT_TRUE(fade > 0.5 && fluid->grad_c_x[out] > 0.1);
    fluid_shift(&rig.sim.fluid, fluid, 0.02);
    assert_near(1e-15, x - expected, fluid->x[out], "x");
    assert_near(1e-14, y, fluid->y[out], "y");
    TEST_ASSERT_TRUE(fluid->x[corner] == at);
}

static void test_shift_evens_out(void)
{
    shift_evens_out("w.shifting_speed=own", 3, 3);
    shift_evens_out("w.shifting_speed=largest", 3, 1); /* c0/10 */
}

/* A shift that vanishes leaves the bits of a scene without. */
static void test_no_shift_is_the_limit(void)
{
    double x[2], vy[2];
    for (int k = 0; k < 2; k++) {
        rig_open(&rig, block, k ? "w.shifting=1e-300" : "w.shifting=0", "w.velocity=y, -x", NULL);
        TEST_ASSERT_TRUE(k == !!(rig.sim.effects & FX_SHIFTING));
        TEST_ASSERT_TRUE(k == !!rig.sim.particles[KIND_FLUID].div_r);
        rig_steps(&rig, 20, 1);
        x[k] = rig.sim.particles[KIND_FLUID].x[77];
        vy[k] = rig.sim.particles[KIND_FLUID].vy[77];
    }
    TEST_ASSERT_TRUE(x[0] == x[1] && vy[0] == vy[1]);
}

/* Momentum of the disordered fluid: forces cancel to the round-off of their sizes. */
static void test_forces_between_particles_cancel(void)
{
    rig_open(&rig, pair, "w.artificial_viscosity=0.5", "dp=0.2", "numerics.h_over_dp=1.35",
             "w.laminar_viscosity=0.3", "w.tensile_control=0.3", NULL);
    fluid = &rig.sim.particles[KIND_FLUID];
    uint64_t seed = 11;
    for (int64_t i = 0; i < fluid->n; i++) {
        fluid->x[i] += 0.05 * noise(&seed);
        fluid->y[i] += 0.05 * noise(&seed);
        fluid->vx[i] = noise(&seed);
        fluid->vy[i] = noise(&seed);
        fluid->dens[i] = 0.05 * noise(&seed);
    }
    rig_sort(&rig);
    rig_evaluate(&rig);
    double sum_x = 0, sum_y = 0, size = 0;
    for (int64_t i = 0; i < fluid->n; i++) {
        sum_x += fluid->ax[i];
        sum_y += fluid->ay[i];
        size += hypot(fluid->ax[i], fluid->ay[i]);
    }
    TEST_ASSERT_TRUE(fluid->n == 32 && size > 1);
    assert_near(1e-13 * size, 0, sum_x, "sum of forces, x");
    assert_near(1e-13 * size, 0, sum_y, "sum of forces, y");
}

/* As few chunks as hold the cells, in whole rounds of 24 or, of few cells, 8, and each cell in one
 * of them. */
static void test_chunks_of_cells(void)
{
    const int32_t cells[] = {0, 1, 256, 257, 1024, 1025, 3071, 3072, 3073, 6144, 6145, 100000};
    const int32_t chunks[] = {0, 4, 4, 8, 8, 16, 24, 24, 48, 48, 72, 792};
    for (size_t k = 0; k < COUNT_OF(cells); k++) {
        TEST_ASSERT_EQUAL_INT32(chunks[k], fluid_chunk_count(cells[k]));
        if (cells[k] == 0) continue;
        TEST_ASSERT_EQUAL_INT32(0, fluid_chunk_start(cells[k], 0));
        TEST_ASSERT_EQUAL_INT32(cells[k], fluid_chunk_start(cells[k], chunks[k]));
        for (int32_t m = 0; m < chunks[k]; m++) {
            const int32_t size =
                fluid_chunk_start(cells[k], m + 1) - fluid_chunk_start(cells[k], m);
            TEST_ASSERT_TRUE(size >= 0 && size <= 128);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_chunks_of_cells);
    RUN_TEST(test_pressure);
    RUN_TEST(test_particles_of_unlike_mass);
    RUN_TEST(test_masses_carry_the_density);
    RUN_TEST(test_acoustic_damper);
    RUN_TEST(test_damper_follows_density);
    RUN_TEST(test_gravity_is_added);
    RUN_TEST(test_continuity);
    RUN_TEST(test_viscosity_acts_on_approaching_pairs);
    RUN_TEST(test_laminar_viscosity);
    RUN_TEST(test_no_viscosity_is_the_limit);
    RUN_TEST(test_diffusion_levels_densities);
    RUN_TEST(test_diffusion_spares_the_hydrostatic_part);
    RUN_TEST(test_diffusion_spares_linear_densities);
    RUN_TEST(test_diffusion_is_limited_by_the_strain);
    RUN_TEST(test_gradient_of_neighbours_almost_on_a_line);
    RUN_TEST(test_gradient_of_a_pair_is_none);
    RUN_TEST(test_no_diffusion_is_the_limit);
    RUN_TEST(test_nothing_beyond_the_support);
    RUN_TEST(test_coincident_and_lone_particles);
    RUN_TEST(test_tension_is_pushed_against);
    RUN_TEST(test_no_tension_is_the_limit);
    RUN_TEST(test_stretched_fluid_does_not_clump);
    RUN_TEST(test_concentration_by_hand);
    RUN_TEST(test_shift_evens_out);
    RUN_TEST(test_no_shift_is_the_limit);
    RUN_TEST(test_forces_between_particles_cancel);
    return UNITY_END();
}
