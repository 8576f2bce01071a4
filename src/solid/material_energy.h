/* SPDX-License-Identifier: MIT
 * Parts of the stress laws that only output needs: stored energy, and the state across the plane.
 * In double. */
#pragma once

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

/* T-41a: the work of the article's law, which has no potential, on the straight path from rest to
 * the right stretch: the integral of P : dS by four points of Gauss. */
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

/* g - ln(1 + g), without cancellation at small g. With z = g/(2 + g), ln(1 + g) = 2 artanh z and
 * g - 2 z = g z. Thirteen terms are exact to round-off for |z| < 1/4. */
SPHFSI_INLINE vdouble less_logarithm(vdouble g)
{
    enum { TERMS = 13 };
    const vdouble z = g / (g + 2.0), z2 = z * z;
    vdouble series = vset_double(0), rest;
    for (int k = TERMS; k > 0; k--) series = series * z2 + 1.0 / (2 * k + 1);
    rest = z * (g - 2.0 * z2 * series);
    for (int l = 0; l < LANES_DOUBLE; l++)
        if (!(fabs(z[l]) < 0.25)) rest[l] = g[l] - elementary_log(1 + g[l]);
    return rest;
}

/* T-21b: the energy of neo_hookean_pk1, in terms of second order. */
SPHFSI_INLINE vdouble neo_hookean_energy(const struct solid_body *b, struct vtensor2 U)
{
    const struct vtensor2 E = green_lagrange(U);
    const vdouble growth = U.xx + U.yy + vtensor2_det(U), in_plane = growth * (growth + 2.0);
    vdouble all = in_plane, shape = -4.0 * vtensor2_det(E);
    if (b->plane == PLANE_STRESS) {
        const vdouble per = 1.0 / (in_plane * b->lambda + (2 * b->mu + b->lambda));
        all = in_plane * per * (2 * b->mu);
        shape = shape + in_plane * in_plane * per * b->lambda;
    }
    return (shape + less_logarithm(all)) * (0.5 * b->mu) + less_logarithm(all) * (0.25 * b->lambda);
}

/* Strain energy per reference volume, J/m^3. */
SPHFSI_INLINE vdouble material_energy(const struct solid_body *b, struct vtensor2 U)
{
    if (b->law == LAW_NEO_HOOKEAN) return neo_hookean_energy(b, U);
    if (b->law == LAW_PAPER) return straight_work(b, U);
    const struct vtensor2 E = green_lagrange(U);
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
