/* SPDX-License-Identifier: MIT
 * Bodies that are bonded touch: particles of both lie within the kernel's reach. */
#include "base/point_grid.h"
#include "geometry/sampling.h"

#include "case/case.h"

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
        const int other = scene_find_solid(scene, scene->solid[k].joined);
        if (other < 0) continue;
        struct point_grid table;
        const double reach = 2 * scene_solid_h(scene, k) * (1 - 1e-9);
        TRY(point_grid_create(&table, reach, p->n, p->x, p->y, &sampler->temp, sampler->diag));
        for (int64_t n = 0; n < p->n; n++) point_grid_insert(&table, n);
        if (touches(scene, &table, k, other, reach)) continue;
        TRY(geometry_go_on(
            sampler,
            fail_at(sampler->diag, scene, scene_line(scene, SECTION_solid, k, "joined"),
                    "[solid %s] is joined to [solid %s], but lies more than 2 h = %g m away "
                    "from it; move it, or leave `joined` out",
                    scene->solid[k].common.name, scene->solid[k].joined, reach)));
    }
    return ERR_OK;
}
