/* SPDX-License-Identifier: MIT
 * Clamps and hinges of beams on rigid bodies (T-107), within Newton's method. */
#include "beam/beam.h"
#include "base/cholesky.h"
#include "rigid/forces.h"

/* A distance that counts as none, over the particle spacing. */
#define JOINED 1e-9

/* A component of a node that a body takes along. */
struct beam_joint {
    int node, component;
    int64_t unknown;
    double mass; /* of all nodes with this unknown, kg/m or kg m */
    struct beam_row row;
    double impulse; /* on the node in the step, N s/m or N s */
};

struct beam_joints {
    int n;
    struct beam_joint *joint;
    double *column; /* [n][size] displacement of nodes and bodies by a unit of force */
    double *compliance, *factors; /* [n][n] */
    double *open;                 /* [n] */
};

/* --- start --- */

static bool is_joined(const struct beam_node *node, int c)
{
    return node->body >= 0 && c < (node->pivots ? 2 : 3);
}

static void add_joint(struct beams *beams, int k, int c)
{
    const struct beam_node *const node = &beams->node[k];
    struct beam_joints *const joints = beams->joints;
    struct beam_joint *const joint = &joints->joint[joints->n++];
    *joint = (struct beam_joint){.node = k, .component = c, .unknown = node->unknown[c]};
    joint->row = (struct beam_row){.body = node->body, .X = {node->X[0], node->X[1]}};
    joint->row.e[c] = 1;
    for (int j = 0; j < beams->n_nodes; j++)
        joint->mass += beams->node[j].unknown[c] == node->unknown[c] ? beams->node[j].mass[c] : 0;
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
    TRY(arena_array(a, &joints->column, n * (size_t)beams->size, what, d));
    TRY(arena_array(a, &joints->compliance, n * n, what, d));
    TRY(arena_array(a, &joints->factors, n * n, what, d));
    TRY(arena_array(a, &joints->open, n, what, d));
    beams->joints = joints;
    for (int k = 0; k < beams->n_nodes; k++)
        for (int c = 0; c < 3; c++)
            if (is_joined(&beams->node[k], c)) add_joint(beams, k, c);
    return ERR_OK;
}

/* --- a step --- */

/* How far the present displacements bring a node from its place on the body. */
static double gap_of(const struct beams *beams, const struct beam_joint *j)
{
    const struct beam_body *const body = &beams->body[j->row.body];
    const struct beam_step *const s = &beams->step[j->node];
    const int c = j->component;
    double x[3], arm[2];
    beam_body_place(body, x);
    if (c == 2) return s->d[2] - 2 * elementary_tan(0.5 * (x[2] - s->x[2]));
    rigid_arm(beams->rigid, j->row.body, j->row.X, x[2], arm);
    const double centre = beams->rigid->body[j->row.body].centre[c];
    return (j->row.X[c] + s->x[c] + s->d[c]) - (centre + x[c] + arm[c]);
}

void beams_give_rest(struct beams *beams, double last)
{
    struct beam_joints *const joints = beams->joints;
    for (int n = 0; joints && n < joints->n; n++) {
        struct beam_joint *const j = &joints->joint[n];
        struct beam_body *const body = &beams->body[j->row.body];
        double impulse[3];
        j->impulse = 0;
        if (beams->rigid->mid_step) continue;
        memcpy(body->x, beams->rigid->state[j->row.body].x, sizeof body->x);
        memset(body->d, 0, sizeof body->d);
        beam_row_aim(beams, &j->row);
        for (int c = 0; c < 3; c++)
            impulse[c] =
                -0.5 * last * beams->state[j->node].reaction[j->component] * j->row.along[c];
        rigid_add_impulse(beams->rigid, j->row.body, impulse);
    }
}

void beams_return_joints(struct beams *beams, double dt)
{
    const struct beam_joints *const joints = beams->joints;
    for (int n = 0; joints && n < joints->n; n++) {
        const struct beam_joint *const j = &joints->joint[n];
        beams->state[j->node].reaction[j->component] = j->impulse / dt;
    }
}

/* --- a part of the step --- */

/* T-107c: impulses that give nodes the velocities of their bodies. Returns the largest change. */
static double meet(struct beams *beams)
{
    double largest = 0;
    for (int n = 0; n < beams->joints->n; n++) {
        const struct beam_joint *const j = &beams->joints->joint[n];
        const int c = j->component;
        double *const v = &beams->state[j->node].v[c];
        const double excess = *v - beam_row_speed(beams, &j->row);
        largest = max2(largest, fabs(excess));
        if (!(j->mass > 0)) {
            *v -= excess;
            continue;
        }
        const double impulse = -excess / (1 / j->mass + beam_row_compliance(beams, &j->row));
        for (int k = 0; k < beams->n_nodes; k++)
            if (beams->node[k].unknown[c] == j->unknown) beams->state[k].v[c] += impulse / j->mass;
        beam_row_kick(beams, &j->row, impulse);
    }
    return largest;
}

void beams_begin_joints(struct beams *beams)
{
    enum { TURNS = 100 };
    struct beam_joints *const joints = beams->joints;
    if (!joints) return;
    for (int n = 0; n < joints->n; n++) {
        struct beam_row *const row = &joints->joint[n].row;
        row->force = 0;
        memset(beams->body[row->body].d, 0, sizeof beams->body[row->body].d);
        beam_row_aim(beams, row);
    }
    double first = meet(beams), largest = first;
    for (int turn = 1; turn < TURNS && largest > 1e-12 * first; turn++) largest = meet(beams);
}

void beams_add_joints(struct beams *beams)
{
    const struct beam_joints *const joints = beams->joints;
    for (int n = 0; joints && n < joints->n; n++) {
        struct beam_joint *const j = &joints->joint[n];
        beam_row_push(beams, &j->row);
        beams->step[j->node].touch[j->component] += j->row.force;
    }
}

bool beams_stay_joined(const struct beams *beams)
{
    const struct beam_joints *const joints = beams->joints;
    const double kept = JOINED * beams->scene->top.dp;
    for (int n = 0; joints && n < joints->n; n++) {
        const struct beam_joint *const j = &joints->joint[n];
        if (!(fabs(gap_of(beams, j)) <= kept) || !beam_row_settled(beams, &j->row, kept))
            return false;
    }
    return true;
}

static double *column_at(const struct beams *beams, int n)
{
    return &beams->joints->column[n * beams->size];
}

/* How far a vector of displacements brings a node from its place on the body. */
static double opened_by(const struct beams *beams, const struct beam_joint *j, const double *vector)
{
    return vector[j->unknown] - beam_row_moved_by(beams, &j->row, vector);
}

/* T-107a: forces that close what is open, in `open`; what they do to nodes and bodies. */
static void close_open(const struct beams *beams, double *vector)
{
    const struct beam_joints *const joints = beams->joints;
    const int n = joints->n;
    memcpy(joints->factors, joints->compliance, (size_t)(n * n) * sizeof *joints->factors);
    /* Not positive far from a solution: more corrections follow while joints are open. */
    (void)cholesky_solve(joints->factors, n, n, 0, joints->open);
    for (int k = 0; k < n; k++)
        for (int64_t r = 0; r < beams->size; r++)
            vector[r] -= column_at(beams, k)[r] * joints->open[k];
}

static void find_flexibility(const struct beams *beams)
{
    const struct beam_joints *const joints = beams->joints;
    for (int k = 0; k < joints->n; k++) {
        const struct beam_joint *const j = &joints->joint[k];
        double *const column = column_at(beams, k);
        memset(column, 0, (size_t)beams->size * sizeof *column);
        column[j->unknown] = 1;
        envelope_solve(&beams->matrix, column);
        beam_row_move(beams, &j->row, column);
        for (int i = 0; i < joints->n; i++)
            joints->compliance[i * joints->n + k] = opened_by(beams, &joints->joint[i], column);
    }
}

void beams_correct_joints(struct beams *beams)
{
    struct beam_joints *const joints = beams->joints;
    if (!joints) return;
    find_flexibility(beams);
    for (int k = 0; k < joints->n; k++) {
        const struct beam_joint *const j = &joints->joint[k];
        joints->open[k] = gap_of(beams, j) + opened_by(beams, j, beams->unknown);
    }
    close_open(beams, beams->unknown);
    for (int k = 0; k < joints->n; k++) joints->joint[k].row.force -= joints->open[k];
}

void beams_resist_joints(const struct beams *beams, double *vector)
{
    const struct beam_joints *const joints = beams->joints;
    if (!joints) return;
    for (int k = 0; k < joints->n; k++)
        joints->open[k] = opened_by(beams, &joints->joint[k], vector);
    close_open(beams, vector);
}

void beams_finish_joints(struct beams *beams, double dt)
{
    const struct beam_joints *const joints = beams->joints;
    for (int n = 0; joints && n < joints->n; n++) {
        struct beam_joint *const j = &joints->joint[n];
        const double impulse = dt * j->row.force, now = beams->rigid->mid_step ? 1 : 0.5;
        j->impulse += impulse;
        for (int c = 0; c < 3; c++)
            beams->body[j->row.body].impulse[c] -= now * impulse * j->row.along[c];
    }
}
