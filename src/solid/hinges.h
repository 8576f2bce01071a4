/* SPDX-License-Identifier: MIT
 * Hinges (T-81): points of a solid body that stay in place, on another body or on a wall. */
#pragma once

#include "solid/solid.h"

/* A point of a body that stays in place, on another body or on a moving wall. */
struct hinge {
    double at[2];     /* at t = 0, m */
    int body[2];      /* the section, and the other one; -1: not a solid */
    int bond[2];      /* of these bodies */
    int motion;       /* of the wall; -1: none */
    double target[2]; /* of the last forces: velocity after their kick, or acceleration */
    int line;
};

/* A particle around a hinge. */
struct hinge_node {
    int32_t particle;
    int hinge, end;          /* end: 1 of its body, 2 of the other one */
    double weight, inv_mass; /* negative for the other body; 0 where a clamp holds the particle */
};

struct hinges {
    const struct scene *scene;
    int n;
    struct hinge *hinge;
    int64_t n_nodes;
    struct hinge_node *node; /* in the order of their particles */
    double *matrix;          /* [2 n][2 n] */
    double *force;           /* [2 n] of the last call, on the body, N/m */
    double kick_time;        /* its dt */
    bool released;           /* hinges_forces does nothing */
};

/* Gives a solid its hinges. solid->body is set; particles of all clamps have free = 0. */
enum err hinges_create(struct solid *solid, struct arena *a, const struct scene *scene,
                       const struct particles *particles, struct diag *d) SPHFSI_CHECKED;

/* Removes the part of the initial velocities that hinges do not allow. */
void hinges_start(struct hinges *hinges, struct particles *particles);

/* Adds the accelerations by hinges to sx, sy, which have all others. With dt: those that lead
 * each point to its place after a kick of dt, which fluid resists or not, and a drift as long;
 * without: those by which it stays there. By one thread. */
void hinges_forces(struct hinges *hinges, struct particles *particles, double time, double dt,
                   bool resisted);

/* As hinges_forces without dt, for accelerations `a`; adds the forces, N/m. */
void hinges_hold(struct hinges *hinges, double *const a[2], double *const force[2], double time);

/* Subtracts a field at the points of the hinges from two items of each. */
void hinges_subtract(const struct hinges *hinges, const double *x, const double *y, double *from);

/* Adds what forces at the points change in a field of velocities or accelerations. */
void hinges_push(const struct hinges *hinges, const double *force, double *x, double *y);

/* Displacement that a hinge gives its point at a time, m. */
void hinges_place(const struct hinges *hinges, int hinge, double time, double to[2]);

/* Work of hinges on moving walls over a kick of dt, as loads_work. */
double hinges_work(const struct hinges *hinges, const double *vx, const double *vy, double dt,
                   double *on);
