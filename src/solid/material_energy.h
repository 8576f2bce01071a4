/* SPDX-License-Identifier: MIT
 * Parts of the stress laws that only output needs: stored energy, and the state across the plane.
 * In double. */
#ifndef SPHFSI_SOLID_MATERIAL_ENERGY_H
#define SPHFSI_SOLID_MATERIAL_ENERGY_H

#include <math.h>

#include "base/real_double.h"
#include "base/elementary.h"

#include "solid/material.h"

/* The right stretch of F = R S, less the identity: (F^T F)^(1/2) - I in closed form, without
 * cancellation (Hoger and Carlson 1984). */
SPHFSI_INLINE struct vtensor2 right_stretch(struct vtensor2 U)
{
    const struct vtensor2 E = green_lagrange(U);
    const vdouble J = vtensor2_det(deformation(U));
    /* S = (C + J I)/trace S, with (trace S)^2 = trace C + 2 J. */
    const vdouble sum = vsqrt_double(2.0 * (E.xx + E.yy + 1.0 + J)), per_sum = 1.0 / sum;
    /* 1 + J - trace S. */
    const vdouble excess = 4.0 * (E.xx * E.yy - E.xy * E.yx) / (1.0 + J + sum);
    return (struct vtensor2){(2.0 * E.xx + excess) * per_sum, 2.0 * E.xy * per_sum,
                             2.0 * E.yx * per_sum, (2.0 * E.yy + excess) * per_sum};
}

/* T-41a: the work of the paper's law, which has no potential, on the straight path from rest to the
 * right stretch: the integral of P : dS by four points of Gauss. */
SPHFSI_INLINE vdouble straight_work(const struct solid_body *b, struct vtensor2 U)
{
    static const double at[] = {0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                0.93056815579702629},
                        weight[] = {0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
                                    0.17392742256872693};
    const struct vtensor2 S = right_stretch(U);
    vdouble work = vset_double(0);
    for (int k = 0; k < 4; k++) {
        const struct vtensor2 P = material_pk1(b, (struct vtensor2){S.xx * at[k], S.xy * at[k],
                                                                    S.yx * at[k], S.yy * at[k]});
        work = work + (P.xx * S.xx + P.xy * S.xy + P.yx * S.yx + P.yy * S.yy) * weight[k];
    }
    return work;
}

/* Strain energy per reference volume, J/m^3. */
SPHFSI_INLINE vdouble material_energy(const struct solid_body *b, struct vtensor2 U)
{
    const struct vtensor2 E = green_lagrange(U);
    if (b->law == LAW_NEO_HOOKEAN) {
        const vdouble J = vtensor2_det(deformation(U));
        vdouble W = J;
        for (int l = 0; l < LANES_DOUBLE; l++) {
            const double t2 = b->plane == PLANE_STRESS
                                  ? (2 * b->mu + b->lambda) / (2 * b->mu + b->lambda * square(J[l]))
                                  : 1;
            const double J2 = square(J[l]) * t2, invariant = 2 * (E.xx[l] + E.yy[l]) + t2 - 1;
            W[l] = (0.5 * b->mu * (invariant - elementary_log(J2)) +
                    0.25 * b->lambda * (J2 - 1 - elementary_log(J2)));
        }
        return W;
    }
    if (b->law == LAW_PAPER) return straight_work(b, U);
    const struct vtensor2 S = hooke(E, plane_lambda(b), b->mu);
    return (S.xx * E.xx + S.yy * E.yy + S.xy * E.xy + S.yx * E.yx) * 0.5;
}

/* State across the plane: the thickness stretch and the Cauchy stress sigma_zz, Pa, of lane 0. In
 * plane strain the stretch is 1; in plane stress the stress is 0. */
SPHFSI_INLINE void material_across(const struct solid_body *b, struct vtensor2 U, double *stretch,
                                   double *sigma_zz)
{
    const struct vtensor2 F = deformation(U), E = green_lagrange(U), cof = vtensor2_cof(F);
    const double J = vtensor2_det(F)[0], ratio = across_ratio(b);
    const struct vtensor2 eps = vtensor2_mul_t(vtensor2_mul(cof, E), cof);
    const double trace_eps = (eps.xx[0] + eps.yy[0]) / (J * J), trace_E = E.xx[0] + E.yy[0];
    *stretch = 1;
    *sigma_zz = 0;
    if (b->plane == PLANE_STRAIN) {
        *sigma_zz = b->law == LAW_SVK           ? b->lambda * trace_E / J
                    : b->law == LAW_NEO_HOOKEAN ? 0.5 * b->lambda * (J * J - 1) / J
                                                : b->lambda * trace_eps;
    } else {
        *stretch = b->law == LAW_SVK ? sqrt(1 + 2 * ratio * trace_E)
                   : b->law == LAW_NEO_HOOKEAN
                       ? sqrt((2 * b->mu + b->lambda) / (2 * b->mu + b->lambda * J * J))
                       : 1 / sqrt(1 - 2 * ratio * trace_eps);
    }
}

#endif
