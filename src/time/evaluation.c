/* SPDX-License-Identifier: MIT
 * Evaluations of the rates, with moving walls, forces of the program and open boundaries; and the fluid's
 * advance, which all integrators share. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "particles/kernel.h"
#include "time/booking.h"
#include "time/integrators.h"
#include "time/timestep.h"

double phase_add(struct simulation *s, enum phase phase, double since)
{
    if (!phase_runs(phase, s->effects)) return since; /* what there is goes to the next one */
    const double now = wall_clock();
    s->phase_seconds[phase] += now - since;
    if (phase == PHASE_solid && s->effects & FX_CONTACT) {
        /* Its forces are computed during the solid's sub-steps. */
        s->phase_seconds[PHASE_solid] -= s->contact.seconds;
        s->phase_seconds[PHASE_contact] += s->contact.seconds;
        s->contact.seconds = 0;
    }
    return now;
}

void move_walls(struct simulation *s, double time)
{
    wall_motion_apply(&s->wall_motion, s->scene, &s->kind[KIND_WALL], time);
}

void find_external(struct simulation *s, enum kind kind, double time)
{
    struct external *const external = &s->external[kind];
    const size_t bytes = (size_t)s->kind[kind].n * sizeof *external->ax;
    memset(external->ax, 0, bytes);
    memset(external->ay, 0, bytes);
    external->at(external->context, time, &s->kind[kind], external->ax, external->ay);
}

/* Accelerations from outside count in the step bound like those of the model. */
static void add_external(struct simulation *s, double time)
{
    const struct external *const external = &s->external[KIND_FLUID];
    struct particles *const p = &s->kind[KIND_FLUID];
    find_external(s, KIND_FLUID, time);
    double top = s->fluid.extremes.acceleration2;
    for (int64_t i = 0; i < p->n; i++) {
        p->ax[i] += external->ax[i];
        p->ay[i] += external->ay[i];
        top = max2(top, square(p->ax[i]) + square(p->ay[i]));
    }
    s->fluid.extremes.acceleration2 = top;
}

/* L-5a: the gradients of the density are found once in the time in which sound crosses the kernel's reach.
 * Verlet's even and odd steps would drift apart by it. */
static bool keeps_slopes(const struct simulation *s, double time)
{
    const struct state *const st = &s->state;
    const double interval = KERNEL_REACH * s->fluid.k.h / s->fluid.k.c0;
    if (s->scene->top.integrator == INTEGRATOR_VERLET) return false;
    if (time != st->time) return true; /* symplectic: the predictor's */
    /* Not after the evaluation before: time - dt has errors of round-off, and may have passed a multiple
     * of the interval that the step before had not reached. */
    const double before = time - st->dt - 2 * DBL_EPSILON * time;
    return st->steps > 0 && floor(time / interval) <= floor(before / interval);
}

void evaluate_fluid(struct simulation *s, double time)
{
    s->state.evaluations++;
    if (s->evaluated) return;
    if (s->effects & FX_MOTION) move_walls(s, time);
    if (s->gravity_varies) scene_gravity_at(s->scene, time, s->fluid.k.gravity);
    if (s->effects & FX_OPEN) {
        const double start = wall_clock();
        /* The predictor's state, half a step ahead, adds nothing to the energy account. */
        const bool counts = time == s->state.time;
        open_set(&s->open, &s->fluid.k, &s->kind[KIND_FLUID], &s->cells, time, counts);
        phase_add(s, PHASE_open, start);
    }
    const bool predicts = s->scene->top.integrator == INTEGRATOR_SYMPLECTIC;
    s->fluid.counts_touch = !predicts || time != s->state.time; /* symplectic: of the corrector */
    if (s->effects & FX_ANTUONO) s->fluid.keeps_slopes = keeps_slopes(s, time);
    fluid_evaluate(&s->fluid, s->kind, &s->cells, s->phase_seconds);
    const double clock = wall_clock();
    coupling_find_forces(&s->coupling, s->kind, &s->cells);
    phase_add(s, PHASE_wall, clock);
    if (s->effects & FX_OPEN) open_hold(&s->open, &s->fluid.k, &s->kind[KIND_FLUID]);
    if (s->external[KIND_FLUID].at) add_external(s, time);
    if (s->external[KIND_SOLID].at) find_external(s, KIND_SOLID, time);
}

void evaluate_start(struct simulation *s)
{
    evaluate_fluid(s, s->state.time);
    s->evaluated = false;
    if (s->effects & FX_DAMPER) fluid_follow_density(&s->fluid, &s->kind[KIND_FLUID], s->state.dt);
}

void advance_structure(struct simulation *s, double dt, double kick)
{
    const int n = timestep_substeps(s, dt);
    s->solid_max_move = coupling_advance(&s->coupling, dt, n, kick, s->state.dt);
    book_solid(s, dt, n, s->coupling.centred);
    s->substeps = n;
    s->state.solid_substeps += n;
    s->state.solid_evaluations += n;
}

/* The extremes over a range of fluid particles, without branches. */
static struct extremes extremes_of(const struct particles *p, int64_t from, int64_t end)
{
    vdouble low = vset_double(0), high = low, speed2 = low, nan_probe = low;
    int64_t i = from;
    for (; i + LANES_DOUBLE <= end; i += LANES_DOUBLE) {
        const vdouble vx = vload_double(&p->vx[i]), vy = vload_double(&p->vy[i]);
        const vdouble d = vload_double(&p->dens[i]), v2 = vx * vx + vy * vy;
        low = vmin_double(d, low);
        high = vmax_double(d, high);
        speed2 = vmax_double(v2, speed2);
        nan_probe = nan_probe + (v2 + d) * 0.0;
    }
    struct extremes e = {-vtop_double(-low), vtop_double(high), vtop_double(speed2),
                         vsum_double(nan_probe)};
    for (; i < end; i++) {
        const double v2 = p->vx[i] * p->vx[i] + p->vy[i] * p->vy[i];
        e.dens_low = min2(e.dens_low, p->dens[i]);
        e.dens_high = max2(e.dens_high, p->dens[i]);
        e.speed2 = max2(e.speed2, v2);
        e.nan_probe += 0 * (v2 + p->dens[i]);
    }
    return e;
}

void advance_fluid(struct simulation *s, advance_rows *rows, const void *by)
{
    enum { BLOCK = 256 };
    struct particles *const p = &s->kind[KIND_FLUID];
    double low = 0, high = 0, speed2 = 0, nan_probe = 0;
#pragma omp parallel for schedule(static) reduction(min : low) reduction(max : high, speed2) \
    reduction(+ : nan_probe)
    for (int64_t from = 0; from < p->n; from += BLOCK) {
        const int64_t end = from + BLOCK < p->n ? from + BLOCK : p->n;
        if (rows) rows(p, by, from, end);
        const struct extremes e = extremes_of(p, from, end);
        low = min2(low, e.dens_low);
        high = max2(high, e.dens_high);
        speed2 = max2(speed2, e.speed2);
        nan_probe += e.nan_probe;
    }
    s->extremes = (struct extremes){low, high, speed2, nan_probe};
}

void update_extremes(struct simulation *s) { advance_fluid(s, NULL, NULL); }

void simulation_refresh(struct simulation *s)
{
    if ((s->effects & FX_FLUID) && !s->cells_overfull) {
        double seconds[PHASE_COUNT];
        memcpy(seconds, s->phase_seconds, sizeof seconds);
        evaluate_fluid(s, s->state.time);
        s->state.evaluations--;
        /* A caller's own forces and motions may change between two steps. */
        s->evaluated =
            !s->external[KIND_FLUID].at && !s->external[KIND_SOLID].at && !s->scene->motion_hook;
        if (!s->evaluated) memcpy(s->phase_seconds, seconds, sizeof seconds);
    }
    if (!(s->effects & FX_SOLID)) return;
    /* After an evaluation of the whole, accelerations of parts would not be available. */
    if (s->solid.in_parts) solid_show(&s->solid, &s->kind[KIND_SOLID]);
    solid_stress(&s->solid, &s->kind[KIND_SOLID]);
}
