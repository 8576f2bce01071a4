/* SPDX-License-Identifier: MIT
 * The energy of the repulsion of walls and structures. */
#ifndef SPHFSI_TIME_REPULSION_H
#define SPHFSI_TIME_REPULSION_H

#include "time/state.h"

/* Energy that walls and structures have stored by repelling each fluid section (L-7b), J/m. */
void repulsion_energy(const struct simulation *sim, double of[SCENE_MAX_SECTIONS]);

#endif
