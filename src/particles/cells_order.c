/* SPDX-License-Identifier: MIT
 * The order of the particles within a cell: clusters of four close particles, the leaves of a
 * k-d tree (Bentley 1975) that halves along the longer axis. The order follows from positions
 * and ids alone, so that a restart reproduces it: positions at the sort for fluid, in the
 * reference configuration for bodies. */
#include "particles/cells.h"
#include "base/simd.h"

/* Positions and ids of the particles of a cell. */
struct cell_points {
    double at[2][CELL_CAPACITY];
    int64_t key[2][CELL_CAPACITY]; /* `at` as integers with the same order; NaN has one too */
    int64_t id[CELL_CAPACITY];
};

_Static_assert(CELL_CAPACITY % LANES_DOUBLE == 0, "the points of a cell fill whole vectors");

/* An integer with the order of x; a NaN comes before or after all numbers. */
static int64_t split_key(double x)
{
    int64_t key;
    x += 0.0; /* -0 becomes 0 */
    memcpy(&key, &x, sizeof key);
    return key < 0 ? key ^ INT64_MAX : key;
}

/* Sorts points by one coordinate, then the other, then by id. A point's rank is the number of
 * points before it: n^2 comparisons, but no branches. */
static void sort_points(const struct cell_points *s, uint16_t *point, int n, int axis)
{
    _Alignas(64) int64_t first[CELL_CAPACITY], second[CELL_CAPACITY], id[CELL_CAPACITY];
    uint16_t sorted[CELL_CAPACITY];
    memcpy(sorted, point, (size_t)n * sizeof *point); /* ids of a damaged file may not be unique */
    for (int k = 0; k < n; k++) {
        first[k] = s->key[axis][point[k]];
        second[k] = s->key[1 - axis][point[k]];
        id[k] = s->id[point[k]];
    }
    for (int from = 0; from < n; from += LANES_DOUBLE) {
        const vlong a = *(const vlong *)(const void *)&first[from];
        const vlong b = *(const vlong *)(const void *)&second[from];
        const vlong c = *(const vlong *)(const void *)&id[from];
        vlong before = {0}; /* lanes from n on are not used */
        for (int j = 0; j < n; j++) {
            const vlong by_id = (second[j] == b) & (id[j] < c);
            before -= (first[j] < a) | ((first[j] == a) & ((second[j] < b) | by_id));
        }
        for (int k = from; k < from + LANES_DOUBLE && k < n; k++)
            sorted[before[k - from]] = point[k];
    }
    memcpy(point, sorted, (size_t)n * sizeof *point);
}

/* The axis along which the particles extend further. */
static int longer_axis(const struct cell_points *s, const uint16_t *point, int n)
{
    double low[] = {INFINITY, INFINITY}, high[] = {-INFINITY, -INFINITY};
    for (int k = 0; k < n; k++)
        for (int axis = 0; axis < 2; axis++) {
            low[axis] = min2(low[axis], s->at[axis][point[k]]);
            high[axis] = max2(high[axis], s->at[axis][point[k]]);
        }
    return high[1] - low[1] > high[0] - low[0];
}

/* Halves the points along the longer axis, into whole clusters, until each part is one cluster. */
static void split(const struct cell_points *s, uint16_t *point, int n)
{
    if (n <= CLUSTER) return;
    sort_points(s, point, n, longer_axis(s, point, n));
    const int half = (n + CLUSTER - 1) / CLUSTER / 2 * CLUSTER;
    split(s, point, half);
    split(s, point + half, n - half);
}

/* Orders the n particles of one cell. */
static void order_cell(uint64_t *pair, int n, const struct particles *particles)
{
    struct cell_points s;
    uint16_t point[CELL_CAPACITY];
    uint32_t particle[CELL_CAPACITY];
    const double *const x = particles->X ? particles->X : particles->x;
    const double *const y = particles->Y ? particles->Y : particles->y;
    ASSERT(n <= CELL_CAPACITY);
    if (n <= CLUSTER) return;
    for (int k = 0; k < n; k++) {
        const uint32_t i = (uint32_t)pair[k];
        ASSERT(i < particles->n);
        s.key[0][k] = split_key(s.at[0][k] = x[i]);
        s.key[1][k] = split_key(s.at[1][k] = y[i]);
        s.id[k] = particles->id[i];
        particle[k] = i;
        point[k] = (uint16_t)k;
    }
    split(&s, point, n);
    for (int k = 0; k < n; k++) pair[k] = (pair[k] >> 32 << 32) | particle[point[k]];
}

/* For particles outside the grid, and cells above their capacity: a guard then stops the run. */
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

/* Each thread orders whole cells. Their start is found first, since ordering changes `pair`. */
void cells_order(uint64_t *pair, int64_t n, const struct particles *particles, int threads)
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
                order_by_id(&pair[k], end - k, particles->id);
            else
                order_cell(&pair[k], (int)(end - k), particles);
        }
    }
}
