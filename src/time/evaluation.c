/* SPDX-License-Identifier: MIT
 * Evaluations of the rates, with moving walls, forces of the program and open boundaries. */
#include "time/advance.h"

#include <float.h>

void place_moving_walls(struct simulation *sim, double time)
{
    rigid_publish(&sim->rigid, sim->state.time, sim->state.dt);
    wall_motion_apply(&sim->wall_motion, sim->scene, &sim->particles[KIND_WALL],
                      scene_time(sim, time));
    for (int j = 0; j < sim->fluid.lines.n; j++) {
        struct thin_line *const line = &sim->fluid.lines.line[j];
        if (line->bends || !(line->follows || line->starts_at[0] || line->starts_at[1])) continue;
        if (line->follows) line_follow(line, &line->follows->placed);
        line_place(line, &sim->particles[KIND_WALL], time != sim->state.time);
    }
    if (sim->beams.line)
        sim->wall_motion.moved_most += beams_place(&sim->beams, time - sim->state.time);
}

void find_hook_forces(struct simulation *sim, enum kind kind, double time)
{
    struct force_hook *const hook = &sim->force_hook[kind];
    const size_t bytes = (size_t)sim->particles[kind].n * sizeof *hook->ax;
    memset(hook->ax, 0, bytes);
    memset(hook->ay, 0, bytes);
    hook->accelerate(hook->context, max2(0, scene_time(sim, time)), &sim->particles[kind], hook->ax,
                     hook->ay);
}

/* Accelerations from outside count in the step bound like those of the model. */
static void add_hook_forces(struct simulation *sim, double time)
{
    const struct force_hook *const hook = &sim->force_hook[KIND_FLUID];
    struct particles *const particles = &sim->particles[KIND_FLUID];
    find_hook_forces(sim, KIND_FLUID, time);
    double largest = sim->fluid.extremes.acceleration2;
    for (int64_t i = 0; i < particles->n; i++) {
        particles->ax[i] += hook->ax[i];
        particles->ay[i] += hook->ay[i];
        largest = max2(largest, square(particles->ax[i]) + square(particles->ay[i]));
    }
    sim->fluid.extremes.acceleration2 = largest;
}

/* L-5a: the gradients of the density are found once in the time in which sound crosses the
 * kernel's reach. Verlet's even and odd steps would drift apart by it. */
static bool keeps_slopes(const struct simulation *sim, double time)
{
    const struct state *const st = &sim->state;
    const double interval = KERNEL_REACH * sim->fluid.k.h / sim->fluid.k.c0;
    if (sim->integrator->alternates) return false;
    if (time != st->time) return true; /* symplectic: the predictor's */
    /* Rounded down: time - dt could otherwise fall into this interval although the last evaluation
     * was in the one before it. */
    const double before = time - st->dt - 2 * DBL_EPSILON * time;
    return st->steps > 0 && floor(time / interval) <= floor(before / interval);
}

void evaluate_rates(struct simulation *sim, double time)
{
    if (sim->evaluated) return;
    if (sim->effects & FX_MOTION) place_moving_walls(sim, time);
    if (sim->gravity_varies)
        scene_gravity_at(sim->scene, scene_time(sim, time), sim->fluid.k.gravity);
    if (sim->effects & FX_OPEN) {
        const double start = phase_clock();
        /* The predictor's state, half a step ahead, adds nothing to the energy account. */
        open_set(&sim->open, time, time == sim->state.time);
        phase_add(sim, PHASE_open, start);
    }
    if (sim->effects & FX_ANTUONO) sim->fluid.keeps_slopes = keeps_slopes(sim, time);
    fluid_evaluate(&sim->fluid, sim->particles, &sim->cells, sim->phase_seconds);
    const double clock = phase_clock();
    coupling_find_forces(&sim->coupling, sim->particles, &sim->cells);
    phase_add(sim, PHASE_wall, clock);
    if (sim->effects & FX_OPEN) open_hold(&sim->open);
    if (sim->effects & FX_DAMPING_ZONE)
        damping_add(&sim->zones, sim->scene, &sim->fluid.k, &sim->particles[KIND_FLUID]);
    if (sim->force_hook[KIND_FLUID].accelerate) add_hook_forces(sim, time);
    if (sim->force_hook[KIND_SOLID].accelerate) find_hook_forces(sim, KIND_SOLID, time);
}

void evaluate_start(struct simulation *sim)
{
    sim->state.evaluations++;
    evaluate_rates(sim, sim->state.time);
    sim->evaluated = false;
    if (sim->effects & FX_DAMPER)
        fluid_follow_density(&sim->fluid, &sim->particles[KIND_FLUID], sim->state.dt);
}

void simulation_refresh(struct simulation *sim)
{
    if ((sim->effects & FX_FLUID) && !sim->cells_overfull) {
        double seconds[PHASE_COUNT];
        memcpy(seconds, sim->phase_seconds, sizeof seconds);
        evaluate_rates(sim, sim->state.time);
        /* A caller's own forces and motions may change between two steps. */
        sim->evaluated = !sim->force_hook[KIND_FLUID].accelerate &&
                         !sim->force_hook[KIND_SOLID].accelerate && !sim->scene->motion_hook;
        if (!sim->evaluated) memcpy(sim->phase_seconds, seconds, sizeof seconds);
    }
    if (sim->effects & FX_SOLID) solid_stress(&sim->solid, &sim->particles[KIND_SOLID]);
}

void simulation_wall_forces(struct simulation *sim)
{
    simulation_refresh(sim);
    if (sim->effects & FX_FLUID && !sim->cells_overfull)
        coupling_find_wall_forces(&sim->coupling, sim->particles, &sim->cells);
}
