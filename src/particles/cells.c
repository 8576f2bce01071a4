/* SPDX-License-Identifier: MIT */
#include "particles/cells.h"

#include <math.h>
#include <string.h>

#include "particles/morton.h"

/* A particle outside the grid sorts behind every cell. */
enum { OUTSIDE = -1 };
#define OUTSIDE_KEY UINT32_MAX

enum { DIGIT_BITS = CELLS_SORT_DIGIT_BITS, DIGITS = 1 << DIGIT_BITS };

/* All or one: teams must not shrink (solid/solid.c). */
static int sort_threads(void) { return thread_count() <= CELLS_SORT_THREADS ? thread_count() : 1; }

static enum err list_create(struct cell_list *list, struct arena *a, size_t n_cells,
                            const struct particles *p, bool keep_order, struct diag *d)
{
    list->start = arena_alloc(a, n_cells, sizeof *list->start, "cell list", d);
    list->count = arena_alloc(a, n_cells, sizeof *list->count, "cell list", d);
    list->cluster = arena_alloc(a, n_cells, sizeof *list->cluster, "cell list", d);
    list->active = arena_alloc(a, (size_t)p->capacity, sizeof *list->active, "cell list", d);
    if (!list->start || !list->count || !list->cluster || !list->active) return ERR_MEMORY;
    if (!keep_order) return ERR_OK;
    list->order = arena_alloc(a, (size_t)p->capacity, sizeof *list->order, "cell list", d);
    return list->order ? ERR_OK : ERR_MEMORY;
}

/* Sides of cells over the reach: with wider ones particles meet more boxes of clusters, with narrower ones
 * clusters are less often full. And the least, for the three cells that joined sides take. */
#define SIDE 1.6
#define LEAST_SIDE 1.05

static double cells_across(double width, double reach)
{
    const double wide = floor(width / (SIDE * reach)), narrow = floor(width / (LEAST_SIDE * reach));
    return max2(1, max2(wide, min2(3, narrow)));
}

enum err cells_create(struct cells *c, struct arena *a, const double lower[2],
                      const double upper[2], double reach, double stray,
                      const struct particles kinds[KIND_COUNT], struct diag *d)
{
    memset(c, 0, sizeof *c);
    c->stray = stray;
    double n[2];
    for (int k = 0; k < 2; k++) {
        c->lower[k] = lower[k];
        n[k] = cells_across(upper[k] - lower[k], reach);
        if (!(n[k] <= MORTON_CELLS))
            return diag_fail(
                d, ERR_INPUT,
                "the domain is %.6g m in %c, more than %d cells of %.3g m: make [domain] "
                "smaller or dp larger",
                upper[k] - lower[k], k ? 'y' : 'x', MORTON_CELLS, SIDE * reach);
        c->side[k] = (upper[k] - lower[k]) / n[k];
        c->stray = min2(c->stray, max2(0, 0.5 * (c->side[k] - reach)));
    }
    c->nx = (int)n[0];
    c->ny = (int)n[1];
    if (n[0] * n[1] > INT32_MAX)
        return diag_fail(d, ERR_INPUT, "the domain has %d x %d cells, too many to number", c->nx,
                         c->ny);

    int64_t most = 0;
    for (int k = 0; k < KIND_COUNT; k++) {
        if (kinds[k].capacity == 0) continue;
        if (kinds[k].capacity > most) most = kinds[k].capacity;
        TRY(list_create(&c->kind[k], a, (size_t)c->nx * (size_t)c->ny, &kinds[k], k != KIND_FLUID,
                        d));
    }
    c->pair_a = arena_alloc(a, (size_t)most, sizeof *c->pair_a, "sorting", d);
    c->pair_b = arena_alloc(a, (size_t)most, sizeof *c->pair_b, "sorting", d);
    c->permutation = arena_alloc(a, (size_t)most, sizeof *c->permutation, "sorting", d);
    c->scratch = arena_alloc(a, (size_t)most, 8, "sorting", d);
    c->sort_threads = sort_threads();
    c->histogram = arena_alloc(a, (size_t)c->sort_threads, sizeof *c->histogram, "sorting", d);
    return c->pair_a && c->pair_b && c->permutation && c->scratch && c->histogram ? ERR_OK
                                                                                  : ERR_MEMORY;
}

enum err cells_join(struct cells *c, int axis, double reach, struct diag *d)
{
    const int n = axis ? c->ny : c->nx;
    if (n < 3)
        return diag_fail(d, ERR_INPUT,
                         "[domain] is periodic in %c and %.6g m wide there: at least %.6g m is "
                         "needed, lest a particle meets another twice",
                         "xy"[axis], n * c -> side[axis], 3 * LEAST_SIDE * reach);
    c->joined[axis] = true;
    return ERR_OK;
}

/* Place along an axis in cells, brought between joined sides. */
static double cells_along(const struct cells *c, int axis, double x)
{
    double place = (x - c->lower[axis]) / c->side[axis];
    if (!c->joined[axis]) return place;
    const double n = axis ? c->ny : c->nx;
    place -= n * floor(place / n);
    return place < n ? place : 0; /* a hair below the lower side rounds to the upper one */
}

/* Fluid beyond joined sides comes in again opposite. */
static int64_t carry_over(const struct cells *c, int axis, double *x, int64_t n)
{
    const double lower = c->lower[axis], period = c->side[axis] * (axis ? c->ny : c->nx);
    int64_t laps = 0;
#pragma omp parallel for schedule(static) reduction(+ : laps)
    for (int64_t k = 0; k < n; k++) {
        const double lap = floor((x[k] - lower) / period);
        if (lap == 0 || !isfinite(lap)) continue;
        x[k] = max2(lower, x[k] - lap * period);
        if (!(x[k] < lower + period)) x[k] = lower;
        laps += (int64_t)lap;
    }
    return laps;
}

static int32_t cell_of(const struct cells *c, double x, double y)
{
    const double fx = cells_along(c, 0, x), fy = cells_along(c, 1, y);
    if (!(fx >= 0 && fx < c->nx && fy >= 0 && fy < c->ny)) return OUTSIDE;
    return (int32_t)fy * c->nx + (int32_t)fx;
}

static uint32_t key_of(const struct cells *c, int32_t cell)
{
    if (cell == OUTSIDE) return OUTSIDE_KEY;
    return morton_key((uint32_t)cell_x(c, cell), (uint32_t)cell_y(c, cell));
}

/* Bits that tell the keys in use apart, with one more so that OUTSIDE_KEY stays last. */
static int key_bits(const struct cells *c)
{
    int bits = 1;
    while ((1 << bits) < c->nx || (1 << bits) < c->ny) bits++;
    return 2 * bits + 1;
}

/* Where each digit of each thread's share begins in the sorted order. */
static void digit_starts(int64_t (*histogram)[DIGITS], int threads)
{
    int64_t sum = 0;
    for (int digit = 0; digit < DIGITS; digit++) {
        for (int t = 0; t < threads; t++) {
            const int64_t count = histogram[t][digit];
            histogram[t][digit] = sum;
            sum += count;
        }
    }
}

/* One stable counting pass over a digit of the keys, which lie in the upper half of each word. */
static void radix_pass(const uint64_t *from, uint64_t *to, int64_t n, int shift,
                       int64_t (*histogram)[DIGITS], int threads)
{
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int t = 0; t < threads; t++) {
        memset(histogram[t], 0, sizeof histogram[t]);
        for (int64_t k = n * t / threads; k < n * (t + 1) / threads; k++)
            histogram[t][(from[k] >> shift) & (DIGITS - 1)]++;
    }
    digit_starts(histogram, threads);
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int t = 0; t < threads; t++)
        for (int64_t k = n * t / threads; k < n * (t + 1) / threads; k++)
            to[histogram[t][(from[k] >> shift) & (DIGITS - 1)]++] = from[k];
}

/* Sorts c->pair_a by key and then into clusters; returns where the result lies. Bits do not depend on
 * threads. */
static const uint64_t *sort_pairs(struct cells *c, int64_t n, const struct particles *p)
{
    const int threads = c->sort_threads < sort_threads() ? c->sort_threads : sort_threads();
    uint64_t *from = c->pair_a, *to = c->pair_b;
    for (int shift = 32; shift < 32 + key_bits(c); shift += DIGIT_BITS) {
        radix_pass(from, to, n, shift, c->histogram, threads);
        uint64_t *const swap = from;
        from = to;
        to = swap;
    }
    cells_order(from, n, p, threads);
    return from;
}

static void list_clear(struct cell_list *list)
{
#pragma omp parallel for schedule(static)
    for (int32_t k = 0; k < list->n_active; k++) list->count[list->active[k]] = 0;
    list->n_active = 0;
}

/* The cell of the particle at place k of n in cell order; none behind the last. */
static int32_t cell_at_place(const struct cell_list *list, const int32_t *cell, int64_t n,
                             int64_t k)
{
    if (k < 0 || k >= n) return OUTSIDE;
    return cell[list->order ? list->order[k] : k];
}

/* A number of cells and of the clusters in them. */
struct tally {
    int32_t cells, clusters;
};

/* Enters the cells that begin in a share of the places, from `at` on among the active ones and their
 * clusters; returns what they come to. Without `enter` they are only counted. */
static struct tally cells_of_chunk(struct cell_list *list, const int32_t *cell, int64_t n,
                                   int64_t first, int64_t end, struct tally at, bool enter)
{
    struct tally found = {0, 0};
    for (int64_t k = first; k < end; k++) {
        const int32_t c = cell_at_place(list, cell, n, k);
        if (c == OUTSIDE) break;
        if (cell_at_place(list, cell, n, k - 1) == c) continue;
        int64_t behind = k + 1;
        while (cell_at_place(list, cell, n, behind) == c) behind++;
        if (enter) {
            list->start[c] = (int32_t)k;
            list->count[c] = (int32_t)(behind - k);
            list->cluster[c] = at.clusters + found.clusters;
            list->active[at.cells + found.cells] = c;
        }
        found.cells++;
        found.clusters += (int32_t)((behind - k + CLUSTER - 1) / CLUSTER);
    }
    return found;
}

/* Ranges, clusters and active cells from the cells of the particles in cell order. */
static void list_fill(struct cell_list *list, const int32_t *cell, int64_t n)
{
    const int threads = sort_threads();
    struct tally found[CELLS_SORT_THREADS], sum = {0, 0};
    list_clear(list);
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int t = 0; t < threads; t++)
        found[t] =
            cells_of_chunk(list, cell, n, n * t / threads, n * (t + 1) / threads, sum, false);
    for (int t = 0; t < threads; t++) {
        const struct tally own = found[t];
        found[t] = sum;
        sum.cells += own.cells;
        sum.clusters += own.clusters;
    }
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int t = 0; t < threads; t++)
        cells_of_chunk(list, cell, n, n * t / threads, n * (t + 1) / threads, found[t], true);
    list->n_active = sum.cells;
}

int64_t cells_sort(struct cells *c, enum kind kind, struct particles *p)
{
    struct cell_list *list = &c->kind[kind];
    const int64_t n = p->n;
    if (n == 0) return 0;
    for (int axis = 0; axis < 2 && kind == KIND_FLUID; axis++)
        c->crossed[axis] = c->joined[axis] ? carry_over(c, axis, axis ? p->y : p->x, n) : 0;
    int64_t outside = 0;
#pragma omp parallel for schedule(static) reduction(+ : outside)
    for (int64_t k = 0; k < n; k++) {
        p->cell[k] = cell_of(c, p->x[k], p->y[k]);
        c->pair_a[k] = (uint64_t)key_of(c, p->cell[k]) << 32 | (uint64_t)k;
        outside += p->cell[k] == OUTSIDE;
    }
    const uint64_t *const sorted = sort_pairs(c, n, p);
    int32_t *const order = list->order ? list->order : c->permutation;
#pragma omp parallel for schedule(static)
    for (int64_t k = 0; k < n; k++) order[k] = (int32_t)(uint32_t)sorted[k];
    if (!list->order) particles_permute(p, order, n, c->scratch);
    list_fill(list, p->cell, n);
    cells_measure(c, kind, p);
    return outside;
}

void cells_resume(struct cells *c, enum kind kind, struct particles *p)
{
    struct cell_list *list = &c->kind[kind];
    if (list->order) {
        for (int64_t k = 0; k < p->n; k++)
            c->pair_a[k] = (uint64_t)key_of(c, p->cell[k]) << 32 | (uint64_t)k;
        const uint64_t *const sorted = sort_pairs(c, p->n, p);
        for (int64_t k = 0; k < p->n; k++) list->order[k] = (int32_t)(uint32_t)sorted[k];
    }
    list_fill(list, p->cell, p->n);
    cells_measure(c, kind, p);
}
