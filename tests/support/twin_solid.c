/* SPDX-License-Identifier: MIT */
#include "twin_solid.h"

#include "unity.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static double kernel(double r, double h)
{
    const double q = r / h;
    return q >= 2 ? 0 : 7 / (4 * pi * h * h) * pow(1 - q / 2, 4) * (2 * q + 1);
}

static double kernel_derivative(double r, double h)
{
    const double q = r / h;
    return q >= 2 ? 0 : -7 / (4 * pi * h * h) * 5 * q * pow(1 - q / 2, 3) / h;
}

static struct twin_mat mul(struct twin_mat a, struct twin_mat b)
{
    struct twin_mat c = {{{0}}};
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            for (int k = 0; k < 2; k++) c.m[i][j] += a.m[i][k] * b.m[k][j];
    return c;
}

static struct twin_mat transpose(struct twin_mat a)
{
    return (struct twin_mat){{{a.m[0][0], a.m[1][0]}, {a.m[0][1], a.m[1][1]}}};
}

static double det(struct twin_mat a) { return a.m[0][0] * a.m[1][1] - a.m[0][1] * a.m[1][0]; }

static struct twin_mat inverse(struct twin_mat a)
{
    const double d = det(a);
    return (struct twin_mat){{{a.m[1][1] / d, -a.m[0][1] / d}, {-a.m[1][0] / d, a.m[0][0] / d}}};
}

/* a + factor b */
static struct twin_mat add(struct twin_mat a, double factor, struct twin_mat b)
{
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) a.m[i][j] += factor * b.m[i][j];
    return a;
}

/* Eq. 12 from F itself: E = (F^T F - I)/2. */
static struct twin_mat green_lagrange(struct twin_mat F)
{
    const struct twin_mat C = mul(transpose(F), F);
    return (struct twin_mat){
        {{0.5 * (C.m[0][0] - 1), 0.5 * C.m[0][1]}, {0.5 * C.m[1][0], 0.5 * (C.m[1][1] - 1)}}};
}

/* Eq. 10, or the law of plane stress: E/(1 - nu^2) [[1, nu], [nu, 1]], 2G on the shear. */
static struct twin_mat hooke(const struct scene_solid *body, struct twin_mat e)
{
    const double E = body->young, nu = body->poisson;
    const bool stress = body->plane == PLANE_STRESS;
    const double a = stress ? E / (1 - nu * nu) : E * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
    const double b = stress ? E * nu / (1 - nu * nu) : E * nu / ((1 + nu) * (1 - 2 * nu));
    const double shear = E / (1 + nu);
    return (struct twin_mat){{{a * e.m[0][0] + b * e.m[1][1], shear * e.m[0][1]},
                              {shear * e.m[1][0], b * e.m[0][0] + a * e.m[1][1]}}};
}

/* Thickness at which the neo-Hookean stress across the plane vanishes: mu (t - 1/t) + lambda/2
 * ((J t)^2 - 1)/t = 0, found by bisection. */
static double neo_hookean_thickness(double lambda, double mu, double J)
{
    double low = 1e-3, high = 1e3;
    for (int k = 0; k < 200; k++) {
        const double t = 0.5 * (low + high);
        if (mu * (t - 1 / t) + 0.5 * lambda * (J * J * t * t - 1) / t > 0)
            high = t;
        else
            low = t;
    }
    return 0.5 * (low + high);
}

static struct twin_mat neo_hookean(const struct scene_solid *body, struct twin_mat F,
                                   double *thickness)
{
    const double E = body->young, nu = body->poisson;
    const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
    *thickness = body->plane == PLANE_STRESS ? neo_hookean_thickness(lambda, mu, det(F)) : 1;
    const double J = det(F) * *thickness;
    const struct twin_mat FmT = transpose(inverse(F));
    struct twin_mat P = {{{0}}};
    P = add(P, mu, F);
    return add(P, 0.5 * lambda * (J * J - 1) - mu, FmT);
}

struct twin_mat twin_solid_stress(const struct scene_solid *body, struct twin_mat F,
                                  struct twin_mat *sigma)
{
    const struct twin_mat E = green_lagrange(F), Fi = inverse(F);
    const double ratio = -body->poisson / (1 - body->poisson);
    double thickness = 1;
    struct twin_mat P;
    if (body->law == LAW_PAPER) {
        const struct twin_mat eps = mul(mul(transpose(Fi), E), Fi); /* Eq. 11, mended */
        *sigma = hooke(body, eps);
        /* Almansi: eps_zz = (1 - 1/t^2)/2. */
        if (body->plane == PLANE_STRESS)
            thickness = 1 / sqrt(1 - 2 * ratio * (eps.m[0][0] + eps.m[1][1]));
        P = mul(*sigma, transpose(Fi)); /* Eq. 9 */
        const double J = det(F) * thickness;
        return (struct twin_mat){{{J * P.m[0][0], J * P.m[0][1]}, {J * P.m[1][0], J * P.m[1][1]}}};
    }
    if (body->law == LAW_SVK) {
        P = mul(F, hooke(body, E));
        if (body->plane == PLANE_STRESS) thickness = sqrt(1 + 2 * ratio * (E.m[0][0] + E.m[1][1]));
    } else {
        P = neo_hookean(body, F, &thickness);
    }
    *sigma = mul(P, transpose(F));
    for (int i = 0; i < 4; i++) sigma->m[i / 2][i % 2] /= det(F) * thickness;
    return P;
}

void twin_solid_copy(struct twin_solid *t, const struct simulation *sim)
{
    const struct particles *const particles = &sim->particles[KIND_SOLID];
    *t = (struct twin_solid){.h = sim->scene->numerics.h_over_dp * sim->scene->top.dp,
                             .dp = sim->scene->top.dp,
                             .body = sim->scene->solid,
                             .contact = sim->scene->n_contact ? sim->scene->contact : NULL,
                             .n = particles->n};
    t->point = calloc((size_t)particles->n, sizeof *t->point);
    TEST_ASSERT_NOT_NULL(t->point);
    for (int64_t i = 0; i < particles->n; i++)
        t->point[i] = (struct twin_solid_point){.body = particles->body[i],
                                                .X = particles->X[i],
                                                .Y = particles->Y[i],
                                                .x = particles->X[i] + particles->ux[i],
                                                .y = particles->Y[i] + particles->uy[i],
                                                .u = particles->vx[i],
                                                .v = particles->vy[i]};
}

void twin_solid_free(struct twin_solid *t)
{
    free(t->point);
    memset(t, 0, sizeof *t);
}

/* Reference geometry of a pair: X_ab and grad_0 W_0ab at a. false: not neighbours. */
struct reference {
    double X[2], r, gradient[2];
};

/* One body, or one joined to the other. */
static bool bonded(const struct twin_solid *t, int a, int b)
{
    return a == b || strcmp(t->body[a].joined, t->body[b].common.name) == 0 ||
           strcmp(t->body[b].joined, t->body[a].common.name) == 0;
}

static bool neighbours(const struct twin_solid *t, const struct twin_solid_point *a,
                       const struct twin_solid_point *b, struct reference *q)
{
    *q = (struct reference){.X = {a->X - b->X, a->Y - b->Y}};
    q->r = sqrt(q->X[0] * q->X[0] + q->X[1] * q->X[1]);
    if (a == b || !bonded(t, a->body, b->body) || q->r >= 2 * t->h) return false;
    for (int i = 0; i < 2; i++) q->gradient[i] = kernel_derivative(q->r, t->h) * q->X[i] / q->r;
    return true;
}

/* F tau C : sym(F^T dF/dt), with dF/dt from the velocities as F is from the positions. */
static void damp(const struct twin_solid *t, struct twin_solid_point *a)
{
    struct twin_mat rate = {{{0}}};
    struct reference q;
    for (int64_t k = 0; k < t->n; k++) {
        const struct twin_solid_point *const b = &t->point[k];
        if (!neighbours(t, a, b, &q)) continue;
        const double v[2] = {b->u - a->u, b->v - a->v};
        for (int j = 0; j < 2; j++) {
            const double g =
                a->inverse_L.m[j][0] * q.gradient[0] + a->inverse_L.m[j][1] * q.gradient[1];
            for (int i = 0; i < 2; i++) rate.m[i][j] += t->dp * t->dp * v[i] * g;
        }
    }
    const struct twin_mat C = mul(transpose(a->F), rate);
    const struct twin_mat E = add(add((struct twin_mat){{{0}}}, 0.5, C), 0.5, transpose(C));
    a->P = add(a->P, t->body[a->body].damping_time, mul(a->F, hooke(&t->body[a->body], E)));
}

/* Eqs. 13b and 13c, then the stress. */
static void deform(const struct twin_solid *t, struct twin_solid_point *a)
{
    const double V = t->dp * t->dp;
    struct twin_mat L = {{{0}}};
    struct reference q;
    for (int64_t k = 0; k < t->n; k++) {
        if (!neighbours(t, a, &t->point[k], &q)) continue;
        for (int i = 0; i < 2; i++)
            for (int j = 0; j < 2; j++) L.m[i][j] += V * -q.X[i] * q.gradient[j];
    }
    a->inverse_L = inverse(L);
    a->F = (struct twin_mat){{{0}}};
    for (int64_t k = 0; k < t->n; k++) {
        const struct twin_solid_point *const b = &t->point[k];
        if (!neighbours(t, a, b, &q)) continue;
        const double x[2] = {b->x - a->x, b->y - a->y};
        for (int j = 0; j < 2; j++) {
            const double g =
                a->inverse_L.m[j][0] * q.gradient[0] + a->inverse_L.m[j][1] * q.gradient[1];
            for (int i = 0; i < 2; i++) a->F.m[i][j] += V * x[i] * g;
        }
    }
    a->P = twin_solid_stress(&t->body[a->body], a->F, &a->sigma);
    damp(t, a);
}

/* Eqs. 15-16: e_ab. */
static void error_vector(const struct twin_solid_point *a, const struct twin_solid_point *b,
                         const struct reference *q, double e[2])
{
    const double x[2] = {a->x - b->x, a->y - b->y};
    const struct twin_mat sum = add(a->F, 1, b->F);
    for (int i = 0; i < 2; i++) e[i] = 0.5 * (sum.m[i][0] * q->X[0] + sum.m[i][1] * q->X[1]) - x[i];
}

/* kappa V_b E_ab times W_0ab/X_ab^2 (Eq. 17), or (1 - X_ab/2h)/(8 h^4): k_ab over V_a. */
static double spring(const struct twin_solid *t, const struct twin_solid_point *a,
                     const struct twin_solid_point *b, const struct reference *q)
{
    const struct scene_solid *const body = &t->body[a->body];
    const double young = 0.5 * (body->young + t->body[b->body].young);
    const double weight = body->hourglass_form == HOURGLASS_PRINTED
                              ? kernel(q->r, t->h) / (q->r * q->r)
                              : (1 - 0.5 * q->r / t->h) / (8 * pow(t->h, 4));
    return body->hourglass * t->dp * t->dp * young * weight;
}

/* Where the hourglass force is the derivative of the sum over pairs of V_a V_b k |e|^2/2, its share
 * of the stress conjugate to F_a. */
static struct twin_mat hourglass_share(const struct twin_solid *t, const struct twin_solid_point *a)
{
    struct twin_mat share = {{{0}}};
    struct reference q;
    for (int64_t n = 0; n < t->n; n++) {
        if (!neighbours(t, a, &t->point[n], &q)) continue;
        double e[2];
        error_vector(a, &t->point[n], &q, e);
        const double k = spring(t, a, &t->point[n], &q);
        for (int i = 0; i < 2; i++)
            for (int j = 0; j < 2; j++) share.m[i][j] += 0.5 * k * e[i] * q.X[j];
    }
    return share;
}

/* Eq. 14b. */
static double viscous_pressure(const struct twin_solid *t, const struct twin_solid_point *a,
                               const struct twin_solid_point *b)
{
    const double x = a->x - b->x, y = a->y - b->y;
    const double vx = (a->u - b->u) * x + (a->v - b->v) * y;
    if (vx >= 0) return 0;
    double mean = 0; /* of alpha c rho0 */
    for (int k = 0; k < 2; k++) {
        const struct scene_solid *const body = &t->body[k ? a->body : b->body];
        const double c = sqrt(body->young / (3 * (1 - 2 * body->poisson)) / body->density);
        mean += 0.5 * body->artificial_viscosity * c * body->density;
    }
    return mean * t->h * vx / (x * x + y * y + 0.01 * t->h * t->h);
}

/* J F^-T of a particle. */
static struct twin_mat cofactor(const struct twin_solid_point *a)
{
    const struct twin_mat FmT = transpose(inverse(a->F));
    return add((struct twin_mat){{{0}}}, det(a->F), FmT);
}

static void force_of_pair(const struct twin_solid *t, struct twin_solid_point *a,
                          const struct twin_solid_point *b, const struct reference *q)
{
    const struct scene_solid *const body = &t->body[a->body];
    const double V = t->dp * t->dp, Pi = viscous_pressure(t, a, b);
    struct twin_mat sum = add(mul(a->P, a->inverse_L), 1, mul(b->P, b->inverse_L));
    const struct twin_mat own = mul(cofactor(a), a->inverse_L);
    if (body->viscosity_form == VISCOSITY_SYMMETRIC)
        sum =
            add(sum, Pi,
                add(add((struct twin_mat){{{0}}}, 0.5, own), 0.5, mul(cofactor(b), b->inverse_L)));
    else
        sum = add(sum, Pi, own);
    const double x[2] = {a->x - b->x, a->y - b->y}, x2 = x[0] * x[0] + x[1] * x[1];
    double e[2], f[2];
    error_vector(a, b, q, e);
    const double k = spring(t, a, b, q), along = k * (e[0] * x[0] + e[1] * x[1]) / x2;
    const bool printed = body->hourglass_form == HOURGLASS_PRINTED;
    for (int i = 0; i < 2; i++) {
        f[i] = V * (sum.m[i][0] * q->gradient[0] + sum.m[i][1] * q->gradient[1]);
        a->size += fabs(f[i]) / body->density;
        const double hourglass = printed ? along * x[i] : k * e[i];
        a->size += fabs(hourglass) / body->density;
        f[i] += hourglass;
    }
    a->ax += f[0] / body->density;
    a->ay += f[1] / body->density;
}

/* --- contact of boxes that fit the lattice --- */

/* Whether a body has a particle at a place of its lattice. */
static bool has(const struct twin_solid *t, int body, double X, double Y)
{
    for (int64_t i = 0; i < t->n; i++)
        if (t->point[i].body == body && hypot(t->point[i].X - X, t->point[i].Y - Y) < 0.1 * t->dp)
            return true;
    return false;
}

/* Whether the line from a to its neighbour b is a piece of a surface: nothing beside both on one
 * side. */
static bool is_edge(const struct twin_solid *t, const struct twin_solid_point *a,
                    const struct twin_solid_point *b)
{
    const double x = b->X - a->X, y = b->Y - a->Y;
    if (a->body != b->body || fabs(hypot(x, y) / t->dp - 1) > 0.1) return false;
    for (int side = -1; side < 2; side += 2)
        if (!has(t, a->body, a->X - side * y, a->Y + side * x) &&
            !has(t, a->body, b->X - side * y, b->Y + side * x))
            return true;
    return false;
}

static bool at_surface(const struct twin_solid *t, const struct twin_solid_point *a)
{
    return !has(t, a->body, a->X + t->dp, a->Y) || !has(t, a->body, a->X - t->dp, a->Y) ||
           !has(t, a->body, a->X, a->Y + t->dp) || !has(t, a->body, a->X, a->Y - t->dp);
}

static void give(const struct twin_solid *t, struct twin_solid_point *a, double part,
                 const double f[2])
{
    const double mass = t->body[a->body].density * t->dp * t->dp;
    a->ax += part * f[0] / mass;
    a->ay += part * f[1] / mass;
    a->size += fabs(part) * hypot(f[0], f[1]) / mass;
}

/* What the other body does to a point: the sum of its normal forces; the edge nearest to it, of
 * equally near ones the last. */
struct press {
    double f[2], distance;
    struct twin_solid_point *a, *b;
};

/* What the place at the share s of the way from a to b does to p, times `sign`: half of k dp (dp/r
 * - 1) with k = stiffness 2 E_A E_B/(E_A + E_B), less the dashpot. */
static void touch(const struct twin_solid *t, struct twin_solid_point *p,
                  struct twin_solid_point *a, struct twin_solid_point *b, double s, double sign,
                  struct press *on)
{
    const struct scene_solid *const A = &t->body[p->body], *const B = &t->body[a->body];
    const double x = p->x - (1 - s) * a->x - s * b->x, y = p->y - (1 - s) * a->y - s * b->y;
    const double r = hypot(x, y), V = t->dp * t->dp;
    if (r >= t->dp) return;
    const double k = t->contact->stiffness * 2 / (1 / A->young + 1 / B->young);
    const double m = 1 / (1 / (A->density * V) + 1 / (B->density * V)), c = sqrt(k * m);
    const double u = p->u - (1 - s) * a->u - s * b->u, v = p->v - (1 - s) * a->v - s * b->v;
    const double speed = (u * x + v * y) / r;
    const double push =
        fmax(0, k * (t->dp * t->dp / r - t->dp) - 2 * t->contact->damping * c * speed);
    const double f[2] = {0.5 * sign * push * x / r, 0.5 * sign * push * y / r};
    give(t, p, 1, f);
    give(t, a, s - 1, f);
    give(t, b, -s, f);
    on->f[0] += f[0];
    on->f[1] += f[1];
    if (a != b && r <= on->distance) *on = (struct press){{on->f[0], on->f[1]}, r, a, b};
}

/* T-62 to T-62d where a point has no place yet: half of a dashpot across the sum of the normal
 * forces, at most Coulomb's friction. The edge moves, and bears the force, as if it reached to the
 * point. In complex numbers. */
static void rub(const struct twin_solid *t, struct twin_solid_point *p, const struct press *on)
{
    const struct scene_solid *const A = &t->body[p->body], *const B = &t->body[on->a->body];
    const double k = t->contact->stiffness * 2 / (1 / A->young + 1 / B->young), V = t->dp * t->dp;
    const double m = 1 / (1 / (A->density * V) + 1 / (B->density * V)), c = sqrt(k * m);
    const double complex i = (double complex)I;
    const double complex e = on->b->x - on->a->x + i * (on->b->y - on->a->y),
                         turn = on->b->u - on->a->u + i * (on->b->v - on->a->v),
                         at = (p->x - on->a->x + i * (p->y - on->a->y)) / e,
                         v = p->u - on->a->u + i * (p->v - on->a->v) - at * turn,
                         n = on->f[0] + i * on->f[1];
    const double complex across = v - n * creal(v * conj(n)) / creal(n * conj(n));
    double complex f = -0.5 * c * across;
    const double most = t->contact->friction * cabs(n);
    if (cabs(f) > most) f *= most / cabs(f);
    const double complex on_b = -conj(at) * f, on_a = -f - on_b;
    give(t, p, 1, (double[]){creal(f), cimag(f)});
    give(t, on->b, 1, (double[]){creal(on_b), cimag(on_b)});
    give(t, on->a, 1, (double[]){creal(on_a), cimag(on_a)});
}

/* T-61a: all edges of the other body, less the points where two of them meet. */
static void touch_surfaces(const struct twin_solid *t, struct twin_solid_point *p)
{
    if (!at_surface(t, p)) return;
    struct press on = {.distance = INFINITY};
    for (int64_t i = 0; i < t->n; i++) {
        struct twin_solid_point *const a = &t->point[i];
        if (bonded(t, p->body, a->body) || !at_surface(t, a)) continue;
        touch(t, p, a, a, 0, -1, &on);
        for (int64_t k = 0; k < i; k++) {
            struct twin_solid_point *const b = &t->point[k];
            if (!at_surface(t, b) || !is_edge(t, a, b)) continue;
            const double x = b->x - a->x, y = b->y - a->y;
            const double s = ((p->x - a->x) * x + (p->y - a->y) * y) / (x * x + y * y);
            touch(t, p, a, b, fmin(1, fmax(0, s)), 1, &on);
        }
    }
    if (on.a && hypot(on.f[0], on.f[1]) > 0) rub(t, p, &on);
}

void twin_solid_evaluate(struct twin_solid *t)
{
    for (int64_t i = 0; i < t->n; i++) deform(t, &t->point[i]);
    struct twin_mat *const share = calloc((size_t)t->n, sizeof *share);
    TEST_ASSERT_NOT_NULL(share);
    for (int64_t i = 0; i < t->n; i++)
        if (t->body[t->point[i].body].hourglass_form == HOURGLASS_VARIATIONAL)
            share[i] = hourglass_share(t, &t->point[i]);
    for (int64_t i = 0; i < t->n; i++) t->point[i].P = add(t->point[i].P, 1, share[i]);
    free(share);
    struct reference q;
    for (int64_t i = 0; i < t->n; i++)
        for (int64_t k = 0; k < t->n; k++)
            if (neighbours(t, &t->point[i], &t->point[k], &q))
                force_of_pair(t, &t->point[i], &t->point[k], &q);
    for (int64_t i = 0; i < t->n && t->contact; i++) touch_surfaces(t, &t->point[i]);
}
