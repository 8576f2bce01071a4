/* SPDX-License-Identifier: MIT
 * The motion of a structure that the fluid uses. */
#include "coupling/motion.h"

void motion_after_substeps(struct coupling *coupling, double dt)
{
    struct particles *const particles = coupling->particles;
    const double time = reduced_averaging_time(coupling, dt), per_dt = 1 / dt,
                 weight = dt / (dt + time);
    /* The mean acceleration is centred half a step plus that time ago, the mean velocity half a
     * step ago. Midway between then and now, the acceleration is a quarter of a step older. */
    const double half = 0.5 * dt, age = time + 0.25 * dt;
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        const double ax = particles->ax[i], ay = particles->ay[i];
        particles->ax[i] = ax + weight * ((particles->vx[i] - particles->vx0[i]) * per_dt - ax);
        particles->ay[i] = ay + weight * ((particles->vy[i] - particles->vy0[i]) * per_dt - ay);
        particles->jx[i] += weight * ((particles->ax[i] - ax) * per_dt - particles->jx[i]);
        particles->jy[i] += weight * ((particles->ay[i] - ay) * per_dt - particles->jy[i]);
        particles->wx[i] = (particles->ux[i] - particles->x0[i]) * per_dt +
                           half * (particles->ax[i] + age * particles->jx[i]);
        particles->wy[i] = (particles->uy[i] - particles->y0[i]) * per_dt +
                           half * (particles->ay[i] + age * particles->jy[i]);
    }
}

void motion_ahead(struct coupling *coupling, double half, double last)
{
    struct particles *const particles = coupling->particles;
    const double age = reduced_averaging_time(coupling, last) + 0.5 * last + 0.5 * half;
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        const double ax = particles->ax[i] + age * particles->jx[i],
                     ay = particles->ay[i] + age * particles->jy[i];
        particles->x[i] =
            particles->X[i] + particles->ux[i] + half * (particles->wx[i] + 0.5 * half * ax);
        particles->y[i] =
            particles->Y[i] + particles->uy[i] + half * (particles->wy[i] + 0.5 * half * ay);
        particles->wx[i] += half * ax;
        particles->wy[i] += half * ay;
    }
}

void motion_at_single_rate(struct coupling *coupling, double weight)
{
    struct particles *const particles = coupling->particles;
    solid_set_positions(particles);
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        particles->wx[i] = particles->vx[i];
        particles->wy[i] = particles->vy[i];
        particles->ax[i] += weight * (particles->sx[i] - particles->ax[i]);
        particles->ay[i] += weight * (particles->sy[i] - particles->ay[i]);
    }
}
