/* SPDX-License-Identifier: MIT
 * Fluid inside a wall or a solid. */
#ifndef SPHFSI_TIME_PENETRATION_H
#define SPHFSI_TIME_PENETRATION_H

#include "time/state.h"

/* Number of fluid particles inside a wall or solid; the index of the first of them, or -1. */
int64_t penetration_count(const struct simulation *sim, int64_t *first);

#endif
