/* SPDX-License-Identifier: MIT
 * Arrays in the precision of the solid's sweeps; reference neighbours as packs and slots. */
#ifndef SPHFSI_SOLID_PACKED_H
#define SPHFSI_SOLID_PACKED_H

#include "solid/solid.h"

/* Element of an array in the precision of the sweeps, such as a packed field or the weights. */
SPHFSI_INLINE void solid_set(const struct solid *solid, void *array, int64_t i, double value)
{
    if (solid->sweeps->size == sizeof(double))
        ((double *)array)[i] = value;
    else
        ((float *)array)[i] = (float)value;
}

SPHFSI_INLINE double solid_get(const struct solid *solid, const void *array, int64_t i)
{
    return solid->sweeps->size == sizeof(double) ? ((const double *)array)[i]
                                                 : (double)((const float *)array)[i];
}

/* Cuts the particles into packs, finds their reference neighbours within 2h in the same body and
 * the weights of the gradient, and sums these (S_GX, S_GY). Bodies, sweeps and packed fields are
 * set. */
enum err solid_stencil_create(struct solid *solid, struct arena *a,
                              const struct particles *particles, struct diag *d) SPHFSI_CHECKED;

#endif
