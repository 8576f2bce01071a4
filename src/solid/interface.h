/* SPDX-License-Identifier: MIT
 * The impedance of the fluid at a structure within the structure's sub-steps (T-35a, T-35b). */
#ifndef SPHFSI_SOLID_INTERFACE_H
#define SPHFSI_SOLID_INTERFACE_H

#include "solid/solid.h"

/* T-35b, after an evaluation of the fluid whose force acts for `kick`, s: takes the part of the
 * interface impulse that this evaluation gives to the fluid off the force on the body. The rest
 * waits. */
void interface_settle(const struct solid *s, struct particles *p, double kick);

/* The pressure that gives the fluid what waits, times `share`: the time of the exchange has changed by the
 * inverse. */
void interface_rescale(struct particles *p, double share);

/* Nothing waits for the fluid at particle i any more. */
void interface_forget(struct particles *p, int64_t i);

/* For use inside a parallel region: each ends with all threads together. */

/* Before sub-steps of dt: finds the wetted normals. */
void interface_begin(const struct solid *s, struct particles *p, double dt);

/* After them: adds the impulse that they have exchanged to the interface impulse, and to the
 * pressure that gives it to the fluid. */
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
