/* SPDX-License-Identifier: MIT
 * The advance of fluid and structure, which all integrators share. */
#ifndef SPHFSI_TIME_ADVANCE_H
#define SPHFSI_TIME_ADVANCE_H

#include "time/state.h"

/* Advances the fluid by `rows`, which updates velocities and densities of the particles from to end
 * - 1; `by` holds its parameters. Finds their extremes while they are in the caches. */
typedef void advance_rows(struct particles *particles, const void *by, int64_t from, int64_t end);
void advance_fluid(struct simulation *sim, advance_rows *rows, const void *by);

/* The sub-steps of a structure in a fluid step of dt; the rates of the evaluation act on the
 * fluid for `kick`. */
void advance_structure(struct simulation *sim, double dt, double kick);

/* The step of rigid bodies from a time on, in the same way. */
void advance_rigid(struct simulation *sim, double time, double dt, double kick);

/* Finds the extremes of the fluid's present state; and the speed of the fastest particle of
 * any kind. */
void update_extremes(struct simulation *sim);
void find_speed(struct simulation *sim);

/* The integrators, each in a file of its own. */
extern const struct integrator integrator_symplectic; /* Eqs. 22-24 */
extern const struct integrator integrator_verlet;     /* Eqs. 25-27 */
extern const struct integrator integrator_leapfrog;   /* T-32a, T-32b */

#endif
