/* SPDX-License-Identifier: MIT
 * 2x2 tensors against sums over indices, and the identities that define the cofactor. */
#include "base/tensor2.h"

#include "rig.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static struct tensor2 draw(uint64_t *seed)
{
    return (struct tensor2){noise(seed), noise(seed), noise(seed), noise(seed)};
}

static double part(struct tensor2 a, int i, int j)
{
    return i == 0 ? (j == 0 ? a.xx : a.xy) : j == 0 ? a.yx : a.yy;
}

static void test_products(void)
{
    uint64_t seed = 1;
    for (int turn = 0; turn < 50; turn++) {
        const struct tensor2 a = draw(&seed), b = draw(&seed);
        const struct tensor2 ab = tensor2_mul(a, b), abt = tensor2_mul_t(a, b);
        for (int i = 0; i < 2; i++) {
            for (int j = 0; j < 2; j++) {
                double sum = 0, sum_t = 0;
                for (int k = 0; k < 2; k++) {
                    sum += part(a, i, k) * part(b, k, j);
                    sum_t += part(a, i, k) * part(b, j, k);
                }
                assert_near(1e-15, sum, part(ab, i, j), "a b");
                assert_near(1e-15, sum_t, part(abt, i, j), "a b^T");
            }
        }
    }
}

/* cof(a)^T a = det(a) I; numbers of [[1, 2], [3, 5]]: det -1, cofactor [[5, -3], [-2, 1]]. */
static void test_determinant_and_cofactor(void)
{
    const struct tensor2 a = {1, 2, 3, 5}, cof = tensor2_cof(a);
    TEST_ASSERT_TRUE(tensor2_det(a) == -1);
    TEST_ASSERT_TRUE(cof.xx == 5 && cof.xy == -3 && cof.yx == -2 && cof.yy == 1);
    uint64_t seed = 2;
    for (int turn = 0; turn < 50; turn++) {
        const struct tensor2 b = draw(&seed), product = tensor2_mul_t(b, tensor2_cof(b));
        assert_near(1e-15, tensor2_det(b), product.xx, "xx");
        assert_near(1e-15, tensor2_det(b), product.yy, "yy");
        assert_near(1e-15, 0, product.xy, "xy");
        assert_near(1e-15, 0, product.yx, "yx");
    }
}

/* The lane form gives the bits of the scalar form in every lane. */
static void test_lanes_are_scalars_side_by_side(void)
{
    uint64_t seed = 3;
    struct tensor2 a[LANES_DOUBLE], b[LANES_DOUBLE];
    struct vtensor2 A, B;
    for (int l = 0; l < LANES_DOUBLE; l++) {
        a[l] = draw(&seed);
        b[l] = draw(&seed);
        A.xx[l] = a[l].xx, A.xy[l] = a[l].xy, A.yx[l] = a[l].yx, A.yy[l] = a[l].yy;
        B.xx[l] = b[l].xx, B.xy[l] = b[l].xy, B.yx[l] = b[l].yx, B.yy[l] = b[l].yy;
    }
    const struct vtensor2 AB = vtensor2_mul(A, B), ABt = vtensor2_mul_t(A, B), C = vtensor2_cof(A);
    const vdouble det = vtensor2_det(A);
    for (int l = 0; l < LANES_DOUBLE; l++) {
        TEST_ASSERT_TRUE(AB.xy[l] == tensor2_mul(a[l], b[l]).xy);
        TEST_ASSERT_TRUE(AB.yx[l] == tensor2_mul(a[l], b[l]).yx);
        TEST_ASSERT_TRUE(ABt.xy[l] == tensor2_mul_t(a[l], b[l]).xy);
        TEST_ASSERT_TRUE(ABt.yy[l] == tensor2_mul_t(a[l], b[l]).yy);
        TEST_ASSERT_TRUE(C.xy[l] == tensor2_cof(a[l]).xy);
        TEST_ASSERT_TRUE(det[l] == tensor2_det(a[l]));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_products);
    RUN_TEST(test_determinant_and_cofactor);
    RUN_TEST(test_lanes_are_scalars_side_by_side);
    return UNITY_END();
}
