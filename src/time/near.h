/* SPDX-License-Identifier: MIT
 * The particles near a point. */
#ifndef SPHFSI_TIME_NEAR_H
#define SPHFSI_TIME_NEAR_H

#include "time/state.h"

/* Called for particle i of a kind at distance r from the point, within reach. */
typedef void visitor(const struct simulation *sim, enum kind kind, int64_t i, double r, void *sums);

/* Visits the particles of a kind that are nearer to (x, y) than `distance`. */
void each_within(const struct simulation *sim, enum kind kind, double x, double y, double distance,
                 visitor *visit, void *sums);

/* Particles of all kinds within the kernel's reach of a point. */
int particles_near(const struct simulation *sim, double x, double y);

/* Energy that walls and structures have stored by repelling each fluid section (L-7b), J/m. */
void repulsion_energy(const struct simulation *sim, double of[SCENE_MAX_SECTIONS]);

#endif
