/* SPDX-License-Identifier: MIT
 * Mass, centre and inertia of rigid bodies from their shapes, not from particles. */
#include "geometry/sampling.h"

#include <math.h>

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
