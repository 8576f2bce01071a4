/* SPDX-License-Identifier: MIT
 * The solid's stable step, from the largest eigenvalues of its own operator. Eq. 29 of the paper knows
 * the speed of sound only; the hourglass springs are stiffer than the material and bound the step. */
#include <math.h>
#include <string.h>

#include "solid.h"

/* Numbers without a pattern that the operator could share, the same on every machine. */
static void scramble(double *v, int64_t n, uint64_t seed, const double *moves)
{
    for (int64_t i = 0; i < n; i++) {
        uint64_t z = (seed += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        v[i] = ((double)(z >> 11) * 0x1p-53 - 0.5) * moves[i];
    }
}

static double norm(const double *x, const double *y, int64_t n)
{
    double sum = 0;
    for (int64_t i = 0; i < n; i++) sum += x[i] * x[i] + y[i] * y[i];
    return sqrt(sum);
}

static void scale_to(double *x, double *y, const double *from_x, const double *from_y, int64_t n,
                     double factor)
{
    for (int64_t i = 0; i < n; i++) {
        x[i] = factor * from_x[i];
        y[i] = factor * from_y[i];
    }
}

/* Largest factor by which the acceleration of a field exceeds the field. The field is (x, y) of the
 * particles, displacement or velocity; `amplitude` keeps it in the linear range. Power iteration
 * approaches from below: 0.3 % are missing after so many rounds at kappa = 50; one percent is added. */
static double largest_factor(const struct solid *s, struct particles *p, double *x, double *y,
                             double amplitude, bool both_signs)
{
    enum { ROUNDS = 60 };
    scramble(x, p->n, 1, p->free);
    scramble(y, p->n, 2, p->free);
    double factor = 0;
    for (int round = 0; round < ROUNDS; round++) {
        const double size = norm(x, y, p->n);
        if (!(size > 0)) return 0;
        scale_to(x, y, x, y, p->n, amplitude / size);
        solid_stress(s, p);
        solid_forces(s, p);
        if (both_signs) {
            /* The viscous force acts on approaching pairs only: the other half of the pairs answers to
             * the opposite field. */
            scale_to(p->x0, p->y0, p->sx, p->sy, p->n, 1);
            scale_to(x, y, x, y, p->n, -1);
            solid_forces(s, p);
            for (int64_t i = 0; i < p->n; i++) {
                p->sx[i] -= p->x0[i];
                p->sy[i] -= p->y0[i];
            }
        }
        factor = norm(p->sx, p->sy, p->n) / amplitude;
        scale_to(x, y, p->sx, p->sy, p->n, 1);
    }
    return 1.01 * factor;
}

void solid_find_step(struct solid *s, struct particles *p)
{
    struct solid bare = *s;
    bare.coupled = false;
    struct solid_body saved[s->n_bodies];
    memcpy(saved, s->body, sizeof saved);
    double *const kept[4] = {p->vx0, p->vy0, p->ux, p->uy};
    scale_to(kept[0], kept[1], p->vx, p->vy, p->n, 1);
    for (int k = 0; k < s->n_bodies; k++) s->body[k].gravity[0] = s->body[k].gravity[1] = 0;

    memset(p->vx, 0, (size_t)p->n * sizeof *p->vx);
    memset(p->vy, 0, (size_t)p->n * sizeof *p->vy);
    s->omega_max = sqrt(largest_factor(&bare, p, p->ux, p->uy, 1e-6 * s->dp, false));
    memset(p->ux, 0, (size_t)p->n * sizeof *p->ux);
    memset(p->uy, 0, (size_t)p->n * sizeof *p->uy);
    s->damping_max = largest_factor(&bare, p, p->vx, p->vy, 1e-6 * s->dp, true);

    scale_to(p->vx, p->vy, kept[0], kept[1], p->n, 1);
    memcpy(s->body, saved, sizeof saved);
    /* An oscillation of frequency w, damped explicitly at the rate m, does not grow while
     * (w dt)^2 + 2 m dt < 4: just that for semi-implicit Euler, a little less than the limit for the
     * predictor-corrector (docs/theory.md). */
    const double w2 = square(s->omega_max), m = s->damping_max;
    s->stable_step = w2 > 0 ? (sqrt(m * m + 4 * w2) - m) / w2 : (double)INFINITY;
}
