/* SPDX-License-Identifier: MIT
 * The solid's reference neighbours as packs and slots. */
#ifndef SPHFSI_SOLID_STENCIL_H
#define SPHFSI_SOLID_STENCIL_H

#include "solid/solid.h"

/* Cuts the particles into packs, finds their reference neighbours within 2h in the same body and
 * the weights of the gradient, and sums these (S_GX, S_GY). s->body, sweeps and lane are set. */
enum err solid_stencil_create(struct solid *solid, struct arena *a,
                              const struct particles *particles, struct diag *d) SPHFSI_CHECKED;

#endif
