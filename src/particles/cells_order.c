/* SPDX-License-Identifier: MIT
 * The order of the particles within a cell: clusters of four that lie close together, the leaves of a k-d
 * tree (Bentley 1975) that halves along the longer axis. It follows from positions and ids alone: those of
 * the fluid as it is sorted, of bodies in their reference configuration, which a restart knows as well. */
#include <math.h>
#include <string.h>

#include "particles/cells.h"
#include "base/simd.h"

/* What decides the places of the particles of a cell. */
struct spots {
    double at[2][CELL_CAPACITY];
    int64_t key[2][CELL_CAPACITY]; /* `at` as whole numbers, which always have an order */
    int64_t id[CELL_CAPACITY];
};

_Static_assert(CELL_CAPACITY % LANES_DOUBLE == 0, "a cell's spots fill whole vectors");

/* Orders as the numbers do; what is not a number comes before or after all of them. */
static int64_t key_of(double x)
{
    int64_t key;
    x += 0.0; /* one zero instead of two */
    memcpy(&key, &x, sizeof key);
    return key < 0 ? key ^ INT64_MAX : key;
}

/* Along an axis, then the other one, then by id: a spot's new place is the number of those that come before,
 * which takes no branches. */
static void sort_spots(const struct spots *s, uint16_t *spot, int n, int axis)
{
    _Alignas(64) int64_t first[CELL_CAPACITY], second[CELL_CAPACITY], id[CELL_CAPACITY];
    uint16_t sorted[CELL_CAPACITY];
    memcpy(sorted, spot, (size_t)n * sizeof *spot); /* ids of damaged files may not be unique */
    for (int k = 0; k < n; k++) {
        first[k] = s->key[axis][spot[k]];
        second[k] = s->key[1 - axis][spot[k]];
        id[k] = s->id[spot[k]];
    }
    for (int from = 0; from < n; from += LANES_DOUBLE) {
        const vlong a = *(const vlong *)(const void *)&first[from];
        const vlong b = *(const vlong *)(const void *)&second[from];
        const vlong c = *(const vlong *)(const void *)&id[from];
        vlong before = {0}; /* of those beyond the last nobody asks */
        for (int j = 0; j < n; j++) {
            const vlong by_id = (second[j] == b) & (id[j] < c);
            before -= (first[j] < a) | ((first[j] == a) & ((second[j] < b) | by_id));
        }
        for (int k = from; k < from + LANES_DOUBLE && k < n; k++)
            sorted[before[k - from]] = spot[k];
    }
    memcpy(spot, sorted, (size_t)n * sizeof *spot);
}

/* The axis along which the particles extend further. */
static int longer_axis(const struct spots *s, const uint16_t *spot, int n)
{
    double left = INFINITY, right = -INFINITY, down = INFINITY, up = -INFINITY;
    for (int k = 0; k < n; k++) {
        const double x = s->at[0][spot[k]], y = s->at[1][spot[k]];
        left = min2(left, x);
        right = max2(right, x);
        down = min2(down, y);
        up = max2(up, y);
    }
    return up - down > right - left;
}

/* Halves the particles along the longer axis, whole clusters each, until they are clusters. */
static void split(const struct spots *s, uint16_t *spot, int n)
{
    if (n <= CLUSTER) return;
    sort_spots(s, spot, n, longer_axis(s, spot, n));
    const int half = (n + CLUSTER - 1) / CLUSTER / 2 * CLUSTER;
    split(s, spot, half);
    split(s, spot + half, n - half);
}

/* One cell's range of pairs. */
static void order_cell(uint64_t *pair, int n, const struct particles *p)
{
    struct spots s;
    uint16_t spot[CELL_CAPACITY];
    uint32_t particle[CELL_CAPACITY];
    const double *const x = p->X ? p->X : p->x, *const y = p->Y ? p->Y : p->y;
    if (n <= CLUSTER) return;
    for (int k = 0; k < n; k++) {
        const uint32_t i = (uint32_t)pair[k];
        s.key[0][k] = key_of(s.at[0][k] = x[i]);
        s.key[1][k] = key_of(s.at[1][k] = y[i]);
        s.id[k] = p->id[i];
        particle[k] = i;
        spot[k] = (uint16_t)k;
    }
    split(&s, spot, n);
    for (int k = 0; k < n; k++) pair[k] = (pair[k] >> 32 << 32) | particle[spot[k]];
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
