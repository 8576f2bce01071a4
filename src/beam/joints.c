/* SPDX-License-Identifier: MIT
 * Clamps and hinges of beams on rigid bodies (T-107), within Newton's method. */
#include "beam/beam.h"
#include "base/cholesky.h"
#include "rigid/forces.h"

/* A distance that counts as none, over the particle spacing. */
#define JOINED 1e-9

/* A component of a node that a body takes along. */
struct beam_joint {
    int node, component, body; /* body: of struct beam_joints */
    int64_t row;
    double mass;     /* of all nodes with this unknown, kg/m or kg m */
    double along[3]; /* what a unit of force is to the body */
    double force;    /* on the node, N/m or N */
    double impulse;  /* on the node in the step, N s/m or N s */
};

/* A rigid body that beams are joined to, in a part of the step. */
struct beam_body {
    int rigid;
    double from[3];      /* where the step began: displacement and angle */
    double mean[3];      /* its mean velocity in the step without joints */
    double x[3], v[3];   /* at the start of the part */
    double a[3];         /* without joints */
    double d[3];         /* displacement; twice the tangent of half the rotation */
    double impulse[3];   /* that it has of the joints in the step */
    double off[3];       /* what d needs more by the present forces (T-107b) */
    double yields[3][3]; /* displacement by a unit of force */
};

struct beam_joints {
    int n, n_bodies;
    struct beam_joint *joint;
    struct beam_body *body;
    double *column;           /* [n][rows] displacement of nodes by a unit of force */
    double *yields, *factors; /* [n][n] */
    double *open;             /* [n] */
    double time, dt;          /* of the part */
};

/* --- start --- */

static int number_body(struct beam_joints *joints, int rigid)
{
    for (int b = 0; b < joints->n_bodies; b++)
        if (joints->body[b].rigid == rigid) return b;
    joints->body[joints->n_bodies].rigid = rigid;
    return joints->n_bodies++;
}

static bool is_joined(const struct beam_node *node, int c)
{
    return node->body >= 0 && c < (node->pivots ? 2 : 3);
}

static void add_joint(struct beams *beams, int k, int c)
{
    const int64_t row = beams->node[k].row[c];
    struct beam_joints *const joints = beams->joints;
    struct beam_joint *const joint = &joints->joint[joints->n++];
    *joint = (struct beam_joint){.node = k, .component = c, .row = row};
    joint->body = number_body(joints, beams->node[k].body);
    for (int j = 0; j < beams->n_nodes; j++)
        joint->mass += beams->node[j].row[c] == row ? beams->node[j].mass[c] : 0;
}

enum err beams_joints_create(struct beams *beams, struct arena *a, struct diag *d)
{
    static const char what[] = "joints of beams";
    size_t n = 0;
    for (int k = 0; k < beams->n_nodes; k++)
        for (int c = 0; c < 3; c++) n += is_joined(&beams->node[k], c);
    if (n == 0) return ERR_OK;
    struct beam_joints *const joints = arena_alloc(a, 1, sizeof *joints, what, d);
    if (!joints) return ERR_MEMORY;
    TRY(arena_array(a, &joints->joint, n, what, d));
    TRY(arena_array(a, &joints->body, n, what, d));
    TRY(arena_array(a, &joints->column, n * (size_t)(beams->matrix.n + ENVELOPE_ALIGN), what, d));
    TRY(arena_array(a, &joints->yields, n * n, what, d));
    TRY(arena_array(a, &joints->factors, n * n, what, d));
    TRY(arena_array(a, &joints->open, n, what, d));
    beams->joints = joints;
    for (int k = 0; k < beams->n_nodes; k++)
        for (int c = 0; c < 3; c++)
            if (is_joined(&beams->node[k], c)) add_joint(beams, k, c);
    return ERR_OK;
}

/* --- bodies --- */

static const struct rigid_equations *equations_of(const struct beams *beams, int body)
{
    return &beams->rigid->eq[beams->joints->body[body].rigid];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Where a displacement d takes the body. */
static void place_body(const struct beam_body *body, double x[3])
{
    for (int c = 0; c < 2; c++) x[c] = body->x[c] + body->d[c];
    x[2] = body->x[2] + body->d[2] * beam_atan_over(0.5 * body->d[2]);
}

/* A hinge in place or on a wall gives the body the place of its angle. */
static void follow_hinge(const struct beams *beams, struct beam_body *body)
{
    const struct beam_joints *const joints = beams->joints;
    double x[3];
    if (!beams->rigid->body[body->rigid].fixed) return;
    place_body(body, x);
    rigid_follow_hinge(beams->rigid, body->rigid, joints->time + joints->dt, x);
    for (int c = 0; c < 2; c++) body->d[c] = x[c] - body->x[c];
}

/* From the centre of mass to a joint's node: at the start of the part, and after it. */
static void find_arms(const struct beams *beams, const struct beam_joint *j, double arm[2][2])
{
    const struct beam_body *const body = &beams->joints->body[j->body];
    const double *const X = beams->node[j->node].X;
    double x[3];
    place_body(body, x);
    rigid_arm(beams->rigid, body->rigid, X, body->x[2], arm[0]);
    rigid_arm(beams->rigid, body->rigid, X, x[2], arm[1]);
}

static void set_along(struct beam_joint *j, const double arm[2])
{
    const int c = j->component;
    j->along[0] = c == 0;
    j->along[1] = c == 1;
    j->along[2] = c == 2 ? 1 : c == 1 ? arm[0] : -arm[1];
}

/* How far the present displacements bring a node from its place on the body. */
static double gap_of(const struct beams *beams, const struct beam_joint *j)
{
    const struct beam_body *const body = &beams->joints->body[j->body];
    const struct beam_step *const s = &beams->step[j->node];
    const int c = j->component;
    double x[3], arm[2][2];
    place_body(body, x);
    if (c == 2) return s->d[2] - 2 * elementary_tan(0.5 * (x[2] - s->x[2]));
    find_arms(beams, j, arm);
    const double centre = beams->rigid->body[body->rigid].centre[c];
    return (beams->node[j->node].X[c] + s->x[c] + s->d[c]) - (centre + x[c] + arm[1][c]);
}

/* T-107d: what a velocity half a step behind has still to receive of the step before. */
static void give_rest(struct beams *beams, struct beam_body *body, double last)
{
    const struct beam_joints *const joints = beams->joints;
    double impulse[3] = {0};
    if (beams->rigid->centred) return;
    memcpy(body->x, beams->rigid->state[body->rigid].x, sizeof body->x);
    memset(body->d, 0, sizeof body->d);
    for (int n = 0; n < joints->n; n++) {
        struct beam_joint *const j = &joints->joint[n];
        double arm[2][2];
        if (&joints->body[j->body] != body) continue;
        find_arms(beams, j, arm);
        set_along(j, arm[0]);
        for (int c = 0; c < 3; c++)
            impulse[c] -= 0.5 * last * beams->state[j->node].reaction[j->component] * j->along[c];
    }
    rigid_load(beams->rigid, body->rigid, impulse);
}

void beams_take_bodies(struct beams *beams, double time, const struct beam_times *times)
{
    const double dt = times->dt, last = times->last;
    struct beam_joints *const joints = beams->joints;
    for (int n = 0; joints && n < joints->n; n++) joints->joint[n].impulse = 0;
    for (int b = 0; joints && b < joints->n_bodies; b++) {
        struct beam_body *const body = &joints->body[b];
        give_rest(beams, body, last);
        rigid_free_motion(beams->rigid, body->rigid, time, dt, body->from, body->v, body->mean);
        memcpy(body->x, body->from, sizeof body->x);
        memset(body->impulse, 0, sizeof body->impulse);
        for (int c = 0; c < 3; c++) body->a[c] = 2 * (body->mean[c] - body->v[c]) / dt;
    }
}

void beams_return_bodies(struct beams *beams, double dt)
{
    const struct beam_joints *const joints = beams->joints;
    for (int n = 0; joints && n < joints->n; n++) {
        const struct beam_joint *const j = &joints->joint[n];
        beams->state[j->node].reaction[j->component] = j->impulse / dt;
    }
    for (int b = 0; joints && b < joints->n_bodies; b++) {
        const struct beam_body *const body = &joints->body[b];
        const double(*const W)[3] = equations_of(beams, b)->yields;
        const double late = beams->rigid->centred ? 0.5 * dt : dt;
        for (int c = 0; c < 3; c++)
            beams->rigid->body[body->rigid].moved[c] +=
                body->x[c] - (body->from[c] + dt * body->mean[c] + late * dot(W[c], body->impulse));
        rigid_load(beams->rigid, body->rigid, body->impulse);
        beams->pushed = true;
    }
}

/* --- a part of the step --- */

/* An impulse of a joint on the node, and the opposite one on the body. */
static void add_impulse(struct beams *beams, struct beam_joint *j, double impulse)
{
    struct beam_body *const body = &beams->joints->body[j->body];
    const double(*const W)[3] = equations_of(beams, j->body)->yields;
    for (int k = 0; k < beams->n_nodes; k++)
        if (beams->node[k].row[j->component] == j->row)
            beams->state[k].v[j->component] += impulse / j->mass;
    for (int c = 0; c < 3; c++) {
        body->impulse[c] -= impulse * j->along[c];
        body->v[c] -= impulse * dot(W[c], j->along);
    }
}

/* T-107c: impulses by which nodes have the velocities of their bodies. Returns the largest change
 * of one. */
static double meet(struct beams *beams)
{
    double largest = 0;
    for (int n = 0; n < beams->joints->n; n++) {
        struct beam_joint *const j = &beams->joints->joint[n];
        const double(*const W)[3] = equations_of(beams, j->body)->yields;
        double *const v = &beams->state[j->node].v[j->component], own = 0;
        const double faster = *v - dot(j->along, beams->joints->body[j->body].v);
        for (int c = 0; c < 3; c++) own += j->along[c] * dot(W[c], j->along);
        largest = max2(largest, fabs(faster));
        if (j->mass > 0)
            add_impulse(beams, j, -faster / (1 / j->mass + own));
        else
            *v -= faster;
    }
    return largest;
}

void beams_begin_joints(struct beams *beams, double time, double dt)
{
    enum { TURNS = 100 };
    struct beam_joints *const joints = beams->joints;
    if (!joints) return;
    joints->time = time;
    joints->dt = dt;
    for (int b = 0; b < joints->n_bodies; b++) memset(joints->body[b].d, 0, sizeof(double[3]));
    for (int n = 0; n < joints->n; n++) {
        struct beam_joint *const j = &joints->joint[n];
        double arm[2][2];
        j->force = 0;
        find_arms(beams, j, arm);
        set_along(j, arm[0]);
    }
    double first = meet(beams), largest = first;
    for (int turn = 1; turn < TURNS && largest > 1e-12 * first; turn++) largest = meet(beams);
    for (int b = 0; b < joints->n_bodies; b++) {
        struct beam_body *const body = &joints->body[b];
        for (int c = 0; c < 3; c++) body->d[c] = dt * (body->v[c] + 0.5 * dt * body->a[c]);
        follow_hinge(beams, body);
    }
}

/* T-107b: what a body lacks, and how it yields, with the part of its moment that turns with it. */
static void find_body(struct beams *beams, int b)
{
    const struct beam_joints *const joints = beams->joints;
    struct beam_body *const body = &joints->body[b];
    const double(*const W)[3] = equations_of(beams, b)->yields;
    const double dt = joints->dt, share = 0.5 * dt * dt;
    double force[3] = {0}, turning = 0;
    for (int n = 0; n < joints->n; n++) {
        struct beam_joint *const j = &joints->joint[n];
        double arm[2][2];
        if (j->body != b) continue;
        find_arms(beams, j, arm);
        set_along(j,
                  (const double[2]){0.5 * (arm[0][0] + arm[1][0]), 0.5 * (arm[0][1] + arm[1][1])});
        for (int c = 0; c < 3; c++) force[c] -= j->force * j->along[c];
        if (j->component < 2) turning += 0.5 * j->force * arm[1][j->component];
    }
    const double stiff = share * turning / (1 + 0.25 * square(body->d[2])),
                 rest = 1 - stiff * W[2][2], by = rest > 0.1 ? stiff / rest : 0;
    for (int c = 0; c < 3; c++) {
        body->off[c] = dt * body->v[c] + share * (body->a[c] + dot(W[c], force)) - body->d[c];
        for (int e = 0; e < 3; e++) body->yields[c][e] = share * (W[c][e] + by * W[c][2] * W[2][e]);
    }
    const double turn = body->off[2];
    for (int c = 0; c < 2 && beams->rigid->body[body->rigid].fixed; c++)
        body->off[c] = turn * W[c][2] / W[2][2];
    for (int c = 0; c < 3; c++) body->off[c] += by * W[c][2] * turn;
}

void beams_add_joints(struct beams *beams)
{
    const struct beam_joints *const joints = beams->joints;
    if (!joints) return;
    for (int b = 0; b < joints->n_bodies; b++) find_body(beams, b);
    for (int n = 0; n < joints->n; n++) {
        const struct beam_joint *const j = &joints->joint[n];
        beams->step[j->node].touch[j->component] += j->force;
    }
}

bool beams_stay_joined(const struct beams *beams)
{
    const struct beam_joints *const joints = beams->joints;
    const double kept = JOINED * beams->scene->top.dp;
    for (int n = 0; joints && n < joints->n; n++) {
        const struct beam_joint *const j = &joints->joint[n];
        if (!(fabs(gap_of(beams, j)) <= kept) ||
            !(fabs(dot(j->along, joints->body[j->body].off)) <= kept))
            return false;
    }
    return true;
}

static double *column_at(const struct beams *beams, int n)
{
    return &beams->joints->column[n * (beams->matrix.n + ENVELOPE_ALIGN)];
}

/* T-107a: forces that close what is open, in `open`; what they do to the nodes. */
static void close_open(const struct beams *beams, double *unknown)
{
    const struct beam_joints *const joints = beams->joints;
    const int n = joints->n;
    memcpy(joints->factors, joints->yields, (size_t)(n * n) * sizeof *joints->factors);
    /* Not positive far from a solution: more corrections follow while joints are open
     * (beams_stay_joined). */
    (void)cholesky_solve(joints->factors, n, n, 0, joints->open);
    for (int k = 0; k < n; k++)
        for (int64_t r = 0; r < beams->matrix.n; r++)
            unknown[r] -= column_at(beams, k)[r] * joints->open[k];
}

static void find_flexibility(const struct beams *beams)
{
    const struct beam_joints *const joints = beams->joints;
    for (int k = 0; k < joints->n; k++) {
        const struct beam_joint *const j = &joints->joint[k];
        double *const column = column_at(beams, k);
        memset(column, 0, (size_t)(beams->matrix.n + ENVELOPE_ALIGN) * sizeof *column);
        column[j->row] = 1;
        envelope_solve(&beams->matrix, column);
        for (int i = 0; i < joints->n; i++) {
            const struct beam_joint *const other = &joints->joint[i];
            double both = column[other->row];
            for (int c = 0; c < 3 && other->body == j->body; c++)
                both += other->along[c] * dot(joints->body[j->body].yields[c], j->along);
            joints->yields[i * joints->n + k] = both;
        }
    }
}

void beams_correct_joints(struct beams *beams)
{
    struct beam_joints *const joints = beams->joints;
    if (!joints) return;
    find_flexibility(beams);
    for (int k = 0; k < joints->n; k++) {
        const struct beam_joint *const j = &joints->joint[k];
        joints->open[k] =
            gap_of(beams, j) + beams->unknown[j->row] - dot(j->along, joints->body[j->body].off);
    }
    close_open(beams, beams->unknown);
    for (int b = 0; b < joints->n_bodies; b++)
        for (int c = 0; c < 3; c++) joints->body[b].d[c] += joints->body[b].off[c];
    for (int k = 0; k < joints->n; k++) {
        struct beam_joint *const j = &joints->joint[k];
        struct beam_body *const body = &joints->body[j->body];
        j->force -= joints->open[k];
        for (int c = 0; c < 3; c++) body->d[c] += dot(body->yields[c], j->along) * joints->open[k];
    }
    for (int b = 0; b < joints->n_bodies; b++) follow_hinge(beams, &joints->body[b]);
}

void beams_resist_joints(const struct beams *beams, double *unknown)
{
    const struct beam_joints *const joints = beams->joints;
    if (!joints) return;
    for (int k = 0; k < joints->n; k++) joints->open[k] = unknown[joints->joint[k].row];
    close_open(beams, unknown);
}

void beams_finish_joints(struct beams *beams, double dt)
{
    const struct beam_joints *const joints = beams->joints;
    for (int n = 0; joints && n < joints->n; n++) {
        struct beam_joint *const j = &joints->joint[n];
        struct beam_body *const body = &joints->body[j->body];
        const double impulse = dt * j->force, now = beams->rigid->centred ? 1 : 0.5;
        j->impulse += impulse;
        for (int c = 0; c < 3; c++) body->impulse[c] -= now * impulse * j->along[c];
    }
    for (int b = 0; joints && b < joints->n_bodies; b++) {
        struct beam_body *const body = &joints->body[b];
        place_body(body, body->x);
        for (int c = 0; c < 3; c++) body->v[c] = 2 * body->d[c] / dt - body->v[c];
    }
}
