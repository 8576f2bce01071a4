/* SPDX-License-Identifier: MIT
 * Cell list in Morton order: it sorts the particles in memory and finds neighbours. */
#pragma once

#include "particles/particles.h"

/* --- Morton (Z-order) keys: cells close to each other in the plane have close keys --- */

/* Largest number of cells along an axis: 16 bits each. */
enum { MORTON_CELLS = 1 << 16 };

/* Spreads the low 16 bits of v to the even bits. */
SPHFSI_INLINE uint32_t morton_spread(uint32_t v)
{
    v = (v | (v << 8)) & 0x00ff00ffu;
    v = (v | (v << 4)) & 0x0f0f0f0fu;
    v = (v | (v << 2)) & 0x33333333u;
    return (v | (v << 1)) & 0x55555555u;
}

SPHFSI_INLINE uint32_t morton_key(uint32_t cx, uint32_t cy)
{
    return morton_spread(cx) | (morton_spread(cy) << 1);
}

/* --- cells --- */

/* Most particles of one kind in a cell. Some twenty are normal, some 370 of a solid at a quarter of
 * the fluid's spacing. With more, particles have collapsed, and a guard stops the run. */
enum { CELL_CAPACITY = 480 };

/* Particles that sweeps process together. */
enum { CLUSTER = 4 };

/* The particles of one kind by cell. Cells are numbered cy * nx + cx. */
struct cell_list {
    int32_t *start, *count; /* [nx * ny]: range in cell order; count 0: empty */
    int32_t *cluster; /* [nx * ny]: number of the cell's first cluster among all of its kind */
    int32_t *active;  /* cells that hold particles, in Morton order */
    int32_t n_active;
    /* How far particles extended beyond the left, right, lower and upper edges of their cells at
     * the last measurement, m; negative: the distance to the edge. */
    double overhang[4];
    int32_t
        *order; /* [capacity]: particles in cell order; NULL for fluid, which is sorted itself */
};

enum {
    CELLS_SORT_DIGIT_BITS = 11, /* of the radix sort */
    CELLS_SORT_THREADS = 256    /* with more threads than this, one sorts */
};

/* A grid of cells whose sides exceed the reach of interactions. */
struct cells {
    double lower[2], side[2]; /* m */
    double skin; /* m; particles are sorted again before one is this far outside its cell */
    int nx, ny;
    bool periodic[2];     /* in x, in y */
    int64_t crossings[2]; /* of fluid through the upper side, less the lower, in the last sort */
    struct cell_list list[KIND_COUNT];
    uint64_t *pair_a, *pair_b; /* sorting scratch, (Morton key, particle) in one word */
    int64_t (*histogram)[1 << CELLS_SORT_DIGIT_BITS]; /* [sort_threads] */
    int sort_threads;
    int32_t *permutation;
    void *scratch; /* 8 bytes for each particle of the largest kind */
};

/* Creates the grid over [lower, upper) for interactions within `reach` of particles `dp` apart, and
 * allocates lists for the capacities of the kinds. `skin` is less where cells are narrow. */
enum err cells_create(struct cells *cells, struct arena *a, const double lower[2],
                      const double upper[2], double dp, double reach, double skin,
                      const struct particles kinds[KIND_COUNT], struct diag *d) SPHFSI_CHECKED;

/* Makes an axis periodic. It needs three cells, so that no two cells are neighbours twice. */
enum err cells_make_periodic(struct cells *cells, int axis, double reach, struct diag *d)
    SPHFSI_CHECKED;

/* Sorts the particles of one kind by the Morton key of their cell, then into clusters of close
 * particles (particles/cells_order.c), and builds the cell list. Fluid is permuted in memory.
 * Returns the number of particles outside the grid (or at a non-finite position): they come
 * last, by id, in no cell, and p->n still counts them. */
int64_t cells_sort(struct cells *cells, enum kind kind, struct particles *particles);

/* Builds the cell list of particles that are already sorted, from their `cell` fields (restart). */
void cells_rebuild(struct cells *cells, enum kind kind, struct particles *particles);

/* Orders the particles of each cell into clusters; `pair`: (Morton key, particle), sorted. */
void cells_order(uint64_t *pair, int64_t n, const struct particles *particles, int threads);

/* Most particles of any kind in one cell. */
int32_t cells_fullest(const struct cells *cells);

/* Measures the present overhang of a kind. */
void cells_measure_overhang(struct cells *cells, enum kind kind, const struct particles *particles);

/* How far, m, a fluid particle and another may move, both together, from where they were measured.
 * Then they can be within `reach` without being in neighbouring cells. 0 or less: sort now. */
double cells_skin_left(const struct cells *cells, double reach);

SPHFSI_INLINE int cell_x(const struct cells *cells, int32_t cell) { return cell % cells->nx; }
SPHFSI_INLINE int cell_y(const struct cells *cells, int32_t cell) { return cell / cells->nx; }

/* A column (axis 0) or row, up to one step outside the grid, wrapped if periodic; -1: none. */
SPHFSI_INLINE int cells_wrap(const struct cells *cells, int axis, int index)
{
    const int n = axis ? cells->ny : cells->nx;
    ASSERT(index >= -1 && index <= n);
    if (index >= 0 && index < n) return index;
    if (!cells->periodic[axis]) return -1;
    return index < 0 ? index + n : index - n;
}

/* The cell at (cx, cy), up to one step outside the grid; -1: none. */
SPHFSI_INLINE int32_t cell_at(const struct cells *cells, int cx, int cy)
{
    const int x = cells_wrap(cells, 0, cx), y = cells_wrap(cells, 1, cy);
    return x < 0 || y < 0 ? -1 : y * cells->nx + x;
}

/* Most clusters of one kind that n particles can fill. */
SPHFSI_INLINE int64_t cells_clusters(const struct cells *cells, int64_t n)
{
    const int64_t most = (int64_t)cells->nx * cells->ny;
    return n / CLUSTER + (n < most ? n : most);
}

/* Clusters of one kind in a cell; the last one may be partly filled. */
SPHFSI_INLINE int32_t clusters_of_count(int32_t count) { return (count + CLUSTER - 1) / CLUSTER; }
SPHFSI_INLINE int32_t clusters_in(const struct cell_list *list, int32_t cell)
{
    return clusters_of_count(list->count[cell]);
}

/* Minimum image: the smallest difference of positions along an axis, if it is periodic. */
SPHFSI_INLINE double cells_minimum_image(const struct cells *cells, int axis, double difference)
{
    if (!cells->periodic[axis]) return difference;
    const double period = cells->side[axis] * (axis ? cells->ny : cells->nx);
    return difference - period * __builtin_floor(difference / period + 0.5);
}

/* The shift of periodic image m, m; false: there is none. */
enum { CELLS_IMAGES = 9 };
SPHFSI_INLINE bool cells_image(const struct cells *cells, int m, double shift[2])
{
    const int times[2] = {m % 3 - 1, m / 3 - 1};
    for (int c = 0; c < 2; c++) {
        if (times[c] && !cells->periodic[c]) return false;
        shift[c] = times[c] * cells->side[c] * (c ? cells->ny : cells->nx);
    }
    return true;
}

/* Centre of a cell. */
SPHFSI_INLINE double cell_centre_x(const struct cells *cells, int32_t cell)
{
    return cells->lower[0] + ((double)cell_x(cells, cell) + 0.5) * cells->side[0];
}
SPHFSI_INLINE double cell_centre_y(const struct cells *cells, int32_t cell)
{
    return cells->lower[1] + ((double)cell_y(cells, cell) + 0.5) * cells->side[1];
}

/* Whether a place is within half a side of a cell: none moves further between sorts. */
SPHFSI_INLINE bool cells_is_near(const struct cells *cells, int32_t cell, double x, double y)
{
    const double dx = cells_minimum_image(cells, 0, x - cell_centre_x(cells, cell));
    const double dy = cells_minimum_image(cells, 1, y - cell_centre_y(cells, cell));
    return __builtin_fabs(dx) <= cells->side[0] && __builtin_fabs(dy) <= cells->side[1];
}

/* The cells, n[0] x n[1] from `first` on, of particles nearer to a point than `distance`, although
 * they may have moved by the skin since they were sorted. */
struct cell_window {
    int first[2], n[2];
};

SPHFSI_INLINE struct cell_window cells_window(const struct cells *cells, const double at[2],
                                              double distance)
{
    struct cell_window w;
    for (int axis = 0; axis < 2; axis++) {
        const int count = axis ? cells->ny : cells->nx;
        const double place = (at[axis] - cells->lower[axis]) / cells->side[axis],
                     part = (distance + cells->skin) / cells->side[axis];
        w.first[axis] = (int)max2(-1, min2(count, __builtin_floor(place - part)));
        w.n[axis] = (int)max2(-1, min2(count, __builtin_floor(place + part))) - w.first[axis] + 1;
        if (cells->periodic[axis] && w.n[axis] > count) w.n[axis] = count;
    }
    return w;
}

/* The m-th cell of a window; -1: outside the grid. */
SPHFSI_INLINE int32_t window_cell(const struct cells *cells, const struct cell_window *w, int m)
{
    return cell_at(cells, w->first[0] + m % w->n[0], w->first[1] + m / w->n[0]);
}

/* The particles of the kinds from `kind` to the one before `end_kind` that are nearer to a point
 * than `distance`. While cells_next gives true, v.i is the next of v.particles, which are of
 * v.kind. `at` outlives the visit. */
struct cell_visit {
    const struct cells *cells;
    const struct particles *particles;
    const double *at;
    double distance;
    int kind, end_kind;
    struct cell_window window;
    int m;          /* the next cell of the window */
    int32_t k, end; /* the next place in the present cell, and its end */
    int64_t i;
    double x, y, r; /* vector from the point to particle i, and its length, m */
};

SPHFSI_INLINE struct cell_visit cells_visit(const struct cells *cells,
                                            const struct particles kinds[], int kind, int end_kind,
                                            const double at[2], double distance)
{
    struct cell_visit v = {cells, &kinds[kind], at, distance, kind, end_kind, .m = 0};
    v.window = cells_window(cells, at, distance);
    return v;
}

SPHFSI_INLINE bool cells_next(struct cell_visit *v)
{
    for (; v->kind < v->end_kind; v->kind++, v->particles++, v->m = 0) {
        const struct cell_list *const list = &v->cells->list[v->kind];
        while (list->n_active) {
            if (v->k == v->end) {
                if (v->m == v->window.n[0] * v->window.n[1]) break;
                const int32_t cell = window_cell(v->cells, &v->window, v->m++);
                v->k = cell < 0 ? 0 : list->start[cell];
                v->end = cell < 0 ? 0 : v->k + list->count[cell];
                continue;
            }
            v->i = list->order ? list->order[v->k] : v->k;
            v->k++;
            v->x = cells_minimum_image(v->cells, 0, v->particles->x[v->i] - v->at[0]);
            v->y = cells_minimum_image(v->cells, 1, v->particles->y[v->i] - v->at[1]);
            const double r2 = square(v->x) + square(v->y);
            if (r2 < square(v->distance)) return v->r = __builtin_sqrt(r2), true;
        }
    }
    return false;
}
