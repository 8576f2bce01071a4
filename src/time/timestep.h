/* SPDX-License-Identifier: MIT
 * The time step and what bounds it (Sec. 2.5 of the paper; time/bounds.def). */
#ifndef SPHFSI_TIME_TIMESTEP_H
#define SPHFSI_TIME_TIMESTEP_H

#include "time/simulation.h"

/* Steps before an output time that are made equal: a change of one in so many is too little to
 * matter. */
enum { EQUAL_STEPS = 64 };

/* Largest step the fluid can ever take, s: Eq. 28b at rest. */
double timestep_fluid_limit(const struct simulation *s);

/* C_CFL of Eq. 28b at rest that the largest step has, whatever bounds it; and whether it is longer
 * than that
 * of another. */
double timestep_courant(const struct simulation *s);
bool timestep_beyond(const struct simulation *s, double cfl);

/* T-35d: largest step with the acceleration of the lightest body as the fluid uses it, s. */
double timestep_added_mass(const struct simulation *s, int *lightest);

/* Chooses the next step from the fluid's last evaluation and the solid's bound, ending no later than
 * t_limit and exactly there, by equal steps before it. Fills s->dt_bound. `*hits` is set where the step
 * ends at t_limit. */
double timestep_choose(struct simulation *s, double t_limit, bool *hits);

/* Most sub-steps of the solid in one step of the fluid that a run may ask for. */
enum { SUBSTEPS_MOST = 10000 };

/* Solid sub-steps of the coming fluid step of dt: 1 where each takes the same. Held in the state: more as
 * soon as the solid's bound asks for them, fewer once that cannot feed an oscillation (T-34c). */
int timestep_substeps(struct simulation *s, double dt);

/* Sets the solid's step from its bound about the undeformed state and the slowing in s->state. */
void timestep_set_solid(struct simulation *s);

/* Finds the solid's bound anew where its stiffness has left the range that the last one holds for.
 * Looks
 * at gradients that are up to date; the state decides, so that a restart does the same. */
void timestep_recheck_solid(struct simulation *s);

/* Books a step that has been taken: time, counters, statistics. */
void timestep_book(struct simulation *s, double dt, double t_limit, bool hits);

/* Whether contact can matter in the coming `steps` from `time` on: notes what it does to their
 * bounds, and lets its
 * forces act where it can. */
bool timestep_watch_contact(struct simulation *s, double time, int steps);

#endif
