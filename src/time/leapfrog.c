/* SPDX-License-Identifier: MIT
 * Leapfrog with one evaluation a step (T-32a, T-32b). Velocities are half a step behind the
 * positions, and the density follows the third-order Adams-Bashforth rule. The evaluation uses the
 * velocity extrapolated by half a step. Stable up to more than twice the step of Eqs. 22-26 for the
 * same work. */
#include "time/advance.h"

/* T-32b: mean rate over the coming step dt from the present rates, those dt_old earlier, and those
 * dt_older before these. Equal steps: the 23/12, -16/12, 5/12 of Adams and Bashforth. */
static double extrapolated_rate(double now, double old, double older, double r, double r_old)
{
    const double first = now - old, second = first - r_old * (old - older);
    return now + 0.5 * r * first + 5.0 / 12 * r * r * second;
}

static double step_ratio(double dt, double dt_old) { return dt_old > 0 ? min2(2, dt / dt_old) : 1; }

/* The interval of an update, s; its ratio to the one before, and that one's. */
struct leapfrog_step {
    double dt, kick, r, r_old;
};

static void update_leapfrog_range(struct particles *particles, const void *parameters, int64_t from,
                                  int64_t end)
{
    const struct leapfrog_step *const step = parameters;
    const double dt = step->dt, kick = step->kick, half = 0.5 * dt, r = step->r,
                 r_old = step->r_old;
#pragma omp simd
    for (int64_t i = from; i < end; i++) {
        particles->vx_half[i] += kick * particles->ax[i];
        particles->vy_half[i] += kick * particles->ay[i];
        particles->x[i] += dt * particles->vx_half[i];
        particles->y[i] += dt * particles->vy_half[i];
        particles->vx[i] = particles->vx_half[i] + half * particles->ax[i];
        particles->vy[i] = particles->vy_half[i] + half * particles->ay[i];
        particles->dens[i] += dt * extrapolated_rate(particles->ddens[i], particles->ddens_old[i],
                                                     particles->ddens_older[i], r, r_old);
    }
}

static void update_leapfrog(struct simulation *sim, double dt)
{
    struct particles *const particles = &sim->particles[KIND_FLUID];
    const double dt_old = sim->state.dt;
    const struct leapfrog_step step = {dt, 0.5 * (dt_old + dt), step_ratio(dt, dt_old),
                                       step_ratio(dt_old, sim->state.dt_old)};
    if (!(dt_old > 0)) { /* the first step has no earlier rates */
        memcpy(particles->ddens_old, particles->ddens,
               (size_t)particles->n * sizeof *particles->ddens);
        memcpy(particles->ddens_older, particles->ddens,
               (size_t)particles->n * sizeof *particles->ddens);
    }
    advance_fluid(sim, update_leapfrog_range, &step);
    /* Swaps the arrays of old rates; the next evaluation overwrites the oldest. */
    double *const oldest = particles->ddens_older;
    particles->ddens_older = particles->ddens_old;
    particles->ddens_old = particles->ddens;
    particles->ddens = oldest;
}

const struct integrator integrator_leapfrog = {
    .step = step_of_one_stage,
    .update = update_leapfrog,
    .largest_cfl = 0.6,
    .density_decay = 6.0 / 11, /* of Adams and Bashforth's third-order rule */
    .velocity_decay = 1,       /* its velocity is used half a step late */
    .centred = true,
};
