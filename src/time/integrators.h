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
/* A solid alone: many steps at once. */
void solid_only_step(struct simulation *s, double t_limit);

/* One evaluation of the fluid's rates and of the fluid's force on the solid, with walls where they are
 * at `time`. */
void evaluate_fluid(struct simulation *s, double time);

/* The same at the state that a step starts from, which need not be repeated where output has just made it. */
void evaluate_start(struct simulation *s);

/* The step uses the evaluation: the next one refers to it. One that is only looked at changes nothing. */
void accept_evaluation(struct simulation *s);

/* Advances the fluid by `rows`, which brings the particles from to end - 1 to their new velocities and
 * densities; `by` is what it needs to know. Their extremes are found while they are in the caches. */
typedef void advance_rows(struct particles *p, const void *by, int64_t from, int64_t end);
void advance_fluid(struct simulation *s, advance_rows *rows, const void *by);

/* Finds the extremes of the fluid as it stands. */
void update_extremes(struct simulation *s);

/* n solid steps within a fluid step of dt, with the fluid's force held or answering (T-35a); afterwards the
 * fluid sees the solid's mean velocity over the step, carried on to its end, and acceleration (T-35). */
void advance_solid(struct simulation *s, double dt, int n, bool centred);

/* Calls the accelerations of the program that uses the library, for a kind at a time. */
void find_push(struct simulation *s, enum kind kind, double time);

/* Puts moving walls where they are at a time, with their velocity and acceleration. */
void move_walls(struct simulation *s, double time);

/* x = X + u for the solid; returns the square of the longest way that a particle has gone by that, m^2. */
double place_solid(struct particles *p);

/* Adds the time since `since` to a phase and returns now. */
double phase_add(struct simulation *s, enum phase phase, double since);

#endif
