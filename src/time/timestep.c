/* SPDX-License-Identifier: MIT */
#include "coupling/bounds.h"
#include "time/timestep.h"

#include <math.h>

/* The data of a bound: the scene, and the fluid's extremes `now`, which are zero at rest. */
typedef double bound_function(const struct simulation *s, const struct fluid_extremes *now);

/* Eq. 28a. */
static double bound_force(const struct simulation *s, const struct fluid_extremes *now)
{
    const double size = sqrt(max2(now->acceleration2, 1e-300));
    return s->scene->numerics.cfl * sqrt(s->fluid.k.h / size);
}

/* Eq. 28b. */
static double bound_acoustic(const struct simulation *s, const struct fluid_extremes *now)
{
    return s->scene->numerics.cfl * s->fluid.k.h / (s->fluid.k.c0 + now->approach);
}

/* T-33b: decay at a rate m is followed up to m dt = limit, of which a tenth is kept for uneven
 * lattices. */
static double bound_decay(const struct simulation *s, double limit, double rate)
{
    return 0.9 * limit * s->fluid.k.h / (rate * s->fluid.k.c0);
}

static double bound_diffusion(const struct simulation *s, const struct fluid_extremes *now)
{
    (void)now;
    return bound_decay(s, s->integrator->density_decay, 6.5 * s->fluid.k.model->density_diffusion);
}

static double bound_artificial(const struct simulation *s, const struct fluid_extremes *now)
{
    (void)now;
    return bound_decay(s, s->integrator->velocity_decay,
                       2.3 * s->fluid.k.model->artificial_viscosity);
}

/* T-33c. */
static double bound_damper(const struct simulation *s, const struct fluid_extremes *now)
{
    const double sound = sqrt(2.0) * s->fluid.k.c0;
    return s->scene->numerics.cfl * s->fluid.k.h / (sound + now->approach);
}

/* L-8: half of the stable 2/omega between two dummies where L-7 is steepest. */
static double bound_repulsion(const struct simulation *s, const struct fluid_extremes *now)
{
    (void)now;
    const struct fluid_constants *const k = &s->fluid.k;
    return square(k->h / k->dp) * k->h / (8.1 * sqrt(k->model->wall_repulsion) * k->c0);
}

/* Morris et al. 1997, Eq. 21. L-6b gives pairs with a surface twice the weight. */
static double bound_viscous(const struct simulation *s, const struct fluid_extremes *now)
{
    (void)now;
    const double weight = s->effects & FX_NO_SLIP && s->effects & FX_ONE_SIDED ? 2 : 1;
    const double inside =
        0.125 * square(s->fluid.k.h) / (weight * s->fluid.k.model->laminar_viscosity);
    return s->effects & FX_COUPLING ? min2(inside, coupling_drag_step(&s->coupling)) : inside;
}

static double bound_solid(const struct simulation *s, const struct fluid_extremes *now)
{
    (void)now;
    if (s->effects & FX_MULTIRATE) return (double)INFINITY;
    return s->solid.contact ? s->dt_lone_solid : s->dt_solid;
}

/* Only with sub-steps: nothing passes within the step. */
static double bound_contact(const struct simulation *s, const struct fluid_extremes *now)
{
    (void)now;
    if (!s->solid.contact) return (double)INFINITY;
    return s->effects & FX_MULTIRATE ? s->contact.approach : s->dt_solid;
}

static double bound_added_mass(const struct simulation *s, const struct fluid_extremes *now)
{
    (void)now;
    int lightest;
    return coupling_added_mass_step(&s->coupling, &lightest);
}

/* Set below, where the remaining time is known. */
static double bound_output(const struct simulation *s, const struct fluid_extremes *now)
{
    (void)s, (void)now;
    return (double)INFINITY;
}

static double bound_fixed(const struct simulation *s, const struct fluid_extremes *now)
{
    (void)now;
    const double fixed = s->scene->numerics.fixed_step;
    return fixed > 0 ? fixed : (double)INFINITY;
}

/* One function for each row of time/bounds.def. */
static bound_function *const bound_functions[BOUND_COUNT] = {
#define BOUND(name, effect, source) bound_##name,
#include "time/bounds.def"
#undef BOUND
};
static const effect_set bound_effects[BOUND_COUNT] = {
#define FX_NONE 0u
#define BOUND(name, effect, source) FX_##effect,
#include "time/bounds.def"
#undef BOUND
#undef FX_NONE
};

/* Relative rounding of the intervals of outputs. */
#define OUTPUT_ROUNDING 1e-9

static double bound_at(const struct simulation *s, int k, const struct fluid_extremes *now)
{
    const bool fixed = s->scene->numerics.fixed_step > 0;
    const bool owned = bound_effects[k] == 0 || s->effects & bound_effects[k];
    return owned && (!fixed || k == BOUND_fixed) ? bound_functions[k](s, now) : (double)INFINITY;
}

double timestep_fluid_limit(const struct simulation *s)
{
    static const struct fluid_extremes rest = {0};
    double limit = (double)INFINITY;
    for (int k = 0; k < BOUND_COUNT; k++)
        if (k != BOUND_solid && k != BOUND_contact) limit = min2(limit, bound_at(s, k, &rest));
    return limit;
}

double timestep_courant(const struct simulation *s)
{
    return timestep_fluid_limit(s) * s->fluid.k.c0 / s->fluid.k.h;
}

bool timestep_beyond(const struct simulation *s, double cfl)
{
    return s->effects & FX_FLUID && timestep_courant(s) > cfl * (1 + 1e-9);
}

/* The step that the bounds allow now, s: the last one may be short because an output followed
 * it. INFINITY before the first step. */
static double usual_step(const struct simulation *s)
{
    double step = s->state.dt > 0 ? s->state.dt_max : (double)INFINITY;
    for (int k = 0; k < BOUND_COUNT && s->state.dt > 0; k++)
        if (k != BOUND_output && k != BOUND_solid) step = min2(step, s->dt_bound[k]);
    return step;
}

const char *timestep_shorter(const struct simulation *s, double *half)
{
    static const enum bound of_cfl[] = {BOUND_force, BOUND_acoustic, BOUND_damper};
    const struct scene_numerics *const n = &s->scene->numerics;
    const double step = usual_step(s),
                 much = 1.8 * step; /* half of a bound must be below the step */
    double fluid = (double)INFINITY;
    for (size_t k = 0; k < COUNT_OF(of_cfl); k++) fluid = min2(fluid, s->dt_bound[of_cfl[k]]);
    const bool fixed = n->fixed_step > 0, lone = !(s->effects & FX_FLUID);
    const double solid = s->dt_bound[BOUND_solid];
    if (!fixed && (lone || solid < min2(fluid, much))) {
        *half = 0.5 * n->solid_safety;
        return "solid_safety";
    }
    if (!fixed && fluid < much) {
        *half = 0.5 * n->cfl;
        return "cfl";
    }
    *half = 0.5 * (fixed ? n->fixed_step : step);
    return "fixed_step";
}

/* The greatest common divisor of two times, up to their rounding. */
static double common_divisor(double a, double b)
{
    const double rounding = OUTPUT_ROUNDING * min2(a, b);
    while (b > rounding) {
        const double rest = fmod(a, b);
        a = b;
        b = b - rest > rounding ? rest : 0;
    }
    return a;
}

bool timestep_output(const struct scene *c, int which, struct output_interval *out)
{
    enum { COMMON = 4 };
    bool common = false; /* whether any probe has the common interval */
    for (int k = 0; k < c->n_probe; k++) common |= !(c->probe[k].interval > 0);
    const struct output_interval of_case[COMMON] = {
        {SECTION_output, 0, "probe_interval", common ? c->output.probe_interval : 0},
        {SECTION_output, 0, "ledger_interval", c->output.ledger_interval},
        {SECTION_output, 0, "snapshot_interval", c->output.snapshot_interval},
        {SECTION_output, 0, "checkpoint_interval", c->output.checkpoint_interval},
    };
    const int k = which - COMMON;
    if (k >= c->n_probe) return false;
    *out = k < 0 ? of_case[which]
                 : (struct output_interval){SECTION_probe, k, "interval", c->probe[k].interval};
    return true;
}

/* The grid of outputs less than `most` apart, 0: none is needed. False if it is finer than
 * half a step or half of the shortest interval; s->uneven is then the output that makes it so. */
static bool find_grid(struct simulation *s, double step, double most)
{
    double grid = 0, shortest = (double)INFINITY;
    struct output_interval out;
    for (int k = 0; timestep_output(s->scene, k, &out); k++) {
        if (!(out.interval > 0 && out.interval < most)) continue;
        grid = grid > 0 ? common_divisor(grid, out.interval) : out.interval;
        shortest = min2(shortest, out.interval);
        s->uneven = k + 1;
        if (2 * grid < min2(step, shortest) * (1 - OUTPUT_ROUNDING)) return false;
    }
    s->uneven = 0;
    s->output_grid = grid < shortest * (1 - OUTPUT_ROUNDING) ? grid : 0;
    return true;
}

void timestep_find_grid(struct simulation *s)
{
    const double fixed = s->scene->numerics.fixed_step;
    const double fluid = s->effects & FX_FLUID ? timestep_fluid_limit(s) : (double)INFINITY;
    const bool together = !(s->effects & FX_MULTIRATE);
    const double step = fixed > 0 ? fixed : together ? min2(fluid, s->dt_solid) : fluid;
    s->output_grid = 0;
    if (!(s->effects & FX_SOLID)) return;
    if (find_grid(s, step, EQUAL_STEPS * step) || find_grid(s, step, FREQUENT_STEPS * step)) return;
    timestep_set_solid(s);
}

double timestep_stop(const struct simulation *s, double t_limit)
{
    const double grid = s->output_grid, time = s->state.time;
    if (grid == 0 || time < 0) return t_limit; /* no rows before t = 0 */
    /* Outputs are at times of 12 digits. */
    const double near = 1e-6 * grid + 1e-11 * time;
    const double next = grid * (floor((time + near) / grid) + 1);
    return next < t_limit - near ? next : t_limit;
}

double timestep_choose(struct simulation *s, double t_limit, bool *hits)
{
    double dt = (double)INFINITY;
    for (int k = 0; k < BOUND_COUNT; k++) {
        s->dt_bound[k] = bound_at(s, k, &s->fluid.extremes);
        dt = min2(dt, s->dt_bound[k]);
    }
    /* Equal steps up to the limit, not full ones and a remainder: steps that change in a pattern
     * excite oscillations near the bound that are stable with each step alone (docs/theory.md).
     * Rounding of the time adds no step. */
    const double left = t_limit - s->state.time, steps = ceil(left / dt * (1 - 1e-9));
    *hits = steps <= 1;
    if (steps > EQUAL_STEPS || (*hits && left == dt)) return *hits ? left : dt;
    const double equal = *hits ? left : left / steps;
    if (equal < dt * (1 - 1e-9)) s->dt_bound[BOUND_output] = equal;
    return equal;
}

/* The fraction of the solid's stable step that is used. At half of it uneven steps feed no
 * oscillation that viscosity does not damp (T-34d). */
static double solid_safety(const struct simulation *s)
{
    return s->scene->numerics.solid_safety * (s->uneven ? 0.5 : 1);
}

/* T-34c: the number of sub-steps goes down only after the solid's viscosity has dissipated enough.
 * An oscillation at the bound can gain that energy by fewer and then more sub-steps. Viscosity acts
 * on approaching pairs, half of the time. */
static bool fewer_is_safe(const struct simulation *s, double fewer)
{
    const struct state *const st = &s->state;
    const double z = solid_safety(s), less = z * fewer / (double)st->substeps_held;
    const double root = sqrt((1 + z) * (1 - less) / ((1 - z) * (1 + less)));
    const double gain = root - 1 / root; /* at least the logarithm of root^2 */
    return 0.5 * s->solid.damping_max * (st->time - st->substeps_needed) > gain;
}

int timestep_substeps(struct simulation *s, double dt)
{
    struct state *const st = &s->state;
    if (!(s->effects & FX_MULTIRATE)) return 1;
    /* Enough for the longest step so far: shorter steps do not change the number. */
    const double most = ceil(max2(st->dt_max, dt) / s->dt_solid * (1 - 1e-9));
    const double needed = max2(1, min2(most, 1e9)), held = (double)st->substeps_held;
    if (needed >= held) st->substeps_needed = st->time;
    if (needed > held || (needed < held && fewer_is_safe(s, needed)))
        st->substeps_held = (int64_t)needed;
    return (int)st->substeps_held;
}

void timestep_set_solid(struct simulation *s)
{
    const double step = s->solid.stable_step * s->state.solid_slowing;
    /* A fully clamped body has no bound, but a moving body may hit it. */
    const bool bounded = s->effects & FX_FLUID || isfinite(step);
    s->dt_solid = s->dt_lone_solid = solid_safety(s) * (bounded ? step : s->solid.paper_step);
}

/* T-62a: eigenvalues of a sum are at most the sum of the largest ones. */
static double step_in_contact(const struct simulation *s)
{
    const struct contact *const c = &s->contact;
    const double slowing = s->state.solid_slowing;
    const double step = solid_step_of(square(s->solid.omega_max / slowing) + c->omega2,
                                      s->solid.damping_max / slowing + c->damping);
    return min2(solid_safety(s) * step, c->approach);
}

bool timestep_watch_contact(struct simulation *s, double time, int steps)
{
    if (!(s->effects & FX_CONTACT)) return false;
    const double start = wall_clock(), fixed = s->scene->numerics.fixed_step;
    const double longest = fixed > 0               ? fixed
                           : s->effects & FX_FLUID ? timestep_fluid_limit(s)
                                                   : s->dt_lone_solid;
    const bool near =
        contact_watch(&s->contact, &s->kind[KIND_SOLID], time, longest, steps * longest);
    s->solid.contact = near ? &s->contact : NULL;
    s->dt_solid = near ? min2(s->dt_lone_solid, step_in_contact(s)) : s->dt_lone_solid;
    s->contact.seconds += wall_clock() - start;
    return near;
}

/* A stiffness larger by a factor k shortens the step by sqrt(k) at most. 1.15 uses the margin of
 * the default solid_safety of 0.9: 0.9 sqrt(1.15) = 0.965. A softer solid is not urgent. */
#define STIFFER 1.15
#define SOFTER 0.6

void timestep_recheck_solid(struct simulation *s)
{
    struct state *const st = &s->state;
    if (s->scene->numerics.fixed_step > 0) return;
    const double now = solid_stiffening(&s->solid, &s->kind[KIND_SOLID]);
    if (now <= STIFFER * st->solid_stiffening && now >= SOFTER * st->solid_stiffening) return;
    double omega, damping;
    const double step = solid_stable_step(&s->solid, &s->kind[KIND_SOLID], &omega, &damping);
    if (!(step > 0)) return; /* not a number: the guards report the cause */
    st->solid_stiffening = now;
    st->solid_slowing = step / s->solid.stable_step;
    timestep_set_solid(s);
}

void timestep_book(struct simulation *s, double dt, double t_limit, bool hits)
{
    struct state *const st = &s->state;
    st->time = hits ? t_limit : st->time + dt;
    st->dt_old = st->dt;
    st->dt = dt;
    st->dt_min = st->steps ? min2(st->dt_min, dt) : dt;
    st->dt_max = max2(st->dt_max, dt);
    st->steps++;
    st->particle_steps += s->kind[KIND_FLUID].n + s->kind[KIND_SOLID].n;
    for (int k = 0; k < BOUND_COUNT; k++)
        if (s->dt_bound[k] <= dt) {
            st->bound_steps[k]++;
            break;
        }
}
