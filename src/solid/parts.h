/* SPDX-License-Identifier: MIT
 * A solid cut into parts. Each is stepped by one thread in arrays of its own, with copies of the
 * particles within reach. Short messages update the copies. Threads on common arrays would fetch
 * each other's cache lines in every loop over a thin body. A particle sums over the same neighbours
 * in the same order as in the whole: the same bits. */
#ifndef SPHFSI_SOLID_PARTS_H
#define SPHFSI_SOLID_PARTS_H

#include "solid/types.h"

/* The fields of a halo exchange. */
enum halo_fields {
    HALO_POSITION = 1, /* displacement and velocity */
    HALO_GRADIENT = 2, /* displacement gradient */
    HALO_STRESS = 4
};

/* Cuts s, which is complete, into s->threads parts; or none if that gives no speed-up. Memory: the
 * arena's. */
enum err solid_parts_create(struct solid *s, struct arena *a, const struct particles *p,
                            struct diag *d) SPHFSI_CHECKED;

/* Copy state and forces from the whole; the state of its own particles back; and the results of
 * their last evaluation: gradients, stresses and accelerations. */
void solid_part_load(struct solid_part *part, const struct particles *whole);
void solid_part_store(const struct solid_part *part, const struct particles *whole);
void solid_part_results(struct solid_part *part, const struct particles *whole);

/* Sends the halo fields that others need from this part, and waits for those that it needs. All
 * parts make the same calls in the same order. */
void halo_exchange(struct solid_part *part, unsigned what);

#endif
