/* SPDX-License-Identifier: MIT
 * Contact of solids with each other, with walls and with themselves: a surface particle and the
 * line through the surface particles opposite repel each other (docs/theory.md, Contact). */
#pragma once

#include "base/point_grid.h"
#include "rigid/rigid.h"
#include "solid/solid.h"

/* Constants of two bodies, of a body and a wall, or of a body and itself. */
struct contact_law {
    bool on;
    double spacing;   /* mean of both spacings, m */
    double reach;     /* distance below which they repel each other: the spacing and the gap, m */
    double stiffness; /* stress per relative overlap (overlap over spacing), Pa */
    double per_mass; /* sum of 1/m of a particle of each body, of a solid alone if against a wall */
    double shear;    /* the same across the normal, in parts of it */
    double damping;  /* fraction of the critical damping */
    double friction; /* Coulomb's coefficient */
};

/* What a surface presses a point of a solid with. */
struct pressing_surface {
    int32_t group, edge; /* the nearest edge of that surface */
    double distance, force[2];
};
/* More surfaces than these at one point have no friction. */
enum { MOST_SURFACES = 4 };

/* A particle at a surface. */
struct contact_point {
    int32_t index;           /* among the particles of its kind */
    int32_t body;            /* walls after solids */
    int32_t group;           /* the same for bonded solids, and for walls that move together */
    int32_t edge;            /* one of those that end here */
    double X[2], x[2], v[2]; /* initial position; present position and velocity */
    double listed[2];        /* position when the list was made */
    double width;            /* length of outline that it stands for, m, T-61 */
    double share;            /* (n - 1)/n of the n edges that end here, T-61a */
    double inset;            /* distance from the outline less half a spacing, m, T-61b */
    double initial;          /* initial distance from another group if below the reach, m */
    int32_t initial_group;   /* and that group; -1: none */
    bool near_clamp;         /* within the kernel of a clamped particle of its group */
    int16_t near_hinge;      /* the hinge, from 1, within whose kernel it begins; 0: none */
    double omega2_bound, damping_bound;           /* sums of the bound of the step, T-62a */
    double wall_omega2_bound, wall_damping_bound; /* what friction with walls adds to them */
    int n_surfaces;                               /* on a solid's point, for friction */
    struct pressing_surface surface[MOST_SURFACES];
};

/* A line between two neighbouring points. A lone particle is a line from itself to itself. */
struct contact_edge {
    int32_t a, b;
    bool sided; /* the outside is to the right from a to b; else on both sides */
};

/* A point near an edge, and the forces of both: on the point and on the ends of the edge, N/m. */
struct contact_pair {
    int32_t point, edge;
    double force[3][2], distance;
    bool touches, near; /* within this step */
};

/* The largest overlap of a step. */
struct contact_depth {
    double overlap; /* in spacings */
    double x, y;
    int body, other; /* walls after solids */
};

struct contact {
    const struct scene *scene;
    struct arena *arena; /* of the list */
    const struct solid *solid;
    int n_solids, n_walls, n_bodies; /* n_bodies: both */
    struct contact_law *law;         /* [n_bodies][n_bodies] */
    int32_t *group;                  /* [n_bodies] */
    bool friction;                   /* some pair has it */
    double reach, spacing;           /* largest of all laws, m */
    double first_omega2; /* largest T-62e of all laws: two faces at first contact, 1/s^2 */
    /* Points: those of solids first, then those of walls that move. */
    int64_t n_solid_points, n_moving_points, n_points;
    struct contact_point *point;
    int32_t *wall_point; /* [n of walls as sampled] number of a wall's particle; -1: inside */
    double max_inset;    /* the largest of them, m */
    int64_t n_edges;
    struct contact_edge *edge;
    struct point_grid grid; /* of the edges' middles */
    double *middle_x, *middle_y;
    /* The list: every pair nearer than its reach and the margin when points were where it says. */
    bool known;
    double margin;
    int64_t n_pairs, max_pairs;
    struct contact_pair *pair;
    struct motion_state *motion; /* [n_walls] at a time, s */
    double time;
    struct rigid *rigid;                /* those of the walls that are rigid bodies; NULL: none */
    double *body_omega2, *body_damping; /* [n_walls] of a rigid body: part of the bound, T-62a */
    int stale;                          /* some point has moved by half of the margin */
    bool list_full;                     /* no memory for a longer list */
    double power; /* of walls that a [motion] moves, from contact_forces, W/m */
    bool touched; /* bodies, or one and a driven wall; the account resets it */
    /* What the next step must respect, from contact_watch. */
    bool near;                  /* some surfaces may touch */
    double omega2, damping;     /* added by contact to the solid's eigenvalues, 1/s^2 and 1/s */
    double step_before_contact; /* longest step in which nothing can pass through a surface, s */
    struct contact_depth deepest;
    double seconds; /* of its forces since the last query */
};

/* Laws and surfaces of solids and walls. */
enum err contact_create(struct contact *contact, struct arena *a, const struct scene *scene,
                        const struct solid *solid, const struct particles *particles,
                        struct diag *d) SPHFSI_CHECKED;

/* Examines the state before a step of at most `longest`: whether surfaces may touch within the time
 * `span`, what contact adds to the solid's eigenvalues, and the longest step in which nothing
 * passes. The results do not depend on earlier calls. By one thread; returns `near`. */
bool contact_watch(struct contact *contact, const struct particles *particles, double time,
                   double longest, double span);

/* The state has been replaced, and walls at rest may be elsewhere: discards what is known. */
void contact_forget(struct contact *contact, const struct particles *walls);

/* Adds the accelerations of contact to sx, sy, with walls as at `time`. By all threads together. */
void contact_forces(struct contact *contact, struct particles *particles, double time);

/* Lets the places that friction holds points to slide where a spring exceeds friction, after the
 * forces of a step. By one thread. */
void contact_slide(struct contact *contact, struct particles *particles);

/* Energy of contact, J/m, with walls at their positions at `time`. */
double contact_energy(struct contact *contact, const struct particles *particles, double time);

/* The section of a body, walls after solids. */
const struct scene_section_common *contact_section(const struct contact *contact, int body);

/* --- within the files of contact: contact_surface.c --- */

/* Finds the surfaces, and how far beyond half a spacing the outlines are from points (T-61b). */
enum err contact_surface_create(struct contact *contact, struct arena *a,
                                const struct particles *solid, struct diag *d) SPHFSI_CHECKED;

/* --- contact_pair.c: distance and law of a point and an edge (T-61, T-62) --- */

/* A place on an edge: 0 to 1 from a to b, the vector from there to the point, the reach. */
struct contact_closest {
    const struct contact_law *law;
    const struct contact_point *point, *a, *b;
    double at, offset[2], distance, reach;
    double reach_a, reach_b; /* at the ends, m */
    double min_reach;   /* the lesser of the two, m: R of T-61c, at which the law is infinite */
    double reach_apart; /* min_reach for a point that begins apart from the ends */
    double left;        /* r of T-61c: the least reach less the overlap, m */
};

/* The place where the distance less the reach is smallest; false: they do not interact. */
bool contact_find_closest(const struct contact *contact, int32_t point, int32_t edge,
                          struct contact_closest *closest);

/* The nearest place, without law and reach. */
struct contact_closest contact_nearest(const struct contact *contact, int32_t point, int32_t edge);

/* Each of two surfaces carries half of the force: points of each act on edges of the other. */
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

/* A part of the sums of T-62a. */
void contact_add_bound(struct contact *contact, const struct particles *particles, int32_t point,
                       double weight, double stiffness, double damping);

/* The part of a force between a solid and a place x in the sums of a wall's body, if it is rigid.
 * n: the direction of the force; NULL: any. */
void contact_add_body_bound(struct contact *contact, int body, const double x[2], const double *n,
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

/* Energy of the springs, J/m. With particles that may `move` (else NULL): instead adds their forces
 * to those of the pairs; returns 0. */
double contact_friction(struct contact *contact, const struct particles *particles,
                        struct particles *move);

/* The part in the step bound of the pairs from first to before end, of one point. */
void contact_friction_bounds(struct contact *contact, const struct particles *particles,
                             int64_t first, int64_t end);
