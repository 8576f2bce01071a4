/* SPDX-License-Identifier: MIT
 * Points by cell, in a hash table: sparse scenes need no more memory than dense ones. */
#ifndef SPHFSI_GEOMETRY_NEAR_H
#define SPHFSI_GEOMETRY_NEAR_H

#include "base/base.h"
#include "base/hash.h"

#include <math.h>

struct near_table {
    double side; /* of a cell, m */
    uint32_t mask;
    int32_t *head, *next; /* index + 1; 0: none */
    const double *x, *y;
};

SPHFSI_INLINE int64_t near_cell(const struct near_table *t, double x)
{
    return (int64_t)floor(x / t->side);
}

/* The first point of a cell, and the one after point n - 1, as index + 1; 0: none. */
SPHFSI_INLINE int32_t near_first(const struct near_table *t, int64_t i, int64_t j)
{
    return t->head[hash_cell(i, j, t->mask)];
}

/* An empty table for n points. */
SPHFSI_INLINE enum err near_create(struct near_table *t, double side, int64_t n, const double *x,
                                   const double *y, struct arena *a, struct diag *d)
{
    uint64_t size = 64;
    while (size < (uint64_t)n) size *= 2;
    *t = (struct near_table){.side = side, .mask = (uint32_t)(size - 1), .x = x, .y = y};
    t->head = arena_alloc(a, size, sizeof *t->head, "neighbours of points", d);
    t->next = arena_alloc(a, (size_t)n, sizeof *t->next, "neighbours of points", d);
    return t->head && t->next ? ERR_OK : ERR_MEMORY;
}

SPHFSI_INLINE void near_insert(struct near_table *t, int64_t k)
{
    const uint32_t slot = hash_cell(near_cell(t, t->x[k]), near_cell(t, t->y[k]), t->mask);
    t->next[k] = t->head[slot];
    t->head[slot] = (int32_t)(k + 1);
}

#endif
