/* SPDX-License-Identifier: MIT
 * Implicit steps of the solid (T-90 to T-93): the midpoint rule with the mean stress over the
 * step, solved by Newton's method with a factored matrix that is kept while it serves. */
#include "implicit/constraint.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "implicit/stress.h"
#include "solid/hinges.h"
#include "solid/loads.h"

/* A matrix is replaced when a correction with it reduces the residual less than by this factor. */
#define SLOW 0.5

/* Of the residual over the largest force of a particle. */
#define TOLERANCE 1e-7

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

/* A sweep at the middle of a step: in place of P of the mean gradient, F of the mean gradient times
 * the mean stress. */
static void take_mean_stress(const struct solid *solid, struct particles *p, int64_t first,
                             int64_t last)
{
    double *const middle[] = {p->Uxx, p->Uxy, p->Uyx, p->Uyy}, *const P[] = {p->Pxx, p->Pxy, p->Pyx,
                                                                             p->Pyy};
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

/* For the state and the step that p holds as those of the matrix. */
static void factor(struct solid *solid, const struct particles *p)
{
    implicit_factor(solid, p, *p->matrix_dt, 0, p->matrix_nx, p->matrix_ny);
}

/* The present state of p as that of the matrix. */
static void factor_here(struct solid *solid, struct particles *p, double dt)
{
    const size_t bytes = (size_t)p->n * sizeof *p->ux;
    memcpy(p->matrix_ux, p->ux, bytes);
    memcpy(p->matrix_uy, p->uy, bytes);
    for (int64_t i = 0; i < p->n; i++) p->matrix_dt[i] = dt;
    if (p->face_x) {
        memcpy(p->matrix_nx, p->face_x, bytes);
        memcpy(p->matrix_ny, p->face_y, bytes);
    }
    factor(solid, p);
}

void implicit_resume(struct solid *solid, struct particles *p)
{
    const size_t bytes = (size_t)p->n * sizeof *p->ux;
    double *const *const kept = solid->scratch;
    if (!(*p->matrix_dt > 0)) return;
    memcpy(kept[0], p->ux, bytes);
    memcpy(kept[1], p->uy, bytes);
    memcpy(p->ux, p->matrix_ux, bytes);
    memcpy(p->uy, p->matrix_uy, bytes);
    solid_gradient(solid, p);
    factor(solid, p);
    memcpy(p->ux, kept[0], bytes);
    memcpy(p->uy, kept[1], bytes);
    solid_gradient(solid, p);
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

/* Round-off of forces: of inertia by that of displacements, and of stress by that of strains. */
static double rounding_of(const struct largest *top, double dt)
{
    return 64 * DBL_EPSILON *
           (4 * top->mass / square(dt) * top->moved +
            top->young * (top->moved + top->dp * top->strain));
}

/* The residual of T-90 of one particle to `unknown`. */
static void find_one(const struct solid *solid, const struct particles *p, int64_t i, double dt,
                     struct largest *top)
{
    const struct solid_body *const body = &solid->body[p->body[i]];
    double *const *const start = solid->scratch;
    double *const to = &solid->implicit->unknown[2 * (int64_t)solid->implicit->order[i]];
    const double ax = 2 / dt * (p->vx[i] - start[START_VX][i]),
                 ay = 2 / dt * (p->vy[i] - start[START_VY][i]);
    double x = p->sx[i] - ax, y = p->sy[i] - ay;
    if (p->face_x) { /* T-35a at the mean velocity */
        const double faster = p->vx[i] * p->face_x[i] + p->vy[i] * p->face_y[i] - p->face_v[i];
        x -= faster * p->face_x[i];
        y -= faster * p->face_y[i];
    }
    to[0] = body->mass * x;
    to[1] = body->mass * y;
    for (int c = 0; c < 2 && solid->implicit->left_out > 0; c++)
        to[c] -= solid->implicit->left_out * start[IMPLICIT_LEFT_OUT + c][i];
    const double off = max2(fabs(to[0]), fabs(to[1]));
    const double strain =
        max2(max2(fabs(p->Uxx[i]), fabs(p->Uxy[i])), max2(fabs(p->Uyx[i]), fabs(p->Uyy[i])));
    const double stress =
        max2(max2(fabs(p->Pxx[i]), fabs(p->Pxy[i])), max2(fabs(p->Pyx[i]), fabs(p->Pyy[i])));
    if (off > top->off || isnan(off)) top->off = off;
    top->force =
        max2(top->force, max2(body->dp * stress, off + body->mass * max2(fabs(ax), fabs(ay))));
    top->moved = max2(top->moved, max2(fabs(p->ux[i]), fabs(p->uy[i])));
    top->strain = max2(top->strain, strain);
    top->mass = max2(top->mass, body->mass);
    top->young = max2(top->young, body->young);
    top->dp = max2(top->dp, body->dp);
}

double implicit_residual(struct solid *solid, struct particles *p, double dt, double time)
{
    double *const *const start = solid->scratch;
    struct largest top = {0};
    for (int64_t i = 0; i < p->n; i++) {
        p->vx[i] = 2 / dt * (p->ux[i] - start[START_UX][i]);
        p->vy[i] = 2 / dt * (p->uy[i] - start[START_UY][i]);
    }
    solid_forces_within(solid, p, time);
    if (solid->hinges) constraint_push(solid->implicit, solid->hinges, p);
    for (int64_t i = 0; i < p->n; i++)
        if (solid->implicit->order[i] >= 0) find_one(solid, p, i, dt, &top);
    return top.off <= rounding_of(&top, dt) ? 0 : top.off / top.force;
}

void implicit_correct(const struct solid *solid, struct particles *p)
{
    struct implicit *const by = solid->implicit;
    if (solid->hinges) constraint_solve(by, solid->hinges, p);
    envelope_solve(&by->matrix, by->unknown);
    for (int64_t i = 0; i < p->n; i++) {
        const int64_t row = 2 * (int64_t)by->order[i];
        if (row < 0) continue;
        p->ux[i] += by->unknown[row];
        p->uy[i] += by->unknown[row + 1];
    }
    by->iterations++;
}

/* Newton's method for the displacements at the middle of the step; returns whether it converged. */
static bool solve(struct solid *solid, struct particles *p, double dt)
{
    struct implicit *const by = solid->implicit;
    double last = (double)INFINITY;
    for (int k = 0; k < ITERATIONS; k++) {
        by->residual = implicit_residual(solid, p, dt, solid->time + 0.5 * dt);
        if (by->residual <= TOLERANCE && (k || !solid->hinges)) return true;
        if (!isfinite(by->residual)) break;
        const bool other_step = fabs(square(dt / *p->matrix_dt) - 1) > SLOW;
        if (!by->factored || other_step || by->residual > SLOW * last) factor_here(solid, p, dt);
        if (!by->factored) break;
        implicit_correct(solid, p);
        last = by->residual;
    }
    return false;
}

/* The exchange with the fluid by T-35a, at the mean velocity. */
static void book_impedance(struct particles *p, double dt)
{
    for (int64_t i = 0; i < p->n; i++) {
        const double along = p->vx[i] * p->face_x[i] + p->vy[i] * p->face_y[i],
                     faster = dt * (along - p->face_v[i]);
        p->face_dv[i] += faster;
        p->face_work[i] -= faster * along;
    }
}

/* From the middle of the step to its end: displacements, velocities, and the mean accelerations, of
 * which the work of loads follows. What clamps add to the other forces does the rest of the work
 * on their particles. */
static void finish(struct solid *solid, struct particles *p, double dt)
{
    double *const *const start = solid->scratch;
    struct loads *const loads = solid->loads;
    if (p->face_x) book_impedance(p, dt);
    for (int64_t k = 0; loads && k < loads->n_held; k++) {
        const int64_t i = loads->held[k];
        loads->held_power[k] =
            -solid->body[p->body[i]].mass * (p->sx[i] * p->vx[i] + p->sy[i] * p->vy[i]);
        loads->held_rise[k] = 0;
    }
    for (int64_t i = 0; i < p->n; i++) {
        p->ux[i] += p->ux[i] - start[START_UX][i];
        p->uy[i] += p->uy[i] - start[START_UY][i];
        p->vx[i] += p->vx[i] - start[START_VX][i];
        p->vy[i] += p->vy[i] - start[START_VY][i];
    }
    solid_place_clamps(solid, p, solid->time + dt);
    for (int64_t i = 0; i < p->n; i++) {
        p->sx[i] = (p->vx[i] - start[START_VX][i]) / dt;
        p->sy[i] = (p->vy[i] - start[START_VY][i]) / dt;
    }
    for (int64_t k = 0; loads && k < loads->n_held; k++) {
        const int64_t i = loads->held[k];
        loads->held_power[k] += 0.5 * solid->body[p->body[i]].mass *
                                (p->sx[i] * (p->vx[i] + start[START_VX][i]) +
                                 p->sy[i] * (p->vy[i] + start[START_VY][i]));
    }
    if (solid->hinges) constraint_end(solid->implicit, solid->hinges, p, dt);
    solid_book_work(solid, p, start[START_VX], start[START_VY], dt);
}

void implicit_keep_start(struct solid *solid, struct particles *p)
{
    const double *const from[] = {p->ux, p->uy, p->vx, p->vy};
    const double *const gradient[] = {p->Uxx, p->Uxy, p->Uyx, p->Uyy};
    const size_t bytes = (size_t)p->n * sizeof *p->ux;
    solid_gradient(solid, p);
    for (int k = 0; k < START_FIELDS; k++) memcpy(solid->scratch[k], from[k], bytes);
    for (int k = 0; k < 4; k++) memcpy(solid->implicit->start[k], gradient[k], bytes);
}

/* The first guess: displacements at the middle by the present velocities; those of clamps are the
 * mean of both ends. */
static void begin(struct solid *solid, struct particles *p, double dt)
{
    double *const *const start = solid->scratch;
    const struct loads *const loads = solid->loads;
    implicit_keep_start(solid, p);
    if (solid->hinges) constraint_begin(solid->implicit, solid->hinges, p, solid->time + dt, true);
    solid_place_clamps(solid, p, solid->time + dt);
    for (int64_t k = 0; loads && k < loads->n_held; k++) {
        const int64_t i = loads->held[k];
        p->ux[i] = 0.5 * (p->ux[i] + start[START_UX][i]);
        p->uy[i] = 0.5 * (p->uy[i] + start[START_UY][i]);
    }
    for (int64_t i = 0; i < p->n; i++) {
        if (solid->implicit->order[i] < 0) continue;
        p->ux[i] += 0.5 * dt * p->vx[i];
        p->uy[i] += 0.5 * dt * p->vy[i];
    }
}

/* A step, or two of half its length where it has no solution. */
static bool step(struct solid *solid, struct particles *p, double dt, int halvings)
{
    const size_t bytes = (size_t)p->n * sizeof *p->ux;
    double *const *const start = solid->scratch;
    begin(solid, p, dt);
    if (solve(solid, p, dt)) {
        finish(solid, p, dt);
        return true;
    }
    double *const to[] = {p->ux, p->uy, p->vx, p->vy};
    for (int k = 0; k < START_FIELDS; k++) memcpy(to[k], start[k], bytes);
    solid->implicit->factored = false;
    if (halvings == 0 || !step(solid, p, 0.5 * dt, halvings - 1)) return false;
    const double time = solid->time;
    solid->time += 0.5 * dt;
    const bool done = step(solid, p, 0.5 * dt, halvings - 1);
    solid->time = time;
    return done;
}

void implicit_step(struct solid *solid, struct particles *p, double dt)
{
    struct loads *const loads = solid->loads;
    struct hinges *const hinges = solid->hinges;
    solid->implicit->iterations = 0;
    solid->within_step = take_mean_stress;
    if (loads) loads->released = true;
    if (hinges) hinges->released = true;
    solid->implicit->failed |= !step(solid, p, dt, HALVINGS);
    if (loads) loads->released = false;
    if (hinges) hinges->released = false;
    solid->within_step = NULL;
}

void implicit_advance(struct solid *solid, struct particles *particles, double dt, int n,
                      bool centred)
{
    if (!implicit_is_next(solid)) {
        solid_advance(solid, particles, dt, n, centred);
        return;
    }
    for (int k = 0; k < n; k++, solid->time += dt) implicit_step(solid, particles, dt);
}
