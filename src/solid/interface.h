/* SPDX-License-Identifier: MIT
 * What the fluid answers to a structure within the structure's sub-steps (T-35a, T-35b). */
#ifndef SPHFSI_SOLID_INTERFACE_H
#define SPHFSI_SOLID_INTERFACE_H

#include "solid/solid.h"

/* For use inside a parallel region: each ends with all threads together. */

/* Before n sub-steps of dt: the structure returns a share of what it was given, and the faces of its
 * particles are found. */
void interface_begin(const struct solid *s, struct particles *p, double dt, int n);

/* After them: the structure owes what it was given meanwhile. */
void interface_end(const struct solid *s, struct particles *p);

/* T-35a for one particle, after the kick of a sub-step; `since`: time since the fluid saw it, s. */
SPHFSI_INLINE void impedance_kick(const struct particles *p, int64_t i, double since)
{
    const double along = p->vx[i] * p->face_x[i] + p->vy[i] * p->face_y[i];
    const double faster = along - p->face_v[i] - since * p->face_a[i];
    p->vx[i] -= faster * p->face_x[i];
    p->vy[i] -= faster * p->face_y[i];
    p->face_dv[i] += faster;
}

#endif
