/* SPDX-License-Identifier: MIT
 * Arrays in the precision of the solid's sweeps. */
#ifndef SPHFSI_SOLID_PACKED_H
#define SPHFSI_SOLID_PACKED_H

#include "solid/solid.h"

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

/* The lanes that the scene calls for, for the particles p. In double precision the sweeps work on the fields
 * themselves, where there are such. s->body, sweeps and variational are set. */
enum err solid_packed_create(struct solid *s, struct arena *a, const struct particles *p,
                             struct diag *d) SPHFSI_CHECKED;

#endif
