/* SPDX-License-Identifier: MIT
 * The surfaces of solids and walls: points, edges and their weights. */
#ifndef SPHFSI_SOLID_CONTACT_SURFACE_H
#define SPHFSI_SOLID_CONTACT_SURFACE_H

#include "solid/types.h"

/* Finds the surfaces, and how much further than half a spacing the outlines of the shapes are
 * from their points (T-61b). */
enum err contact_surface_create(struct contact *contact, struct arena *a,
                                const struct particles *solid, struct diag *d) SPHFSI_CHECKED;

/* The spacing of a solid or wall, m. */
SPHFSI_INLINE double contact_dp(const struct contact *contact, int body)
{
    return body < contact->n_solids ? contact->solid->body[body].dp : contact->scene->top.dp;
}

#endif
