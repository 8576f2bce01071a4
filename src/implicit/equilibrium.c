/* SPDX-License-Identifier: MIT
 * Static equilibrium of solids by Newton's method (T-78a). Where it does not converge at once, a
 * part of the forces of the start is left out at first: load steps. */
#include "implicit/implicit.h"
#include "solid/contact.h"

/* Residuals over the largest force of a particle: one that is enough, one as good as none. */
#define TOLERANCE 1e-7
#define FINE 1e-12

/* A matrix is kept while a correction with it reduces the residual by this factor. */
#define FAST 0.1

enum { ITERATIONS = 25 };

/* T-78b: bodies with this many more particles across than along, whose factors cost too much. */
static const double dear = 80;

static const double shortest_part = 1.0 / 256;

/* T-78a: Newton's method from the present displacements. Pieces that nothing holds get a little of
 * their mass, with which their rigid motions have a solution. */
static bool balance(struct solid *solid, struct particles *particles, struct equilibrium *found)
{
    struct implicit *const implicit = solid->implicit;
    const double shift = implicit->n_free ? 1e-12 * square(solid->omega_max) : 0;
    double last = 0;
    int64_t negative = -1;
    for (int k = 0; k < ITERATIONS; k++) {
        const double residual = implicit_residual(solid, particles, (double)INFINITY, 0);
        if (!isfinite(residual)) return false;
        if (residual <= FINE || (k && residual <= TOLERANCE && residual > FAST * last))
            return negative <= 0;
        if (!(residual <= FAST * last))
            negative = implicit_factor(solid, particles, (double)INFINITY, shift, NULL, NULL);
        if (negative < 0 || !implicit_correct(solid, particles)) return false;
        found->corrections++;
        last = residual;
    }
    return false;
}

/* Whether surfaces come near each other between the displacements `from` and the present ones, on
 * straight lines, looked at wherever some particle has moved by half a spacing. */
static bool comes_near(const struct solid *solid, struct particles *particles,
                       double *const from[2], struct contact *contact)
{
    double *const u[2] = {particles->ux, particles->uy}, *const to[2] = {particles->vx0,
                                                                         particles->vy0};
    const size_t bytes = (size_t)particles->n * sizeof *particles->ux;
    double moved = 0; /* squared */
    bool near = false;
    if (!contact) return false;
    for (int c = 0; c < 2; c++) memcpy(to[c], u[c], bytes);
    for (int64_t i = 0; i < particles->n; i++)
        moved = max2(moved, square(to[0][i] - from[0][i]) + square(to[1][i] - from[1][i]));
    const int parts = 1 + (int)min2(2 * sqrt(moved) / solid->dp, 1e6);
    for (int k = 1; k <= parts && !near; k++) {
        for (int c = 0; c < 2; c++)
            for (int64_t i = 0; i < particles->n; i++)
                u[c][i] = from[c][i] + (to[c][i] - from[c][i]) * k / parts;
        near = contact_watch(contact, particles, 0, 0, 0);
    }
    return near;
}

/* Load steps: those that fail are halved, those that succeed are doubled. */
static bool load(struct solid *solid, struct particles *particles, struct contact *contact,
                 struct equilibrium *found)
{
    double *const *const start = solid->scratch;
    double done = 0, part = 1;
    while (done < 1) {
        implicit_keep_start(solid, particles);
        solid->implicit->left_out = 1 - done - part;
        if (solid->hinges) constraint_begin(solid->implicit, solid->hinges, particles, 0, false);
        if (balance(solid, particles, found)) {
            if (comes_near(solid, particles, start, contact)) return false;
            done += part;
            part = min2(2 * part, 1 - done);
            found->load_steps++;
            continue;
        }
        memcpy(particles->ux, start[0], (size_t)particles->n * sizeof *particles->ux);
        memcpy(particles->uy, start[1], (size_t)particles->n * sizeof *particles->uy);
        part *= 0.5;
        if (part < shortest_part) return false;
    }
    return true;
}

/* The forces of the start, which load steps leave out in part. A body that no clamp or hinge holds
 * needs those that add up to none; its name and their sum otherwise. */
static int find_fallen(struct solid *solid, const struct particles *particles, double sum[2])
{
    struct implicit *const implicit = solid->implicit;
    double total[solid->n_bodies][3]; /* sum of forces, and of their sizes */
    bool held[solid->n_bodies];
    memset(total, 0, sizeof total);
    memset(held, 0, sizeof held);
    for (int k = 0; solid->hinges && k < solid->hinges->n; k++)
        for (int end = 0; end < 2; end++)
            if (solid->hinges->hinge[k].bond[end] >= 0)
                held[solid->hinges->hinge[k].bond[end]] = true;
    for (int64_t i = 0; i < particles->n; i++) {
        const int bond = solid->body[particles->body[i]].bond;
        held[bond] |= implicit->order[i] < 0;
        if (implicit->order[i] < 0) continue;
        for (int c = 0; c < 2; c++) {
            const double f = implicit->unknown[2 * (int64_t)implicit->order[i] + c];
            solid->scratch[IMPLICIT_LEFT_OUT + c][i] = f;
            total[bond][c] += f;
            total[bond][2] += fabs(f);
        }
    }
    for (int k = 0; k < solid->n_bodies; k++) {
        for (int c = 0; c < 2; c++) sum[c] = total[k][c];
        if (!held[k] && max2(fabs(sum[0]), fabs(sum[1])) > TOLERANCE * total[k][2]) return k;
    }
    return -1;
}

static enum err find(struct equilibrium *found, struct solid *solid, struct particles *particles,
                     const struct scene *scene, struct contact *contact, struct diag *d)
{
    double sum[2];
    if (contact && contact_watch(contact, particles, 0, 0, 0)) return ERR_OK;
    implicit_keep_start(solid, particles);
    if (implicit_residual(solid, particles, (double)INFINITY, 0) == 0) {
        found->found = true;
        return ERR_OK;
    }
    const int fallen = find_fallen(solid, particles, sum);
    if (fallen < 0) {
        found->found = load(solid, particles, contact, found);
        return ERR_OK;
    }
    if (contact && (solid->n_bodies > 1 || scene->n_wall > 0)) return ERR_OK;
    return diag_fail(
        d, ERR_GUARD,
        "%s: [relax]: nothing holds [solid %s] against a force of (%.3g, %.3g) N/m, so there "
        "is no state of rest; give it a `clamp` or a `hinge`, put a [wall] below it, or "
        "leave [relax] out",
        scene_place(scene, scene->solid[fallen].common.line).text, scene->solid[fallen].common.name,
        sum[0], sum[1]);
}

enum err equilibrium_find(struct equilibrium *found, const struct solid *from,
                          struct particles *particles, const struct scene *scene,
                          struct contact *contact, struct diag *d)
{
    const size_t bytes = (size_t)particles->n * sizeof *particles->ux;
    struct arena arena = {0};
    struct solid solid;
    *found = (struct equilibrium){0};
    const double across = implicit_across(from, particles);
    if (from->force_hook || across * across * across > dear * (double)particles->n) return ERR_OK;
    for (int k = 0; k < from->n_bodies; k++)
        if (from->body[k].kappa > 0 && !from->body[k].variational) return ERR_OK;
    enum err e = solid_create(&solid, &arena, scene, particles, true, d);
    double *start[2] = {NULL, NULL};
    for (int c = 0; c < 2 && !e; c++) e = arena_array(&arena, &start[c], particles->n, "start", d);
    if (!e) {
        memcpy(start[0], particles->ux, bytes);
        memcpy(start[1], particles->uy, bytes);
        solid.loads = from->loads;
        solid.hinges = from->hinges;
        solid.gravity_scene = from->gravity_scene;
        solid.calls_out = from->calls_out;
        solid.omega_max = from->omega_max;
        e = implicit_create(&solid, &arena, particles, d);
    }
    if (from->hinges) from->hinges->released = true;
    if (!e) e = find(found, &solid, particles, scene, contact, d);
    if (from->hinges) from->hinges->released = false;
    if (!e && !found->found) {
        memcpy(particles->ux, start[0], bytes);
        memcpy(particles->uy, start[1], bytes);
    }
    arena_free(&arena);
    return e;
}
