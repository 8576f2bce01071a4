/* SPDX-License-Identifier: MIT
 * The damping of velocities in zones, and the energy that it takes (T-101). */
#include "fluid/damping.h"

enum { BLOCK = 1024 }; /* particles whose power is one sum */

enum err damping_create(struct damping_zones *damping, struct arena *a, const struct scene *scene,
                        int64_t particles, struct diag *d)
{
    damping->n = scene->n_damping;
    TRY(arena_array(a, &damping->taken, damping->n, "damping", d));
    TRY(arena_array(a, &damping->power, damping->n, "damping", d));
    TRY(arena_array(a, &damping->block, particles / BLOCK + 1, "damping", d));
    return ERR_OK;
}

/* T-101: the rate at a place, 1/s. */
static double rate_at(const struct scene_damping *zone, double x, double y)
{
    const double ex = zone->to[0] - zone->from[0], ey = zone->to[1] - zone->from[1];
    const double part = ((x - zone->from[0]) * ex + (y - zone->from[1]) * ey) / (ex * ex + ey * ey);
    double rate = part > 0 ? zone->rate : 0;
    for (int n = 0; n < zone->power; n++) rate *= min2(part, 1);
    return rate;
}

void damping_add(struct damping_zones *damping, const struct scene *scene,
                 const struct fluid_constants *k, struct particles *particles)
{
    for (int z = 0; z < damping->n; z++) {
        const struct scene_damping *const zone = &scene->damping[z];
        const int64_t blocks = (particles->n + BLOCK - 1) / BLOCK;
#pragma omp parallel for schedule(static)
        for (int64_t b = 0; b < blocks; b++) {
            double power = 0;
            for (int64_t i = b * BLOCK; i < particles->n && i < (b + 1) * BLOCK; i++) {
                const double rate = rate_at(zone, particles->x[i], particles->y[i]);
                const double u = particles->vx[i], v = particles->vy[i];
                particles->ax[i] -= rate * u;
                particles->ay[i] -= rate * v;
                power += particle_mass(k, particles, i) * rate * (u * u + v * v);
            }
            damping->block[b] = power;
        }
        damping->power[z] = 0;
        for (int64_t b = 0; b < blocks; b++) damping->power[z] += damping->block[b];
    }
}

void damping_book(struct damping_zones *damping, double dt)
{
    for (int z = 0; z < damping->n; z++) damping->taken[z] += dt * damping->power[z];
}

double damping_energy(const struct damping_zones *damping)
{
    double sum = 0;
    for (int z = 0; z < damping->n; z++) sum += damping->taken[z];
    return sum;
}
