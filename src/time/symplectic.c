/* SPDX-License-Identifier: MIT
 * Symplectic predictor-corrector (Eqs. 22-24) of the paper: two evaluations a step. With solid
 * sub-steps the predictor extrapolates the structure (T-35), and the corrector's force acts on both
 * sides over the whole step. */
#include "coupling/motion.h"
#include "time/advance.h"
#include "time/evaluation.h"
#include "time/integrator.h"
#include "time/timestep.h"

static void predict_fluid(struct particles *p, double half)
{
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        p->x0[i] = p->x[i];
        p->y0[i] = p->y[i];
        p->vx0[i] = p->vx[i];
        p->vy0[i] = p->vy[i];
        p->dens0[i] = p->dens[i];
        p->x[i] += half * p->vx[i]; /* Eq. 22a */
        p->y[i] += half * p->vy[i];
        p->vx[i] += half * p->ax[i]; /* Eq. 22b */
        p->vy[i] += half * p->ay[i];
        p->dens[i] += half * p->ddens[i]; /* Eq. 24a */
    }
}

static void correct_rows(struct particles *p, const void *by, int64_t from, int64_t end)
{
    const double dt = *(const double *)by;
#pragma omp simd
    for (int64_t i = from; i < end; i++) {
        p->vx[i] = p->vx0[i] + dt * p->ax[i]; /* Eq. 23a */
        p->vy[i] = p->vy0[i] + dt * p->ay[i];
        p->x[i] = p->x0[i] + 0.5 * dt * (p->vx[i] + p->vx0[i]); /* Eq. 23b */
        p->y[i] = p->y0[i] + 0.5 * dt * (p->vy[i] + p->vy0[i]);
        /* Eq. 24b, less 1, without cancellation. */
        const double eps = -p->ddens[i] / (1 + p->dens[i]) * dt;
        p->dens[i] = p->dens0[i] - (1 + p->dens0[i]) * 2 * eps / (2 + eps);
    }
}

static void rates_of_solid(struct simulation *s)
{
    solid_stress(&s->solid, &s->kind[KIND_SOLID]);
    solid_forces(&s->solid, &s->kind[KIND_SOLID]);
    s->state.solid_evaluations++;
}

/* The solid has the same two stages as the fluid. */
static void predict_solid(struct particles *p, double half)
{
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        p->x0[i] = p->ux[i];
        p->y0[i] = p->uy[i];
        p->vx0[i] = p->vx[i];
        p->vy0[i] = p->vy[i];
        p->ux[i] += half * p->vx[i]; /* Eq. 22 */
        p->uy[i] += half * p->vy[i];
        p->vx[i] += half * p->sx[i];
        p->vy[i] += half * p->sy[i];
    }
}

static void correct_solid(struct particles *p, double dt)
{
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        p->vx[i] = p->vx0[i] + dt * p->sx[i]; /* Eq. 23 */
        p->vy[i] = p->vy0[i] + dt * p->sy[i];
        p->ux[i] = p->x0[i] + 0.5 * dt * (p->vx[i] + p->vx0[i]);
        p->uy[i] = p->y0[i] + 0.5 * dt * (p->vy[i] + p->vy0[i]);
    }
}

static void symplectic_step(struct simulation *s, double t_limit)
{
    struct particles *const fluid = &s->kind[KIND_FLUID], *const solid = &s->kind[KIND_SOLID];
    const bool coupled = s->effects & FX_COUPLING, multirate = s->effects & FX_MULTIRATE;
    const double time = s->state.time;
    evaluate_start(s);
    double clock = wall_clock();
    if (coupled && !multirate) rates_of_solid(s);
    clock = phase_add(s, PHASE_solid, clock);

    bool hits;
    const double dt = timestep_choose(s, t_limit, &hits);
    energy_test_due(s);
    predict_fluid(fluid, 0.5 * dt);
    if (coupled && multirate) coupling_predict(&s->coupling, dt, s->state.dt);
    if (coupled && !multirate) {
        predict_solid(solid, 0.5 * dt);
        s->solid.time = time + 0.5 * dt;
        solid_place_clamps(&s->solid, solid, s->solid.time);
        motion_at_single_rate(&s->coupling, 0);
    }
    phase_add(s, PHASE_update, clock);

    evaluate_fluid(s, time + 0.5 * dt);
    energy_of_midpoint(s, dt);
    clock = wall_clock();
    if (coupled && multirate) advance_structure(s, dt, dt);
    if (coupled && !multirate) rates_of_solid(s);
    clock = phase_add(s, PHASE_solid, clock);

    advance_fluid(s, correct_rows, &dt);
    if (coupled && !multirate) {
        correct_solid(solid, dt);
        energy_of_solid(s, dt, 1, true);
        solid_book_work(&s->solid, solid, solid->vx0, solid->vy0, dt);
        solid_place_clamps(&s->solid, solid, time + dt);
        motion_at_single_rate(&s->coupling, dt / (dt + averaging_time(&s->coupling)));
        s->state.solid_substeps++;
        s->substeps = 1;
    }
    timestep_book(s, dt, t_limit, hits);
    phase_add(s, PHASE_update, clock);
}

static void symplectic_solid(struct simulation *s, double dt)
{
    struct particles *const p = &s->kind[KIND_SOLID];
    rates_of_solid(s);
    predict_solid(p, 0.5 * dt);
    s->solid.time += 0.5 * dt;
    solid_place_clamps(&s->solid, p, s->solid.time);
    rates_of_solid(s);
    correct_solid(p, dt);
    solid_book_work(&s->solid, p, p->vx0, p->vy0, dt);
    s->solid.time += 0.5 * dt;
    solid_place_clamps(&s->solid, p, s->solid.time);
}

const struct integrator integrator_symplectic = {
    .step = symplectic_step,
    .solid_step = symplectic_solid,
    .largest_cfl = 0.4,
    .density_decay = 2,
    .velocity_decay = 2,
    .fluid_groups = G_STAGE | G_STAGE_FLUID,
    .ahead = 0.5,
    .centred = true,
};
