/* SPDX-License-Identifier: MIT
 * How fluid, solids, rigid bodies and beams advance in a step, for all integrators. */
#include "time/advance.h"
#include "time/timestep.h"

void advance_solids(struct simulation *sim, double dt, double rates_time)
{
    const int n = timestep_substeps(sim, dt);
    sim->sorting.solid_move =
        coupling_advance(&sim->coupling, dt, n, rates_time, !(sim->state.dt > 0));
    energy_book_solid(sim, dt, n);
    sim->substeps = n;
    sim->state.solid_substeps += n;
    sim->state.solid_evaluations += n;
}

void begin_rigid(struct simulation *sim, double dt, double rates_time)
{
    const double time = sim->state.time;
    double gravity[2];
    scene_gravity_at(sim->scene, time + (sim->rigid.mid_step ? 0.5 * dt : 0), gravity);
    rigid_begin(&sim->rigid, gravity, time, dt, rates_time);
}

void advance_rigid(struct simulation *sim, double dt, double rates_time)
{
    rigid_advance(&sim->rigid, sim->state.time, dt, rates_time);
    for (int k = 0; k < sim->rigid.n; k++) {
        const struct rigid_body *const b = &sim->rigid.body[k];
        energy_book_body(sim, scene_rigid_wall(sim->scene, k), b->received, b->driven,
                         b->through_springs);
    }
}

void advance_beams(struct simulation *sim, double dt, double rates_time)
{
    const struct beam_times times = {dt, sim->state.dt, rates_time};
    beams_advance(&sim->beams, sim->state.time, &times);
    for (int k = 0; k < sim->beams.n; k++) {
        const struct beam *const b = &sim->beams.beam[k];
        energy_book_body(sim, scene_beam_wall(sim->scene, k), b->received, b->driven, 0);
    }
}

/* The extremes over a range of fluid particles, without branches. */
static struct extremes extremes_of(const struct particles *particles, int64_t from, int64_t end)
{
    vdouble low = vset_double(0), high = low, speed2 = low, nan_probe = low;
    int64_t i = from;
    for (; i + LANES_DOUBLE <= end; i += LANES_DOUBLE) {
        const vdouble vx = vload_double(&particles->vx[i]), vy = vload_double(&particles->vy[i]);
        const vdouble d = vload_double(&particles->dens[i]), v2 = vx * vx + vy * vy;
        low = vmin_double(d, low);
        high = vmax_double(d, high);
        speed2 = vmax_double(v2, speed2);
        nan_probe = nan_probe + (v2 + d) * 0.0;
    }
    struct extremes e = {-vtop_double(-low), vtop_double(high), vtop_double(speed2),
                         vsum_double(nan_probe)};
    for (; i < end; i++) {
        const double v2 = particles->vx[i] * particles->vx[i] + particles->vy[i] * particles->vy[i];
        e.dens_low = min2(e.dens_low, particles->dens[i]);
        e.dens_high = max2(e.dens_high, particles->dens[i]);
        e.speed2 = max2(e.speed2, v2);
        e.nan_probe += 0 * (v2 + particles->dens[i]);
    }
    return e;
}

/* Updates the fluid and finds its extremes block by block, while a block is in the cache. */
void advance_fluid(struct simulation *sim, advance_range *range, const void *parameters)
{
    enum { BLOCK = 256 }; /* particles whose fields stay in the first-level cache */
    struct particles *const particles = &sim->particles[KIND_FLUID];
    double low = 0, high = 0, speed2 = 0, nan_probe = 0;
#pragma omp parallel for schedule(static) reduction(min : low) reduction(max : high, speed2) \
    reduction(+ : nan_probe)
    for (int64_t from = 0; from < particles->n; from += BLOCK) {
        const int64_t end = from + BLOCK < particles->n ? from + BLOCK : particles->n;
        if (range) range(particles, parameters, from, end);
        const struct extremes e = extremes_of(particles, from, end);
        low = min2(low, e.dens_low);
        high = max2(high, e.dens_high);
        speed2 = max2(speed2, e.speed2);
        nan_probe += e.nan_probe;
    }
    sim->extremes = (struct extremes){low, high, speed2, nan_probe};
}

void update_extremes(struct simulation *sim) { advance_fluid(sim, NULL, NULL); }

void find_speed(struct simulation *sim)
{
    const struct particles *const solid = &sim->particles[KIND_SOLID];
    double largest = sim->extremes.speed2;
#pragma omp parallel for schedule(static) reduction(max : largest) if (solid->n > 0)
    for (int64_t i = 0; i < solid->n; i++)
        largest = max2(largest, solid->vx[i] * solid->vx[i] + solid->vy[i] * solid->vy[i]);
    sim->sorting.speed2 = largest;
    if (sim->effects & FX_MOTION)
        sim->sorting.speed2 =
            max2(sim->sorting.speed2,
                 wall_motion_speed2(&sim->wall_motion, &sim->particles[KIND_WALL]));
}

void step_of_one_stage(struct simulation *sim, double t_limit)
{
    const struct integrator *const integrator = sim->integrator;
    evaluate_start(sim);
    double clock = phase_clock();
    bool hits;
    const double dt = timestep_choose(sim, t_limit, &hits);
    const double rates_time = 0.5 * (sim->state.dt + dt);
    energy_book_step(sim, dt);
    integrator->update(sim, dt);
    clock = phase_add(sim, PHASE_update, clock);
    if (sim->effects & FX_RIGID) begin_rigid(sim, dt, rates_time);
    /* Solids get Verlet's force for dt (T-35b), rigid bodies and beams over the mean step. */
    if (sim->effects & FX_COUPLING)
        advance_solids(sim, dt, integrator->alternates ? dt : rates_time);
    if (sim->effects & FX_BEAM) advance_beams(sim, dt, rates_time);
    if (sim->effects & FX_RIGID) advance_rigid(sim, dt, rates_time);
    clock = phase_add(sim, PHASE_solid, clock);
    timestep_end_fluid_step(sim, dt, t_limit, hits);
    phase_add(sim, PHASE_update, clock);
}
