/* SPDX-License-Identifier: MIT
 * The kernel: normalised, of compact support, and its slope is its derivative. */
#include "particles/kernel.h"

#include "rig.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

/* Integral of 2 pi r W over [0, 2h] by Simpson's rule: the integrand is a polynomial of degree 6,
 * so 200 intervals leave an error below 1e-8. */
static double integral(double h)
{
    enum { N = 200 };
    const double step = 2 * h / N;
    double sum = 0;
    for (int k = 0; k <= N; k++) {
        const double r = k * step, weight = k == 0 || k == N ? 1 : k % 2 ? 4 : 2;
        sum += weight * 2 * PI * r * kernel_w(r, h);
    }
    return sum * step / 3;
}

static void test_integral_is_one(void)
{
    assert_near(1e-8, 1, integral(1), "h = 1");
    assert_near(1e-8, 1, integral(0.0135), "h = 0.0135");
    assert_near(1e-8, 1, integral(250), "h = 250");
}

/* W(0) = 7/(4 pi h^2) = 0.557042300821634/h^2; W(h) = 3/16 of it. */
static void test_values(void)
{
    assert_near(1e-15, 0.557042300821634, kernel_w(0, 1), "W(0)");
    assert_near(1e-15, 0.557042300821634 * 3 / 16, kernel_w(1, 1), "W(h)");
    assert_near(1e-15, 0.557042300821634 / 4, kernel_w(0, 2), "W(0) for h = 2");
    /* dW/dr at r = h: 5 * 7/(4 pi) * (1/2)^3 = 0.348151438013521 downwards. */
    assert_near(1e-15, -0.348151438013521, kernel_slope(1, 1), "slope at h");
}

static void test_support_ends_at_two_h(void)
{
    TEST_ASSERT_TRUE(kernel_w(1.999, 1) > 0);
    TEST_ASSERT_TRUE(kernel_slope(1.999, 1) < 0);
    for (double r = 2; r < 100; r *= 1.5) {
        TEST_ASSERT_TRUE(kernel_w(r, 1) == 0);
        TEST_ASSERT_TRUE(kernel_slope(r, 1) == 0);
    }
}

/* slope(r) r = dW/dr: a central difference of step e is off by e^2 W'''/6 < 4 e^2/h^5 and by the
 * round-off eps W(0)/e. */
static void test_slope_is_the_derivative(void)
{
    const double h = 0.8, e = 1e-5;
    for (double r = 0.01; r < 2 * h; r += 0.037) {
        const double difference = (kernel_w(r + e, h) - kernel_w(r - e, h)) / (2 * e);
        assert_near(1e-8, difference, kernel_slope(r, h) * r, "dW/dr");
    }
}

static void test_falls_monotonically(void)
{
    for (double r = 0; r < 2; r += 0.01) TEST_ASSERT_TRUE(kernel_w(r + 0.01, 1) <= kernel_w(r, 1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_integral_is_one);
    RUN_TEST(test_values);
    RUN_TEST(test_support_ends_at_two_h);
    RUN_TEST(test_slope_is_the_derivative);
    RUN_TEST(test_falls_monotonically);
    return UNITY_END();
}
