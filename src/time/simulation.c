/* SPDX-License-Identifier: MIT */
#include "time/simulation.h"
#include "time/account.h"
#include "time/booking.h"
#include "time/guards.h"

#include <math.h>
#include <string.h>

#include "time/isolated.h"
#include "fluid/eos.h"
#include "time/integrators.h"
#include "time/warnings.h"
#include "particles/kernel.h"
#include "time/timestep.h"

/* Distances from a point to particles at rest. */
static enum err fill_kind(struct simulation *s, enum kind kind, int64_t first_id, struct diag *d)
{
    const struct scene_points *const points = &s->scene->points[kind];
    const unsigned groups = effects_groups(s->effects, kind, s->scene->top.integrator);
    struct particles *const p = &s->kind[kind];
    memset(p, 0, sizeof *p);
    if (!groups || points->n == 0) return ERR_OK;
    const int64_t most = groups & G_OPEN ? open_places(s->scene) : points->n;
    TRY(particles_create(p, &s->arena, most, groups, kind_names[kind], d));
    p->n = points->n;
    for (int64_t i = 0; i < p->n; i++) {
        p->x[i] = points->x[i];
        p->y[i] = points->y[i];
        p->id[i] = first_id + i;
        p->body[i] = points->body[i];
        if (p->X) p->X[i] = points->x[i];
        if (p->Y) p->Y[i] = points->y[i];
        if (p->open) p->open[i] = points->open[i];
        if (p->free) p->free[i] = points->clamped && points->clamped[i] ? 0 : 1;
    }
    return ERR_OK;
}

static double expr_or(const struct expr *e, double x, double y, double otherwise)
{
    return e ? scene_expr_at(e, x, y) : otherwise;
}

static void start_fluid(struct simulation *s)
{
    struct particles *const p = &s->kind[KIND_FLUID];
    for (int64_t i = 0; i < p->n; i++) {
        const struct scene_fluid *const f = &s->scene->fluid[p->body[i]];
        const double x = p->x[i], y = p->y[i];
        /* Hydrostatic start below the free surface. */
        const double depth = isnan(f->surface) ? 0 : max2(0, f->surface - y);
        const double pressure =
            expr_or(f->pressure.e[0], x, y, -s->scene->rho0 * s->scene->top.gravity[1] * depth);
        p->dens[i] = eos_dens(pressure, s->scene->rho0, s->scene->c0);
        if (p->dens_slow) p->dens_slow[i] = p->dens[i];
        if (p->m) p->m[i] = f->particle_mass == MASS_HYDROSTATIC ? 1 + p->dens[i] : 1;
        p->vx[i] = expr_or(f->velocity.e[0], x, y, 0);
        p->vy[i] = expr_or(f->velocity.e[1], x, y, 0);
        if (p->vx_half) {
            p->vx_half[i] = p->vx[i];
            p->vy_half[i] = p->vy[i];
        }
        if (!p->vx_old) continue;
        p->vx_old[i] = p->vx[i];
        p->vy_old[i] = p->vy[i];
        p->dens_old[i] = p->dens[i];
    }
}

static void start_solid(struct simulation *s)
{
    struct particles *const p = &s->kind[KIND_SOLID];
    for (int64_t i = 0; i < p->n; i++) {
        const struct scene_solid *const b = &s->scene->solid[p->body[i]];
        p->vx[i] = p->free[i] * expr_or(b->velocity.e[0], p->X[i], p->Y[i], 0);
        p->vy[i] = p->free[i] * expr_or(b->velocity.e[1], p->X[i], p->Y[i], 0);
        if (!p->wx) continue;
        p->wx[i] = p->vx[i];
        p->wy[i] = p->vy[i];
    }
}

/* What makes the steps of fluid and solid so different, and its remedy. */
static const char *remedy_of_substeps(const struct simulation *s)
{
    const double free = solid_step_of(square(s->solid.omega_max), 0);
    bool damped = false;
    for (int k = 0; k < s->scene->n_solid; k++) damped |= s->scene->solid[k].damping_time > 0;
    const double sound = s->scene->numerics.cfl * s->fluid.k.h / s->fluid.k.c0;
    if (s->scene->numerics.fixed_step > sound) return "reduce fixed_step, or leave it out";
    if (damped && s->solid.stable_step < 0.5 * free)
        return "reduce the damping_time of the [solid]";
    return "reduce young of the [solid], or raise its density or the sound_speed of the [fluid]";
}

/* Sub-steps help where the solid's step is the smaller one. */
static enum err choose_rate(struct simulation *s, struct diag *d)
{
    if (!(s->effects & FX_COUPLING)) return ERR_OK;
    const double ratio = timestep_fluid_limit(s) / s->dt_solid;
    if (!(ratio <= SUBSTEPS_MOST))
        return diag_fail(
            d, ERR_INPUT,
            "the solid's stable step of %.3g s needs %.3g sub-steps per fluid step, more than the "
            "limit of %d; %s",
            s->dt_solid, ratio, SUBSTEPS_MOST, remedy_of_substeps(s));
    const int wish = s->scene->numerics.multirate;
    const bool binds = s->dt_solid < timestep_fluid_limit(s);
    if (wish == MULTIRATE_ON || (wish == MULTIRATE_AUTO && binds)) s->effects |= FX_MULTIRATE;
    if (!(s->effects & FX_MULTIRATE))
        s->effects &= ~(effect_set)(FX_IMPEDANCE | FX_FORCE_EXTRAPOLATION);
    s->fluid.effects = s->effects;
    coupling_set_rate(&s->coupling, s->effects, timestep_fluid_limit(s));
    return ERR_OK;
}

static void set_guards(struct simulation *s)
{
    s->guard = (struct guard){
        .dens_limit = 0.3,
        .speed_limit = s->effects & FX_FLUID ? s->scene->c0 : (double)INFINITY,
        .step_limit = 1e-4 * (s->effects & FX_FLUID ? timestep_fluid_limit(s) : s->dt_solid),
    };
}

static void find_speed(struct simulation *s)
{
    const struct particles *const solid = &s->kind[KIND_SOLID];
    double top = s->extremes.speed2;
#pragma omp parallel for schedule(static) reduction(max : top) if (solid->n > 0)
    for (int64_t i = 0; i < solid->n; i++)
        top = max2(top, solid->vx[i] * solid->vx[i] + solid->vy[i] * solid->vy[i]);
    s->speed2 = top;
    if (s->effects & FX_MOTION)
        s->speed2 = max2(s->speed2, wall_motion_speed2(&s->wall_motion, &s->kind[KIND_WALL]));
}

/* Energy that a fluid particle carries, J/m. */
static double energy_of(const struct simulation *s, const struct particles *p, int64_t i)
{
    const struct fluid_constants *const k = &s->fluid.k;
    const double *const g = s->scene->top.gravity;
    const double m = p->m ? p->m[i] : 1;
    return m * k->mass *
           (0.5 * (square(p->vx[i]) + square(p->vy[i])) - g[0] * p->x[i] - g[1] * p->y[i] +
            eos_energy(p->dens[i], k->c0));
}

/* Energy that gravity adds to fluid that leaves through a periodic side and enters at the opposite
 * one. */
static void book_crossings(struct simulation *s)
{
    for (int axis = 0; axis < 2; axis++) {
        const double given = s->fluid.k.mass * s->scene->top.gravity[axis] *
                             (double)s->cells.crossings[axis] *
                             (s->scene->domain_upper[axis] - s->scene->domain_lower[axis]);
        s->state.periodic_energy += given;
        s->state.account.put[account_entry(KIND_FLUID, 0)] += given;
    }
}

static void forget(struct particles *p, int64_t i)
{
    p->p[i] = p->dens[i] = 0;
    if (p->fx) p->fx[i] = p->fy[i] = 0;
    if (p->wet_x) p->wet_x[i] = p->wet_y[i] = 0;
}

/* Clears the fluid sums of structure particles. Evaluations skip those without fluid nearby, so
 * this is done before the cells change. */
static void forget_touch(struct simulation *s, enum kind kind)
{
    struct particles *const p = &s->kind[kind];
    const struct cell_list *const list = &s->cells.kind[kind];
    for (int32_t k = 0; k < s->fluid.n_near_fluid[kind]; k++) {
        const int32_t cell = s->fluid.near_fluid[kind][k];
        for (int32_t j = list->start[cell]; j < list->start[cell] + list->count[cell]; j++) {
            forget(p, list->order[j]);
        }
    }
}

/* A checkpoint contains the sums of the last evaluation before it. */
static void forget_all_touch(struct particles *p)
{
    for (int64_t i = 0; i < p->n; i++) forget(p, i);
}

/* Sets the cells' skin from a new measurement. The next evaluation uses the present state; the
 * predictor's second one is half a step of the present velocities later. */
static void find_skin_left(struct simulation *s)
{
    const bool predicts = s->scene->top.integrator == INTEGRATOR_SYMPLECTIC;
    const double ahead = predicts ? 1.1 * timestep_fluid_limit(s) * sqrt(s->speed2) : 0;
    s->skin_left = cells_skin_left(&s->cells, KERNEL_REACH * s->fluid.k.h + ahead);
}

/* Sorts fluid, structure and moving walls into cells; removes fluid outside the domain. */
static enum err sort_particles(struct simulation *s, struct diag *d)
{
    struct particles *const fluid = &s->kind[KIND_FLUID], *const solid = &s->kind[KIND_SOLID];
    if (s->effects & FX_WALL) forget_touch(s, KIND_WALL);
    if (s->effects & FX_COUPLING) forget_touch(s, KIND_SOLID);
    if (s->effects & FX_OPEN) TRY(open_exchange(&s->open, &s->fluid.k, fluid, d));
    const int64_t lost = cells_sort(&s->cells, KIND_FLUID, fluid);
    if (lost && s->state.lost == 0) guards_warn_of_loss(s, fluid->n - lost, d);
    for (int64_t i = fluid->n - lost; i < fluid->n; i++) {
        const double energy = energy_of(s, fluid, i);
        s->state.lost_energy += energy;
        s->state.account.put[account_entry(KIND_FLUID, fluid->body[i])] -= energy;
    }
    if (s->effects & FX_PERIODIC) book_crossings(s);
    fluid->n -= lost;
    s->state.lost += lost;
    if (s->effects & FX_OPEN) TRY(open_list(&s->open, fluid, d));
    if ((s->effects & FX_WALL) && s->state.sorts == 0)
        cells_sort(&s->cells, KIND_WALL, &s->kind[KIND_WALL]);
    else if (s->effects & FX_MOTION)
        wall_motion_sort(&s->wall_motion, &s->cells, &s->kind[KIND_WALL]);
    if (s->effects & FX_COUPLING) cells_sort(&s->cells, KIND_SOLID, solid);
    fluid_find_near(&s->fluid, &s->cells);
    s->state.sorts++;
    const int32_t fullest = fluid_fullest_cell(&s->cells);
    s->cells_overfull = fullest > CELL_CAPACITY;
    find_skin_left(s);
    if (s->cells_overfull && s->state.steps == 0)
        return diag_fail(
            d, ERR_INPUT,
            "%d particles start in one cell of %.3g m, more than the limit of %d; use a smaller "
            "numerics.h_over_dp, or a dp of solids closer to that of the fluid",
            fullest, s->cells.side[0], CELL_CAPACITY);
    if (s->cells_overfull)
        return diag_fail(
            d, ERR_GUARD,
            "t = %.6g s: %d particles have collapsed into one cell of %.3g m, where about twenty "
            "are usual, so the run is unstable; a smaller cfl or another sound_speed may help",
            s->state.time, fullest, s->cells.side[0]);
    return ERR_OK;
}

/* Subtracts the largest distance that two particles can have moved in the last step from the skin.
 * For the fluid: the larger of its speeds before and after, half a step of its acceleration, and
 * its shift. */
static void use_skin_left(struct simulation *s, double speed2_before)
{
    const double dt = s->state.dt, speed = sqrt(max2(speed2_before, s->extremes.speed2)),
                 moved =
                     dt * (speed + 0.5 * dt * sqrt(s->fluid.extremes.acceleration2)) + s->shifted;
    s->skin_left -= moved + max2(moved, s->solid_max_move);
}

/* Whether the cells may miss a pair at the next evaluations. Where displacements are bounded,
 * cells need not be measured at every step. Rounding errors of the displacements are below the
 * tolerance. */
static bool sorting_due(struct simulation *s)
{
    if (s->effects & FX_OPEN && open_due(&s->open, &s->kind[KIND_FLUID], s->scene->top.dp))
        return true;
    const bool bounded =
        s->scene->top.integrator != INTEGRATOR_SYMPLECTIC && !(s->effects & FX_MOTION);
    const double tolerance = 1e-6 * s->fluid.k.h;
    if (bounded && s->skin_left > tolerance) return false;
    for (int kind = 0; kind < KIND_COUNT; kind++)
        if (s->cells.kind[kind].n_active && (kind != KIND_WALL || s->wall_motion.moved))
            cells_measure_overhang(&s->cells, (enum kind)kind, &s->kind[kind]);
    find_skin_left(s);
    return !(s->skin_left > 0);
}

static enum err create_fluid(struct simulation *s, struct diag *d)
{
    const struct scene *const scene = s->scene;
    const double reach = KERNEL_REACH * scene->h, stray = scene->numerics.skin * scene->h;
    TRY(cells_create(&s->cells, &s->arena, scene->domain_lower, scene->domain_upper, reach, stray,
                     s->kind, d));
    for (int axis = 0; axis < 2; axis++)
        if (scene_periodic(scene, axis)) TRY(cells_make_periodic(&s->cells, axis, reach, d));
    TRY(fluid_create(&s->fluid, &s->arena, scene, s->effects, s->kind, &s->cells, d));
    start_fluid(s);
    return ERR_OK;
}

void simulation_begin_account(struct simulation *s)
{
    const struct ledger start = simulation_ledger(s);
    s->state.energy_start = start.kinetic + start.potential + start.internal + start.elastic +
                            start.hourglass + start.contact;
    account_begin(s);
}

static enum err build(struct simulation *s, struct diag *d)
{
    s->gravity_varies = scene_gravity_varies(s->scene);
    int64_t id = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        TRY(fill_kind(s, (enum kind)kind, id, d));
        id += s->kind[kind].n;
    }
    if (s->effects & FX_FLUID) TRY(create_fluid(s, d));
    if (s->effects & FX_OPEN) TRY(open_create(&s->open, &s->arena, s->scene, id, d));
    if (s->effects & FX_SOLID) {
        TRY(solid_create(&s->solid, &s->arena, s->scene, &s->kind[KIND_SOLID], d));
        start_solid(s);
        solid_find_step(&s->solid, &s->kind[KIND_SOLID]);
        if (s->effects & FX_CONTACT)
            TRY(contact_create(&s->contact, &s->arena, s->scene, &s->solid, &s->kind[KIND_SOLID],
                               d));
        if (s->effects & (FX_LOAD | FX_CLAMP_MOTION)) {
            TRY(loads_create(&s->loads, &s->arena, s->scene, &s->kind[KIND_SOLID], d));
            s->solid.loads = &s->loads;
        }
        s->solid.gravity = s->gravity_varies ? s->scene : NULL;
        s->state.solid_stiffening = s->state.solid_slowing = 1;
        timestep_set_solid(s);
    }
    if (s->effects & FX_MOTION) {
        TRY(wall_motion_create(&s->wall_motion, &s->arena, s->scene, &s->kind[KIND_WALL], d));
        move_walls(s, 0);
    }
    coupling_create(&s->coupling, s->scene, &s->fluid, &s->solid, &s->kind[KIND_SOLID]);
    s->coupling.exchange_time = &s->state.exchange_time;
    s->coupling.ahead = s->scene->top.integrator == INTEGRATOR_SYMPLECTIC ? 0.5 : 0;
    s->coupling.centred = s->scene->top.integrator != INTEGRATOR_VERLET;
    TRY(choose_rate(s, d));
    timestep_find_grid(s);
    simulation_warn_of_steps(s, d);
    set_guards(s);
    update_extremes(s);
    find_speed(s);
    if (s->effects & FX_FLUID) TRY(sort_particles(s, d));
    simulation_begin_account(s);
    open_forget(&s->open); /* particles and velocities of the buffers belong to the start */
    book_open(s);
    s->state.det_low = 1;
    s->evaluated = false; /* the caller may add to the scene before the first step */
    return ERR_OK;
}

enum err simulation_create(struct simulation *s, const struct scene *scene, struct diag *d)
{
    memset(s, 0, sizeof *s);
    s->scene = scene;
    s->effects = effects_of_scene(scene);
    const enum err e = build(s, d);
    if (e) simulation_free(s);
    return e;
}

enum err simulation_external(struct simulation *s, enum kind kind, external_function *at,
                             void *context, struct diag *d)
{
    struct external *const external = &s->external[kind];
    const size_t n = (size_t)s->kind[kind].capacity;
    if (!external->ax)
        external->ax = arena_alloc(&s->arena, n, sizeof *external->ax, "accelerations", d);
    if (!external->ay)
        external->ay = arena_alloc(&s->arena, n, sizeof *external->ay, "accelerations", d);
    if (!external->ax || !external->ay) return ERR_MEMORY;
    external->at = at;
    external->context = context;
    s->evaluated = false; /* without it */
    if (kind == KIND_SOLID) s->solid.external[0] = at ? external->ax : NULL;
    if (kind == KIND_SOLID) s->solid.external[1] = at ? external->ay : NULL;
    return ERR_OK;
}

void simulation_free(struct simulation *s) { arena_free(&s->arena); }

/* Moves fluid particles towards lower concentration. */
static double shift_fluid(struct simulation *s, double clock)
{
    const struct fluid_energy before = book_before(s);
    s->shifted = fluid_shift(&s->fluid, &s->kind[KIND_FLUID], s->state.dt);
    book_change(s, &before);
    return phase_add(s, PHASE_shift, clock);
}

/* T-70: work in the last step of gravity beyond its value at t = 0, with the value at mid-step. The
 * ledger has the potential energy of the value at t = 0. */
static void add_gravity_work(struct simulation *s)
{
    double g[2], px = 0, py = 0;
    const double *const start = s->scene->top.gravity;
    scene_gravity_at(s->scene, s->state.time - 0.5 * s->state.dt, g);
    const struct particles *const fluid = &s->kind[KIND_FLUID], *const solid = &s->kind[KIND_SOLID];
    for (int64_t i = 0; i < fluid->n; i++) {
        px += s->fluid.k.mass * fluid->vx[i];
        py += s->fluid.k.mass * fluid->vy[i];
    }
    for (int64_t i = 0; i < solid->n; i++) {
        const double mass = s->scene->solid[solid->body[i]].gravity * solid->free[i] *
                            s->solid.body[solid->body[i]].mass;
        px += mass * solid->vx[i];
        py += mass * solid->vy[i];
        s->state.account.put[account_entry(KIND_SOLID, solid->body[i])] +=
            s->state.dt * mass *
            ((g[0] - start[0]) * solid->vx[i] + (g[1] - start[1]) * solid->vy[i]);
    }
    s->state.wall_work += s->state.dt * ((g[0] - start[0]) * px + (g[1] - start[1]) * py);
}

/* Magnitude of the impulse exchanged between fluid and structure in the last step. */
static void add_exchange(struct simulation *s)
{
    const struct particles *const p = &s->kind[KIND_SOLID];
    double fx = 0, fy = 0;
    for (int64_t i = 0; i < p->n; i++) {
        fx += p->fx[i];
        fy += p->fy[i];
    }
    s->state.exchanged += s->state.dt * sqrt(fx * fx + fy * fy);
}

/* What the last step has done to the solid from outside, and whether bodies have touched. */
static void take_work(struct simulation *s)
{
    s->state.wall_work += s->solid.work;
    s->solid.work = 0;
    for (int k = 0; k < s->solid.n_bodies; k++) {
        account_work(&s->state.account, SOURCE_OUTSIDE, KIND_SOLID, k, s->solid.work_on[k]);
        s->solid.work_on[k] = 0;
    }
    account_touch(s);
}

/* Updates the solid's gradients if the guards or the search for the step read them after this
 * step. */
static void show_strain(struct simulation *s)
{
    if (guards_strain_due(s)) solid_show(&s->solid, &s->kind[KIND_SOLID]);
}

enum err simulation_step(struct simulation *s, double t_limit, struct diag *d)
{
    s->solid.time = s->state.time;
    t_limit = timestep_stop(s, t_limit);
    if (!(s->effects & FX_FLUID)) {
        const int64_t steps = s->state.steps;
        solid_only_step(s, t_limit);
        take_work(s);
        if (s->gravity_varies) add_gravity_work(s);
        if (s->effects & FX_MOTION) move_walls(s, s->state.time);
        find_speed(s);
        show_strain(s);
        /* Before the guards, which judge what it finds: a checkpoint does not hold that. */
        book_check_solid_only(s, steps);
        TRY(guards_check(s, d));
        timestep_recheck_solid(s);
        return ERR_OK;
    }
    const double speed2_before = s->extremes.speed2;
    const double watch = wall_clock();
    timestep_watch_contact(s, s->state.time, 1);
    /* As phase_add takes all seconds of contact out of the solid's. */
    if (s->effects & FX_CONTACT) s->phase_seconds[PHASE_solid] += wall_clock() - watch;
    if (s->scene->top.integrator == INTEGRATOR_SYMPLECTIC)
        symplectic_step(s, t_limit);
    else if (s->scene->top.integrator == INTEGRATOR_VERLET)
        verlet_step(s, t_limit);
    else
        leapfrog_step(s, t_limit);
    double clock = wall_clock();
    /* Done here so that the state does not depend on output between two steps. */
    if (s->effects & FX_SHIFTING) clock = shift_fluid(s, clock);
    if (s->effects & FX_MOTION) move_walls(s, s->state.time);
    show_strain(s);
    const enum err e = guards_check(s, d);
    find_speed(s);
    if (s->effects & FX_MOTION)
        s->state.wall_work += s->state.dt * wall_motion_power(&s->wall_motion, &s->kind[KIND_WALL]);
    if (s->effects & FX_OPEN) {
        open_book(&s->open, s->state.dt);
        book_open(s);
    }
    take_work(s);
    if (s->gravity_varies) add_gravity_work(s);
    if (s->effects & FX_COUPLING) add_exchange(s);
    if (!e && guards_strain_due(s)) timestep_recheck_solid(s);
    clock = phase_add(s, PHASE_update, clock);
    if (e) return e;
    use_skin_left(s, speed2_before);
    /* Sorted here so that the cells are valid for output between two steps. */
    if (sorting_due(s)) TRY(sort_particles(s, d));
    clock = phase_add(s, PHASE_sort, clock);
    limit_isolated_tension(s);
    TRY(guards_penetration(s, d));
    phase_add(s, PHASE_update, clock);
    return ERR_OK;
}

enum err simulation_resume(struct simulation *s, struct diag *d)
{
    TRY(account_check(&s->state.account, d));
    s->evaluated = false;
    if (s->effects & FX_FLUID) {
        for (int kind = 0; kind < KIND_COUNT; kind++)
            if (s->kind[kind].capacity && (kind != KIND_SOLID || (s->effects & FX_COUPLING)))
                cells_rebuild(&s->cells, (enum kind)kind, &s->kind[kind]);
        if (s->effects & FX_OPEN) TRY(open_list(&s->open, &s->kind[KIND_FLUID], d));
        fluid_find_near(&s->fluid, &s->cells);
        find_skin_left(s);
        if (s->effects & FX_COUPLING) forget_all_touch(&s->kind[KIND_SOLID]);
        if (s->effects & FX_WALL) forget_all_touch(&s->kind[KIND_WALL]);
        if (fluid_fullest_cell(&s->cells) > CELL_CAPACITY)
            return diag_fail(d, ERR_INPUT,
                             "the checkpoint cannot be used, because it has more than %d particles "
                             "in one cell; try an older one",
                             CELL_CAPACITY);
    }
    if (s->effects & FX_SOLID) {
        timestep_set_solid(s);
        if (s->effects & FX_COUPLING)
            coupling_set_rate(&s->coupling, s->effects, timestep_fluid_limit(s));
        contact_forget(&s->contact, &s->kind[KIND_WALL]);
        solid_stress(&s->solid, &s->kind[KIND_SOLID]); /* the guards read the last gradients */
    }
    update_extremes(s);
    find_speed(s);
    return ERR_OK;
}

uint64_t simulation_hash(struct simulation *s)
{
    simulation_refresh(s);
    uint64_t h = HASH_START;
    for (int kind = 0; kind < KIND_COUNT; kind++) h = particles_hash(&s->kind[kind], h);
    h = hash_bytes(h, &s->state, sizeof s->state);
    return s->effects & FX_OPEN ? open_hash(&s->open, h) : h;
}
