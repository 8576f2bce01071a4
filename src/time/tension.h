/* SPDX-License-Identifier: MIT
 * Isolated particles, which the fluid does not resolve. */
#ifndef SPHFSI_TIME_TENSION_H
#define SPHFSI_TIME_TENSION_H

#include "time/state.h"

/* Particles of all kinds within the kernel's reach of a point. */
int particles_near(const struct simulation *sim, double x, double y);

/* T-45: removes the tension of fluid particles far below the reference density with almost no
 * neighbours. To be called after a step, while cells are valid. */
void limit_isolated_tension(struct simulation *sim);

#endif
