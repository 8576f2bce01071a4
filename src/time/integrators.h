/* SPDX-License-Identifier: MIT
 * The time integrators of Sec. 2.4, each one step of fluid, walls and solid. */
#ifndef SPHFSI_TIME_INTEGRATORS_H
#define SPHFSI_TIME_INTEGRATORS_H

#include "time/simulation.h"

/* Eqs. 22-24: predictor-corrector. */
void symplectic_step(struct simulation *s, double t_limit);
/* Eqs. 22-23 for a solid alone. */
void symplectic_solid(struct simulation *s, double dt);
/* Eqs. 25-27: Verlet for the fluid, semi-implicit Euler for the solid. */
void verlet_step(struct simulation *s, double t_limit);
/* T-32a, T-32b: leapfrog, one evaluation a step. */
void leapfrog_step(struct simulation *s, double t_limit);
/* A solid without fluid: many steps per call. */
void solid_only_step(struct simulation *s, double t_limit);

/* One evaluation of the fluid's rates and of the fluid's force on the solid, with walls at their
 * positions at `time`. */
void evaluate_fluid(struct simulation *s, double time);

/* The same for the state at the start of a step. Not repeated if output has just evaluated it. The
 * acoustic damper's density then follows, once a step (T-9b); an evaluation for output changes
 * nothing. */
void evaluate_start(struct simulation *s);

/* Advances the fluid by `rows`, which updates velocities and densities of the particles from to end
 * - 1; `by` holds its parameters. Finds their extremes while they are in the caches. */
typedef void advance_rows(struct particles *p, const void *by, int64_t from, int64_t end);
void advance_fluid(struct simulation *s, advance_rows *rows, const void *by);

/* Finds the extremes of the fluid's present state. */
void update_extremes(struct simulation *s);

/* The sub-steps of a structure in a fluid step of dt; the rates of the evaluation act on the fluid for
 * `kick`. */
void advance_structure(struct simulation *s, double dt, double kick);

/* Calls the accelerations of the program that uses the library, for a kind at a time. */
void find_external(struct simulation *s, enum kind kind, double time);

/* Sets position, velocity and acceleration of moving walls at a time. */
void move_walls(struct simulation *s, double time);

/* Adds the time since `since` to a phase and returns the present time. */
double phase_add(struct simulation *s, enum phase phase, double since);

#endif
