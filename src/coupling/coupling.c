/* SPDX-License-Identifier: MIT
 * The order of the exchange in a step of the fluid. */
#include "coupling/coupling.h"
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
    particles_clear(particles->drag_x, particles->n);
    particles_clear(particles->drag_y, particles->n);
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

/* T-36a: from the impulse that the fluid gets, for `kick`, to the force in the middle of the
 * structure's kicks; `last`: the step before. The forces of Verlet's two solutions are averaged. */
static void extrapolate_force(struct coupling *coupling, double dt, double kick, double last)
{
    struct particles *const particles = coupling->particles;
    const double weight = particles->interface_pressure_next ? 0.5 : 1;
    const double impulse = kick / dt, now = coupling->lead / dt, before = impulse + now - 1;
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        const double px = particles->fx[i] - particles->drag_x[i],
                     py = particles->fy[i] - particles->drag_y[i];
        const double old_x = last > 0 ? particles->mean_fx[i] : px,
                     old_y = last > 0 ? particles->mean_fy[i] : py;
        particles->mean_fx[i] = old_x + weight * (px - old_x);
        particles->mean_fy[i] = old_y + weight * (py - old_y);
        particles->fx[i] =
            impulse * particles->fx[i] + now * particles->mean_fx[i] - before * old_x;
        particles->fy[i] =
            impulse * particles->fy[i] + now * particles->mean_fy[i] - before * old_y;
    }
}

void coupling_predict(struct coupling *coupling, double dt)
{
    if (coupling->impedance > 0)
        impulse_set_time(coupling, dt); /* for the force of the corrector */
    motion_ahead(coupling, coupling->ahead * dt);
}

double coupling_advance(struct coupling *coupling, double dt, int n, double kick, double last)
{
    struct particles *const particles = coupling->particles;
    const bool impedance = coupling->impedance > 0;
    if (impedance) impulse_return(coupling, kick);
    if (impedance && coupling->ahead == 0) impulse_set_time(coupling, dt); /* no predictor */
    const double middle = 0.5 * (coupling->centred ? dt : dt - dt / n);
    coupling->lead = middle - coupling->ahead * dt;
    if (particles->mean_fx) extrapolate_force(coupling, dt, kick, last);
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
