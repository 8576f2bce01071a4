/* SPDX-License-Identifier: MIT
 * Sorting the particles into cells, and when it is due. */
#ifndef SPHFSI_TIME_SORTING_H
#define SPHFSI_TIME_SORTING_H

#include "time/state.h"

/* Sorts fluid, structure and moving walls into cells; removes fluid outside the domain. */
enum err sort_particles(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

/* Subtracts the largest distance that two particles can have moved in the last step from the
 * skin that is left; `speed2_before`: of the fluid before it. */
void use_skin_left(struct simulation *sim, double speed2_before);

/* Whether the cells may miss a pair at the next evaluations. */
bool sorting_due(struct simulation *sim);

/* Measures the skin that is left. */
void find_skin_left(struct simulation *sim);

/* Clears what the fluid has given to particles of walls or structures. Evaluations skip those
 * without fluid nearby, so this is done before the cells change. */
void clear_fluid_sums(struct particles *particles);

#endif
