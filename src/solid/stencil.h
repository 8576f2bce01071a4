/* SPDX-License-Identifier: MIT
 * The solid's reference neighbours as packs and slots. */
#ifndef SPHFSI_SOLID_STENCIL_H
#define SPHFSI_SOLID_STENCIL_H

#include "solid/solid.h"

/* Cuts the particles into packs, finds their reference neighbours within 2h in the same body and the
 * weights of the gradient, and sums these (S_GX, S_GY). s->body, sweeps and lane are set. */
enum err solid_stencil_create(struct solid *s, struct arena *a, const struct particles *p,
                              struct diag *d) SPHFSI_CHECKED;

/* The same for the particles p of a part of a whole, from the slots of the whole. `global` has the
 * index of each in the whole [p->n], ascending; `local` the index here of each of the whole, -1 if
 * it is not here. Neighbours that are not here have no slot. */
enum err solid_stencil_of_part(struct solid *part, struct arena *a, const struct particles *p,
                               const struct solid *whole, const int32_t *global,
                               const int32_t *local, struct diag *d) SPHFSI_CHECKED;

#endif
