/* SPDX-License-Identifier: MIT
 * Cell list in Morton order: where a particle lies in memory and who its neighbours are. */
#ifndef SPHFSI_PARTICLES_CELLS_H
#define SPHFSI_PARTICLES_CELLS_H

#include "particles/particles.h"

/* By how much particles hang over the left, right, lower and upper edges of their cells, m; negative: they
 * keep off them. */
struct overhang {
    double by[4];
};

/* Most particles of one kind in a cell, where some twenty belong. More than this means particles have
 * collapsed onto each other: a guard stops the run before. And particles near each other that sweeps take
 * together. */
enum { CELL_CAPACITY = 320, CLUSTER = 4 };

/* The particles of one kind by cell. Cells are numbered cy * nx + cx. */
struct cell_list {
    int32_t *start, *count; /* [nx * ny]: range in cell order; count 0: empty */
    int32_t *cluster; /* [nx * ny]: number of the cell's first cluster among all of its kind */
    int32_t *active;  /* cells that hold particles, in Morton order */
    int32_t n_active;
    struct overhang most; /* the largest over all cells, when last measured */
    int32_t *order;       /* particle at each place of the cell order; fluid is kept sorted in
                               memory, so that there place = particle and order is NULL */
};

/* Bits of a digit of the radix sort. */
enum { CELLS_SORT_DIGIT_BITS = 11 };

/* Most threads that sort; where there are more, one does. */
enum { CELLS_SORT_THREADS = 256 };

/* A grid of cells wider than the interaction reaches, by less in a narrow domain. */
struct cells {
    double lower[2], side[2]; /* m */
    double stray;             /* m, from their cells, before particles have to be sorted again */
    int nx, ny;
    bool joined[2]; /* the opposite sides in x, in y are one: periodic */
    int64_t crossed
        [2]; /* times that fluid left through an upper side, less a lower, at the last sort */
    struct cell_list kind[KIND_COUNT];
    uint64_t *pair_a, *pair_b; /* sorting scratch, (Morton key, particle) in one word */
    int64_t (*histogram)[1 << CELLS_SORT_DIGIT_BITS]; /* [sort_threads] */
    int sort_threads;
    int32_t *permutation;
    void *scratch; /* 8 bytes for each particle of the largest kind */
};

/* Lays the grid over [lower, upper) for pairs within `reach` and particles that may stray by up to `stray`
 * (less in a narrow domain), and makes room for the kinds' capacities. */
enum err cells_create(struct cells *c, struct arena *a, const double lower[2],
                      const double upper[2], double reach, double stray,
                      const struct particles kinds[KIND_COUNT], struct diag *d) SPHFSI_CHECKED;

/* Joins the opposite sides along an axis; a cell must not meet another one twice: three of them. */
enum err cells_join(struct cells *c, int axis, double reach, struct diag *d) SPHFSI_CHECKED;

/* Sorts the particles of one kind into cells, by Morton key and then into clusters of neighbours
 * (particles/cells_order.c); the fluid itself is permuted. Particles outside the grid come last, by
 * id, and are left out: their number is returned, and p->n counts them still (they are at p->n - lost
 * ... p->n - 1 of a fluid). Non-finite positions count as outside. */
int64_t cells_sort(struct cells *c, enum kind kind, struct particles *p);

/* Builds the cell list of particles that are sorted already, from their `cell` fields (restart). */
void cells_resume(struct cells *c, enum kind kind, struct particles *p);

/* Orders the particles of each cell in `pair` (Morton key, particle), sorted by key already, so that every
 * four in a row lie close together. */
void cells_order(uint64_t *pair, int64_t n, const struct particles *p, int threads);

/* Measures by how much the particles of a kind hang over their cells' edges now. */
void cells_measure(struct cells *c, enum kind kind, const struct particles *p);

/* What a fluid particle and any other may go together, m, from where they were last measured, until they can
 * come within `reach` of each other in cells that do not touch; 0 or less: that may be so already. */
double cells_skin_left(const struct cells *c, double reach);

SPHFSI_INLINE int cell_x(const struct cells *c, int32_t cell) { return cell % c->nx; }
SPHFSI_INLINE int cell_y(const struct cells *c, int32_t cell) { return cell / c->nx; }

/* A column (axis 0) or row up to one step beyond the grid, brought through joined sides; -1: none. */
SPHFSI_INLINE int cells_place(const struct cells *c, int axis, int place)
{
    const int n = axis ? c->ny : c->nx;
    if (place >= 0 && place < n) return place;
    if (!c->joined[axis]) return -1;
    return place < 0 ? place + n : place - n;
}

/* The cell at (cx, cy), up to one step beyond the grid; -1: there is none. */
SPHFSI_INLINE int32_t cell_at(const struct cells *c, int cx, int cy)
{
    const int x = cells_place(c, 0, cx), y = cells_place(c, 1, cy);
    return x < 0 || y < 0 ? -1 : y * c->nx + x;
}

/* Most clusters of one kind that n particles can fill. */
SPHFSI_INLINE int64_t cells_clusters(const struct cells *c, int64_t n)
{
    const int64_t cells = (int64_t)c->nx * c->ny;
    return n / CLUSTER + (n < cells ? n : cells);
}

/* Clusters of one kind in a cell; the last one need not be full. */
SPHFSI_INLINE int32_t clusters_in(const struct cell_list *list, int32_t cell)
{
    return (list->count[cell] + CLUSTER - 1) / CLUSTER;
}

/* A difference of positions along an axis, the short way round through joined sides. */
SPHFSI_INLINE double cells_short_way(const struct cells *c, int axis, double difference)
{
    if (!c->joined[axis]) return difference;
    const double period = c->side[axis] * (axis ? c->ny : c->nx);
    return difference - period * __builtin_floor(difference / period + 0.5);
}

/* Centre of a cell. */
SPHFSI_INLINE double cell_centre_x(const struct cells *c, int32_t cell)
{
    return c->lower[0] + ((double)cell_x(c, cell) + 0.5) * c->side[0];
}
SPHFSI_INLINE double cell_centre_y(const struct cells *c, int32_t cell)
{
    return c->lower[1] + ((double)cell_y(c, cell) + 0.5) * c->side[1];
}

/* Whether a position is no further from a cell than half of a side, which no particle strays. */
SPHFSI_INLINE bool cells_near(const struct cells *c, int32_t cell, double x, double y)
{
    const double dx = cells_short_way(c, 0, x - cell_centre_x(c, cell)) / c->side[0],
                 dy = cells_short_way(c, 1, y - cell_centre_y(c, cell)) / c->side[1];
    return dx >= -1 && dx <= 1 && dy >= -1 && dy <= 1;
}

#endif
