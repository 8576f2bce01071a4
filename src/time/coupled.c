/* SPDX-License-Identifier: MIT
 * What the integrators share: evaluations with moving walls, looking at the fluid as it advances, solid
 * sub-steps within a fluid step. */
#include <math.h>
#include <string.h>

#include "time/filter.h"
#include "time/integrators.h"
#include "time/timestep.h"

double phase_add(struct simulation *s, enum phase phase, double since)
{
    if (!phase_runs(phase, s->effects)) return since; /* what there is goes to the next one */
    const double now = wall_clock();
    s->phase_seconds[phase] += now - since;
    if (phase == PHASE_solid && s->effects & FX_CONTACT) {
        /* Its forces are found among the solid's sub-steps. */
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

static void find_push(struct simulation *s, enum kind kind, double time)
{
    struct push *const push = &s->push[kind];
    const size_t bytes = (size_t)s->kind[kind].n * sizeof *push->ax;
    memset(push->ax, 0, bytes);
    memset(push->ay, 0, bytes);
    push->at(push->context, time, &s->kind[kind], push->ax, push->ay);
}

/* Accelerations from outside count in the bound of the step as the model's own do. */
static void push_fluid(struct simulation *s, double time)
{
    const struct push *const push = &s->push[KIND_FLUID];
    struct particles *const p = &s->kind[KIND_FLUID];
    find_push(s, KIND_FLUID, time);
    double top = s->fluid.extremes.acceleration2;
    for (int64_t i = 0; i < p->n; i++) {
        p->ax[i] += push->ax[i];
        p->ay[i] += push->ay[i];
        top = max2(top, square(p->ax[i]) + square(p->ay[i]));
    }
    s->fluid.extremes.acceleration2 = top;
}

/* What the structure was given back or ahead in the last step stands in its force, also where no fluid is
 * near any more and no evaluation writes it anew. */
static void forget_given(struct particles *p)
{
    memset(p->fx, 0, (size_t)p->n * sizeof *p->fx);
    memset(p->fy, 0, (size_t)p->n * sizeof *p->fy);
}

/* Half a step on, the predictor's state is no gain of its own. */
static void set_buffers(struct simulation *s, double time)
{
    const double clock = wall_clock();
    open_set(&s->open, &s->fluid.k, &s->kind[KIND_FLUID], &s->cells, time, time == s->state.time);
    phase_add(s, PHASE_open, clock);
}

void evaluate_fluid(struct simulation *s, double time)
{
    s->state.evaluations++;
    if (s->evaluated) return;
    if (s->effects & FX_MOTION) move_walls(s, time);
    if (s->gravity_varies) scene_gravity_at(s->scene, time, s->fluid.k.gravity);
    if (s->effects & (FX_IMPEDANCE | FX_HELD_FORCE)) forget_given(&s->kind[KIND_SOLID]);
    if (s->effects & FX_OPEN) set_buffers(s, time);
    fluid_evaluate(&s->fluid, s->kind, &s->cells, s->phase_seconds);
    if (s->effects & FX_OPEN) open_hold(&s->open, &s->fluid.k, &s->kind[KIND_FLUID]);
    if (s->push[KIND_FLUID].at) push_fluid(s, time);
    if (s->push[KIND_SOLID].at) find_push(s, KIND_SOLID, time);
}

void accept_evaluation(struct simulation *s)
{
    s->evaluated = false;
    if (!(s->effects & FX_DAMPER)) return;
    struct particles *const p = &s->kind[KIND_FLUID];
    double *const before = p->swell;
    p->swell = p->swell_new;
    p->swell_new = before; /* which the next evaluation overwrites */
}

void evaluate_start(struct simulation *s)
{
    evaluate_fluid(s, s->state.time);
    accept_evaluation(s);
}

/* The extremes of some of the fluid, found without a branch. */
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

double place_solid(struct particles *p)
{
    double way2 = 0;
#pragma omp parallel for simd schedule(static) reduction(max : way2)
    for (int64_t i = 0; i < p->n; i++) {
        const double x = p->X[i] + p->ux[i], y = p->Y[i] + p->uy[i];
        way2 = max2(way2, square(x - p->x[i]) + square(y - p->y[i]));
        p->x[i] = x;
        p->y[i] = y;
    }
    return way2;
}

/* T-35: what the fluid sees of a structure after sub-steps. */
static void update_interface_state(struct simulation *s, double dt)
{
    struct particles *const p = &s->kind[KIND_SOLID];
    const double lag = fluid_eval_lag(s, dt), per_dt = 1 / dt, newest = dt / (dt + lag);
    /* The mean acceleration is that of half a step and the lag ago, the mean velocity that of half a step:
     * between that and now the acceleration is, at the middle, a quarter of a step old. */
    const double half = 0.5 * dt, since = lag + 0.25 * dt;
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        const double ax = p->ax[i], ay = p->ay[i];
        p->ax[i] = ax + newest * ((p->vx[i] - p->vx0[i]) * per_dt - ax);
        p->ay[i] = ay + newest * ((p->vy[i] - p->vy0[i]) * per_dt - ay);
        p->jx[i] += newest * ((p->ax[i] - ax) * per_dt - p->jx[i]);
        p->jy[i] += newest * ((p->ay[i] - ay) * per_dt - p->jy[i]);
        p->wx[i] = (p->ux[i] - p->x0[i]) * per_dt + half * (p->ax[i] + since * p->jx[i]);
        p->wy[i] = (p->uy[i] - p->y0[i]) * per_dt + half * (p->ay[i] + since * p->jy[i]);
    }
}

void advance_solid(struct simulation *s, double dt, int n, bool centred)
{
    struct particles *const p = &s->kind[KIND_SOLID];
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        p->x0[i] = p->ux[i];
        p->y0[i] = p->uy[i];
        p->vx0[i] = p->vx[i];
        p->vy0[i] = p->vy[i];
    }
    solid_advance(&s->solid, p, dt / n, n, centred);
    s->substeps = n;
    s->state.solid_substeps += n;
    s->state.solid_evaluations += n;
    s->solid_max_move = sqrt(place_solid(p));
    update_interface_state(s, dt);
}

/* Steps of a lone solid that are taken between two looks at its state. */
enum { SOLID_BATCH = LOOK_INTERVAL };

/* Bounds of a lone solid; returns the one that binds. */
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
    if (s->scene->top.integrator == INTEGRATOR_SYMPLECTIC) {
        for (int k = 0; k < n; k++) symplectic_solid(s, dt);
    } else {
        solid_advance(&s->solid, &s->kind[KIND_SOLID], dt, n, false);
        s->state.solid_evaluations += n;
    }
}

/* Where something is near each step is looked at for itself, and may be shorter than planned; returns the
 * time that has gone by, or 0 where all steps were as long as planned. */
static double advance_near(struct simulation *s, double dt, int n)
{
    double gone = 0;
    bool shorter = false;
    for (int k = 0; k < n; k++) {
        if (k) timestep_watch_contact(s, s->solid.time, SOLID_BATCH);
        const bool cut = !(s->scene->numerics.fixed_step > 0) && s->dt_solid < dt;
        const double now = cut ? s->dt_solid : dt;
        advance_lone(s, now, 1);
        gone += now;
        shorter |= cut;
        s->state.dt_min = s->state.steps || k ? min2(s->state.dt_min, now) : now;
    }
    return shorter ? gone : 0;
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

void solid_only_step(struct simulation *s, double t_limit)
{
    struct state *const st = &s->state;
    const double start = wall_clock();
    const bool near = timestep_watch_contact(s, st->time, SOLID_BATCH);
    const enum bound binding = lone_bounds(s);
    const double bound = s->dt_bound[binding];
    const bool pushed = s->push[KIND_SOLID].at != NULL;
    if (pushed) find_push(s, KIND_SOLID, st->time);
    const int batch = pushed || s->gravity_varies ? 1 : SOLID_BATCH;
    /* Equal steps up to the limit, as in timestep_choose; round-off of the times must not add one. */
    const double left = t_limit - st->time, steps = max2(1, ceil(left / bound - 1e-6));
    const double dt = steps <= EQUAL_STEPS ? left / steps : bound;
    const bool hits = steps <= batch;
    const int n = hits ? (int)steps : batch;
    const bool cut = dt < bound * (1 - 1e-9);
    if (cut) s->dt_bound[BOUND_output] = dt;
    double gone = 0;
    if (near)
        gone = advance_near(s, dt, n);
    else
        advance_lone(s, dt, n);
    place_solid(&s->kind[KIND_SOLID]);
    phase_add(s, PHASE_solid, start);
    st->time = gone > 0 ? st->time + gone : hits ? t_limit : st->time + n * dt;
    book_lone(s, dt, n, cut ? BOUND_output : binding);
}
