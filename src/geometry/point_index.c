/* SPDX-License-Identifier: MIT */
#include "geometry/point_index.h"

#define ALLOCATE(field)                                                                     \
    do {                                                                                    \
        to->field = arena_alloc(&g->temp, (size_t)n, sizeof *to->field, "points", g->diag); \
        if (!to->field) return ERR_MEMORY;                                                  \
    } while (0)

enum err point_index_create(struct point_index *to, struct sampler *g)
{
    const struct scene *const s = g->scene;
    int64_t n = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++) n += s->points[kind].n;
    *to = (struct point_index){.scene = s};
    ALLOCATE(x);
    ALLOCATE(y);
    ALLOCATE(section);
    ALLOCATE(kind);
    ALLOCATE(bit);
    TRY(point_grid_create(&to->table, s->top.dp, n, to->x, to->y, &g->temp, g->diag));
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int64_t k = 0; k < s->points[kind].n; k++) {
            const struct scene_points *const p = &s->points[kind];
            to->x[to->n] = p->x[k];
            to->y[to->n] = p->y[k];
            to->section[to->n] = p->body[k];
            to->kind[to->n] = (uint8_t)kind;
            to->bit[to->n] = kind != KIND_FLUID          ? POINT_BODY
                             : p->open && p->open[k] > 0 ? POINT_BUFFER
                                                         : POINT_FLUID;
            point_grid_insert(&to->table, to->n++);
        }
    return ERR_OK;
}

/* In one image of a periodic domain. */
static int64_t point_at(const struct point_index *of, double x, double y, double within, int kinds)
{
    struct point_visit v = point_grid_visit(&of->table, x, y, within);
    while (point_grid_next(&of->table, &v))
        if (of->bit[v.k] & kinds) return v.k;
    return -1;
}

int64_t point_index_at(const struct point_index *of, const double at[2], double within, int kinds)
{
    const struct scene *const s = of->scene;
    const int nx = scene_periodic(s, 0), ny = scene_periodic(s, 1);
    for (int i = -nx; i <= nx; i++)
        for (int j = -ny; j <= ny; j++) {
            const int64_t found =
                point_at(of, at[0] + i * (s->domain_upper[0] - s->domain_lower[0]),
                         at[1] + j * (s->domain_upper[1] - s->domain_lower[1]), within, kinds);
            if (found >= 0) return found;
        }
    return -1;
}

bool point_index_surface(const struct point_index *of)
{
    const double dp = of->scene->top.dp;
    for (int64_t k = 0; k < of->n; k++)
        for (int side = 0; side < 4 && of->bit[k] == POINT_FLUID; side++) {
            const double step = side % 2 ? 1.2 * dp : -1.2 * dp;
            const double at[2] = {of->x[k] + (side < 2 ? step : 0),
                                  of->y[k] + (side < 2 ? 0 : step)};
            if (point_index_at(of, at, dp, POINT_ANY) < 0) return true;
        }
    return false;
}
