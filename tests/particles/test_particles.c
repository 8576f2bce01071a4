/* SPDX-License-Identifier: MIT
 * Particle fields: a group that is off costs nothing, permutation moves whole particles, the hash
 * sees every field of the state. */
#include "particles/particles.h"

#include "unity.h"

#include <string.h>

static struct arena arena;
static struct diag diag;
static struct particles p;

void setUp(void)
{
    diag = (struct diag){0};
    arena = (struct arena){0};
}

void tearDown(void)
{
    arena_fail_after(-1);
    arena_free(&arena);
}

static void create(int64_t n, unsigned groups)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, particles_create(&p, &arena, n, groups, "test", &diag));
    p.n = n;
}

static void test_fields_follow_groups(void)
{
    const unsigned groups = G_POINT | G_DENSITY;
    create(10, groups);
    size_t bytes = 0;
    for (int k = 0; k < field_count; k++) {
        const bool on = field_table[k].group & groups;
        TEST_ASSERT_EQUAL_INT_MESSAGE(on, field_array(&p, &field_table[k]) != NULL,
                                      field_table[k].name);
        bytes += on ? 10 * field_table[k].size : 0;
    }
    TEST_ASSERT_EQUAL_UINT64(bytes, particles_bytes(&p));
    TEST_ASSERT_NOT_NULL(p.dens);
    TEST_ASSERT_NULL(p.ux);
}

static void test_no_particles_are_no_failure(void)
{
    create(0, G_POINT);
    TEST_ASSERT_NOT_NULL(p.x);
    TEST_ASSERT_EQUAL_UINT64(7, particles_hash(&p, 7));
}

static void test_failing_memory_is_named(void)
{
    arena_fail_after(3);
    TEST_ASSERT_EQUAL_INT(ERR_MEMORY,
                          particles_create(&p, &arena, 10, G_POINT, "water particles", &diag));
    TEST_ASSERT_NOT_NULL(strstr(diag.text, "water particles"));
}

/* Every field of the state follows its particle; sizes 4 and 8 both occur. */
static void test_permutation_moves_whole_particles(void)
{
    enum { N = 1000 };
    create(N, G_POINT | G_DENSITY | G_VERLET);
    static int32_t order[N];
    static double scratch[N];
    for (int32_t i = 0; i < N; i++) {
        p.x[i] = i;
        p.dens[i] = -i;
        p.vx_old[i] = 0.5 * i;
        p.id[i] = i + ((int64_t)1 << 40);
        p.cell[i] = 3 * i;
        order[i] = (int32_t)((i * 387) % N); /* 387 and 1000 have no common divisor */
    }
    particles_permute(&p, order, N, scratch);
    for (int32_t i = 0; i < N; i++) {
        TEST_ASSERT_TRUE(p.x[i] == order[i]);
        TEST_ASSERT_TRUE(p.dens[i] == -order[i]);
        TEST_ASSERT_TRUE(p.vx_old[i] == 0.5 * order[i]);
        TEST_ASSERT_EQUAL_INT64(order[i] + ((int64_t)1 << 40), p.id[i]);
        TEST_ASSERT_EQUAL_INT32(3 * order[i], p.cell[i]);
    }
}

/* One bit anywhere in the state changes the hash; derived fields and room behind n do not. */
static void test_hash_sees_every_bit_of_the_state(void)
{
    const unsigned all = ~0u;
    create(5, all);
    p.n = 4;
    const uint64_t before = particles_hash(&p, 1);
    for (int k = 0; k < field_count; k++) {
        unsigned char *const bytes = field_array(&p, &field_table[k]);
        bytes[3 * field_table[k].size] ^= 1;
        const bool state = field_table[k].keep == KEEP_STATE;
        TEST_ASSERT_EQUAL_INT_MESSAGE(state, before != particles_hash(&p, 1), field_table[k].name);
        bytes[3 * field_table[k].size] ^= 1;
        bytes[4 * field_table[k].size] ^= 1;
        TEST_ASSERT_EQUAL_HEX64(before, particles_hash(&p, 1));
    }
    TEST_ASSERT_TRUE(before != particles_hash(&p, 2));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_fields_follow_groups);
    RUN_TEST(test_no_particles_are_no_failure);
    RUN_TEST(test_failing_memory_is_named);
    RUN_TEST(test_permutation_moves_whole_particles);
    RUN_TEST(test_hash_sees_every_bit_of_the_state);
    return UNITY_END();
}
