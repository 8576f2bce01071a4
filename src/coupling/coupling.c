/* SPDX-License-Identifier: MIT
 * The order of the exchange in a step of the fluid. */
#include "coupling/coupling.h"

#include <math.h>

#include "coupling/impulse.h"
#include "coupling/motion.h"
#include "implicit/implicit.h"

void coupling_set_rate(struct coupling *coupling, effect_set effects, double longest)
{
    const bool impedance = effects & FX_IMPEDANCE;
    coupling->substeps = effects & FX_MULTIRATE;
    coupling->impedance = impedance ? coupling->scene->rho0 * coupling->scene->c0 : 0;
    coupling->solid->kick = impedance ? impedance_kick : solid_free_kick;
    if (!impedance) *coupling->exchange_time = 0;
    if (impedance && *coupling->exchange_time == 0) *coupling->exchange_time = longest;
}

static void find_forces_on(const struct coupling *coupling, struct particles *particles,
                           enum kind kind, const struct cells *cells, bool all)
{
    const bool mixed = coupling->scene->top.precision == PRECISION_MIXED;
    if (!particles->fx) return;
    particles_clear(particles->fx, particles->n); /* those without fluid nearby get no force */
    particles_clear(particles->fy, particles->n);
    particles_clear(particles->wet_x, particles->n);
    particles_clear(particles->wet_y, particles->n);
    (mixed ? find_force_mixed : find_force_double)(coupling->fluid, particles, kind, cells, all);
}

void coupling_find_forces(const struct coupling *coupling, struct particles kinds[KIND_COUNT],
                          const struct cells *cells)
{
    find_forces_on(coupling, &kinds[KIND_SOLID], KIND_SOLID, cells, false);
    if (coupling->fluid->effects & FX_MOTION)
        find_forces_on(coupling, &kinds[KIND_WALL], KIND_WALL, cells, false);
}

void coupling_show_forces(const struct coupling *coupling, struct particles kinds[KIND_COUNT],
                          const struct cells *cells)
{
    find_forces_on(coupling, &kinds[KIND_WALL], KIND_WALL, cells, true);
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
    struct particles *const particles = coupling->particles;
    const double time = last + averaging_time(coupling), weight = last / time,
                 per_time = ahead / time;
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        particles->fx[i] = extrapolated(&particles->mean_fx[i], particles->fx[i], per_time, weight);
        particles->fy[i] = extrapolated(&particles->mean_fy[i], particles->fy[i], per_time, weight);
    }
}

static void scale_force(struct particles *particles, double factor)
{
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        particles->fx[i] *= factor;
        particles->fy[i] *= factor;
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
    struct particles *const particles = coupling->particles;
    const bool impedance = coupling->impedance > 0;
    if (impedance) impulse_return(coupling, kick);
    if (impedance && coupling->ahead == 0) impulse_set_time(coupling, dt); /* no predictor */
    if (coupling->substeps && particles->mean_fx)
        extrapolate_force(coupling, 0.5 * (coupling->centred ? dt : dt - dt / n), last);
    /* Over its sub-steps the structure gets exactly the impulse given to the fluid. */
    if (kick != dt) scale_force(particles, kick / dt);
        /* The state at the start gives the mean velocity and acceleration of the step. */
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        particles->x0[i] = particles->ux[i];
        particles->y0[i] = particles->uy[i];
        particles->vx0[i] = particles->vx[i];
        particles->vy0[i] = particles->vy[i];
    }
    if (impedance) impulse_begin(coupling, implicit_is_next(coupling->solid) ? 0 : dt / n);
    implicit_advance(coupling->solid, particles, dt / n, n, coupling->centred);
    if (impedance) impulse_end(coupling);
    const double moved = solid_set_positions(particles);
    motion_after_substeps(coupling, dt);
    return moved;
}
