/* SPDX-License-Identifier: MIT
 * A point and an edge in contact: their distance and their law (T-61, T-62). And what the files of
 * contact call of each other. */
#pragma once

#include "solid/contact.h"

/* --- contact_surface.c --- */

/* Finds the surfaces, and how much further than half a spacing the outlines of the shapes are
 * from their points (T-61b). */
enum err contact_surface_create(struct contact *contact, struct arena *a,
                                const struct particles *solid, struct diag *d) SPHFSI_CHECKED;

/* --- contact_pair.c --- */

/* A place on an edge: 0 to 1 from a to b, the vector from there to the point, and the reach
 * there. */
struct contact_closest {
    const struct contact_law *law;
    const struct contact_point *point, *a, *b;
    double at, offset[2], distance, reach;
    double reach_a, reach_b; /* at the ends, */
    double min_reach;   /* and the least of them, m: R of T-61c, at which the law is infinite */
    double reach_apart; /* the same for a point that begins apart from them */
    double left;        /* r of T-61c: the least reach less the overlap, m */
};

/* The place where the distance less the reach is smallest; false: they do not interact. */
bool contact_find_closest(const struct contact *contact, int32_t point, int32_t edge,
                          struct contact_closest *closest);

/* The nearest place, without law and reach. */
struct contact_closest contact_nearest(const struct contact *contact, int32_t point, int32_t edge);

/* Each surface of a pair of bodies carries half of the force: the points of each act on the edges
 * of the other. */
#define CONTACT_HALF 0.5

/* Constants of a point and an edge. */
struct contact_constants {
    double stiffness;          /* force per overlap at first contact, N/m per depth */
    double damping;            /* N s/m */
    double tangential_damping; /* of the spring of friction, N s/m */
};
struct contact_constants contact_constants_of(const struct contact_law *law,
                                              const struct contact_point *point);

SPHFSI_INLINE struct contact_law *contact_law_of(const struct contact *contact, int a, int b)
{
    return &contact->law[a * contact->n_bodies + b];
}

/* The number of a body among the rigid ones; below 0: another. */
SPHFSI_INLINE int contact_rigid_of(const struct contact *contact, int body)
{
    const int k = body - contact->n_solids - scene_rigid_wall(contact->scene, 0);
    return contact->rigid && k < contact->scene->n_rigid ? k : -1;
}

/* The spacing of a solid or wall, m. */
SPHFSI_INLINE double contact_dp(const struct contact *contact, int body)
{
    return body < contact->n_solids ? contact->solid->body[body].dp : contact->scene->top.dp;
}

/* To a solid's particle or a rigid body, or to the power of other walls. */
void contact_add_force(struct contact *contact, struct particles *particles, int32_t point,
                       const double f[2]);

/* How much a force moves a point, 1/kg; 0: a wall or rigid body. */
double contact_inv_mass(const struct contact *contact, const struct particles *particles,
                        const struct contact_point *point);

/* A part of the rows of T-62a. */
void contact_add_row(struct contact *contact, const struct particles *particles, int32_t point,
                     double weight, double stiffness, double damping);

/* The part of a force between a solid and a place x in the row of a wall's body: of a rigid one. n:
 * the direction of the force; NULL: any. */
void contact_add_body_row(struct contact *contact, int body, const double x[2], const double *n,
                          double stiffness, double damping);

/* Memory for a list of so many pairs; keeps those listed. */
enum err contact_list_resize(struct contact *contact, int64_t max_pairs, struct diag *d)
    SPHFSI_CHECKED;

/* Lists every pair nearer than its reach and `margin`, by point and edge. */
void contact_list(struct contact *contact, double margin);

/* Moves points to their positions in the state, those of moving walls to `time`; `stale` if some
 * point has left the margin. All threads together. */
void contact_place(struct contact *contact, const struct particles *particles, double time);

/* --- contact_friction.c --- */

/* Adds the forces to those of the pairs. */
void contact_friction_forces(struct contact *contact, struct particles *particles);

/* Energy of the springs, J/m. */
double contact_friction_energy(struct contact *contact, const struct particles *particles);

/* The part in the step bound of the pairs from first to before end, of one point. */
void contact_friction_rows(struct contact *contact, const struct particles *particles,
                           int64_t first, int64_t end);
