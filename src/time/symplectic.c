/* SPDX-License-Identifier: MIT
 * Symplectic predictor-corrector (Eqs. 22-24) of the article: two evaluations a step. With solid
 * sub-steps the predictor extrapolates the structure (T-35), and the corrector's force acts on both
 * sides over the whole step. */
#include "time/advance.h"
#include "time/timestep.h"

static void swap_fields(double **a, double **b)
{
    double *const field = *a;
    *a = *b;
    *b = field;
}

/* The state at the start of the step and the predicted one change places. */
static void swap_states(struct particles *particles)
{
    swap_fields(&particles->x, &particles->x0);
    swap_fields(&particles->y, &particles->y0);
    swap_fields(&particles->vx, &particles->vx0);
    swap_fields(&particles->vy, &particles->vy0);
    swap_fields(&particles->dens, &particles->dens_half);
}

/* Writes the predicted state to the fields, for effects that read it there. Otherwise the sweeps
 * predict by themselves (`predict_by`). */
static void predict_fields(struct particles *particles, double half)
{
    swap_states(particles);
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        particles->x[i] = particles->x0[i] + half * particles->vx0[i]; /* Eq. 22a */
        particles->y[i] = particles->y0[i] + half * particles->vy0[i];
        particles->vx[i] = particles->vx0[i] + half * particles->ax[i]; /* Eq. 22b */
        particles->vy[i] = particles->vy0[i] + half * particles->ay[i];
        particles->dens[i] = particles->dens_half[i] + half * particles->ddens[i]; /* Eq. 24a */
    }
}

/* From the start of the step to its end; dens_half is predicted. */
static void correct_range(struct particles *particles, const void *parameters, int64_t from,
                          int64_t end)
{
    const double dt = *(const double *)parameters;
#pragma omp simd
    for (int64_t i = from; i < end; i++) {
        const double vx = particles->vx[i], vy = particles->vy[i], dens = particles->dens[i];
        particles->vx[i] = vx + dt * particles->ax[i]; /* Eq. 23a */
        particles->vy[i] = vy + dt * particles->ay[i];
        particles->x[i] += 0.5 * dt * (particles->vx[i] + vx); /* Eq. 23b */
        particles->y[i] += 0.5 * dt * (particles->vy[i] + vy);
        /* Eq. 24b, less 1, without cancellation. */
        const double eps = -particles->ddens[i] / (1 + particles->dens_half[i]) * dt;
        particles->dens[i] = dens - (1 + dens) * 2 * eps / (2 + eps);
    }
}

static void rates_of_solid(struct simulation *sim)
{
    solid_stress(&sim->solid, &sim->particles[KIND_SOLID]);
    solid_forces(&sim->solid, &sim->particles[KIND_SOLID]);
    sim->state.solid_evaluations++;
}

/* The solid has the same two stages as the fluid. */
static void predict_solid(struct particles *particles, double half)
{
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        particles->ux0[i] = particles->ux[i];
        particles->uy0[i] = particles->uy[i];
        particles->vx0[i] = particles->vx[i];
        particles->vy0[i] = particles->vy[i];
        particles->ux[i] += half * particles->vx[i]; /* Eq. 22 */
        particles->uy[i] += half * particles->vy[i];
        particles->vx[i] += half * particles->sx[i];
        particles->vy[i] += half * particles->sy[i];
    }
}

static void correct_solid(struct particles *particles, double dt)
{
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        particles->vx[i] = particles->vx0[i] + dt * particles->sx[i]; /* Eq. 23 */
        particles->vy[i] = particles->vy0[i] + dt * particles->sy[i];
        particles->ux[i] = particles->ux0[i] + 0.5 * dt * (particles->vx[i] + particles->vx0[i]);
        particles->uy[i] = particles->uy0[i] + 0.5 * dt * (particles->vy[i] + particles->vy0[i]);
    }
}

/* The first half of the solid's step of the same length as the fluid's, with the interface. */
static void predict_at_single_rate(struct simulation *sim, double dt)
{
    predict_solid(&sim->particles[KIND_SOLID], 0.5 * dt);
    sim->solid.time = scene_time(sim, sim->state.time + 0.5 * dt);
    solid_place_clamps(&sim->solid, &sim->particles[KIND_SOLID], sim->solid.time);
    coupling_move_at_single_rate(&sim->coupling, 0);
}

static void correct_at_single_rate(struct simulation *sim, double dt)
{
    struct particles *const solid = &sim->particles[KIND_SOLID];
    correct_solid(solid, dt);
    energy_book_solid(sim, dt, 1);
    solid_finish_kick(&sim->solid, solid, solid->vx0, solid->vy0, dt);
    solid_place_clamps(&sim->solid, solid, scene_time(sim, sim->state.time + dt));
    coupling_move_at_single_rate(&sim->coupling, coupling_acceleration_weight(&sim->coupling, dt));
    sim->state.solid_substeps++;
    sim->substeps = 1;
}

static void symplectic_step(struct simulation *sim, double t_limit)
{
    const bool multirate = sim->effects & FX_MULTIRATE;
    const bool single_rate = sim->effects & FX_COUPLING && !multirate;
    const double time = sim->state.time;
    evaluate_start(sim);
    double clock = phase_clock();
    if (single_rate) rates_of_solid(sim);
    clock = phase_add(sim, PHASE_solid, clock);

    bool hits;
    const double dt = timestep_choose(sim, t_limit, &hits);
    energy_book_exchange(sim);
    energy_test_if_due(sim);
    const bool needs_fields =
        sim->effects & (FX_OPEN | FX_DAMPING_ZONE) || sim->force_hook[KIND_FLUID].accelerate;
    if (needs_fields)
        predict_fields(&sim->particles[KIND_FLUID], 0.5 * dt);
    else
        sim->fluid.predict_by = 0.5 * dt;
    if (multirate) coupling_predict(&sim->coupling, dt);
    if (single_rate) predict_at_single_rate(sim, dt);
    phase_add(sim, PHASE_update, clock);

    sim->state.evaluations++;
    evaluate_rates(sim, time + 0.5 * dt);
    sim->fluid.predict_by = 0;
    energy_book_evaluation(sim, dt);
    clock = phase_clock();
    if (sim->effects & FX_RIGID) begin_rigid(sim, dt, dt);
    if (multirate) advance_solids(sim, dt, dt);
    if (single_rate) rates_of_solid(sim);
    clock = phase_add(sim, PHASE_solid, clock);

    if (needs_fields) swap_states(&sim->particles[KIND_FLUID]);
    advance_fluid(sim, correct_range, &dt);
    if (single_rate) correct_at_single_rate(sim, dt);
    clock = phase_add(sim, PHASE_update, clock);
    if (sim->effects & FX_BEAM) advance_beams(sim, dt, dt);
    if (sim->effects & FX_RIGID) advance_rigid(sim, dt, dt);
    clock = phase_add(sim, PHASE_solid, clock);
    timestep_end_fluid_step(sim, dt, t_limit, hits);
    phase_add(sim, PHASE_update, clock);
}

static void symplectic_solid(struct simulation *sim, double dt)
{
    struct particles *const particles = &sim->particles[KIND_SOLID];
    rates_of_solid(sim);
    predict_solid(particles, 0.5 * dt);
    sim->solid.time += 0.5 * dt;
    solid_place_clamps(&sim->solid, particles, sim->solid.time);
    rates_of_solid(sim);
    correct_solid(particles, dt);
    solid_finish_kick(&sim->solid, particles, particles->vx0, particles->vy0, dt);
    sim->solid.time += 0.5 * dt;
    solid_place_clamps(&sim->solid, particles, sim->solid.time);
}

const struct integrator integrator_symplectic = {
    .step = symplectic_step,
    .solid_step = symplectic_solid,
    .largest_cfl = 0.4,
    .density_decay = 2,
    .velocity_decay = 2,
    .fluid_groups = G_START | G_START_FLUID,
    .rates_at = 0.5,
    .centred = true,
};
