/* SPDX-License-Identifier: MIT
 * The order of the particles within a cell: clusters of four that lie close together, the leaves of a k-d
 * tree (Bentley 1975) that halves along the longer axis. It follows from positions and ids alone: those of
 * the fluid as it is sorted, of bodies in their reference configuration, which a restart knows as well. */
#include <math.h>

#include "cells.h"

/* What decides the place of a particle. */
struct spot {
    double at[2];
    int64_t id;
    uint32_t particle;
};

/* Along an axis, then the other one, then by id. */
static bool comes_before(const struct spot *a, const struct spot *b, int axis)
{
    if (a->at[axis] != b->at[axis]) return a->at[axis] < b->at[axis];
    if (a->at[1 - axis] != b->at[1 - axis]) return a->at[1 - axis] < b->at[1 - axis];
    return a->id < b->id;
}

/* By insertion: a few of them, mostly in order since the last time. */
static void sort_spots(struct spot *spot, int n, int axis)
{
    for (int k = 1; k < n; k++) {
        const struct spot moved = spot[k];
        int j = k;
        for (; j > 0 && comes_before(&moved, &spot[j - 1], axis); j--) spot[j] = spot[j - 1];
        spot[j] = moved;
    }
}

/* The axis along which the particles extend further. */
static int longer_axis(const struct spot *spot, int n)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int k = 0; k < n; k++)
        for (int axis = 0; axis < 2; axis++) {
            low[axis] = min2(low[axis], spot[k].at[axis]);
            high[axis] = max2(high[axis], spot[k].at[axis]);
        }
    return high[1] - low[1] > high[0] - low[0];
}

/* Halves the particles along the longer axis, whole clusters each, until they are clusters. */
static void split(struct spot *spot, int n)
{
    if (n <= CLUSTER) return;
    sort_spots(spot, n, longer_axis(spot, n));
    const int half = (n + CLUSTER - 1) / CLUSTER / 2 * CLUSTER;
    split(spot, half);
    split(spot + half, n - half);
}

/* One cell's range of pairs. */
static void order_cell(uint64_t *pair, int n, const struct particles *p)
{
    struct spot spot[CELL_CAPACITY];
    const double *const x = p->X ? p->X : p->x, *const y = p->Y ? p->Y : p->y;
    for (int k = 0; k < n; k++) {
        const uint32_t i = (uint32_t)pair[k];
        spot[k] = (struct spot){{x[i], y[i]}, p->id[i], i};
    }
    split(spot, n);
    for (int k = 0; k < n; k++) pair[k] = (pair[k] >> 32 << 32) | spot[k].particle;
}

/* Those outside of the grid, and those of a cell with more than there is room for, which ends the run. */
static void order_by_id(uint64_t *pair, int64_t n, const int64_t *id)
{
    for (int64_t k = 1; k < n; k++) {
        const uint64_t moved = pair[k];
        const int64_t moved_id = id[(uint32_t)moved];
        int64_t j = k;
        for (; j > 0 && id[(uint32_t)pair[j - 1]] > moved_id; j--) pair[j] = pair[j - 1];
        pair[j] = moved;
    }
}

static int64_t end_of_cell(const uint64_t *pair, int64_t n, int64_t k)
{
    int64_t end = k + 1;
    while (end < n && pair[end] >> 32 == pair[k] >> 32) end++;
    return end;
}

/* Shares of the places begin where cells do: found before any of them is put in order. */
void cells_order(uint64_t *pair, int64_t n, const struct particles *p, int threads)
{
    int64_t first[CELLS_SORT_THREADS + 1] = {0};
    for (int t = 1; t <= threads; t++) {
        const int64_t k = n * t / threads;
        first[t] = k > 0 && k < n ? end_of_cell(pair, n, k - 1) : k;
    }
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int t = 0; t < threads; t++) {
        for (int64_t k = first[t], end; k < first[t + 1]; k = end) {
            end = end_of_cell(pair, first[t + 1], k);
            if (pair[k] >> 32 == UINT32_MAX || end - k > CELL_CAPACITY)
                order_by_id(&pair[k], end - k, p->id);
            else
                order_cell(&pair[k], (int)(end - k), p);
        }
    }
}
