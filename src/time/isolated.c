/* SPDX-License-Identifier: MIT */
#include "time/isolated.h"

#include <math.h>

#include "particles/kernel.h"

/* Below this rho/rho0 - 1, ten times what c0 is chosen for, tension is not of the flow. */
#define TORN (-0.1)

/* Particles within reach that are a third of those within the fluid: less than a corner of it has. */
static int most_of_drop(const struct simulation *s)
{
    const double reach = KERNEL_REACH * s->fluid.k.h / s->scene->top.dp;
    return (int)(PI / 3 * reach * reach);
}

void limit_isolated_tension(struct simulation *s)
{
    if (!(s->extremes.dens_low < TORN)) return;
    struct particles *const p = &s->kind[KIND_FLUID];
    const int most = most_of_drop(s);
#pragma omp parallel for schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        if (!(p->dens[i] < TORN) || simulation_near(s, p->x[i], p->y[i]) > most) continue;
        p->dens[i] = 0;
        if (p->dens_old) p->dens_old[i] = 0;
    }
}
