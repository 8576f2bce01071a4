/* SPDX-License-Identifier: MIT
 * Contact of solids with each other and with walls: springs between surface particles that come nearer
 * than their mean spacing. */
#ifndef SPHFSI_SOLID_CONTACT_H
#define SPHFSI_SOLID_CONTACT_H

#include "solid/solid.h"

/* Points by cell in a hash table: bodies may fly apart without making it larger. */
struct contact_grid {
    double side;
    const double *x, *y;
    int32_t *head, *next;
    uint32_t mask;
};

/* Constants of two bodies, or of a body and a wall. */
struct contact_law {
    bool on;
    double reach;     /* distance below which they push, m */
    double gap;       /* part of it beyond the mean spacing, m */
    double stiffness; /* force per depth over the overlap, Pa */
    double damping;   /* force per depth over the speed of approach, Pa s */
    double friction;  /* Coulomb's coefficient */
    double grip;      /* friction over the speed of slip before it slides, Pa s */
};

enum { CONTACT_PARTNERS = 32 };

struct contact {
    const struct scene *scene;
    int n_solids, n_walls;
    struct contact_law *law; /* [n_solids][n_solids + n_walls] */
    const struct particles *wall;
    /* Particles at a surface: those of solids first. */
    int64_t n_solid_points, n_points;
    int32_t *index,
        *body;     /* of the particle among those of its kind; of its body, walls behind solids */
    double *X, *Y; /* where it began, m */
    double *x, *y; /* where it is now, m */
    double *at_x, *at_y; /* where it was when partners were last looked for */
    /* Points of other bodies within reach and skin of a solid's point, ascending. */
    int32_t *partner, *n_partners; /* [n_solid_points][CONTACT_PARTNERS], [n_solid_points] */
    double largest_dp;             /* of any body, m */
    double reach, skin; /* the largest reach; partners hold until a point has gone skin/2 */
    int stale;          /* some point has */
    int crowded;        /* some point has more partners than there is room for */
    struct contact_grid grid;
    double *power;               /* [n_solid_points] of moving walls on it, W/m; NULL: none moves */
    double *vx, *vy;             /* [points of walls] with power: velocities now */
    struct motion_state *motion; /* [n_walls] now */
    double omega2, damping;      /* what contact can add to the largest eigenvalues of the solid */
    double seconds;              /* that its forces have taken since they were last asked for */
};

/* Laws from the [contact] sections, surface points of solids and walls. */
enum err contact_create(struct contact *c, struct arena *a, const struct scene *scene,
                        const struct solid *s, const struct particles *solid,
                        const struct particles *wall, struct diag *d) SPHFSI_CHECKED;

/* Adds the accelerations of contact to sx, sy, with walls where they are at `time`. Inside a parallel
 * region all threads call it together. */
void contact_forces(struct contact *c, const struct solid *s, struct particles *p, double time);

/* Power of moving walls at the last call of contact_forces, W/m. */
double contact_power(const struct contact *c);

/* Energy of all springs, J/m, with walls where they are at `time`. */
double contact_energy(struct contact *c, const struct particles *p, double time);

#endif
