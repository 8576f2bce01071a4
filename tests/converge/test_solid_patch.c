/* SPDX-License-Identifier: MIT
 * Patch tests of the deformation gradient and of the discrete divergence of the stress, and their
 * orders of accuracy on smooth fields. */
#include "rig.h"
#include "unity.h"

#include <math.h>

#define MATERIAL "dp = 1 cm\nend_time = 1\n[solid b]\ndensity = 1000\nyoung = 1e6\npoisson = 0.25\n"

/* A bar with a notch, a disc with its ragged edge, and a foil of two particles. */
static const char *const bodies[] = {
    MATERIAL "shape = box 0, 0, 0.2, 0.08\nminus = box 0.08, 0.05, 0.12, 0.08\n",
    MATERIAL "shape = circle 0.1, 0.1, 0.071\n",
    MATERIAL "shape = box 0, 0, 0.2, 0.02\n",
};

static struct rig rig;
static struct particles *p;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

static void open(const char *text, const char *gradient, const char *set)
{
    rig_open(&rig, text, "precision=double", gradient, set, NULL);
    p = &rig.sim.particles[KIND_SOLID];
}

/* Unlike fmax it does not pass over a NaN. */
static double larger(double a, double b) { return a > b ? a : isnan(a) ? a : b; }

/* Largest difference of a component of the displacement gradient from U. */
static double off(int64_t i, double xx, double xy, double yx, double yy)
{
    return larger(larger(fabs(p->Uxx[i] - xx), fabs(p->Uxy[i] - xy)),
                  larger(fabs(p->Uyx[i] - yx), fabs(p->Uyy[i] - yy)));
}

/* A linear field is exact everywhere, surfaces and corners included, for both gradients. Values up
 * to 0.4 m with 3e-17 of round-off over distances of 1 cm and 20 terms: 1e-13. */
static void test_linear_fields_are_exact(void)
{
    double top = 0;
    for (int k = 0; k < 6; k++) {
        open(bodies[k % 3], k / 3 ? "b.gradient=quadratic" : "b.gradient=linear", "dp=1 cm");
        for (int64_t i = 0; i < p->n; i++) {
            p->ux[i] = 0.3 + 0.2 * p->X[i] - 0.5 * p->Y[i];
            p->uy[i] = -0.1 + 0.4 * p->X[i] + 0.1 * p->Y[i];
        }
        solid_stress(&rig.sim.solid, p);
        for (int64_t i = 0; i < p->n; i++) top = larger(top, off(i, 0.2, -0.5, 0.4, 0.1));
    }
    printf("linear field: largest error of the gradient %.3g\n",
           top); /* the validation reads this */
    assert_at_most(1e-13, top, "error of U");
}

/* A quadratic field is exact everywhere with the quadratic gradient, where there are three
 * particles across; with the linear one it is off at surfaces by the order of h u'' = 0.01 to 0.1.
 */
static void test_quadratic_fields_are_exact_with_the_quadratic_gradient(void)
{
    for (int k = 0; k < 4; k++) {
        const bool quadratic = k / 2;
        open(bodies[k % 2], quadratic ? "b.gradient=quadratic" : "b.gradient=linear", "dp=1 cm");
        for (int64_t i = 0; i < p->n; i++) {
            const double X = p->X[i], Y = p->Y[i];
            p->ux[i] = 2 * X * X - 3 * X * Y + Y * Y + 0.1 * X;
            p->uy[i] = -X * X + 2 * X * Y + 4 * Y * Y - 0.2 * Y;
        }
        solid_stress(&rig.sim.solid, p);
        double top = 0;
        for (int64_t i = 0; i < p->n; i++) {
            const double X = p->X[i], Y = p->Y[i];
            top = larger(top, off(i, 4 * X - 3 * Y + 0.1, -3 * X + 2 * Y, -2 * X + 2 * Y,
                                  2 * X + 8 * Y - 0.2));
        }
        assert_at_most(quadratic ? 1e-12 : 0.3, top, "error of U");
        TEST_ASSERT_TRUE(quadratic || top > 1e-3);
    }
}

/* Largest error of U for a smooth field, waves of 10 X and 12 Y. */
static double error_of_smooth_field(const char *gradient, const char *dp)
{
    open(bodies[0], gradient, dp);
    for (int64_t i = 0; i < p->n; i++) {
        p->ux[i] = 0.01 * sin(10 * p->X[i]) * cos(12 * p->Y[i]);
        p->uy[i] = 0.01 * cos(10 * p->X[i] + 12 * p->Y[i]);
    }
    solid_stress(&rig.sim.solid, p);
    double top = 0;
    for (int64_t i = 0; i < p->n; i++) {
        const double x = 10 * p->X[i], y = 12 * p->Y[i];
        top = larger(top, off(i, 0.1 * cos(x) * cos(y), -0.12 * sin(x) * sin(y), -0.1 * sin(x + y),
                              -0.12 * sin(x + y)));
    }
    return top;
}

/* At surfaces the linear gradient is of first order, the quadratic one of second: errors fall by 2
 * and by 4 as dp is halved, within a quarter for the next order. */
static void test_orders_of_accuracy(void)
{
    const char *const gradients[] = {"b.gradient=linear", "b.gradient=quadratic"};
    for (int k = 0; k < 2; k++) {
        const double coarse = error_of_smooth_field(gradients[k], "dp=5 mm");
        const double fine = error_of_smooth_field(gradients[k], "dp=2.5 mm");
        const double order = k ? 4 : 2;
        assert_near(0.25 * order, order, coarse / fine, gradients[k]);
    }
}

/* Inside the body (three supports from the surface, the reach of a variational hourglass force) a
 * quadratic displacement of 1e-6 has the exact acceleration of linear elasticity; the hourglass
 * force leaves quadratic fields alone, since (F_a + F_b) X_ab/2 is exact for them. Relative error:
 * that of the strain's square, some 1e-6, and round-off 1e-16/1e-6. */
static void test_divergence_of_the_stress(void)
{
    /* nu = 0.25: lambda = mu = 0.4 E */
    const double mu = 4e5, e = 1e-6;
    const char *const forms[] = {"b.hourglass_form=printed", "b.hourglass_form=variational"};
    for (int k = 0; k < 4; k++) {
        open(MATERIAL "shape = box 0, 0, 0.3, 0.3\n",
             k / 2 ? "b.gradient=quadratic" : "b.gradient=linear", forms[k % 2]);
        for (int64_t i = 0; i < p->n; i++) {
            const double X = p->X[i] - 0.15, Y = p->Y[i] - 0.15;
            p->ux[i] = e * (2 * X * X - 3 * X * Y + Y * Y);
            p->uy[i] = e * (-X * X + 2 * X * Y + 4 * Y * Y);
            p->vx[i] = p->vy[i] = 0;
        }
        solid_stress(&rig.sim.solid, p);
        solid_forces(&rig.sim.solid, p);
        /* div sigma = (lambda + 2 mu) u_x,xx + mu u_x,yy + (lambda + mu) u_y,xy and likewise in y,
         * with u_x,xx = 4e, u_x,yy = 2e, u_x,xy = -3e, u_y,xx = -2e, u_y,yy = 8e, u_y,xy = 2e. */
        const double ax = mu / 1000 * e * (3 * 4 + 2 + 2 * 2);
        const double ay = mu / 1000 * e * (3 * 8 - 2 + 2 * -3);
        int64_t inside = 0;
        for (int64_t i = 0; i < p->n; i++) {
            if (fmax(fabs(p->X[i] - 0.15), fabs(p->Y[i] - 0.15)) > 0.15 - 6 * 0.0135) continue;
            assert_near(1e-5 * ax, ax, p->sx[i], "div P/rho, x");
            assert_near(1e-5 * ay, ay, p->sy[i], "div P/rho, y");
            inside++;
        }
        TEST_ASSERT_TRUE(inside > 50);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_linear_fields_are_exact);
    RUN_TEST(test_quadratic_fields_are_exact_with_the_quadratic_gradient);
    RUN_TEST(test_orders_of_accuracy);
    RUN_TEST(test_divergence_of_the_stress);
    return UNITY_END();
}
