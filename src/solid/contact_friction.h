/* SPDX-License-Identifier: MIT
 * Coulomb friction (T-62c, T-62d): a tangential spring with a slider between a point of a solid
 * and a place that moves with the surface which it presses. */
#ifndef SPHFSI_SOLID_CONTACT_FRICTION_H
#define SPHFSI_SOLID_CONTACT_FRICTION_H

#include "solid/types.h"

enum err contact_friction_create(struct contact *contact, struct arena *a, struct diag *d)
    SPHFSI_CHECKED;

/* Adds the forces to those of the pairs. */
void contact_friction_forces(struct contact *contact, struct particles *particles);

/* Energy of the springs, J/m. */
double contact_friction_energy(struct contact *contact, const struct particles *particles);

/* The part in the step bound of the pairs from first to before end, of one point. */
void contact_friction_rows(struct contact *contact, const struct particles *particles,
                           int64_t first, int64_t end);

/* Lets the places slide where a spring exceeds friction, after the forces of a step. By one
 * thread. */
void contact_slide(struct contact *contact, struct particles *particles);

#endif
