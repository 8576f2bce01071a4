/* SPDX-License-Identifier: MIT
 * The solid's reference neighbours as packs and slots. */
#ifndef SPHFSI_SOLID_STENCIL_H
#define SPHFSI_SOLID_STENCIL_H

#include "solid.h"

/* A number of an array of the precision of the sweeps, such as a lane or the weights. */
SPHFSI_INLINE void solid_set(const struct solid *s, void *array, int64_t i, double value)
{
    if (s->sweeps->size == sizeof(double))
        ((double *)array)[i] = value;
    else
        ((float *)array)[i] = (float)value;
}

SPHFSI_INLINE double solid_get(const struct solid *s, const void *array, int64_t i)
{
    return s->sweeps->size == sizeof(double) ? ((const double *)array)[i]
                                             : (double)((const float *)array)[i];
}

/* Cuts the particles into packs, finds their reference neighbours within 2h in the same body and the
 * weights of the gradient, and sums these (S_GX, S_GY). s->body, sweeps and lane are set. */
enum err solid_stencil_create(struct solid *s, struct arena *a, const struct particles *p,
                              struct diag *d) SPHFSI_CHECKED;

#endif
