/* SPDX-License-Identifier: MIT
 * Every verb of the lanes against one lane at a time in plain C, to the bit. */
#include "base/simd.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What makes lanes differ: signs, zeros, infinities, tiny and huge, and plain numbers. */
static const double values[] = {0.0,      -0.0,      1.0,   -1.0,  0.1,       3.0e-5,
                                -7.25,    1e20,      -1e20, 1e-30, 0x1p-1022, 1.0 / 3,
                                INFINITY, -INFINITY, 2.5,   -1e-3};
enum { N = COUNT_OF(values) };

static double at(int k) { return values[(unsigned)k % N]; }

static bool same_double(double a, double b)
{
    return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

static bool same_float(float a, float b)
{
    return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

void setUp(void) {}
void tearDown(void) {}

/* Lane l of three operands: all pairs meet as `turn` goes round. */
#define OPERANDS(type, lanes)              \
    type a[lanes], b[lanes], c[lanes];     \
    for (int l = 0; l < (lanes); l++) {    \
        a[l] = (type)at(turn + l);         \
        b[l] = (type)at(turn / N + 3 * l); \
        c[l] = (type)at(turn / 5 + 7 * l); \
    }

#define CHECK_LANES(type, lanes, store, same, verb, expected)                                   \
    do {                                                                                        \
        type out_[lanes];                                                                       \
        store(out_, verb);                                                                      \
        for (int l = 0; l < (lanes); l++) {                                                     \
            char text_[128];                                                                    \
            snprintf(text_, sizeof text_, "%s lane %d of (%g, %g, %g)", #verb, l, (double)a[l], \
                     (double)b[l], (double)c[l]);                                               \
            TEST_ASSERT_TRUE_MESSAGE(same((expected), out_[l]), text_);                         \
        }                                                                                       \
    } while (0)

static void test_float_verbs(void)
{
    for (int turn = 0; turn < N * N; turn++) {
        OPERANDS(float, LANES_FLOAT)
        const vfloat A = vload_float(a), B = vload_float(b), C = vload_float(c);
#define CHECK(verb, expected) \
    CHECK_LANES(float, LANES_FLOAT, vstore_float, same_float, verb, expected)
        CHECK(A, a[l]);
        CHECK(A + B, a[l] + b[l]);
        CHECK(A / B, a[l] / b[l]);
        CHECK(vset_float(a[0]), a[0] + 0.0f);
        CHECK(vfma_float(A, B, C), fmaf(a[l], b[l], c[l]));
        CHECK(vmin_float(A, B), a[l] < b[l] ? a[l] : b[l]);
        CHECK(vmax_float(A, B), a[l] > b[l] ? a[l] : b[l]);
        CHECK(vabs_float(A), fabsf(a[l]));
        CHECK(vsqrt_float(A), sqrtf(a[l]));
#undef CHECK
    }
}

static void test_double_verbs(void)
{
    for (int turn = 0; turn < N * N; turn++) {
        OPERANDS(double, LANES_DOUBLE)
        const vdouble A = vload_double(a), B = vload_double(b), C = vload_double(c);
#define CHECK(verb, expected) \
    CHECK_LANES(double, LANES_DOUBLE, vstore_double, same_double, verb, expected)
        CHECK(A, a[l]);
        CHECK(A - B, a[l] - b[l]);
        CHECK(A * B, a[l] * b[l]);
        CHECK(A / B, a[l] / b[l]);
        CHECK(vset_double(a[0]), a[0] + 0.0);
        CHECK(vfma_double(A, B, C), fma(a[l], b[l], c[l]));
        CHECK(vmin_double(A, B), a[l] < b[l] ? a[l] : b[l]);
        CHECK(vmax_double(A, B), a[l] > b[l] ? a[l] : b[l]);
        CHECK(vabs_double(A), fabs(a[l]));
        CHECK(vsqrt_double(A), sqrt(a[l]));
#undef CHECK
    }
}

/* vmin and vmax give the second operand where the comparison fails: for NaN and for equal zeros. */
static void test_min_and_max_of_nan_and_zeros(void)
{
    const float nf = NAN;
    const double nd = (double)NAN;
    TEST_ASSERT_TRUE(vmin_float(vset_float(nf), vset_float(2))[0] == 2.0f);
    TEST_ASSERT_TRUE(isnan(vmin_float(vset_float(2), vset_float(nf))[0]));
    TEST_ASSERT_TRUE(vmax_float(vset_float(nf), vset_float(2))[0] == 2.0f);
    TEST_ASSERT_TRUE(isnan(vmax_float(vset_float(2), vset_float(nf))[0]));
    TEST_ASSERT_TRUE(vmin_double(vset_double(nd), vset_double(2))[0] == 2);
    TEST_ASSERT_TRUE(isnan(vmin_double(vset_double(2), vset_double(nd))[0]));
    TEST_ASSERT_TRUE(vmax_double(vset_double(nd), vset_double(2))[0] == 2);
    TEST_ASSERT_TRUE(isnan(vmax_double(vset_double(2), vset_double(nd))[0]));
    const vfloat minus = -vset_float(0);
    TEST_ASSERT_TRUE(signbit(vmin_float(vset_float(0), minus)[0]));
    TEST_ASSERT_FALSE(signbit(vmin_float(minus, vset_float(0))[0]));
}

/* fma rounds once: (1 + 2^-27)^2 - 1 keeps its last term in double, (1 + 2^-13)^2 - 1 in float. */
static void test_fma_rounds_once(void)
{
    const double d = 1 + 0x1p-27;
    TEST_ASSERT_TRUE(vfma_double(vset_double(d), vset_double(d), vset_double(-1))[0] ==
                     0x1p-26 + 0x1p-54);
    TEST_ASSERT_TRUE(vfma_double(vset_double(d), vset_double(d), vset_double(-1))[0] ==
                     0x1p-26 + 0x1p-54);
    const float f = 1 + 0x1p-13f;
    TEST_ASSERT_TRUE(vfma_float(vset_float(f), vset_float(f), vset_float(-1))[0] ==
                     0x1p-12f + 0x1p-26f);
}

static void test_top_finds_the_largest_wherever_it_is(void)
{
    for (int where = 0; where < LANES_FLOAT; where++) {
        vfloat a = vset_float(-2);
        a[where] = -1;
        TEST_ASSERT_TRUE(vtop_float(a) == -1.0f);
    }
    for (int where = 0; where < LANES_DOUBLE; where++) {
        vdouble a = vset_double(-2);
        a[where] = -1;
        TEST_ASSERT_TRUE(vtop_double(a) == -1);
    }
}

static void test_loads_and_stores_at_any_address(void)
{
    double d[3 * LANES_DOUBLE + 1] = {0};
    float f[3 * LANES_FLOAT + 1] = {0};
    for (int shift = 0; shift <= LANES_DOUBLE; shift++) {
        vstore_double(d + shift, vset_double(shift + 1));
        TEST_ASSERT_TRUE(vload_double(d + shift)[LANES_DOUBLE - 1] == shift + 1);
        TEST_ASSERT_TRUE(d[shift + LANES_DOUBLE] == 0);
    }
    for (int shift = 0; shift <= LANES_FLOAT; shift++) {
        vstore_float(f + shift, vset_float((float)shift + 1));
        TEST_ASSERT_TRUE(vload_float(f + shift)[LANES_FLOAT - 1] == (float)shift + 1);
        TEST_ASSERT_TRUE(f[shift + LANES_FLOAT] == 0);
    }
}

/* The sum is by halving, whatever the machine: lane k meets lane k + n/2. */
static void test_sum_follows_the_tree(void)
{
    uint32_t seed = 1;
    for (int turn = 0; turn < 200; turn++) {
        double d[LANES_DOUBLE], tree[LANES_DOUBLE];
        for (int l = 0; l < LANES_DOUBLE; l++) {
            seed = seed * 1664525u + 1013904223u;
            tree[l] = d[l] = ldexp((double)(int32_t)seed, -(int)(seed >> 28)) / 3;
        }
        for (int half = LANES_DOUBLE / 2; half; half /= 2)
            for (int l = 0; l < half; l++) tree[l] += tree[l + half];
        TEST_ASSERT_TRUE(tree[0] == vsum_double(vload_double(d)));
    }
}

/* Four items in each group, an item for each group, and the groups' sums: the same as lane by lane.
 */
static void test_groups(void)
{
    float f[2 * LANES_FLOAT], sum_f[GROUPS_FLOAT];
    double d[2 * LANES_DOUBLE + GROUP], sum_d[GROUPS_DOUBLE];
    for (int k = 0; k < 2 * LANES_FLOAT; k++) f[k] = 1 / (float)(k + 3);
    for (int k = 0; k < 2 * LANES_DOUBLE + GROUP; k++) d[k] = 1 / (double)(k + 3);
    const vfloat four_f = vfour_float(f + 1), spread_f = vspread_float(f + 2);
    for (int l = 0; l < LANES_FLOAT; l++) {
        TEST_ASSERT_TRUE(four_f[l] == f[1 + l % GROUP]);
        TEST_ASSERT_TRUE(spread_f[l] == f[2 + l / GROUP]);
    }
    const vdouble four_d = vfour_double(d + 1), spread_d = vspread_double(d + 2);
    for (int l = 0; l < LANES_DOUBLE; l++) {
        TEST_ASSERT_TRUE(four_d[l] == d[1 + l % GROUP]);
        TEST_ASSERT_TRUE(spread_d[l] == d[2 + l / GROUP]);
    }
    vsum_four_float(vload_float(f), sum_f);
    for (int g = 0; g < GROUPS_FLOAT; g++)
        TEST_ASSERT_TRUE(sum_f[g] == (f[4 * g] + f[4 * g + 2]) + (f[4 * g + 1] + f[4 * g + 3]));
    vsum_four_double(vload_double(d), sum_d);
    for (int g = 0; g < GROUPS_DOUBLE; g++)
        TEST_ASSERT_TRUE(sum_d[g] == (LANES_DOUBLE < GROUP ? d[0] + d[1]
                                                           : (d[4 * g] + d[4 * g + 2]) +
                                                                 (d[4 * g + 1] + d[4 * g + 3])));
}

/* Those below the limit, in order, and no others: of all patterns of eight, twice. */
static void test_kept_below(void)
{
    for (unsigned pattern = 0; pattern < 256; pattern++) {
        float a[LANES_FLOAT];
        uint32_t item[LANES_FLOAT], out[2 * LANES_FLOAT], expected[LANES_FLOAT];
        int n = 0;
        for (int l = 0; l < LANES_FLOAT; l++) {
            item[l] = 1000 + pattern + 7 * (unsigned)l;
            const bool below = pattern >> l % 8 & 1;
            a[l] = below ? 1.99f : l % 3 ? 2.0f : NAN;
            if (below) expected[n++] = item[l];
        }
        TEST_ASSERT_EQUAL_INT(n, vkeep_below(out, item, vload_float(a), 2.0f));
        if (n) TEST_ASSERT_EQUAL_UINT32_ARRAY(expected, out, n);
    }
}

/* The first n lanes and no more, as they are and as doubles. */
static void test_some_of_the_lanes(void)
{
    float a[LANES_FLOAT], out[LANES_FLOAT + 1];
    double b[LANES_DOUBLE], wide[LANES_FLOAT + 1], own[LANES_DOUBLE + 1];
    for (int l = 0; l < LANES_FLOAT; l++) a[l] = (float)at(l);
    for (int l = 0; l < LANES_DOUBLE; l++) b[l] = at(l);
    for (int n = 0; n <= LANES_FLOAT; n++) {
        for (int l = 0; l <= LANES_FLOAT; l++) out[l] = 77, wide[l] = 77;
        vput_float(out, vload_float(a), n);
        vwiden_float(wide, vload_float(a), n);
        for (int l = 0; l <= LANES_FLOAT; l++) {
            TEST_ASSERT_TRUE(same_float(out[l], l < n ? a[l] : 77));
            TEST_ASSERT_TRUE(same_double(wide[l], l < n ? (double)a[l] : 77));
        }
    }
    for (int n = 0; n <= LANES_DOUBLE; n++) {
        for (int wider = 0; wider < 2; wider++) {
            for (int l = 0; l <= LANES_DOUBLE; l++) own[l] = 77;
            if (wider)
                vwiden_double(own, vload_double(b), n);
            else
                vput_double(own, vload_double(b), n);
            for (int l = 0; l <= LANES_DOUBLE; l++)
                TEST_ASSERT_TRUE(same_double(own[l], l < n ? b[l] : 77));
        }
    }
}

static __attribute__((noinline)) void turn(const double x[2], double cosine, double sine,
                                           double to[2])
{
    const double X = x[0], Y = x[1];
    to[0] = cosine * X - sine * Y;
    to[1] = sine * X + cosine * Y;
}

/* gcc would make a vector of the difference and the sum, and contract it. */
static void test_products_are_rounded(void)
{
    for (int k = 1; k < 100; k++) {
        const double x[2] = {0.1 * k, 0.3 / k}, a = 0.7 / k, b = 1.1 / k;
        const volatile double ax = a * x[0], ay = a * x[1], bx = b * x[0], by = b * x[1];
        double found[2];
        turn(x, a, b, found);
        TEST_ASSERT_TRUE(same_double(found[0], ax - by) && same_double(found[1], bx + ay));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_float_verbs);
    RUN_TEST(test_some_of_the_lanes);
    RUN_TEST(test_double_verbs);
    RUN_TEST(test_min_and_max_of_nan_and_zeros);
    RUN_TEST(test_fma_rounds_once);
    RUN_TEST(test_products_are_rounded);
    RUN_TEST(test_sum_follows_the_tree);
    RUN_TEST(test_groups);
    RUN_TEST(test_kept_below);
    RUN_TEST(test_top_finds_the_largest_wherever_it_is);
    RUN_TEST(test_loads_and_stores_at_any_address);
    return UNITY_END();
}
