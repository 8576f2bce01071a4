/* SPDX-License-Identifier: MIT
 * Steps of a solid without fluid. */
#include "time/solid_steps.h"

#include <math.h>

#include "time/evaluation.h"
#include "time/guards.h"
#include "time/timestep.h"

/* Steps of a solid without fluid between two checks of its state. */
enum { SOLID_BATCH = CHECK_INTERVAL };

/* Bounds of a solid without fluid; returns the smallest. */
static enum bound lone_bounds(struct simulation *s)
{
    const double fixed = s->scene->numerics.fixed_step;
    for (int k = 0; k < BOUND_COUNT; k++) s->dt_bound[k] = (double)INFINITY;
    if (fixed > 0) {
        s->dt_bound[BOUND_fixed] = fixed;
        return BOUND_fixed;
    }
    s->dt_bound[BOUND_solid] = s->dt_lone_solid;
    if (!(s->dt_solid < s->dt_lone_solid)) return BOUND_solid;
    s->dt_bound[BOUND_contact] = s->dt_solid;
    return BOUND_contact;
}

static void advance_lone(struct simulation *s, double dt, int n)
{
    const struct integrator *const by = s->integrator;
    if (by->solid_step) {
        for (int k = 0; k < n; k++) by->solid_step(s, dt);
    } else {
        solid_advance(&s->solid, &s->kind[KIND_SOLID], dt, n, by->centred);
        s->state.solid_evaluations += n;
    }
}

/* When a contact is near, each step is chosen separately and may be shorter than planned.
 * Where surfaces are pressed so hard that the material may fail, the guards judge each step.
 * Returns the time advanced, or 0 if all *n steps were as long as planned. */
static double advance_near(struct simulation *s, double dt, int *n)
{
    double advanced = 0;
    bool shorter = false;
    for (int k = 0; k < *n; k++) {
        if (k) timestep_watch_contact(s, s->solid.time, SOLID_BATCH);
        if (k && guards_contact_hard(s)) {
            shorter = true;
            *n = k;
            break;
        }
        const bool cut = !(s->scene->numerics.fixed_step > 0) && s->dt_solid < dt;
        const double now = cut ? s->dt_solid : dt;
        advance_lone(s, now, 1);
        advanced += now;
        shorter |= cut;
        s->state.dt_min = s->state.steps || k ? min2(s->state.dt_min, now) : now;
    }
    return shorter ? advanced : 0;
}

/* `verlet` kicks at the start of a step (T-32), the others in its middle (T-30, T-36). The
 * positions after the step follow later. */
static void external_for_step(struct simulation *s, double dt)
{
    struct particles *const p = &s->kind[KIND_SOLID];
    const double half = s->integrator->centred ? 0.5 * dt : 0;
    for (int64_t i = 0; half > 0 && i < p->n; i++) {
        p->x[i] += half * p->vx[i];
        p->y[i] += half * p->vy[i];
    }
    find_external(s, KIND_SOLID, s->state.time + half);
}

static void book_lone(struct simulation *s, double dt, int n, enum bound binding)
{
    struct state *const st = &s->state;
    st->dt_min = st->steps ? min2(st->dt_min, dt) : dt;
    st->dt_max = max2(st->dt_max, dt);
    st->dt = dt;
    st->steps += n;
    st->solid_substeps += n;
    st->particle_steps += n * s->kind[KIND_SOLID].n;
    st->bound_steps[binding] += n;
    s->substeps = 1;
}

/* Adds the work of a program's accelerations on each body over dt, at the present velocities. */
static void add_external_work(struct simulation *s, double dt)
{
    const struct particles *const p = &s->kind[KIND_SOLID];
    const struct external *const external = &s->external[KIND_SOLID];
    for (int64_t i = 0; i < p->n; i++)
        energy_supply(s, KIND_SOLID, p->body[i],
                      dt * s->solid.body[p->body[i]].mass * p->free[i] *
                          (external->ax[i] * p->vx[i] + external->ay[i] * p->vy[i]));
}

void solid_only_step(struct simulation *s, double t_limit)
{
    struct state *const st = &s->state;
    const double start = wall_clock();
    const bool near = timestep_watch_contact(s, st->time, SOLID_BATCH);
    const enum bound binding = lone_bounds(s);
    const double bound = s->dt_bound[binding];
    const bool external = s->external[KIND_SOLID].at != NULL;
    const int batch = external || s->gravity_varies ? 1 : SOLID_BATCH;
    /* Equal steps up to the limit, as in timestep_choose. Rounding of the times must not add a
     * step. */
    const double left = t_limit - st->time, steps = max2(1, ceil(left / bound - 1e-6));
    const double dt = steps <= EQUAL_STEPS ? left / steps : bound;
    const bool hits = steps <= batch;
    int n = hits ? (int)steps : batch;
    const bool cut = dt < bound * (1 - 1e-9);
    if (cut) s->dt_bound[BOUND_output] = dt;
    if (external) external_for_step(s, dt);
    double advanced = 0;
    if (external) add_external_work(s, 0.5 * dt);
    if (near)
        advanced = advance_near(s, dt, &n);
    else
        advance_lone(s, dt, n);
    if (external) add_external_work(s, (advanced > 0 ? advanced : dt) - 0.5 * dt);
    solid_set_positions(&s->kind[KIND_SOLID]);
    phase_add(s, PHASE_solid, start);
    st->time = advanced > 0 ? st->time + advanced : hits ? t_limit : st->time + n * dt;
    book_lone(s, dt, n, cut ? BOUND_output : binding);
}
