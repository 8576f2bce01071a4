/* SPDX-License-Identifier: MIT
 * Stress as a function of strain, for all laws of the solid. */
#pragma once

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

SPHFSI_INLINE struct vtensor2 scale(vreal a, struct vtensor2 A)
{
    return (struct vtensor2){a * A.xx, a * A.xy, a * A.yx, a * A.yy};
}

/* a A + b B. */
SPHFSI_INLINE struct vtensor2 combine(vreal a, struct vtensor2 A, vreal b, struct vtensor2 B)
{
    return (struct vtensor2){a * A.xx + b * B.xx, a * A.xy + b * B.xy, a * A.yx + b * B.yx,
                             a * A.yy + b * B.yy};
}

/* T-92a: the rate of S = mu I + q B, q = lambda/2 (J^2 - 1) - mu, for B = C^-1 and its rate dB, and
 * the rate `grow` of ln J. In plane stress the thickness follows J_2, the J in the plane. */
SPHFSI_INLINE struct vtensor2 neo_hookean_rate(const struct solid_body *b, vreal J2,
                                               struct vtensor2 B, struct vtensor2 dB, vreal grow)
{
    const vreal square = J2 * J2, twice = 2.0 * square * grow;
    const vreal thin = 2 * b->mu / (square * b->lambda + 2 * b->mu);
    const bool stress = b->plane == PLANE_STRESS;
    const vreal growth = stress ? (square - 1.0) * thin : square - 1.0;
    const vreal rate = stress ? twice * thin * thin * (1 + 0.5 * b->lambda / b->mu) : twice;
    return combine(rate * (0.5 * b->lambda), B, growth * (0.5 * b->lambda) - b->mu, dB);
}

/* T-92b: the rate of S = k ((lambda e + mu) B - mu B^2), the law of Eqs. 9-12 with the trace e = 1
 * - tr B/2 of the Almansi strain and k = J times the change of thickness. */
SPHFSI_INLINE struct vtensor2 paper_rate(const struct solid_body *b, vreal J, struct vtensor2 S,
                                         struct vtensor2 B, struct vtensor2 dB, vreal grow)
{
    const double lambda = plane_lambda(b), mu = b->mu;
    const double across = b->plane == PLANE_STRESS ? across_ratio(b) : 0;
    const vreal e = 1.0 - 0.5 * (B.xx + B.yy), de = -0.5 * (dB.xx + dB.yy);
    const vreal thickness2 = 1.0 / (1.0 - 2 * across * e), k = J * vsqrt(thickness2);
    const struct vtensor2 dB2 = combine(vset(1), vtensor2_mul(dB, B), vset(1), vtensor2_mul(B, dB)),
                          shape = combine(lambda * e + mu, dB, vset(-mu), dB2);
    return combine(vset(1), combine(grow + across * de * thickness2, S, k * lambda * de, B), k,
                   shape);
}

/* The rate of that stress S for a rate dE of the strain. */
SPHFSI_INLINE struct vtensor2 stress_rate(const struct solid_body *b, struct vtensor2 E,
                                          struct vtensor2 S, struct vtensor2 dE)
{
    if (b->law == LAW_SVK) return hooke(dE, plane_lambda(b), b->mu);
    const struct vtensor2 C = deformation(scale(vset(2), E)), cof = vtensor2_cof(C);
    const vreal square = vtensor2_det(C), J = vsqrt(square);
    const struct vtensor2 B = scale(1.0 / square, cof), BdE = vtensor2_mul(B, dE),
                          dB = scale(vset(-2), vtensor2_mul(BdE, B));
    const vreal grow = BdE.xx + BdE.yy;
    return b->law == LAW_NEO_HOOKEAN ? neo_hookean_rate(b, J, B, dB, grow)
                                     : paper_rate(b, J, S, B, dB, grow);
}

SPHFSI_INLINE struct vtensor2 load_tensor(double *const field[4], int64_t i)
{
    return (struct vtensor2){vload(field[0] + i), vload(field[1] + i), vload(field[2] + i),
                             vload(field[3] + i)};
}
