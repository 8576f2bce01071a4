/* SPDX-License-Identifier: MIT
 * Elementary functions: rounded correctly where long double can tell, and the same bits everywhere.
 */
#include "base/elementary.h"
#include "base/hash.h"
#include "base/base.h"
#include "unity.h"

#include <float.h>
#include <math.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

/* Error in units of the last place of the true value. */
static double error_of(double value, long double truth)
{
    const double size = fabs((double)truth);
    return (double)fabsl((long double)value - truth) / (nextafter(size, (double)INFINITY) - size);
}

/* A point of (low, high) that a generator of Lehmer gives. */
static double point(double low, double high)
{
    static uint64_t seed = 1;
    seed = seed * 48271 % 2147483647;
    return low + (high - low) * (double)seed / 2147483647;
}

enum { POINTS = 3000 };

/* The long double of most machines has 64 bits, which makes 1 in 2048 of a unit. */
static const double half = 0.5 + 1.0 / 512;

#define NEAR(name, reference, low, high)                                                      \
    for (int k = 0; k < POINTS; k++) {                                                        \
        const double x = point(low, high);                                                    \
        TEST_ASSERT_TRUE_MESSAGE(error_of(name(x), reference((long double)x)) < half, #name); \
    }
#define NEAR_2(name, reference, low_x, high_x, low_y, high_y)                \
    for (int k = 0; k < POINTS; k++) {                                       \
        const double x = point(low_x, high_x), y = point(low_y, high_y);     \
        const long double truth = reference((long double)x, (long double)y); \
        TEST_ASSERT_TRUE_MESSAGE(error_of(name(x, y), truth) < half, #name); \
    }

static void rounded_to_the_nearest(void)
{
    if (LDBL_MANT_DIG < 64) TEST_IGNORE_MESSAGE("long double is double here");
    NEAR(elementary_sin, sinl, -30, 30)
    NEAR(elementary_sin, sinl, -1e9, 1e9)
    NEAR(elementary_cos, cosl, -30, 30)
    NEAR(elementary_tan, tanl, -30, 30)
    NEAR(elementary_exp, expl, -700, 700)
    NEAR(elementary_exp, expl, -1e-3, 1e-3)
    NEAR(elementary_log, logl, 1e-9, 3)
    NEAR(elementary_log, logl, 1, 1e12)
    NEAR(elementary_sinh, sinhl, -1, 1)
    NEAR(elementary_sinh, sinhl, -60, 60)
    NEAR(elementary_cosh, coshl, -60, 60)
    NEAR(elementary_tanh, tanhl, -2, 2)
    NEAR_2(elementary_pow, powl, 1e-3, 50, -20, 20)
    NEAR_2(elementary_atan2, atan2l, -2, 2, -2, 2)
    NEAR_2(elementary_hypot, hypotl, -2, 2, -2, 2)
}

static void exact_and_special_values(void)
{
    const double inf = (double)INFINITY;
    TEST_ASSERT_TRUE(elementary_pow(10, -3) == 1e-3 && elementary_pow(0.001, 2) == 1e-6);
    TEST_ASSERT_TRUE(elementary_pow(-2, 3) == -8 && elementary_pow(-2, -2) == 0.25);
    TEST_ASSERT_TRUE(isnan(elementary_pow(-2, 0.5)) && elementary_pow(0, 2) == 0);
    TEST_ASSERT_TRUE(elementary_pow(3, 0) == 1 && elementary_pow(0, -1) == inf);
    TEST_ASSERT_TRUE(elementary_exp(0) == 1 && elementary_exp(-1000) == 0);
    TEST_ASSERT_TRUE(elementary_exp(1000) == inf && elementary_exp(-inf) == 0);
    TEST_ASSERT_TRUE(elementary_log(1) == 0 && elementary_log(0) == -inf);
    TEST_ASSERT_TRUE(isnan(elementary_log(-1)) && elementary_log(inf) == inf);
    TEST_ASSERT_TRUE(elementary_sin(0) == 0 && signbit(elementary_sin(-0.0)));
    TEST_ASSERT_TRUE(elementary_cos(0) == 1 && isnan(elementary_sin(inf)));
    TEST_ASSERT_TRUE(elementary_tanh(1000) == 1 && elementary_tanh(-1000) == -1);
    TEST_ASSERT_TRUE(elementary_sinh(0) == 0 && elementary_cosh(0) == 1);
    TEST_ASSERT_TRUE(isnan(elementary_sinh((double)NAN)) && elementary_cosh(-inf) == inf);
    TEST_ASSERT_TRUE(elementary_hypot(3, -4) == 5 && elementary_hypot(0, 0) == 0);
    TEST_ASSERT_TRUE(fabs(elementary_hypot(3e200, 4e200) / 5e200 - 1) < 1e-15 &&
                     elementary_hypot(inf, 1) == inf);
    TEST_ASSERT_TRUE(elementary_atan2(1, 1) == atan2(1, 1) &&
                     elementary_atan2(0, -1) == atan2(0, -1));
    TEST_ASSERT_TRUE(elementary_atan2(-1, -1) == atan2(-1, -1));
    TEST_ASSERT_TRUE(elementary_tan(0) == 0 && signbit(elementary_tan(-0.0)));
    TEST_ASSERT_TRUE(elementary_tan(1e300) == tan(1e300) && isnan(elementary_tan(inf)));
    TEST_ASSERT_TRUE(elementary_tanh(0) == 0 && signbit(elementary_tanh(-0.0)));
    TEST_ASSERT_TRUE(isnan(elementary_tanh((double)NAN)) && isnan(elementary_cosh((double)NAN)));
    TEST_ASSERT_TRUE(elementary_pow(inf, 2) == inf && elementary_pow(inf, -1) == 0);
    TEST_ASSERT_TRUE(elementary_pow(2, inf) == inf && elementary_pow(0.5, inf) == 0);
    TEST_ASSERT_TRUE(elementary_atan2(inf, 1) == atan2(inf, 1) && elementary_atan2(1, inf) == 0 &&
                     elementary_atan2(1, 0) == atan2(1, 0));
    TEST_ASSERT_TRUE(elementary_hypot(1, -inf) == inf && isnan(elementary_hypot((double)NAN, 1)));
}

/* Found once; equal with glibc, musl, gcc, clang and in WebAssembly. */
static void the_same_bits_everywhere(void)
{
    uint64_t h = HASH_START;
    for (int k = 0; k < 2000; k++) {
        const double x = 0.0137 * k - 9.1, y = 0.05 * k + 0.3;
        const double value[] = {elementary_sin(x),      elementary_cos(x),
                                elementary_tan(x),      elementary_sinh(x),
                                elementary_cosh(x),     elementary_tanh(x),
                                elementary_exp(x),      elementary_log(y),
                                elementary_pow(y, 1.7), elementary_atan2(x, y),
                                elementary_hypot(x, y)};
        h = hash_bytes(h, value, sizeof value);
    }
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xf2f9897e92b0c9f2), h);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(rounded_to_the_nearest);
    RUN_TEST(exact_and_special_values);
    RUN_TEST(the_same_bits_everywhere);
    return UNITY_END();
}
