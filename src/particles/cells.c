/* SPDX-License-Identifier: MIT
 * Sorts particles into cells, and measures how far they are outside of theirs. */
#include "particles/cells.h"
#include "base/threads.h"

/* A particle outside the grid is sorted after all cells. */
enum { OUTSIDE = -1 };
#define OUTSIDE_KEY UINT32_MAX

enum { DIGIT_BITS = CELLS_SORT_DIGIT_BITS, DIGITS = 1 << DIGIT_BITS };

/* All threads or one: libgomp would end and restart threads if teams changed in size. */
static int sort_threads(void) { return thread_count() <= CELLS_SORT_THREADS ? thread_count() : 1; }

static enum err list_create(struct cell_list *list, struct arena *a, const struct cells *cells,
                            const struct particles *particles, bool keep_order, struct diag *d)
{
    char what[80];
    snprintf(what, sizeof what, "cell list of the [domain], %d x %d cells", cells->nx, cells->ny);
    const size_t n_cells = (size_t)cells->nx * (size_t)cells->ny;
    TRY(arena_array(a, &list->start, n_cells, what, d));
    TRY(arena_array(a, &list->count, n_cells, what, d));
    TRY(arena_array(a, &list->cluster, n_cells, what, d));
    TRY(arena_array(a, &list->active, particles->capacity, "cell list", d));
    if (!keep_order) return ERR_OK;
    TRY(arena_array(a, &list->order, particles->capacity, "cell list", d));
    return ERR_OK;
}

/* Side of a cell over the reach, as nearly as whole squares of SQUARE x SQUARE particles of a
 * lattice allow: these form clusters that are squares, too, which have fewest neighbours. In wider
 * cells each cluster tests more boxes; in narrower ones more clusters are only partly filled. */
#define SIDE 1.6
#define LEAST_SIDE 1.05
enum { SQUARE = 4 };

enum err cells_create(struct cells *cells, struct arena *a, const double lower[2],
                      const double upper[2], double dp, double reach, double skin,
                      const struct particles kinds[KIND_COUNT], struct diag *d)
{
    memset(cells, 0, sizeof *cells);
    cells->skin = skin;
    double n[2];
    const double side = SQUARE * dp * max2(1, round(SIDE * reach / (SQUARE * dp)));
    for (int k = 0; k < 2; k++) {
        cells->lower[k] = lower[k];
        const double width = upper[k] - lower[k], most = floor(width / (LEAST_SIDE * reach));
        n[k] = max2(1, min2(most, max2(3, round(width / side))));
        if (!(n[k] <= MORTON_CELLS))
            return diag_fail(
                d, ERR_INPUT,
                "the domain is %.6g m in %c, more than %d cells of %.3g m; make [domain] "
                "smaller or dp larger",
                width, k ? 'y' : 'x', MORTON_CELLS, side);
        cells->side[k] = width / n[k];
        cells->skin = min2(cells->skin, max2(0, 0.5 * (cells->side[k] - reach)));
    }
    cells->nx = (int)n[0];
    cells->ny = (int)n[1];
    if (n[0] * n[1] > INT32_MAX)
        return diag_fail(d, ERR_INPUT,
                         "the domain has %d x %d cells, more than %d; make [domain] smaller or dp "
                         "larger",
                         cells->nx, cells->ny, INT32_MAX);

    int64_t most = 0;
    for (int k = 0; k < KIND_COUNT; k++) {
        if (kinds[k].capacity == 0) continue;
        if (kinds[k].capacity > most) most = kinds[k].capacity;
        TRY(list_create(&cells->list[k], a, cells, &kinds[k], k != KIND_FLUID, d));
    }
    TRY(arena_array(a, &cells->pair_a, most, "sorting", d));
    TRY(arena_array(a, &cells->pair_b, most, "sorting", d));
    TRY(arena_array(a, &cells->permutation, most, "sorting", d));
    TRY(arena_place(a, &cells->scratch, (size_t)most, 8, "sorting", d));
    cells->sort_threads = sort_threads();
    TRY(arena_array(a, &cells->histogram, cells->sort_threads, "sorting", d));
    return ERR_OK;
}

enum err cells_make_periodic(struct cells *cells, int axis, double reach, struct diag *d)
{
    const int n = axis ? cells->ny : cells->nx;
    if (n < 3)
        return diag_fail(
            d, ERR_INPUT,
            "[domain] is periodic in %c and only %.6g m wide there; at least %.6g m is "
            "needed, so that no particle interacts twice with another",
            "xy"[axis], n * cells -> side[axis], 3 * LEAST_SIDE * reach);
    cells->periodic[axis] = true;
    return ERR_OK;
}

/* Coordinate along an axis in units of cells, wrapped if the axis is periodic. */
static double cells_along(const struct cells *cells, int axis, double x)
{
    double at = (x - cells->lower[axis]) / cells->side[axis];
    if (!cells->periodic[axis]) return at;
    const double n = axis ? cells->ny : cells->nx;
    at -= n * floor(at / n);
    return at < n ? at : 0; /* just below the lower side rounding gives n */
}

/* Wraps coordinates into the periodic domain; returns crossings of its upper less lower side. */
static int64_t wrap_positions(const struct cells *cells, int axis, double *x, int64_t n)
{
    const double lower = cells->lower[axis],
                 period = cells->side[axis] * (axis ? cells->ny : cells->nx);
    int64_t crossings = 0;
#pragma omp parallel for schedule(static) reduction(+ : crossings)
    for (int64_t k = 0; k < n; k++) {
        const double periods = floor((x[k] - lower) / period);
        if (periods == 0 || !isfinite(periods)) continue;
        x[k] = max2(lower, x[k] - periods * period);
        if (!(x[k] < lower + period)) x[k] = lower;
        crossings += (int64_t)periods;
    }
    return crossings;
}

static int32_t cell_of(const struct cells *cells, double x, double y)
{
    const double fx = cells_along(cells, 0, x), fy = cells_along(cells, 1, y);
    if (!(fx >= 0 && fx < cells->nx && fy >= 0 && fy < cells->ny)) return OUTSIDE;
    return (int32_t)fy * cells->nx + (int32_t)fx;
}

/* Significant bits of the keys in use, and one more so that OUTSIDE_KEY stays last. */
static int key_bits(const struct cells *cells)
{
    int bits = 1;
    while ((1 << bits) < cells->nx || (1 << bits) < cells->ny) bits++;
    return 2 * bits + 1;
}

/* One stable counting sort by a digit of the keys, which are the upper halves of the words. */
static void radix_pass(const uint64_t *from, uint64_t *to, int64_t n, int shift,
                       int64_t (*histogram)[DIGITS], int threads)
{
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int t = 0; t < threads; t++) {
        memset(histogram[t], 0, sizeof histogram[t]);
        for (int64_t k = n * t / threads; k < n * (t + 1) / threads; k++)
            histogram[t][(from[k] >> shift) & (DIGITS - 1)]++;
    }
    /* Counts become the starts of each digit and thread in the output. */
    int64_t sum = 0;
    for (int digit = 0; digit < DIGITS; digit++)
        for (int t = 0; t < threads; t++) {
            const int64_t count = histogram[t][digit];
            histogram[t][digit] = sum;
            sum += count;
        }
    ASSERT(sum == n);
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int t = 0; t < threads; t++)
        for (int64_t k = n * t / threads; k < n * (t + 1) / threads; k++)
            to[histogram[t][(from[k] >> shift) & (DIGITS - 1)]++] = from[k];
}

/* Sorts c->pair_a by key and then into clusters; returns the sorted array, c->pair_a or
 * c->pair_b. The result does not depend on the number of threads. */
static const uint64_t *sort_pairs(struct cells *cells, int64_t n, const struct particles *particles)
{
    const int threads = cells->sort_threads < sort_threads() ? cells->sort_threads : sort_threads();
    uint64_t *from = cells->pair_a, *to = cells->pair_b;
    for (int shift = 32; shift < 32 + key_bits(cells); shift += DIGIT_BITS) {
        radix_pass(from, to, n, shift, cells->histogram, threads);
        uint64_t *const swap = from;
        from = to;
        to = swap;
    }
    cells_order(from, n, particles, threads);
    return from;
}

/* Start, count and first cluster of each cell, and the active cells, from the cells of the
 * particles, of which those outside the grid come last. */
static void list_fill(struct cell_list *list, const int32_t *cell, int64_t n)
{
    int32_t last = OUTSIDE, clusters = 0;
    for (int32_t k = 0; k < list->n_active; k++) list->count[list->active[k]] = 0;
    list->n_active = 0;
    for (int64_t k = 0; k < n; k++) {
        const int32_t c = cell[list->order ? list->order[k] : k];
        if (c == OUTSIDE) break;
        if (c != last) {
            if (last != OUTSIDE) clusters += clusters_in(list, last);
            list->start[c] = (int32_t)k;
            list->cluster[c] = clusters;
            list->active[list->n_active++] = c;
        }
        list->count[c]++;
        last = c;
    }
}

/* How far the particles of a cell extend beyond its edges. */
static void overhang_of(const struct cells *cells, const struct cell_list *list,
                        const struct particles *particles, int32_t cell, double side[4])
{
    const double left = cells->lower[0] + cell_x(cells, cell) * cells->side[0],
                 bottom = cells->lower[1] + cell_y(cells, cell) * cells->side[1];
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int32_t k = list->start[cell]; k < list->start[cell] + list->count[cell]; k++) {
        const int32_t i = list->order ? list->order[k] : k;
        low[0] = min2(low[0], particles->x[i]);
        high[0] = max2(high[0], particles->x[i]);
        low[1] = min2(low[1], particles->y[i]);
        high[1] = max2(high[1], particles->y[i]);
    }
    side[0] = left - low[0];
    side[1] = high[0] - left - cells->side[0];
    side[2] = bottom - low[1];
    side[3] = high[1] - bottom - cells->side[1];
}

void cells_measure_overhang(struct cells *cells, enum kind kind, const struct particles *particles)
{
    struct cell_list *const list = &cells->list[kind];
    double most[] = {-INFINITY, -INFINITY, -INFINITY, -INFINITY};
#pragma omp parallel for schedule(static) reduction(max : most)
    for (int32_t k = 0; k < list->n_active; k++) {
        double own[4];
        overhang_of(cells, list, particles, list->active[k], own);
        for (int side = 0; side < 4; side++) most[side] = max2(most[side], own[side]);
    }
    /* Particles in no cell come last. One that is back in the grid needs a cell. */
    const int32_t *const last = list->n_active ? &list->active[list->n_active - 1] : NULL;
    for (int64_t k = last ? list->start[*last] + list->count[*last] : 0; k < particles->n; k++) {
        const int64_t i = list->order ? list->order[k] : k;
        if (cell_of(cells, particles->x[i], particles->y[i]) != OUTSIDE) most[0] = INFINITY;
    }
    memcpy(list->overhang, most, sizeof most);
}

/* Sweeps visit pairs in neighbouring cells only. Two particles of other cells can be within reach
 * only if their overhangs add up to more than the cells' side exceeds the reach. */
double cells_skin_left(const struct cells *cells, double reach)
{
    const double *const fluid = cells->list[KIND_FLUID].overhang;
    double left = INFINITY;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const double *const other = cells->list[kind].overhang;
        if (!cells->list[kind].n_active && !(other[0] > 0)) continue;
        for (int to = 0; to < 4; to++) { /* to ^ 1: the opposite */
            const double excess = cells->side[to / 2] - reach;
            left = min2(left, cells->skin - other[to]);
            left = min2(left, excess - (fluid[to] + other[to ^ 1]));
        }
    }
    return left;
}

/* Particles in the order of their cells; returns it. */
static const int32_t *sort_by_cell(struct cells *cells, const struct cell_list *list,
                                   const struct particles *particles)
{
    int32_t *const order = list->order ? list->order : cells->permutation;
#pragma omp parallel for schedule(static)
    for (int64_t k = 0; k < particles->n; k++) {
        const int32_t at = particles->cell[k];
        const uint32_t x = (uint32_t)cell_x(cells, at), y = (uint32_t)cell_y(cells, at);
        const uint32_t key = at == OUTSIDE ? OUTSIDE_KEY : morton_key(x, y);
        cells->pair_a[k] = (uint64_t)key << 32 | (uint64_t)k;
    }
    const uint64_t *const sorted = sort_pairs(cells, particles->n, particles);
#pragma omp parallel for schedule(static)
    for (int64_t k = 0; k < particles->n; k++) order[k] = (int32_t)(uint32_t)sorted[k];
    return order;
}

int64_t cells_sort(struct cells *cells, enum kind kind, struct particles *particles)
{
    struct cell_list *list = &cells->list[kind];
    const int64_t n = particles->n;
    if (n == 0) return 0;
    if (kind == KIND_FLUID)
        for (int axis = 0; axis < 2; axis++)
            cells->crossings[axis] =
                cells->periodic[axis]
                    ? wrap_positions(cells, axis, axis ? particles->y : particles->x, n)
                    : 0;
    int64_t outside = 0;
#pragma omp parallel for schedule(static) reduction(+ : outside)
    for (int64_t k = 0; k < n; k++) {
        particles->cell[k] = cell_of(cells, particles->x[k], particles->y[k]);
        outside += particles->cell[k] == OUTSIDE;
    }
    const int32_t *const order = sort_by_cell(cells, list, particles);
    if (!list->order) particles_permute(particles, order, n, cells->scratch);
    list_fill(list, particles->cell, n);
    cells_measure_overhang(cells, kind, particles);
    return outside;
}

void cells_rebuild(struct cells *cells, enum kind kind, struct particles *particles)
{
    struct cell_list *list = &cells->list[kind];
    if (list->order) sort_by_cell(cells, list, particles);
    list_fill(list, particles->cell, particles->n);
    cells_measure_overhang(cells, kind, particles);
}

int32_t cells_fullest(const struct cells *cells)
{
    int32_t fullest = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const struct cell_list *const list = &cells->list[kind];
        for (int32_t k = 0; k < list->n_active; k++)
            if (list->count[list->active[k]] > fullest) fullest = list->count[list->active[k]];
    }
    return fullest;
}
