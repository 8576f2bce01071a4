/* SPDX-License-Identifier: MIT
 * Limits beyond which a state is invalid, and warnings before them. */
#pragma once

#include "time/state.h"

/* Steps of the fluid between two checks of the solid's deformation, which need a pass of their own.
 * At 0.1 of the speed of sound neighbours approach by a third meanwhile. */
enum { CHECK_INTERVAL = 16 };

/* Number of fluid particles inside a wall or solid; the index of the first of them, or -1. */
int64_t guards_count_entered(const struct simulation *sim, int64_t *first);

/* Checks for fluid inside walls or solids. Warns once; fails above what may be stray. */
enum err guards_check_entered(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

/* Says that fluid has left the domain: the particles from `first` on, which are in no cell. */
void guards_warn_of_loss(const struct simulation *sim, int64_t first, struct diag *d);
/* After a sorting: of bodies of which no particle is in a cell. */
void guards_warn_of_leaving(struct simulation *sim, struct diag *d);

/* Whether surfaces in contact are pressed harder than the modulus of contact. */
bool guards_contact_hard(const struct simulation *sim);

/* Whether the check after this step reads the solid's gradients, which must then be up to date. */
bool guards_strain_due(const struct simulation *sim);

/* Checks the state after a step. ERR_GUARD with a sentence that names particle, place, time,
 * quantity and likely cause; warns once if a limit is near. */
enum err guards_check(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;
