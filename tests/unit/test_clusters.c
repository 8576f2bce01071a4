/* SPDX-License-Identifier: MIT
 * What a cluster sees, against brute force: every particle within reach of one of its own, once, also where
 * particles have strayed from their cells and through joined sides. */
#include "rig.h"
#include "smoothing.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>

static const char scene[] = "dp = 1 cm\nend_time = 10\nprecision = double\n[numerics]\nskin = 0.5\n"
                            "[domain]\nlower = -0.3, -0.4\nupper = 0.4, 0.4\nperiodic = x\n"
                            "[fluid w]\nshape = box -0.3, -0.3, 0.4, 0.3\nsound_speed = 20\n"
                            "[wall bed]\nshape = box -0.3, -0.34, 0.4, -0.3\n";

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

/* Where the lanes say that the r-th particle of a cluster is, seen from another cell's centre, in m. */
static void place_seen(enum kind kind, uint32_t seen, int r, double place[2])
{
    const struct fluid *const f = &rig.sim.fluid;
    const double *const lanes = (const double *)f->lanes[kind].cluster +
                                seen_number(seen) * (size_t)(f->lanes[kind].n * CLUSTER);
    const unsigned step[2] = {seen_column(seen), seen_row(seen)};
    for (int axis = 0; axis < 2; axis++)
        place[axis] = f->k.h * lanes[(LANE_X + axis) * CLUSTER + r] +
                      ((double)step[axis] - 1) * rig.sim.cells.side[axis];
}

/* Pairs of particle i with others of a kind within reach, straight from the definition. */
static int within_reach(enum kind kind, int64_t i)
{
    const struct particles *const a = &rig.sim.kind[KIND_FLUID], *const b = &rig.sim.kind[kind];
    const struct cells *const c = &rig.sim.cells;
    int n = 0;
    for (int64_t j = 0; j < b->n; j++)
        n += hypot(cells_short_way(c, 0, a->x[i] - b->x[j]),
                   cells_short_way(c, 1, a->y[i] - b->y[j])) < KERNEL_REACH * rig.sim.fluid.k.h;
    return n;
}

static void compare(enum kind kind, int *in_list, int *in_reach)
{
    static struct surroundings around;
    static struct cluster_list near;
    const struct fluid *const f = &rig.sim.fluid;
    const struct cells *const c = &rig.sim.cells;
    const struct cell_list *const list = &c->kind[KIND_FLUID];
    for (int32_t k = 0; k < list->n_active; k++) {
        const int32_t cell = list->active[k];
        clusters_around(&around, &f->lanes[kind].boxes, c, kind, cell, f->k.h);
        for (int32_t m = 0; m < list->count[cell]; m++) {
            const uint32_t own = seen_cluster(list->cluster[cell] + m / CLUSTER, 1, 1);
            clusters_near(&near, &around, &f->lanes[KIND_FLUID].boxes, (int32_t)seen_number(own));
            double at[2], other[2];
            place_seen(KIND_FLUID, own, m % CLUSTER, at);
            int found = 0;
            for (int n = 0; n < near.n; n++)
                for (int r = 0; r < CLUSTER; r++) {
                    place_seen(kind, near.seen[n], r, other);
                    const double away = hypot(at[0] - other[0], at[1] - other[1]);
                    found += away < KERNEL_REACH * f->k.h;
                    *in_list += away < 100;
                }
            const int expected = within_reach(kind, list->start[cell] + m);
            TEST_ASSERT_EQUAL_INT(expected, found);
            *in_reach += found;
        }
    }
}

/* Shaken, and then strayed by as much as cells allow for. */
static void test_all_within_reach_are_seen(void)
{
    uint64_t seed = 3;
    rig_open(&rig, scene, NULL);
    struct particles *const p = &rig.sim.kind[KIND_FLUID];
    for (int turn = 0; turn < 3; turn++) {
        for (int64_t i = 0; i < p->n; i++) {
            p->x[i] += 0.004 * noise(&seed);
            p->y[i] += 0.004 * noise(&seed);
        }
        if (turn < 2) rig_sort(&rig);
        rig_evaluate(&rig);
        for (int kind = KIND_FLUID; kind <= KIND_WALL; kind++) {
            int in_list = 0, in_reach = 0;
            compare((enum kind)kind, &in_list, &in_reach);
            TEST_ASSERT_TRUE(in_reach > (kind == KIND_FLUID ? 20 * p->n : 100));
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
    return UNITY_END();
}
