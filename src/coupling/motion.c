/* SPDX-License-Identifier: MIT
 * The motion of a structure that the fluid uses. */
#include "coupling/coupling.h"

/* T-35: weight of the last step in the mean that extrapolates the velocity. With 1/4 and more the
 * motion of some light bodies grows by itself. */
#define RECENT 0.2

void motion_after_substeps(struct coupling *coupling, double dt)
{
    struct particles *const particles = coupling->particles;
    const double per_dt = 1 / dt, half = 0.5 * dt,
                 weight = dt / (dt + reduced_averaging_time(coupling, dt));
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        const double ax = (particles->vx[i] - particles->vx0[i]) * per_dt;
        const double ay = (particles->vy[i] - particles->vy0[i]) * per_dt;
        particles->ax[i] += weight * (ax - particles->ax[i]);
        particles->ay[i] += weight * (ay - particles->ay[i]);
        particles->recent_ax[i] += RECENT * (ax - particles->recent_ax[i]);
        particles->recent_ay[i] += RECENT * (ay - particles->recent_ay[i]);
        particles->wx[i] =
            (particles->ux[i] - particles->x0[i]) * per_dt + half * particles->recent_ax[i];
        particles->wy[i] =
            (particles->uy[i] - particles->y0[i]) * per_dt + half * particles->recent_ay[i];
    }
}

void motion_ahead(struct coupling *coupling, double half)
{
    struct particles *const particles = coupling->particles;
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        const double ax = half * particles->recent_ax[i], ay = half * particles->recent_ay[i];
        particles->x[i] = particles->X[i] + particles->ux[i] + half * (particles->wx[i] + 0.5 * ax);
        particles->y[i] = particles->Y[i] + particles->uy[i] + half * (particles->wy[i] + 0.5 * ay);
        particles->wx[i] += ax;
        particles->wy[i] += ay;
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
