/* SPDX-License-Identifier: MIT */
#include "time/tension.h"

#include <math.h>

#include "particles/kernel.h"

static void count(void *n, int64_t i, double x, double y, double r)
{
    (void)i, (void)x, (void)y, (void)r;
    ++*(int *)n;
}

int particles_near(const struct simulation *sim, double x, double y)
{
    const double at[] = {x, y}, reach = KERNEL_REACH * sim->fluid.k.h;
    int n = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++)
        if (sim->cells.kind[kind].n_active)
            cells_each_near(&sim->cells, (enum kind)kind, &sim->kind[kind], at, reach, count, &n);
    return n;
}

void limit_isolated_tension(struct simulation *sim)
{
    /* T-45: what a water hammer at the speed that c0 is chosen for changes, and two thirds of
     * the guard's limit. Larger tension is not part of the flow. */
    const double factor = sim->scene->numerics.sound_factor;
    const double lowest = max2(-1 / factor, -2.0 / 3 * sim->guard.dens_limit);
    if (!(sim->extremes.dens_low < lowest)) return;
    struct particles *const particles = &sim->kind[KIND_FLUID];
    /* Particles within reach: a third of the number inside the fluid, fewer than a corner of
     * it has. */
    const double reach = KERNEL_REACH * sim->fluid.k.h / sim->scene->top.dp;
    const int most = (int)(PI / 3 * reach * reach);
    for (int64_t i = 0; i < particles->n; i++) {
        if (!(particles->dens[i] < lowest) ||
            particles_near(sim, particles->x[i], particles->y[i]) > most)
            continue;
        particles->dens[i] = 0;
        if (particles->dens_slow) particles->dens_slow[i] = 0;
        if (particles->dens_old) particles->dens_old[i] = 0;
        if (particles->ddens_old) particles->ddens_old[i] = particles->ddens_older[i] = 0;
        sim->state.tension_limited++;
    }
}
