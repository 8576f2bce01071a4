/* SPDX-License-Identifier: MIT
 * The hash table of cells and the list of points in each. */
#include "base/point_grid.h"

static enum err create_table(struct point_grid *g, int64_t n, struct arena *a, struct diag *d)
{
    uint64_t size = 64;
    while (size < (uint64_t)n) size *= 2;
    g->mask = (uint32_t)(size - 1);
    TRY(arena_array(a, &g->head, size, "grid of points", d));
    TRY(arena_array(a, &g->next, n, "grid of points", d));
    return ERR_OK;
}

enum err point_grid_create(struct point_grid *g, double side, int64_t n, double *x, double *y,
                           struct arena *a, struct diag *d)
{
    *g = (struct point_grid){.side = side, .x = x, .y = y};
    return create_table(g, n, a, d);
}

void point_grid_clear(struct point_grid *g)
{
    memset(g->head, 0, ((size_t)g->mask + 1) * sizeof *g->head);
}

static enum err grow(struct point_grid *g, struct arena *a, struct diag *d)
{
    const int64_t capacity = g->capacity ? 2 * g->capacity : 256;
    if (capacity > INT32_MAX / 2)
        return diag_fail(d, ERR_INPUT,
                         "more than %g points along curved or slanted edges; use a larger dp or "
                         "shorter edges",
                         1e9);
    double *const x = arena_alloc(a, (size_t)capacity, sizeof *x, "grid of points", d);
    double *const y = arena_alloc(a, (size_t)capacity, sizeof *y, "grid of points", d);
    if (!x || !y) return ERR_MEMORY;
    for (int64_t k = 0; k < g->n; k++) x[k] = g->x[k], y[k] = g->y[k];
    g->x = x;
    g->y = y;
    g->capacity = capacity;
    TRY(create_table(g, capacity, a, d));
    for (int64_t k = 0; k < g->n; k++) point_grid_insert(g, k);
    return ERR_OK;
}

enum err point_grid_add(struct point_grid *g, double x, double y, struct arena *a, struct diag *d)
{
    if (g->n == g->capacity) TRY(grow(g, a, d));
    g->x[g->n] = x;
    g->y[g->n] = y;
    point_grid_insert(g, g->n++);
    return ERR_OK;
}
