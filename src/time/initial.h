/* SPDX-License-Identifier: MIT
 * The state at time zero. */
#ifndef SPHFSI_TIME_INITIAL_H
#define SPHFSI_TIME_INITIAL_H

#include "time/state.h"

/* Builds all particles and models of sim->scene; sim->effects and the integrator are set. */
enum err initial_state(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

#endif
