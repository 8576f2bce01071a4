/* SPDX-License-Identifier: MIT
 * The fluid's equations of the article a second time: plain double loops over all pairs, written
 * from the article (with Eq. 19 as in Adami et al. 2012) and not from the code under test. */
#ifndef TWIN_H
#define TWIN_H

#include "time/simulation.h"

struct twin_point {
    double x, y, u, v;    /* m, m/s; of a solid: the velocity that the fluid sees */
    double ax, ay;        /* m/s^2: of a fluid particle the result, of the others given */
    double rho, p;        /* kg/m^3, Pa: of walls and solids a result (Eqs. 19-20) */
    double sx, sy;        /* kg/m^4: renormalised gradient of the density, a result or given */
    double cx, cy, div_r; /* 1/m, 1: gradient of the concentration, divergence of the positions */
    double m;             /* kg/m */
    double p_state;       /* Pa: of the equation of state alone */
    double rho_slow;      /* kg/m^3: with the delay of the damper, as given */
    double drho;          /* kg/(m^3 s) */
    double mu, mv;        /* m/s: mirrored velocity of a wall or solid that fluid sticks to */
    bool sticks;
    double fx, fy; /* N/m: force of the fluid on a solid particle, Eq. 21b */
    /* Sums of the sizes of the terms: what round-off is relative to. */
    double size_a, size_drho, size_p, size_f;
    double weight; /* sum of W over the fluid, relative to W(0): of walls and solids */
};

struct twin {
    double h, mass, c0, rho0, alpha, delta, nu, tensile, repulsion, wall_damping, dp, g[2];
    bool damped;       /* the pressure of the acoustic damper is added */
    double period[2];  /* 0: none */
    bool suction;      /* walls and structures may pull */
    bool one_sided;    /* each fluid particle meets its own pressure in them */
    bool strained;     /* the limit of Meringolo et al. 2019 for Eq. 6 */
    bool renormalised; /* the form of Antuono et al. 2010 for Eq. 6 */
    bool given_slopes; /* its gradients are given */
    bool hydrostatic;  /* the form of Fourtakas et al. 2019 for Eq. 6 */
    bool filled;       /* walls and solids keep their volume (T-11a) */
    int64_t n[KIND_COUNT];
    struct twin_point *point[KIND_COUNT];
    double top_acceleration, top_approach; /* for Eqs. 28a and 28b */
};

/* Copies the state, but nothing that the code has computed from it. */
void twin_copy(struct twin *t, const struct simulation *sim);
/* Eqs. 19-20 for walls and solids, Eqs. 4, 6, 7 and 21a for the fluid, Eq. 21b for the solids. */
void twin_evaluate(struct twin *t);
void twin_free(struct twin *t);

#endif
