/* SPDX-License-Identifier: MIT
 * What holds and pulls rigid bodies: hinges, guides and springs. */
#ifndef SPHFSI_RIGID_FORCES_H
#define SPHFSI_RIGID_FORCES_H

#include "rigid/rigid.h"

enum err rigid_springs_create(struct rigid *rigid, struct arena *a, struct diag *d) SPHFSI_CHECKED;

/* The loads of springs on the bodies where they are, and the derivatives of these. */
void rigid_find_loads(struct rigid *rigid);

/* Energy of the springs whose first end a body has, J/m; and after a step the work that they pass
 * on to the second one. */
double rigid_spring_energy(const struct rigid *rigid, int k);
void rigid_pass_work(struct rigid *rigid, double kick);

/* Power of the motion of a hinge on its body, W/m. */
double rigid_hinge_power(const struct rigid *rigid, int k, double time);

/* Position and velocity of a body as its hinge or guide allows them at a time: of its angle, or of
 * its place along the line. */
void rigid_hold(struct rigid *rigid, int k, double time);

/* T-96 of a body: what acts on it for the step, the masses of fluid and springs that resist, and
 * the solution. */
struct rigid_equations {
    double impulse[3], fluid[3][3], springs[3][3];
    double *faster; /* [3] delta */
};
/* Solves them for a velocity that the hinge or guide allows at the time `end` of the step, and sets
 * the reaction of these. */
void rigid_solve(struct rigid *rigid, int k, struct rigid_equations *eq, double end, double kick);

#endif
