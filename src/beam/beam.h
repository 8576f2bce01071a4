/* SPDX-License-Identifier: MIT
 * Beams: lines of nodes with two displacements and a rotation each, which two-node elements join
 * (T-103). README.md tells the order of a step. */
#pragma once

#include "beam/element.h"
#include "implicit/envelope.h"
#include "rigid/rigid.h"

/* What a run carries from step to step, for each node: x, y and angle each. Doubles only: saved as
 * such. */
struct beam_state {
    double x[3];       /* displacement, m, and counter-clockwise rotation, rad */
    double v[3];       /* velocity, m/s and 1/s */
    double w[3];       /* its mean over the last step, which the fluid uses */
    double a[3];       /* change of v over the last step; in fluid the mean of T-35c of that of w */
    double impulse[3]; /* that the fluid has still to receive, N s/m and N s (T-105b) */
    double pushed[3];  /* mean of the fluid's force (T-36a), N/m and N */
    double exchange;   /* time T_e in which the fluid receives the impulse (T-35e), s */
    double reaction[3]; /* of a clamp or hinge in the last step, N/m and N */
};
enum { BEAM_NUMBERS = sizeof(struct beam_state) / sizeof(double) };

struct beam_node {
    int beam;
    double X[2];    /* at the start, m */
    double mass[3]; /* kg/m, kg/m, kg m */
    double length;  /* of the line that it represents, m */
    int64_t row[3]; /* of the unknowns; -1: held */
    int mover;      /* motion of its clamp or hinge; -1: in place */
    int joined[2];  /* nodes of other beams that have its place, its angle; -1: none */
    int body;       /* rigid body that it is joined to; -1: none */
    bool pivots;    /* by a hinge */
    int line;       /* of its clamp or hinge in the case */
};

/* In a step: see beam_advance. */
struct beam_step {
    double x[3], v[3], w[3];      /* at the start */
    double load[3];               /* from outside, N/m and N */
    double force[3];              /* of the elements against the displacement, N/m and N */
    double fluid[3], resisted[3]; /* in fluid: its force, and its resistance (T-105) */
    double d[3];                  /* displacement; twice the tangent of half the rotation */
    double touch[3];              /* of contact (T-106) and joints (T-107), N/m and N */
    double faster[3];             /* in fluid: its mean velocity less that of the step before */
};

/* A [beam]: its nodes and elements are `first` to `end` - 1. */
struct beam {
    const struct scene_beam *given;
    int first_node, end_node, first_element, end_element;
    double work;     /* of loads, clamps and hinges in the last step, J/m */
    double received; /* work of the fluid in it, J/m */
};

/* A node that a [load] acts on: its part of the force and moment, or the length for a traction. */
struct beam_load {
    int section, node;
    double part, length;
};

/* A [spring] from a node to a place; node -1: it is of no beam. */
struct beam_spring {
    const struct scene_spring *given;
    int node;
    double length; /* without force, m */
};

struct beams {
    int n, n_nodes, n_elements, n_loads;
    struct beam *beam;
    struct beam_node *node;
    struct beam_element *element;
    struct beam_state *state; /* [n_nodes] */
    struct beam_step *step;   /* [n_nodes] */
    struct beam_start *start; /* [n_elements] of the step */
    struct beam_load *load;
    int n_springs; /* of the scene */
    struct beam_spring *spring;
    const struct scene *scene;
    /* In fluid (beam/wet.h): */
    struct particles *walls;
    struct thin_line **line; /* [n]; NULL: no fluid */
    double *carries; /* [n_nodes] share of the motion that the fluid sees along a beam (T-111a) */
    double (*added)[6][6]; /* [n_elements] T Z of T-105, kg/m, kg and kg m */
    struct envelope matrix;
    double *unknown; /* [rows] */
    int iterations;  /* of Newton's method in the last step */
    double residual; /* over the largest force of a node */
    double ahead;    /* steps that the fluid is evaluated after the start of a step */
    bool alternates; /* the fluid has two solutions, which share the forces */
    struct beam_contact *contact;
    struct beam_joints *joints; /* with rigid bodies; NULL: none */
    struct rigid *rigid;        /* NULL: none */
    bool crowded;               /* more places touch than the memory holds */
    bool pushed;                /* a beam has pushed a rigid body; the account resets it */
    bool failed;                /* no solution, however short the step */
};

enum err beams_create(struct beams *beams, struct arena *a, const struct scene *scene,
                      struct diag *d) SPHFSI_CHECKED;

/* Without fluid and solids, s: a part of the longest period, and of that of a pendulum. */
double beams_longest_step(struct beams *beams);

/* The lengths of a step, of the one before (0: the first), and of that of the velocities by the
 * rates of the last evaluation, s. */
struct beam_times {
    double dt, last, kick;
};

/* A step from a time on (T-104). */
void beams_advance(struct beams *beams, double time, const struct beam_times *times);

/* --- for output --- */

/* The point of a beam that is nearest to a point at the start: an element, the part of it before
 * that point, and the distance, m. */
struct beam_place {
    int element;
    double part, distance;
};
struct beam_place beam_find(const struct beams *beams, int beam, const double at[2]);

/* Axial force and shear force, N/m, moment, N, and curvature, 1/m, at a place. */
void beam_section(const struct beams *beams, const struct beam_place *place, double out[4]);

/* The sum of the forces of clamps and hinges, N/m, and their moment about a point, N. */
void beam_reaction(const struct beams *beams, int beam, const double about[2], double out[3]);

struct body_energy beam_energy(const struct beams *beams, int beam);
