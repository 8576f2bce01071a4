/* SPDX-License-Identifier: MIT
 * A solid cut across into parts, each stepped by a thread in arrays of its own. A part has copies of the
 * particles within reach of its own, too; what becomes of these it is told by messages of a few lines, where
 * threads that share arrays fetch each other's lines in every loop over a thin body. A particle sums over
 * the same neighbours in the same order as in the whole, so the bits are those of the whole. */
#ifndef SPHFSI_SOLID_PARTS_H
#define SPHFSI_SOLID_PARTS_H

#include "solid/types.h"

/* What is handed over. */
enum hand {
    HALO_POSITION = 1, /* displacement and velocity */
    HALO_GRADIENT = 2, /* displacement gradient */
    HALO_STRESS = 4
};

/* Cuts s, which is complete, into s->threads parts, or none where that does not pay. Memory: the arena's. */
enum err solid_parts_create(struct solid *s, struct arena *a, const struct particles *p,
                            struct diag *d) SPHFSI_CHECKED;

/* Takes state and forces from the whole; gives the state of its own back; gives what the last evaluation has
 * found of it: gradients, stresses and accelerations. */
void solid_part_load(struct solid_part *part, const struct particles *whole);
void solid_part_store(const struct solid_part *part, const struct particles *whole);
void solid_part_show(struct solid_part *part, const struct particles *whole);

/* Hands what others need of this part over, some of enum hand, and waits for what it needs of theirs. All
 * parts call this in turn with the same. */
void halo_exchange(struct solid_part *part, unsigned what);

#endif
