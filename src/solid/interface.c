/* SPDX-License-Identifier: MIT
 * The pressure at a moving surface changes by rho0 c0 times its velocity immediately; sound spreads
 * it later. As a constant force over the sub-steps this pressure acts a step late. Oscillations
 * with periods between 4/3 and 4 steps then gain energy. */
#include "solid/interface.h"

#include <math.h>

/* Fraction of the interface impulse returned per step: slow compared with oscillations of some tens
 * of steps. A tenth excites structures of a fiftieth of the fluid's density; zero makes them too
 * heavy. */
#define RETURN_FRACTION 0.02

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

void interface_begin(const struct solid *s, struct particles *p, double dt, int n)
{
    const double per_time = 1 / (n * dt);
#pragma omp for schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        p->fx[i] -= RETURN_FRACTION * per_time * p->interface_impulse_x[i]; /* T-35b */
        p->fy[i] -= RETURN_FRACTION * per_time * p->interface_impulse_y[i];
        p->interface_impulse_x[i] *= 1 - RETURN_FRACTION;
        p->interface_impulse_y[i] *= 1 - RETURN_FRACTION;
        find_face(s, p, i, dt);
    }
}

void interface_end(const struct solid *s, struct particles *p)
{
#pragma omp for schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        const double impulse = s->body[p->body[i]].mass * p->face_dv[i];
        p->interface_impulse_x[i] -= impulse * p->face_x[i];
        p->interface_impulse_y[i] -= impulse * p->face_y[i];
    }
}
