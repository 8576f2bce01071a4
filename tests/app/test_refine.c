/* SPDX-License-Identifier: MIT
 * Order, extrapolation and band of three resolutions, on values whose law is known. */
#include "app/refine.h"

#include <math.h>

#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

/* f(h) = exact + a h^p at h = 1, r, r^2. */
static struct convergence of_law(double exact, double a, double p, double r)
{
    return converge((const double[]){exact + a, exact + a * pow(r, p), exact + a * pow(r, 2 * p)},
                    r);
}

static void test_first_order(void)
{
    const struct convergence c = of_law(7, -0.25, 1, 1.5);
    TEST_ASSERT_TRUE(c.ordered);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1, c.order);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 7, c.extrapolated);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.25 * 0.25, c.band);
}

static void test_an_order_above_two_is_not_believed(void)
{
    const struct convergence c = of_law(7, 0.1, 3, 2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3, c.order);
    /* The difference of the finest two, 0.7, over 2^2 - 1. */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.25 * 0.7 / 3, c.band);
}

static void test_no_order_where_values_go_to_and_fro(void)
{
    const struct convergence c = converge((const double[]){1, 3, 2}, 2);
    TEST_ASSERT_FALSE(c.ordered);
    TEST_ASSERT_EQUAL_DOUBLE(6, c.band);
    TEST_ASSERT_EQUAL_DOUBLE(1, c.extrapolated);
}

static void test_no_order_where_differences_hardly_shrink(void)
{
    const struct convergence c = of_law(0, 1, 0.3, 2);
    TEST_ASSERT_FALSE(c.ordered);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3 * (pow(2, 0.6) - 1), c.band);
}

/* Energies dissipated in the template dam_break: all positive, but a limit of their trend is negative. */
static void test_a_band_above_the_value_is_no_result(void)
{
    const struct convergence c = converge((const double[]){14, 30.415, 65.021}, 2);
    TEST_ASSERT_TRUE(c.ordered && c.extrapolated < 0);
    TEST_ASSERT_FALSE(c.resolved);
    TEST_ASSERT_FALSE(converge((const double[]){1, 3, 2}, 2).resolved);
    TEST_ASSERT_FALSE(converge((const double[]){0, 1, 2}, 2).resolved);
    TEST_ASSERT_TRUE(converge((const double[]){7, 6, 6.5}, 2).resolved);
    TEST_ASSERT_TRUE(converge((const double[]){0, 0, 0}, 2).resolved);
}

/* Wherever three values of one sign have a limit of the other, the band is above 100 %. */
static void test_no_result_has_another_sign_than_its_values(void)
{
    uint32_t random = 1;
    int turned = 0;
    for (int k = 0; k < 20000; k++) {
        double value[3];
        for (int i = 0; i < 3; i++) {
            random = random * 1664525u + 1013904223u;
            value[i] = (double)(random >> 8) + 1;
        }
        const struct convergence c = converge(value, 1.1 + (k % 30) * 0.1);
        turned += c.extrapolated < 0;
        TEST_ASSERT_FALSE(c.resolved && c.extrapolated < 0);
    }
    TEST_ASSERT_GREATER_THAN(100, turned);
}

static void test_three_equal_values_have_no_band(void)
{
    const struct convergence c = converge((const double[]){5, 5, 5}, 2);
    TEST_ASSERT_FALSE(c.ordered);
    TEST_ASSERT_EQUAL_DOUBLE(0, c.band);
}

static void test_values_that_are_not_finite(void)
{
    for (int k = 0; k < 3; k++) {
        double value[3] = {5, 5.1, 5.3};
        value[k] = k == 1 ? INFINITY : NAN;
        const struct convergence c = converge(value, 2);
        TEST_ASSERT_FALSE(c.ordered);
        TEST_ASSERT_EQUAL_STRING("not finite", c.why);
        TEST_ASSERT_TRUE(isnan(c.band));
        TEST_ASSERT_FALSE(c.resolved);
    }
}

enum { ROWS = 400 };

/* A swing, a phase error of order p, and noise in each run. */
static bool swing_agrees(double error, double p, double noise)
{
    static double run[3][ROWS];
    uint32_t random = 1;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < ROWS; i++) {
            random = random * 1664525u + 1013904223u;
            const double late = error * pow(2, p * k), t = 0.05 * i;
            run[k][i] = sin(t * (1 - late)) + late + noise * ((double)random / 4294967296.0 - 0.5);
        }
    return errors_agree(run[0], run[1], run[2], ROWS);
}

static void test_noise_has_no_order(void)
{
    TEST_ASSERT_TRUE(swing_agrees(0.001, 2, 0));
    TEST_ASSERT_TRUE(swing_agrees(0.002, 1, 0.002));
    TEST_ASSERT_FALSE(swing_agrees(0, 1, 0.01));
    TEST_ASSERT_FALSE(swing_agrees(0.001, 1, 0.1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_first_order);
    RUN_TEST(test_an_order_above_two_is_not_believed);
    RUN_TEST(test_no_order_where_values_go_to_and_fro);
    RUN_TEST(test_no_order_where_differences_hardly_shrink);
    RUN_TEST(test_a_band_above_the_value_is_no_result);
    RUN_TEST(test_no_result_has_another_sign_than_its_values);
    RUN_TEST(test_three_equal_values_have_no_band);
    RUN_TEST(test_values_that_are_not_finite);
    RUN_TEST(test_noise_has_no_order);
    return UNITY_END();
}
