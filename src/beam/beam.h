/* SPDX-License-Identifier: MIT
 * Beams: lines of nodes with two displacements and a rotation each, which two-node elements join
 * (T-103). The order of a step is in README.md. */
#pragma once

#include "fluid/thin_lines.h"
#include "implicit/envelope.h"
#include "rigid/rigid.h"

/* --- element.c: the element of a geometrically exact beam (Simo and Vu-Quoc 1986) --- */

struct beam_element {
    int node[2];
    double between[2];   /* from the first node to the second at the start, m */
    double length;       /* m */
    double stiffness[3]; /* EA, GA with T-103c, EI: of the strains below, N/m, N/m and N m */
    double damping_time; /* s */
};

/* atan(z)/z. */
double beam_atan_over(double z);

/* T-103a: stretch and shear at the middle of an element with the displacements and rotations q of
 * its nodes, and its change of curvature, 1/m. `turn`: cosine and sine of the angle between the
 * middle's tangent and the x axis. */
void beam_strain(const struct beam_element *e, const double *const q[2], double strain[3],
                 double turn[2]);

/* An element at the start of a step: positions of the second node from the first, and strain. */
struct beam_start {
    double apart[2], turn[2], strain[3];
};

/* T-104: the mean force on each node over a step of dt in which the nodes move by d, and its
 * derivative by d. Its work is the change of elastic energy plus what is dissipated. w: the mean
 * velocities in the step before, in fluid (T-104d); NULL: none. */
void beam_force(const struct beam_element *e, const struct beam_start *start,
                const double *const d[2], const double *const w[2], double dt, double force[2][3],
                double matrix[6][6]);

/* What a run carries from step to step for a node: x, y, angle. Only doubles: saved as such. */
struct beam_state {
    double x[3];       /* displacement, m, and counter-clockwise rotation, rad */
    double v[3];       /* velocity, m/s and 1/s */
    double w[3];       /* its mean over the last step, which the fluid uses */
    double a[3];       /* change of v over the last step; in fluid the mean of T-35c of that of w */
    double impulse[3]; /* that the fluid has still to receive, N s/m and N s (T-105b) */
    double pushed[3];  /* mean of the fluid's force (T-36a), N/m and N */
    double exchange_time; /* time T_e in which the fluid receives the impulse (T-35e), s */
    double reaction[3];   /* of a clamp or hinge in the last step, N/m and N */
};
enum { BEAM_NUMBERS = sizeof(struct beam_state) / sizeof(double) };

struct beam_node {
    int beam;
    double X[2];        /* at the start, m */
    double mass[3];     /* kg/m, kg/m, kg m */
    double length;      /* of the line that it represents, m */
    int64_t unknown[3]; /* its place among the unknowns; -1: held */
    int mover;          /* motion of its clamp or hinge; -1: in place */
    int joined[2];      /* nodes of other beams that have its place, its angle; -1: none */
    int body;           /* rigid body that it is joined to; -1: none */
    bool pivots;        /* by a hinge */
    int line;           /* of its clamp or hinge in the case */
};

/* What a node has within a step. */
struct beam_step {
    double x[3], v[3], w[3];      /* at the start */
    double load[3];               /* from outside, N/m and N */
    double force[3];              /* of the elements against the displacement, N/m and N */
    double fluid[3], resisted[3]; /* in fluid: its force, and its resistance (T-105) */
    double d[3];                  /* displacement; twice the tangent of half the rotation */
    double touch[3];              /* of contact (T-106) and joints (T-107), N/m and N */
    double excess[3];             /* in fluid: its mean velocity less that of the step before */
};

/* A [beam]: its nodes and elements are `first` to `end` - 1. */
struct beam {
    const struct scene_beam *given;
    int first_node, end_node, first_element, end_element;
    double driven;   /* work of loads, clamps and hinges in the last step, J/m */
    double received; /* that of the fluid, J/m */
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
    double length;     /* without force, m */
    double elongation; /* where the last step has found the force, m */
    double stiffness;  /* that the longest step takes into account, at least, N/m^2 */
};

/* A force of contact or of a joint: on nodes and, with the opposite sign, on a rigid body. */
struct beam_row {
    int body;        /* -1: none */
    double X[2];     /* place on the body at the start, m */
    double e[3];     /* direction of the force on the nodes; 0, 0, 1: of a moment */
    double along[3]; /* what a unit of force is to the body */
    double force;    /* on the nodes, N/m or N */
};

/* A rigid body in a step, or in a part of one. */
struct beam_body {
    double from[3];             /* where the step began: displacement and angle */
    double mean[3];             /* its mean velocity in the step without beams */
    double x[3], v[3];          /* at the start of the part */
    double a[3];                /* without beams */
    double d[3];                /* displacement; twice the tangent of half the rotation */
    double impulse[3], push[3]; /* that it has of joints and of contact in the step */
    double force[3], turning;   /* of beams now; the part of the moment that turns with it */
    double off[3];              /* what d needs more by the present forces (T-107b) */
    double compliance[3][3];    /* displacement by a unit of force */
};

struct beams {
    int n, n_nodes, n_elements, n_loads, n_bodies;
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
    /* In fluid (beam/wet.c): */
    struct particles *walls;
    struct thin_line **line; /* [n]; NULL: no fluid */
    double *carries; /* [n_nodes] share of the motion that the fluid sees along a beam (T-111a) */
    double (*added)[6][6]; /* [n_elements] Z of T-105, kg/(m s), kg/s, kg m/s */
    struct envelope matrix;
    int64_t size;    /* of a vector of displacements: unknowns of nodes, then of bodies */
    double *unknown; /* [size] */
    int iterations;  /* of Newton's method in the last step */
    double residual; /* over the largest force of a node */
    double stage;    /* of the fluid's rates, in steps after the start of a step */
    bool alternates; /* the fluid has two solutions, which share the forces */
    struct beam_contact *contact;
    struct beam_joints *joints; /* with rigid bodies; NULL: none */
    struct rigid *rigid;        /* NULL: none */
    struct beam_body *body;     /* [n_bodies] all rigid bodies */
    double part_end;            /* time at the end of the part of a step, s */
    bool crowded;               /* more places touch than the memory holds */
    bool has_pushed_body;       /* a beam has pushed a rigid body; the account resets it */
    int infinite;               /* a [load], counted from 1, that was not finite; 0: none */
    bool failed;                /* no solution, however short the step */
};

enum err beams_create(struct beams *beams, struct arena *a, const struct scene *scene,
                      struct diag *d) SPHFSI_CHECKED;

/* Without fluid and solids, s: a part of the longest period, and of that of a pendulum. */
double beams_longest_step(struct beams *beams);
/* The part of it that remains while springs are stiffer than it takes into account. */
double beams_stiffer_step(const struct beams *beams);

/* Lengths of a step, of the one before (0: none), and for which rates act, s. */
struct beam_times {
    double dt, last, rates_time;
};

/* A step from a time on (T-104). */
void beams_advance(struct beams *beams, double time, const struct beam_times *times);

/* --- for output --- */

/* The nearest point of a beam at the start: an element, the part before it, the distance, m. */
struct beam_place {
    int element;
    double part, distance;
};
struct beam_place beam_find(const struct beams *beams, int beam, const double at[2]);

/* Axial force and shear force, N/m, moment, N, and curvature, 1/m, at a place. */
void beam_section_force(const struct beams *beams, const struct beam_place *place, double out[4]);

/* The sum of the forces of clamps and hinges, N/m, and their moment about a point, N. */
void beam_reaction(const struct beams *beams, int beam, const double about[2], double out[3]);

struct body_energy beam_energy(const struct beams *beams, int beam);

/* --- contact.c: contact without friction: a force that keeps distances (T-106) --- */

enum { BEAM_PAIRS = 512 }; /* that may touch at a time */

enum err beams_contact_create(struct beams *beams, struct arena *a, struct diag *d) SPHFSI_CHECKED;

/* Finds the pairs that may touch in a step, by its first guess. No force acts there yet. */
void beams_find_pairs(struct beams *beams, double time, double dt);

/* Adds the forces of contact to those of the nodes (`touch` of struct beam_step). */
void beams_add_pairs(struct beams *beams);

/* Whether the present displacements keep all distances. */
bool beams_keep_apart(const struct beams *beams);

/* Adds to `unknown`, the correction without a change of the forces, what they change. The matrix
 * has its factors. false: there are no such forces, as of a matrix that is not positive. */
bool beams_correct_pairs(struct beams *beams);

/* After a part of the step: the work of walls that push, and the impulses on rigid bodies. */
void beams_finish_pairs(struct beams *beams, double dt);

/* A particle of a solid within `reach` of the middle of a beam, and this beam; -1: none. Solids and
 * beams have no contact. */
int64_t beams_find_solid(const struct beams *beams, const struct particles *solid, double reach,
                         int *beam);

/* --- joints.c: clamps and hinges on rigid bodies: their forces are unknowns (T-107) --- */

enum err beams_joints_create(struct beams *beams, struct arena *a, struct diag *d) SPHFSI_CHECKED;

/* T-107d: before a step, what bodies have still to receive of the step before. */
void beams_give_rest(struct beams *beams, double last);
/* After it: the mean reactions. */
void beams_return_joints(struct beams *beams, double dt);

/* A part of the step: velocities that the joints allow (T-107c), and no forces yet. */
void beams_begin_joints(struct beams *beams);

/* Adds the forces of the joints to those of the nodes (`touch` of struct beam_step). */
void beams_add_joints(struct beams *beams);

/* Whether the present displacements of nodes and bodies agree. */
bool beams_stay_joined(const struct beams *beams);

/* Changes the forces, and adds to `unknown`, the correction without a change of the forces, what
 * they change. The matrix has its factors. */
void beams_correct_joints(struct beams *beams);

/* Displacements by other forces without the joints: adds what the joints change. */
void beams_resist_joints(const struct beams *beams, double *vector);

/* After a part of the step: the impulses on bodies. */
void beams_finish_joints(struct beams *beams, double dt);

/* --- bodies.c: rigid bodies that beams touch or are joined to (T-107) --- */

enum err beams_bodies_create(struct beams *beams, struct arena *a, struct diag *d) SPHFSI_CHECKED;

/* The unknowns of a body in a vector of displacements. */
SPHFSI_INLINE int64_t beams_body_row(const struct beams *beams, int body)
{
    return beams->matrix.n + ENVELOPE_ALIGN + 3 * body;
}

/* A step may follow as one part or several. Before it: the motion of the bodies in the whole step
 * from `time` on, without the beams. After it: the impulses that the bodies have had. */
void beams_take_bodies(struct beams *beams, double time, double dt);
void beams_return_bodies(struct beams *beams, double dt);

/* A part of the step: the first guess. */
void beams_begin_bodies(struct beams *beams, double time, double dt);

/* Sets the forces on all bodies to zero, before those of contact and joints are added. */
void beams_clear_rows(struct beams *beams);
/* T-107b, with all forces of the rows: what the bodies lack, which goes to `unknown`. */
void beams_find_bodies(struct beams *beams, double dt);
/* Moves the bodies by `unknown`. */
void beams_move_bodies(struct beams *beams);
/* After a part of the step. */
void beams_finish_bodies(struct beams *beams, double dt);

/* Where the displacement in the part takes a body. */
void beam_body_place(const struct beam_body *body, double x[3]);

/* Sets `along`, by the mean arm of the part. */
void beam_row_aim(const struct beams *beams, struct beam_row *row);
/* Adds its force to those of the body. */
void beam_row_push(const struct beams *beams, struct beam_row *row);
/* What the body's displacement, or that in a vector, is along a row; 0: no body. */
double beam_row_moved(const struct beams *beams, const struct beam_row *row);
double beam_row_moved_by(const struct beams *beams, const struct beam_row *row,
                         const double *vector);
/* Adds the displacement of the body by a unit of force to a vector. */
void beam_row_move(const struct beams *beams, const struct beam_row *row, double *vector);
/* Whether the body is where its forces bring it. */
bool beam_row_settled(const struct beams *beams, const struct beam_row *row, double kept);
/* The body's velocity along a row; what a unit of impulse changes in it; and an impulse. */
double beam_row_speed(const struct beams *beams, const struct beam_row *row);
double beam_row_compliance(const struct beams *beams, const struct beam_row *row);
void beam_row_kick(const struct beams *beams, const struct beam_row *row, double impulse);

/* --- springs.c: springs and mooring lines from a beam to a place (T-108) --- */

/* Adds their forces for the present displacements to `touch` of struct beam_step, and the
 * derivative to the matrix. Raises `rounding` to the largest stiffness times a length, N/m. */
void beams_add_springs(struct beams *beams, double dt, double *rounding);

/* Adds half of their stiffnesses at the start to the matrix; lines that only pull count as taut. */
void beams_stiffen(struct beams *beams);

/* Sets what the longest step takes into account of a spring: its stiffness at the start, or the
 * least that matters at a lowest frequency omega. */
void beams_set_stiffness(struct beams *beams, int spring, double omega2);

/* --- for output --- */

/* Adds that of the springs of a beam. */
void beam_add_spring_energy(const struct beams *beams, int beam, struct body_energy *sum);

/* The force of a [spring] at its end `to`; false: it is not of a beam. */
bool beam_spring_force(const struct beams *beams, int spring, double force[2]);

/* --- wet.c: fluid on both sides: each beam is a thin line with its nodes --- */

/* Ties the beams to their lines. `stage`, `alternates`: as of the integrator (time/state.h). */
enum err beams_wet_create(struct beams *beams, struct arena *a, struct lines *lines,
                          struct particles *walls, double stage, bool alternates, struct diag *d)
    SPHFSI_CHECKED;

/* Sets the lines and their dummies to where the beams are `since` after the last step. Returns the
 * largest displacement of a dummy, m. */
double beams_place(struct beams *beams, double since);

/* T-105: the fluid's force on the nodes and its resistance, for a step. */
void beams_find_fluid(struct beams *beams, const struct beam_times *times);

/* After the step: what the fluid has still to receive, the motion that it uses, and the work. */
void beams_return_impulse(struct beams *beams, const struct beam_times *times);
