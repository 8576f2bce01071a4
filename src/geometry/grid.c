/* SPDX-License-Identifier: MIT */
#include "geometry/grid.h"

#include <math.h>
#include <string.h>

static uint64_t slot_of(const struct point_grid *t, int64_t i, int64_t j)
{
    uint64_t key = (uint64_t)i * 0x9E3779B97F4A7C15u ^ (uint64_t)j * 0xC2B2AE3D27D4EB4Fu;
    key ^= key >> 29;
    key *= 0xBF58476D1CE4E5B9u;
    return (key >> 32) & t->mask;
}

static void link_point(struct point_grid *t, int64_t k)
{
    const uint64_t slot =
        slot_of(t, (int64_t)floor(t->pt[k][0] / t->side), (int64_t)floor(t->pt[k][1] / t->side));
    t->next[k] = t->head[slot];
    t->head[slot] = (int32_t)(k + 1);
}

static enum err grow(struct point_grid *t, struct sampler *g)
{
    const int64_t capacity = t->capacity ? 2 * t->capacity : 256;
    if (capacity > INT32_MAX / 2)
        return diag_add(g->diag, ERR_INPUT,
                        "%s: dp = %g m needs too many particles along curved or slanted edges; use "
                        "a larger dp or shorter edges",
                        g->scene->path, g->scene->top.dp);
    double(*pt)[2] = arena_alloc(&g->temp, (size_t)capacity, sizeof *pt, "edges", g->diag);
    t->next = arena_alloc(&g->temp, (size_t)capacity, sizeof *t->next, "edges", g->diag);
    t->head = arena_alloc(&g->temp, (size_t)capacity, sizeof *t->head, "edges", g->diag);
    if (!pt || !t->next || !t->head) return ERR_MEMORY;
    if (t->n) memcpy(pt, t->pt, (size_t)t->n * sizeof *pt);
    t->pt = pt;
    t->capacity = capacity;
    t->mask = (uint64_t)capacity - 1;
    for (int64_t k = 0; k < t->n; k++) link_point(t, k);
    return ERR_OK;
}

enum err grid_add(struct point_grid *t, struct sampler *g, double x, double y)
{
    if (t->n == t->capacity) TRY(grow(t, g));
    t->pt[t->n][0] = x;
    t->pt[t->n][1] = y;
    link_point(t, t->n++);
    return ERR_OK;
}

bool grid_any_within(const struct point_grid *t, double x, double y, double distance)
{
    if (t->n == 0) return false;
    const int64_t i0 = (int64_t)floor((x - distance) / t->side),
                  i1 = (int64_t)floor((x + distance) / t->side),
                  j0 = (int64_t)floor((y - distance) / t->side),
                  j1 = (int64_t)floor((y + distance) / t->side);
    for (int64_t j = j0; j <= j1; j++)
        for (int64_t i = i0; i <= i1; i++)
            for (int32_t n = t->head[slot_of(t, i, j)]; n; n = t->next[n - 1])
                if (square(t->pt[n - 1][0] - x) + square(t->pt[n - 1][1] - y) < square(distance))
                    return true;
    return false;
}
