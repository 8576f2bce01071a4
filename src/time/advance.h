/* SPDX-License-Identifier: MIT
 * The state at time zero, and what a step consists of: evaluation of the rates, advance of fluid
 * and structure, sorting into cells. All integrators share it. */
#pragma once

#include "time/energy.h"

/* --- initial.c --- */

/* Builds all particles and models of sim->scene; sim->effects and the integrator are set. */
enum err initial_state(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

/* --- evaluation.c --- */

/* One evaluation of the fluid's rates and of the fluid's force on the solid, with walls at their
 * positions at `time`. */
void evaluate_rates(struct simulation *sim, double time);

/* Evaluates the state at the start of a step. Not repeated if output has just evaluated it. The
 * acoustic damper's density then follows, once a step (T-9b); an evaluation for output changes
 * nothing. */
void evaluate_start(struct simulation *sim);

/* Calls the accelerations of the program that uses the library, for a kind at a time. */
void find_external(struct simulation *sim, enum kind kind, double time);

/* Sets position, velocity and acceleration of moving walls at a time. */
void move_walls(struct simulation *sim, double time);

/* Brings DERIVED fields that output uses (pressure of wall and solid; displacement gradient) up to
 * date without changing the state. */
void simulation_refresh(struct simulation *sim);

/* Also finds the fluid's force on all walls: a step needs that on moving ones alone. */
void simulation_wall_forces(struct simulation *sim);

/* --- advance.c --- */

/* Advances the fluid by `range`, which updates the particles from `from` to `end` - 1 (NULL: they
 * stay). Finds their extremes while they are in the caches. */
typedef void advance_range(struct particles *particles, const void *parameters, int64_t from,
                           int64_t end);
void advance_fluid(struct simulation *sim, advance_range *range, const void *parameters);

/* The sub-steps of solids in a fluid step of dt; the rates of the evaluation act on the
 * fluid for `kick`. */
void advance_solids(struct simulation *sim, double dt, double kick);

/* The step of rigid bodies from a time on, in the same way: before that of solids, which may push
 * them, and after it. */
void begin_rigid(struct simulation *sim, double time, double dt, double kick);
void advance_rigid(struct simulation *sim, double time, double dt, double kick);

/* The step of beams from a time on. */
void advance_beams(struct simulation *sim, double time, double dt, double kick);

/* A step with one evaluation at its start, in which the integrator updates the fluid. */
void step_of_one_stage(struct simulation *sim, double t_limit);

/* Finds the extremes of the fluid's present state; and the speed of the fastest particle of
 * any kind. */
void update_extremes(struct simulation *sim);
void find_speed(struct simulation *sim);

/* --- sorting.c --- */

/* Sorts fluid, structure and moving walls into cells; removes fluid outside the domain. */
enum err sort_particles(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

/* Whether the cells may miss a pair at the next evaluations. */
bool sorting_due(struct simulation *sim);

/* Measures the skin that is left. */
void find_skin_left(struct simulation *sim);

/* Subtracts the largest distance that two particles can have moved in the last step from the
 * skin that is left; `speed2_before`: of the fluid before it. */
void use_skin_left(struct simulation *sim, double speed2_before);

/* Clears what particles of walls or structures have from the fluid. Evaluations skip those
 * without fluid nearby, so this is done before the cells change. */
void forget_fluid(struct particles *particles);

/* T-45: removes the tension of fluid particles far below the reference density with almost no
 * neighbours. To be called after a step, while cells are valid. */
void limit_isolated_tension(struct simulation *sim);

/* Particles within the kernel's reach of a point, of the first `kinds` kinds: fluid, walls,
 * solids. */
int particles_near(const struct simulation *sim, double x, double y, int kinds);

/* --- solid_steps.c --- */

/* Up to 16 steps of solids without fluid, or one with rigid bodies, which end at t_limit at the
 * latest. The observer sees the state before them, and within them the states on both sides of the
 * time that it waits for. */
enum err step_without_fluid(struct simulation *sim, double t_limit, struct diag *d) SPHFSI_CHECKED;

/* --- timestep.c: the time step and its bounds (Sec. 2.5 of the paper; time/bounds.def) --- */

/* Smallest bound of the fluid's step at rest, without those of solid and contact, s. */
double timestep_fluid_limit(const struct simulation *sim);
/* No next step is longer, with fluid or without, s. */
double timestep_longest(const struct simulation *sim);

/* The bound that limits the step now. */
enum bound timestep_binding(const struct simulation *sim);

/* The key of [numerics] that makes steps shorter, and half of its value. It is fixed_step,
 * with half of the smallest bound, if neither cfl nor solid_safety sets that step. */
const char *timestep_shorter(const struct simulation *sim, double *half);

/* Finds all bounds of the next step, sim->dt_bound, from the fluid's last evaluation and the bound
 * of the solid; returns the smallest, s. */
double timestep_bound(struct simulation *sim);

/* Chooses the next step by its bounds. It ends at t_limit at the latest; the last two steps before
 * that are equal. Sets `*hits` if the step ends at t_limit. */
double timestep_choose(struct simulation *sim, double t_limit, bool *hits);

/* Largest allowed number of the solid's sub-steps in one step of the fluid. */
enum { SUBSTEPS_MOST = 10000 };

/* Solid sub-steps of the coming fluid step of dt; 1 at a single rate. Kept in the state: raised as
 * soon as the solid's bound requires it, reduced once that cannot excite an oscillation (T-34c). */
int timestep_substeps(struct simulation *sim, double dt);

/* Sets the solid's step from its bound about the undeformed state and the state's reduction. */
void timestep_set_solid(struct simulation *sim);

/* Computes the solid's bound again if its stiffness has left the range of the last bound. Reads
 * gradients that are up to date. The state decides, so that a restart does the same. */
void timestep_recheck_solid(struct simulation *sim);

/* Counts n completed steps of dt. */
void timestep_count(struct simulation *sim, double dt, int n);

/* The end of a step with fluid: its time and what is counted. */
void timestep_end_fluid_step(struct simulation *sim, double dt, double t_limit, bool hits);

/* Whether contact can matter in the coming `steps` from `time` on. Stores its effect on their
 * bounds, and enables its forces if it can. */
bool timestep_watch_contact(struct simulation *sim, double time, int steps);

/* --- guards.c: limits beyond which a state is invalid --- */

/* Steps of the fluid between two checks of the solid's deformation, which need a pass of their
 * own. At a tenth of the speed of sound, neighbours approach by a third of their distance in
 * that time. */
enum { CHECK_INTERVAL = 16 };

/* Number of fluid particles inside a wall or solid; the index of the first of them, or -1. */
int64_t guards_count_entered(const struct simulation *sim, int64_t *first);

/* Checks from time to time for fluid that has entered a wall or a solid. Warns once, and fails if
 * there are more than stray particles. */
enum err guards_check_entered(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

/* Says that fluid has left the domain: the particles from `first` on, which are no longer in a
 * cell. */
void guards_warn_of_loss(const struct simulation *sim, int64_t first, struct diag *d);
/* After a sorting: of bodies of which no particle is in a cell. */
void guards_warn_of_leaving(struct simulation *sim, struct diag *d);

/* Whether surfaces in contact are pressed harder than the modulus of contact. */
bool guards_contact_hard(const struct simulation *sim);

/* Whether the check after this step reads the solid's gradients, which must then be up to date. */
bool guards_strain_due(const struct simulation *sim);

/* Checks the state after a step. ERR_GUARD with a sentence that names particle, place, time,
 * quantity and likely cause; warns once if a limit is near. */
enum err guards_check(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

/* --- the integrators, each in a file of its own --- */

extern const struct integrator integrator_symplectic; /* Eqs. 22-24 */
extern const struct integrator integrator_verlet;     /* Eqs. 25-27 */
extern const struct integrator integrator_leapfrog;   /* T-32a, T-32b */
