/* SPDX-License-Identifier: MIT
 * Coulomb friction (T-62c, T-62d): a tangential spring with a slider between a point of a solid
 * and a place that moves with the surface which it presses. */
#ifndef SPHFSI_SOLID_CONTACT_FRICTION_H
#define SPHFSI_SOLID_CONTACT_FRICTION_H

#include "solid/types.h"

enum err contact_friction_create(struct contact *c, struct arena *a, struct diag *d) SPHFSI_CHECKED;

/* Adds the forces to those of the pairs. */
void contact_friction_forces(struct contact *c, struct particles *p);

/* Energy of the springs, J/m. */
double contact_friction_energy(struct contact *c, const struct particles *p);

/* The part in the step bound of the pairs from first to before end, of one point. */
void contact_friction_rows(struct contact *c, const struct particles *p, int64_t first,
                           int64_t end);

/* Lets the places slide where a spring exceeds friction, after the forces of a step. By one
 * thread. */
void contact_slide(struct contact *c, struct particles *p);

#endif
