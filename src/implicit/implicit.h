/* SPDX-License-Identifier: MIT
 * Implicit steps of the solid: one that conserves energy and momentum takes the place of its
 * sub-steps (T-90). */
#pragma once

#include "implicit/envelope.h"
#include "solid/hinges.h"

/* Particles on which the gradient at a particle depends, itself included, and its derivatives. */
struct implicit_links {
    int64_t *first; /* [n + 1] of each particle */
    int32_t *node;
    double *gx, *gy; /* 1/m */
};

struct implicit {
    int64_t n;      /* particles whose motion is unknown */
    int32_t *order; /* [n of particles] place among them, -1: its motion is given */
    int64_t n_free; /* connected pieces of bodies that no clamp holds */
    struct implicit_links links;
    struct envelope springs; /* of T-28, the same for both components, N/m^2; constant */
    struct envelope matrix;  /* the factors of the last matrix */
    double *unknown;         /* both components, one particle after the other */
    /* Two items for each hinge: their forces, N/m; places of their points, m; [2 n][2 n] the
     * displacements that forces give the points, m^2/N; and a vector of unknowns. */
    double *hinge_force, *hinge_place, *flexibility, *column;
    double *start[4]; /* displacement gradient at the start of the step */
    bool factored;
    double period; /* the longest of the bodies about their undeformed state, s */
    /* The last step, or load step. */
    double left_out; /* part of the forces of the start that a load step leaves out */
    int iterations;  /* solutions with the matrix */
    double residual; /* over the largest force of a particle */
    bool failed;     /* no solution, however short the step */
};

/* Fields of the solid's scratch that hold the forces which a load step leaves out in part, N/m. */
enum { IMPLICIT_LEFT_OUT = 4 };

/* T-94: particles across a slender body. */
SPHFSI_INLINE double implicit_across(const struct solid *solid, const struct particles *particles)
{
    return solid_thickness(solid, particles, SOLID_ALL) / solid->dp;
}

/* T-94: an implicit step costs as much as so many sub-steps. */
SPHFSI_INLINE double implicit_pays_from(const struct solid *solid,
                                        const struct particles *particles)
{
    return 10 + 2 * implicit_across(solid, particles);
}

/* Makes the solid take implicit steps; its particles, loads and clamps are set. */
enum err implicit_create(struct solid *solid, struct arena *a, const struct particles *particles,
                         struct diag *d) SPHFSI_CHECKED;

/* Whether the next step is an implicit one: the springs of contact are not in its matrix, so while
 * surfaces are near each other there are explicit sub-steps. */
SPHFSI_INLINE bool implicit_is_next(const struct solid *solid)
{
    return solid->implicit && !solid->contact;
}

/* n steps of dt of the solid: implicit ones if implicit_is_next, or those of solid_advance. */
void implicit_advance(struct solid *solid, struct particles *particles, double dt, int n);

/* After the state has been read: the matrix that it was found with. */
void implicit_resume(struct solid *solid, struct particles *particles);

/* T-92: the factors of the matrix for the present gradients, a step of dt and wetted normals (NULL:
 * none), with `shift` times the mass added, 1/s^2. Returns the number of negative pivots, or -1. */
int64_t implicit_factor(struct solid *solid, const struct particles *particles, double dt,
                        double shift, const double *nx, const double *ny);

/* Takes the present displacements and velocities as those at the start of a step. */
void implicit_keep_start(struct solid *solid, struct particles *particles);

/* The residual of T-90 for the present displacements as those of the middle of the step, at `time`,
 * to `unknown`; returns the largest of a particle over the largest force, 0: below round-off.
 * dt = INFINITY: of static equilibrium. */
double implicit_residual(struct solid *solid, struct particles *particles, double dt, double time);

/* Adds the solution for `unknown` to the displacements; false: hinges have none. */
bool implicit_correct(const struct solid *solid, struct particles *particles);

/* The longest period of the bodies about their undeformed state, in which they are now, s; INFINITY
 * without any. From the number of negative pivots of K - omega^2 M, which is the number of
 * frequencies below omega (Sylvester), three of them zero for each free piece. */
double implicit_period(struct solid *solid, struct particles *particles);

/* --- constraint.c: hinges within implicit steps (T-90a) --- */

enum err constraint_create(struct implicit *implicit, const struct hinges *hinges, struct arena *a,
                           struct diag *d) SPHFSI_CHECKED;

/* Finds what forces at the hinges do to the points of these, with the present factors. */
void constraint_factor(struct implicit *implicit, const struct hinges *hinges);

/* Where the points are sought for the time: there, or halfway from where they are. */
void constraint_begin(struct implicit *implicit, struct hinges *hinges,
                      const struct particles *particles, double time, bool middle);

/* Adds to the residual what the hinges' forces must be changed by, so that the solution leads the
 * points to their places. false: there is none, as of a matrix that is not positive. */
bool constraint_solve(struct implicit *implicit, struct hinges *hinges,
                      const struct particles *particles);

/* After a step of dt: the hinges' forces and the velocities of their points, for their work. */
void constraint_end(const struct implicit *implicit, struct hinges *hinges,
                    const struct particles *particles, double dt);

/* --- equilibrium.c: static equilibrium of solids without fluid (T-78a) --- */

struct equilibrium {
    bool found;
    int corrections; /* solutions with the matrix */
    int load_steps;
};

/* Seeks the displacements without velocity at which all forces at t = 0 balance. If none is found,
 * the particles are as they were. It may not exist or be unstable, surfaces may come near each
 * other, or something may act that the matrix lacks. `contact`: of the solid, or NULL. ERR_GUARD: a
 * body that nothing holds or could hold. */
enum err equilibrium_find(struct equilibrium *found, const struct solid *solid,
                          struct particles *particles, const struct scene *scene,
                          struct contact *contact, struct diag *d) SPHFSI_CHECKED;
