/* SPDX-License-Identifier: MIT
 * Steps of a solid without fluid. */
#ifndef SPHFSI_TIME_SOLID_STEPS_H
#define SPHFSI_TIME_SOLID_STEPS_H

#include "time/state.h"

/* Up to 16 steps, which end no later than t_limit. */
void solid_only_step(struct simulation *sim, double t_limit);

#endif
