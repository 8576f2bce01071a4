/* SPDX-License-Identifier: MIT
 * The particles of a solid that its clamps hold: those with their centres in a clamp. The solid's
 * lattice is fitted to the ends of its clamps (geometry/lattice.c). */
#include "geometry/sampling.h"

#include "base/elementary.h"
#include "case/case.h"

static enum err fail_empty(struct sampler *g, const struct region *region, int clamp)
{
    const struct shape_list *const clamps = &g->scene->solid[region->body].clamp;
    char place[LOCATION_TEXT];
    scene_location(g->scene, clamps->item[clamp].line, place);
    return diag_add(
        g->diag, ERR_INPUT,
        "%s: clamp %d of [solid %s] contains no particle; it must cover a part of the body", place,
        clamp + 1, region->name);
}

bool geometry_is_hinge(const struct shape *clamp, double dp)
{
    return clamp->kind == SHAPE_CIRCLE && clamp->size <= 1.5 * dp;
}

/* A small circle is meant as a hinge, but two particles that are held also hold the angle. `nearest` is the
 * particle nearest to its centre. */
static void warn_of_hinge(const struct sampler *g, const struct region *region,
                          const struct shape *clamp, int64_t held, const double nearest[2])
{
    const double dp = region->lattice.dp;
    char place[LOCATION_TEXT];
    if (!geometry_is_hinge(clamp, dp) || held < 2) return;
    scene_location(g->scene, clamp->line, place);
    diag_warn(g->diag,
              "%s: this small clamp holds %lld particles of [solid %s], so the body cannot turn "
              "about it; a hinge holds one: clamp = circle %.6g, %.6g, 0.6*dp",
              place, (long long)held, region->name, nearest[0], nearest[1]);
}

enum err geometry_clamp(struct sampler *g, struct region *region, int64_t from, struct samples *p)
{
    const struct shape_list *const clamps = &g->scene->solid[region->body].clamp;
    const double *const spacing = region->lattice.spacing;
    struct outlines *const o = &region->clamps;
    TRY(outlines_of(o, g->scene, clamps, &g->temp, g->diag));
    TRY(outlines_turn(o, region->lattice.angle, &g->temp, g->diag));
    int64_t *held = arena_alloc(&g->temp, (size_t)clamps->n, sizeof *held, "clamps", g->diag);
    double(*nearest)[2] =
        arena_alloc(&g->temp, (size_t)clamps->n, sizeof *nearest, "clamps", g->diag);
    if (!held || !nearest) return ERR_MEMORY;
    for (int64_t k = from; k < p->n; k++) {
        double at[2];
        lattice_place(&region->lattice, p->x[k], p->y[k], at);
        for (int c = 0; c < o->n; c++) {
            if (!outline_contains(&o->item[c], at[0] + NUDGE_X * spacing[0],
                                  at[1] + NUDGE_Y * spacing[1], g->scratch))
                continue;
            const int shape = o->shape[c];
            const double *const centre = clamps->item[shape].pt[0];
            p->clamped[k] = 1;
            region->n_hinged += geometry_is_hinge(&clamps->item[shape], region->lattice.dp);
            if (held[shape]++ == 0 || elementary_hypot(p->x[k] - centre[0], p->y[k] - centre[1]) <
                                          elementary_hypot(nearest[shape][0] - centre[0],
                                                           nearest[shape][1] - centre[1])) {
                nearest[shape][0] = p->x[k];
                nearest[shape][1] = p->y[k];
            }
        }
        region->n_clamped += p->clamped[k];
    }
    for (int c = 0; c < clamps->n; c++) {
        if (!held[c]) TRY(geometry_go_on(g, fail_empty(g, region, c)));
        if (clamps->n == 1) warn_of_hinge(g, region, &clamps->item[c], held[c], nearest[c]);
    }
    return ERR_OK;
}
