/* SPDX-License-Identifier: MIT
 * Points in square cells, in a hash table: sparse scenes need no more memory than dense ones. */
#pragma once

#include "base/hash.h"

struct point_grid {
    double side;   /* of a cell, m */
    double *x, *y; /* of all points by index: the caller's, or the grid's own with point_grid_add */
    int64_t n, capacity; /* of point_grid_add */
    uint32_t mask;
    int32_t *head, *next; /* index + 1; 0: none */
};

/* An empty grid for n points, whose positions the caller has; `side` is set before insertions. */
enum err point_grid_create(struct point_grid *g, double side, int64_t n, double *x, double *y,
                           struct arena *a, struct diag *d) SPHFSI_CHECKED;
void point_grid_clear(struct point_grid *g);
/* Adds a point with its position; begin with a grid that is zero but for its side. */
enum err point_grid_add(struct point_grid *g, double x, double y, struct arena *a, struct diag *d)
    SPHFSI_CHECKED;

SPHFSI_INLINE int64_t point_grid_cell(const struct point_grid *g, double x)
{
    return (int64_t)floor(x / g->side);
}

/* Inserts point k. The last one inserted in a cell is visited first. */
SPHFSI_INLINE void point_grid_insert(struct point_grid *g, int64_t k)
{
    const uint32_t slot =
        hash_cell(point_grid_cell(g, g->x[k]), point_grid_cell(g, g->y[k]), g->mask);
    g->next[k] = g->head[slot];
    g->head[slot] = (int32_t)(k + 1);
}

/* The points nearer to a place than `reach`, each once: for (struct point_visit v =
 * point_grid_visit(g, x, y, reach); point_grid_next(g, &v);) ... v.k ... */
struct point_visit {
    double x, y, reach;
    int64_t i0, i1, j1, i, j; /* cells: bounds, and the present one */
    int32_t following;        /* in the chain, index + 1 */
    int64_t k;
};

SPHFSI_INLINE struct point_visit point_grid_visit(const struct point_grid *g, double x, double y,
                                                  double reach)
{
    if (!g->head) return (struct point_visit){.i = 1, .i1 = 0, .j = 0, .j1 = -1};
    struct point_visit v = {.x = x, .y = y, .reach = reach};
    v.i = v.i0 = point_grid_cell(g, x - reach);
    v.i1 = point_grid_cell(g, x + reach);
    v.j = point_grid_cell(g, y - reach);
    v.j1 = point_grid_cell(g, y + reach);
    v.following = g->head[hash_cell(v.i, v.j, g->mask)];
    return v;
}

SPHFSI_INLINE bool point_grid_next(const struct point_grid *g, struct point_visit *v)
{
    while (v->j <= v->j1) {
        while (v->following) {
            v->k = v->following - 1;
            v->following = g->next[v->k];
            const double x = g->x[v->k], y = g->y[v->k];
            /* Several cells may have the same slot. */
            if (square(x - v->x) + square(y - v->y) < square(v->reach) &&
                point_grid_cell(g, x) == v->i && point_grid_cell(g, y) == v->j)
                return true;
        }
        if (v->i++ == v->i1) {
            v->i = v->i0;
            v->j++;
        }
        if (v->j <= v->j1) v->following = g->head[hash_cell(v->i, v->j, g->mask)];
    }
    return false;
}

/* Whether any point is nearer to a place than `reach`. */
SPHFSI_INLINE bool point_grid_any(const struct point_grid *g, double x, double y, double reach)
{
    struct point_visit v = point_grid_visit(g, x, y, reach);
    return point_grid_next(g, &v);
}
