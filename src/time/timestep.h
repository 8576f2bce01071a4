/* SPDX-License-Identifier: MIT
 * The time step and its bounds (Sec. 2.5 of the article; time/bounds.def). */
#pragma once

#include "time/state.h"

/* Smallest bound of the fluid's step at rest, without those of solid and contact, s. */
double timestep_fluid_limit(const struct simulation *sim);
/* No next step is longer, with fluid or without, s. */
double timestep_longest(const struct simulation *sim);

/* The bound that limits the step now. */
enum bound timestep_binding(const struct simulation *sim);

/* The key of [numerics] that makes steps shorter, and half of its value. It is fixed_step,
 * with half of the smallest bound, if neither cfl nor solid_safety sets that step. */
const char *timestep_key_to_halve(const struct simulation *sim, double *half);

/* Finds all bounds of the next step, sim->dt_bound; returns the smallest, s. */
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

/* Whether contact can matter in the coming `steps`; then it bounds them and has forces. */
bool timestep_watch_contact(struct simulation *sim, double time, int steps);
