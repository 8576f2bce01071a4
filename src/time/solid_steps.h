/* SPDX-License-Identifier: MIT
 * Steps of a solid without fluid. */
#ifndef SPHFSI_TIME_SOLID_STEPS_H
#define SPHFSI_TIME_SOLID_STEPS_H

#include "time/state.h"

/* Up to 16 steps, which end at t_limit at the latest. The observer sees the state before them, and
 * within them the states on both sides of the time that it waits for. */
enum err solid_only_step(struct simulation *sim, double t_limit, struct diag *d) SPHFSI_CHECKED;

/* One step of rigid bodies without fluid and solids. */
enum err rigid_only_step(struct simulation *sim, double t_limit, struct diag *d) SPHFSI_CHECKED;

#endif
