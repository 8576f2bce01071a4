/* SPDX-License-Identifier: MIT
 * The solid's stable step, from the largest eigenvalues of its own operator. Eq. 29 of the paper
 * contains the speed of sound only; the hourglass springs are stiffer than the material and limit
 * the step. */
#include <math.h>
#include <string.h>

#include "solid/material.h"
#include "solid/solid.h"

/* Numbers without a pattern that the operator could have too; the same on every machine. */
static void scramble(double *v, int64_t n, uint64_t seed, const double *moves)
{
    for (int64_t i = 0; i < n; i++) {
        uint64_t z = (seed += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        v[i] = ((double)(z >> 11) * 0x1p-53 - 0.5) * moves[i];
    }
}

static double largest(const double *x, const double *y, int64_t n)
{
    double top = 0;
    for (int64_t i = 0; i < n; i++) top = max2(top, max2(fabs(x[i]), fabs(y[i])));
    return top;
}

static double norm(const double *x, const double *y, int64_t n)
{
    double sum = 0;
    for (int64_t i = 0; i < n; i++) sum += x[i] * x[i] + y[i] * y[i];
    return sqrt(sum);
}

/* Copies a field of both components. */
static void keep(double *const to[2], const double *x, const double *y, int64_t n)
{
    memcpy(to[0], x, (size_t)n * sizeof *x);
    memcpy(to[1], y, (size_t)n * sizeof *y);
}

/* field = base + scaled direction. */
static void set_field(double *const field[2], double *const base[2], const double *dx,
                      const double *dy, int64_t n, double factor)
{
    for (int64_t i = 0; i < n; i++) {
        field[0][i] = base[0][i] + factor * dx[i];
        field[1][i] = base[1][i] + factor * dy[i];
    }
}

/* Applies the operator to the field at its base plus the direction in (sx, sy), scaled to
 * `amplitude` at most. Stores the difference from its result at the base in (sx, sy). Returns the
 * factor by which that is larger. */
static double apply_operator(struct solid *s, struct particles *p, double *const field[2],
                             double *const base[2], double amplitude, bool both_signs)
{
    const double factor = amplitude / largest(p->sx, p->sy, p->n);
    const double asked = factor * norm(p->sx, p->sy, p->n);
    double *const other[2] = {p->x0, p->y0};
    const double *const rest[2] = {s->scratch[2], s->scratch[3]};
    if (both_signs) {
        /* The viscous force acts on approaching pairs only: the other half of the pairs responds to
         * the opposite field. */
        set_field(field, base, p->sx, p->sy, p->n, -factor);
        keep(other, p->sx, p->sy, p->n);
        solid_operator(s, p, false);
        set_field(field, base, other[0], other[1], p->n, factor);
        keep(other, p->sx, p->sy, p->n);
    } else {
        set_field(field, base, p->sx, p->sy, p->n, factor);
    }
    solid_operator(s, p, !both_signs);
    for (int64_t i = 0; i < p->n; i++) {
        p->sx[i] -= both_signs ? other[0][i] : rest[0][i];
        p->sy[i] -= both_signs ? other[1][i] : rest[1][i];
    }
    return norm(p->sx, p->sy, p->n) / asked;
}

/* Largest ratio of the operator's change to a small change of the field, displacement or velocity;
 * `amplitude` keeps it in the linear range. Power iteration approaches it from below: after so many
 * iterations 0.3 % are missing at kappa = 50; one percent is added. */
static double largest_factor(struct solid *s, struct particles *p, double *const field[2],
                             double *const base[2], double amplitude, bool both_signs)
{
    enum { ROUNDS = 60 };
    double factor = 0;
    scramble(p->sx, p->n, 1, p->free);
    scramble(p->sy, p->n, 2, p->free);
    for (int round = 0; round < ROUNDS; round++) {
        if (!(largest(p->sx, p->sy, p->n) > 0)) return 0;
        factor = apply_operator(s, p, field, base, amplitude, both_signs);
    }
    return 1.01 * factor;
}

/* An oscillation of angular frequency omega, damped explicitly at the rate gamma, does not grow
 * while (omega dt)^2 + 2 gamma dt < 4: just that for semi-implicit Euler, a little less than the
 * limit for the predictor-corrector (docs/theory.md). */
double solid_step_of(double omega2, double damping)
{
    if (!(omega2 > 0)) return (double)INFINITY;
    return (sqrt(damping * damping + 4 * omega2) - damping) / omega2;
}

double solid_stable_step(struct solid *s, struct particles *p, double *omega, double *damping)
{
    double *const rates[2] = {s->scratch[4], s->scratch[5]};
    keep(rates, p->sx, p->sy, p->n);
    const size_t bytes = (size_t)p->n * sizeof *p->vx;
    double *const u[2] = {p->ux, p->uy}, *const v[2] = {p->vx, p->vy};
    double *const base[2] = {s->scratch[0], s->scratch[1]};
    double *const rest[2] = {s->scratch[2], s->scratch[3]};
    double *const kept[2] = {p->vx0, p->vy0};
    /* At a base strain of 1 the rounding error of float is a thousandth of the change; velocities
     * have the same amplitude. */
    const double amplitude = (s->sweeps->size < sizeof(double) ? 1e-4 : 1e-6) * s->dp;
    keep(kept, p->vx, p->vy, p->n);
    memset(p->vx, 0, bytes);
    memset(p->vy, 0, bytes);
    solid_operator(s, p, true);
    keep(rest, p->sx, p->sy, p->n);
    keep(base, p->ux, p->uy, p->n);
    *omega = sqrt(largest_factor(s, p, u, base, amplitude, false));
    keep(u, base[0], base[1], p->n);
    memset(base[0], 0, bytes);
    memset(base[1], 0, bytes);
    *damping = 0;
    bool damped = false;
    double rate = 0; /* of mass damping */
    for (int k = 0; k < s->n_bodies; k++) {
        damped |= s->body[k].viscosity + s->body[k].damping_time > 0;
        rate = max2(rate, s->body[k].mass_damping);
    }
    /* Linear damping acts on both signs: half of it on each. */
    for (int k = 0; k < s->n_bodies; k++) s->body[k].damping_time *= 0.5;
    if (damped) {
        solid_operator(s, p, true);
        *damping = largest_factor(s, p, v, base, amplitude * *omega, true);
    }
    for (int k = 0; k < s->n_bodies; k++) s->body[k].damping_time *= 2;
    *damping += rate;
    keep(v, kept[0], kept[1], p->n);
    /* Later readers get the fields of the body, not of a trial. */
    solid_stress(s, p);
    keep((double *[2]){p->sx, p->sy}, rates[0], rates[1], p->n);
    /* The eigenvalues of a sum of two operators are at most the sum of the largest of each. */
    return solid_step_of(square(*omega), *damping);
}

void solid_find_step(struct solid *s, struct particles *p)
{
    s->stable_step = solid_stable_step(s, p, &s->omega_max, &s->damping_max);
}

static vdouble larger(vdouble a, vdouble b) { return -vmin_double(-a, -b); }

/* The larger of dP_11/dF_11 and dP_22/dF_22 in the principal axes, the stiffness of an axial wave,
 * Pa. From the stretches only, since the laws are isotropic. */
static vdouble axial_stiffness(const struct solid_body *b, vdouble first, vdouble second)
{
    const double delta = 1e-5;
    const vdouble zero = vset_double(0);
    const struct vtensor2 U = {first - 1.0, zero, zero, second - 1.0};
    struct vtensor2 along = U, across = U;
    along.xx = along.xx + delta;
    across.yy = across.yy + delta;
    const struct vtensor2 P = material_pk1(b, U);
    return larger(material_pk1(b, along).xx - P.xx, material_pk1(b, across).yy - P.yy) / delta;
}

/* Principal stretches of LANES particles from i on. `beyond`: which of the first n are stretched or
 * compressed by some 5 %; returns whether one is. */
static bool stretches(const struct particles *p, int64_t i, int n, vdouble *first, vdouble *second,
                      bool beyond[LANES])
{
    const struct vtensor2 F =
        deformation((struct vtensor2){vload_double(&p->Uxx[i]), vload_double(&p->Uxy[i]),
                                      vload_double(&p->Uyx[i]), vload_double(&p->Uyy[i])});
    const vdouble det = vtensor2_det(F);
    const vdouble trace = F.xx * F.xx + F.xy * F.xy + F.yx * F.yx + F.yy * F.yy;
    bool any = false;
    for (int l = 0; l < n; l++)
        any |= beyond[l] = !(trace[l] < 2.1 && trace[l] < 2.1 * det[l] * det[l]);
    if (!any) return false;
    const vdouble sum = vsqrt_double(larger(trace + 2.0 * det, vset_double(0)));
    const vdouble difference = vsqrt_double(larger(trace - 2.0 * det, vset_double(0)));
    *first = 0.5 * (sum + difference);
    *second = 0.5 * (sum - difference);
    return true;
}

/* The largest of the axial stiffnesses in a pack. Each particle counts by itself: who shares its
 * vector depends on the machine. */
static double stiffest(const struct solid *s, const struct particles *p,
                       const struct solid_pack *pack)
{
    double top = 0;
    for (int from = 0; from < pack->lanes; from += LANES) {
        const int n = pack->lanes - from < LANES ? pack->lanes - from : LANES;
        vdouble first, second;
        bool beyond[LANES];
        if (!stretches(p, pack->i + from, n, &first, &second, beyond)) continue;
        const vdouble now = axial_stiffness(&s->body[pack->body], first, second);
        for (int l = 0; l < n; l++)
            if (beyond[l]) top = max2(top, now[l]);
    }
    return top;
}

double solid_stiffening(const struct solid *s, const struct particles *p)
{
    double top = 1;
    double reference[s->n_bodies];
    for (int k = 0; k < s->n_bodies; k++)
        reference[k] = axial_stiffness(&s->body[k], vset_double(1), vset_double(1))[0];
#pragma omp parallel for schedule(static) num_threads(s->threads) reduction(max : top)
    for (int64_t k = 0; k < s->n_packs; k++)
        /* cppcheck-suppress uninitvar ; all of its items are set above */
        top = max2(top, stiffest(s, p, &s->pack[k]) / reference[s->pack[k].body]);
    return top;
}
