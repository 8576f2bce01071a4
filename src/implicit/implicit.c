/* SPDX-License-Identifier: MIT
 * Implicit steps of the solid (T-90 to T-93): the midpoint rule with the mean stress over the
 * step, solved by Newton's method with a factored matrix that is kept while it serves. */
#include "implicit/implicit.h"

#include <float.h>

#include "implicit/stress.h"
#include "solid/loads.h"

/* A matrix is replaced when a correction with it reduces the residual less than by this factor, or
 * when dt^2 differs from its own by this fraction. It decides on the cost, not on the solution. */
#define SLOW 0.5

/* Largest residual over the largest force of a particle. Floats of a force have errors of 6e-8. */
#define TOLERANCE 1e-7

/* Limits of the effort before the step is halved, and before the run stops. */
enum { ITERATIONS = 40, HALVINGS = 6 };

/* --- stress --- */

static struct vtensor2 between(struct vtensor2 a, struct vtensor2 b, double share)
{
    return (struct vtensor2){a.xx + (b.xx - a.xx) * share, a.xy + (b.xy - a.xy) * share,
                             a.yx + (b.yx - a.yx) * share, a.yy + (b.yy - a.yy) * share};
}

/* T-91: the mean of S over the straight path between two strains, by Gauss' two points. */
static struct vtensor2 mean_stress(const struct solid_body *b, struct vtensor2 from,
                                   struct vtensor2 to)
{
    const double point = 0.21132486540518713; /* (1 - 1/sqrt(3))/2 */
    return between(stress_of_strain(b, between(from, to, point)),
                   stress_of_strain(b, between(from, to, 1 - point)), 0.5);
}

/* A sweep in the middle of a step: in place of P, the mean gradient times the mean stress. */
static void take_mean_stress(const struct solid *solid, struct particles *particles, int64_t first,
                             int64_t last)
{
    double *const middle[] = {particles->Uxx, particles->Uxy, particles->Uyx, particles->Uyy},
                  *const P[] = {particles->Pxx, particles->Pxy, particles->Pyx, particles->Pyy};
    for (int64_t k = first; k < last; k++) {
        const struct solid_pack *const pack = &solid->pack[k];
        const struct solid_body *const body = &solid->body[pack->body];
        const struct vtensor2 U = load_tensor(middle, pack->i),
                              from = load_tensor(solid->implicit->start, pack->i),
                              to = between(from, U, 2);
        const struct vtensor2 mean =
            vtensor2_mul(deformation(U),
                         mean_stress(body, green_lagrange(from), green_lagrange(to)));
        const struct vtensor2 had = material_pk1(body, U), now = load_tensor(P, pack->i);
        vput(P[0] + pack->i, now.xx + (mean.xx - had.xx), pack->lanes);
        vput(P[1] + pack->i, now.xy + (mean.xy - had.xy), pack->lanes);
        vput(P[2] + pack->i, now.yx + (mean.yx - had.yx), pack->lanes);
        vput(P[3] + pack->i, now.yy + (mean.yy - had.yy), pack->lanes);
    }
}

/* --- matrix --- */

/* Factors the matrix of the state and the step that the particles hold for it. */
static void factor(struct solid *solid, const struct particles *particles)
{
    implicit_factor(solid, particles, *particles->matrix_dt, 0, particles->matrix_nx,
                    particles->matrix_ny);
}

/* Factors the matrix of the present state. */
static void factor_here(struct solid *solid, struct particles *particles, double dt)
{
    const size_t bytes = (size_t)particles->n * sizeof *particles->ux;
    memcpy(particles->matrix_ux, particles->ux, bytes);
    memcpy(particles->matrix_uy, particles->uy, bytes);
    for (int64_t i = 0; i < particles->n; i++) particles->matrix_dt[i] = dt;
    if (particles->face_x) {
        memcpy(particles->matrix_nx, particles->face_x, bytes);
        memcpy(particles->matrix_ny, particles->face_y, bytes);
    }
    factor(solid, particles);
}

void implicit_resume(struct solid *solid, struct particles *particles)
{
    const size_t bytes = (size_t)particles->n * sizeof *particles->ux;
    double *const *const kept = solid->scratch;
    if (!(*particles->matrix_dt > 0)) return;
    memcpy(kept[0], particles->ux, bytes);
    memcpy(kept[1], particles->uy, bytes);
    memcpy(particles->ux, particles->matrix_ux, bytes);
    memcpy(particles->uy, particles->matrix_uy, bytes);
    solid_gradient(solid, particles);
    factor(solid, particles);
    memcpy(particles->ux, kept[0], bytes);
    memcpy(particles->uy, kept[1], bytes);
    solid_gradient(solid, particles);
}

/* --- step --- */

/* The state at the start of a step, in the scratch of the solid. */
enum { START_UX, START_UY, START_VX, START_VY, START_FIELDS };

/* Largest values of any particle. */
struct largest {
    double off, force;          /* residual and forces, N/m */
    double moved, strain, mass; /* m, 1, kg/m */
    double young, dp;
};

/* The residual of T-90 of one particle to `unknown`. */
static void find_one(const struct solid *solid, const struct particles *particles, int64_t i,
                     double dt, struct largest *top)
{
    const struct solid_body *const body = &solid->body[particles->body[i]];
    double *const *const start = solid->scratch;
    double *const to = &solid->implicit->unknown[2 * (int64_t)solid->implicit->order[i]];
    const double ax = 2 / dt * (particles->vx[i] - start[START_VX][i]),
                 ay = 2 / dt * (particles->vy[i] - start[START_VY][i]);
    double x = particles->sx[i] - ax, y = particles->sy[i] - ay;
    if (particles->face_x) { /* T-35a at the mean velocity */
        const double excess = particles->vx[i] * particles->face_x[i] +
                              particles->vy[i] * particles->face_y[i] - particles->face_v[i];
        x -= excess * particles->face_x[i];
        y -= excess * particles->face_y[i];
    }
    to[0] = body->mass * x;
    to[1] = body->mass * y;
    for (int c = 0; c < 2 && solid->implicit->left_out > 0; c++)
        to[c] -= solid->implicit->left_out * start[IMPLICIT_LEFT_OUT + c][i];
    const double off = max2(fabs(to[0]), fabs(to[1]));
    const double strain = max2(max2(fabs(particles->Uxx[i]), fabs(particles->Uxy[i])),
                               max2(fabs(particles->Uyx[i]), fabs(particles->Uyy[i])));
    const double stress = max2(max2(fabs(particles->Pxx[i]), fabs(particles->Pxy[i])),
                               max2(fabs(particles->Pyx[i]), fabs(particles->Pyy[i])));
    if (off > top->off || isnan(off)) top->off = off;
    top->force =
        max2(top->force, max2(body->dp * stress, off + body->mass * max2(fabs(ax), fabs(ay))));
    top->moved = max2(top->moved, max2(fabs(particles->ux[i]), fabs(particles->uy[i])));
    top->strain = max2(top->strain, strain);
    top->mass = max2(top->mass, body->mass);
    top->young = max2(top->young, body->young);
    top->dp = max2(top->dp, body->dp);
}

double implicit_residual(struct solid *solid, struct particles *particles, double dt, double time)
{
    double *const *const start = solid->scratch;
    struct largest top = {0};
    for (int64_t i = 0; i < particles->n; i++) {
        particles->vx[i] = 2 / dt * (particles->ux[i] - start[START_UX][i]);
        particles->vy[i] = 2 / dt * (particles->uy[i] - start[START_UY][i]);
    }
    solid_stress_and_forces(solid, particles, time);
    if (solid->hinges)
        hinges_push(solid->hinges, solid->implicit->hinge_force, particles->sx, particles->sy);
    for (int64_t i = 0; i < particles->n; i++)
        if (solid->implicit->order[i] >= 0) find_one(solid, particles, i, dt, &top);
    /* Round-off of forces: of inertia by displacements', and of stress by strains'. */
    const double rounding =
        64 * DBL_EPSILON *
        (4 * top.mass / square(dt) * top.moved + top.young * (top.moved + top.dp * top.strain));
    return top.off <= rounding ? 0 : top.off / top.force;
}

bool implicit_correct(const struct solid *solid, struct particles *particles)
{
    struct implicit *const implicit = solid->implicit;
    if (solid->hinges && !constraint_solve(implicit, solid->hinges, particles)) return false;
    envelope_solve(&implicit->matrix, implicit->unknown);
    for (int64_t i = 0; i < particles->n; i++) {
        const int64_t row = 2 * (int64_t)implicit->order[i];
        if (row < 0) continue;
        particles->ux[i] += implicit->unknown[row];
        particles->uy[i] += implicit->unknown[row + 1];
    }
    implicit->iterations++;
    return true;
}

/* Newton's method for the displacements at the middle of the step; returns whether it converged. */
static bool solve(struct solid *solid, struct particles *particles, double dt)
{
    struct implicit *const implicit = solid->implicit;
    double last = (double)INFINITY;
    for (int k = 0; k < ITERATIONS; k++) {
        implicit->residual = implicit_residual(solid, particles, dt, solid->time + 0.5 * dt);
        if (implicit->residual <= TOLERANCE && (k || !solid->hinges)) return true;
        if (!isfinite(implicit->residual)) break;
        const bool other_step = fabs(square(dt / *particles->matrix_dt) - 1) > SLOW;
        const bool anew = !implicit->factored || other_step || implicit->residual > SLOW * last;
        if (anew) factor_here(solid, particles, dt);
        if (!implicit->factored) break;
        if (!implicit_correct(solid, particles)) {
            if (anew) break;
            implicit->factored = false; /* old; those of the present state may do */
        }
        last = implicit->residual;
    }
    return false;
}

/* The exchange with the fluid by T-35a, at the mean velocity. */
static void book_impedance(struct particles *particles, double dt)
{
    for (int64_t i = 0; i < particles->n; i++) {
        const double along = particles->vx[i] * particles->face_x[i] +
                             particles->vy[i] * particles->face_y[i],
                     excess = dt * (along - particles->face_v[i]);
        particles->face_dv[i] += excess;
        particles->face_work[i] -= excess * along;
    }
}

/* From the middle of the step to its end: displacements, velocities, and the mean accelerations,
 * which give the work of loads. What clamps add to other forces does the rest. */
static void finish(struct solid *solid, struct particles *particles, double dt)
{
    double *const *const start = solid->scratch;
    struct loads *const loads = solid->loads;
    if (particles->face_x) book_impedance(particles, dt);
    for (int64_t k = 0; loads && k < loads->n_held; k++) {
        const int64_t i = loads->held[k];
        loads->held_power[k] =
            -solid->body[particles->body[i]].mass *
            (particles->sx[i] * particles->vx[i] + particles->sy[i] * particles->vy[i]);
        loads->held_rise[k] = 0;
    }
    for (int64_t i = 0; i < particles->n; i++) {
        particles->ux[i] += particles->ux[i] - start[START_UX][i];
        particles->uy[i] += particles->uy[i] - start[START_UY][i];
        particles->vx[i] += particles->vx[i] - start[START_VX][i];
        particles->vy[i] += particles->vy[i] - start[START_VY][i];
    }
    solid_place_clamps(solid, particles, solid->time + dt);
    for (int64_t i = 0; i < particles->n; i++) {
        particles->sx[i] = (particles->vx[i] - start[START_VX][i]) / dt;
        particles->sy[i] = (particles->vy[i] - start[START_VY][i]) / dt;
    }
    for (int64_t k = 0; loads && k < loads->n_held; k++) {
        const int64_t i = loads->held[k];
        loads->held_power[k] += 0.5 * solid->body[particles->body[i]].mass *
                                (particles->sx[i] * (particles->vx[i] + start[START_VX][i]) +
                                 particles->sy[i] * (particles->vy[i] + start[START_VY][i]));
    }
    if (solid->hinges) constraint_end(solid->implicit, solid->hinges, particles, dt);
    solid_finish_kick(solid, particles, start[START_VX], start[START_VY], dt);
}

void implicit_keep_start(struct solid *solid, struct particles *particles)
{
    const double *const from[] = {particles->ux, particles->uy, particles->vx, particles->vy};
    const double *const gradient[] = {particles->Uxx, particles->Uxy, particles->Uyx,
                                      particles->Uyy};
    const size_t bytes = (size_t)particles->n * sizeof *particles->ux;
    solid_gradient(solid, particles);
    for (int k = 0; k < START_FIELDS; k++) memcpy(solid->scratch[k], from[k], bytes);
    for (int k = 0; k < 4; k++) memcpy(solid->implicit->start[k], gradient[k], bytes);
}

/* First guess: displacements at the middle by the velocities; of clamps the mean of both ends. */
static void begin(struct solid *solid, struct particles *particles, double dt)
{
    double *const *const start = solid->scratch;
    const struct loads *const loads = solid->loads;
    implicit_keep_start(solid, particles);
    if (solid->hinges)
        constraint_begin(solid->implicit, solid->hinges, particles, solid->time + dt, true);
    solid_place_clamps(solid, particles, solid->time + dt);
    for (int64_t k = 0; loads && k < loads->n_held; k++) {
        const int64_t i = loads->held[k];
        particles->ux[i] = 0.5 * (particles->ux[i] + start[START_UX][i]);
        particles->uy[i] = 0.5 * (particles->uy[i] + start[START_UY][i]);
    }
    for (int64_t i = 0; i < particles->n; i++) {
        if (solid->implicit->order[i] < 0) continue;
        particles->ux[i] += 0.5 * dt * particles->vx[i];
        particles->uy[i] += 0.5 * dt * particles->vy[i];
    }
}

/* A step, or two of half its length where it has no solution. */
static bool step(struct solid *solid, struct particles *particles, double dt, int halvings)
{
    const size_t bytes = (size_t)particles->n * sizeof *particles->ux;
    double *const *const start = solid->scratch;
    begin(solid, particles, dt);
    if (solve(solid, particles, dt)) {
        finish(solid, particles, dt);
        return true;
    }
    double *const to[] = {particles->ux, particles->uy, particles->vx, particles->vy};
    for (int k = 0; k < START_FIELDS; k++) memcpy(to[k], start[k], bytes);
    solid->implicit->factored = false;
    if (halvings == 0 || !step(solid, particles, 0.5 * dt, halvings - 1)) return false;
    const double time = solid->time;
    solid->time += 0.5 * dt;
    const bool done = step(solid, particles, 0.5 * dt, halvings - 1);
    solid->time = time;
    return done;
}

void implicit_advance(struct solid *solid, struct particles *particles, double dt, int n)
{
    struct loads *const loads = solid->loads;
    struct hinges *const hinges = solid->hinges;
    if (!implicit_is_next(solid)) {
        solid_advance(solid, particles, dt, n);
        return;
    }
    solid->implicit_stress = take_mean_stress;
    if (loads) loads->released = true;
    if (hinges) hinges->released = true;
    for (int k = 0; k < n; k++, solid->time += dt) {
        solid->implicit->iterations = 0;
        solid->implicit->failed |= !step(solid, particles, dt, HALVINGS);
    }
    if (loads) loads->released = false;
    if (hinges) hinges->released = false;
    solid->implicit_stress = NULL;
}

/* T-93: the longest period of solids sets the implicit step where there is no fluid. */
double implicit_period(struct solid *solid, struct particles *particles)
{
    struct implicit *const implicit = solid->implicit;
    const double rounding = 8 * DBL_EPSILON * square(solid->omega_max);
    double low = rounding, high = square(solid->omega_max);
    if (implicit->n == 0) return (double)INFINITY;
    solid_gradient(solid, particles);
    while (high > 1.01 * low) {
        const double middle = sqrt(low * high);
        const int64_t below =
            implicit_factor(solid, particles, (double)INFINITY, -middle, NULL, NULL);
        *(below > 3 * implicit->n_free ? &high : &low) = middle;
    }
    implicit->factored = false;
    return high > 2 * rounding ? 2 * PI / sqrt(high) : (double)INFINITY;
}
