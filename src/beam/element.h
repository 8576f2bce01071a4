/* SPDX-License-Identifier: MIT
 * The two-node element of a geometrically exact beam (Reissner 1972, Simo and Vu-Quoc 1986). */
#pragma once

#include "base/base.h"

struct beam_element {
    int node[2];
    double between[2];   /* from the first node to the second at the start, m */
    double length;       /* m */
    double stiffness[3]; /* EA, GA with T-103c, EI: of the strains below, N/m, N/m and N m */
    double damping_time; /* s */
};

/* atan(z)/z. */
double beam_atan_over(double z);

/* T-103a: stretch and shear at the middle of an element with the displacements and rotations q of
 * its nodes, and its change of curvature, 1/m. `turn`: cosine and sine of the angle between the
 * middle's tangent and the x axis. */
void beam_strain(const struct beam_element *e, const double *const q[2], double strain[3],
                 double turn[2]);

/* An element at the start of a step: positions of the second node from the first, and strain. */
struct beam_start {
    double apart[2], turn[2], strain[3];
};

/* T-104: the mean force on each node over a step of dt in which the nodes move by d, such that its
 * work is the change of the elastic energy, plus what is dissipated; and its derivative by d. w:
 * the mean velocities in the step before, in fluid (T-104d); NULL: none. */
void beam_force(const struct beam_element *e, const struct beam_start *start,
                const double *const d[2], const double *const w[2], double dt, double force[2][3],
                double matrix[6][6]);
