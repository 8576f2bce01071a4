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

/* Power of the motion of a wall on the body that is hinged to it, W/m. */
double rigid_hinge_power(const struct rigid *rigid, int k, double time);

/* Position and velocity of a body as its hinge in place or on a wall, or its guide, allows them at
 * a time: of its angle, or of its place along the line. */
void rigid_hold(struct rigid *rigid, int k, double time);
/* The displacement of a body on such a hinge from its angle. */
void rigid_follow_hinge(const struct rigid *rigid, int k, double time, double x[3]);

/* Stages of constraints (T-102): of the velocities before the forces of the step, of those after,
 * and of the places. */
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
    double touch[RIGID_STAGES][3];    /* changes by contact and by hinges between bodies */
};
/* Solves them for a velocity that the hinge or guide allows at the time `end` of the step. */
void rigid_solve(struct rigid *rigid, int k, double end, double kick);
/* The reaction of hinge or guide. */
void rigid_find_reaction(struct rigid *rigid, int k, double kick);

/* Of the masses of a body alone, as it may move at a time: eq->alone. */
void rigid_find_alone(struct rigid *rigid, int k, double time);

/* --- impulses between two bodies --- */

/* A step, the time for which its rates act, and that for which its last velocity moves bodies. */
struct rigid_step {
    double dt, kick, late;
};

/* Two bodies, -1: none, and what a unit of an impulse between them is to each. */
struct rigid_row {
    const int *body;
    const double (*along)[3];
};

/* Relative velocity along a row after a stage; what the stage has changed in it; and what a unit of
 * impulse adds. */
double rigid_row_rate(const struct rigid *rigid, struct rigid_row row, enum rigid_stage stage);
double rigid_row_change(const struct rigid *rigid, struct rigid_row row, enum rigid_stage stage);
double rigid_row_yields(const struct rigid *rigid, struct rigid_row row, enum rigid_stage stage);
void rigid_row_push(struct rigid *rigid, struct rigid_row row, enum rigid_stage stage,
                    double impulse);

/* Component c of the displacement that the velocity after the step gives a body. */
double rigid_way(const struct rigid *rigid, int k, int c, double late);

/* --- hinges between bodies, and moments in hinges (rigid/hinges.c) --- */

enum err rigid_hinges_create(struct rigid *rigid, struct arena *a, struct diag *d) SPHFSI_CHECKED;
/* Before the impulses of a step, with walls where they are at a time. */
void rigid_hinges_begin(struct rigid *rigid, double time);
/* Changes each impulse once; returns the largest change of a velocity. */
double rigid_hinges_relax(struct rigid *rigid, enum rigid_stage stage,
                          const struct rigid_step *step);
/* Adds the impulses to `eq` of the bodies for which they are no reaction. */
void rigid_hinges_load(struct rigid *rigid);
/* Velocities at the end of the step that the hinges allow; kick = 0: of the start. */
void rigid_hinges_hold(struct rigid *rigid, double time, double kick);
void rigid_hinges_work(struct rigid *rigid);
/* Energy of the springs in the hinges that a body has. */
double rigid_hinge_energy(const struct rigid *rigid, int k);

/* --- contact (rigid/contact.c) --- */

enum err rigid_contact_create(struct rigid *rigid, struct arena *a, struct diag *d) SPHFSI_CHECKED;

/* After the solution of all bodies for a step, with walls where they are at a time: the impulses
 * of contact and hinges, added to `eq`, and what they change there. */
void rigid_touch(struct rigid *rigid, double time, const struct rigid_step *step);

/* Their work in the last step, of walls that move and of bodies on each other. */
void rigid_contact_work(struct rigid *rigid);

#endif
