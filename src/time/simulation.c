/* SPDX-License-Identifier: MIT
 * A run in memory: its creation, the order of a step, and its continuation from a checkpoint. */
#include "time/simulation.h"
#include "base/hash.h"
#include "time/advance.h"
#include "time/guards.h"
#include "time/timestep.h"

static const struct integrator *const integrators[] = {
    [INTEGRATOR_SYMPLECTIC] = &integrator_symplectic,
    [INTEGRATOR_VERLET] = &integrator_verlet,
    [INTEGRATOR_LEAPFROG] = &integrator_leapfrog,
};

enum err simulation_create(struct simulation *sim, const struct scene *scene, struct diag *d)
{
    memset(sim, 0, sizeof *sim);
    sim->scene = scene;
    sim->effects = effects_of_scene(scene);
    sim->fluid.effects = sim->effects;
    sim->integrator = integrators[scene->top.integrator];
    sim->state.seeks_rest = (sim->effects & FX_RELAX) != 0;
    team_begin(&sim->team, thread_count());
    const enum err e = initial_state(sim, d);
    if (e) {
        simulation_free(sim);
        return e;
    }
    simulation_refresh(sim);
    open_forget(&sim->open); /* particles and velocities of the buffers belong to the start */
    energy_begin(sim);
    sim->state.det_low = 1;
    sim->evaluated = false; /* the caller may add to the scene before the first step */
    return ERR_OK;
}

enum err simulation_set_force_hook(struct simulation *sim, enum kind kind, force_hook_function *f,
                                   void *context, struct diag *d)
{
    struct force_hook *const hook = &sim->force_hook[kind];
    const size_t n = (size_t)sim->particles[kind].capacity;
    if (!hook->ax) TRY(arena_array(&sim->arena, &hook->ax, n, "accelerations", d));
    if (!hook->ay) TRY(arena_array(&sim->arena, &hook->ay, n, "accelerations", d));
    hook->accelerate = f;
    hook->context = context;
    sim->evaluated = false; /* the last evaluation lacked it */
    if (kind == KIND_SOLID) sim->solid.force_hook = f ? hook : NULL;
    return ERR_OK;
}

void simulation_free(struct simulation *sim) { arena_free(&sim->arena); }

/* Adds the magnitude of the impulse that fluid and structure exchanged in the last step. */
static void add_exchanged_impulse(struct simulation *sim)
{
    const struct particles *const particles = &sim->particles[KIND_SOLID];
    double fx = 0, fy = 0;
    for (int64_t i = 0; i < particles->n; i++) {
        fx += particles->fx[i];
        fy += particles->fy[i];
    }
    sim->state.exchanged += sim->state.dt * sqrt(fx * fx + fy * fy);
}

/* What follows a step: shifting, walls, work, guards and sorting. */
static enum err after_step(struct simulation *sim, double speed2_before, struct diag *d)
{
    double clock = phase_clock();
    /* Done here so that the state does not depend on output between two steps. */
    if (sim->effects & FX_SHIFTING) {
        sim->sorting.shifted = fluid_shift(&sim->fluid, &sim->particles[KIND_FLUID], sim->state.dt);
        clock = phase_add(sim, PHASE_shift, clock);
    }
    if (sim->effects & FX_MOTION) place_moving_walls(sim, sim->state.time);
    if (guards_strain_due(sim)) solid_write_stress(&sim->solid, &sim->particles[KIND_SOLID]);
    find_speed(sim);
    if (sim->effects & FX_OPEN) open_add_work(&sim->open, sim->state.dt);
    energy_after_step(sim);
    if (sim->effects & FX_COUPLING) add_exchanged_impulse(sim);
    /* Before the guards, which read the result: a checkpoint does not hold it. */
    if (!(sim->effects & FX_FLUID)) energy_test_if_due(sim);
    TRY(guards_check(sim, d));
    if (guards_strain_due(sim)) timestep_recheck_solid(sim);
    clock = phase_add(sim, PHASE_update, clock);
    if (!(sim->effects & FX_FLUID)) return ERR_OK;
    spend_skin(sim, speed2_before);
    /* Sorted here so that the cells are valid for output between two steps. */
    if (sorting_due(sim)) TRY(sort_particles(sim, d));
    clock = phase_add(sim, PHASE_sort, clock);
    limit_isolated_tension(sim);
    TRY(guards_check_entered(sim, d));
    phase_add(sim, PHASE_update, clock);
    return ERR_OK;
}

enum err simulation_step(struct simulation *sim, double t_limit, struct diag *d)
{
    const double begin = wall_clock(), speed2_before = sim->extremes.speed2;
    thread_use(sim->team.now);
    sim->fluid.threads = sim->team.now;
    solid_use_threads(&sim->solid, &sim->particles[KIND_SOLID], sim->team.now);
    sim->solid.time = scene_time(sim, sim->state.time);
    rigid_publish(&sim->rigid, sim->state.time, sim->state.dt);
    if (sim->effects & FX_FLUID) {
        TRY(observe(sim, sim->state.time + timestep_longest(sim), d));
        const double clock = phase_clock();
        timestep_watch_contact(sim, sim->solid.time, 1);
        phase_add(sim, PHASE_solid, clock);
        sim->integrator->step(sim, t_limit);
    } else {
        TRY(step_without_fluid(sim, t_limit, d));
    }
    TRY(after_step(sim, speed2_before, d));
    TRY(observe(sim, sim->state.time, d));
    team_next(&sim->team, wall_clock() - begin);
    return ERR_OK;
}

enum err simulation_resume(struct simulation *sim, struct diag *d)
{
    sim->evaluated = false;
    rigid_publish(&sim->rigid, sim->state.time, sim->state.dt);
    if (sim->effects & FX_FLUID) {
        for (int kind = 0; kind < KIND_COUNT; kind++)
            if (sim->particles[kind].capacity &&
                (kind != KIND_SOLID || (sim->effects & FX_COUPLING)))
                cells_rebuild(&sim->cells, (enum kind)kind, &sim->particles[kind]);
        if (sim->effects & FX_OPEN) TRY(open_list(&sim->open, d));
        if (sim->effects & (FX_RIGID | FX_BEAM | FX_COUPLING)) /* the run has warned */
            guards_warn_of_leaving(sim, &(struct diag){.warn = NULL});
        fluid_find_near(&sim->fluid, &sim->cells);
        measure_skin(sim);
        if (sim->effects & FX_COUPLING) forget_fluid(&sim->particles[KIND_SOLID]);
        if (sim->effects & FX_WALL) forget_fluid(&sim->particles[KIND_WALL]);
        if (cells_fullest(&sim->cells) > CELL_CAPACITY)
            return diag_fail(d, ERR_INPUT,
                             "the checkpoint cannot be used, because it has more than %d particles "
                             "in one cell; try an older one",
                             CELL_CAPACITY);
    }
    if (sim->effects & FX_SOLID) {
        timestep_set_solid(sim);
        if (sim->effects & FX_COUPLING)
            coupling_set_rate(&sim->coupling, sim->effects, timestep_fluid_limit(sim));
        contact_forget(&sim->contact, &sim->particles[KIND_WALL]);
        if (sim->effects & FX_IMPLICIT) implicit_resume(&sim->solid, &sim->particles[KIND_SOLID]);
        /* The guards read the last gradients. */
        solid_stress(&sim->solid, &sim->particles[KIND_SOLID]);
    }
    update_extremes(sim);
    find_speed(sim);
    return ERR_OK;
}

uint64_t simulation_hash(struct simulation *sim)
{
    simulation_refresh(sim);
    uint64_t h = HASH_START;
    for (int kind = 0; kind < KIND_COUNT; kind++) h = particles_hash(&sim->particles[kind], h);
    struct state state = sim->state;
    state.energy_start = state.gain = state.gain_share = state.gain_since = 0;
    h = hash_bytes(h, &state, offsetof(struct state, energy));
    if (sim->effects & FX_RIGID)
        h = hash_bytes(h, sim->rigid.state, (size_t)sim->rigid.n * sizeof *sim->rigid.state);
    if (sim->effects & FX_BEAM)
        h = hash_bytes(h, sim->beams.state, (size_t)sim->beams.n_nodes * sizeof *sim->beams.state);
    return sim->effects & FX_OPEN ? open_hash(&sim->open, h) : h;
}
