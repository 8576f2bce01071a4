/* SPDX-License-Identifier: MIT
 * The solid's stable step, from the largest eigenvalues of its own operator. Eq. 29 of the article
 * contains the speed of sound only; the hourglass springs are stiffer than the material and limit
 * the step. */
#include "solid/material.h"

/* Numbers without a pattern that the operator could have too; the same on every machine. */
static void fill_random(double *v, int64_t n, uint64_t seed, const double *moves)
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
    double largest = 0;
    for (int64_t i = 0; i < n; i++) largest = max2(largest, max2(fabs(x[i]), fabs(y[i])));
    return largest;
}

static double norm(const double *x, const double *y, int64_t n)
{
    double sum = 0;
    for (int64_t i = 0; i < n; i++) sum += x[i] * x[i] + y[i] * y[i];
    return sqrt(sum);
}

/* Copies a field of both components. */
static void keep(double *const to[2], double *const from[2], int64_t n)
{
    for (int c = 0; c < 2; c++) memcpy(to[c], from[c], (size_t)n * sizeof *to[c]);
}

static void clear(double *const field[2], int64_t n)
{
    for (int c = 0; c < 2; c++) memset(field[c], 0, (size_t)n * sizeof *field[c]);
}

/* A field, displacement or velocity, that varies about its base; the operator's result there. */
struct variation {
    double *field[2], *base[2], *rest[2];
    double amplitude; /* keeps it in the linear range */
    bool both_signs;
};

/* The operator where the field is its base plus a scaled direction; its result to (sx, sy). */
static void operator_at(struct solid *solid, struct particles *particles, const struct variation *v,
                        double *const direction[2], double factor)
{
    for (int c = 0; c < 2; c++)
        for (int64_t i = 0; i < particles->n; i++)
            v->field[c][i] = v->base[c][i] + factor * direction[c][i];
    solid_pair_forces(solid, particles, !v->both_signs);
}

/* Applies the operator to the field at its base plus the direction in (sx, sy), scaled to the
 * amplitude at most. Stores the difference from its result at the base in (sx, sy). Returns the
 * factor by which that is larger. The viscous force acts on approaching pairs only: the other half
 * of the pairs responds to the opposite field. */
static double apply_operator(struct solid *solid, struct particles *particles,
                             const struct variation *v)
{
    const int64_t n = particles->n;
    double *const s[2] = {particles->sx, particles->sy};
    double *const direction[2] = {particles->ux0, particles->uy0};
    const double factor = v->amplitude / largest(s[0], s[1], n);
    const double asked = factor * norm(s[0], s[1], n);
    keep(direction, s, n);
    if (v->both_signs) {
        operator_at(solid, particles, v, direction, -factor);
        keep(v->rest, s, n);
    }
    operator_at(solid, particles, v, direction, factor);
    for (int c = 0; c < 2; c++)
        for (int64_t i = 0; i < n; i++) s[c][i] -= v->rest[c][i];
    return norm(s[0], s[1], n) / asked;
}

/* Largest ratio of the operator's change to a small change of the field. Power iteration approaches
 * it from below: after so many iterations 0.3 % are missing at kappa = 50; one percent is added. */
static double largest_factor(struct solid *solid, struct particles *particles,
                             const struct variation *v)
{
    enum { ROUNDS = 60 };
    double factor = 0;
    fill_random(particles->sx, particles->n, 1, particles->free);
    fill_random(particles->sy, particles->n, 2, particles->free);
    for (int round = 0; round < ROUNDS; round++) {
        if (!(largest(particles->sx, particles->sy, particles->n) > 0)) return 0;
        factor = apply_operator(solid, particles, v);
    }
    return 1.01 * factor;
}

/* An oscillation of angular frequency omega, damped explicitly at the rate gamma, does not grow
 * while (omega dt)^2 + 2 gamma dt < 4: just that for semi-implicit Euler, a little less than the
 * limit for the predictor-corrector (docs/theory.md). */
double solid_step_of(double omega2, double damping)
{
    if (!(omega2 > 0)) return damping > 0 ? 2 / damping : (double)INFINITY;
    return (sqrt(damping * damping + 4 * omega2) - damping) / omega2;
}

double solid_stable_step(struct solid *solid, struct particles *particles, double *omega,
                         double *damping)
{
    const int64_t n = particles->n;
    double *const *const scratch = solid->scratch;
    double *const s[2] = {particles->sx, particles->sy}, *const rates[2] = {scratch[4], scratch[5]},
                  *const kept[2] = {particles->vx0, particles->vy0};
    struct variation u = {.field = {particles->ux, particles->uy},
                          .base = {scratch[0], scratch[1]},
                          .rest = {scratch[2], scratch[3]}},
                     v = u;
    /* At a base strain of 1 float rounds by a thousandth of the change; velocities are as large. */
    u.amplitude = (solid->sweeps->size < sizeof(double) ? 1e-4 : 1e-6) * solid->dp;
    v.field[0] = particles->vx;
    v.field[1] = particles->vy;
    v.both_signs = true;
    keep(rates, s, n);
    keep(kept, v.field, n);
    clear(v.field, n);
    solid_pair_forces(solid, particles, true);
    keep(u.rest, s, n);
    keep(u.base, u.field, n);
    *omega = sqrt(largest_factor(solid, particles, &u));
    keep(u.field, u.base, n);
    clear(v.base, n);
    *damping = 0;
    bool damped = false;
    double rate = 0; /* of mass damping */
    for (int k = 0; k < solid->n_bodies; k++) {
        damped |= solid->body[k].viscosity + solid->body[k].damping_time > 0;
        rate = max2(rate, solid->body[k].mass_damping);
        solid->body[k].damping_time *= 0.5; /* linear: it acts on both signs, half of it on each */
    }
    if (damped) {
        solid_pair_forces(solid, particles, true);
        v.amplitude = u.amplitude * *omega;
        *damping = largest_factor(solid, particles, &v);
    }
    for (int k = 0; k < solid->n_bodies; k++) solid->body[k].damping_time *= 2;
    *damping += rate;
    keep(v.field, kept, n);
    /* Later readers get the fields of the body, not of a trial. */
    solid_stress(solid, particles);
    keep(s, rates, n);
    /* The eigenvalues of a sum of two operators are at most the sum of the largest of each. */
    return solid_step_of(square(*omega), *damping);
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

/* The largest of the axial stiffnesses in a pack, of particles that are stretched or compressed by
 * some 5 %. Each counts by itself: who shares its vector depends on the machine. */
static double stiffest(const struct solid *solid, const struct particles *particles,
                       const struct solid_pack *pack)
{
    double largest = 0;
    for (int from = 0; from < pack->lanes; from += LANES) {
        const int64_t i = pack->i + from;
        const int n = pack->lanes - from < LANES ? pack->lanes - from : LANES;
        const struct vtensor2 F = deformation(
            (struct vtensor2){vload_double(&particles->Uxx[i]), vload_double(&particles->Uxy[i]),
                              vload_double(&particles->Uyx[i]), vload_double(&particles->Uyy[i])});
        const vdouble det = vtensor2_det(F);
        const vdouble trace = F.xx * F.xx + F.xy * F.xy + F.yx * F.yx + F.yy * F.yy;
        bool beyond[LANES], any = false;
        for (int l = 0; l < n; l++)
            any |= beyond[l] = !(trace[l] < 2.1 && trace[l] < 2.1 * det[l] * det[l]);
        if (!any) continue;
        /* The sum and the difference of the principal stretches. */
        const vdouble sum = vsqrt_double(larger(trace + 2.0 * det, vset_double(0)));
        const vdouble difference = vsqrt_double(larger(trace - 2.0 * det, vset_double(0)));
        const vdouble now = axial_stiffness(&solid->body[pack->body], 0.5 * (sum + difference),
                                            0.5 * (sum - difference));
        for (int l = 0; l < n; l++)
            if (beyond[l]) largest = max2(largest, now[l]);
    }
    return largest;
}

double solid_stiffening(const struct solid *solid, const struct particles *particles)
{
    double largest = 1;
    double reference[solid->n_bodies];
    for (int k = 0; k < solid->n_bodies; k++)
        reference[k] = axial_stiffness(&solid->body[k], vset_double(1), vset_double(1))[0];
#pragma omp parallel for schedule(static) num_threads(solid->threads) reduction(max : largest)
    for (int64_t k = 0; k < solid->n_packs; k++)
        /* cppcheck-suppress uninitvar ; all of its items are set above */
        largest = max2(largest, stiffest(solid, particles, &solid->pack[k]) /
                                    reference[solid->pack[k].body]);
    return largest;
}
