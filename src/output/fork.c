/* SPDX-License-Identifier: MIT
 * Loads a checkpoint into a case with other physics: checks and resets what a restart can rely on. */
#include "output/checkpoint.h"
#include "base/elementary.h"
#include "coupling/impulse.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* Every particle of a moving wall has to be where its motion puts it: a jump would move it through
 * the fluid. */
static enum err check_wall(const struct simulation *s, int64_t i, const struct motion_state *m,
                           struct diag *d)
{
    const struct particles *const p = &s->kind[KIND_WALL];
    const struct motion_point to = motion_of_point(m, p->X[i], p->Y[i]);
    if (elementary_hypot(p->x[i] - to.x[0], p->y[i] - to.x[1]) <= 1e-3 * s->scene->top.dp)
        return ERR_OK;
    const struct scene_wall *const w = &s->scene->wall[p->body[i]];
    return diag_fail(
        d, ERR_INPUT,
        "fork: a particle of [wall %s] would jump at %.6g s from its place in the checkpoint, "
        "(%.6g, %.6g) m, to (%.6g, %.6g) m of [motion %s]; let the motion begin where the "
        "checkpoint ends",
        w->common.name, s->state.time, p->x[i], p->y[i], to.x[0], to.x[1], w->motion);
}

static enum err fork_walls(struct simulation *s, struct diag *d)
{
    struct particles *p = &s->kind[KIND_WALL];
    struct motion_state m = {0};
    for (int64_t i = 0; i < p->n; i++) {
        const struct scene_wall *const w = &s->scene->wall[p->body[i]];
        if (!w->motion[0]) {
            p->vx[i] = p->vy[i] = 0;
            if (p->ax) p->ax[i] = p->ay[i] = 0;
            continue;
        }
        if (i == 0 || p->body[i] != p->body[i - 1])
            m = motion_at(s->scene, scene_find_motion(s->scene, w->motion), s->state.time);
        TRY(check_wall(s, i, &m, d));
    }
    return ERR_OK;
}

/* Applies the clamps of the new case, `free`. A clamp without a motion stops its particles where they
 * are;
 * the motion of a clamp must continue from their present displacement. */
static enum err fork_clamps(struct simulation *s, const double *free, struct diag *d)
{
    struct particles *const p = &s->kind[KIND_SOLID];
    double *const ux = s->solid.scratch[1], *const uy = s->solid.scratch[2];
    for (int64_t i = 0; i < p->n; i++) {
        p->free[i] = free[i];
        ux[i] = p->ux[i];
        uy[i] = p->uy[i];
        if (free[i] != 0) continue;
        p->vx[i] = p->vy[i] = 0;
        if (p->wx) p->wx[i] = p->wy[i] = p->ax[i] = p->ay[i] = p->jx[i] = p->jy[i] = 0;
    }
    solid_place_clamps(&s->solid, p, s->state.time);
    for (int64_t i = 0; i < p->n; i++) {
        if (elementary_hypot(p->ux[i] - ux[i], p->uy[i] - uy[i]) <= 1e-3 * s->solid.dp) continue;
        const struct scene_solid *const b = &s->scene->solid[p->body[i]];
        return diag_fail(d, ERR_INPUT,
                         "fork: the clamp of [solid %s] would jump at %.6g s from its displacement "
                         "in the checkpoint, (%.6g, %.6g) m, to (%.6g, %.6g) m of [motion %s]; let "
                         "the motion begin where the checkpoint ends",
                         b->common.name, s->state.time, ux[i], uy[i], p->ux[i], p->uy[i],
                         b->clamp_motion);
    }
    return ERR_OK;
}

/* Drops the interface impulse if the new case has no impedance interface, which would give it on. */
static void clear_interface_impulse(struct simulation *s)
{
    struct particles *const p = &s->kind[KIND_SOLID];
    if (!p->interface_pressure || s->effects & FX_IMPEDANCE) return;
    for (int64_t i = 0; i < p->n; i++) impulse_clear(p, i);
}

/* Whether the order of the checkpoint is one of the present grid. It stays then, so that a fork without a
 * change keeps its bits. */
static bool order_fits(const struct simulation *s)
{
    struct diag other_grid = {.code = ERR_OK};
    if (checkpoint_check_cells(s, &other_grid)) return false;
    const struct cells *const c = &s->cells;
    for (int k = 0; k < KIND_COUNT; k++) {
        const struct particles *const p = &s->kind[k];
        for (int64_t i = 0; i < p->n; i++) {
            const double x = p->x[i] - c->lower[0], y = p->y[i] - c->lower[1];
            const bool inside =
                x >= 0 && x < c->nx * c->side[0] && y >= 0 && y < c->ny * c->side[1];
            if (p->cell[i] < 0 && inside) return false;
        }
    }
    return true;
}

static enum err sort_again(struct simulation *s, struct diag *d)
{
    for (int k = 0; k < KIND_COUNT; k++) {
        if (k == KIND_SOLID && !(s->effects & FX_COUPLING)) continue;
        const int64_t out = cells_sort(&s->cells, (enum kind)k, &s->kind[k]);
        if (k == KIND_FLUID && out)
            return diag_fail(d, ERR_INPUT,
                             "fork: %" PRId64 " fluid particles of the checkpoint are outside the "
                             "domain of this case; enlarge [domain]",
                             out);
    }
    s->state.sorts++;
    return ERR_OK;
}

enum err checkpoint_fork(const struct image *m, struct simulation *s, struct diag *d)
{
    const struct particles *const solid = &s->kind[KIND_SOLID];
    double *const free = s->solid.scratch[0];
    if (s->effects & FX_SOLID) memcpy(free, solid->free, (size_t)solid->n * sizeof *free);
    TRY(checkpoint_load(m, s, true, d));
    if (s->effects & (FX_FLUID | FX_MOTION)) TRY(fork_walls(s, d));
    if (s->effects & FX_SOLID) TRY(fork_clamps(s, free, d));
    clear_interface_impulse(s);
    if ((s->effects & FX_FLUID) && !order_fits(s)) TRY(sort_again(s, d));
    TRY(simulation_resume(s, d));
    energy_begin(s);
    return ERR_OK;
}
