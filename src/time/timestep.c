/* SPDX-License-Identifier: MIT
 * The time step: the smallest of its bounds (bounds.def), and sub-steps of the solid. */
#include "time/timestep.h"
#include "time/advance.h"

/* T-33b: decay at a rate m is followed up to m dt = limit, less a tenth for uneven lattices. */
static double bound_decay(const struct simulation *sim, double limit, double rate)
{
    return 0.9 * limit * sim->fluid.k.h / (rate * sim->fluid.k.c0);
}

/* Without fluid the step is the bodies', which springs of a changing stiffness may shorten. */
static double bound_solid(const struct simulation *sim)
{
    int stiffest;
    double step = sim->solid.contact ? sim->dt_lone_solid : sim->dt_solid;
    if (sim->effects & FX_FLUID) return step;
    if (sim->effects & FX_BEAM) step *= beams_stiffer_step(&sim->beams);
    if (sim->effects & FX_RIGID)
        step = min2(step, rigid_spring_step(&sim->rigid, sim->state.dt, true, &stiffest));
    return step;
}

/* What bound k of time/bounds.def allows by the fluid's extremes `now`, zero at rest. */
static double bound_value(const struct simulation *sim, enum bound k,
                          const struct rate_extremes *now)
{
    const struct scene_numerics *const n = &sim->scene->numerics;
    const struct fluid_constants *const f = &sim->fluid.k;
    const double never = (double)INFINITY;
    int lightest;
    switch (k) {
    case BOUND_force: return n->cfl * sqrt(f->h / sqrt(max2(now->acceleration2, 1e-300)));
    case BOUND_acoustic: return n->cfl * f->h / (f->c0 + now->approach);
    case BOUND_damper: return n->cfl * f->h / (sqrt(2.0) * f->c0 + now->approach);
    case BOUND_diffusion:
        return bound_decay(sim, sim->integrator->density_decay, 6.5 * f->model->density_diffusion);
    case BOUND_artificial:
        return bound_decay(sim, sim->integrator->velocity_decay,
                           2.3 * f->model->artificial_viscosity);
    case BOUND_repulsion: /* of two dummies where L-7 is steepest */
        return square(f->h / f->dp) * f->h / (8.1 * sqrt(f->model->wall_repulsion) * f->c_u);
    case BOUND_viscous: { /* L-6b gives pairs with a surface twice the weight */
        const double weight = sim->effects & FX_NO_SLIP && sim->effects & FX_ONE_SIDED ? 2 : 1;
        const double inside =
            0.125 * square(f->h) * f->second_moment / (weight * f->model->laminar_viscosity);
        return sim->effects & FX_COUPLING ? min2(inside, coupling_drag_step(&sim->coupling))
                                          : inside;
    }
    case BOUND_solid:
        if (sim->effects & FX_MULTIRATE) return never;
        return bound_solid(sim);
    case BOUND_contact: /* with sub-steps only what passes within the step */
        if (!sim->solid.contact) return never;
        return sim->effects & FX_MULTIRATE || sim->solid.implicit ? sim->contact.step_before_contact
                                                                  : sim->dt_solid;
    case BOUND_added_mass: return coupling_added_mass_step(&sim->coupling, &lightest);
    case BOUND_zone: {
        double rate = 0;
        for (int z = 0; z < sim->scene->n_damping; z++) rate += sim->scene->damping[z].rate;
        /* A decay that fluid cannot pass on grows until two alternating solutions meet again. */
        const double limit =
            sim->integrator->alternates ? 2.0 / n->verlet_reset : sim->integrator->velocity_decay;
        return 0.9 * limit / rate;
    }
    case BOUND_spring: {
        double damping;
        const double omega2 = rigid_spring_rates(&sim->rigid, sim->state.dt, &damping);
        return n->solid_safety * solid_step_of(omega2, damping);
    }
    case BOUND_fixed: return n->fixed_step > 0 ? n->fixed_step : never;
    case BOUND_COUNT: break;
    }
    return never;
}

static double bound_at(const struct simulation *sim, int k, const struct rate_extremes *now)
{
    const bool fixed = sim->scene->numerics.fixed_step > 0;
    const effect_set effect = bound_table[k].effect;
    bool owned = effect == 0 || sim->effects & effect;
    if (!(sim->effects & FX_FLUID)) /* without solids dt_solid is that of rigid bodies and beams */
        owned = k == BOUND_solid || k == BOUND_contact || k == BOUND_fixed ||
                (k == BOUND_spring && sim->effects & FX_SOLID && sim->effects & FX_RIGID);
    return owned && (!fixed || k == BOUND_fixed) ? bound_value(sim, (enum bound)k, now)
                                                 : (double)INFINITY;
}

double timestep_fluid_limit(const struct simulation *sim)
{
    static const struct rate_extremes rest = {0};
    double limit = (double)INFINITY;
    for (int k = 0; k < BOUND_COUNT; k++)
        if (k != BOUND_solid && k != BOUND_contact) limit = min2(limit, bound_at(sim, k, &rest));
    return limit;
}

enum bound timestep_binding(const struct simulation *sim)
{
    int least = 0;
    for (int k = 1; k < BOUND_COUNT; k++)
        if (sim->dt_bound[k] < sim->dt_bound[least]) least = k;
    return (enum bound)least;
}

double timestep_longest(const struct simulation *sim)
{
    const double fixed = sim->scene->numerics.fixed_step;
    if (sim->effects & FX_FLUID) return timestep_fluid_limit(sim);
    if (fixed > 0) return fixed;
    return min2(sim->dt_solid, bound_at(sim, BOUND_spring, &sim->fluid.extremes));
}

const char *timestep_key_to_halve(const struct simulation *sim, double *half)
{
    const struct scene_numerics *const n = &sim->scene->numerics;
    const double *const bound = sim->dt_bound, step = bound[timestep_binding(sim)];
    const double fluid = min2(bound[BOUND_force], min2(bound[BOUND_acoustic], bound[BOUND_damper]));
    const double halving_helps_below = 1.8 * step; /* half of a bound must be below the step */
    const bool lone = !(sim->effects & FX_FLUID) && !(n->fixed_step > 0);
    if (sim->effects & FX_SOLID &&
        (lone || bound[BOUND_solid] < min2(fluid, halving_helps_below))) {
        *half = 0.5 * n->solid_safety;
        return "solid_safety";
    }
    if (fluid < halving_helps_below) {
        *half = 0.5 * n->cfl;
        return "cfl";
    }
    *half = 0.5 * step;
    return "fixed_step";
}

double timestep_bound(struct simulation *sim)
{
    for (int k = 0; k < BOUND_COUNT; k++) sim->dt_bound[k] = bound_at(sim, k, &sim->fluid.extremes);
    return sim->dt_bound[timestep_binding(sim)];
}

double timestep_choose(struct simulation *sim, double t_limit, bool *hits)
{
    const double dt = timestep_bound(sim);
    /* No extra step for a remainder that is only rounding. */
    const double left = t_limit - sim->state.time, steps = whole_parts(left / dt);
    *hits = steps <= 1;
    return steps <= 2 ? left / max2(1, steps) : dt;
}

/* T-34c: steps of the solid grow again, from a part `ratio` of the new ones, only after its
 * viscosity has dissipated enough. An oscillation at the bound can gain that energy by longer and
 * then shorter steps. Viscosity acts on approaching pairs, half of the time. */
static bool longer_is_safe(const struct simulation *sim, double ratio)
{
    const struct state *const st = &sim->state;
    const double z = sim->scene->numerics.solid_safety, less = z * ratio;
    const double root = sqrt((1 + z) * (1 - less) / ((1 - z) * (1 + less)));
    const double gain = root - 1 / root; /* at least the logarithm of root^2 */
    return 0.5 * sim->solid.damping_max * (st->time - st->short_steps_needed_at) > gain;
}

int timestep_substeps(struct simulation *sim, double dt)
{
    struct state *const st = &sim->state;
    if (!(sim->effects & FX_MULTIRATE) || implicit_is_next(&sim->solid)) return 1;
    /* Enough for the longest step so far: shorter steps do not change the number. */
    const double most = whole_parts(max2(st->dt_max, dt) / sim->dt_solid);
    const double needed = max2(1, min2(most, 1e9)), held = (double)st->substeps_held;
    if (needed >= held) st->short_steps_needed_at = st->time;
    if (needed > held || (needed < held && longer_is_safe(sim, needed / held)))
        st->substeps_held = (int64_t)needed;
    return (int)st->substeps_held;
}

/* Steps in the longest period of solids alone: the midpoint rule adds (2 pi/100)^2/12 = 0.03 %. */
enum { IMPLICIT_PARTS = 100 };

void timestep_set_solid(struct simulation *sim)
{
    const double step = sim->solid.stable_step * sim->state.solid_slowing;
    /* A fully clamped body has no bound, but a moving body may hit it. */
    const bool bounded = sim->effects & FX_FLUID || isfinite(step);
    sim->dt_solid = sim->dt_lone_solid =
        sim->scene->numerics.solid_safety * (bounded ? step : sim->solid.acoustic_step);
    if (sim->effects & FX_FLUID || !sim->solid.implicit) return;
    if (isfinite(sim->solid.implicit->period))
        sim->dt_solid = sim->dt_lone_solid = sim->solid.implicit->period / IMPLICIT_PARTS;
}

/* T-62a: eigenvalues of a sum are at most the sum of the largest ones. */
static double step_in_contact(const struct simulation *sim)
{
    const struct contact *const contact = &sim->contact;
    const double slowing = sim->state.solid_slowing;
    const double step = solid_step_of(square(sim->solid.omega_max / slowing) + contact->omega2,
                                      sim->solid.damping_max / slowing + contact->damping);
    return min2(sim->scene->numerics.solid_safety * step, contact->step_before_contact);
}

/* T-62e, in parts of 1/omega: a point that meets a surface or leaves it then changes the energy of
 * its approach by 1 % (root mean square). */
#define RESOLVED 0.4

bool timestep_watch_contact(struct simulation *sim, double time, int steps)
{
    if (!(sim->effects & FX_CONTACT)) return false;
    const double start = phase_clock(), fixed = sim->scene->numerics.fixed_step;
    const double longest = fixed > 0                 ? fixed
                           : sim->effects & FX_FLUID ? timestep_fluid_limit(sim)
                                                     : sim->dt_lone_solid;
    const bool near =
        contact_watch(&sim->contact, &sim->particles[KIND_SOLID], time, longest, steps * longest);
    const double resolved = min2(sim->dt_lone_solid, sim->scene->numerics.solid_safety * RESOLVED /
                                                         sqrt(sim->contact.first_omega2));
    /* Sub-steps are held as a number. Without them this is the last time with surfaces near. */
    double *const needed = sim->effects & FX_MULTIRATE ? NULL : &sim->state.short_steps_needed_at;
    const bool held = needed && *needed > 0 && !longer_is_safe(sim, resolved / sim->dt_lone_solid);
    sim->solid.contact = near ? &sim->contact : NULL;
    sim->dt_solid = near   ? min2(resolved, step_in_contact(sim))
                    : held ? resolved
                           : sim->dt_lone_solid;
    if (near && needed) *needed = sim->state.time;
    sim->contact.seconds += phase_clock() - start;
    return near;
}

/* A stiffness larger by a factor k shortens the step by sqrt(k) at most. 1.15 uses the margin of
 * the default solid_safety of 0.9: 0.9 sqrt(1.15) = 0.965. A softer solid is stable; its steps
 * are up to 1 - sqrt(0.6) = 23 % shorter than they could be. */
#define STIFFER 1.15
#define SOFTER 0.6

void timestep_recheck_solid(struct simulation *sim)
{
    struct state *const st = &sim->state;
    if (sim->scene->numerics.fixed_step > 0) return;
    const double now = solid_stiffening(&sim->solid, &sim->particles[KIND_SOLID]);
    if (now <= STIFFER * st->solid_stiffening && now >= SOFTER * st->solid_stiffening) return;
    double omega, damping;
    const double step =
        solid_stable_step(&sim->solid, &sim->particles[KIND_SOLID], &omega, &damping);
    if (!(step > 0)) return; /* not a number: the guards report the cause */
    st->solid_stiffening = now;
    st->solid_slowing = step / sim->solid.stable_step;
    timestep_set_solid(sim);
}

void timestep_count(struct simulation *sim, double dt, int n)
{
    struct state *const st = &sim->state;
    st->dt = dt;
    st->dt_max = max2(st->dt_max, dt);
    st->steps += n;
    st->particle_steps += n * (sim->particles[KIND_FLUID].n + sim->particles[KIND_SOLID].n);
    st->bound_steps[timestep_binding(sim)] += n;
}

void timestep_end_fluid_step(struct simulation *sim, double dt, double t_limit, bool hits)
{
    struct state *const st = &sim->state;
    st->time = hits ? t_limit : st->time + dt;
    st->dt_old = st->dt;
    st->dt_min = st->steps ? min2(st->dt_min, dt) : dt;
    timestep_count(sim, dt, 1);
}
