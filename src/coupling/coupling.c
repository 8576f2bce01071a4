/* SPDX-License-Identifier: MIT
 * The order of the exchange in a step of the fluid. */
#include "coupling/coupling.h"

#include <math.h>

#include "coupling/impulse.h"
#include "coupling/motion.h"

void coupling_set_rate(struct coupling *coupling, effect_set effects, double longest)
{
    const bool impedance = effects & FX_IMPEDANCE;
    coupling->substeps = effects & FX_MULTIRATE;
    coupling->impedance = impedance ? coupling->scene->rho0 * coupling->scene->c0 : 0;
    coupling->solid->kick = impedance ? impedance_kick : solid_free_kick;
    if (!impedance) *coupling->exchange_time = 0;
    if (impedance && *coupling->exchange_time == 0) *coupling->exchange_time = longest;
}

void coupling_find_forces(const struct coupling *coupling, struct particles kinds[KIND_COUNT],
                          const struct cells *cells)
{
    const bool mixed = coupling->scene->top.precision == PRECISION_MIXED;
    force_sweep *const find_force = mixed ? find_force_mixed : find_force_double;
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++) {
        struct particles *const p = &kinds[kind];
        if (!p->fx) continue;
        particles_clear(p->fx, p->n); /* those without fluid nearby get no force */
        particles_clear(p->fy, p->n);
        particles_clear(p->wet_x, p->n);
        particles_clear(p->wet_y, p->n);
        find_force(coupling->fluid, p, (enum kind)kind, cells);
    }
}

/* One component of T-36a: the force and its mean. The mean starts with the first force and ends
 * when it is below any significant force, N/m. */
SPHFSI_INLINE double extrapolated(double *mean, double force, double per_time, double weight)
{
    const double least = 1e-30, old = *mean != 0 ? *mean : force;
    const double next = old + weight * (force - old);
    *mean = fabs(next) > least ? next : 0;
    return force + per_time * (force - old);
}

/* T-36a: the constant force over the sub-steps is that at their start; `ahead`: the time from there
 * to the middle of their kicks; `last`: the step before. */
static void extrapolate_force(struct coupling *coupling, double ahead, double last)
{
    struct particles *const p = coupling->particles;
    const double time = last + averaging_time(coupling), weight = last / time,
                 per_time = ahead / time;
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        p->fx[i] = extrapolated(&p->mean_fx[i], p->fx[i], per_time, weight);
        p->fy[i] = extrapolated(&p->mean_fy[i], p->fy[i], per_time, weight);
    }
}

static void scale_force(struct particles *p, double factor)
{
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        p->fx[i] *= factor;
        p->fy[i] *= factor;
    }
}

void coupling_predict(struct coupling *coupling, double dt, double last)
{
    if (coupling->impedance > 0)
        impulse_set_time(coupling, dt); /* for the force of the corrector */
    motion_ahead(coupling, coupling->ahead * dt, last);
}

double coupling_advance(struct coupling *coupling, double dt, int n, double kick, double last)
{
    struct particles *const p = coupling->particles;
    const bool impedance = coupling->impedance > 0;
    if (impedance) impulse_return(coupling, kick);
    if (impedance && coupling->ahead == 0) impulse_set_time(coupling, dt); /* no predictor */
    if (coupling->substeps && p->mean_fx) extrapolate_force(coupling, 0.5 * (dt - dt / n), last);
    /* Over its sub-steps the structure gets exactly the impulse given to the fluid. */
    if (kick != dt) scale_force(p, kick / dt);
        /* The state at the start gives the mean velocity and acceleration of the step. */
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        p->x0[i] = p->ux[i];
        p->y0[i] = p->uy[i];
        p->vx0[i] = p->vx[i];
        p->vy0[i] = p->vy[i];
    }
    if (impedance) impulse_begin(coupling, dt / n);
    solid_advance(coupling->solid, p, dt / n, n, coupling->centred);
    if (impedance) impulse_end(coupling);
    const double moved = solid_set_positions(p);
    motion_after_substeps(coupling, dt);
    return moved;
}
