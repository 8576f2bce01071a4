/* SPDX-License-Identifier: MIT
 * The order of the exchange in a step of the fluid. The motion of structures that the fluid uses.
 * Bounds of the step, which are needed because each side follows the other a step later. */
#include "coupling/coupling.h"
#include "implicit/implicit.h"

void coupling_set_rate(struct coupling *coupling, effect_set effects, double longest)
{
    const bool impedance = effects & FX_IMPEDANCE;
    coupling->multirate = effects & FX_MULTIRATE;
    coupling->impedance = impedance ? coupling->scene->rho0 * coupling->scene->c0 : 0;
    coupling->solid->apply_kick = impedance ? impedance_kick : solid_plain_kick;
    if (!impedance) *coupling->exchange_time = 0;
    if (impedance && *coupling->exchange_time == 0) *coupling->exchange_time = longest;
}

static void find_forces_on(const struct coupling *coupling, struct particles *particles,
                           enum kind kind, const struct cells *cells, bool all)
{
    const bool mixed = coupling->scene->top.precision == PRECISION_MIXED;
    double *const sums[] = {particles->fx,    particles->fy,     particles->wet_x,
                            particles->wet_y, particles->drag_x, particles->drag_y};
    if (!particles->fx) return;
    for (size_t k = 0; k < COUNT_OF(sums); k++) /* particles without fluid nearby get no force */
        particles_clear(sums[k], particles->n);
    (mixed ? find_force_mixed : find_force_double)(coupling->fluid, particles, kind, cells, all);
}

void coupling_find_forces(const struct coupling *coupling, struct particles kinds[KIND_COUNT],
                          const struct cells *cells)
{
    find_forces_on(coupling, &kinds[KIND_SOLID], KIND_SOLID, cells, false);
    if (coupling->fluid->effects & FX_MOTION)
        find_forces_on(coupling, &kinds[KIND_WALL], KIND_WALL, cells, false);
}

void coupling_find_wall_forces(const struct coupling *coupling, struct particles kinds[KIND_COUNT],
                               const struct cells *cells)
{
    find_forces_on(coupling, &kinds[KIND_WALL], KIND_WALL, cells, true);
}

/* T-36a: the pressure's part of the force that the fluid gets for `rates_time`. */
static void extrapolate_forces(struct coupling *coupling, double dt, double rates_time,
                               bool first_step)
{
    struct particles *const particles = coupling->particles;
    const struct force_weights weights =
        force_weights(rates_time / dt, coupling->lead / dt, coupling->alternates);
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        const double fx = particles->fx[i], fy = particles->fy[i];
        particles->fx[i] = extrapolated_force(&weights, fx, fx - particles->drag_x[i], first_step,
                                              &particles->mean_fx[i]);
        particles->fy[i] = extrapolated_force(&weights, fy, fy - particles->drag_y[i], first_step,
                                              &particles->mean_fy[i]);
    }
}

/* --- the motion that the fluid uses --- */

/* T-35: weight of the last step in the mean. With 1/4 a light plate gains 2 % of its energy. */
#define RECENT 0.2

/* T-35: after sub-steps in a step of dt. */
static void move_after_substeps(struct coupling *coupling, double dt)
{
    struct particles *const particles = coupling->particles;
    const double per_dt = 1 / dt, half = 0.5 * dt,
                 weight = coupling_acceleration_weight(coupling, dt);
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        const double ax = (particles->vx[i] - particles->vx0[i]) * per_dt;
        const double ay = (particles->vy[i] - particles->vy0[i]) * per_dt;
        particles->ax[i] += weight * (ax - particles->ax[i]);
        particles->ay[i] += weight * (ay - particles->ay[i]);
        particles->recent_ax[i] += RECENT * (ax - particles->recent_ax[i]);
        particles->recent_ay[i] += RECENT * (ay - particles->recent_ay[i]);
        particles->wx[i] =
            (particles->ux[i] - particles->ux0[i]) * per_dt + half * particles->recent_ax[i];
        particles->wy[i] =
            (particles->uy[i] - particles->uy0[i]) * per_dt + half * particles->recent_ay[i];
    }
}

/* T-35, with sub-steps: position and velocity `half` ahead. */
static void predict_motion(struct coupling *coupling, double half)
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

void coupling_move_at_single_rate(struct coupling *coupling, double weight)
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

/* --- a step of the fluid --- */

void coupling_predict(struct coupling *coupling, double dt)
{
    if (coupling->impedance > 0)
        impulse_set_time(coupling, dt); /* for the force of the corrector */
    predict_motion(coupling, coupling->rates_at * dt);
}

/* The state at the start gives the mean velocity and acceleration of the step. */
static void keep_start(struct particles *particles)
{
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        particles->ux0[i] = particles->ux[i];
        particles->uy0[i] = particles->uy[i];
        particles->vx0[i] = particles->vx[i];
        particles->vy0[i] = particles->vy[i];
    }
}

double coupling_advance(struct coupling *coupling, double dt, int n, double rates_time,
                        bool first_step)
{
    struct particles *const particles = coupling->particles;
    const bool impedance = coupling->impedance > 0;
    if (impedance) impulse_return(coupling, rates_time);
    if (impedance && coupling->rates_at == 0) impulse_set_time(coupling, dt); /* not predicted */
    const double middle = 0.5 * (coupling->solid->centred ? dt : dt - dt / n);
    coupling->lead = middle - coupling->rates_at * dt;
    if (particles->mean_fx) extrapolate_forces(coupling, dt, rates_time, first_step);
    keep_start(particles);
    if (impedance) impulse_begin(coupling, implicit_is_next(coupling->solid) ? 0 : dt / n);
    implicit_advance(coupling->solid, particles, dt / n, n);
    if (impedance) impulse_end(coupling);
    const double moved = solid_set_positions(particles);
    move_after_substeps(coupling, dt);
    return moved;
}

/* --- bounds of the time step --- */

/* Largest added mass over a particle's own mass, for a body of the fluid's density (T-35d).
 * Measured; results are as good from 1.5 to 2.75 (docs/theory/substeps.md, Sec. 7.4). */
#define ADDED_MASS 2

/* T-35d: density of fluid over that of a body, which has less mass where it is thin. */
static double added_mass(const struct coupling *coupling, const struct solid_body *body)
{
    const double layers = 2 * coupling->scene->top.dp;
    return coupling->scene->rho0 / body->density * max2(1, layers / body->thickness);
}

double coupling_added_mass_step(const struct coupling *coupling, int *lightest)
{
    const struct solid_body *const body = coupling->solid->body;
    *lightest = 0;
    for (int k = 1; k < coupling->solid->n_bodies; k++)
        if (added_mass(coupling, &body[k]) > added_mass(coupling, &body[*lightest])) *lightest = k;
    const double b = 2 / (1 + ADDED_MASS * added_mass(coupling, &body[*lightest]));
    return averaging_time(coupling) * b /
           ((1 + (acceleration_age(coupling) - 1) * b) * extrapolated_halves(coupling));
}

/* T-35g: viscosity stops the particles at the corner of a structure at a rate that is held over a
 * step of the fluid. 8.6 is the kernel's sum there; 0.9 leaves a margin. */
double coupling_drag_step(const struct coupling *coupling)
{
    const struct scene *const scene = coupling->scene;
    const struct fluid_constants *const fluid = &coupling->fluid->k;
    double rate = 0;
    for (int k = 0; k < coupling->solid->n_bodies; k++) {
        if (scene->solid[k].slip != SLIP_NONE) continue;
        const double finer = scene->top.dp / scene_solid_dp(scene, k);
        const double denser = coupling->solid->body[k].density / scene->rho0;
        rate = max2(rate, 8.6 * finer * fluid->model->laminar_viscosity /
                              (denser * fluid->second_moment * square(fluid->h)));
    }
    return rate > 0 ? 0.9 / (2 * (1 + extrapolated_halves(coupling)) * rate) : (double)INFINITY;
}
