/* SPDX-License-Identifier: MIT
 * Verlet for the fluid with an Euler step every N_s (Eqs. 25-26), semi-implicit Euler for the solid
 * (Eq. 27): one evaluation a step. */
#include "time/advance.h"

/* Eq. 25, or Eq. 26 with `euler`. With variable steps the 2 dt of Eq. 25 is the time since the
 * previous state, dt_old + dt: as printed, a free fall would lose g (dt_old - dt). */
struct verlet_step {
    double dt, dt_old;
    bool euler;
};

static void update_verlet_range(struct particles *particles, const void *parameters, int64_t from,
                                int64_t end)
{
    const struct verlet_step *const step = parameters;
    const bool euler = step->euler;
    const double dt = step->dt, kick = euler ? dt : step->dt_old + dt;
#pragma omp simd
    for (int64_t i = from; i < end; i++) {
        const double vx = particles->vx[i], vy = particles->vy[i], dens = particles->dens[i];
        particles->x[i] += dt * vx + 0.5 * dt * dt * particles->ax[i];
        particles->y[i] += dt * vy + 0.5 * dt * dt * particles->ay[i];
        particles->vx[i] = (euler ? vx : particles->vx_old[i]) + kick * particles->ax[i];
        particles->vy[i] = (euler ? vy : particles->vy_old[i]) + kick * particles->ay[i];
        particles->dens[i] = (euler ? dens : particles->dens_old[i]) + kick * particles->ddens[i];
        particles->vx_old[i] = vx;
        particles->vy_old[i] = vy;
        particles->dens_old[i] = dens;
    }
}

static void update_verlet(struct simulation *sim, double dt)
{
    const bool euler = sim->state.verlet_count == 0;
    sim->state.verlet_count = (sim->state.verlet_count + 1) % sim->scene->numerics.verlet_reset;
    advance_fluid(sim, update_verlet_range, &(struct verlet_step){dt, sim->state.dt, euler});
}

const struct integrator integrator_verlet = {
    .step = step_of_one_stage,
    .update = update_verlet,
    .largest_cfl = 0.2,
    .density_decay = 2,
    .velocity_decay = 2,
    .alternates = true,
};
