/* SPDX-License-Identifier: MIT
 * What warnings share: their beginning, all points of a scene by place, extents and speeds. */
#include "check/check.h"

int drawn_at(const struct check *check, double x, double y)
{
    for (int r = 0; r < check->scene->n_solid + check->scene->n_wall; r++)
        if (geometry_covers(&check->shapes.regions[r], x, y)) return r;
    return -1;
}

struct body body_at(const struct scene *scene, int k)
{
    const struct scene_solid *const solid = k < scene->n_solid ? &scene->solid[k] : NULL;
    const struct scene_wall *const wall = solid ? NULL : &scene->wall[k - scene->n_solid];
    const struct scene_section_common *const common = solid ? &solid->common : &wall->common;
    return (struct body){common, solid ? solid->clamp_motion : wall->motion,
                         solid ? solid->slip : wall->slip, solid ? KIND_SOLID : KIND_WALL,
                         solid ? k : k - scene->n_solid};
}

enum err list_points(struct check *check)
{
    const struct scene *const scene = check->scene;
    struct points *const p = &check->points;
    struct arena *const temp = &check->shapes.temp;
    int64_t n = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++) n += scene->points[kind].n;
    TRY(arena_array(temp, &p->x, n, "check", check->diag));
    TRY(arena_array(temp, &p->y, n, "check", check->diag));
    TRY(arena_array(temp, &p->section, n, "check", check->diag));
    TRY(arena_array(temp, &p->kind, n, "check", check->diag));
    TRY(arena_array(temp, &p->bit, n, "check", check->diag));
    TRY(point_grid_create(&p->grid, 2.1 * scene->top.dp, n, p->x, p->y, temp, check->diag));
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int64_t k = 0; k < scene->points[kind].n; k++) {
            const struct scene_points *const from = &scene->points[kind];
            p->x[p->n] = from->x[k];
            p->y[p->n] = from->y[k];
            p->section[p->n] = from->body[k];
            p->kind[p->n] = (uint8_t)kind;
            p->bit[p->n] = kind != KIND_FLUID                ? POINT_BODY
                           : from->open && from->open[k] > 0 ? POINT_BUFFER
                                                             : POINT_FLUID;
            point_grid_insert(&p->grid, p->n++);
        }
    return ERR_OK;
}

int64_t point_at(const struct check *check, const double at[2], double within, int kinds)
{
    const struct scene *const scene = check->scene;
    const int nx = scene_periodic(scene, 0), ny = scene_periodic(scene, 1);
    const double width = scene->domain_upper[0] - scene->domain_lower[0],
                 height = scene->domain_upper[1] - scene->domain_lower[1];
    for (int i = -nx; i <= nx; i++)
        for (int j = -ny; j <= ny; j++) {
            struct point_visit v = point_grid_visit(&check->points.grid, at[0] + i * width,
                                                    at[1] + j * height, within);
            while (point_grid_next(&check->points.grid, &v))
                if (check->points.bit[v.k] & kinds) return v.k;
        }
    return -1;
}

int64_t point_beside(const struct check *check, int64_t k, const double toward[2], double within,
                     int kinds)
{
    const double dp = check->scene->top.dp;
    const double at[2] = {check->points.x[k] + dp * toward[0], check->points.y[k] + dp * toward[1]};
    return point_at(check, at, within * dp, kinds);
}

double extent_along(const struct scene *scene, enum kind kind, int section, const double along[2])
{
    const struct scene_points *const p = &scene->points[kind];
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int64_t k = 0; k < p->n; k++) {
        if (p->body[k] != section || (p->open && p->open[k] > 0)) continue;
        const double at = along[0] * p->x[k] + along[1] * p->y[k];
        low = min2(low, at);
        high = max2(high, at);
    }
    return max2(0, high - low);
}

double start_speed(const struct scene *scene, enum kind kind, int section,
                   const struct scene_expr *velocity)
{
    const struct scene_points *const p = &scene->points[kind];
    if (!velocity->e[0]) return 0;
    double most = 0;
    for (int64_t k = 0; k < p->n; k++) {
        if (p->body[k] != section) continue;
        double v[2];
        for (int c = 0; c < 2; c++)
            v[c] = velocity->e[c] ? expr_at(velocity->e[c], p->x[k], p->y[k]) : 0;
        most = max2(most, elementary_hypot(v[0], v[1]));
    }
    return most;
}
