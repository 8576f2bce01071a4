/* SPDX-License-Identifier: MIT
 * Bodies: their thickness, the area that their particles cover, those that clamps hold, those
 * next to a body that is bonded to theirs; the mass of rigid bodies, from their shapes. */
#include "geometry/sampling.h"
#include "base/point_grid.h"

/* --- thickness and area --- */

double geometry_rows_across(const struct region *region)
{
    double across = HUGE_VAL;
    for (int c = 0; c < 2; c++)
        across = min2(across, (double)(geometry_index(region, c, region->box.high[c]) -
                                       geometry_index(region, c, region->box.low[c])));
    for (int k = 0; k < region->list->n; k++)
        if (region->list->item[k].kind == SHAPE_POLYLINE)
            across = min2(across, round(fabs(region->list->item[k].size) / region->lattice.dp));
    return across;
}

/* The area that no clamp holds, and how much more of it particles cover; without hinges. */
static enum err find_area(struct sampler *sampler, const struct region *region)
{
    const struct scene_lattice *const l = &region->lattice;
    const struct shape_list *const list = &sampler->scene->solid[region->body].clamp;
    const struct outlines *const minus = &region->minus, *const clamps = &region->clamps;
    const bool part = region->n_clamped > region->n_hinged && region->n_clamped < region->n;
    const int64_t n = region->n - (part ? region->n_clamped - region->n_hinged : 0);
    struct outlines cut = {0};
    TRY(geometry_array(sampler, &cut.item, minus->n + clamps->n));
    for (int k = 0; k < minus->n; k++) cut.item[cut.n++] = minus->item[k];
    for (int k = 0; part && k < clamps->n; k++)
        if (!geometry_is_hinge(&list->item[clamps->shape[k]], l->dp))
            cut.item[cut.n++] = clamps->item[k];
    struct scene_lattice *const to = &sampler->scene->solid_lattice[region->body];
    to->area_free = part;
    struct moments of;
    TRY(outlines_moments(&region->add, &cut, 0.25 * l->spacing[1], &of, &sampler->temp,
                         sampler->diag));
    to->area = of.area;
    to->area_error = (double)n * square(l->dp) / to->area - 1;
    return ERR_OK;
}

enum err geometry_check_bodies(struct sampler *sampler)
{
    for (int r = 0; r < sampler->n_regions; r++) {
        const struct region *const region = &sampler->regions[r];
        if (region->kind != KIND_SOLID || region->n == 0) continue;
        const double across = geometry_rows_across(region);
        if (across < 2)
            TRY(geometry_refuse(sampler, region->common->line,
                                "%s is %.0f particle thick at dp = %g m; bending needs at "
                                "least 2, better 4",
                                section_title(region->common).text, across, region->lattice.dp));
        TRY(find_area(sampler, region));
    }
    return ERR_OK;
}

/* --- mass of rigid bodies --- */

enum err geometry_rigid_mass(struct sampler *sampler, int rigid, const struct region *region)
{
    struct scene *const scene = sampler->scene;
    const struct scene_rigid *const given = &scene->rigid[rigid];
    struct rigid_mass *const to = &scene->rigid_mass[rigid];
    struct moments of;
    const bool all_given =
        !isnan(given->mass) && !isnan(given->centre[0]) && !isnan(given->inertia);
    if (region->add.n == 0 && !all_given)
        return geometry_refuse(sampler, given->common.line,
                               "[rigid %s] has no area, because its lines have no thickness; give "
                               "it `mass`, `centre` and `inertia`",
                               given->common.name);
    const double height = region->add.box.high[1] - region->add.box.low[1];
    /* The lines are close enough for the ends of circles. */
    TRY(outlines_moments(&region->add, &region->minus, 1e-4 * height, &of, &sampler->temp,
                         sampler->diag));
    const double x = of.x / of.area, y = of.y / of.area;
    to->mass = isnan(given->mass) ? given->density * of.area : given->mass;
    to->centre[0] = isnan(given->centre[0]) ? x : given->centre[0];
    to->centre[1] = isnan(given->centre[0]) ? y : given->centre[1];
    const double about_area = (of.xx + of.yy) / of.area - x * x - y * y;
    to->inertia =
        isnan(given->inertia)
            ? to->mass * (about_area + square(x - to->centre[0]) + square(y - to->centre[1]))
            : given->inertia;
    return ERR_OK;
}

/* --- clamps --- */

bool geometry_is_hinge(const struct shape *clamp, double dp)
{
    return clamp->kind == SHAPE_CIRCLE && clamp->size <= 1.5 * dp;
}

enum err geometry_clamp(struct sampler *sampler, struct region *region, int64_t from,
                        struct samples *samples)
{
    const struct shape_list *const clamps = &sampler->scene->solid[region->body].clamp;
    struct outlines *const o = &region->clamps;
    TRY(outlines_of(o, sampler->scene, clamps, &sampler->temp, sampler->diag));
    TRY(outlines_turn(o, region->lattice.angle, &sampler->temp, sampler->diag));
    int64_t *held;
    TRY(geometry_array(sampler, &held, clamps->n));
    for (int64_t k = from; k < samples->n; k++) {
        double at[2];
        geometry_place(region, samples->x[k], samples->y[k], at);
        for (int c = 0; c < o->n; c++) {
            if (!outline_contains(&o->item[c], at[0], at[1])) continue;
            const int shape = o->shape[c];
            held[shape]++;
            samples->clamped[k] = 1;
            region->n_hinged += geometry_is_hinge(&clamps->item[shape], region->lattice.dp);
        }
        region->n_clamped += samples->clamped[k];
    }
    for (int c = 0; c < clamps->n; c++)
        if (!held[c])
            TRY(geometry_refuse(
                sampler, clamps->item[c].line,
                "clamp %d of %s contains no particle; it must cover a part of the body; "
                "`hinge = X, Y` holds any point of a body that may turn about it",
                c + 1, section_title(region->common).text));
    return ERR_OK;
}

/* --- bonds --- */

static bool touches(const struct scene *scene, const struct point_grid *t, int body, int other,
                    double reach)
{
    const struct scene_points *const p = &scene->points[KIND_SOLID];
    for (int64_t k = 0; k < p->n; k++) {
        if (p->body[k] != body) continue;
        struct point_visit v = point_grid_visit(t, p->x[k], p->y[k], reach);
        while (point_grid_next(t, &v))
            if (p->body[v.k] == other) return true;
    }
    return false;
}

enum err geometry_check_joined(struct sampler *sampler)
{
    const struct scene *const scene = sampler->scene;
    const struct scene_points *const p = &scene->points[KIND_SOLID];
    for (int k = 0; k < scene->n_solid; k++) {
        const int other = scene_find(scene, SECTION_solid, scene->solid[k].joined);
        if (other < 0) continue;
        struct point_grid table;
        const double reach = 2 * scene_solid_h(scene, k) * (1 - 1e-9);
        TRY(point_grid_create(&table, reach, p->n, p->x, p->y, &sampler->temp, sampler->diag));
        for (int64_t n = 0; n < p->n; n++) point_grid_insert(&table, n);
        if (touches(scene, &table, k, other, reach)) continue;
        TRY(geometry_refuse(sampler, key_line(scene, SECTION_solid, k, "joined"),
                            "[solid %s] is joined to [solid %s], but lies more than 2 h = %g m "
                            "away from it; move it, or leave `joined` out",
                            scene->solid[k].common.name, scene->solid[k].joined, reach));
    }
    return ERR_OK;
}
