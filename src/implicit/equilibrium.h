/* SPDX-License-Identifier: MIT
 * Static equilibrium of solids without fluid (T-78a). */
#pragma once

#include "implicit/implicit.h"

struct equilibrium {
    bool found;
    int corrections; /* solutions with the matrix */
    int load_steps;
};

/* Seeks the displacements without velocity at which all forces at t = 0 balance. Not found:
 * the particles are as they were; there is none, it is not stable, surfaces come near each other
 * during the search (contact: of the solid, or NULL), or something acts that the matrix does not
 * have. ERR_GUARD: a body that nothing holds or could hold. */
enum err equilibrium_find(struct equilibrium *found, const struct solid *solid,
                          struct particles *particles, const struct scene *scene,
                          struct contact *contact, struct diag *d) SPHFSI_CHECKED;
