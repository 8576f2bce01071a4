/* SPDX-License-Identifier: MIT
 * Leapfrog with one evaluation a step (T-32a, T-32b). Velocities are half a step behind the
 * positions, and the density follows the third-order Adams-Bashforth rule. The evaluation uses the
 * velocity extrapolated by half a step. Stable up to more than twice the step of Eqs. 22-26 for the
 * same work. */
#include <string.h>

#include "time/advance.h"
#include "time/evaluation.h"
#include "time/integrator.h"
#include "time/timestep.h"

/* T-32b: mean rate over the coming step dt from the present rates, those dt_old earlier, and those
 * dt_older before these. Equal steps: the 23/12, -16/12, 5/12 of Adams and Bashforth. */
static double extrapolated_rate(double now, double old, double older, double r, double r_old)
{
    const double first = now - old, second = first - r_old * (old - older);
    return now + 0.5 * r * first + 5.0 / 12 * r * r * second;
}

static double step_ratio(double dt, double dt_old) { return dt_old > 0 ? min2(2, dt / dt_old) : 1; }

/* The interval of an update, s, from half a step behind to half a step ahead; its ratio to the
 * previous one, and the previous one's ratio. */
struct step_sizes {
    double dt, kick, r, r_old;
};

static void update_leapfrog_rows(struct particles *p, const void *by, int64_t from, int64_t end)
{
    const struct step_sizes *const step = by;
    const double dt = step->dt, kick = step->kick, half = 0.5 * dt, r = step->r,
                 r_old = step->r_old;
#pragma omp simd
    for (int64_t i = from; i < end; i++) {
        p->vx_half[i] += kick * p->ax[i];
        p->vy_half[i] += kick * p->ay[i];
        p->x[i] += dt * p->vx_half[i];
        p->y[i] += dt * p->vy_half[i];
        p->vx[i] = p->vx_half[i] + half * p->ax[i];
        p->vy[i] = p->vy_half[i] + half * p->ay[i];
        p->dens[i] +=
            dt * extrapolated_rate(p->ddens[i], p->ddens_old[i], p->ddens_older[i], r, r_old);
    }
}

static void update_fluid(struct simulation *s, double dt, double dt_old, double dt_older)
{
    struct particles *const p = &s->kind[KIND_FLUID];
    const struct step_sizes by = {dt, 0.5 * (dt_old + dt), step_ratio(dt, dt_old),
                                  step_ratio(dt_old, dt_older)};
    if (!(dt_old > 0)) { /* the first step has no earlier rates */
        memcpy(p->ddens_old, p->ddens, (size_t)p->n * sizeof *p->ddens);
        memcpy(p->ddens_older, p->ddens, (size_t)p->n * sizeof *p->ddens);
    }
    advance_fluid(s, update_leapfrog_rows, &by);
    /* Swaps the arrays of old rates; the next evaluation overwrites the oldest. */
    double *const oldest = p->ddens_older;
    p->ddens_older = p->ddens_old;
    p->ddens_old = p->ddens;
    p->ddens = oldest;
}

static void leapfrog_step(struct simulation *s, double t_limit)
{
    struct state *const st = &s->state;
    evaluate_start(s);
    double clock = wall_clock();
    bool hits;
    const double dt = timestep_choose(s, t_limit, &hits), dt_old = st->dt;
    energy_of_step(s, dt);
    update_fluid(s, dt, dt_old, st->dt_old);
    clock = phase_add(s, PHASE_update, clock);
    if (s->effects & FX_COUPLING) advance_structure(s, dt, 0.5 * (dt_old + dt));
    clock = phase_add(s, PHASE_solid, clock);
    timestep_book(s, dt, t_limit, hits);
    phase_add(s, PHASE_update, clock);
}

const struct integrator integrator_leapfrog = {
    .step = leapfrog_step,
    .largest_cfl = 0.6,
    .density_decay = 6.0 / 11, /* of Adams and Bashforth's third-order rule */
    .velocity_decay = 1,       /* its velocity is used half a step late */
    .centred = true,
};
