/* SPDX-License-Identifier: MIT
 * The pressure at a moving surface changes by rho0 c0 times its velocity immediately; sound spreads
 * it later. As a constant force over the sub-steps this pressure acts a step late. Oscillations
 * with periods between 4/3 and 4 steps then gain energy. */
#include "coupling/impulse.h"

#include <math.h>

/* T-35a: the direction of the wetted surface times the root of the fraction of the normal velocity
 * removed in a sub-step of dt; the update is implicit, so it adds no step bound. Also the normal
 * velocity that the fluid uses. Zero for dry and clamped particles. */
static void find_normal(const struct coupling *coupling, struct particles *p, int64_t i, double dt)
{
    const struct solid_body *const body = &coupling->solid->body[p->body[i]];
    const double wet = sqrt(square(p->wet_x[i]) + square(p->wet_y[i])) * p->free[i];
    const double k = dt * coupling->impedance * wet / body->mass;
    const double root = wet > 0 ? sqrt(k / (1 + k)) / wet : 0;
    p->face_x[i] = root * p->wet_x[i];
    p->face_y[i] = root * p->wet_y[i];
    p->face_v[i] = p->wx[i] * p->face_x[i] + p->wy[i] * p->face_y[i];
    p->face_dv[i] = p->face_work[i] = 0;
}

void impulse_begin(struct coupling *coupling, double dt)
{
    struct particles *const p = coupling->particles;
    const struct loads *const loads = coupling->solid->loads;
#pragma omp parallel for schedule(static) num_threads(coupling->solid->threads)
    for (int64_t i = 0; i < p->n; i++) find_normal(coupling, p, i, dt);
    for (int64_t k = 0; loads && k < loads->n_held; k++) { /* the motion of their clamps is given */
        p->face_x[loads->held[k]] = p->face_y[loads->held[k]] = 0;
        impulse_clear(p, loads->held[k]); /* a clamp that a fork has added may have one */
    }
}

void impedance_kick(const struct particles *p, int64_t first, int64_t end, double kick,
                    double drift)
{
#pragma omp simd
    for (int64_t i = first; i < end; i++) {
        const double before = p->vx[i] * p->face_x[i] + p->vy[i] * p->face_y[i];
        p->vx[i] += kick * p->sx[i];
        p->vy[i] += kick * p->sy[i];
        const double along = p->vx[i] * p->face_x[i] + p->vy[i] * p->face_y[i];
        const double faster = along - p->face_v[i];
        p->vx[i] -= faster * p->face_x[i];
        p->vy[i] -= faster * p->face_y[i];
        p->face_dv[i] += faster;
        const double after = p->vx[i] * p->face_x[i] + p->vy[i] * p->face_y[i];
        p->face_work[i] -= 0.5 * faster * (before + after);
        p->ux[i] += drift * p->vx[i];
        p->uy[i] += drift * p->vy[i];
    }
}

/* Verlet's two solutions receive the pressure in equal parts: the impulses of a fast oscillation
 * would drive them apart. */
static void add_pressure(struct particles *p, int64_t i, double pressure)
{
    if (!p->interface_pressure_next) {
        p->interface_pressure[i] += pressure;
        return;
    }
    p->interface_pressure[i] += p->interface_pressure_next[i] + 0.5 * pressure;
    p->interface_pressure_next[i] = 0.5 * pressure;
}

/* A pressure of 1 Pa on the body's side of the pairs of T-13 is half of the force on the wetted
 * surface. The pressure follows from the new impulse, not from all that the fluid has still to
 * receive: a surface that was larger would make that one too large. */
void impulse_end(struct coupling *coupling)
{
    struct particles *const p = coupling->particles;
    const struct solid *const solid = coupling->solid;
#pragma omp parallel for schedule(static) num_threads(solid->threads)
    for (int64_t i = 0; i < p->n; i++) {
        const double impulse = -solid->body[p->body[i]].mass * p->face_dv[i];
        const double x = impulse * p->face_x[i], y = impulse * p->face_y[i];
        const double wet2 = square(p->wet_x[i]) + square(p->wet_y[i]);
        const double half = 0.5 * wet2 * *coupling->exchange_time;
        p->interface_impulse_x[i] += x;
        p->interface_impulse_y[i] += y;
        add_pressure(p, i, half > 0 ? (x * p->wet_x[i] + y * p->wet_y[i]) / half : 0);
    }
}

/* The force on the body contains the pressure that gave the fluid a part of the impulse. The
 * body has had that part in its sub-steps: it is taken off the force, and off the impulse. */
void impulse_return(struct coupling *coupling, double kick)
{
    struct particles *const p = coupling->particles;
    const double per_time = 1 / *coupling->exchange_time, left = 1 - kick * per_time;
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        const double later = p->interface_pressure_next ? 0.5 * p->interface_pressure_next[i] : 0;
        const double fx = per_time * p->interface_impulse_x[i] - later * p->wet_x[i];
        const double fy = per_time * p->interface_impulse_y[i] - later * p->wet_y[i];
        p->fx[i] -= fx;
        p->fy[i] -= fy;
        p->interface_impulse_x[i] -= kick * fx;
        p->interface_impulse_y[i] -= kick * fy;
        p->interface_pressure[i] *= left;
    }
}

void impulse_set_time(struct coupling *coupling, double dt)
{
    struct particles *const p = coupling->particles;
    const double before = *coupling->exchange_time, now = max2(dt, before - dt),
                 ratio = before / now;
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        p->interface_pressure[i] *= ratio;
        if (p->interface_pressure_next) p->interface_pressure_next[i] *= ratio;
    }
    *coupling->exchange_time = now;
}

void impulse_clear(struct particles *p, int64_t i)
{
    p->interface_impulse_x[i] = p->interface_impulse_y[i] = p->interface_pressure[i] = 0;
    if (p->interface_pressure_next) p->interface_pressure_next[i] = 0;
}
