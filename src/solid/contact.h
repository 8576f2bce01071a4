/* SPDX-License-Identifier: MIT
 * Contact of solids with each other, with walls and with themselves: surface particles and the line
 * through the surface particles opposite push each other apart (docs/theory.md, Contact). */
#ifndef SPHFSI_SOLID_CONTACT_H
#define SPHFSI_SOLID_CONTACT_H

#include "solid/solid.h"

/* Constants of two bodies, of a body and a wall, or of a body and itself. */
struct contact_law {
    bool on;
    double spacing;   /* mean of both spacings, m */
    double reach;     /* distance below which they push: the spacing and the gap, m */
    double stiffness; /* stress over the share of the spacing that is overlapped, Pa */
    double damping;   /* share of the critical damping */
    double friction;  /* Coulomb's coefficient */
};

/* A piece of a surface: the line between two neighbouring points; a particle that has no neighbour is a
 * line from itself to itself. */
struct contact_edge {
    int32_t a, b;
    bool sided; /* the outside is to the right of the way from a to b; else on both sides */
};

/* Places by cell in a hash table: bodies may fly apart without making it larger. */
struct contact_grid {
    double side;
    const double *x, *y;
    int32_t *head, *next;
    uint32_t mask;
};

/* The forces of one pair: on the point and on both ends of the edge, N/m. */
struct contact_force {
    double p[2], a[2], b[2];
    bool touches;
};

/* The worst overlap of a step. */
struct contact_depth {
    double overlap; /* in spacings */
    double x, y;
    int body, other; /* walls behind solids */
};

/* Pairs of a body with itself, and with others: they move relative to each other at different speeds.
 * */
enum contact_with { CONTACT_SELF, CONTACT_OTHER, CONTACT_WITH };

struct contact {
    const struct scene *scene;
    struct arena *arena; /* of the list */
    const struct solid *solid;
    int n_solids, n_walls, n_groups;
    struct contact_law *law; /* [n_solids + n_walls][n_solids + n_walls] */
    /* Particles at a surface: those of solids first, then those of walls that move. */
    int64_t n_solid_points, n_moving_points, n_points;
    int32_t *index;      /* among the particles of its kind */
    int32_t *body;       /* walls behind solids */
    int32_t *wall_point; /* [n of walls as sampled] number of a wall's particle; -1: within */
    int32_t *group;      /* solids that are bonded, and walls that move together, share a number */
    double *X, *Y, *x, *y, *vx, *vy; /* where it began; where it is, and its velocity */
    double *began;                   /* distance from another group where less than the reach, m */
    int32_t *began_group;            /* and that group; -1: none */
    double *share;                   /* (n - 1)/n of the n edges that end at the point, T-61a */
    uint8_t *held;                   /* within the kernel of a clamped particle of its group */
    int64_t n_edges;
    struct contact_edge *edge;
    struct contact_grid grid; /* of the edges' middles */
    double *middle_x, *middle_y;
    uint8_t *skip;         /* [n_edges] of walls far away */
    double reach, spacing; /* the largest of any law */
    /* The list: every pair nearer than its reach and `margin` when points were at at_x, at_y. */
    bool known;
    double margin[CONTACT_WITH];
    double *at_x, *at_y;
    int64_t n_pairs, most_pairs;
    int32_t *pair_point, *pair_edge;
    struct contact_force *force; /* [most_pairs] */
    double *row, *row_damping;   /* [n_solid_points] sums of the bound of the step */
    struct contact_mean *mean;   /* [n_groups] */
    struct motion_state *motion; /* [n_walls] now */
    int stale;                   /* some point has moved by half of the margin */
    bool crowded;                /* no memory for a longer list */
    double power;                /* of moving walls at the last call of contact_forces, W/m */
    /* What the next step has to mind, by contact_watch. */
    bool near;              /* some surfaces may touch */
    double omega2, damping; /* what contact adds to the solid's eigenvalues, 1/s^2 and 1/s */
    double approach;        /* longest step in which nothing can pass, s */
    struct contact_depth deepest;
    double seconds; /* that its forces have taken since they were last asked for */
};

/* Laws and surfaces of solids and walls. */
enum err contact_create(struct contact *c, struct arena *a, const struct scene *scene,
                        const struct solid *s, const struct particles *solid, struct diag *d)
    SPHFSI_CHECKED;

/* Looks at the state before a step of at most `longest`: whether any surfaces may touch within the time
 * `span`, what contact adds to the solid's eigenvalues, and the longest step in which nothing passes.
 * Nothing of what it finds depends on when it looked before. By one thread; returns `near`. */
bool contact_watch(struct contact *c, const struct particles *p, double time, double longest,
                   double span);

/* The state is another one, in which walls at rest may stand elsewhere: nothing is known of its
 * surroundings. */
void contact_forget(struct contact *c, const struct particles *walls);

/* Adds the accelerations of contact to sx, sy, with walls where they are at `time`. Inside a parallel
 * region all threads call it together. */
void contact_forces(struct contact *c, const struct solid *s, struct particles *p, double time);

/* Energy of contact, J/m, with walls where they are at `time`. */
double contact_energy(struct contact *c, const struct particles *p, double time);

/* "[solid a]" or "[wall b]" of a body, walls behind solids. */
enum { CONTACT_NAME = 160 };
void contact_name(const struct contact *c, int body, char text[CONTACT_NAME]);

/* --- what its files share --- */

/* The surfaces of solids and walls: points, edges, share (solid/contact_surface.c). */
enum err contact_find_surface(struct contact *c, struct arena *a, const struct particles *solid,
                              struct diag *d) SPHFSI_CHECKED;

/* Places by cell (solid/contact_search.c): memory for n; fills in those of `item`, or 0 to n - 1
 * where that is
 * NULL; calls `found` for each within reach of (x, y). */
enum err contact_grid_create(struct contact_grid *g, struct arena *a, int64_t n, struct diag *d)
    SPHFSI_CHECKED;
void contact_grid_fill(struct contact_grid *g, int64_t n, const uint8_t *skip);
typedef void contact_visit(void *context, int32_t item);
void contact_grid_find(const struct contact_grid *g, double x, double y, double reach,
                       contact_visit *found, void *context);

/* Lists every pair nearer than its reach and margin, by point and edge. */
void contact_list(struct contact *c);

/* Brings points to where they are at the state, those of moving walls to `time`, and lists pairs anew
 * where some point has left the margin. All threads together. */
void contact_place(struct contact *c, const struct particles *p, double time);

/* The law of a point and an edge, with the reach of this pair; not on: they do not meet. */
struct contact_law contact_pair_law(const struct contact *c, int32_t point, int32_t edge);

/* Where on an edge a point is nearest: place 0 to 1 from a to b, and the way from there to the point.
 * */
struct contact_foot {
    double at, x, y, distance;
};
struct contact_foot contact_foot(const struct contact *c, int32_t point, int32_t edge);

/* Whether a pair is of one group. */
SPHFSI_INLINE enum contact_with contact_with(const struct contact *c, int32_t point, int32_t edge)
{
    return c->group[point] == c->group[c->edge[edge].a] ? CONTACT_SELF : CONTACT_OTHER;
}

#endif
