/* SPDX-License-Identifier: MIT
 * Hinges of solids: forces that hold a point of a body in place or on another body (T-81). */
#include "solid/hinges.h"
#include "case/params.h"
#include "base/cholesky.h"
#include "particles/kernel.h"

/* --- start --- */

/* Which end of a hinge a particle belongs to: 1 its own body, 2 the other; 0: none. */
static int end_of(const struct hinges *hinges, const struct solid *solid,
                  const struct particles *particles, int64_t i, int hinge)
{
    const struct hinge *const h = &hinges->hinge[hinge];
    const struct solid_body *const body = &solid->body[particles->body[i]];
    const double r2 = square(particles->X[i] - h->at[0]) + square(particles->Y[i] - h->at[1]);
    if (!(r2 < square(KERNEL_REACH * body->h))) return 0;
    return body->bond == h->bond[0] ? 1 : body->bond == h->bond[1] ? 2 : 0;
}

static int64_t list_nodes(struct hinges *hinges, const struct solid *solid,
                          const struct particles *particles, struct hinge_node *node)
{
    int64_t n = 0;
    for (int64_t i = 0; i < particles->n; i++)
        for (int k = 0; k < hinges->n; k++) {
            const int end = end_of(hinges, solid, particles, i, k);
            if (!end) continue;
            if (node)
                node[n] = (struct hinge_node){.hinge = k,
                                              .end = end,
                                              .particle = (int32_t)i,
                                              .inv_mass = particles->free[i] /
                                                          solid->body[particles->body[i]].mass};
            n++;
        }
    return n;
}

/* T-81: weights of a linear interpolation at the point by moving least squares. */
static enum err find_weights(struct hinges *hinges, const struct solid *solid,
                             const struct particles *particles, int hinge, int end, struct diag *d)
{
    const struct hinge *const h = &hinges->hinge[hinge];
    const char *const name = hinges->scene->solid[h->body[end - 1]].common.name;
    double M[3][3] = {{0}}, z[3] = {1, 0, 0}, nearest = (double)INFINITY;
    for (int64_t k = 0; k < hinges->n_nodes; k++) {
        struct hinge_node *const node = &hinges->node[k];
        if (node->hinge != hinge || node->end != end) continue;
        const double size = solid->body[particles->body[node->particle]].h;
        const double b[3] = {1, (particles->X[node->particle] - h->at[0]) / size,
                             (particles->Y[node->particle] - h->at[1]) / size};
        const double r = size * sqrt(b[1] * b[1] + b[2] * b[2]);
        node->weight = square(size) * kernel_w(r, size);
        for (int m = 0; m < 9; m++) M[m / 3][m % 3] += node->weight * b[m / 3] * b[m % 3];
        nearest = min2(nearest, r);
    }
    /* At the edge of the body or up to a spacing off, as in the gap to another one. */
    if (!(nearest <= 1.5 * solid->body[h->body[end - 1]].dp))
        return fail_at(d, hinges->scene, h->line,
                       "the hinge at (%.6g, %.6g) m is not on [solid %s]; choose a point of the "
                       "body",
                       h->at[0], h->at[1], name);
    if (cholesky_solve(&M[0][0], 3, 3, 1e-6, z) < 3)
        return fail_at(d, hinges->scene, h->line,
                       "the hinge at (%.6g, %.6g) m has too few particles of [solid %s] around "
                       "it; a body needs at least 2 particles across",
                       h->at[0], h->at[1], name);
    for (int64_t k = 0; k < hinges->n_nodes; k++) {
        struct hinge_node *const node = &hinges->node[k];
        if (node->hinge != hinge || node->end != end) continue;
        const double size = solid->body[particles->body[node->particle]].h;
        node->weight *= z[0] + z[1] * (particles->X[node->particle] - h->at[0]) / size +
                        z[2] * (particles->Y[node->particle] - h->at[1]) / size;
        if (end == 2) node->weight = -node->weight;
    }
    return ERR_OK;
}

/* The matrix of the hinges' forces, in which `face` is the direction in which the fluid resists a
 * particle's kick (T-35a): what one hinge's force does to the velocity of another's point. */
static void assemble(struct hinges *hinges, const struct particles *particles, bool resisted)
{
    const int n2 = 2 * hinges->n;
    memset(hinges->matrix, 0, (size_t)n2 * (size_t)n2 * sizeof *hinges->matrix);
    for (int64_t first = 0, end; first < hinges->n_nodes; first = end) {
        const int32_t i = hinges->node[first].particle;
        const double fx = resisted ? particles->face_x[i] : 0;
        const double fy = resisted ? particles->face_y[i] : 0;
        for (end = first; end < hinges->n_nodes && hinges->node[end].particle == i; end++) {
            const struct hinge_node *const a = &hinges->node[end];
            double *const row = &hinges->matrix[2 * a->hinge * n2];
            for (int64_t k = first; k <= end; k++) {
                const struct hinge_node *const b = &hinges->node[k];
                const double both = a->weight * b->weight * a->inv_mass;
                double *const to = &row[2 * b->hinge];
                to[0] += both * (1 - fx * fx);
                to[1] -= both * fx * fy;
                to[n2] -= both * fx * fy;
                to[n2 + 1] += both * (1 - fy * fy);
            }
        }
    }
}

static void set_hinge(struct hinges *hinges, const struct solid *solid, int body,
                      const struct hinge_point *from)
{
    const struct scene *const scene = hinges->scene;
    const int other = scene_find(scene, SECTION_solid, from->other),
              wall = scene_find(scene, SECTION_wall, from->other);
    hinges->hinge[hinges->n++] = (struct hinge){
        .at = {from->at[0], from->at[1]},
        .body = {body, other},
        .bond = {solid->body[body].bond, other >= 0 ? solid->body[other].bond : -1},
        .motion = other < 0 ? scene_wall_motion(scene, wall) : -1,
        .line = from->line,
    };
}

/* Whether something can move at every hinge, and independently. */
static enum err check_hinges(struct hinges *hinges, const struct particles *particles,
                             struct diag *d)
{
    assemble(hinges, particles, false);
    const int rank =
        cholesky_solve(hinges->matrix, 2 * hinges->n, 2 * hinges->n, 1e-9, hinges->force);
    if (rank == 2 * hinges->n) return ERR_OK;
    const struct hinge *const h = &hinges->hinge[rank / 2];
    return fail_at(d, hinges->scene, h->line,
                   "the hinge at (%.6g, %.6g) m holds nothing that could move: a clamp or another "
                   "hinge of [solid %s] holds this point; leave one out",
                   h->at[0], h->at[1], hinges->scene->solid[h->body[0]].common.name);
}

enum err hinges_create(struct solid *solid, struct arena *a, const struct scene *scene,
                       const struct particles *particles, struct diag *d)
{
    struct hinges *const hinges = arena_alloc(a, 1, sizeof *hinges, "hinges", d);
    size_t n = 0;
    if (!hinges) return ERR_MEMORY;
    solid->hinges = hinges;
    for (int body = 0; body < scene->n_solid; body++) n += (size_t)scene->solid[body].hinge.n;
    *hinges = (struct hinges){.scene = scene};
    TRY(arena_array(a, &hinges->hinge, n, "hinges", d));
    TRY(arena_array(a, &hinges->matrix, 4 * n * n, "hinges", d));
    TRY(arena_array(a, &hinges->force, 2 * n, "hinges", d));
    for (int body = 0; body < scene->n_solid; body++)
        for (int k = 0; k < scene->solid[body].hinge.n; k++)
            set_hinge(hinges, solid, body, &scene->solid[body].hinge.item[k]);
    for (int k = 0; k < hinges->n; k++)
        if (hinges->hinge[k].bond[0] == hinges->hinge[k].bond[1])
            return fail_at(d, hinges->scene, hinges->hinge[k].line,
                           "the hinge at (%.6g, %.6g) m connects [solid %s] with [solid %s], to "
                           "which it is joined; leave it out",
                           hinges->hinge[k].at[0], hinges->hinge[k].at[1],
                           hinges->scene->solid[hinges->hinge[k].body[0]].common.name,
                           hinges->scene->solid[hinges->hinge[k].body[1]].common.name);
    hinges->n_nodes = list_nodes(hinges, solid, particles, NULL);
    TRY(arena_array(a, &hinges->node, hinges->n_nodes, "particles of hinges", d));
    list_nodes(hinges, solid, particles, hinges->node);
    for (int k = 0; k < hinges->n; k++) {
        TRY(find_weights(hinges, solid, particles, k, 1, d));
        if (hinges->hinge[k].bond[1] >= 0) TRY(find_weights(hinges, solid, particles, k, 2, d));
    }
    return check_hinges(hinges, particles, d);
}

/* --- during the run --- */

/* What the wall of a hinge does at a time: displacement, velocity, acceleration; zero without. */
static struct motion_point place_of(const struct hinges *hinges, const struct hinge *h, double time)
{
    struct motion_point at = {{0, 0}, {0, 0}, {0, 0}};
    if (h->motion < 0) return at;
    const struct motion_state state = motion_at(hinges->scene, h->motion, time);
    at = motion_of_point(&state, h->at[0], h->at[1]);
    for (int c = 0; c < 2; c++) at.x[c] -= h->at[c];
    return at;
}

void hinges_place(const struct hinges *hinges, int hinge, double time, double to[2])
{
    memcpy(to, place_of(hinges, &hinges->hinge[hinge], time).x, 2 * sizeof *to);
}

static void subtract_value(const struct hinge_node *node, double x, double y, double *from)
{
    from[2 * node->hinge] -= node->weight * x;
    from[2 * node->hinge + 1] -= node->weight * y;
}

void hinges_subtract(const struct hinges *hinges, const double *x, const double *y, double *from)
{
    for (int64_t k = 0; k < hinges->n_nodes; k++) {
        const struct hinge_node *const node = &hinges->node[k];
        subtract_value(node, x[node->particle], y[node->particle], from);
    }
}

void hinges_push(const struct hinges *hinges, const double *force, double *x, double *y)
{
    for (int64_t k = 0; k < hinges->n_nodes; k++) {
        const struct hinge_node *const node = &hinges->node[k];
        const double per_force = node->weight * node->inv_mass;
        x[node->particle] += per_force * force[2 * node->hinge];
        y[node->particle] += per_force * force[2 * node->hinge + 1];
    }
}

/* Solves T-81 for what the points lack without the hinges, in `force`. */
static void solve_hinges(struct hinges *hinges, const struct particles *particles, bool resisted)
{
    assemble(hinges, particles, resisted);
    /* Positive: check_hinges has tested it, and T-35a takes less than all of a velocity. */
    (void)cholesky_solve(hinges->matrix, 2 * hinges->n, 2 * hinges->n, 0, hinges->force);
}

void hinges_start(struct hinges *hinges, struct particles *particles)
{
    for (int k = 0; k < hinges->n; k++)
        memcpy(&hinges->force[2 * k], place_of(hinges, &hinges->hinge[k], 0).v, 2 * sizeof(double));
    hinges_subtract(hinges, particles->vx, particles->vy, hinges->force);
    solve_hinges(hinges, particles, false);
    hinges_push(hinges, hinges->force, particles->vx, particles->vy);
}

/* The velocity of particle i after a kick of dt without hinges (T-35a), or its acceleration. */
static void value_of(const struct particles *particles, int32_t i, double dt, bool resisted,
                     double value[2])
{
    value[0] = particles->sx[i];
    value[1] = particles->sy[i];
    if (!(dt > 0)) return;
    value[0] = particles->vx[i] + dt * particles->sx[i];
    value[1] = particles->vy[i] + dt * particles->sy[i];
    if (!resisted) return;
    const double fx = particles->face_x[i], fy = particles->face_y[i];
    const double excess = value[0] * fx + value[1] * fy - particles->face_v[i];
    value[0] -= excess * fx;
    value[1] -= excess * fy;
}

/* The velocity or acceleration that brings each point to its place a drift of dt later. */
static void find_targets(struct hinges *hinges, const struct particles *particles, double time,
                         double dt)
{
    double *const target = hinges->force;
    for (int k = 0; k < hinges->n; k++) {
        const struct motion_point to = place_of(hinges, &hinges->hinge[k], time + dt);
        for (int c = 0; c < 2; c++) target[2 * k + c] = dt > 0 ? to.x[c] : to.a[c];
    }
    if (!(dt > 0)) return;
    hinges_subtract(hinges, particles->ux, particles->uy, target);
    for (int k = 0; k < 2 * hinges->n; k++) target[k] /= dt;
}

void hinges_forces(struct hinges *hinges, struct particles *particles, double time, double dt,
                   bool resisted)
{
    if (hinges->released) return;
    find_targets(hinges, particles, time, dt);
    for (int k = 0; k < hinges->n; k++)
        for (int c = 0; c < 2; c++) hinges->hinge[k].target[c] = hinges->force[2 * k + c];
    for (int64_t k = 0; k < hinges->n_nodes; k++) {
        double value[2];
        value_of(particles, hinges->node[k].particle, dt, resisted, value);
        subtract_value(&hinges->node[k], value[0], value[1], hinges->force);
    }
    solve_hinges(hinges, particles, resisted);
    if (dt > 0)
        for (int k = 0; k < 2 * hinges->n; k++) hinges->force[k] /= dt;
    hinges_push(hinges, hinges->force, particles->sx, particles->sy);
    hinges->kick_time = dt;
}

void hinges_hold(struct hinges *hinges, double *const a[2], double *const force[2], double time)
{
    for (int k = 0; k < hinges->n; k++)
        memcpy(&hinges->force[2 * k], place_of(hinges, &hinges->hinge[k], time).a,
               2 * sizeof(double));
    hinges_subtract(hinges, a[0], a[1], hinges->force);
    solve_hinges(hinges, NULL, false);
    for (int64_t k = 0; k < hinges->n_nodes; k++) {
        const struct hinge_node *const node = &hinges->node[k];
        if (node->inv_mass == 0) continue;
        for (int c = 0; c < 2; c++) {
            const double f = node->weight * hinges->force[2 * node->hinge + c];
            a[c][node->particle] += node->inv_mass * f;
            force[c][node->particle] += f;
        }
    }
}

double hinges_work(const struct hinges *hinges, const double *vx, const double *vy, double dt,
                   double *on)
{
    double work = 0, before[2 * hinges->n]; /* velocities against the motion */
    memset(before, 0, sizeof before);
    hinges_subtract(hinges, vx, vy, before);
    for (int k = 0; k < hinges->n; k++) {
        const struct hinge *const h = &hinges->hinge[k];
        double done = 0;
        if (h->motion < 0) continue;
        for (int c = 0; c < 2; c++) {
            const double v = -before[2 * k + c];
            const double after = hinges->kick_time > 0 ? h->target[c] : v + dt * h->target[c];
            done += 0.5 * dt * hinges->force[2 * k + c] * (v + after);
        }
        work += done;
        on[h->body[0]] += done;
    }
    return work;
}
