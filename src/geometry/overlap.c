/* SPDX-License-Identifier: MIT
 * Which particles remain where regions overlap. Two regions overlap if the centre of a particle of
 * one lies in the outlines of the other. Solids have priority: a clamped part replaces the wall
 * that holds it. Walls that move together form a union. Any other overlap is an error of the
 * case. */
#include "geometry/sampling.h"
#include "base/point_grid.h"
#include "particles/kernel.h"

/* Beside a common edge of shapes that are sampled on different lattices, or in layers, particles
 * may be nearer to each other than this many dp. The one of less priority is left out. */
static const double too_near = 0.7;

bool geometry_covers(const struct region *region, double x, double y)
{
    double at[2];
    geometry_place(region, x, y, at);
    return geometry_piece_at(region, at[0], at[1]) >= 0;
}

bool geometry_covers_strictly(const struct region *region, double x, double y)
{
    double at[2];
    lattice_place(&region->lattice, x, y, at);
    for (int k = 0; k < 4; k++) {
        const double u = at[0] + (k & 1 ? NUDGE_X : -NUDGE_X) * region->lattice.dp,
                     v = at[1] + (k & 2 ? NUDGE_Y : -NUDGE_Y) * region->lattice.dp;
        if (geometry_piece_at(region, u, v) < 0) return false;
    }
    return true;
}

/* Whether particle k may lie in another region: in a wall if clamped; of a wall in its clamp. */
static bool may_lie_in(const struct sampler *sampler, const struct samples *samples, int64_t k,
                       const struct region *its)
{
    const struct region *const mine = &sampler->regions[samples->region[k]];
    double at[2];
    if (its->kind == KIND_WALL && mine->kind == KIND_SOLID) return samples->clamped[k];
    if (mine->kind != KIND_WALL || its->kind == KIND_FLUID) return false;
    if (its->kind == KIND_WALL)
        return scene_wall_motion(sampler->scene, mine->body) ==
               scene_wall_motion(sampler->scene, its->body);
    geometry_place(its, samples->x[k], samples->y[k], at);
    return outlines_find(&its->clamps, at[0], at[1]) >= 0;
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
    const bool fluid = mine->kind == KIND_FLUID || its->kind == KIND_FLUID,
               wall = mine->kind == KIND_WALL || its->kind == KIND_WALL;
    return fail_at(sampler->diag, sampler->scene, mine->common->line,
                   "%lld particles of %s lie in %s, the first at (%.6g, %.6g) m: %s%s",
                   (long long)count, section_title(mine->common).text,
                   section_title(its->common).text, x, y,
                   fluid || !wall ? "move one of the shapes, or subtract the overlap with `minus`"
                   : mine->kind == its->kind ? "walls that move differently must not overlap"
                                             : "only the clamped part of a solid may lie in a wall",
                   has_band(mine) || has_band(its)
                       ? "; if the band of a polyline is on the wrong side, change the sign of its "
                         "thickness or, without one, the order of its points"
                       : "");
}

/* Sets `covered` where a particle lies in a region of more priority; fails if it must not lie in
 * one. From the last region on, so that a message names fluid in a body, not a body in fluid. */
static enum err find_overlaps(struct sampler *sampler, const struct samples *samples,
                              uint8_t *covered)
{
    for (int64_t k = samples->n - 1, first; k >= 0; k = first - 1) {
        const int region = samples->region[k];
        const struct region *other = NULL;
        int64_t wrong = 0, at = 0;
        for (first = k; first > 0 && samples->region[first - 1] == region;) first--;
        for (int64_t j = first; j <= k; j++)
            for (int r = 0; r < sampler->n_regions; r++) {
                const struct region *const its = &sampler->regions[r];
                if (r == region || !geometry_covers_strictly(its, samples->x[j], samples->y[j]))
                    continue;
                covered[j] |= r < region;
                if ((other && its != other) || may_lie_in(sampler, samples, j, its)) continue;
                if (!wrong++) other = its, at = j;
            }
        if (wrong)
            return fail_overlap(sampler, &sampler->regions[region], other, samples->x[at],
                                samples->y[at], wrong);
    }
    return ERR_OK;
}

/* Whether a particle that remains, of another region, is too near to particle k. */
static bool is_crowded(const struct point_grid *t, const struct sampler *sampler,
                       const struct samples *samples, int64_t k)
{
    const struct region *const mine = &sampler->regions[samples->region[k]];
    struct point_visit v = point_grid_visit(t, samples->x[k], samples->y[k], t->side);
    while (point_grid_next(t, &v)) {
        const struct region *const its = &sampler->regions[samples->region[v.k]];
        const double spacing = 0.5 * (mine->lattice.dp + its->lattice.dp);
        if (its != mine &&
            square(samples->x[v.k] - samples->x[k]) + square(samples->y[v.k] - samples->y[k]) <
                square(too_near * spacing))
            return true;
    }
    return false;
}

enum err geometry_points(struct sampler *sampler, enum kind kind, int64_t n, bool open,
                         struct scene_points *to)
{
    static const char what[] = "particles";
    struct arena *const a = &sampler->scene->arena;
    *to = (struct scene_points){0};
    TRY(arena_array(a, &to->x, n, what, sampler->diag));
    TRY(arena_array(a, &to->y, n, what, sampler->diag));
    TRY(arena_array(a, &to->body, n, what, sampler->diag));
    if (kind == KIND_SOLID) TRY(arena_array(a, &to->clamped, n, what, sampler->diag));
    if (kind == KIND_WALL && sampler->scene->n_thin)
        TRY(arena_array(a, &to->volume, n, what, sampler->diag));
    if (open) TRY(arena_array(a, &to->open, n, what, sampler->diag));
    return ERR_OK;
}

/* The particles of a wall are followed by the dummies of its lines. */
static enum err store(struct sampler *sampler, const struct samples *samples, const uint8_t *kept,
                      enum kind kind)
{
    struct scene *const scene = sampler->scene;
    struct scene_points *const to = &scene->points[kind];
    int64_t n = 0, k = 0;
    double part[2][3];
    for (int64_t j = 0; j < samples->n; j++) {
        const struct region *const region = &sampler->regions[samples->region[j]];
        if (kept[j] && region->kind == kind)
            n += geometry_cut(scene, kind, region->body, samples->x[j], samples->y[j], part);
    }
    if (kind == KIND_WALL)
        for (int j = 0; j < scene->n_thin; j++) n += scene->thin[j].n_dummies;
    TRY(geometry_points(sampler, kind, n, false, to));
    for (int r = 0; r < sampler->n_regions; r++) {
        const struct region *const region = &sampler->regions[r];
        for (; k < samples->n && samples->region[k] == r; k++) {
            if (!kept[k] || region->kind != kind) continue;
            const int parts =
                geometry_cut(scene, kind, region->body, samples->x[k], samples->y[k], part);
            for (int p = 0; p < parts; p++, to->n++) {
                to->x[to->n] = part[p][0];
                to->y[to->n] = part[p][1];
                to->body[to->n] = region->body;
                if (to->clamped) to->clamped[to->n] = samples->clamped[k];
                if (to->volume) to->volume[to->n] = part[p][2];
            }
        }
        if (kind == KIND_WALL && region->kind == kind) geometry_thin_store(scene, region->body);
    }
    return ERR_OK;
}

/* Whether a particle of a wall or rigid body is out of reach of all that touches its surface: of
 * fluid on any side, and of solids. So thick walls are shells. The edges of all sections count: a
 * clamp that moves leaves a hollow in the wall that it replaces. */
static bool is_deep(const struct sampler *sampler, const struct samples *samples, int64_t k)
{
    const struct region *const mine = &sampler->regions[samples->region[k]];
    const double reach = KERNEL_REACH * sampler->scene->h;
    double at[2];
    if (mine->kind != KIND_WALL) return false;
    lattice_place(&mine->lattice, samples->x[k], samples->y[k], at);
    for (int r = 0; r < sampler->n_regions; r++)
        if (outlines_edge_within(&sampler->regions[r].add, at[0], at[1], reach) ||
            outlines_edge_within(&sampler->regions[r].minus, at[0], at[1], reach))
            return false;
    return true;
}

enum err geometry_merge(struct sampler *sampler, const struct samples *samples)
{
    struct point_grid t;
    uint8_t *covered, *kept;
    TRY(geometry_array(sampler, &covered, samples->n));
    TRY(geometry_array(sampler, &kept, samples->n));
    TRY(find_overlaps(sampler, samples, covered));
    TRY(point_grid_create(&t, sampler->scene->top.dp, samples->n, samples->x, samples->y,
                          &sampler->temp, sampler->diag));
    for (int64_t k = 0; k < samples->n; k++) {
        kept[k] = !covered[k] && !is_crowded(&t, sampler, samples, k);
        if (kept[k]) point_grid_insert(&t, k);
        kept[k] &= !is_deep(sampler, samples, k);
    }
    for (int kind = 0; kind < KIND_COUNT; kind++)
        TRY(store(sampler, samples, kept, (enum kind)kind));
    return ERR_OK;
}
