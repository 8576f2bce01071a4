/* SPDX-License-Identifier: MIT
 * Walls that are drawn as lines without thickness. Such a line becomes a band on its dry side, as
 * many layers of particles thick as the kernel reaches. With fluid on both sides it is a thin
 * line. */
#include "geometry/sampling.h"
#include "base/elementary.h"
#include "particles/kernel.h"

static bool is_fluid(const struct sampler *sampler, const double at[2])
{
    for (int k = 0; k < sampler->n_regions; k++)
        if (sampler->regions[k].kind == KIND_FLUID &&
            geometry_piece_at(&sampler->regions[k], at[0], at[1]) >= 0)
            return true;
    return false;
}

/* Whether there is fluid half a spacing beside a line, on its left (side = 1) or right (-1). Places
 * less than a spacing from a corner may lie beyond the next segment. */
static bool is_wet(const struct sampler *sampler, const struct shape *line, double side)
{
    const double dp = sampler->scene->top.dp;
    for (int k = 0; k + 1 < line->n; k++) {
        const double *const a = line->pt[k], *const b = line->pt[k + 1];
        const double dx = b[0] - a[0], dy = b[1] - a[1], length = elementary_hypot(dx, dy);
        const double off = 0.5 * side * dp / length;
        const int64_t parts = 1 + (int64_t)max2(0, min2(1e6 / line->n, 2 * (length / dp - 2)));
        for (int64_t j = 1; j <= parts; j++) {
            const double s =
                parts == 1
                    ? 0.5
                    : (dp + (length - 2 * dp) * (double)(j - 1) / (double)(parts - 1)) / length;
            const double at[2] = {a[0] + s * dx - off * dy, a[1] + s * dy + off * dx};
            if (is_fluid(sampler, at)) return true;
        }
    }
    return false;
}

/* Whether a piece of fluid begins inside a closed line, wherever it is. */
static enum err find_inside(struct sampler *sampler, const struct shape *line, bool *found)
{
    struct shape inside = *line;
    struct outlines o;
    inside.kind = SHAPE_POLYGON;
    TRY(outlines_of(&o, sampler->scene, &(struct shape_list){1, &inside}, &sampler->temp,
                    sampler->diag));
    *found = false;
    for (int k = 0; k < sampler->n_regions; k++) {
        const struct outlines *const add = &sampler->regions[k].add;
        if (sampler->regions[k].kind != KIND_FLUID) continue;
        for (int j = 0; j < add->n; j++) {
            const double *const at = add->item[j].n ? add->item[j].pt[0] : add->item[j].centre;
            *found |= outlines_find(&o, at[0], at[1]) >= 0;
        }
    }
    return ERR_OK;
}

/* Fluid beside the line decides on which side the wall is. Without any, the fluid is meant to be on
 * the left of an open line, and inside a closed one if it has some there. A closed line around a
 * wall is filled. */
static enum err thicken_line(struct sampler *sampler, struct shape *line)
{
    const struct scene *const scene = sampler->scene;
    const double dp = scene->top.dp, *const first = line->pt[0],
                 *const last = line->pt[line->n - 1];
    const double thick = dp * ceil(KERNEL_REACH * scene->h / dp - 1e-9);
    const bool left_turning = polygon_area(line->n, line->pt) > 0; /* of a closed line */
    const bool closed = line->n > 3 && first[0] == last[0] && first[1] == last[1];
    const bool wet_left = is_wet(sampler, line, 1), wet_right = is_wet(sampler, line, -1);
    bool fluid_left = !wet_right;
    line->thin = wet_left && wet_right;
    if (line->thin) return ERR_OK;
    if (closed && !wet_left && !wet_right) {
        TRY(find_inside(sampler, line, &fluid_left));
        fluid_left = fluid_left == left_turning;
    }
    line->size = fluid_left ? -thick : thick;
    if (!closed || fluid_left == left_turning) return ERR_OK;
    line->kind = SHAPE_POLYGON;
    line->size = 0;
    line->n--;
    return ERR_OK;
}

enum err geometry_thicken(struct sampler *sampler, const struct region *wall)
{
    for (int k = 0; k < wall->list->n; k++) {
        struct shape *const shape = &wall->list->item[k];
        if (shape->bare && !shape->thin && shape->kind == SHAPE_POLYLINE && shape->size == 0)
            TRY(thicken_line(sampler, shape));
    }
    return ERR_OK;
}
