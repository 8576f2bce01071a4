/* SPDX-License-Identifier: MIT
 * The fluid's model and its sweeps: one evaluation of all rates of fluid, walls and coupling. */
#ifndef SPHFSI_FLUID_H
#define SPHFSI_FLUID_H

#include "cells.h"

/* Constants of the fluid, SI. */
struct fluid_constants {
    double h, c0, rho0;
    double mass;       /* of a fluid particle per depth, rho0 dp^2; also hydrodynamic mass of dummies */
    double alpha;      /* Eq. 7 */
    double delta;      /* Eq. 6 */
    double gravity[2];
};

/* Largest values over all fluid particles of the last evaluation; order-free maxima. */
struct fluid_extremes {
    double acceleration2; /* |a|^2 */
    double approach;      /* max |h v.x/(r^2 + eta^2)| of Eq. 28b, m/s */
};

/* Copies in cell order that the sweeps read: positions relative to the cell's centre; float in
 * mixed, double in double precision. */
struct lanes {
    void *x, *y, *u, *v, *volume, *p, *dens;
};

struct fluid_sweeps;

struct fluid {
    struct fluid_constants k;
    unsigned effects;
    const struct fluid_sweeps *sweeps; /* the kernel chosen for precision and effects */
    const char *kernel_name;
    struct lanes lanes[KIND_COUNT];
    int32_t *near_fluid[KIND_COUNT];   /* walls and solids: cells with fluid within reach, Morton order */
    int32_t n_near_fluid[KIND_COUNT];
    void *tiles;                       /* [threads] of candidate tiles */
    struct fluid_extremes extremes;
};

#endif
