/* SPDX-License-Identifier: MIT */
#include "time/tension.h"

#include <math.h>

#include "particles/kernel.h"
#include "time/booking.h"
#include "time/near.h"

void limit_isolated_tension(struct simulation *s)
{
    /* T-45: what a water hammer at the speed that c0 is chosen for changes, and two thirds of the guard's
     * limit. Larger tension is not part of the flow. */
    const double factor = s->scene->numerics.sound_factor;
    const double lowest = max2(-1 / factor, -2.0 / 3 * s->guard.dens_limit);
    if (!(s->extremes.dens_low < lowest)) return;
    struct particles *const p = &s->kind[KIND_FLUID];
    /* Particles within reach: a third of the number inside the fluid, fewer than a corner of it has. */
    const double reach = KERNEL_REACH * s->fluid.k.h / s->scene->top.dp;
    const int most = (int)(PI / 3 * reach * reach);
    for (int64_t i = 0; i < p->n; i++) {
        if (!(p->dens[i] < lowest) || particles_near(s, p->x[i], p->y[i]) > most) continue;
        book_reset(s, i);
        p->dens[i] = 0;
        if (p->dens_slow) p->dens_slow[i] = 0;
        if (p->dens_old) p->dens_old[i] = 0;
        if (p->ddens_old) p->ddens_old[i] = p->ddens_older[i] = 0;
        s->state.tension_limited++;
    }
}
