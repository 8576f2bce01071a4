/* SPDX-License-Identifier: MIT
 * The true stress of a particle, for output. */
#include <math.h>

#include "material.h"

void solid_cauchy(const struct solid *s, const struct particles *p, int64_t i, double sigma[4],
                  double *det)
{
    const struct solid_body *const b = &s->body[p->body[i]];
    const struct vtensor2 U = {vset_double(p->Uxx[i]), vset_double(p->Uxy[i]),
                               vset_double(p->Uyx[i]), vset_double(p->Uyy[i])};
    const struct vtensor2 F = deformation(U);
    double thickness, sigma_zz;
    material_across(b, U, &thickness, &sigma_zz);
    const struct vtensor2 PF = vtensor2_mul_t(material_pk1(b, U), F);
    const double J = vtensor2_det(F)[0] * thickness;
    sigma[0] = PF.xx[0] / J;
    sigma[1] = PF.yy[0] / J;
    sigma[2] = 0.5 * (PF.xy[0] + PF.yx[0]) / J;
    sigma[3] = sigma_zz;
    *det = J;
}

double solid_von_mises(const double sigma[4])
{
    const double xx = sigma[0], yy = sigma[1], xy = sigma[2], zz = sigma[3];
    return sqrt(0.5 * (square(xx - yy) + square(yy - zz) + square(zz - xx)) + 3 * square(xy));
}
