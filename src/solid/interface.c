/* SPDX-License-Identifier: MIT
 * The pressure at a moving surface changes by rho0 c0 times its velocity immediately; sound spreads
 * it later. As a constant force over the sub-steps this pressure acts a step late. Oscillations
 * with periods between 4/3 and 4 steps then gain energy. */
#include "solid/interface.h"

#include <math.h>

/* T-35a: the direction of the wetted surface times the root of the fraction of the normal velocity
 * removed in a sub-step of dt; the update is implicit, so it adds no step bound. Also the normal
 * velocity that the fluid uses. Zero for dry and clamped particles. */
static void find_face(const struct solid *s, struct particles *p, int64_t i, double dt)
{
    const struct solid_body *const body = &s->body[p->body[i]];
    const double wet = sqrt(square(p->wet_x[i]) + square(p->wet_y[i])) * p->free[i];
    const double k = dt * s->impedance * wet / body->mass;
    const double root = wet > 0 ? sqrt(k / (1 + k)) / wet : 0;
    p->face_x[i] = root * p->wet_x[i];
    p->face_y[i] = root * p->wet_y[i];
    p->face_v[i] = p->wx[i] * p->face_x[i] + p->wy[i] * p->face_y[i];
    p->face_dv[i] = p->face_work[i] = 0;
}

void interface_settle(const struct solid *s, struct particles *p, double kick)
{
    const double per_time = 1 / s->exchange_time, waits = 1 - kick * per_time;
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        const double later = p->interface_later ? 0.5 * p->interface_later[i] : 0;
        const double fx = per_time * p->interface_impulse_x[i] - later * p->wet_x[i];
        const double fy = per_time * p->interface_impulse_y[i] - later * p->wet_y[i];
        p->fx[i] -= fx;
        p->fy[i] -= fy;
        p->interface_impulse_x[i] -= kick * fx;
        p->interface_impulse_y[i] -= kick * fy;
        p->interface_pressure[i] *= waits;
    }
}

void interface_rescale(struct particles *p, double share)
{
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        p->interface_pressure[i] *= share;
        if (p->interface_later) p->interface_later[i] *= share;
    }
}

void interface_forget(struct particles *p, int64_t i)
{
    p->interface_impulse_x[i] = p->interface_impulse_y[i] = p->interface_pressure[i] = 0;
    if (p->interface_later) p->interface_later[i] = 0;
}

void interface_begin(const struct solid *s, struct particles *p, double dt)
{
#pragma omp for schedule(static)
    for (int64_t i = 0; i < p->n; i++) find_face(s, p, i, dt);
}

/* Verlet's two solutions receive the pressure in equal parts: the impulses of a fast oscillation
 * would drive them apart. */
static void press(struct particles *p, int64_t i, double pressure)
{
    if (!p->interface_later) {
        p->interface_pressure[i] += pressure;
        return;
    }
    p->interface_pressure[i] += p->interface_later[i] + 0.5 * pressure;
    p->interface_later[i] = 0.5 * pressure;
}

/* A pressure of 1 Pa on the body's side of the pairs of T-13 is half of the force on the wetted
 * surface. The pressure is found from the new impulse, not from all that waits: a surface that was
 * larger would make that one too large. */
void interface_end(const struct solid *s, struct particles *p)
{
#pragma omp for schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        const double impulse = -s->body[p->body[i]].mass * p->face_dv[i];
        const double x = impulse * p->face_x[i], y = impulse * p->face_y[i];
        const double wet2 = square(p->wet_x[i]) + square(p->wet_y[i]);
        const double half = 0.5 * wet2 * s->exchange_time;
        p->interface_impulse_x[i] += x;
        p->interface_impulse_y[i] += y;
        press(p, i, half > 0 ? (x * p->wet_x[i] + y * p->wet_y[i]) / half : 0);
    }
}
