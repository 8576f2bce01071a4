/* SPDX-License-Identifier: MIT
 * The particles of a solid that its clamps hold: those with their centres in a clamp. The solid's
 * lattice is fitted to the ends of its clamps (geometry/lattice.c). */
#include "geometry/sampling.h"

#include "case/case.h"

bool geometry_is_hinge(const struct shape *clamp, double dp)
{
    return clamp->kind == SHAPE_CIRCLE && clamp->size <= 1.5 * dp;
}

enum err geometry_clamp(struct sampler *sampler, struct region *region, int64_t from,
                        struct samples *samples)
{
    const struct shape_list *const clamps = &sampler->scene->solid[region->body].clamp;
    const double *const spacing = region->lattice.spacing;
    struct outlines *const o = &region->clamps;
    TRY(outlines_of(o, sampler->scene, clamps, &sampler->temp, sampler->diag));
    TRY(outlines_turn(o, region->lattice.angle, &sampler->temp, sampler->diag));
    int64_t *held =
        arena_alloc(&sampler->temp, (size_t)clamps->n, sizeof *held, "clamps", sampler->diag);
    if (!held) return ERR_MEMORY;
    for (int64_t k = from; k < samples->n; k++) {
        double at[2];
        lattice_place(&region->lattice, samples->x[k], samples->y[k], at);
        for (int c = 0; c < o->n; c++) {
            if (!outline_contains(&o->item[c], at[0] + NUDGE_X * spacing[0],
                                  at[1] + NUDGE_Y * spacing[1]))
                continue;
            const int shape = o->shape[c];
            held[shape]++;
            samples->clamped[k] = 1;
            region->n_hinged += geometry_is_hinge(&clamps->item[shape], region->lattice.dp);
        }
        region->n_clamped += samples->clamped[k];
    }
    for (int c = 0; c < clamps->n; c++)
        if (!held[c])
            TRY(geometry_go_on(
                sampler,
                fail_at(sampler->diag, sampler->scene, clamps->item[c].line,
                        "clamp %d of [solid %s] contains no particle; it must cover a part of "
                        "the body; `hinge = X, Y` holds any point of a body that may turn about it",
                        c + 1, region->name)));
    return ERR_OK;
}
