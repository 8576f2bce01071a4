/* SPDX-License-Identifier: MIT
 * The time step and its bounds (Sec. 2.5 of the paper; time/bounds.def). */
#ifndef SPHFSI_TIME_TIMESTEP_H
#define SPHFSI_TIME_TIMESTEP_H

#include "time/state.h"

/* Steps before an output time that are made equal: one step more in so many is a small change. */
enum { EQUAL_STEPS = 64 };

/* Outputs that are fewer steps apart must have a common grid of times. Others disturb the
 * steps rarely. */
enum { FREQUENT_STEPS = 16 };

/* Largest possible step of the fluid, s: Eq. 28b at rest. */
double timestep_fluid_limit(const struct simulation *sim);

/* C_CFL of Eq. 28b at rest for the largest step, whatever bound sets it; whether another bound
 * makes it longer. */
double timestep_courant(const struct simulation *sim);
bool timestep_beyond(const struct simulation *sim, double cfl);

/* An interval of outputs that the case may give: where, and its value, s; 0: there are none. */
struct output_interval {
    enum section_id section;
    int index;
    const char *key;
    double interval;
};

/* The intervals of a case, which = 0, 1 ...; false after the last one. */
bool timestep_output(const struct scene *scene, int which, struct output_interval *out);

/* T-34d: sets the grid of times, s, that has all outputs less than EQUAL_STEPS steps apart: the
 * greatest common divisor of their intervals. If it is finer than half a step, of those less than
 * FREQUENT_STEPS apart. 0 without solids or if it is one of the intervals. If that is too fine as
 * well, s->uneven tells which, and solids take half of their steps. */
void timestep_find_grid(struct simulation *sim);

/* The time at which the coming steps end: the next of that grid, or t_limit if that is earlier. */
double timestep_stop(const struct simulation *sim, double t_limit);

/* The key of [numerics] that makes steps shorter, and half of its value. It is fixed_step,
 * with half of the last step, if neither cfl nor solid_safety sets that step. */
const char *timestep_shorter(const struct simulation *sim, double *half);

/* Chooses the next step from the fluid's last evaluation and the solid's bound. It ends no later
 * than t_limit, and exactly there after equal steps. Fills s->dt_bound; sets `*hits` if the step
 * ends at t_limit. */
double timestep_choose(struct simulation *sim, double t_limit, bool *hits);

/* Largest allowed number of the solid's sub-steps in one step of the fluid. */
enum { SUBSTEPS_MOST = 10000 };

/* Solid sub-steps of the coming fluid step of dt; 1 at a single rate. Kept in the state: raised as
 * soon as the solid's bound requires it, reduced once that cannot excite an oscillation (T-34c). */
int timestep_substeps(struct simulation *sim, double dt);

/* Sets the solid's step from its bound about the undeformed state and the reduction in s->state. */
void timestep_set_solid(struct simulation *sim);

/* Computes the solid's bound again if its stiffness has left the range of the last bound. Reads
 * gradients that are up to date. The state decides, so that a restart does the same. */
void timestep_recheck_solid(struct simulation *sim);

/* Counts a completed step: time, counters, statistics. */
void timestep_book(struct simulation *sim, double dt, double t_limit, bool hits);

/* Whether contact can matter in the coming `steps` from `time` on. Stores its effect on their
 * bounds, and enables its forces if it can. */
bool timestep_watch_contact(struct simulation *sim, double time, int steps);

#endif
