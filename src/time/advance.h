/* SPDX-License-Identifier: MIT
 * The state at time zero, and what a step consists of: evaluation of the rates, advance of fluid
 * and structure, sorting into cells. All integrators share it. */
#pragma once

#include "time/simulation.h"

/* --- initial.c --- */

/* Builds all particles and models of sim->scene; sim->effects and the integrator are set. */
enum err initial_state(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

/* --- evaluation.c --- */

/* An evaluation of the fluid's rates and its force on the solid, with walls as at `time`. */
void evaluate_rates(struct simulation *sim, double time);

/* Evaluates the state at the start of a step. Not repeated if output has just evaluated it. The
 * acoustic damper's density then follows, once a step (T-9b), not for output. */
void evaluate_start(struct simulation *sim);

/* Calls the accelerations of the program that uses the library, for a kind at a time. */
void find_hook_forces(struct simulation *sim, enum kind kind, double time);

/* Sets walls, thin lines, rigid bodies and beams to where they are at a time. */
void place_moving_walls(struct simulation *sim, double time);

/* --- advance.c --- */

/* Advances the fluid by `range`, which updates particles `from` to `end` - 1 (NULL:
 * they stay), and finds its extremes. */
typedef void advance_range(struct particles *particles, const void *parameters, int64_t from,
                           int64_t end);
void advance_fluid(struct simulation *sim, advance_range *range, const void *parameters);

/* The sub-steps of solids in a fluid step of dt, whose rates act for `rates_time`. */
void advance_solids(struct simulation *sim, double dt, double rates_time);

/* The step of rigid bodies. begin_rigid: before the sub-steps of solids, which may
 * push bodies. advance_rigid: after them. */
void begin_rigid(struct simulation *sim, double dt, double rates_time);
void advance_rigid(struct simulation *sim, double dt, double rates_time);

/* The step of beams. */
void advance_beams(struct simulation *sim, double dt, double rates_time);

/* A step with one evaluation at its start, in which the integrator updates the fluid. */
void step_of_one_stage(struct simulation *sim, double t_limit);

/* Finds the extremes of the fluid's present state; and the speed of the fastest particle. */
void update_extremes(struct simulation *sim);
void find_speed(struct simulation *sim);

/* --- sorting.c --- */

/* Sorts fluid, structure and moving walls into cells; removes fluid outside the domain. */
enum err sort_particles(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

/* Whether the cells may miss a pair at the next evaluations. */
bool sorting_due(struct simulation *sim);

/* Measures the skin that is left. */
void measure_skin(struct simulation *sim);

/* Subtracts the largest distance that two particles can have moved in the last step from the
 * skin that is left; `speed2_before`: of the fluid before it. */
void spend_skin(struct simulation *sim, double speed2_before);

/* Clears what particles of walls or structures have from the fluid. Evaluations skip those
 * without fluid nearby, so this is done before the cells change. */
void forget_fluid(struct particles *particles);

/* T-45: removes the tension of fluid particles far below the reference density with almost no
 * neighbours. To be called after a step, while cells are valid. */
void limit_isolated_tension(struct simulation *sim);

/* --- without_fluid.c --- */

/* Up to SOLID_BATCH steps of solids, or one with rigid bodies or beams, not beyond t_limit.
 * The observer sees the state before them and those on both sides of its time. */
enum err step_without_fluid(struct simulation *sim, double t_limit, struct diag *d) SPHFSI_CHECKED;

/* --- the integrators, each in a file of its own --- */

extern const struct integrator integrator_symplectic; /* Eqs. 22-24 */
extern const struct integrator integrator_verlet;     /* Eqs. 25-27 */
extern const struct integrator integrator_leapfrog;   /* T-32a, T-32b */
