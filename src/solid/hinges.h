/* SPDX-License-Identifier: MIT
 * Hinges: points of bodies that stay in place, on another body or on a wall (T-81). */
#ifndef SPHFSI_SOLID_HINGES_H
#define SPHFSI_SOLID_HINGES_H

#include "solid/types.h"

/* Finds the particles around each hinge and their weights. solid->body is set; the particles of all
 * clamps have free = 0. */
enum err hinges_create(struct hinges *hinges, struct arena *a, const struct scene *scene,
                       const struct solid *solid, const struct particles *particles, struct diag *d)
    SPHFSI_CHECKED;

/* Removes the part of the initial velocities that hinges do not allow. */
void hinges_start(struct hinges *hinges, struct particles *particles);

/* Adds the accelerations by hinges to sx, sy, which have all others. With dt: those that lead
 * each point to its place after a kick of dt, which fluid resists or not, and a drift as long;
 * without: those by which it stays there. By one thread. */
void hinges_forces(struct hinges *hinges, struct particles *particles, double time, double dt,
                   bool resisted);

/* The same without dt for accelerations `by`; adds the forces, N/m. */
void hinges_hold(struct hinges *hinges, double *const by[2], double *const force[2], double time);

/* Work of hinges on moving walls over a kick of dt with the last forces, J/m, from the velocities
 * before it. Adds each body's part to `on`. */
double hinges_work(const struct hinges *hinges, const double *vx, const double *vy, double dt,
                   double *on);

#endif
