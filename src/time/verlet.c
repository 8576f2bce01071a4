/* SPDX-License-Identifier: MIT
 * Verlet for the fluid with an Euler step every N_s (Eqs. 25-26), semi-implicit Euler for the solid
 * (Eq. 27): one evaluation a step. */
#include "time/advance.h"
#include "time/evaluation.h"
#include "time/integrator.h"
#include "time/timestep.h"

/* Eq. 25, or Eq. 26 with `euler`. With variable steps the 2 dt of Eq. 25 is the time since the
 * previous state, dt_old + dt: as printed, a free fall would lose g (dt_old - dt). */
struct step_sizes {
    double dt, dt_old;
    bool euler;
};

static void update_verlet_rows(struct particles *p, const void *by, int64_t from, int64_t end)
{
    const struct step_sizes *const step = by;
    const bool euler = step->euler;
    const double dt = step->dt, kick = euler ? dt : step->dt_old + dt;
#pragma omp simd
    for (int64_t i = from; i < end; i++) {
        const double vx = p->vx[i], vy = p->vy[i], dens = p->dens[i];
        p->x[i] += dt * vx + 0.5 * dt * dt * p->ax[i];
        p->y[i] += dt * vy + 0.5 * dt * dt * p->ay[i];
        p->vx[i] = (euler ? vx : p->vx_old[i]) + kick * p->ax[i];
        p->vy[i] = (euler ? vy : p->vy_old[i]) + kick * p->ay[i];
        p->dens[i] = (euler ? dens : p->dens_old[i]) + kick * p->ddens[i];
        p->vx_old[i] = vx;
        p->vy_old[i] = vy;
        p->dens_old[i] = dens;
    }
}

static void verlet_step(struct simulation *s, double t_limit)
{
    evaluate_start(s);
    double clock = wall_clock();
    bool hits;
    const double dt = timestep_choose(s, t_limit, &hits);
    const bool euler = s->state.verlet_count == 0;
    s->state.verlet_count = (s->state.verlet_count + 1) % s->scene->numerics.verlet_reset;
    energy_of_step(s, dt);
    if (euler) energy_of_restart(s);
    advance_fluid(s, update_verlet_rows, &(struct step_sizes){dt, s->state.dt, euler});
    clock = phase_add(s, PHASE_update, clock);
    if (s->effects & FX_COUPLING) advance_structure(s, dt, dt);
    clock = phase_add(s, PHASE_solid, clock);
    timestep_book(s, dt, t_limit, hits);
    phase_add(s, PHASE_update, clock);
}

const struct integrator integrator_verlet = {
    .step = verlet_step,
    .largest_cfl = 0.2,
    .density_decay = 2,
    .velocity_decay = 2,
    .alternates = true,
};
