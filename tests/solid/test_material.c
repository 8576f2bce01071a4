/* SPDX-License-Identifier: MIT
 * Stress laws: numbers by hand, small strains, objectivity, energy, what happens across the plane.
 */
#include "solid/material_energy.h"

#include "rig.h"
#include "unity.h"

#include <math.h>

static const int laws[] = {LAW_PAPER, LAW_SVK, LAW_NEO_HOOKEAN};
static const int planes[] = {PLANE_STRAIN, PLANE_STRESS};

void setUp(void) {}
void tearDown(void) {}

/* lambda = 3, mu = 2 (nu = 0.3, E = 5.2). */
static struct solid_body body(int law, int plane)
{
    return (struct solid_body){.lambda = 3, .mu = 2, .young = 5.2, .law = law, .plane = plane};
}

static struct vtensor2 spread(struct tensor2 a)
{
    return (struct vtensor2){vset_double(a.xx), vset_double(a.xy), vset_double(a.yx),
                             vset_double(a.yy)};
}

static struct tensor2 pk1(const struct solid_body *b, struct tensor2 U)
{
    const struct vtensor2 P = material_pk1(b, spread(U));
    for (int l = 1; l < LANES_DOUBLE; l++)
        TEST_ASSERT_TRUE(P.xx[l] == P.xx[0] && P.xy[l] == P.xy[0] && P.yx[l] == P.yx[0]);
    return (struct tensor2){P.xx[0], P.xy[0], P.yx[0], P.yy[0]};
}

static struct tensor2 draw(uint64_t *seed, double size)
{
    return (struct tensor2){size * noise(seed), size * noise(seed), size * noise(seed),
                            size * noise(seed)};
}

static void assert_tensor(double tolerance, struct tensor2 e, struct tensor2 a, const char *what)
{
    assert_near(tolerance, e.xx, a.xx, what);
    assert_near(tolerance, e.xy, a.xy, what);
    assert_near(tolerance, e.yx, a.yx, what);
    assert_near(tolerance, e.yy, a.yy, what);
}

/* F = diag(1.1, 1) in plane strain.
 *   svk:   E_xx = 0.105, S = (7 * 0.105, 3 * 0.105), P = (1.1 * 0.735, 0.315)
 *   paper: eps_xx = (1 - 1/1.21)/2 = 0.08677685950413, sigma = (7, 3) eps, P = (sigma_xx, 1.1
 * sigma_yy) neo-Hookean: P = (2.2 + (1.5 * 0.21 - 2)/1.1, 2 + 1.5 * 0.21 - 2) */
static void test_stretch_by_hand(void)
{
    const struct tensor2 U = {0.1, 0, 0, 0};
    const double eps = 0.5 * (1 - 1 / 1.21);
    struct solid_body b = body(LAW_SVK, PLANE_STRAIN);
    assert_tensor(1e-15, (struct tensor2){0.8085, 0, 0, 0.315}, pk1(&b, U), "svk");
    b.law = LAW_PAPER;
    assert_tensor(1e-15, (struct tensor2){7 * eps, 0, 0, 3.3 * eps}, pk1(&b, U), "paper");
    b.law = LAW_NEO_HOOKEAN;
    assert_tensor(1e-15, (struct tensor2){2.2 - 1.685 / 1.1, 0, 0, 0.315}, pk1(&b, U),
                  "neo-Hookean");
}

/* Simple shear F = [[1, 0.2], [0, 1]], J = 1.
 *   svk: E = [[0, 0.1], [0.1, 0.02]], S = [[0.06, 0.4], [0.4, 0.14]], P = F S
 *   paper: eps = F^-T E F^-1 = [[0, 0.1], [0.1, -0.02]], sigma = [[-0.06, 0.4], [0.4, -0.14]],
 *          P = sigma F^-T, F^-T = [[1, 0], [-0.2, 1]]
 *   neo-Hookean: P = 2 (F - F^-T) */
static void test_shear_by_hand(void)
{
    const struct tensor2 U = {0, 0.2, 0, 0};
    struct solid_body b = body(LAW_SVK, PLANE_STRAIN);
    assert_tensor(1e-15, (struct tensor2){0.14, 0.428, 0.4, 0.14}, pk1(&b, U), "svk");
    b.law = LAW_PAPER;
    assert_tensor(1e-15, (struct tensor2){-0.14, 0.4, 0.428, -0.14}, pk1(&b, U), "paper");
    b.law = LAW_NEO_HOOKEAN;
    assert_tensor(1e-15, (struct tensor2){0, 0.4, 0.4, 0}, pk1(&b, U), "neo-Hookean");
}

/* Linear elasticity for strains and rotations of e = 1e-6: sigma = lambda tr(eps) + 2 mu eps. The
 * next order is at most some 10 e of the moduli. */
static void test_small_strains_are_linear(void)
{
    uint64_t seed = 1;
    const double e = 1e-6;
    for (int turn = 0; turn < 20; turn++) {
        const struct tensor2 U = draw(&seed, e);
        for (int l = 0; l < 3; l++) {
            for (int k = 0; k < 2; k++) {
                const struct solid_body b = body(laws[l], planes[k]);
                /* Plane stress: E/(1 - nu^2) = 5.714286, nu E/(1 - nu^2) = 1.714286. */
                const double lambda = planes[k] == PLANE_STRESS ? 5.2 * 0.3 / 0.91 : 3;
                const double trace = lambda * (U.xx + U.yy), shear = 2 * (U.xy + U.yx);
                const struct tensor2 linear = {trace + 4 * U.xx, shear, shear, trace + 4 * U.yy};
                assert_tensor(10 * e * 7 * e, linear, pk1(&b, U), "linear elasticity");
            }
        }
    }
}

/* P(Q F) = Q P(F): rotating afterwards rotates the stress; and no stress for F = Q. */
static void test_rotations_do_not_strain(void)
{
    uint64_t seed = 2;
    for (int turn = 0; turn < 20; turn++) {
        const double angle = 3.2 * noise(&seed);
        const struct tensor2 Q = {cos(angle), -sin(angle), sin(angle), cos(angle)};
        const struct tensor2 U = draw(&seed, 0.3), F = {1 + U.xx, U.xy, U.yx, 1 + U.yy};
        const struct tensor2 QF = tensor2_mul(Q, F);
        const struct tensor2 turned = {QF.xx - 1, QF.xy, QF.yx, QF.yy - 1};
        for (int l = 0; l < 3; l++) {
            for (int k = 0; k < 2; k++) {
                const struct solid_body b = body(laws[l], planes[k]);
                assert_tensor(1e-13, tensor2_mul(Q, pk1(&b, U)), pk1(&b, turned), "P(QF) = Q P(F)");
                assert_tensor(1e-14, (struct tensor2){0, 0, 0, 0},
                              pk1(&b, (struct tensor2){Q.xx - 1, Q.xy, Q.yx, Q.yy - 1}),
                              "P(Q) = 0");
            }
        }
    }
}

/* P F^T = J sigma is symmetric: no torque. */
static void test_kirchhoff_stress_is_symmetric(void)
{
    uint64_t seed = 3;
    for (int turn = 0; turn < 50; turn++) {
        const struct tensor2 U = draw(&seed, 0.3), F = {1 + U.xx, U.xy, U.yx, 1 + U.yy};
        for (int l = 0; l < 3; l++) {
            for (int k = 0; k < 2; k++) {
                const struct solid_body b = body(laws[l], planes[k]);
                const struct tensor2 PF = tensor2_mul_t(pk1(&b, U), F);
                assert_near(1e-13, PF.xy, PF.yx, "P F^T");
            }
        }
    }
}

static double energy(const struct solid_body *b, struct tensor2 U)
{
    return material_energy(b, spread(U))[0];
}

/* P = dW/dF, central differences of step 1e-5: error of the order of its square times the moduli.
 */
static void test_stress_is_the_slope_of_the_energy(void)
{
    uint64_t seed = 4;
    const double e = 1e-5;
    for (int turn = 0; turn < 20; turn++) {
        const struct tensor2 U = draw(&seed, 0.25);
        for (int l = 1; l < 3; l++) {
            for (int k = 0; k < 2; k++) {
                const struct solid_body b = body(laws[l], planes[k]);
                const struct tensor2 P = pk1(&b, U);
                const double expected[4] = {P.xx, P.xy, P.yx, P.yy};
                for (int c = 0; c < 4; c++) {
                    double up[4] = {U.xx, U.xy, U.yx, U.yy}, down[4] = {U.xx, U.xy, U.yx, U.yy};
                    up[c] += e;
                    down[c] -= e;
                    const struct tensor2 a = {up[0], up[1], up[2], up[3]};
                    const struct tensor2 z = {down[0], down[1], down[2], down[3]};
                    assert_near(1e-8, (energy(&b, a) - energy(&b, z)) / (2 * e), expected[c],
                                "dW/dF");
                }
            }
        }
    }
}

/* Energies vanish at rest, agree for small strains with (lambda/2) tr^2 + mu eps:eps to the next
 * order, and are positive: the paper's law as well. */
static void test_energy_of_small_strains(void)
{
    uint64_t seed = 5;
    const double e = 1e-8;
    for (int turn = 0; turn < 20; turn++) {
        const struct tensor2 U = draw(&seed, e);
        for (int l = 0; l < 3; l++) {
            for (int k = 0; k < 2; k++) {
                const struct solid_body b = body(laws[l], planes[k]);
                const double lambda = planes[k] == PLANE_STRESS ? 5.2 * 0.3 / 0.91 : 3;
                const double shear = 0.5 * (U.xy + U.yx);
                const double W = 0.5 * lambda * square(U.xx + U.yy) +
                                 2 * (square(U.xx) + square(U.yy) + 2 * square(shear));
                assert_near(100 * e * e * e, W, energy(&b, U), "W");
                TEST_ASSERT_TRUE(energy(&b, (struct tensor2){0, 0, 0, 0}) == 0);
            }
        }
    }
}

/* Plane stress: the thickness t that is reported leaves no stress across in the three-dimensional
 * law. paper: eps_zz = (1 - 1/t^2)/2, lambda (tr eps + eps_zz) + 2 mu eps_zz = 0 svk:   E_zz = (t^2
 * - 1)/2,     lambda (tr E + E_zz) + 2 mu E_zz = 0 neo-Hookean: mu (t^2 - 1) + lambda/2 ((J t)^2 -
 * 1) = 0 */
static void test_plane_stress_has_none_across(void)
{
    uint64_t seed = 6;
    for (int turn = 0; turn < 50; turn++) {
        const struct tensor2 U = draw(&seed, 0.2), F = {1 + U.xx, U.xy, U.yx, 1 + U.yy};
        const double J = tensor2_det(F),
                     C = square(F.xx) + square(F.xy) + square(F.yx) + square(F.yy);
        const double trace_E = 0.5 * C - 1;
        /* tr(F^-T F^-1) = C/J^2, eps = (I - F^-T F^-1)/2 */
        const double trace_eps = 1 - 0.5 * C / (J * J);
        for (int l = 0; l < 3; l++) {
            const struct solid_body b = body(laws[l], PLANE_STRESS);
            double t, sigma_zz;
            material_across(&b, spread(U), &t, &sigma_zz);
            const double zz = laws[l] == LAW_PAPER ? 0.5 * (1 - 1 / (t * t)) : 0.5 * (t * t - 1);
            const double across = laws[l] == LAW_PAPER ? 3 * (trace_eps + zz) + 4 * zz
                                  : laws[l] == LAW_SVK ? 3 * (trace_E + zz) + 4 * zz
                                                       : 4 * zz + 1.5 * (square(J * t) - 1);
            TEST_ASSERT_TRUE(sigma_zz == 0);
            assert_near(1e-13, 0, across, "stress across");
        }
    }
}

/* Plane strain: sigma_zz by hand for F = diag(1.1, 1): 3 * 0.105/1.1, 3 * 0.0867768595,
 * 1.5 * 0.21/1.1; the thickness stays. */
static void test_plane_strain_across(void)
{
    const struct tensor2 U = {0.1, 0, 0, 0};
    const double expected[] = {1.5 * (1 - 1 / 1.21), 0.315 / 1.1, 0.315 / 1.1};
    for (int l = 0; l < 3; l++) {
        const struct solid_body b = body(laws[l], PLANE_STRAIN);
        double t, sigma_zz;
        material_across(&b, spread(U), &t, &sigma_zz);
        TEST_ASSERT_TRUE(t == 1);
        assert_near(1e-15, expected[l], sigma_zz, "sigma_zz");
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_stretch_by_hand);
    RUN_TEST(test_shear_by_hand);
    RUN_TEST(test_small_strains_are_linear);
    RUN_TEST(test_rotations_do_not_strain);
    RUN_TEST(test_kirchhoff_stress_is_symmetric);
    RUN_TEST(test_stress_is_the_slope_of_the_energy);
    RUN_TEST(test_energy_of_small_strains);
    RUN_TEST(test_plane_stress_has_none_across);
    RUN_TEST(test_plane_strain_across);
    return UNITY_END();
}
