/* SPDX-License-Identifier: MIT
 * Morton keys: the interleaved bits of both coordinates. */
#include "particles/cells.h"

#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static uint32_t by_bits(uint32_t cx, uint32_t cy)
{
    uint32_t key = 0;
    for (int b = 0; b < 16; b++) key |= ((cx >> b) & 1) << (2 * b) | ((cy >> b) & 1) << (2 * b + 1);
    return key;
}

/* The Z: (0,0) (1,0) (0,1) (1,1), then the next block to the right. */
static void test_first_keys(void)
{
    TEST_ASSERT_EQUAL_HEX32(0, morton_key(0, 0));
    TEST_ASSERT_EQUAL_HEX32(1, morton_key(1, 0));
    TEST_ASSERT_EQUAL_HEX32(2, morton_key(0, 1));
    TEST_ASSERT_EQUAL_HEX32(3, morton_key(1, 1));
    TEST_ASSERT_EQUAL_HEX32(4, morton_key(2, 0));
    TEST_ASSERT_EQUAL_HEX32(8, morton_key(0, 2));
}

static void test_keys_interleave_bits(void)
{
    uint32_t seed = 7;
    for (int k = 0; k < 10000; k++) {
        seed = seed * 1664525u + 1013904223u;
        const uint32_t cx = seed >> 16, cy = (seed * 2654435761u) >> 16;
        TEST_ASSERT_EQUAL_HEX32(by_bits(cx, cy), morton_key(cx, cy));
    }
    TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, morton_key(MORTON_CELLS - 1, MORTON_CELLS - 1));
    TEST_ASSERT_EQUAL_HEX32(0x55555555u, morton_key(MORTON_CELLS - 1, 0));
}

/* Aligned squares of 2^k cells are contiguous in the order. */
static void test_aligned_squares_are_contiguous(void)
{
    uint32_t low = UINT32_MAX, high = 0;
    for (uint32_t y = 24; y < 32; y++) {
        for (uint32_t x = 8; x < 16; x++) {
            const uint32_t key = morton_key(x, y);
            low = key < low ? key : low;
            high = key > high ? key : high;
        }
    }
    TEST_ASSERT_EQUAL_UINT32(63, high - low);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_first_keys);
    RUN_TEST(test_keys_interleave_bits);
    RUN_TEST(test_aligned_squares_are_contiguous);
    return UNITY_END();
}
