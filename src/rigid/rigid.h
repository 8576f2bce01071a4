/* SPDX-License-Identifier: MIT
 * Rigid bodies: moving walls whose motion is three unknowns, the displacement of the centre of mass
 * and the angle. The order of a step is in README.md. */
#pragma once

#include "fluid/exchange.h"
#include "fluid/wall_motion.h"

/* What a run carries from step to step: x, y and angle each. Doubles only: saved as such. */
struct rigid_state {
    double x[3];          /* displacement, m, rad */
    double v[3];          /* velocity; half a step before x unless `mid_step` */
    double last[3];       /* acceleration of the last step, m/s^2, 1/s^2 */
    double a[3];          /* mean acceleration, as the fluid's equations use it (T-98) */
    double impulse[3];    /* that the fluid has still to receive, N s/m and N s (T-97) */
    double rate[3];       /* of the impulse in the last step, N/m and N */
    double reaction[3];   /* of hinge and guide in the last step, N/m and N */
    double exchange_time; /* time in which the fluid receives the impulse (T-35e), s */
};
enum { RIGID_NUMBERS = sizeof(struct rigid_state) / sizeof(double) };

struct rigid_body {
    const struct scene_rigid *given;
    const struct moving_wall *wall;  /* its particles */
    double mass[3];                  /* kg/m, kg/m, kg m */
    double centre[2];                /* of mass at the start, m */
    const struct hinge_point *fixed; /* a hinge in place or on a wall; NULL: none */
    int hinge_motion;                /* of this wall; -1: in place */
    double mean[3];                  /* velocity over the last step, m/s and 1/s */
    /* Contact with solids and beams: force now, its impulse, what it moves in the next step. */
    double push[3], push_impulse[3], moved[3];
    /* In the last step, J/m: work of the fluid, of the hinge's motion, and through springs. */
    double received, driven, through_springs;
};

/* A [spring]: the bodies of its ends, -1: in place; of a beam both. */
struct rigid_spring {
    const struct scene_spring *given;
    int body[2];
    double length;     /* without force, m */
    double elongation; /* the largest where the last step has found the force, m */
};

struct rigid {
    int n;
    struct rigid_body *body;
    struct rigid_state *state;
    int n_springs;
    struct rigid_spring *spring;
    struct rigid_equations *eq; /* [n] of a step (rigid/forces.h) */
    struct rigid_contact *contact;
    int n_hinges;
    struct rigid_hinge *hinge; /* of all bodies, in their order */
    int n_rows;
    struct rigid_row *row; /* of a step: contact, hinges and springs (rigid/forces.h) */
    const struct scene *scene;
    struct particles *walls;
    double impedance; /* rho0 c0; 0: no fluid */
    double mean_time; /* h/c0: of the mean acceleration, s; 0: no fluid */
    bool mid_step;    /* forces are found in the middle of a step */
    double end;       /* of the step that has begun, s */
    bool crowded;     /* more places touch than the memory holds */
};

enum err rigid_create(struct rigid *rigid, struct arena *a, const struct scene *scene,
                      const struct wall_motion *motion, struct particles *walls, bool mid_step,
                      struct diag *d) SPHFSI_CHECKED;

/* The [rigid] of a name; -1: none. */
int rigid_find(const struct scene *scene, const char *name);

/* Without fluid and solids, s: a thousandth of the time in which gravity or its velocity moves a
 * body by its radius of gyration. `stiffest`: the spring that allows no more, from 1; 0: none. */
double rigid_longest_step(const struct rigid *rigid, int *stiffest);

/* The part of it that springs allow, as stiff as they are now or after a step of dt; `laws_only`:
 * those with a `force`, whose stiffness changes. */
double rigid_spring_step(const struct rigid *rigid, double dt, bool laws_only, int *stiffest);

/* Sums of the squared frequencies, 1/s^2, and of the damping rates, 1/s, of all springs between two
 * bodies, as stiff as they are now or after a step of dt: at least the largest of these bodies. */
double rigid_spring_rates(const struct rigid *rigid, double dt, double *damping);

/* Gives the scene the motion of bodies at a time, after a step of dt: motion_at continues it. */
void rigid_publish(const struct rigid *rigid, double time, double dt);

/* Where a body with a displacement and an angle is, without velocities. */
struct motion_state rigid_placed(const struct rigid *rigid, int k, const double x[3]);

/* Begins a step of dt from a time on: the motion of the bodies without contact, which is published.
 * The rates of the last evaluation act for `rates_time`, as on the fluid (T-96). */
void rigid_begin(struct rigid *rigid, const double gravity[2], double time, double dt,
                 double rates_time);

/* Ends it, after the sub-steps of solids. */
void rigid_advance(struct rigid *rigid, double time, double dt, double rates_time);

/* --- contact with solids, between these two (T-102a) --- */

/* Sets the force to zero; adds one at a point, with the body where `m` says. */
void rigid_clear_push(struct rigid *rigid);
void rigid_push(struct rigid *rigid, int k, const struct motion_state *m, const double at[2],
                const double force[2]);

/* The force of this time acts for dt: the published motion changes. */
void rigid_kick(struct rigid *rigid, double time, double dt);

/* --- beams on bodies, also between these two (beam/bodies.c, joints.c) --- */

/* Place and velocity of a body at the start of a step, and mean velocity by forces so far. */
void rigid_free_motion(const struct rigid *rigid, int k, double time, double dt, double x[3],
                       double v[3], double mean[3]);

/* Adds an impulse to those of the step. */
void rigid_add_impulse(struct rigid *rigid, int k, const double impulse[3]);

/* The force of a spring at its end `to`, and where that is. */
void rigid_spring_force(const struct rigid *rigid, int spring, double force[2], double at[2]);

/* After a step: how far the places of a hinge on its bodies are apart, or its angle from a driven
 * one, at the radius of gyration, m; the largest of all hinges, and its body. */
double rigid_hinge_gap(const struct rigid *rigid, int *worst);

/* Whether a hinge joins two bodies: they may overlap there. */
bool rigid_share_hinge(const struct rigid *rigid, int one, int other);

struct body_energy rigid_energy(const struct rigid *rigid, int k, double dt);
