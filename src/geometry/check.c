/* SPDX-License-Identifier: MIT
 * Thickness of bodies in particles, and the area that their particles cover. */
#include "geometry/sampling.h"

#include "case/case.h"

#include <math.h>

double geometry_rows_between(const struct region *region, int c, double low, double high)
{
    const double origin = region->lattice.origin[c], spacing = region->lattice.spacing[c];
    return ceil((high - origin) / spacing - 0.5 - 1e-6) -
           ceil((low - origin) / spacing - 0.5 - 1e-6);
}

double geometry_rows_across(const struct region *region)
{
    double across = HUGE_VAL;
    for (int c = 0; c < 2; c++)
        across =
            min2(across, geometry_rows_between(region, c, region->box.low[c], region->box.high[c]));
    for (int k = 0; k < region->list->n; k++)
        if (region->list->item[k].kind == SHAPE_POLYLINE)
            across = min2(across, round(fabs(region->list->item[k].size) / region->lattice.dp));
    return across;
}

/* The area where no clamp holds the solid, and how much more of it particles cover. A hinge's area
 * is not that of its particles. */
static enum err find_area(struct sampler *sampler, const struct region *region)
{
    const struct scene_lattice *const l = &region->lattice;
    const struct shape_list *const list = &sampler->scene->solid[region->body].clamp;
    const struct outlines *const minus = &region->minus, *const clamps = &region->clamps;
    const bool part = region->n_clamped > region->n_hinged && region->n_clamped < region->n;
    const int64_t n = region->n - (part ? region->n_clamped - region->n_hinged : 0);
    struct outlines cut = {.item = arena_alloc(&sampler->temp, (size_t)(minus->n + clamps->n),
                                               sizeof *cut.item, "shapes", sampler->diag)};
    if (!cut.item) return ERR_MEMORY;
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
        if (region->kind != KIND_SOLID) continue;
        const double across = geometry_rows_across(region);
        if (across < 2)
            TRY(geometry_go_on(
                sampler, fail_at(sampler->diag, sampler->scene, region->line,
                                 "[solid %s] is %.0f particle thick at dp = %g m; bending needs at "
                                 "least 2, better 4",
                                 region->name, across, region->lattice.dp)));
        TRY(find_area(sampler, region));
    }
    return ERR_OK;
}
