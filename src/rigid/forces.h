/* SPDX-License-Identifier: MIT
 * What holds, pulls and stops rigid bodies: hinges, guides, springs and contact. */
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

/* Stages of contact (T-102): of the velocities before the forces of the step, of those after, and
 * of the places. */
enum rigid_stage { RIGID_IMPACT, RIGID_STEP, RIGID_PUSH, RIGID_STAGES };

/* T-96 of a body: what acts on it for the step, the masses of fluid and springs that resist, and
 * the solution. */
struct rigid_equations {
    double impulse[3], fluid[3][3], springs[3][3];
    double from_fluid[3];             /* the fluid's part of the impulse */
    double start[3], before[3];       /* velocity; the same as hinge or guide allow it now */
    double change[3], faster[3];      /* of the velocity before, and delta */
    double alone[3][3], yields[3][3]; /* change by a unit of impulse, without fluid and with it */
    double pushed[3];                 /* change by contact with solids */
    double touch[RIGID_STAGES][3];    /* changes by contact with walls and rigid bodies */
};
/* Solves them for a velocity that the hinge or guide allows at the time `end` of the step. */
void rigid_solve(struct rigid *rigid, int k, double end, double kick);
/* The reaction of hinge or guide. */
void rigid_find_reaction(struct rigid *rigid, int k, double kick);

/* --- contact (rigid/contact.c) --- */

enum err rigid_contact_create(struct rigid *rigid, struct arena *a, struct diag *d) SPHFSI_CHECKED;

/* After the solution of all bodies for a step of dt, with walls where they are at a time: the
 * impulses of contact, added to `eq`, and what they change there. */
void rigid_touch(struct rigid *rigid, double time, double dt);

/* Their work in the last step, of walls that move and of bodies on each other. */
void rigid_contact_work(struct rigid *rigid);

#endif
