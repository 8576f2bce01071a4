/* SPDX-License-Identifier: MIT
 * The state at time zero: particles and models of a scene, and the rate of its solids. */
#include "time/advance.h"
#include "solid/hinges.h"
#include "solid/loads.h"
#include "time/timestep.h"

static enum err fill_kind(struct simulation *sim, enum kind kind, int64_t first_id, struct diag *d)
{
    const struct scene_points *const points = &sim->scene->points[kind];
    unsigned groups = effects_groups(sim->effects, kind);
    struct particles *const particles = &sim->particles[kind];
    memset(particles, 0, sizeof *particles);
    if (!groups || points->n == 0) return ERR_OK;
    if (kind == KIND_FLUID) groups |= sim->integrator->fluid_groups;
    if (kind == KIND_SOLID) groups |= G_START;
    const int64_t most = groups & G_OPEN ? open_capacity(sim->scene) : points->n;
    TRY(particles_create(particles, &sim->arena, most, groups, kind_names[kind], d));
    particles->n = points->n;
    for (int64_t i = 0; i < particles->n; i++) {
        particles->x[i] = points->x[i];
        particles->y[i] = points->y[i];
        particles->id[i] = first_id + i;
        particles->body[i] = points->body[i];
        if (particles->X) particles->X[i] = points->x[i];
        if (particles->Y) particles->Y[i] = points->y[i];
        if (particles->open) particles->open[i] = points->open[i];
        if (particles->free) particles->free[i] = points->clamped && points->clamped[i] ? 0 : 1;
    }
    return ERR_OK;
}

static double expr_or(const struct expr *e, double x, double y, double otherwise)
{
    return e ? expr_at(e, x, y) : otherwise;
}

static void start_fluid(struct simulation *sim)
{
    struct particles *const particles = &sim->particles[KIND_FLUID];
    for (int64_t i = 0; i < particles->n; i++) {
        const struct scene_fluid *const f = &sim->scene->fluid[particles->body[i]];
        const double x = particles->x[i], y = particles->y[i];
        /* Hydrostatic start below the free surface. */
        const double depth = isnan(f->surface) ? 0 : max2(0, f->surface - y);
        const double pressure =
            expr_or(f->pressure.e[0], x, y, -sim->scene->rho0 * sim->scene->top.gravity[1] * depth);
        particles->dens[i] = eos_dens(pressure, sim->scene->rho0, sim->scene->c0);
        if (particles->m)
            particles->m[i] = f->particle_mass == MASS_HYDROSTATIC ? 1 + particles->dens[i] : 1;
        particles->vx[i] = expr_or(f->velocity.e[0], x, y, 0);
        particles->vy[i] = expr_or(f->velocity.e[1], x, y, 0);
    }
    /* What integrators carry on begins with the same values. */
    const size_t bytes = (size_t)particles->n * sizeof(double);
    double *const to[] = {particles->vx_half, particles->vx_old,    particles->vy_half,
                          particles->vy_old,  particles->dens_slow, particles->dens_old};
    double *const from[] = {particles->vx, particles->vy, particles->dens};
    for (size_t k = 0; k < COUNT_OF(to); k++)
        if (to[k]) memcpy(to[k], from[k / 2], bytes);
}

static void start_solid(struct simulation *sim)
{
    struct particles *const particles = &sim->particles[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++) {
        const struct scene_solid *const b = &sim->scene->solid[particles->body[i]];
        particles->vx[i] =
            particles->free[i] * expr_or(b->velocity.e[0], particles->X[i], particles->Y[i], 0);
        particles->vy[i] =
            particles->free[i] * expr_or(b->velocity.e[1], particles->X[i], particles->Y[i], 0);
    }
    if (sim->solid.hinges) hinges_start(sim->solid.hinges, particles);
    for (int64_t i = 0; particles->wx && i < particles->n; i++) {
        particles->wx[i] = particles->vx[i];
        particles->wy[i] = particles->vy[i];
    }
}

/* Whether an implicit step costs less than the sub-steps of a fluid step (T-94). */
static bool implicit_pays(const struct simulation *sim)
{
    const struct scene *const scene = sim->scene;
    const struct scene_numerics *const n = &scene->numerics;
    bool possible = n->solid_steps == SOLID_STEPS_AUTO && sim->effects & FX_COUPLING &&
                    n->multirate != MULTIRATE_OFF && n->solid_precision != SOLID_PRECISION_SINGLE;
    for (int k = 0; k < scene->n_solid; k++)
        possible &= sim->solid.body[k].variational || !(sim->solid.body[k].kappa > 0);
    if (!possible) return false;
    const double substeps = timestep_fluid_limit(sim) / sim->dt_solid;
    return substeps > implicit_pays_from(&sim->solid, &sim->particles[KIND_SOLID]);
}

/* Sub-steps help where the solid's step is the smaller one. */
static enum err choose_rate(struct simulation *sim, struct diag *d)
{
    if (!(sim->effects & FX_COUPLING)) return ERR_OK;
    const double ratio = timestep_fluid_limit(sim) / sim->dt_solid;
    const bool implicit = sim->effects & FX_IMPLICIT;
    if (!implicit && !(ratio <= SUBSTEPS_MOST))
        return diag_fail(
            d, ERR_INPUT,
            "the solid's stable step of %.3g s needs %.3g sub-steps per fluid step, more than the "
            "limit of %d. Reduce young or damping_time of the [solid], or fixed_step, or raise the "
            "density of the [solid] or the sound_speed of the [fluid]",
            sim->dt_solid, ratio, SUBSTEPS_MOST);
    const int wish = sim->scene->numerics.multirate;
    const bool binds = sim->dt_solid < timestep_fluid_limit(sim);
    if (implicit || wish == MULTIRATE_ON || (wish == MULTIRATE_AUTO && binds))
        sim->effects |= FX_MULTIRATE;
    if (!(sim->effects & FX_MULTIRATE))
        sim->effects &= ~(effect_set)(FX_IMPEDANCE | FX_SPLIT_IMPULSE);
    sim->fluid.effects = sim->effects;
    coupling_set_rate(&sim->coupling, sim->effects, timestep_fluid_limit(sim));
    return ERR_OK;
}

/* The limits are those of docs/theory/guards.md. */
static void set_guards(struct simulation *sim)
{
    sim->guard = (struct guard){
        .dens_limit = 0.3,
        .speed_limit = sim->effects & FX_FLUID ? sim->scene->c0 : (double)INFINITY,
        .step_limit =
            1e-4 * (sim->effects & FX_FLUID ? timestep_fluid_limit(sim)
                                            : min2(sim->dt_solid, sim->solid.stable_step)),
    };
}

static enum err create_fluid(struct simulation *sim, struct diag *d)
{
    const struct scene *const scene = sim->scene;
    const double reach = KERNEL_REACH * scene->h, stray = scene->numerics.skin * scene->h;
    TRY(cells_create(&sim->cells, &sim->arena, scene->domain_lower, scene->domain_upper,
                     scene->top.dp, reach, stray, sim->particles, d));
    for (int axis = 0; axis < 2; axis++)
        if (scene_periodic(scene, axis)) TRY(cells_make_periodic(&sim->cells, axis, reach, d));
    TRY(fluid_create(&sim->fluid, &sim->arena, scene, sim->particles, &sim->cells, d));
    start_fluid(sim);
    if (!(sim->effects & FX_DAMPING_ZONE)) return ERR_OK;
    return damping_create(&sim->zones, &sim->arena, scene, sim->particles[KIND_FLUID].capacity, d);
}

static enum err create_bare_solids(struct simulation *sim, struct diag *d)
{
    TRY(solid_create(&sim->solid, &sim->arena, sim->scene, &sim->particles[KIND_SOLID],
                     sim->effects & FX_IMPLICIT, d));
    sim->solid.centred = sim->integrator->centred || sim->effects & FX_IMPLICIT;
    if (sim->effects & FX_HINGE)
        TRY(hinges_create(&sim->solid, &sim->arena, sim->scene, &sim->particles[KIND_SOLID], d));
    start_solid(sim);
    sim->solid.stable_step = solid_stable_step(&sim->solid, &sim->particles[KIND_SOLID],
                                               &sim->solid.omega_max, &sim->solid.damping_max);
    return ERR_OK;
}

/* The solids with what acts on them: implicit steps, contact, loads. */
static enum err create_solids(struct simulation *sim, struct diag *d)
{
    struct arena *const a = &sim->arena;
    struct particles *const particles = &sim->particles[KIND_SOLID];
    TRY(create_bare_solids(sim, d));
    sim->state.solid_stiffening = sim->state.solid_slowing = 1;
    timestep_set_solid(sim);
    if (implicit_pays(sim)) {
        sim->effects |= FX_IMPLICIT;
        TRY(particles_add(particles, a, G_MATRIX, "solid", d));
        /* In double precision. What the first call has allocated stays in the arena, unused. */
        TRY(create_bare_solids(sim, d));
    }
    if (sim->effects & FX_CONTACT)
        TRY(contact_create(&sim->contact, a, sim->scene, &sim->solid, particles, d));
    if (sim->effects & (FX_LOAD | FX_CLAMP_MOTION))
        TRY(loads_create(&sim->solid, a, sim->scene, particles, d));
    if (sim->effects & FX_IMPLICIT) {
        TRY(implicit_create(&sim->solid, a, particles, d));
        if (!(sim->effects & FX_FLUID))
            sim->solid.implicit->period = implicit_period(&sim->solid, particles);
    }
    sim->solid.gravity_scene = sim->gravity_varies ? sim->scene : NULL;
    timestep_set_solid(sim);
    return ERR_OK;
}

/* The step of rigid bodies and beams alone; with solids the step is that of solids. */
static void set_step_of_bodies(struct simulation *sim)
{
    const double never = (double)INFINITY;
    const double swing =
        sim->effects & FX_RIGID ? rigid_longest_step(&sim->rigid, &sim->stiffest) : never;
    const double bending = sim->effects & FX_BEAM ? beams_longest_step(&sim->beams) : never;
    if (sim->effects & FX_SOLID || bending < swing) sim->stiffest = 0;
    if (!(sim->effects & FX_SOLID))
        sim->dt_solid = sim->dt_lone_solid = sim->solid.stable_step = min2(swing, bending);
}

enum err initial_state(struct simulation *sim, struct diag *d)
{
    struct arena *const a = &sim->arena;
    struct particles *const walls = &sim->particles[KIND_WALL];
    sim->gravity_varies = scene_gravity_varies(sim->scene);
    int64_t id = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        TRY(fill_kind(sim, (enum kind)kind, id, d));
        id += sim->particles[kind].n;
    }
    if (sim->effects & FX_FLUID) TRY(create_fluid(sim, d));
    sim->open = (struct open_boundaries){.k = &sim->fluid.k,
                                         .particles = &sim->particles[KIND_FLUID],
                                         .cells = &sim->cells};
    if (sim->effects & FX_OPEN) TRY(open_create(&sim->open, a, sim->scene, id, d));
    sim->coupling = (struct coupling){
        .scene = sim->scene,
        .fluid = &sim->fluid,
        .solid = &sim->solid,
        .particles = &sim->particles[KIND_SOLID],
        .rates_at = sim->integrator->rates_at,
        .alternates = sim->integrator->alternates,
        .exchange_time = &sim->state.exchange_time,
    };
    if (sim->effects & FX_SOLID) TRY(create_solids(sim, d));
    if (sim->effects & FX_MOTION) {
        TRY(wall_motion_create(&sim->wall_motion, a, sim->scene, walls, d));
        if (sim->effects & FX_RIGID)
            TRY(rigid_create(&sim->rigid, a, sim->scene, &sim->wall_motion, walls,
                             sim->integrator->rates_at > 0 || !(sim->effects & FX_FLUID), d));
        if (sim->effects & FX_RIGID) sim->contact.rigid = &sim->rigid;
    }
    if (sim->effects & FX_BEAM) TRY(beams_create(&sim->beams, a, sim->scene, d));
    if (sim->effects & FX_BEAM && sim->effects & FX_RIGID) sim->beams.rigid = &sim->rigid;
    if (sim->effects & FX_BEAM && sim->effects & FX_FLUID)
        TRY(beams_wet_create(&sim->beams, a, &sim->fluid.lines, walls, sim->integrator->rates_at,
                             sim->integrator->alternates, d));
    if (sim->effects & FX_THIN) lines_tie(&sim->fluid.lines, &sim->wall_motion);
    if (sim->effects & FX_MOTION) place_moving_walls(sim, 0);
    if (!(sim->effects & FX_FLUID)) set_step_of_bodies(sim);
    TRY(choose_rate(sim, d));
    set_guards(sim);
    update_extremes(sim);
    find_speed(sim);
    return sim->effects & FX_FLUID ? sort_particles(sim, d) : ERR_OK;
}
