/* SPDX-License-Identifier: MIT
 * Steps of solids, rigid bodies and beams without fluid. */
#include "time/advance.h"
#include "time/guards.h"
#include "time/timestep.h"

/* n steps; implicit ones have explicit sub-steps while surfaces are near each other. */
static void advance_lone(struct simulation *sim, double dt, int n)
{
    const struct integrator *const integrator = sim->integrator;
    struct solid *const solid = &sim->solid;
    sim->substeps = 1;
    if (solid->implicit && solid->contact)
        sim->substeps = (int)max2(1, min2(whole_parts(dt / sim->dt_solid), SUBSTEPS_MOST + 1));
    const int all = n * sim->substeps;
    sim->state.solid_substeps += all;
    if (!(sim->effects & FX_SOLID)) return;
    if (integrator->solid_step && !solid->implicit) {
        for (int k = 0; k < n; k++) integrator->solid_step(sim, dt);
    } else {
        implicit_advance(solid, &sim->particles[KIND_SOLID], dt / sim->substeps, all);
        sim->state.solid_evaluations += all;
    }
}

/* When a contact is near, each step is chosen separately and may be shorter than planned. Where
 * surfaces are pressed so hard that the material may fail, the guards judge each step: *n becomes
 * the number of steps taken, and *cut the time by which they were shorter. */
static enum err advance_batch(struct simulation *sim, bool near, double dt, int *n, double *cut,
                              struct diag *d)
{
    struct state *const st = &sim->state;
    const double start = st->time;
    for (int k = 0, part; k < *n; k += part) {
        double step = dt;
        if (near && k) timestep_watch_contact(sim, sim->solid.time, SOLID_BATCH);
        if (near && k && guards_contact_hard(sim)) {
            *n = k;
            break;
        }
        const bool chosen = near && !sim->solid.implicit && !(sim->scene->numerics.fixed_step > 0);
        if (chosen) step = min2(dt, sim->dt_solid);
        part = near ? 1 : *n - k;
        if (sim->observer.context) /* up to the state before a time observed, then over it */
            part = (int)max2(1, min2(floor((sim->observer.next - st->time) / step - 1e-6), part));
        if (k && sim->observer.context) solid_set_positions(&sim->particles[KIND_SOLID]);
        TRY(observe(sim, st->time + (part + 1e-6) * step, d));
        if (sim->effects & FX_RIGID) begin_rigid(sim, step, step);
        advance_lone(sim, step, part);
        if (sim->effects & FX_BEAM) advance_beams(sim, step, step);
        if (sim->effects & FX_RIGID) advance_rigid(sim, step, step);
        *cut += dt - step;
        st->time = start + ((k + part) * dt - *cut);
        st->dt_min = st->steps || k ? min2(st->dt_min, step) : step;
    }
    return ERR_OK;
}

/* `verlet` kicks at the start of a step (T-32), the others in its middle (T-30, T-36). */
static void find_hook_forces_for_step(struct simulation *sim, double dt)
{
    struct particles *const particles = &sim->particles[KIND_SOLID];
    const double half = sim->solid.centred ? 0.5 * dt : 0;
    for (int64_t i = 0; half > 0 && i < particles->n; i++) {
        particles->x[i] += half * particles->vx[i];
        particles->y[i] += half * particles->vy[i];
    }
    find_hook_forces(sim, KIND_SOLID, sim->state.time + half);
}

/* Adds the work of a program's accelerations on each body over dt, at the present velocities. */
static void add_hook_work(struct simulation *sim, double dt)
{
    const struct particles *const particles = &sim->particles[KIND_SOLID];
    const struct force_hook *const hook = &sim->force_hook[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++)
        energy_supply(sim, KIND_SOLID, particles->body[i],
                      dt * sim->solid.body[particles->body[i]].mass * particles->free[i] *
                          (hook->ax[i] * particles->vx[i] + hook->ay[i] * particles->vy[i]));
}

int simulation_batch(const struct simulation *sim)
{
    const bool single = sim->effects & FX_FLUID || sim->solid.force_hook || sim->gravity_varies ||
                        sim->solid.implicit || sim->rigid.n || sim->beams.n;
    return single ? 1 : SOLID_BATCH;
}

enum err step_without_fluid(struct simulation *sim, double t_limit, struct diag *d)
{
    struct state *const st = &sim->state;
    const double start = phase_clock(), before = phases_so_far(sim), begin = st->time;
    const bool implicit = sim->solid.implicit != NULL;
    const bool near = timestep_watch_contact(sim, sim->solid.time, implicit ? 1 : SOLID_BATCH);
    const double bound = timestep_bound(sim);
    const bool hook = sim->solid.force_hook != NULL;
    const int batch = simulation_batch(sim);
    /* Rounding of the times must not add a step. */
    const double left = t_limit - begin, steps = max2(1, ceil(left / bound - 1e-6));
    const bool hits = steps <= batch;
    const double dt = hits ? left / steps : bound, end = hits ? t_limit : begin + batch * dt;
    const int planned = hits ? (int)steps : batch;
    int n = planned;
    double cut = 0;
    if (hook) find_hook_forces_for_step(sim, dt);
    if (hook) add_hook_work(sim, 0.5 * dt);
    TRY(advance_batch(sim, near, dt, &n, &cut, d));
    if (hook) add_hook_work(sim, st->time - begin - 0.5 * dt);
    if (n == planned && cut == 0) st->time = end;
    solid_set_positions(&sim->particles[KIND_SOLID]);
    phase_add(sim, PHASE_solid, start + (phases_so_far(sim) - before));
    timestep_count(sim, dt, n);
    return ERR_OK;
}
