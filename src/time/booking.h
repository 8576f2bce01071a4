/* SPDX-License-Identifier: MIT
 * What each step adds to the account of energy (T-46): the work of all rates as the integrator
 * applies them. */
#ifndef SPHFSI_TIME_BOOKING_H
#define SPHFSI_TIME_BOOKING_H

#include "time/state.h"

/* After an evaluation at the present state, from which a step of dt starts: counts its rates over
 * half of the last step and half of this one, and checks the account in between if that is due. */
void book_step(struct simulation *s, double dt);

/* Checks the account at the present state if that is due. */
void book_check(struct simulation *s);

/* The same after so many steps of a solid without fluid. */
void book_check_solid_only(struct simulation *s, int64_t steps_before);

/* At a state from which Verlet takes an Euler step, after book_step: the solution that it discards. */
void book_restart(struct simulation *s);

/* After an evaluation in the middle of a step of dt: counts its rates over the step. */
void book_midpoint(struct simulation *s, double dt);

/* After n kicks of the solid within dt from x0, y0, vx0, vy0: counts the work of the fluid, of the
 * impedance and of a program's accelerations. `centred`: kicks in the middle of drifts. */
void book_solid(struct simulation *s, double dt, int n, bool centred);

/* Energy of position and compression of fluid sections, J/m: the change between the two calls is
 * counted as spent. */
struct fluid_energy {
    double section[SCENE_MAX_SECTIONS];
};
struct fluid_energy book_before(const struct simulation *s);
void book_change(struct simulation *s, const struct fluid_energy *before);

/* The density of a fluid particle is about to be set to zero: its energy of compression is spent. */
void book_reset(struct simulation *s, int64_t i);

/* Open boundaries: after open_book. */
void book_open(struct simulation *s);

#endif
