/* SPDX-License-Identifier: MIT
 * Steps of a solid without fluid. */
#include "time/solid_steps.h"

#include <math.h>

#include "time/evaluation.h"
#include "time/guards.h"
#include "time/timestep.h"
#include "time/energy.h"

/* Steps of a solid without fluid between two checks of its state. */
enum { SOLID_BATCH = CHECK_INTERVAL };

/* Bounds of a solid without fluid; returns the smallest. */
static enum bound lone_bounds(struct simulation *sim)
{
    const double fixed = sim->scene->numerics.fixed_step;
    for (int k = 0; k < BOUND_COUNT; k++) sim->dt_bound[k] = (double)INFINITY;
    if (fixed > 0) {
        sim->dt_bound[BOUND_fixed] = fixed;
        return BOUND_fixed;
    }
    sim->dt_bound[BOUND_solid] = sim->dt_lone_solid;
    if (sim->solid.implicit && sim->solid.contact) /* as beside fluid */
        sim->dt_bound[BOUND_contact] = sim->contact.approach;
    if (sim->solid.implicit)
        return sim->dt_bound[BOUND_contact] < sim->dt_lone_solid ? BOUND_contact : BOUND_solid;
    if (!(sim->dt_solid < sim->dt_lone_solid)) return BOUND_solid;
    sim->dt_bound[BOUND_contact] = sim->dt_solid;
    return BOUND_contact;
}

static void advance_lone(struct simulation *sim, double dt, int n)
{
    const struct integrator *const by = sim->integrator;
    if (by->solid_step && !sim->solid.implicit) {
        for (int k = 0; k < n; k++) by->solid_step(sim, dt);
    } else {
        solid_advance(&sim->solid, &sim->kind[KIND_SOLID], dt, n, sim->coupling.centred);
        sim->state.solid_evaluations += n;
    }
}

/* One implicit step, or while surfaces are near each other explicit sub-steps. */
static void advance_implicit(struct simulation *sim, double dt)
{
    const double needed = sim->solid.contact ? ceil(dt / sim->dt_solid * (1 - 1e-9)) : 1;
    sim->substeps = (int)max2(1, min2(needed, SUBSTEPS_MOST + 1));
    advance_lone(sim, dt / sim->substeps, sim->substeps);
    sim->state.solid_substeps += sim->substeps - 1;
}

/* When a contact is near, each step is chosen separately and may be shorter than planned.
 * Where surfaces are pressed so hard that the material may fail, the guards judge each step.
 * Returns the time advanced, or 0 if all *n steps were as long as planned. */
static double advance_near(struct simulation *sim, double dt, int *n)
{
    double advanced = 0;
    bool shorter = false;
    for (int k = 0; k < *n; k++) {
        if (k) timestep_watch_contact(sim, sim->solid.time, SOLID_BATCH);
        if (k && guards_contact_hard(sim)) {
            shorter = true;
            *n = k;
            break;
        }
        const bool cut = !(sim->scene->numerics.fixed_step > 0) && sim->dt_solid < dt;
        const double now = cut ? sim->dt_solid : dt;
        advance_lone(sim, now, 1);
        advanced += now;
        shorter |= cut;
        sim->state.dt_min = sim->state.steps || k ? min2(sim->state.dt_min, now) : now;
    }
    return shorter ? advanced : 0;
}

/* `verlet` kicks at the start of a step (T-32), the others in its middle (T-30, T-36). The
 * positions after the step follow later. */
static void external_for_step(struct simulation *sim, double dt)
{
    struct particles *const particles = &sim->kind[KIND_SOLID];
    const double half = sim->coupling.centred ? 0.5 * dt : 0;
    for (int64_t i = 0; half > 0 && i < particles->n; i++) {
        particles->x[i] += half * particles->vx[i];
        particles->y[i] += half * particles->vy[i];
    }
    find_external(sim, KIND_SOLID, sim->state.time + half);
}

static void book_lone(struct simulation *sim, double dt, int n, enum bound binding)
{
    struct state *const st = &sim->state;
    st->dt_min = st->steps ? min2(st->dt_min, dt) : dt;
    st->dt_max = max2(st->dt_max, dt);
    st->dt = dt;
    st->steps += n;
    st->solid_substeps += n;
    st->particle_steps += n * sim->kind[KIND_SOLID].n;
    st->bound_steps[binding] += n;
    if (!sim->solid.implicit) sim->substeps = 1;
}

/* Adds the work of a program's accelerations on each body over dt, at the present velocities. */
static void add_external_work(struct simulation *sim, double dt)
{
    const struct particles *const particles = &sim->kind[KIND_SOLID];
    const struct external *const external = &sim->external[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++)
        energy_supply(sim, KIND_SOLID, particles->body[i],
                      dt * sim->solid.body[particles->body[i]].mass * particles->free[i] *
                          (external->ax[i] * particles->vx[i] +
                           external->ay[i] * particles->vy[i]));
}

void solid_only_step(struct simulation *sim, double t_limit)
{
    struct state *const st = &sim->state;
    const double start = wall_clock();
    const bool implicit = sim->solid.implicit != NULL;
    const bool near = timestep_watch_contact(sim, st->time, implicit ? 1 : SOLID_BATCH);
    const enum bound binding = lone_bounds(sim);
    const double bound = sim->dt_bound[binding];
    const bool external = sim->external[KIND_SOLID].at != NULL;
    const int batch = external || sim->gravity_varies || implicit ? 1 : SOLID_BATCH;
    /* Equal steps up to the limit, as in timestep_choose. Rounding of the times must not add a
     * step. */
    const double left = t_limit - st->time, steps = max2(1, ceil(left / bound - 1e-6));
    const double dt = steps <= EQUAL_STEPS ? left / steps : bound;
    const bool hits = steps <= batch;
    int n = hits ? (int)steps : batch;
    const bool cut = dt < bound * (1 - 1e-9);
    if (cut) sim->dt_bound[BOUND_output] = dt;
    if (external) external_for_step(sim, dt);
    double advanced = 0;
    if (external) add_external_work(sim, 0.5 * dt);
    if (implicit)
        advance_implicit(sim, dt);
    else if (near)
        advanced = advance_near(sim, dt, &n);
    else
        advance_lone(sim, dt, n);
    if (external) add_external_work(sim, (advanced > 0 ? advanced : dt) - 0.5 * dt);
    solid_set_positions(&sim->kind[KIND_SOLID]);
    phase_add(sim, PHASE_solid, start);
    st->time = advanced > 0 ? st->time + advanced : hits ? t_limit : st->time + n * dt;
    book_lone(sim, dt, n, cut ? BOUND_output : binding);
}
