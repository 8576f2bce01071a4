/* SPDX-License-Identifier: MIT
 * A fluid that is struck answers at once with the pressure rho0 c0 times the velocity, and sound spreads
 * it later. Held over the structure's sub-steps, that answer comes a step late, and modes that swing
 * by a quarter to three quarters of a period meanwhile take energy from it. */
#include "interface.h"

#include <math.h>

void interface_answer(const struct solid *s, struct particles *p, double dt)
{
#pragma omp for schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        const double wet = sqrt(square(p->wet_x[i]) + square(p->wet_y[i]));
        if (!(wet * p->free[i] > 0)) continue;
        const double nx = p->wet_x[i] / wet, ny = p->wet_y[i] / wet;
        const double mass = s->body[p->body[i]].mass;
        /* T-35a, taken implicitly: no bound of the step follows from it. */
        const double k = dt * s->impedance * wet / mass;
        const double faster = (p->vx[i] - p->wx[i]) * nx + (p->vy[i] - p->wy[i]) * ny;
        const double kick = -k / (1 + k) * faster;
        p->vx[i] += kick * nx;
        p->vy[i] += kick * ny;
        p->owed_x[i] += mass * kick * nx;
        p->owed_y[i] += mass * kick * ny;
    }
}

/* Of what is owed, in a step: as slow as to leave modes that swing within some tens of steps alone. A tenth
 * drives structures of a fiftieth of the fluid's density again; none leaves them rho0 c0 dt too heavy. */
#define SHARE 0.02

void interface_return(struct particles *p, double dt)
{
#pragma omp for schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        p->fx[i] -= SHARE / dt * p->owed_x[i];
        p->fy[i] -= SHARE / dt * p->owed_y[i];
        p->owed_x[i] *= 1 - SHARE;
        p->owed_y[i] *= 1 - SHARE;
    }
}
