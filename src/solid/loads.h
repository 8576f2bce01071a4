/* SPDX-License-Identifier: MIT
 * Prescribed action on a solid from outside: loads on a part of a body, and clamps that move. */
#ifndef SPHFSI_SOLID_LOADS_H
#define SPHFSI_SOLID_LOADS_H

#include "solid/types.h"

/* Finds the particles with loads and moving clamps. */
enum err loads_create(struct loads *v, struct arena *a, const struct scene *scene,
                      struct particles *particles, struct diag *d) SPHFSI_CHECKED;

/* Sets position and velocity of the particles of moving clamps at a time. By one thread. */
void loads_place_clamps(struct loads *v, struct particles *particles, double time);

/* Adds the loads to sx, sy; sets the acceleration of the particles of moving clamps to that of
 * their motion. By one thread, after all other forces. */
void loads_forces(struct loads *v, const struct solid *solid, struct particles *particles,
                  double time);

/* Work of loads and moving clamps over a kick of dt with the last forces, J/m, from the
 * velocities before it: exactly the change of kinetic energy that they cause. Adds each body's
 * part to `on`. */
double loads_work(const struct loads *v, const struct particles *particles, const double *vx,
                  const double *vy, double dt, double *on);

#endif
