/* SPDX-License-Identifier: MIT
 * What pushes a solid from outside by prescription: loads on a part of a body, and clamps that move. */
#ifndef SPHFSI_SOLID_LOADS_H
#define SPHFSI_SOLID_LOADS_H

#include "solid/types.h"

/* Finds the particles that loads and moving clamps act on. */
enum err loads_create(struct loads *v, struct arena *a, const struct scene *scene,
                      struct particles *p, struct diag *d) SPHFSI_CHECKED;

/* Puts the particles of moving clamps where they are at a time, with their velocity. By one thread. */
void loads_place_clamps(struct loads *v, struct particles *p, double time);

/* Takes their faces (solid/interface.h) from the particles of moving clamps: they answer to the clamp,
 * not to the fluid. By one thread. */
void clear_driven_normals(const struct loads *v, struct particles *p);

/* Adds the loads to sx, sy; gives the particles of moving clamps the acceleration of their motion. By
 * one thread, after all other forces. */
void loads_forces(struct loads *v, const struct solid *s, struct particles *p, double time);

/* Work of loads and moving clamps over a kick of dt with the last forces, J/m, from the velocities before
 * it: the change of kinetic energy that they have caused, exactly. `on` is added what each body has got. */
double loads_work(const struct loads *v, const struct particles *p, const double *vx,
                  const double *vy, double dt, double *on);

#endif
