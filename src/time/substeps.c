/* SPDX-License-Identifier: MIT
 * Steps of the solid within a step of the fluid, and what the fluid uses of the solid afterwards (T-35). */
#include <math.h>

#include "solid/interface.h"
#include "time/filter.h"
#include "time/booking.h"
#include "time/integrators.h"

double place_solid(struct particles *p)
{
    double way2 = 0;
#pragma omp parallel for simd schedule(static) reduction(max : way2)
    for (int64_t i = 0; i < p->n; i++) {
        const double x = p->X[i] + p->ux[i], y = p->Y[i] + p->uy[i];
        way2 = max2(way2, square(x - p->x[i]) + square(y - p->y[i]));
        p->x[i] = x;
        p->y[i] = y;
    }
    return way2;
}

/* T-35: velocity and acceleration of a structure that the fluid uses after sub-steps. */
static void update_interface_state(struct simulation *s, double dt)
{
    struct particles *const p = &s->kind[KIND_SOLID];
    const double lag = fluid_eval_lag(s, dt), per_dt = 1 / dt, newest = dt / (dt + lag);
    /* The mean acceleration is centred half a step plus the lag ago, the mean velocity half a
     * step ago. Midway between then and now, the acceleration is a quarter of a step older than
     * the lag. */
    const double half = 0.5 * dt, since = lag + 0.25 * dt;
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        const double ax = p->ax[i], ay = p->ay[i];
        p->ax[i] = ax + newest * ((p->vx[i] - p->vx0[i]) * per_dt - ax);
        p->ay[i] = ay + newest * ((p->vy[i] - p->vy0[i]) * per_dt - ay);
        p->jx[i] += newest * ((p->ax[i] - ax) * per_dt - p->jx[i]);
        p->jy[i] += newest * ((p->ay[i] - ay) * per_dt - p->jy[i]);
        p->wx[i] = (p->ux[i] - p->x0[i]) * per_dt + half * (p->ax[i] + since * p->jx[i]);
        p->wy[i] = (p->uy[i] - p->y0[i]) * per_dt + half * (p->ay[i] + since * p->jy[i]);
    }
}

void follow_exchange(struct simulation *s, double dt)
{
    const double before = s->state.exchange_time, now = max2(dt, before - dt);
    interface_rescale(&s->kind[KIND_SOLID], before / now);
    s->state.exchange_time = s->solid.exchange_time = now;
}

void advance_solid(struct simulation *s, double dt, int n, bool centred)
{
    struct particles *const p = &s->kind[KIND_SOLID];
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        p->x0[i] = p->ux[i];
        p->y0[i] = p->uy[i];
        p->vx0[i] = p->vx[i];
        p->vy0[i] = p->vy[i];
    }
    solid_advance(&s->solid, p, dt / n, n, centred);
    book_solid(s, dt, n, centred);
    s->substeps = n;
    s->state.solid_substeps += n;
    s->state.solid_evaluations += n;
    s->solid_max_move = sqrt(place_solid(p));
    update_interface_state(s, dt);
}
