/* SPDX-License-Identifier: MIT
 * Stress as a function of strain, for all laws of the solid. */
#ifndef SPHFSI_IMPLICIT_STRESS_H
#define SPHFSI_IMPLICIT_STRESS_H

#include "base/real_double.h"

#include "solid/material.h"

/* T-91: second Piola-Kirchhoff stress of a strain, S = F^-1 P with the upper triangular F of
 * F^T F = I + 2 E: the laws are objective, so every F of this strain gives the same. */
SPHFSI_INLINE struct vtensor2 stress_of_strain(const struct solid_body *b, struct vtensor2 E)
{
    const vreal a = vsqrt(2.0 * E.xx + 1.0), shear = 2.0 * E.xy / a;
    const vreal rest = 2.0 * E.yy - shear * shear, d = vsqrt(rest + 1.0);
    const struct vtensor2 U = {2.0 * E.xx / (a + 1.0), shear, vset(0), rest / (d + 1.0)};
    const struct vtensor2 P = material_pk1(b, U);
    const vreal across = P.yx / d;
    return (struct vtensor2){(P.xx - shear * across) / a, across, across, P.yy / d};
}

SPHFSI_INLINE struct vtensor2 load_tensor(double *const field[4], int64_t i)
{
    return (struct vtensor2){vload(field[0] + i), vload(field[1] + i), vload(field[2] + i),
                             vload(field[3] + i)};
}

#endif
