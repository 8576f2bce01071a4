/* SPDX-License-Identifier: MIT
 * The solid's packs against a second, plain implementation of Eqs. 9-18 (support/twin_solid.c): two
 * bodies of different material, deformed and in motion without a pattern.
 *
 * Tolerances: F to 1e-12 (sums of some 20 terms of order 1, coordinates known to 1e-14 of dp),
 * stress to 1e-12 of Young's modulus, and accelerations to 1e-12 of the largest sum of the sizes of
 * the terms of a particle, which the round-off of its sum is relative to. With pairs in float: the
 * same sums, 1e-6. */
#include "twin_solid.h"

#include "rig.h"
#include "time/advance.h"
#include "time/timestep.h"
#include "unity.h"

#include <math.h>

static const char scene[] =
    "dp = 1 cm\nend_time = 1\n"
    "[solid bar]\nshape = box 0, 0, 0.15, 0.05\nclamp = box 0, 0, 0.02, 0.05\n"
    "density = 1100\nyoung = 2e6\npoisson = 0.4\ngradient = linear\n"
    "[solid plug]\nshape = circle 0.25, 0.02, 0.045\n"
    "density = 2700\nyoung = 5e6\npoisson = 0.25\ngradient = linear\n";

static const char *text = scene, *precision = "numerics.solid_precision=double";
static double tolerance = 1e-12;
static struct rig rig;
static struct twin_solid twin;

void setUp(void) {}

void tearDown(void)
{
    twin_solid_free(&twin);
    rig_close(&rig);
}

/* A rotation by 0.7, stretches of +20 % and -15 %, and noise of 5 % of dp; velocities at random. */
static void deform(struct particles *particles)
{
    uint64_t seed = 99;
    for (int64_t i = 0; i < particles->n; i++) {
        const double a = 1.2 * particles->X[i] + 0.1 * particles->Y[i], b = 0.85 * particles->Y[i];
        particles->ux[i] = cos(0.7) * a - sin(0.7) * b - particles->X[i] + 5e-4 * noise(&seed);
        particles->uy[i] = sin(0.7) * a + cos(0.7) * b - particles->Y[i] + 5e-4 * noise(&seed);
        particles->vx[i] = noise(&seed);
        particles->vy[i] = noise(&seed);
    }
}

/* The viscous stress counts in: it is large, since velocities are at random. So does, in float, the
 * share of hourglass control, of whose errors the noise makes a twentieth of dp. */
static double scale_of_stress(const struct scene_solid *b)
{
    const double hourglass = tolerance > 1e-9 ? 0.05 * b->hourglass : 0;
    return b->young * (1 + b->damping_time * 1000 + hourglass);
}

static double difference(struct twin_mat t, double xx, double xy, double yx, double yy)
{
    return fmax(fmax(fabs(t.m[0][0] - xx), fabs(t.m[0][1] - xy)),
                fmax(fabs(t.m[1][0] - yx), fabs(t.m[1][1] - yy)));
}

static void compare_stress(const struct particles *particles)
{
    for (int64_t i = 0; i < particles->n; i++) {
        const struct twin_solid_point *const q = &twin.point[i];
        const double young = scale_of_stress(&twin.body[q->body]);
        const double off = difference(q->F, 1 + particles->Uxx[i], particles->Uxy[i],
                                      particles->Uyx[i], 1 + particles->Uyy[i]);
        assert_at_most(tolerance, off, "deformation gradient");
        assert_at_most(tolerance * young,
                       difference(q->P, particles->Pxx[i], particles->Pxy[i], particles->Pyx[i],
                                  particles->Pyy[i]),
                       "first Piola-Kirchhoff stress");
        double sigma[4], det;
        solid_cauchy(&rig.sim.solid, particles, i, sigma, &det);
        assert_at_most(tolerance * young,
                       difference(q->sigma, sigma[0], sigma[2], sigma[2], sigma[1]),
                       "Cauchy stress");
    }
}

static void compare(const char *set, const char *another, const char *third)
{
    rig_open(&rig, text, precision, set, another, third, NULL);
    struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    deform(particles);
    timestep_watch_contact(&rig.sim, 0, 1);
    solid_stress(&rig.sim.solid, particles);
    solid_forces(&rig.sim.solid, particles);
    twin_solid_copy(&twin, &rig.sim);
    twin_solid_evaluate(&twin);
    compare_stress(particles);
    double size[2] = {0}, top[2] = {0};
    for (int64_t i = 0; i < particles->n; i++) {
        const struct twin_solid_point *const q = &twin.point[i];
        size[q->body] = fmax(size[q->body], q->size);
        if (particles->free[i] > 0)
            top[q->body] =
                fmax(top[q->body], hypot(particles->sx[i] - q->ax, particles->sy[i] - q->ay));
        else
            TEST_ASSERT_TRUE(particles->sx[i] == 0 && particles->sy[i] == 0);
    }
    for (int k = 0; k < 2; k++) {
        TEST_ASSERT_TRUE(size[k] > 1e3);
        assert_at_most(tolerance, top[k] / size[k], rig.scene.solid[k].common.name);
    }
    twin_solid_free(&twin);
}

static void test_laws_in_plane_strain(void)
{
    compare("plug.law=paper", "bar.law=paper", "bar.plane=strain");
    compare("plug.law=svk", "bar.law=neo_hookean", "bar.plane=strain");
    compare("plug.law=neo_hookean", "bar.law=svk", "bar.plane=strain");
}

static void test_laws_in_plane_stress(void)
{
    compare("plug.plane=stress", "bar.law=paper", "bar.plane=stress");
    compare("bar.plane=strain", "plug.law=svk", "plug.plane=stress");
    compare("bar.law=neo_hookean", "plug.law=neo_hookean", "bar.plane=stress");
}

static void test_hourglass_forms(void)
{
    compare("bar.hourglass_form=printed", "plug.hourglass_form=variational", "plug.hourglass=10");
    compare("bar.hourglass_form=variational", "plug.hourglass_form=printed", "bar.hourglass=200");
    compare("bar.hourglass=0", "plug.hourglass=0", "bar.law=paper");
}

static void test_viscosity_forms(void)
{
    compare("bar.viscosity_form=printed", "plug.viscosity_form=symmetric",
            "bar.artificial_viscosity=1");
    compare("bar.viscosity_form=symmetric", "plug.viscosity_form=printed",
            "plug.artificial_viscosity=1");
    compare("bar.artificial_viscosity=0", "plug.artificial_viscosity=0", "bar.hourglass=0");
}

static void test_kelvin_voigt(void)
{
    compare("bar.damping_time=1 ms", "bar.law=svk", "plug.plane=stress");
    compare("plug.damping_time=0.1 ms", "plug.plane=stress", "bar.damping_time=2 ms");
}

/* Two materials bonded to each other. */
static void test_joined_bodies(void)
{
    static const char pair[] =
        "dp = 1 cm\nend_time = 1\n"
        "[solid bar]\nshape = box 0, 0, 0.15, 0.05\nclamp = box 0, 0, 0.02, 0.05\n"
        "density = 1100\nyoung = 2e6\npoisson = 0.4\ngradient = linear\n"
        "[solid plug]\nlike = bar\nshape = box 0.15, -0.02, 0.25, 0.06\njoined = bar\n"
        "density = 2700\nyoung = 5e6\npoisson = 0.25\n";
    text = pair;
    compare("plug.artificial_viscosity=1", "bar.law=svk", "plug.law=neo_hookean");
    compare("bar.hourglass_form=printed", "plug.hourglass_form=printed", "bar.law=svk");
    compare("bar.viscosity_form=symmetric", "bar.artificial_viscosity=0",
            "plug.artificial_viscosity=1");
    text = scene;
}

/* Two bodies that touch, pressed into each other by the deformation. */
static void test_contact(void)
{
    static const char pair[] =
        "dp = 1 cm\nend_time = 1\n"
        "[solid bar]\nshape = box 0, 0, 0.15, 0.05\nclamp = box 0, 0, 0.02, 0.05\n"
        "density = 1100\nyoung = 2e6\npoisson = 0.4\ngradient = linear\n"
        "[solid plug]\nlike = bar\nshape = box 0.1, 0.05, 0.18, 0.1\n"
        "density = 2700\nyoung = 5e6\npoisson = 0.25\n[contact all]\n";
    text = pair;
    compare("all.stiffness=1", "all.damping=0", "all.friction=0");
    compare("all.stiffness=3", "all.damping=0.4", "all.friction=0.5");
    text = scene;
}

static void run_all(void)
{
    RUN_TEST(test_laws_in_plane_strain);
    RUN_TEST(test_laws_in_plane_stress);
    RUN_TEST(test_hourglass_forms);
    RUN_TEST(test_viscosity_forms);
    RUN_TEST(test_kelvin_voigt);
    RUN_TEST(test_joined_bodies);
    RUN_TEST(test_contact);
}

int main(void)
{
    UNITY_BEGIN();
    run_all();
    precision = "numerics.solid_precision=single";
    tolerance = 1e-6;
    run_all();
    return UNITY_END();
}
