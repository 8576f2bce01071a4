/* SPDX-License-Identifier: MIT
 * Loads a checkpoint into a case with other physics: checks and resets what a restart can rely on.
 */
#include "output/checkpoint.h"

#include <inttypes.h>

/* What moves has to be where its motion puts it: a jump would move it through the fluid. */
static enum err check_jump(const struct simulation *sim, const char *what, const char *name,
                           const char *motion, const double from[2], const double to[2], double dp,
                           struct diag *d)
{
    if (elementary_hypot(from[0] - to[0], from[1] - to[1]) <= 1e-3 * dp) return ERR_OK;
    return diag_fail(
        d, ERR_INPUT,
        "fork: %s %s] would jump at %.6g s from (%.6g, %.6g) m in the checkpoint to "
        "(%.6g, %.6g) m of [motion %s]; let the motion begin where the checkpoint ends",
        what, name, simulation_time(sim), from[0], from[1], to[0], to[1], motion);
}

static enum err fork_walls(struct simulation *sim, struct diag *d)
{
    struct particles *particles = &sim->particles[KIND_WALL];
    struct motion_state m = {0};
    rigid_publish(&sim->rigid, sim->state.time, sim->state.dt);
    for (int64_t i = 0; i < particles->n; i++) {
        const struct scene_wall *const w = &sim->scene->wall[particles->body[i]];
        if (!w->motion[0]) {
            particles->vx[i] = particles->vy[i] = 0;
            if (particles->ax) particles->ax[i] = particles->ay[i] = 0;
            continue;
        }
        if (i == 0 || particles->body[i] != particles->body[i - 1])
            m = motion_at(sim->scene, scene_wall_motion(sim->scene, particles->body[i]),
                          simulation_time(sim));
        const struct motion_point to = motion_of_point(&m, particles->X[i], particles->Y[i]);
        TRY(check_jump(sim, "a particle of [wall", w->common.name, w->motion,
                       (double[]){particles->x[i], particles->y[i]}, to.x, sim->scene->top.dp, d));
    }
    return ERR_OK;
}

/* Applies the clamps of the new case, `free`. A clamp without a motion stops its particles where
 * they are; the motion of a clamp must continue from their present displacement. */
static enum err fork_clamps(struct simulation *sim, const double *free, struct diag *d)
{
    struct particles *const particles = &sim->particles[KIND_SOLID];
    double *const ux = sim->solid.scratch[1], *const uy = sim->solid.scratch[2];
    for (int64_t i = 0; i < particles->n; i++) {
        particles->free[i] = free[i];
        ux[i] = particles->ux[i];
        uy[i] = particles->uy[i];
        if (free[i] != 0) continue;
        particles->vx[i] = particles->vy[i] = 0;
        if (particles->wx)
            particles->wx[i] = particles->wy[i] = particles->ax[i] = particles->ay[i] =
                particles->recent_ax[i] = particles->recent_ay[i] = 0;
    }
    solid_place_clamps(&sim->solid, particles, simulation_time(sim));
    for (int64_t i = 0; i < particles->n; i++) {
        const struct scene_solid *const b = &sim->scene->solid[particles->body[i]];
        TRY(check_jump(sim, "the displacement of the clamp of [solid", b->common.name,
                       b->clamp_motion, (double[]){ux[i], uy[i]},
                       (double[]){particles->ux[i], particles->uy[i]}, sim->solid.dp, d));
    }
    return ERR_OK;
}

/* Whether the checkpoint's order fits the grid and stays: then a fork may keep its bits. */
static bool order_fits(const struct simulation *sim)
{
    struct diag other_grid = {.code = ERR_OK};
    if (checkpoint_check_cells(sim, &other_grid)) return false;
    const struct cells *const cells = &sim->cells;
    for (int k = 0; k < KIND_COUNT; k++) {
        const struct particles *const particles = &sim->particles[k];
        for (int64_t i = 0; i < particles->n; i++) {
            const double x = particles->x[i] - cells->lower[0],
                         y = particles->y[i] - cells->lower[1];
            const bool inside = x >= 0 && x < cells->nx * cells->side[0] && y >= 0 &&
                                y < cells->ny * cells->side[1];
            if (particles->cell[i] < 0 && inside) return false;
        }
    }
    return true;
}

static enum err sort_again(struct simulation *sim, struct diag *d)
{
    for (int k = 0; k < KIND_COUNT; k++) {
        if (k == KIND_SOLID && !(sim->effects & FX_COUPLING)) continue;
        const int64_t out = cells_sort(&sim->cells, (enum kind)k, &sim->particles[k]);
        if (k == KIND_FLUID && out)
            return diag_fail(d, ERR_INPUT,
                             "fork: %" PRId64 " fluid particles of the checkpoint are outside the "
                             "domain of this case; enlarge [domain]",
                             out);
    }
    sim->state.sorts++;
    return ERR_OK;
}

enum err checkpoint_fork(struct checkpoint *m, struct simulation *sim, struct diag *d)
{
    struct particles *const solid = &sim->particles[KIND_SOLID];
    double *const free = sim->solid.scratch[0];
    if (sim->effects & FX_SOLID) memcpy(free, solid->free, (size_t)solid->n * sizeof *free);
    TRY(checkpoint_load(m, sim, true, d));
    if (sim->effects & (FX_FLUID | FX_MOTION)) TRY(fork_walls(sim, d));
    if (sim->effects & FX_SOLID) TRY(fork_clamps(sim, free, d));
    /* Without an impedance interface nothing would give the interface impulse on. */
    if (solid->interface_pressure && !(sim->effects & FX_IMPEDANCE))
        for (int64_t i = 0; i < solid->n; i++) impulse_clear(solid, i);
    if ((sim->effects & FX_FLUID) && !order_fits(sim)) TRY(sort_again(sim, d));
    TRY(simulation_resume(sim, d));
    memset(sim->guard.warned_left, 0, sizeof sim->guard.warned_left); /* a run of its own */
    if (sim->state.seeks_rest && !(sim->effects & FX_RELAX))
        relax_end(sim); /* a search that was cut */
    else
        energy_begin(sim);
    return ERR_OK;
}
