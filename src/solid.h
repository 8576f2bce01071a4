/* SPDX-License-Identifier: MIT
 * Total-Lagrangian elastic solid: reference neighbours as packs, deformation gradient, stress, forces. */
#ifndef SPHFSI_SOLID_H
#define SPHFSI_SOLID_H

#include "particles.h"
#include "scene.h"

struct solid_pack;
struct solid_slot;

/* Constants of one body, SI. */
struct solid_body {
    double lambda, mu;   /* Lame constants in effect (plane stress: the reduced lambda) */
    double density, young;
    double viscosity;    /* alpha_s c_s h rho0 of Eq. 14b; 0: none */
    double sound_speed;  /* c_s of Eq. 29 */
    double kappa;
    double gravity[2];
    int law, plane, symmetric;
};

struct solid {
    int n_bodies;
    struct solid_body *body;
    double h, volume;         /* smoothing length; dp^2 */
    int64_t n_packs, n_slots;
    struct solid_pack *pack;
    struct solid_slot *slot;
    double omega_max;         /* largest frequency of the linearised operator, 1/s */
    double damping_max;       /* largest rate of its viscous part, 1/s */
    double paper_step;        /* Eq. 29, s */
};

/* Cauchy stress (xx, yy, xy, zz), Pa, and det F of a particle from its displacement gradient. */
void solid_cauchy(const struct solid *s, const struct particles *p, int64_t i, double sigma[4],
                  double *det);

#endif
