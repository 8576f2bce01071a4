/* SPDX-License-Identifier: MIT
 * The fluid's sweeps against a second, plain implementation of the paper's equations
 * (support/twin.c) on disordered particles in a wall corner with a structure.
 *
 * Tolerances, relative to the largest sum of the sizes of a particle's terms (what its round-off is
 * relative to). Double: coordinates of some 30 h are known to 4e-15 h, and a term changes by at
 * most a few times its size per h; with densities near rho0 the pressure B ((1 + d)^7 - 1) of the
 * twin loses a digit or two: 1e-12 of the terms. Mixed: lanes hold offsets up to 4 h from a cell's
 * centre as floats, known to 2.4e-7 h each; a term t^3 xi, whose slope is at most 1.5 a unit of its
 * own size near the particle, is off by some 1e-6 of itself, and a dozen neighbours of random sign
 * do not add up to more than that: 2e-6 of the terms. */
#include "twin.h"

#include "rig.h"
#include "unity.h"

#include <math.h>

static const char scene[] =
    "dp = 1 cm\nend_time = 1 s\ngravity = 1.5, -9.81\n"
    "[fluid water]\nshape = box 0, 0, 0.24, 0.2\nsound_speed = 20\nartificial_viscosity = 0.05\n"
    "density_diffusion = 0.1\n"
    "[wall floor]\nshape = box -0.06, -0.06, 0.3, 0\n"
    "[wall side]\nshape = box -0.06, 0, 0, 0.25\nmotion = push\n"
    "[motion push]\nx = 0.1*t\n"
    "[solid gate]\nshape = box 0.24, 0, 0.3, 0.25\ndensity = 1100\nyoung = 1e6\npoisson = 0.4\n"
    "[domain]\nlower = -0.3, -0.3\nupper = 0.6, 0.6\n";

/* Through a side in x: fluid between walls that it sticks to, one of them moving. */
static const char channel[] =
    "dp = 1 cm\nend_time = 1 s\ngravity = 1.5, -9.81\n"
    "[fluid water]\nshape = box 0, 0, 0.24, 0.2\nsound_speed = 20\nartificial_viscosity = 0.05\n"
    "density_diffusion = 0.1\nlaminar_viscosity = 0.05\n"
    "[wall floor]\nshape = box 0, -0.06, 0.3, 0\nslip = none\n"
    "[wall roof]\nshape = box 0, 0.2, 0.26, 0.23\nmotion = push\nslip = none\n"
    "[wall middle]\nshape = box 0.24, 0, 0.26, 0.2\n"
    "[motion push]\nx = 0.1*t\n"
    "[solid gate]\nshape = box 0.26, 0.05, 0.3, 0.45\ndensity = 1100\nyoung = 1e6\npoisson = 0.4\n"
    "slip = none\n[domain]\nlower = 0, -0.3\nupper = 0.3, 0.6\nperiodic = x\n";

static struct rig rig;
static struct twin twin;

void setUp(void) {}

void tearDown(void)
{
    twin_free(&twin);
    rig_close(&rig);
}

/* Displaces every particle by up to 0.2 dp and gives it a velocity, density and acceleration. */
static void disorder(void)
{
    uint64_t seed = 42, other = 7; /* places are the same whatever fields there are */
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        struct particles *const particles = &rig.sim.particles[kind];
        for (int64_t i = 0; i < particles->n; i++) {
            particles->x[i] += 0.002 * noise(&seed);
            particles->y[i] += 0.002 * noise(&seed);
            particles->vx[i] = noise(&seed);
            particles->vy[i] = noise(&seed);
            if (particles->ax) particles->ax[i] = 20 * noise(&seed);
            if (particles->ay) particles->ay[i] = 20 * noise(&seed);
            if (kind == KIND_FLUID) particles->dens[i] = 0.01 + 0.02 * noise(&seed);
            if (kind == KIND_FLUID && particles->m) particles->m[i] = 1 + 0.2 * noise(&other);
            if (kind == KIND_FLUID && particles->dens_slow)
                particles->dens_slow[i] = 0.01 + 0.02 * noise(&other);
            if (kind == KIND_SOLID) particles->wx[i] = noise(&seed);
            if (kind == KIND_SOLID) particles->wy[i] = noise(&seed);
        }
    }
    rig_sort(&rig);
}

static void compare_fluid(double tolerance)
{
    const struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    const double rho0 = twin.rho0;
    double top_a = 0, top_rho = 0, size_a = 0, size_rho = 0, size_p = 0, top_p = 0;
    for (int64_t i = 0; i < particles->n; i++) {
        const struct twin_point *const q = &twin.point[KIND_FLUID][i];
        size_a = fmax(size_a, q->size_a);
        size_rho = fmax(size_rho, q->size_drho);
        size_p = fmax(size_p, fabs(q->p_state));
        top_a = fmax(top_a, hypot(particles->ax[i] - q->ax, particles->ay[i] - q->ay));
        top_rho = fmax(top_rho, fabs(rho0 * particles->ddens[i] - q->drho));
        top_p = fmax(top_p, fabs(rig_pressure(&rig.sim, i) - q->p_state));
        if (!particles->div_r) continue;
        /* Both are of the size of 1/h and 1. */
        assert_near(tolerance / twin.h, q->cx, particles->grad_c_x[i],
                    "gradient of the concentration, x");
        assert_near(tolerance / twin.h, q->cy, particles->grad_c_y[i],
                    "gradient of the concentration, y");
        assert_near(2 * tolerance, q->div_r, particles->div_r[i], "divergence of the positions");
    }
    TEST_ASSERT_TRUE(size_a > 100 && size_rho > 1e4);
    assert_at_most(tolerance, top_a / size_a, "acceleration of the fluid");
    assert_at_most(tolerance, top_rho / size_rho, "rate of density");
    /* The state is double in both precisions. */
    assert_at_most(1e-13, top_p / size_p, "pressure of the fluid");
    const struct rate_extremes *const top = &rig.sim.fluid.extremes;
    assert_near(tolerance, 1, sqrt(top->acceleration2) / twin.top_acceleration, "largest |a|");
    assert_near(tolerance, 1, top->approach / twin.top_approach, "largest rate of approach");
}

/* Where hardly any fluid is in reach (W below 1e-3 of W(0) in all) the quotient of Eq. 19 is as
 * uncertain as the single distances at the rim of the support; the force of such a particle is
 * compared with the others' all the same. */
static void compare_dummies(enum kind kind, double tolerance)
{
    const struct particles *const particles = &rig.sim.particles[kind];
    const double c2 = twin.rho0 * twin.c0 * twin.c0;
    double top = 0, top_rho = 0, size = 0;
    int64_t wet = 0, dry = 0;
    for (int64_t i = 0; i < particles->n; i++) {
        const struct twin_point *const q = &twin.point[kind][i];
        size = fmax(size, q->size_p);
        if (q->weight == 0) {
            dry++;
            TEST_ASSERT_TRUE(particles->p[i] == 0);
            TEST_ASSERT_TRUE(particles->dens[i] == 0);
        }
        if (q->weight < 1e-3) continue;
        wet++;
        top = fmax(top, fabs(particles->p[i] - q->p));
        top_rho = fmax(top_rho, fabs(twin.rho0 * (1 + particles->dens[i]) - q->rho) / twin.rho0);
    }
    TEST_ASSERT_TRUE(wet > 30);
    TEST_ASSERT_TRUE(dry > 30);
    assert_at_most(tolerance, top / size, "extrapolated pressure");
    assert_at_most(tolerance * size / c2 + 1e-15, top_rho, "extrapolated density");
}

static void compare_forces(double tolerance)
{
    const struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    double top = 0, size = 0;
    for (int64_t i = 0; i < particles->n; i++) {
        const struct twin_point *const q = &twin.point[KIND_SOLID][i];
        size = fmax(size, q->size_f);
        top = fmax(top, hypot(particles->fx[i] - q->fx, particles->fy[i] - q->fy));
    }
    TEST_ASSERT_TRUE(size > 0);
    assert_at_most(tolerance, top / size, "force on the solid");
}

static void agree(const char *text, const char *precision, const char *set, const char *another,
                  double tolerance)
{
    rig_open(&rig, text, precision, set, another, NULL);
    disorder();
    twin_copy(&twin, &rig.sim);
    rig_evaluate(&rig);
    twin_evaluate(&twin);
    compare_fluid(tolerance);
    compare_dummies(KIND_WALL, tolerance);
    compare_dummies(KIND_SOLID, tolerance);
    compare_forces(tolerance);
    twin_free(&twin);
}

/* The fluid after a while: other places and densities, but the gradients of the density found
 * before. */
static void agree_with_earlier_slopes(const char *text, const char *precision, double tolerance)
{
    struct twin before;
    uint64_t seed = 5;
    rig_open(&rig, text, precision, "water.diffusion_form=antuono", "water.density_diffusion=0.5",
             NULL);
    disorder();
    twin_copy(&before, &rig.sim);
    rig_evaluate(&rig);
    twin_evaluate(&before);
    struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    for (int64_t i = 0; i < particles->n; i++) {
        particles->x[i] += 2e-4 * noise(&seed);
        particles->y[i] += 2e-4 * noise(&seed);
        particles->dens[i] += 0.01 * noise(&seed);
    }
    twin_copy(&twin, &rig.sim);
    twin.given_slopes = true;
    for (int64_t i = 0; i < particles->n; i++) {
        twin.point[KIND_FLUID][i].sx = before.point[KIND_FLUID][i].sx;
        twin.point[KIND_FLUID][i].sy = before.point[KIND_FLUID][i].sy;
    }
    twin_free(&before);
    rig.sim.fluid.keeps_slopes = true;
    rig_evaluate(&rig);
    twin_evaluate(&twin);
    compare_fluid(tolerance);
    twin_free(&twin);
}

static void agree_for_all_effects(const char *precision, double tolerance)
{
    const char *const viscosity[] = {"water.artificial_viscosity=0",
                                     "water.artificial_viscosity=0.05"};
    const char *const diffusion[] = {"water.density_diffusion=0", "water.density_diffusion=0.1"};
    for (int v = 0; v < 2; v++)
        for (int d = 0; d < 2; d++) agree(scene, precision, viscosity[v], diffusion[d], tolerance);
    agree(scene, precision, "water.artificial_viscosity=0.05", "numerics.suction=on", tolerance);
    agree(scene, precision, "water.diffusion_form=fourtakas", "water.density_diffusion=0.5",
          tolerance);
    agree(scene, precision, "numerics.h_over_dp=2", "numerics.skin=0", tolerance);
    agree(scene, precision, "numerics.h_over_dp=2.6", "numerics.skin=0", tolerance);
    agree(channel, precision, "water.artificial_viscosity=0", "water.density_diffusion=0",
          tolerance);
    agree(channel, precision, "water.artificial_viscosity=0.05", "numerics.suction=on", tolerance);
    agree(scene, precision, "water.tensile_control=0.3", "water.density_diffusion=0", tolerance);
    agree(scene, precision, "water.wall_repulsion=0.3", "numerics.suction=on", tolerance);
    agree(scene, precision, "water.wall_repulsion=0.3", "numerics.sides=one", tolerance);
    agree(channel, precision, "numerics.sides=one", "numerics.suction=on", tolerance);
    agree(scene, precision, "water.diffusion_form=antuono", "water.density_diffusion=0.5",
          tolerance);
    agree(channel, precision, "water.diffusion_form=antuono", "water.shifting=1", tolerance);
    agree(scene, precision, "water.diffusion_limiter=strain", "water.density_diffusion=1",
          tolerance);
    agree_with_earlier_slopes(scene, precision, tolerance);
    agree_with_earlier_slopes(channel, precision, tolerance);
    agree(channel, precision, "water.shifting=2", "water.artificial_viscosity=0", tolerance);
    agree(scene, precision, "water.acoustic_damper=4", "water.wall_repulsion=0.3", tolerance);
    agree(scene, precision, "water.wall_damping=1", "water.wall_repulsion=0.3", tolerance);
    agree(scene, precision, "water.particle_mass=hydrostatic", "water.surface=0.2", tolerance);
    agree(channel, precision, "water.particle_mass=hydrostatic", "water.surface=0.2", tolerance);
    agree(scene, precision, "scheme=standard", "water.surface=0.2", tolerance);
}

static void test_double(void) { agree_for_all_effects("precision=double", 1e-12); }

static void test_mixed(void) { agree_for_all_effects("precision=mixed", 2e-6); }

/* The twin differs if any law differs by one part in a million: viscosity, diffusion, gravity. */
static void test_the_comparison_can_fail(void)
{
    rig_open(&rig, channel, "precision=double", "water.wall_repulsion=0.3", "water.wall_damping=1",
             NULL);
    disorder();
    rig_evaluate(&rig);
    for (int what = 0; what < 7; what++) {
        twin_copy(&twin, &rig.sim);
        double *const constant[] = {&twin.alpha, &twin.delta,     &twin.g[1],        &twin.h,
                                    &twin.nu,    &twin.repulsion, &twin.wall_damping};
        *constant[what] *= 1 + 1e-6;
        twin_evaluate(&twin);
        double a = 0, rho = 0, size_a = 0, size_rho = 0;
        for (int64_t i = 0; i < twin.n[KIND_FLUID]; i++) {
            const struct twin_point *const q = &twin.point[KIND_FLUID][i];
            a = fmax(a, fabs(rig.sim.particles[KIND_FLUID].ay[i] - q->ay));
            rho = fmax(rho, fabs(rig.sim.particles[KIND_FLUID].ddens[i] * twin.rho0 - q->drho));
            size_a = fmax(size_a, q->size_a);
            size_rho = fmax(size_rho, q->size_drho);
        }
        TEST_ASSERT_TRUE(fmax(a / size_a, rho / size_rho) > 1e-11);
        twin_free(&twin);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_double);
    RUN_TEST(test_mixed);
    RUN_TEST(test_the_comparison_can_fail);
    return UNITY_END();
}
