/* SPDX-License-Identifier: MIT
 * The impedance of the fluid in the sub-steps of a structure, and the impulse that it has still to
 * receive (T-35a, T-35b). The pressure at a moving surface changes by rho0 c0 times its velocity
 * immediately; sound spreads it later. As a constant force over the sub-steps this pressure acts a
 * step late. Oscillations with periods between 4/3 and 4 steps then gain energy. */
#include "coupling/coupling.h"
#include "solid/loads.h"

/* T-35f: fluid at a body thinner than two of its spacings receives impulses of both sides. */
static double impedance_of(const struct coupling *coupling, const struct solid_body *body)
{
    return coupling->impedance * min2(1, body->thickness / (2 * coupling->scene->top.dp));
}

/* T-35a: face = sqrt(k/(1 + k)) A/|A| with k = dt Z |A|/m, so that face face^T removes the fraction
 * k/(1 + k) of the normal velocity in a sub-step of dt. The update is implicit, so it adds no step
 * bound. dt = 0, for implicit steps: sqrt(Z |A|/m) A/|A|, the root of the rate. Also the normal
 * velocity of T-35 in the middle of the kicks. Zero for dry and clamped particles. */
static void find_normal(const struct coupling *coupling, struct particles *particles, int64_t i,
                        double dt)
{
    const struct solid_body *const body = &coupling->solid->body[particles->body[i]];
    const double wet =
        sqrt(square(particles->wet_x[i]) + square(particles->wet_y[i])) * particles->free[i];
    const double k = (dt > 0 ? dt : 1) * impedance_of(coupling, body) * wet / body->mass;
    const double root = wet > 0 ? sqrt(dt > 0 ? k / (1 + k) : k) / wet : 0;
    particles->face_x[i] = root * particles->wet_x[i];
    particles->face_y[i] = root * particles->wet_y[i];
    const double wx = particles->wx[i] + coupling->lead * particles->recent_ax[i],
                 wy = particles->wy[i] + coupling->lead * particles->recent_ay[i];
    particles->face_v[i] = wx * particles->face_x[i] + wy * particles->face_y[i];
    particles->face_dv[i] = particles->face_work[i] = 0;
}

void impulse_begin(struct coupling *coupling, double dt)
{
    struct particles *const particles = coupling->particles;
    const struct loads *const loads = coupling->solid->loads;
#pragma omp parallel for schedule(static) num_threads(coupling->solid->threads)
    for (int64_t i = 0; i < particles->n; i++) find_normal(coupling, particles, i, dt);
    for (int64_t k = 0; loads && k < loads->n_held; k++) { /* the motion of their clamps is given */
        particles->face_x[loads->held[k]] = particles->face_y[loads->held[k]] = 0;
        impulse_clear(particles, loads->held[k]); /* a clamp that a fork has added may have one */
    }
}

void impedance_kick(const struct particles *particles, int64_t first, int64_t end, double kick_time,
                    double drift, double next)
{
#pragma omp simd
    for (int64_t i = first; i < end; i++) {
        const double before =
            particles->vx[i] * particles->face_x[i] + particles->vy[i] * particles->face_y[i];
        particles->vx[i] += kick_time * particles->sx[i];
        particles->vy[i] += kick_time * particles->sy[i];
        const double along =
            particles->vx[i] * particles->face_x[i] + particles->vy[i] * particles->face_y[i];
        const double excess = along - particles->face_v[i];
        particles->vx[i] -= excess * particles->face_x[i];
        particles->vy[i] -= excess * particles->face_y[i];
        particles->face_dv[i] += excess;
        const double after =
            particles->vx[i] * particles->face_x[i] + particles->vy[i] * particles->face_y[i];
        particles->face_work[i] -= 0.5 * excess * (before + after);
        particles->ux[i] = particles->ux[i] + drift * particles->vx[i] + next * particles->vx[i];
        particles->uy[i] = particles->uy[i] + drift * particles->vy[i] + next * particles->vy[i];
    }
}

/* Both solutions of Verlet receive equal parts: a fast oscillation would drive them apart. */
static void add_pressure(struct particles *particles, int64_t i, double pressure)
{
    if (!particles->interface_pressure_next) {
        particles->interface_pressure[i] += pressure;
        return;
    }
    particles->interface_pressure[i] += particles->interface_pressure_next[i] + 0.5 * pressure;
    particles->interface_pressure_next[i] = 0.5 * pressure;
}

/* A pressure of 1 Pa on the body's side of the pairs of T-13 is half of the force on the wetted
 * surface. The pressure follows from the new impulse, not from all that the fluid has still to
 * receive: a surface that was larger would make that one too large. */
void impulse_end(struct coupling *coupling)
{
    struct particles *const particles = coupling->particles;
    const struct solid *const solid = coupling->solid;
#pragma omp parallel for schedule(static) num_threads(solid->threads)
    for (int64_t i = 0; i < particles->n; i++) {
        const double impulse = -solid->body[particles->body[i]].mass * particles->face_dv[i];
        const double x = impulse * particles->face_x[i], y = impulse * particles->face_y[i];
        const double wet2 = square(particles->wet_x[i]) + square(particles->wet_y[i]);
        const double half = 0.5 * wet2 * *coupling->exchange_time;
        particles->interface_impulse_x[i] += x;
        particles->interface_impulse_y[i] += y;
        add_pressure(particles, i,
                     half > 0 ? (x * particles->wet_x[i] + y * particles->wet_y[i]) / half : 0);
    }
}

/* The force on the body contains the pressure that gave the fluid a part of the impulse. The
 * body has had that part in its sub-steps: it is taken off the force, and off the impulse. */
void impulse_return(struct coupling *coupling, double rates_time)
{
    struct particles *const particles = coupling->particles;
    const double per_time = 1 / *coupling->exchange_time, left = 1 - rates_time * per_time;
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        const double later =
            particles->interface_pressure_next ? 0.5 * particles->interface_pressure_next[i] : 0;
        const double fx =
            per_time * particles->interface_impulse_x[i] - later * particles->wet_x[i];
        const double fy =
            per_time * particles->interface_impulse_y[i] - later * particles->wet_y[i];
        particles->fx[i] -= fx;
        particles->fy[i] -= fy;
        particles->interface_impulse_x[i] -= rates_time * fx;
        particles->interface_impulse_y[i] -= rates_time * fy;
        particles->interface_pressure[i] *= left;
    }
}

void impulse_set_time(struct coupling *coupling, double dt)
{
    struct particles *const particles = coupling->particles;
    const double before = *coupling->exchange_time, now = exchange_time_after(before, dt),
                 ratio = before / now;
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        particles->interface_pressure[i] *= ratio;
        if (particles->interface_pressure_next) particles->interface_pressure_next[i] *= ratio;
    }
    *coupling->exchange_time = now;
}

void impulse_clear(struct particles *particles, int64_t i)
{
    particles->interface_impulse_x[i] = particles->interface_impulse_y[i] =
        particles->interface_pressure[i] = 0;
    if (particles->interface_pressure_next) particles->interface_pressure_next[i] = 0;
}
