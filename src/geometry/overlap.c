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
static double spacing(const struct region *regions, const struct samples *samples, int64_t a,
                      int64_t b)
{
    return 0.5 * (regions[samples->region[a]].lattice.dp + regions[samples->region[b]].lattice.dp);
}

/* The first point in the table, of another region, that coincides with point k; -1: none. */
static int64_t coinciding(const struct point_grid *t, const struct region *regions,
                          const struct samples *samples, int64_t k)
{
    struct point_visit v = point_grid_visit(t, samples->x[k], samples->y[k], t->side);
    while (point_grid_next(t, &v))
        if (samples->region[v.k] != samples->region[k] &&
            square(samples->x[v.k] - samples->x[k]) + square(samples->y[v.k] - samples->y[k]) <
                square(same_place * spacing(regions, samples, k, v.k)))
            return v.k;
    return -1;
}

static int motion_of(const struct scene *scene, const struct region *wall)
{
    return scene_find_motion(scene, scene->wall[wall->body].motion);
}

int geometry_shape_at(const struct sampler *sampler, const struct region *region, double x,
                      double y)
{
    double at[2];
    lattice_place(&region->lattice, x, y, at);
    at[0] += NUDGE_X * region->lattice.spacing[0];
    at[1] += NUDGE_Y * region->lattice.spacing[1];
    for (int k = 0; k < region->minus.n; k++)
        if (outline_contains(&region->minus.item[k], at[0], at[1], sampler->scratch)) return -1;
    for (int k = 0; k < region->add.n; k++)
        if (outline_contains(&region->add.item[k], at[0], at[1], sampler->scratch))
            return region->add.shape[k];
    return -1;
}

bool geometry_covers(const struct sampler *sampler, const struct region *region, double x, double y)
{
    return geometry_shape_at(sampler, region, x, y) >= 0;
}

/* Whether point k can be omitted because of point `other`. Lattices at different angles, and
 * layers, have points too near to each other on both sides of a common edge. */
static bool yields_to(const struct sampler *sampler, const struct samples *samples, int64_t k,
                      int64_t other)
{
    const struct region *mine = &sampler->regions[samples->region[k]],
                        *its = &sampler->regions[samples->region[other]];
    if (!geometry_covers(sampler, its, samples->x[k], samples->y[k])) return true;
    if (mine->kind != KIND_WALL) return false;
    if (its->kind == KIND_SOLID) return samples->clamped[other];
    return its->kind == KIND_WALL &&
           motion_of(sampler->scene, mine) == motion_of(sampler->scene, its);
}

static bool has_band(const struct region *region)
{
    for (int k = 0; k < region->list->n; k++)
        if (region->list->item[k].kind == SHAPE_POLYLINE) return true;
    return false;
}

static enum err fail_overlap(struct sampler *sampler, const struct region *mine,
                             const struct region *its, double x, double y, int64_t count)
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
    return fail_at(sampler->diag, sampler->scene, mine->line,
                   "%lld particles of [%s %s] lie in [%s %s], the first at (%.6g, %.6g) m: %s",
                   (long long)count, kind_names[mine->kind], mine->name, kind_names[its->kind],
                   its->name, x, y, mend);
}

/* Sets `kept`; fails if a region overlaps another one and must not. */
static enum err find_overlaps(struct sampler *sampler, const struct samples *samples,
                              struct point_grid *t, uint8_t *kept)
{
    int64_t k = 0;
    for (int region = 0; region < sampler->n_regions; region++) {
        int64_t wrong = 0, first = -1, first_other = -1;
        for (; k < samples->n && samples->region[k] == region; k++) {
            const int64_t other = coinciding(t, sampler->regions, samples, k);
            kept[k] = other < 0;
            if (kept[k]) point_grid_insert(t, k);
            if (kept[k] || yields_to(sampler, samples, k, other)) continue;
            if (!wrong++) {
                first = k;
                first_other = other;
            }
        }
        if (wrong)
            return fail_overlap(sampler, &sampler->regions[region],
                                &sampler->regions[samples->region[first_other]], samples->x[first],
                                samples->y[first], wrong);
    }
    return ERR_OK;
}

static enum err store(struct sampler *sampler, const struct samples *samples, const uint8_t *kept,
                      enum kind kind)
{
    struct scene *scene = sampler->scene;
    struct scene_points *to = &scene->points[kind];
    size_t n = 0;
    for (int64_t k = 0; k < samples->n; k++)
        n += kept[k] && sampler->regions[samples->region[k]].kind == kind;
    *to = (struct scene_points){0};
    to->x = arena_alloc(&scene->arena, n, sizeof *to->x, "particles", sampler->diag);
    to->y = arena_alloc(&scene->arena, n, sizeof *to->y, "particles", sampler->diag);
    to->body = arena_alloc(&scene->arena, n, sizeof *to->body, "particles", sampler->diag);
    if (!to->x || !to->y || !to->body) return ERR_MEMORY;
    if (kind == KIND_SOLID) {
        to->clamped = arena_alloc(&scene->arena, n, 1, "particles", sampler->diag);
        if (!to->clamped) return ERR_MEMORY;
    }
    for (int64_t k = 0; k < samples->n; k++) {
        const struct region *region = &sampler->regions[samples->region[k]];
        if (!kept[k] || region->kind != kind) continue;
        to->x[to->n] = samples->x[k];
        to->y[to->n] = samples->y[k];
        to->body[to->n] = region->body;
        if (to->clamped) to->clamped[to->n] = samples->clamped[k];
        to->n++;
    }
    return ERR_OK;
}

enum err geometry_merge(struct sampler *sampler, const struct samples *samples)
{
    struct point_grid t;
    uint8_t *kept = arena_alloc(&sampler->temp, (size_t)samples->n, 1, "overlaps", sampler->diag);
    if (!kept) return ERR_MEMORY;
    TRY(point_grid_create(&t, sampler->scene->top.dp, samples->n, samples->x, samples->y,
                          &sampler->temp, sampler->diag));
    TRY(find_overlaps(sampler, samples, &t, kept));
    for (int kind = 0; kind < KIND_COUNT; kind++)
        TRY(store(sampler, samples, kept, (enum kind)kind));
    return ERR_OK;
}
