/* SPDX-License-Identifier: MIT
 * The solid's equations of the paper (Eqs. 9-18) a second time: plain double loops over all pairs
 * of the reference configuration, written from the article and not from the code under test. */
#ifndef TWIN_SOLID_H
#define TWIN_SOLID_H

#include "time/simulation.h"

struct twin_mat {
    double m[2][2];
};

struct twin_solid_point {
    int body;
    double X, Y, x, y, u, v;                /* reference and current position, velocity */
    struct twin_mat inverse_L, F, sigma, P; /* P with the share of a variational hourglass force */
    double ax, ay;                          /* Eq. 18 without gravity, m/s^2 */
    double size;                            /* sum of the sizes of its terms */
};

struct twin_solid {
    double h, dp;
    const struct scene_solid *body;
    const struct scene_contact *contact; /* NULL: none; between all bodies */
    int64_t n;
    struct twin_solid_point *point;
};

void twin_solid_copy(struct twin_solid *t, const struct simulation *sim);
/* All of Eqs. 13-18, with the linear gradient of Eq. 13b whatever the scene says. */
void twin_solid_evaluate(struct twin_solid *t);
void twin_solid_free(struct twin_solid *t);

/* First Piola-Kirchhoff and Cauchy stress of a deformation gradient by the body's law. */
struct twin_mat twin_solid_stress(const struct scene_solid *body, struct twin_mat F,
                                  struct twin_mat *sigma);

#endif
