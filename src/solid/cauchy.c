/* SPDX-License-Identifier: MIT
 * True stress of a particle and energy of bodies, for output. */
#include "solid/material_energy.h"

/* Displacement gradients of `count` particles, in the first lanes; the others have none. */
static struct vtensor2 gradients_at(const struct particles *particles, int64_t i, int count)
{
    struct vtensor2 U = {{0}, {0}, {0}, {0}};
    for (int l = 0; l < count; l++) {
        U.xx[l] = particles->Uxx[i + l];
        U.xy[l] = particles->Uxy[i + l];
        U.yx[l] = particles->Uyx[i + l];
        U.yy[l] = particles->Uyy[i + l];
    }
    return U;
}

void solid_cauchy(const struct solid *solid, const struct particles *particles, int64_t i,
                  double sigma[4], double *det)
{
    const struct solid_body *const b = &solid->body[particles->body[i]];
    const struct vtensor2 U = gradients_at(particles, i, 1), F = deformation(U);
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

void solid_energy(const struct solid *solid, const struct particles *particles, int body,
                  double *elastic, double *hourglass, double *det_low)
{
    *elastic = *hourglass = 0;
    *det_low = INFINITY;
    for (int64_t k = 0; k < solid->n_packs; k++) {
        const struct solid_pack *const pack = &solid->pack[k];
        if (body != SOLID_ALL && pack->body != body) continue;
        const struct solid_body *const b = &solid->body[pack->body];
        double locked[LANES_FLOAT] = {0};
        if (b->kappa > 0) solid->sweeps->hourglass(solid, pack, locked);
        for (int first = 0; first < pack->lanes; first += LANES_DOUBLE) {
            const int count =
                pack->lanes - first < LANES_DOUBLE ? pack->lanes - first : LANES_DOUBLE;
            const struct vtensor2 U = gradients_at(particles, pack->i + first, count);
            const vdouble psi = material_energy(b, U), det = vtensor2_det(deformation(U));
            for (int l = 0; l < count; l++) {
                *elastic += psi[l] * square(b->dp);
                *hourglass += locked[first + l];
                if (!(det[l] >= *det_low)) *det_low = det[l];
            }
        }
    }
}
