/* SPDX-License-Identifier: MIT
 * Guards: limits beyond which a state is not sound. */
#ifndef SPHFSI_TIME_GUARDS_H
#define SPHFSI_TIME_GUARDS_H

#include "time/simulation.h"

/* The solid's deformation is looked at every so many steps of the fluid: it takes a pass of its own. At a
 * tenth of the speed of sound neighbours close in by a third of their distance in that time. */
enum { LOOK_INTERVAL = 16 };

/* Looks at the account of energy at a row of the ledger: warns once where a region has gained energy, and
 * fails where that is nine tenths of what is in play in it. */
enum err guards_energy(struct simulation *s, const struct ledger *row, struct diag *d)
    SPHFSI_CHECKED;

/* Now and then: fluid that has entered a wall or a solid. Warns once, and fails where it is more than
 * stray particles. */
enum err guards_penetration(struct simulation *s, struct diag *d) SPHFSI_CHECKED;

/* Number of fluid particles that stand inside of a wall or solid, and the first of them or -1. */
int64_t monitor_crossed(const struct simulation *s, int64_t *first);

/* Whether the check after this step takes the solid's gradients, which have to be shown for it. */
bool guards_strain_due(const struct simulation *s);

/* Checks the state after a step. ERR_GUARD with a sentence that names particle, place, time, quantity
 * and likely cause; warns once where trouble is near. */
enum err guards_check(struct simulation *s, struct diag *d) SPHFSI_CHECKED;

#endif
