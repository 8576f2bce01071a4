/* SPDX-License-Identifier: MIT
 * Which particles remain where regions overlap. Solids have priority: a clamped part replaces the
 * wall that holds it. Walls form a union. Any other overlap is an error of the case. */
#include "geometry/sampling.h"
#include "base/point_grid.h"

#include "case/case.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Two points nearer than this many dp coincide. The distance on a lattice is 1. Between two
 * lattices, it is at most sqrt(1/2) from a point to the nearest one of the other. */
static const double same_place = 0.7;

/* Mean of the spacings of two points' lattices. */
static double spacing(const struct region *regions, const struct samples *p, int64_t a, int64_t b)
{
    return 0.5 * (regions[p->region[a]].lattice.dp + regions[p->region[b]].lattice.dp);
}

/* The first point in the table, of another region, that coincides with point k; -1: none. */
static int64_t coinciding(const struct point_grid *t, const struct region *regions,
                          const struct samples *p, int64_t k)
{
    struct point_visit v = point_grid_visit(t, p->x[k], p->y[k], t->side);
    while (point_grid_next(t, &v))
        if (p->region[v.k] != p->region[k] &&
            square(p->x[v.k] - p->x[k]) + square(p->y[v.k] - p->y[k]) <
                square(same_place * spacing(regions, p, k, v.k)))
            return v.k;
    return -1;
}

static int motion_of(const struct scene *s, const struct region *wall)
{
    return scene_find_motion(s, s->wall[wall->body].motion);
}

int geometry_shape_at(const struct sampler *g, const struct region *region, double x, double y)
{
    double at[2];
    lattice_place(&region->lattice, x, y, at);
    at[0] += NUDGE_X * region->lattice.spacing[0];
    at[1] += NUDGE_Y * region->lattice.spacing[1];
    for (int k = 0; k < region->minus.n; k++)
        if (outline_contains(&region->minus.item[k], at[0], at[1], g->scratch)) return -1;
    for (int k = 0; k < region->add.n; k++)
        if (outline_contains(&region->add.item[k], at[0], at[1], g->scratch))
            return region->add.shape[k];
    return -1;
}

bool geometry_covers(const struct sampler *g, const struct region *region, double x, double y)
{
    return geometry_shape_at(g, region, x, y) >= 0;
}

/* Whether point k can be omitted because of point `other`. Lattices at different angles, and
 * layers, have points too near to each other on both sides of a common edge. */
static bool yields_to(const struct sampler *g, const struct samples *p, int64_t k, int64_t other)
{
    const struct region *mine = &g->regions[p->region[k]], *its = &g->regions[p->region[other]];
    if (!geometry_covers(g, its, p->x[k], p->y[k])) return true;
    if (mine->kind != KIND_WALL) return false;
    if (its->kind == KIND_SOLID) return p->clamped[other];
    return its->kind == KIND_WALL && motion_of(g->scene, mine) == motion_of(g->scene, its);
}

static bool has_band(const struct region *region)
{
    for (int k = 0; k < region->list->n; k++)
        if (region->list->item[k].kind == SHAPE_POLYLINE) return true;
    return false;
}

static enum err fail_overlap(struct sampler *g, const struct region *mine, const struct region *its,
                             double x, double y, int64_t count)
{
    const char *mend = "move one of the shapes, or subtract the overlap with `minus`";
    if (has_band(mine) || has_band(its))
        mend = "change the sign of `thickness` if the band of the polyline is on the wrong side, "
               "move one of the shapes, or subtract the overlap with `minus`";
    if (mine->kind == KIND_WALL && its->kind == KIND_SOLID)
        mend = has_band(mine) ? "only the clamped part of a solid may lie in a wall; change the "
                                "sign of `thickness` if the band of the polyline is on the wrong "
                                "side"
                              : "only the clamped part of a solid may lie in a wall";
    if (mine->kind == KIND_WALL && its->kind == KIND_WALL)
        mend = "walls that move differently must not overlap";
    return fail_at(g->diag, g->scene, mine->line,
                   "%lld particles of [%s %s] lie in [%s %s], the first at (%.6g, %.6g) m: %s",
                   (long long)count, kind_names[mine->kind], mine->name, kind_names[its->kind],
                   its->name, x, y, mend);
}

/* Sets `kept`; fails if a region overlaps another one and must not. */
static enum err find_overlaps(struct sampler *g, const struct samples *p, struct point_grid *t,
                              uint8_t *kept)
{
    int64_t k = 0;
    for (int region = 0; region < g->n_regions; region++) {
        int64_t wrong = 0, first = -1, first_other = -1;
        for (; k < p->n && p->region[k] == region; k++) {
            const int64_t other = coinciding(t, g->regions, p, k);
            kept[k] = other < 0;
            if (kept[k]) point_grid_insert(t, k);
            if (kept[k] || yields_to(g, p, k, other)) continue;
            if (!wrong++) {
                first = k;
                first_other = other;
            }
        }
        if (wrong)
            return fail_overlap(g, &g->regions[region], &g->regions[p->region[first_other]],
                                p->x[first], p->y[first], wrong);
    }
    return ERR_OK;
}

static enum err store(struct sampler *g, const struct samples *p, const uint8_t *kept,
                      enum kind kind)
{
    struct scene *s = g->scene;
    struct scene_points *to = &s->points[kind];
    size_t n = 0;
    for (int64_t k = 0; k < p->n; k++) n += kept[k] && g->regions[p->region[k]].kind == kind;
    *to = (struct scene_points){0};
    to->x = arena_alloc(&s->arena, n, sizeof *to->x, "particles", g->diag);
    to->y = arena_alloc(&s->arena, n, sizeof *to->y, "particles", g->diag);
    to->body = arena_alloc(&s->arena, n, sizeof *to->body, "particles", g->diag);
    if (!to->x || !to->y || !to->body) return ERR_MEMORY;
    if (kind == KIND_SOLID) {
        to->clamped = arena_alloc(&s->arena, n, 1, "particles", g->diag);
        if (!to->clamped) return ERR_MEMORY;
    }
    for (int64_t k = 0; k < p->n; k++) {
        const struct region *region = &g->regions[p->region[k]];
        if (!kept[k] || region->kind != kind) continue;
        to->x[to->n] = p->x[k];
        to->y[to->n] = p->y[k];
        to->body[to->n] = region->body;
        if (to->clamped) to->clamped[to->n] = p->clamped[k];
        to->n++;
    }
    return ERR_OK;
}

enum err geometry_merge(struct sampler *g, const struct samples *p)
{
    struct point_grid t;
    uint8_t *kept = arena_alloc(&g->temp, (size_t)p->n, 1, "overlaps", g->diag);
    if (!kept) return ERR_MEMORY;
    TRY(point_grid_create(&t, g->scene->top.dp, p->n, p->x, p->y, &g->temp, g->diag));
    TRY(find_overlaps(g, p, &t, kept));
    for (int kind = 0; kind < KIND_COUNT; kind++) TRY(store(g, p, kept, (enum kind)kind));
    return ERR_OK;
}
