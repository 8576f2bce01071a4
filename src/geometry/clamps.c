/* SPDX-License-Identifier: MIT
 * The particles of a solid that its clamps hold: those with their centres in a clamp. The solid's
 * lattice is fitted to the ends of its clamps (geometry/lattice.c). */
#include "geometry/sampling.h"

#include "case/case.h"

bool geometry_is_hinge(const struct shape *clamp, double dp)
{
    return clamp->kind == SHAPE_CIRCLE && clamp->size <= 1.5 * dp;
}

enum err geometry_clamp(struct sampler *g, struct region *region, int64_t from, struct samples *p)
{
    const struct shape_list *const clamps = &g->scene->solid[region->body].clamp;
    const double *const spacing = region->lattice.spacing;
    struct outlines *const o = &region->clamps;
    TRY(outlines_of(o, g->scene, clamps, &g->temp, g->diag));
    TRY(outlines_turn(o, region->lattice.angle, &g->temp, g->diag));
    int64_t *held = arena_alloc(&g->temp, (size_t)clamps->n, sizeof *held, "clamps", g->diag);
    if (!held) return ERR_MEMORY;
    for (int64_t k = from; k < p->n; k++) {
        double at[2];
        lattice_place(&region->lattice, p->x[k], p->y[k], at);
        for (int c = 0; c < o->n; c++) {
            if (!outline_contains(&o->item[c], at[0] + NUDGE_X * spacing[0],
                                  at[1] + NUDGE_Y * spacing[1], g->scratch))
                continue;
            const int shape = o->shape[c];
            held[shape]++;
            p->clamped[k] = 1;
            region->n_hinged += geometry_is_hinge(&clamps->item[shape], region->lattice.dp);
        }
        region->n_clamped += p->clamped[k];
    }
    for (int c = 0; c < clamps->n; c++)
        if (!held[c])
            TRY(geometry_go_on(
                g, fail_at(g->diag, g->scene, clamps->item[c].line,
                           "clamp %d of [solid %s] contains no particle; it must cover a part of "
                           "the body",
                           c + 1, region->name)));
    return ERR_OK;
}
