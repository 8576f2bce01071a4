/* SPDX-License-Identifier: MIT
 * Parts of the stress laws that only output needs: stored energy, and the state across the plane.
 * In double. */
#ifndef SPHFSI_SOLID_MATERIAL_ENERGY_H
#define SPHFSI_SOLID_MATERIAL_ENERGY_H

#include <math.h>

#include "base/real_double.h"

#include "solid/material.h"

/* Strain energy per reference volume, J/m^3. The paper's law has no stored-energy function. Its row
 * is half the product of stress and strain, exact for small strains only. */
SPHFSI_INLINE vdouble material_energy(const struct solid_body *b, struct vtensor2 U)
{
    const struct vtensor2 F = deformation(U), E = green_lagrange(U), cof = vtensor2_cof(F);
    const vdouble J = vtensor2_det(F);
    struct vtensor2 e = E;
    if (b->law == LAW_NEO_HOOKEAN) {
        vdouble W = J;
        for (int l = 0; l < LANES_DOUBLE; l++) {
            const double t2 = b->plane == PLANE_STRESS
                                  ? (2 * b->mu + b->lambda) / (2 * b->mu + b->lambda * square(J[l]))
                                  : 1;
            const double J2 = square(J[l]) * t2, invariant = 2 * (E.xx[l] + E.yy[l]) + t2 - 1;
            W[l] = (0.5 * b->mu * (invariant - log(J2)) + 0.25 * b->lambda * (J2 - 1 - log(J2)));
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
    const vdouble eps_zz = (e.xx + e.yy) * across_ratio(b);
    return W * J / vsqrt_double(1.0 - 2.0 * eps_zz);
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
