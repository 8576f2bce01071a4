/* SPDX-License-Identifier: MIT
 * What holds, pulls and stops rigid bodies: hinges, guides, springs and contact. */
#pragma once

#include "rigid/rigid.h"

enum err rigid_springs_create(struct rigid *rigid, struct arena *a, struct diag *d) SPHFSI_CHECKED;

/* Adds that of the springs whose first end a body has. */
void rigid_add_spring_energy(const struct rigid *rigid, int k, struct body_energy *sum);

/* Mean power of a wall's motion, which may have kinks, on the body hinged to it in a step, W/m. */
double rigid_hinge_power(const struct rigid *rigid, int k, double dt);

/* Position and velocity of a body as its hinge in place or on a wall, or its guide, allows them:
 * of its angle, or of its place along the line. The hinge is where it is at the time `place`, with
 * the velocity that it has at the time `speed`. */
void rigid_hold(struct rigid *rigid, int k, double place, double speed);
/* The displacement of a body on such a hinge from its angle. */
void rigid_follow_hinge(const struct rigid *rigid, int k, double time, double x[3]);

/* Stages of constraints (T-102): velocities before a step's forces and after them; places. */
enum rigid_stage { RIGID_IMPACT, RIGID_STEP, RIGID_PUSH, RIGID_STAGES };

/* T-96 of a body: what acts on it in the step, the mass of fluid that resists, the solution. */
struct rigid_equations {
    double impulse[3];
    double resisting[3][3];        /* T' Z of T-96: mass of fluid, kg/m, kg, kg m */
    double from_fluid[3];          /* the fluid's part of the impulse */
    double start[3], before[3];    /* velocity; the same as hinge or guide allow it now */
    double at_start[3];            /* velocity at the time of the start */
    double change[3], excess[3];   /* of the velocity before, and delta */
    double mobility_dry[3][3];     /* change by a unit of impulse, without fluid */
    double mobility[3][3];         /* the same with fluid */
    double push_change[3];         /* change by contact with solids and beams */
    double touch[RIGID_STAGES][3]; /* changes by contact and by hinges between bodies */
    double near, turn[2];          /* an angle at the end of the step; its cosine and sine */
};
/* Solves them for a velocity that the hinge or guide allows at the time `end` of the step. */
void rigid_solve(struct rigid *rigid, int k, double end, double rates_time);
/* The reaction of hinge or guide. */
void rigid_find_reaction(struct rigid *rigid, int k, double rates_time);

/* Finds eq->mobility_dry, the masses of a body alone as it may move at a time. */
void rigid_find_mobility_dry(struct rigid *rigid, int k, double time);

/* --- relations of a body to another one, to a wall or to a place --- */

/* A step, the time for which its rates act, and that for which its last velocity moves bodies. */
struct rigid_step {
    double dt, rates_time, lag;
};

/* What decides on the impulse of a row: surfaces do not come nearer than their gap; friction stops
 * as far as it can; a spring with a damper; points stay together. */
enum rigid_law { RIGID_GAP, RIGID_FRICTION, RIGID_SPRING, RIGID_JOINT };

struct rigid_row {
    enum rigid_law law;
    int body[2];        /* -1: a wall or place, or none */
    double along[2][3]; /* what a unit of impulse is to each body: force and moment */
    double other_rate;  /* the part of what is no body in the relative velocity, m/s */
    double start_rate;  /* relative velocity before the step */
    double impulse[RIGID_STAGES];
    double gap, restitution;   /* m, 1 */
    double leave;              /* least speed at which a gap opens after an impact, m/s */
    double friction;           /* Coulomb's coefficient with the gap of the row before, or N */
    double stiffness, damping; /* N/m^2 and N s/m^2, or N and N s */
    double force;              /* of a spring before the step: N/m, or its moment, N */
    double theta;    /* part of a step in which its change of the rate moves it: 1/4, explicit 0 */
    bool pulls_only; /* a spring that does not push */
    const struct rigid_hinge *hinge; /* NULL: none */
    int component;                   /* of it: x, y or the angle */
};

/* A row for the coming step, which its caller fills in. */
struct rigid_row *rigid_add_row(struct rigid *rigid, enum rigid_law law, const int body[2]);

/* Sets what a unit of a force along e is to a body; `arm`: from its centre of mass to the place. */
void rigid_row_along(struct rigid_row *row, int side, const double arm[2], const double e[2]);

/* Relative velocity along a row after a stage; its change in that; and by a unit of impulse. */
double rigid_row_rate(const struct rigid *rigid, const struct rigid_row *row,
                      enum rigid_stage stage);
double rigid_row_change(const struct rigid *rigid, const struct rigid_row *row,
                        enum rigid_stage stage);
double rigid_row_mobility(const struct rigid *rigid, const struct rigid_row *row,
                          enum rigid_stage stage);
void rigid_row_push(struct rigid *rigid, const struct rigid_row *row, enum rigid_stage stage,
                    double impulse);

/* Component c of the displacement that the velocity after the step gives a body. */
double rigid_displacement(const struct rigid *rigid, int k, int c, double lag);

/* From the centre of mass to a point of a body, where the body is. */
void rigid_arm(const struct rigid *rigid, int k, const double at[2], double angle, double arm[2]);

void rigid_add_springs(struct rigid *rigid, double dt);

/* --- hinges between bodies, and moments in hinges (rigid/hinges.c) --- */

enum err rigid_hinges_create(struct rigid *rigid, struct arena *a, struct diag *d) SPHFSI_CHECKED;
/* With walls where they are at a time. */
void rigid_add_hinges(struct rigid *rigid, double time);
/* T-99a: the rest of the distance, or of the driven angle, after the step, as a velocity. */
double rigid_joint_left(const struct rigid *rigid, const struct rigid_row *row, double lag);
/* Velocities at the end of the step that hinges allow; rates_time = 0: at the start of a run. */
void rigid_hinges_hold(struct rigid *rigid, double time, double rates_time);
/* Energy of the springs in the hinges that a body has. */
double rigid_hinge_energy(const struct rigid *rigid, int k);

/* --- contact (rigid/contact.c) --- */

enum err rigid_contact_create(struct rigid *rigid, struct arena *a, struct diag *d) SPHFSI_CHECKED;
/* Two rows for each pair that may touch, with walls where they are at a time. */
void rigid_add_pairs(struct rigid *rigid, double time);

/* --- the solution for all rows (rigid/impulses.c) --- */

/* After all bodies' solution, with walls as at a time: all impulses, added to `eq`. */
void rigid_find_impulses(struct rigid *rigid, double time, const struct rigid_step *step);

/* Their work in the last step, of walls that move and of bodies on each other. */
void rigid_impulse_work(struct rigid *rigid);
