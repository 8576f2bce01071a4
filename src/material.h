/* SPDX-License-Identifier: MIT
 * Stress laws of the solid, one short function each, over lanes. All take the displacement gradient
 * U = F - I, so that small strains keep their digits, and give the first Piola-Kirchhoff stress P. */
#ifndef SPHFSI_MATERIAL_H
#define SPHFSI_MATERIAL_H

#include <math.h>

#include "solid.h"
#include "tensor2.h"

/* F = I + U. */
SPHFSI_INLINE struct vtensor2 deformation(struct vtensor2 U)
{
    return (struct vtensor2){U.xx + 1.0, U.xy, U.yx, U.yy + 1.0};
}

/* Eq. 12: Green-Lagrange strain E = (U + U^T + U^T U)/2. */
SPHFSI_INLINE struct vtensor2 green_lagrange(struct vtensor2 U)
{
    const vdouble shear = (U.xy + U.yx + U.xx * U.xy + U.yx * U.yy) * 0.5;
    return (struct vtensor2){U.xx + (U.xx * U.xx + U.yx * U.yx) * 0.5, shear, shear,
                             U.yy + (U.xy * U.xy + U.yy * U.yy) * 0.5};
}

/* Linear isotropic law, Eq. 10: lambda tr(e) I + 2 mu e. */
SPHFSI_INLINE struct vtensor2 hooke(struct vtensor2 e, double lambda, double mu)
{
    const vdouble trace = (e.xx + e.yy) * lambda;
    return (struct vtensor2){trace + e.xx * (2 * mu), e.xy * (2 * mu), e.yx * (2 * mu),
                             trace + e.yy * (2 * mu)};
}

/* In plane stress the strain across is -ratio (e_xx + e_yy), which lowers lambda to this. */
SPHFSI_INLINE double plane_lambda(const struct solid_body *b)
{
    return b->plane == PLANE_STRESS ? 2 * b->lambda * b->mu / (b->lambda + 2 * b->mu) : b->lambda;
}

/* Eqs. 9-12 with the Almansi strain eps = F^-T E F^-1: Cauchy stress linear in eps, P = J sigma F^-T.
 * In plane stress J counts the change of thickness, 1/sqrt(1 - 2 eps_zz). */
SPHFSI_INLINE struct vtensor2 paper_pk1(const struct solid_body *b, struct vtensor2 U)
{
    const struct vtensor2 F = deformation(U), cof = vtensor2_cof(F);
    const vdouble inv_J = 1.0 / vtensor2_det(F), inv_J2 = inv_J * inv_J;
    struct vtensor2 eps = vtensor2_mul_t(vtensor2_mul(cof, green_lagrange(U)), cof);
    eps = (struct vtensor2){eps.xx * inv_J2, eps.xy * inv_J2, eps.yx * inv_J2, eps.yy * inv_J2};
    struct vtensor2 P = vtensor2_mul(hooke(eps, plane_lambda(b), b->mu), cof);
    if (b->plane == PLANE_STRESS) {
        const vdouble eps_zz = (eps.xx + eps.yy) * (-b->lambda / (b->lambda + 2 * b->mu));
        const vdouble thickness = 1.0 / vsqrt_double(1.0 - 2.0 * eps_zz);
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

/* Compressible neo-Hookean, W = mu/2 (tr(F^T F) - 3) - mu ln J + lambda/4 (J^2 - 1 - 2 ln J):
 * P = mu F + (lambda/2 (J^2 - 1) - mu) F^-T. In plane stress the thickness t follows from
 * P_zz = 0 in closed form: t^2 = (2 mu + lambda)/(2 mu + lambda J_2^2), J = J_2 t. */
SPHFSI_INLINE struct vtensor2 neo_hookean_pk1(const struct solid_body *b, struct vtensor2 U)
{
    const struct vtensor2 F = deformation(U), cof = vtensor2_cof(F);
    const vdouble J = vtensor2_det(F);
    vdouble J2 = J * J;
    if (b->plane == PLANE_STRESS) J2 = J2 * (2 * b->mu + b->lambda) / (2 * b->mu + b->lambda * J2);
    const vdouble inverse = ((J2 - 1.0) * (0.5 * b->lambda) - b->mu) / J;
    return (struct vtensor2){F.xx * b->mu + cof.xx * inverse, F.xy * b->mu + cof.xy * inverse,
                             F.yx * b->mu + cof.yx * inverse, F.yy * b->mu + cof.yy * inverse};
}

SPHFSI_INLINE struct vtensor2 material_pk1(const struct solid_body *b, struct vtensor2 U)
{
    switch (b->law) {
    case LAW_SVK: return svk_pk1(b, U);
    case LAW_NEO_HOOKEAN: return neo_hookean_pk1(b, U);
    default: return paper_pk1(b, U);
    }
}

/* Strain energy per reference volume, J/m^3. The paper's law has no stored-energy function: its row is
 * half the product of stress and strain, which is exact for small strains only. */
SPHFSI_INLINE vdouble material_energy(const struct solid_body *b, struct vtensor2 U)
{
    const struct vtensor2 F = deformation(U), E = green_lagrange(U), cof = vtensor2_cof(F);
    const vdouble J = vtensor2_det(F);
    struct vtensor2 e = E;
    if (b->law == LAW_NEO_HOOKEAN) {
        vdouble W = J;
        for (int l = 0; l < LANES_DOUBLE; l++) {
            const double t2 = b->plane == PLANE_STRESS
                                  ? (2 * b->mu + b->lambda) / (2 * b->mu + b->lambda * J[l] * J[l])
                                  : 1;
            const double J2 = J[l] * J[l] * t2, invariant = 2 * (E.xx[l] + E.yy[l]) + t2 - 1;
            W[l] = 0.5 * b->mu * (invariant - log(J2)) + 0.25 * b->lambda * (J2 - 1 - log(J2));
        }
        return W;
    }
    if (b->law == LAW_PAPER) {
        const vdouble inv_J2 = 1.0 / (J * J);
        e = vtensor2_mul_t(vtensor2_mul(cof, E), cof);
        e = (struct vtensor2){e.xx * inv_J2, e.xy * inv_J2, e.yx * inv_J2, e.yy * inv_J2};
    }
    const struct vtensor2 S = hooke(e, plane_lambda(b), b->mu);
    const vdouble W = (S.xx * e.xx + S.yy * e.yy + S.xy * e.xy + S.yx * e.yx) * 0.5;
    if (b->law != LAW_PAPER) return W;
    if (b->plane == PLANE_STRAIN) return W * J;
    const vdouble eps_zz = (e.xx + e.yy) * (-b->lambda / (b->lambda + 2 * b->mu));
    return W * J / vsqrt_double(1.0 - 2.0 * eps_zz);
}

/* What happens across the plane: the stretch of the thickness and the Cauchy stress sigma_zz, Pa, of
 * lane 0. In plane strain the stretch is 1, in plane stress the stress is 0. */
SPHFSI_INLINE void material_across(const struct solid_body *b, struct vtensor2 U, double *stretch,
                                   double *sigma_zz)
{
    const struct vtensor2 F = deformation(U), E = green_lagrange(U), cof = vtensor2_cof(F);
    const double J = vtensor2_det(F)[0], ratio = -b->lambda / (b->lambda + 2 * b->mu);
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
