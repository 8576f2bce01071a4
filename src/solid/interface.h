/* SPDX-License-Identifier: MIT
 * The impedance of the fluid at a structure within the structure's sub-steps (T-35a, T-35b). */
#ifndef SPHFSI_SOLID_INTERFACE_H
#define SPHFSI_SOLID_INTERFACE_H

#include "solid/solid.h"

/* For use inside a parallel region: each ends with all threads together. */

/* Before n sub-steps of dt: returns a fraction of the interface impulse and finds the wetted
 * normals. */
void interface_begin(const struct solid *s, struct particles *p, double dt, int n);

/* After them: adds the impulse that they have exchanged to the interface impulse. */
void interface_end(const struct solid *s, struct particles *p);

/* T-35a for one particle, after the kick of a sub-step; `before`: v . face before the kick. */
SPHFSI_INLINE void impedance_kick(const struct particles *p, int64_t i, double before)
{
    const double along = p->vx[i] * p->face_x[i] + p->vy[i] * p->face_y[i];
    const double faster = along - p->face_v[i];
    p->vx[i] -= faster * p->face_x[i];
    p->vy[i] -= faster * p->face_y[i];
    p->face_dv[i] += faster;
    const double after = p->vx[i] * p->face_x[i] + p->vy[i] * p->face_y[i];
    p->face_work[i] -= 0.5 * faster * (before + after);
}

#endif
