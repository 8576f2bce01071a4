/* SPDX-License-Identifier: MIT
 * One inline function for each law between two particles of the solid, over a pack of pairs. */
#ifndef SPHFSI_SOLID_FX_H
#define SPHFSI_SOLID_FX_H

#include "material.h"
#include "solid.h"

SPHFSI_INLINE struct vtensor2 load_gradient(const struct particles *p, int64_t i)
{
    return (struct vtensor2){vload_double(&p->Uxx[i]), vload_double(&p->Uxy[i]),
                             vload_double(&p->Uyx[i]), vload_double(&p->Uyy[i])};
}

/* Particles a of a pack, as the pair laws see them. */
struct solid_receiver {
    vdouble ux, uy, vx, vy;
    struct vtensor2 U;
};

SPHFSI_INLINE struct solid_receiver receiver_of(const struct particles *p, int64_t i)
{
    return (struct solid_receiver){vload_double(&p->ux[i]), vload_double(&p->uy[i]),
                                   vload_double(&p->vx[i]), vload_double(&p->vy[i]),
                                   load_gradient(p, i)};
}

/* One slot's pairs: neighbours b and geometry. */
struct solid_pair {
    const struct solid_slot *slot;
    int64_t j;
    vdouble X, Y, x, y; /* x_ab = X_ab + u_ab */
    vdouble ux, uy;     /* u_ab */
    struct vtensor2 U_b;
};

SPHFSI_INLINE struct solid_pair pair_of(const struct solid_slot *slot, const struct particles *p,
                                        int64_t i, const struct solid_receiver *a)
{
    struct solid_pair q = {.slot = slot, .j = i + slot->offset};
    q.X = vload_double(slot->X);
    q.Y = vload_double(slot->Y);
    q.ux = a->ux - vload_double(&p->ux[q.j]);
    q.uy = a->uy - vload_double(&p->uy[q.j]);
    q.x = q.X + q.ux;
    q.y = q.Y + q.uy;
    return q;
}

/* What a pack sums over its slots. */
struct solid_sums {
    vdouble stress_x, stress_y;   /* Pa/m */
    vdouble viscous_x, viscous_y; /* of Pi_ab G_ab, still to be turned by J F^-T of a */
    vdouble turned_x, turned_y;   /* of Pi_ab (J F^-T)_b H_ab, in the symmetric form */
    vdouble ax, ay;               /* m/s^2 */
    struct vtensor2 pull;         /* of k_ab e_ab X_ab^T, in the variational form, m^2/s^2 */
};

/* Eq. 13a, the neighbours' part: P_b L_b^-1 V_b grad_0 W. */
SPHFSI_INLINE void stress_force(const struct solid_slot *slot, const struct particles *p, int64_t j,
                                struct solid_sums *s)
{
    const vdouble Hx = vload_double(slot->Hx), Hy = vload_double(slot->Hy);
    s->stress_x = vfma_double(vload_double(&p->Pxx[j]), Hx, s->stress_x);
    s->stress_x = vfma_double(vload_double(&p->Pxy[j]), Hy, s->stress_x);
    s->stress_y = vfma_double(vload_double(&p->Pyx[j]), Hx, s->stress_y);
    s->stress_y = vfma_double(vload_double(&p->Pyy[j]), Hy, s->stress_y);
}

/* Eq. 14b over rho0 alpha_s c_s h, for approaching pairs: v.x/(x^2 + 0.01 h^2), 1/s. */
SPHFSI_INLINE vdouble viscous_pressure(const struct solid_pair *q, const struct particles *p,
                                       const struct solid_receiver *a, vdouble eta2)
{
    const vdouble vx = a->vx - vload_double(&p->vx[q->j]), vy = a->vy - vload_double(&p->vy[q->j]);
    const vdouble approach = vmin_double(vfma_double(vx, q->x, vy * q->y), vset_double(0));
    return approach / vfma_double(q->x, q->x, vfma_double(q->y, q->y, eta2));
}

/* Of joined bodies: the mean of both particles' rho0 alpha_s c_s h, over the density of a, so that the
 * pair's Pi is one number. */
SPHFSI_INLINE vdouble mean_viscosity(const struct solid_pair *q, const struct particles *p,
                                     int64_t i, const struct solid_body *body)
{
    return (vload_double(&p->drag[i]) + vload_double(&p->drag[q->j])) * (0.5 / body->density);
}

/* Eqs. 14a and 13a as printed: Pi_ab (J F^-T)_a G_ab. The symmetric form, half of it and half of the same
 * with the tensor and the gradient of b, is antisymmetric. */
SPHFSI_INLINE void viscous_force(const struct solid_pair *q, vdouble Pi, bool symmetric,
                                 struct solid_sums *s)
{
    if (symmetric) {
        const vdouble Hx = vload_double(q->slot->Hx), Hy = vload_double(q->slot->Hy);
        const struct vtensor2 *const U = &q->U_b;
        /* The cofactor of I + U times H. */
        const vdouble x = vfma_double(-U->yx, Hy, vfma_double(U->yy, Hx, Hx));
        const vdouble y = vfma_double(-U->xy, Hx, vfma_double(U->xx, Hy, Hy));
        s->turned_x = vfma_double(Pi, x, s->turned_x);
        s->turned_y = vfma_double(Pi, y, s->turned_y);
    }
    s->viscous_x = vfma_double(Pi, vload_double(q->slot->Gx), s->viscous_x);
    s->viscous_y = vfma_double(Pi, vload_double(q->slot->Gy), s->viscous_y);
}

/* Eqs. 15-16: twice e_ab = (F_a + F_b) X_ab/2 - x_ab, in displacements. */
SPHFSI_INLINE void hourglass_error(const struct solid_pair *q, const struct solid_receiver *a,
                                   vdouble *ex, vdouble *ey)
{
    const struct vtensor2 F = {a->U.xx + q->U_b.xx, a->U.xy + q->U_b.xy, a->U.yx + q->U_b.yx,
                               a->U.yy + q->U_b.yy};
    *ex = vfma_double(F.xx, q->X, vfma_double(F.xy, q->Y, -(q->ux + q->ux)));
    *ey = vfma_double(F.yx, q->X, vfma_double(F.yy, q->Y, -(q->uy + q->uy)));
}

/* With the energy E = sum over pairs of k_ab |e_ab|^2/2, k_ab = kappa E_ab V_a V_b W_0ab/X_ab^2 as in Eq. 17:
 * over the mass of a the sum of k_ab e_ab is -dE/du_a, opposite to the bit for b; and as e_ab depends on F_a
 * too, dE/dF_a/V_a, the sum of k_ab e_ab X_ab^T/(2 V_a), adds to P_a. */
SPHFSI_INLINE void hourglass_variational(const struct solid_pair *q, const struct solid_receiver *a,
                                         struct solid_sums *s)
{
    vdouble ex, ey;
    hourglass_error(q, a, &ex, &ey);
    const vdouble half_k = vload_double(q->slot->half_k);
    ex = ex * half_k;
    ey = ey * half_k;
    s->ax = s->ax + ex;
    s->ay = s->ay + ey;
    s->pull.xx = vfma_double(ex, q->X, s->pull.xx);
    s->pull.xy = vfma_double(ex, q->Y, s->pull.xy);
    s->pull.yx = vfma_double(ey, q->X, s->pull.yx);
    s->pull.yy = vfma_double(ey, q->Y, s->pull.yy);
}

/* Over the mass of a: Eq. 17 as printed, a force along x_ab. */
SPHFSI_INLINE void hourglass_printed(const struct solid_pair *q, const struct solid_receiver *a,
                                     struct solid_sums *s)
{
    vdouble ex, ey;
    hourglass_error(q, a, &ex, &ey);
    const vdouble along = vload_double(q->slot->half_k) * vfma_double(ex, q->x, ey * q->y) /
                          vfma_double(q->x, q->x, q->y * q->y);
    s->ax = vfma_double(along, q->x, s->ax);
    s->ay = vfma_double(along, q->y, s->ay);
}

#endif
