/* SPDX-License-Identifier: MIT
 * One inline function for each law between two particles of the solid, for a pack of pairs.
 * Included by the sweeps (solid/sweep.h), once for each precision. */
#pragma once

#include "solid/material.h"

/* A packed field of the particles from i on; a weight of a slot. */
#define packed_of(s, number, i) vload((const real *)(s)->packed[number] + (i))
#define weight_of(slot, weight) vload((slot) + (weight)*LANES)

/* Displacements are in two parts where real is float. */
/* NOLINTNEXTLINE(misc-redundant-expression): compiled for both precisions */
enum { SPLIT = sizeof(real) < sizeof(double) };

SPHFSI_INLINE struct vtensor2 load_gradient(const struct solid *solid, int64_t i)
{
    return (struct vtensor2){packed_of(solid, S_UXX, i), packed_of(solid, S_UXY, i),
                             packed_of(solid, S_UYX, i), packed_of(solid, S_UYY, i)};
}

struct vvector2 {
    vreal x, y;
};

/* Displacements of the particles from i on, and differences from others to these. */
struct placed {
    struct vvector2 u, low;
};

SPHFSI_INLINE struct placed placed_at(const struct solid *solid, int64_t i)
{
    struct placed at = {.u = {packed_of(solid, S_UX, i), packed_of(solid, S_UY, i)}};
    if (SPLIT)
        at.low = (struct vvector2){packed_of(solid, S_LOW_X, i), packed_of(solid, S_LOW_Y, i)};
    return at;
}

/* u_ab: both parts are subtracted separately, since neighbours have equal leading digits. */
SPHFSI_INLINE struct vvector2 displacement_between(const struct solid *solid,
                                                   const struct placed *a, int64_t j)
{
    const struct placed b = placed_at(solid, j);
    if (!SPLIT) return (struct vvector2){a->u.x - b.u.x, a->u.y - b.u.y};
    return (struct vvector2){(a->u.x - b.u.x) + (a->low.x - b.low.x),
                             (a->u.y - b.u.y) + (a->low.y - b.low.y)};
}

/* v_ab. */
SPHFSI_INLINE struct vvector2 velocity_between(const struct solid *solid, struct vvector2 a,
                                               int64_t j)
{
    return (struct vvector2){a.x - packed_of(solid, S_VX, j), a.y - packed_of(solid, S_VY, j)};
}

/* Particles a of a pack: what the pair laws use. */
struct solid_receiver {
    struct placed at;
    struct vvector2 v;
    struct vtensor2 U;
};

SPHFSI_INLINE struct solid_receiver receiver_of(const struct solid *solid, int64_t i)
{
    return (struct solid_receiver){placed_at(solid, i),
                                   {packed_of(solid, S_VX, i), packed_of(solid, S_VY, i)},
                                   load_gradient(solid, i)};
}

/* One slot's pairs: neighbours b and geometry. */
struct solid_pair {
    const real *slot;
    int64_t j;
    vreal X, Y, x, y;  /* x_ab = X_ab + u_ab */
    struct vvector2 u; /* u_ab */
    struct vtensor2 U_b;
};

SPHFSI_INLINE struct solid_pair pair_of(const struct solid *solid, const real *slot, int64_t j,
                                        const struct solid_receiver *a)
{
    struct solid_pair q = {.slot = slot, .j = j};
    q.X = weight_of(slot, W_X);
    q.Y = weight_of(slot, W_Y);
    vhold(q.X);
    vhold(q.Y);
    q.u = displacement_between(solid, &a->at, j);
    q.x = q.X + q.u.x;
    q.y = q.Y + q.u.y;
    return q;
}

/* Sums of a pack over its slots. */
struct solid_sums {
    vreal stress_x, stress_y;   /* Pa/m */
    vreal viscous_x, viscous_y; /* of Pi_ab G_ab, still to be multiplied by J F^-T of a */
    vreal turned_x, turned_y;   /* of Pi_ab (J F^-T)_b H_ab, in the symmetric form */
    vreal ax, ay;               /* m/s^2 */
    struct vtensor2 pull;       /* of k_ab e_ab X_ab^T, in the variational form, m^2/s^2 */
};

/* Eq. 13a, the neighbours' part: P_b L_b^-1 V_b grad_0 W. */
SPHFSI_INLINE void stress_force(const struct solid *solid, const real *slot, int64_t j,
                                struct solid_sums *sums)
{
    const vreal Hx = weight_of(slot, W_HX), Hy = weight_of(slot, W_HY);
    sums->stress_x = vfma(packed_of(solid, S_PXX, j), Hx, sums->stress_x);
    sums->stress_x = vfma(packed_of(solid, S_PXY, j), Hy, sums->stress_x);
    sums->stress_y = vfma(packed_of(solid, S_PYX, j), Hx, sums->stress_y);
    sums->stress_y = vfma(packed_of(solid, S_PYY, j), Hy, sums->stress_y);
}

/* Eq. 14b over rho0 alpha_s c_s h, for approaching pairs: v.x/(x^2 + 0.01 h^2), 1/s. */
SPHFSI_INLINE vreal viscous_pressure(const struct solid *solid, const struct solid_pair *q,
                                     const struct solid_receiver *a, vreal eta2)
{
    const struct vvector2 v = velocity_between(solid, a->v, q->j);
    const vreal approach = vmin(vfma(v.x, q->x, v.y * q->y), vset(0));
    return approach / vfma(q->x, q->x, vfma(q->y, q->y, eta2));
}

/* For joined bodies: the mean of both particles' rho0 alpha_s c_s h, over the density of a, so that
 * Pi is the same for both particles. */
SPHFSI_INLINE vreal mean_viscosity(const struct solid *solid, int64_t i, int64_t j,
                                   const struct solid_body *body)
{
    const vreal viscosity = packed_of(solid, S_VISCOSITY, i) + packed_of(solid, S_VISCOSITY, j);
    return viscosity * (real)(0.5 / body->density);
}

/* Eqs. 14a and 13a as printed: Pi_ab (J F^-T)_a G_ab. The symmetric form, half of it and half of
 * the same with the tensor and the gradient of b, is antisymmetric. */
SPHFSI_INLINE void viscous_force(const struct solid_pair *q, vreal Pi, bool symmetric,
                                 struct solid_sums *s)
{
    if (symmetric) {
        vreal Hx = weight_of(q->slot, W_HX), Hy = weight_of(q->slot, W_HY);
        vhold(Hx);
        vhold(Hy);
        const struct vtensor2 *const U = &q->U_b;
        /* The cofactor of I + U times H. */
        const vreal x = vfma(-U->yx, Hy, vfma(U->yy, Hx, Hx));
        const vreal y = vfma(-U->xy, Hx, vfma(U->xx, Hy, Hy));
        s->turned_x = vfma(Pi, x, s->turned_x);
        s->turned_y = vfma(Pi, y, s->turned_y);
    }
    s->viscous_x = vfma(Pi, weight_of(q->slot, W_GX), s->viscous_x);
    s->viscous_y = vfma(Pi, weight_of(q->slot, W_GY), s->viscous_y);
}

/* Eqs. 15-16: twice e_ab = (F_a + F_b) X_ab/2 - x_ab, in displacements. */
SPHFSI_INLINE void hourglass_error(const struct solid_pair *q, const struct solid_receiver *a,
                                   vreal *ex, vreal *ey)
{
    const struct vtensor2 F = {a->U.xx + q->U_b.xx, a->U.xy + q->U_b.xy, a->U.yx + q->U_b.yx,
                               a->U.yy + q->U_b.yy};
    *ex = vfma(F.xx, q->X, vfma(F.xy, q->Y, -(q->u.x + q->u.x)));
    *ey = vfma(F.yx, q->X, vfma(F.yy, q->Y, -(q->u.y + q->u.y)));
}

/* The energy E is the sum over pairs of k_ab |e_ab|^2/2 (T-28). The sum of k_ab e_ab over the mass
 * of a is -dE/du_a, opposite to the bit for b. Since e_ab depends on F_a too, P_a gains
 * dE/dF_a/V_a, the sum of k_ab e_ab X_ab^T/(2 V_a). */
SPHFSI_INLINE void hourglass_variational(const struct solid_pair *q, const struct solid_receiver *a,
                                         struct solid_sums *s)
{
    vreal ex, ey;
    hourglass_error(q, a, &ex, &ey);
    vreal half_k = weight_of(q->slot, W_HALF_K);
    vhold(half_k);
    ex = ex * half_k;
    ey = ey * half_k;
    s->ax = s->ax + ex;
    s->ay = s->ay + ey;
    s->pull.xx = vfma(ex, q->X, s->pull.xx);
    s->pull.xy = vfma(ex, q->Y, s->pull.xy);
    s->pull.yx = vfma(ey, q->X, s->pull.yx);
    s->pull.yy = vfma(ey, q->Y, s->pull.yy);
}

/* Over the mass of a: Eq. 17 as printed, a force along x_ab. */
SPHFSI_INLINE void hourglass_printed(const struct solid_pair *q, const struct solid_receiver *a,
                                     struct solid_sums *s)
{
    vreal ex, ey;
    hourglass_error(q, a, &ex, &ey);
    const vreal along =
        weight_of(q->slot, W_HALF_K) * vfma(ex, q->x, ey * q->y) / vfma(q->x, q->x, q->y * q->y);
    s->ax = vfma(along, q->x, s->ax);
    s->ay = vfma(along, q->y, s->ay);
}
