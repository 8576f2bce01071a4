/* SPDX-License-Identifier: MIT
 * Stress laws of the solid, one short function each, on vectors of `real`. All use the displacement
 * gradient U = F - I, which keeps the digits of small strains, and return the first Piola-Kirchhoff
 * stress P. */
#pragma once

#include "solid/solid.h"
#include "base/tensor2.h"

/* F = I + U. */
SPHFSI_INLINE struct vtensor2 deformation(struct vtensor2 U)
{
    return (struct vtensor2){U.xx + (real)1, U.xy, U.yx, U.yy + (real)1};
}

/* Eq. 12: Green-Lagrange strain E = (U + U^T + U^T U)/2. */
SPHFSI_INLINE struct vtensor2 green_lagrange(struct vtensor2 U)
{
    const vreal shear = (U.xy + U.yx + U.xx * U.xy + U.yx * U.yy) * (real)0.5;
    return (struct vtensor2){U.xx + (U.xx * U.xx + U.yx * U.yx) * (real)0.5, shear, shear,
                             U.yy + (U.xy * U.xy + U.yy * U.yy) * (real)0.5};
}

/* Linear isotropic law, Eq. 10: lambda tr(e) I + 2 mu e. */
SPHFSI_INLINE struct vtensor2 hooke(struct vtensor2 e, double lambda, double mu)
{
    const vreal trace = (e.xx + e.yy) * (real)lambda;
    const real twice = (real)(2 * mu);
    return (struct vtensor2){trace + e.xx * twice, e.xy * twice, e.yx * twice,
                             trace + e.yy * twice};
}

/* In plane stress the strain across the plane is this times (e_xx + e_yy), */
SPHFSI_INLINE double across_ratio(const struct solid_body *b)
{
    return -b->lambda / (b->lambda + 2 * b->mu);
}

/* which reduces lambda to this. */
SPHFSI_INLINE double plane_lambda(const struct solid_body *b)
{
    return b->plane == PLANE_STRESS ? 2 * b->lambda * b->mu / (b->lambda + 2 * b->mu) : b->lambda;
}

/* Eqs. 9-12 with the Almansi strain eps = F^-T E F^-1: Cauchy stress linear in eps, P = J sigma
 * F^-T. In plane stress J counts the change of thickness, 1/sqrt(1 - 2 eps_zz). */
SPHFSI_INLINE struct vtensor2 paper_pk1(const struct solid_body *b, struct vtensor2 U)
{
    const struct vtensor2 F = deformation(U), cof = vtensor2_cof(F);
    const vreal inv_J = (real)1 / vtensor2_det(F), inv_J2 = inv_J * inv_J;
    struct vtensor2 eps = vtensor2_mul_t(vtensor2_mul(cof, green_lagrange(U)), cof);
    eps = (struct vtensor2){eps.xx * inv_J2, eps.xy * inv_J2, eps.yx * inv_J2, eps.yy * inv_J2};
    struct vtensor2 P = vtensor2_mul(hooke(eps, plane_lambda(b), b->mu), cof);
    if (b->plane == PLANE_STRESS) {
        const vreal eps_zz = (eps.xx + eps.yy) * (real)across_ratio(b);
        const vreal thickness = (real)1 / vsqrt((real)1 - (real)2 * eps_zz);
        P = (struct vtensor2){P.xx * thickness, P.xy * thickness, P.yx * thickness,
                              P.yy * thickness};
    }
    return P;
}

/* St. Venant-Kirchhoff: S = lambda tr(E) I + 2 mu E, P = F S. */
SPHFSI_INLINE struct vtensor2 svk_pk1(const struct solid_body *b, struct vtensor2 U)
{
    return vtensor2_mul(deformation(U), hooke(green_lagrange(U), plane_lambda(b), b->mu));
}

/* Compressible neo-Hookean, W = mu/2 (tr(F^T F) - 3) - mu ln J + lambda/4 (J^2 - 1 - 2 ln J): P =
 * mu F + (lambda/2 (J^2 - 1) - mu) F^-T = (mu (J F - cof F) + lambda/2 (J^2 - 1) cof F)/J, in J - 1
 * = tr U + det U to avoid cancellation (T-21a): J F - cof F = U - cof U + (J - 1) F. In plane
 * stress the thickness t follows from P_zz = 0 in closed form: t^2 = (2 mu + lambda)/(2 mu + lambda
 * J_2^2), J = J_2 t, which turns J_2^2 - 1 into J^2 - 1 as below. */
SPHFSI_INLINE struct vtensor2 neo_hookean_pk1(const struct solid_body *b, struct vtensor2 U)
{
    const struct vtensor2 F = deformation(U), cof = vtensor2_cof(F);
    const real mu = (real)b->mu, lambda = (real)b->lambda;
    const vreal growth = U.xx + U.yy + vtensor2_det(U), inv_J = (real)1 / (growth + (real)1);
    vreal growth2 = growth * (growth + (real)2);
    if (b->plane == PLANE_STRESS)
        growth2 = growth2 * (2 * mu) / (2 * mu + lambda * (growth2 + (real)1));
    const vreal both = growth2 * (real)(0.5 * b->lambda);
    const vreal shear = (U.xy + U.yx) * mu, stretch = (U.xx - U.yy) * mu, more = growth * mu;
    return (struct vtensor2){(stretch + more * F.xx + both * cof.xx) * inv_J,
                             (shear + more * F.xy + both * cof.xy) * inv_J,
                             (shear + more * F.yx + both * cof.yx) * inv_J,
                             (more * F.yy - stretch + both * cof.yy) * inv_J};
}

SPHFSI_INLINE struct vtensor2 material_pk1(const struct solid_body *b, struct vtensor2 U)
{
    switch (b->law) {
    case LAW_SVK: return svk_pk1(b, U);
    case LAW_NEO_HOOKEAN: return neo_hookean_pk1(b, U);
    default: return paper_pk1(b, U);
    }
}
