/* SPDX-License-Identifier: MIT
 * Hinges within implicit steps (T-90a): their forces are further unknowns. */
#include "implicit/implicit.h"
#include "base/cholesky.h"

/* Adds the forces of all hinges to the unknowns of their particles. */
static void add_forces(const struct implicit *implicit, const struct hinges *hinges,
                       const double *force, double *to)
{
    for (int64_t k = 0; k < hinges->n_nodes; k++) {
        const struct hinge_node *const node = &hinges->node[k];
        const int64_t row = 2 * (int64_t)implicit->order[node->particle];
        if (row < 0) continue;
        for (int c = 0; c < 2; c++) to[row + c] += node->weight * force[2 * node->hinge + c];
    }
}

/* Subtracts from each item the motion that unknowns give the point of the hinge. */
static void subtract_motion(const struct implicit *implicit, const struct hinges *hinges,
                            const double *unknown, double *from)
{
    for (int64_t k = 0; k < hinges->n_nodes; k++) {
        const struct hinge_node *const node = &hinges->node[k];
        const int64_t row = 2 * (int64_t)implicit->order[node->particle];
        if (row < 0) continue;
        for (int c = 0; c < 2; c++) from[2 * node->hinge + c] -= node->weight * unknown[row + c];
    }
}

enum err constraint_create(struct implicit *implicit, const struct hinges *hinges, struct arena *a,
                           struct diag *d)
{
    const size_t n = 2 * (size_t)hinges->n;
    TRY(arena_array(a, &implicit->column, 2 * (size_t)implicit->n + ENVELOPE_ALIGN, "hinges", d));
    TRY(arena_array(a, &implicit->flexibility, n * n, "hinges", d));
    TRY(arena_array(a, &implicit->hinge_force, n, "hinges", d));
    TRY(arena_array(a, &implicit->hinge_place, n, "hinges", d));
    return ERR_OK;
}

void constraint_factor(struct implicit *implicit, const struct hinges *hinges)
{
    const int n = 2 * hinges->n;
    for (int k = 0; k < n; k++) {
        double *const row = &implicit->flexibility[k * n];
        memset(implicit->column, 0, 2 * (size_t)implicit->n * sizeof *implicit->column);
        memset(row, 0, (size_t)n * sizeof *row);
        row[k] = 1;
        add_forces(implicit, hinges, row, implicit->column);
        row[k] = 0;
        envelope_solve(&implicit->matrix, implicit->column);
        subtract_motion(implicit, hinges, implicit->column, row);
        for (int m = 0; m < n; m++) row[m] = -row[m];
    }
}

void constraint_begin(struct implicit *implicit, struct hinges *hinges,
                      const struct particles *particles, double time, bool middle)
{
    const size_t n = 2 * (size_t)hinges->n;
    memset(implicit->hinge_force, 0, n * sizeof *implicit->hinge_force);
    memset(implicit->hinge_place, 0, n * sizeof *implicit->hinge_place);
    if (middle) hinges_subtract(hinges, particles->ux, particles->uy, implicit->hinge_place);
    for (int k = 0; k < hinges->n; k++) {
        double to[2];
        hinges_place(hinges, k, time, to);
        for (int c = 0; c < 2; c++)
            implicit->hinge_place[2 * k + c] =
                middle ? 0.5 * (to[c] - implicit->hinge_place[2 * k + c]) : to[c];
    }
}

bool constraint_solve(struct implicit *implicit, struct hinges *hinges,
                      const struct particles *particles)
{
    const int n = 2 * hinges->n;
    memcpy(implicit->column, implicit->unknown, 2 * (size_t)implicit->n * sizeof *implicit->column);
    envelope_solve(&implicit->matrix, implicit->column);
    memcpy(hinges->force, implicit->hinge_place, (size_t)n * sizeof *hinges->force);
    hinges_subtract(hinges, particles->ux, particles->uy, hinges->force);
    subtract_motion(implicit, hinges, implicit->column, hinges->force);
    memcpy(hinges->matrix, implicit->flexibility, (size_t)(n * n) * sizeof *hinges->matrix);
    if (cholesky_solve(hinges->matrix, n, n, 0, hinges->force) < n) return false;
    add_forces(implicit, hinges, hinges->force, implicit->unknown);
    for (int k = 0; k < n; k++) implicit->hinge_force[k] += hinges->force[k];
    return true;
}

void constraint_end(const struct implicit *implicit, struct hinges *hinges,
                    const struct particles *particles, double dt)
{
    const size_t bytes = 2 * (size_t)hinges->n * sizeof *hinges->force;
    memset(hinges->force, 0, bytes);
    hinges_subtract(hinges, particles->vx, particles->vy, hinges->force);
    for (int k = 0; k < hinges->n; k++)
        for (int c = 0; c < 2; c++) hinges->hinge[k].target[c] = -hinges->force[2 * k + c];
    memcpy(hinges->force, implicit->hinge_force, bytes);
    hinges->kick_time = dt;
}
