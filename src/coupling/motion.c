/* SPDX-License-Identifier: MIT
 * The motion of a structure that the fluid uses. */
#include "coupling/motion.h"

void motion_after_substeps(struct coupling *coupling, double dt)
{
    struct particles *const p = coupling->particles;
    const double time = reduced_averaging_time(coupling, dt), per_dt = 1 / dt,
                 weight = dt / (dt + time);
    /* The mean acceleration is centred half a step plus that time ago, the mean velocity half a
     * step ago. Midway between then and now, the acceleration is a quarter of a step older. */
    const double half = 0.5 * dt, age = time + 0.25 * dt;
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        const double ax = p->ax[i], ay = p->ay[i];
        p->ax[i] = ax + weight * ((p->vx[i] - p->vx0[i]) * per_dt - ax);
        p->ay[i] = ay + weight * ((p->vy[i] - p->vy0[i]) * per_dt - ay);
        p->jx[i] += weight * ((p->ax[i] - ax) * per_dt - p->jx[i]);
        p->jy[i] += weight * ((p->ay[i] - ay) * per_dt - p->jy[i]);
        p->wx[i] = (p->ux[i] - p->x0[i]) * per_dt + half * (p->ax[i] + age * p->jx[i]);
        p->wy[i] = (p->uy[i] - p->y0[i]) * per_dt + half * (p->ay[i] + age * p->jy[i]);
    }
}

void motion_ahead(struct coupling *coupling, double half, double last)
{
    struct particles *const p = coupling->particles;
    const double age = reduced_averaging_time(coupling, last) + 0.5 * last + 0.5 * half;
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        const double ax = p->ax[i] + age * p->jx[i], ay = p->ay[i] + age * p->jy[i];
        p->x[i] = p->X[i] + p->ux[i] + half * (p->wx[i] + 0.5 * half * ax);
        p->y[i] = p->Y[i] + p->uy[i] + half * (p->wy[i] + 0.5 * half * ay);
        p->wx[i] += half * ax;
        p->wy[i] += half * ay;
    }
}

void motion_at_single_rate(struct coupling *coupling, double weight)
{
    struct particles *const p = coupling->particles;
    solid_set_positions(p);
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        p->wx[i] = p->vx[i];
        p->wy[i] = p->vy[i];
        p->ax[i] += weight * (p->sx[i] - p->ax[i]);
        p->ay[i] += weight * (p->sy[i] - p->ay[i]);
    }
}
