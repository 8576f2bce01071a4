/* SPDX-License-Identifier: MIT
 * Implicit steps of the solid (T-90 to T-93): the midpoint rule with the mean stress over the
 * step, solved by Newton's method with a factored matrix that is kept while it serves. */
#include "base/real_double.h"

#include "implicit/implicit.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "solid/loads.h"
#include "solid/material.h"

/* A matrix is replaced when a correction with it reduces the residual less than by this factor. */
#define SLOW 0.5

/* Of the residual over the largest force of a particle. */
#define TOLERANCE 1e-7

enum { ITERATIONS = 40, HALVINGS = 6 };

/* --- stress --- */

/* T-91: second Piola-Kirchhoff stress of a strain, S = F^-1 P with the upper triangular F of
 * F^T F = I + 2 E: the laws are objective, so every F of this strain gives the same. */
static struct vtensor2 stress_of_strain(const struct solid_body *b, struct vtensor2 E)
{
    const vreal a = vsqrt(2.0 * E.xx + 1.0), shear = 2.0 * E.xy / a;
    const vreal rest = 2.0 * E.yy - shear * shear, d = vsqrt(rest + 1.0);
    const struct vtensor2 U = {2.0 * E.xx / (a + 1.0), shear, vset(0), rest / (d + 1.0)};
    const struct vtensor2 P = material_pk1(b, U);
    const vreal across = P.yx / d;
    return (struct vtensor2){(P.xx - shear * across) / a, across, across, P.yy / d};
}

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

static struct vtensor2 load_tensor(double *const field[4], int64_t i)
{
    return (struct vtensor2){vload(field[0] + i), vload(field[1] + i), vload(field[2] + i),
                             vload(field[3] + i)};
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

/* dP/dF of one particle, Pa, in the order xx, xy, yx, yy. */
struct tangent {
    double of[4][4];
};

/* T-92: dP = dF S + F (dS/dE : sym(F^T dF)). dS/dE is by differences, for all laws; `viscous`
 * adds to it what a damping_time does over the step, times the same tensor. */
static void find_tangents(const struct solid_body *body, struct vtensor2 U, double viscous,
                          int lanes, struct tangent *tangent)
{
    const double delta = 1e-6;
    const struct vtensor2 F = deformation(U), E = green_lagrange(U), S = stress_of_strain(body, E);
    const vreal zero = vset(0);
    const vreal strain[3][4] = {{F.xx, zero, F.yx, zero},
                                {zero, F.xy, zero, F.yy},
                                {F.xy, F.xx, F.yy, F.yx}};
    vreal D[3][3];
    for (int c = 0; c < 3; c++) {
        const double x = c == 0 ? delta : 0, y = c == 1 ? delta : 0, both = c == 2 ? delta / 2 : 0;
        const struct vtensor2 up =
            stress_of_strain(body, (struct vtensor2){E.xx + x, E.xy + both, E.yx + both, E.yy + y});
        const struct vtensor2 down =
            stress_of_strain(body, (struct vtensor2){E.xx - x, E.xy - both, E.yx - both, E.yy - y});
        const double per = (1 + viscous) / (2 * delta);
        D[0][c] = (up.xx - down.xx) * per;
        D[1][c] = (up.yy - down.yy) * per;
        D[2][c] = (up.xy - down.xy) * per;
    }
    const vreal stress[2][2] = {{S.xx, S.xy}, {S.xy, S.yy}};
    for (int r = 0; r < 4; r++)
        for (int c = 0; c <= r; c++) {
            vreal sum = r / 2 == c / 2 ? stress[r % 2][c % 2] : zero;
            for (int m = 0; m < 3; m++)
                for (int n = 0; n < 3; n++)
                    sum = sum + strain[m][r] * (0.5 * (D[m][n] + D[n][m])) * strain[n][c];
            for (int l = 0; l < lanes; l++) tangent[l].of[r][c] = tangent[l].of[c][r] = sum[l];
        }
}

/* Adds V g_m . dP/dF . g_n for each two of the particles that the gradient depends on. */
static void add_particle(const struct implicit *by, int64_t i, double volume,
                         const struct tangent *tangent)
{
    const struct implicit_links *const links = &by->links;
    for (int64_t n = links->first[i]; n < links->first[i + 1]; n++) {
        const int64_t column = by->order[links->node[n]];
        if (column < 0) continue;
        const double gx = volume * links->gx[n], gy = volume * links->gy[n];
        double to[2][4];
        for (int c = 0; c < 2; c++)
            for (int r = 0; r < 4; r++)
                to[c][r] = tangent->of[r][2 * c] * gx + tangent->of[r][2 * c + 1] * gy;
        for (int64_t m = links->first[i]; m < links->first[i + 1]; m++) {
            const int64_t row = by->order[links->node[m]];
            if (row < column) continue;
            const double hx = links->gx[m], hy = links->gy[m];
            for (int r = 0; r < 2; r++)
                for (int c = 0; c < (row == column ? r + 1 : 2); c++)
                    envelope_add(&by->matrix, 2 * row + r, 2 * column + c,
                                 hx * to[c][2 * r] + hy * to[c][2 * r + 1]);
        }
    }
}

/* The matrix of T-92 without inertia: of the stress at the gradients in p, and of the springs. */
static void add_stiffness(struct solid *solid, const struct particles *p, double dt)
{
    struct implicit *const by = solid->implicit;
    struct tangent tangent[LANES];
    double *const gradient[] = {p->Uxx, p->Uxy, p->Uyx, p->Uyy};
    envelope_clear(&by->matrix);
    for (int64_t k = 0; k < solid->n_packs; k++) {
        const struct solid_pack *const pack = &solid->pack[k];
        const struct solid_body *const body = &solid->body[pack->body];
        find_tangents(body, load_tensor(gradient, pack->i), 2 * body->damping_time / dt,
                      pack->lanes, tangent);
        for (int l = 0; l < pack->lanes; l++)
            add_particle(by, pack->i + l, square(body->dp), &tangent[l]);
    }
    const struct envelope *const from = &by->springs;
    for (int64_t row = 0; row < from->n; row++)
        for (int c = 0; c < 2; c++) {
            for (int64_t column = from->first[row]; column < row; column++) {
                const double value = from->value[from->start[row] + column - from->first[row]];
                if (value != 0) envelope_add(&by->matrix, 2 * row + c, 2 * column + c, value);
            }
            envelope_add(&by->matrix, 2 * row + c, 2 * row + c, from->pivot[row]);
        }
}

/* T-92: for the state and the step that p holds as those of the matrix. */
static void factor(struct solid *solid, const struct particles *p)
{
    struct implicit *const by = solid->implicit;
    add_stiffness(solid, p, *p->matrix_dt);
    for (int64_t i = 0; i < p->n; i++) {
        const struct solid_body *const body = &solid->body[p->body[i]];
        const int64_t row = 2 * (int64_t)by->order[i];
        const double per_dt = 2 / *p->matrix_dt, rate = body->mass * per_dt;
        if (row < 0) continue;
        for (int c = 0; c < 2; c++)
            by->matrix.pivot[row + c] += rate * (per_dt + body->mass_damping);
        by->matrix.pivot[row] += rate * square(p->matrix_nx[i]);
        by->matrix.pivot[row + 1] += rate * square(p->matrix_ny[i]);
        envelope_add(&by->matrix, row + 1, row, rate * p->matrix_nx[i] * p->matrix_ny[i]);
    }
    by->factored = envelope_factor(&by->matrix) >= 0;
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

/* --- period --- */

/* Masses, centres and moments of inertia of bodies, joined ones as one; zero of those that are
 * held. */
struct rigid {
    double mass, x, y, inertia;
    bool held;
};

static void find_rigid(const struct solid *solid, const struct particles *p, struct rigid *rigid)
{
    memset(rigid, 0, (size_t)solid->n_bodies * sizeof *rigid);
    for (int64_t i = 0; i < p->n; i++) {
        const struct solid_body *const body = &solid->body[p->body[i]];
        struct rigid *const of = &rigid[body->bond];
        of->held |= solid->implicit->order[i] < 0;
        of->mass += body->mass;
        of->x += body->mass * p->X[i];
        of->y += body->mass * p->Y[i];
    }
    for (int k = 0; k < solid->n_bodies; k++)
        if (rigid[k].mass > 0) rigid[k].x /= rigid[k].mass, rigid[k].y /= rigid[k].mass;
    for (int64_t i = 0; i < p->n; i++) {
        const struct solid_body *const body = &solid->body[p->body[i]];
        struct rigid *const of = &rigid[body->bond];
        of->inertia += body->mass * (square(p->X[i] - of->x) + square(p->Y[i] - of->y));
    }
}

/* Removes the rigid motions of bodies that are not held from `unknown`. */
static void remove_rigid(const struct solid *solid, const struct particles *p,
                         const struct rigid *rigid)
{
    const struct implicit *const by = solid->implicit;
    double x[solid->n_bodies], y[solid->n_bodies], turn[solid->n_bodies];
    for (int k = 0; k < solid->n_bodies; k++) x[k] = y[k] = turn[k] = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int64_t i = 0; i < p->n; i++) {
            const struct solid_body *const body = &solid->body[p->body[i]];
            const struct rigid *const of = &rigid[body->bond];
            if (of->held) continue;
            double *const u = &by->unknown[2 * (int64_t)by->order[i]];
            const double dx = p->X[i] - of->x, dy = p->Y[i] - of->y;
            if (pass == 0) {
                x[body->bond] += body->mass / of->mass * u[0];
                y[body->bond] += body->mass / of->mass * u[1];
                turn[body->bond] += body->mass / of->inertia * (dx * u[1] - dy * u[0]);
            } else {
                u[0] -= x[body->bond] - turn[body->bond] * dy;
                u[1] -= y[body->bond] + turn[body->bond] * dx;
            }
        }
}

/* unknown = M unknown; returns the energy norm u . M u. */
static double weigh(const struct solid *solid, const struct particles *p)
{
    const struct implicit *const by = solid->implicit;
    double sum = 0;
    for (int64_t i = 0; i < p->n; i++) {
        if (by->order[i] < 0) continue;
        const double mass = solid->body[p->body[i]].mass;
        double *const u = &by->unknown[2 * (int64_t)by->order[i]];
        sum += mass * (square(u[0]) + square(u[1]));
        u[0] *= mass;
        u[1] *= mass;
    }
    return sum;
}

/* The square of a frequency, by inverse iteration with the matrix K + shift M from a field without
 * a pattern; INFINITY if nothing moves. */
static double iterate(struct solid *solid, struct particles *p, const struct rigid *rigid,
                      double shift)
{
    enum { ROUNDS = 12 };
    struct implicit *const by = solid->implicit;
    double lowest = (double)INFINITY;
    add_stiffness(solid, p, (double)INFINITY);
    for (int64_t i = 0; i < p->n; i++)
        for (int c = 0; c < 2 && by->order[i] >= 0; c++)
            by->matrix.pivot[2 * (int64_t)by->order[i] + c] += shift * solid->body[p->body[i]].mass;
    if (envelope_factor(&by->matrix) < 0) return lowest;
    for (int64_t k = 0; k < 2 * by->n; k++)
        by->unknown[k] = (double)((uint32_t)(k + 1) * 2654435769u) * 0x1p-32 - 0.5;
    for (int round = 0; round < ROUNDS; round++) {
        remove_rigid(solid, p, rigid);
        const double before = weigh(solid, p);
        if (!(before > 0)) return lowest;
        for (int64_t k = 0; k < 2 * by->n; k++) by->unknown[k] /= sqrt(before);
        envelope_solve(&by->matrix, by->unknown);
        double after = 0;
        for (int64_t i = 0; i < p->n; i++)
            for (int c = 0; c < 2 && by->order[i] >= 0; c++)
                after += solid->body[p->body[i]].mass *
                         square(by->unknown[2 * (int64_t)by->order[i] + c]);
        lowest = 1 / sqrt(after) - shift;
    }
    return lowest;
}

double implicit_period(struct solid *solid, struct particles *p)
{
    struct rigid rigid[solid->n_bodies];
    double omega2 = square(solid->omega_max), before;
    const double rounding = 8 * DBL_EPSILON * omega2;
    find_rigid(solid, p, rigid);
    solid_gradient(solid, p);
    do { /* the shift, a tenth of the square of the frequency, makes it converge */
        before = omega2;
        omega2 = iterate(solid, p, rigid, 0.1 * before);
    } while (omega2 < 0.99 * before && omega2 > rounding);
    solid->implicit->factored = false;
    return omega2 > rounding && isfinite(omega2) ? 2 * M_PI / sqrt(omega2) : (double)INFINITY;
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

/* Forces at the present displacements as those of the middle of the step, and the residual of T-90;
 * returns the largest of a particle over the largest force, 0: below round-off. */
static double find_residual(struct solid *solid, struct particles *p, double dt)
{
    double *const *const start = solid->scratch;
    struct largest top = {0};
    for (int64_t i = 0; i < p->n; i++) {
        p->vx[i] = 2 / dt * (p->ux[i] - start[START_UX][i]);
        p->vy[i] = 2 / dt * (p->uy[i] - start[START_UY][i]);
    }
    solid_forces_within(solid, p, solid->time + 0.5 * dt);
    for (int64_t i = 0; i < p->n; i++)
        if (solid->implicit->order[i] >= 0) find_one(solid, p, i, dt, &top);
    return top.off <= rounding_of(&top, dt) ? 0 : top.off / top.force;
}

static void correct(const struct solid *solid, struct particles *p)
{
    struct implicit *const by = solid->implicit;
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
        by->residual = find_residual(solid, p, dt);
        if (by->residual <= TOLERANCE) return true;
        if (!isfinite(by->residual)) break;
        const bool other_step = fabs(square(dt / *p->matrix_dt) - 1) > SLOW;
        if (!by->factored || other_step || by->residual > SLOW * last) factor_here(solid, p, dt);
        if (!by->factored) break;
        correct(solid, p);
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
    solid_book_work(solid, p, start[START_VX], start[START_VY], dt);
}

static void keep_start(struct solid *solid, struct particles *p)
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
    keep_start(solid, p);
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
    solid->implicit->iterations = 0;
    solid->within_step = take_mean_stress;
    if (loads) loads->released = true;
    solid->implicit->failed |= !step(solid, p, dt, HALVINGS);
    if (loads) loads->released = false;
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
