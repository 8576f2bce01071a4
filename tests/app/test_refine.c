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
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_first_order);
    RUN_TEST(test_an_order_above_two_is_not_believed);
    RUN_TEST(test_no_order_where_values_go_to_and_fro);
    RUN_TEST(test_no_order_where_differences_hardly_shrink);
    RUN_TEST(test_three_equal_values_have_no_band);
    RUN_TEST(test_values_that_are_not_finite);
    return UNITY_END();
}
