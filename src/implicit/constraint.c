/* SPDX-License-Identifier: MIT
 * Hinges within implicit steps (T-90a): their forces are unknowns beside the displacements. */
#include "implicit/constraint.h"

#include <string.h>

#include "base/cholesky.h"
#include "solid/hinges.h"

/* Adds the forces of all hinges to the unknowns of their particles. */
static void add_forces(const struct implicit *by, const struct hinges *hinges, const double *force,
                       double *to)
{
    for (int64_t k = 0; k < hinges->n_nodes; k++) {
        const struct hinge_node *const node = &hinges->node[k];
        const int64_t row = 2 * (int64_t)by->order[node->particle];
        for (int c = 0; c < 2 && row >= 0; c++)
            to[row + c] += node->weight * force[2 * node->hinge + c];
    }
}

/* Subtracts from each item the motion that unknowns give the point of the hinge. */
static void subtract_motion(const struct implicit *by, const struct hinges *hinges,
                            const double *unknown, double *from)
{
    for (int64_t k = 0; k < hinges->n_nodes; k++) {
        const struct hinge_node *const node = &hinges->node[k];
        const int64_t row = 2 * (int64_t)by->order[node->particle];
        for (int c = 0; c < 2 && row >= 0; c++)
            from[2 * node->hinge + c] -= node->weight * unknown[row + c];
    }
}

/* Subtracts the interpolated field of all particles, of clamps too. */
static void subtract_field(const struct hinges *hinges, const double *x, const double *y,
                           double *from)
{
    for (int64_t k = 0; k < hinges->n_nodes; k++) {
        const struct hinge_node *const node = &hinges->node[k];
        from[2 * node->hinge] -= node->weight * x[node->particle];
        from[2 * node->hinge + 1] -= node->weight * y[node->particle];
    }
}

enum err constraint_create(struct implicit *by, const struct hinges *hinges, struct arena *a,
                           struct diag *d)
{
    const size_t n = 2 * (size_t)hinges->n;
    by->column =
        arena_alloc(a, 2 * (size_t)by->n + ENVELOPE_ALIGN, sizeof *by->column, "hinges", d);
    by->yields = arena_alloc(a, n * n, sizeof *by->yields, "hinges", d);
    by->held = arena_alloc(a, n, sizeof *by->held, "hinges", d);
    by->place = arena_alloc(a, n, sizeof *by->place, "hinges", d);
    return by->column && by->yields && by->held && by->place ? ERR_OK : ERR_MEMORY;
}

void constraint_factor(struct implicit *by, const struct hinges *hinges)
{
    const int n = 2 * hinges->n;
    for (int k = 0; k < n; k++) {
        double *const row = &by->yields[k * n];
        memset(by->column, 0, 2 * (size_t)by->n * sizeof *by->column);
        memset(row, 0, (size_t)n * sizeof *row);
        row[k] = 1;
        add_forces(by, hinges, row, by->column);
        row[k] = 0;
        envelope_solve(&by->matrix, by->column);
        subtract_motion(by, hinges, by->column, row);
        for (int m = 0; m < n; m++) row[m] = -row[m];
    }
}

void constraint_begin(struct implicit *by, struct hinges *hinges, const struct particles *p,
                      double time, bool middle)
{
    const size_t n = 2 * (size_t)hinges->n;
    memset(by->held, 0, n * sizeof *by->held);
    memset(by->place, 0, n * sizeof *by->place);
    if (middle) subtract_field(hinges, p->ux, p->uy, by->place);
    for (int k = 0; k < hinges->n; k++) {
        double to[2];
        hinges_place(hinges, k, time, to);
        for (int c = 0; c < 2; c++)
            by->place[2 * k + c] = middle ? 0.5 * (to[c] - by->place[2 * k + c]) : to[c];
    }
}

void constraint_push(const struct implicit *by, const struct hinges *hinges, struct particles *p)
{
    for (int64_t k = 0; k < hinges->n_nodes; k++) {
        const struct hinge_node *const node = &hinges->node[k];
        const double per_force = node->weight * node->inv_mass;
        p->sx[node->particle] += per_force * by->held[2 * node->hinge];
        p->sy[node->particle] += per_force * by->held[2 * node->hinge + 1];
    }
}

void constraint_solve(struct implicit *by, struct hinges *hinges, const struct particles *p)
{
    const int n = 2 * hinges->n;
    memcpy(by->column, by->unknown, 2 * (size_t)by->n * sizeof *by->column);
    envelope_solve(&by->matrix, by->column);
    memcpy(hinges->force, by->place, (size_t)n * sizeof *hinges->force);
    subtract_field(hinges, p->ux, p->uy, hinges->force);
    subtract_motion(by, hinges, by->column, hinges->force);
    memcpy(hinges->matrix, by->yields, (size_t)(n * n) * sizeof *hinges->matrix);
    cholesky_solve(hinges->matrix, n, n, 0, hinges->force);
    add_forces(by, hinges, hinges->force, by->unknown);
    for (int k = 0; k < n; k++) by->held[k] += hinges->force[k];
}

void constraint_end(const struct implicit *by, struct hinges *hinges, const struct particles *p,
                    double dt)
{
    const size_t bytes = 2 * (size_t)hinges->n * sizeof *hinges->force;
    memset(hinges->force, 0, bytes);
    subtract_field(hinges, p->vx, p->vy, hinges->force);
    for (int k = 0; k < hinges->n; k++)
        for (int c = 0; c < 2; c++) hinges->hinge[k].target[c] = -hinges->force[2 * k + c];
    memcpy(hinges->force, by->held, bytes);
    hinges->kick = dt;
}
