/* SPDX-License-Identifier: MIT
 * What a cluster sees, against brute force: every particle within reach of one of its own, once,
 * also where particles have strayed from their cells and through joined sides; and in shares each
 * pair from one side. */
#include "rig.h"
#include "particles/kernel.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char scene[] = "dp = 1 cm\nend_time = 10\nprecision = double\n[numerics]\nskin = 0.5\n"
                            "[domain]\nlower = -0.3, -0.4\nupper = 0.4, 0.4\nperiodic = x\n"
                            "[fluid w]\nshape = box -0.3, -0.3, 0.4, 0.3\nsound_speed = 20\n"
                            "[wall bed]\nshape = box -0.3, -0.34, 0.4, -0.3\n";

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

/* Where the lanes say that the r-th particle of a cluster is, seen from another cell's centre, in
 * m. */
static void place_seen(enum kind kind, uint32_t code, int r, double place[2])
{
    const struct fluid *const fluid = &rig.sim.fluid;
    const double *const lanes = (const double *)fluid->packed[kind].cluster +
                                neighbour_number(code) * (size_t)(fluid->packed[kind].n * CLUSTER);
    const unsigned step[2] = {neighbour_column(code), neighbour_row(code)};
    for (int axis = 0; axis < 2; axis++)
        place[axis] = fluid->k.h * lanes[(PACKED_X + axis) * CLUSTER + r] +
                      ((double)step[axis] - 1) * rig.sim.cells.side[axis];
}

/* Pairs of particle i with others of a kind within reach, straight from the definition. */
static int within_reach(enum kind kind, int64_t i)
{
    const struct particles *const a = &rig.sim.particles[KIND_FLUID], *const b =
                                                                          &rig.sim.particles[kind];
    const struct cells *const cells = &rig.sim.cells;
    int n = 0;
    for (int64_t j = 0; j < b->n; j++)
        n += hypot(cells_minimum_image(cells, 0, a->x[i] - b->x[j]),
                   cells_minimum_image(cells, 1, a->y[i] - b->y[j])) <
             KERNEL_REACH * rig.sim.fluid.k.h;
    return n;
}

static void compare(enum kind kind, int *in_list, int *in_reach)
{
    static struct neighbour_clusters around;
    static struct cluster_list near;
    const struct fluid *const fluid = &rig.sim.fluid;
    const struct cells *const cells = &rig.sim.cells;
    const struct cell_list *const list = &cells->list[KIND_FLUID];
    for (int32_t k = 0; k < list->n_active; k++) {
        const int32_t cell = list->active[k];
        neighbour_clusters_collect(&around, &fluid->packed[kind].boxes, cells, kind, cell,
                                   fluid->k.h, (struct cluster_range){0});
        for (int32_t m = 0; m < list->count[cell]; m++) {
            const uint32_t own = neighbour_code(list->cluster[cell] + m / CLUSTER, 1, 1);
            cluster_list_build(&near, &around, &fluid->packed[KIND_FLUID].boxes,
                               (int32_t)neighbour_number(own));
            double at[2], other[2];
            place_seen(KIND_FLUID, own, m % CLUSTER, at);
            int found = 0;
            for (int n = 0; n < near.n; n++)
                for (int r = 0; r < CLUSTER; r++) {
                    place_seen(kind, near.code[n], r, other);
                    const double away = hypot(at[0] - other[0], at[1] - other[1]);
                    found += away < KERNEL_REACH * fluid->k.h;
                    *in_list += away < 100;
                }
            const int expected = within_reach(kind, list->start[cell] + m);
            TEST_ASSERT_EQUAL_INT(expected, found);
            *in_reach += found;
        }
    }
}

/* Adds up for each particle whom it sees within reach itself and who sees it ahead, in shares of so
 * many cells. Pairs in a share must not be looked at from both sides: that would count them twice.
 */
static void count_shares(int32_t cells, int *met)
{
    static struct neighbour_clusters around;
    static struct cluster_list near;
    const struct fluid *const fluid = &rig.sim.fluid;
    const struct cell_list *const list = &rig.sim.cells.list[KIND_FLUID];
    int64_t *const particle =
        calloc((size_t)rig.sim.particles[KIND_FLUID].n, CLUSTER * sizeof *particle);
    TEST_ASSERT_NOT_NULL(particle);
    for (int32_t k = 0; k < list->n_active; k++) /* by place in the clusters */
        for (int32_t m = 0; m < list->count[list->active[k]]; m++)
            particle[list->cluster[list->active[k]] * CLUSTER + m] =
                list->start[list->active[k]] + m;
    for (int32_t first = 0; first < list->n_active; first += cells) {
        const int32_t end = first + cells < list->n_active ? first + cells : list->n_active;
        const struct cluster_range range = clusters_of(list, first, end);
        for (int32_t k = first; k < end; k++) {
            const int32_t cell = list->active[k];
            neighbour_clusters_collect(&around, &fluid->packed[KIND_FLUID].boxes, &rig.sim.cells,
                                       KIND_FLUID, cell, fluid->k.h, range);
            for (int32_t m = clusters_in(list, cell) - 1; m >= 0; m--) {
                cluster_list_build_half(&near, &around, &fluid->packed[KIND_FLUID].boxes);
                TEST_ASSERT_EQUAL_INT(list->cluster[cell] + m, neighbour_number(near.code[0]));
                for (int n = 0; n < near.n; n++) {
                    const int32_t number = (int32_t)neighbour_number(near.code[n]);
                    const bool inside = number >= range.first && number < range.end;
                    TEST_ASSERT_EQUAL(inside && n > 0, neighbour_is_half(near.code[n]));
                    for (int pair = 0; pair < CLUSTER * CLUSTER; pair++) {
                        const int r = pair / CLUSTER, b = pair % CLUSTER;
                        double at[2], other[2];
                        place_seen(KIND_FLUID, near.code[0], r, at);
                        place_seen(KIND_FLUID, near.code[n], b, other);
                        if (at[0] > 100 || other[0] > 100) continue; /* no particle */
                        if (hypot(at[0] - other[0], at[1] - other[1]) >= KERNEL_REACH * fluid->k.h)
                            continue;
                        met[particle[(list->cluster[cell] + m) * CLUSTER + r]]++;
                        if (neighbour_is_half(near.code[n])) met[particle[number * CLUSTER + b]]++;
                    }
                }
            }
        }
    }
    free(particle);
}

static void test_pairs_in_a_share_are_seen_once(void)
{
    static const int32_t cells[] = {1, 5, 64, 100000};
    uint64_t seed = 5;
    rig_open(&rig, scene, NULL);
    struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    for (int64_t i = 0; i < particles->n; i++) {
        particles->x[i] += 0.006 * noise(&seed);
        particles->y[i] += 0.006 * noise(&seed);
    }
    rig_sort(&rig);
    rig_evaluate(&rig);
    int *const met = calloc((size_t)particles->n, sizeof *met);
    TEST_ASSERT_NOT_NULL(met);
    for (size_t k = 0; k < COUNT_OF(cells); k++) {
        memset(met, 0, (size_t)particles->n * sizeof *met);
        count_shares(cells[k], met);
        for (int64_t i = 0; i < particles->n; i++)
            TEST_ASSERT_EQUAL_INT(within_reach(KIND_FLUID, i), met[i]);
    }
    free(met);
}

/* Of any number of cells: all of them, once, in as many shares for 16 threads as for one. */
static void test_shares_hold_all_cells(void)
{
    for (int32_t n = 1; n < 5000; n += n < 40 ? 1 : 37) {
        const int32_t shares = fluid_chunk_count(n);
        TEST_ASSERT_EQUAL_INT(0, shares % (n > 24 * CHUNK_CELLS  ? 24
                                           : n > 2 * CHUNK_CELLS ? 8
                                                                 : 4));
        TEST_ASSERT_EQUAL_INT(0, fluid_chunk_start(n, 0));
        TEST_ASSERT_EQUAL_INT(n, fluid_chunk_start(n, shares));
        for (int32_t m = 0; m < shares; m++) {
            const int32_t cells = fluid_chunk_start(n, m + 1) - fluid_chunk_start(n, m);
            TEST_ASSERT_TRUE(cells >= 0 && cells <= CHUNK_CELLS);
        }
    }
}

/* Shaken, and then strayed by as much as cells allow for. */
static void test_all_within_reach_are_seen(void)
{
    uint64_t seed = 3;
    rig_open(&rig, scene, NULL);
    struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    for (int turn = 0; turn < 3; turn++) {
        for (int64_t i = 0; i < particles->n; i++) {
            particles->x[i] += 0.004 * noise(&seed);
            particles->y[i] += 0.004 * noise(&seed);
        }
        if (turn < 2) rig_sort(&rig);
        rig_evaluate(&rig);
        for (int kind = KIND_FLUID; kind <= KIND_WALL; kind++) {
            int in_list = 0, in_reach = 0;
            compare((enum kind)kind, &in_list, &in_reach);
            TEST_ASSERT_TRUE(in_reach > (kind == KIND_FLUID ? 20 * particles->n : 100));
            /* Not everything is looked at: less than three candidates for a neighbour. */
            if (kind == KIND_FLUID) assert_at_most(3, 1.0 * in_list / in_reach, "candidates");
        }
    }
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_all_within_reach_are_seen);
    RUN_TEST(test_pairs_in_a_share_are_seen_once);
    RUN_TEST(test_shares_hold_all_cells);
    return UNITY_END();
}
