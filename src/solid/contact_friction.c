/* SPDX-License-Identifier: MIT */
#include "solid/contact_friction.h"

#include "solid/contact_law.h"

#include <math.h>
#include <string.h>

/* What a surface presses a point of a solid with. */
struct normal_load {
    int32_t group, edge; /* the nearest edge of that surface */
    double distance, force[2];
};

/* More surfaces than these at one point have no friction. */
enum { MAX_LOADS = 4 };

enum err contact_friction_create(struct contact *c, struct arena *a, struct diag *d)
{
    const size_t n = (size_t)c->n_solid_points;
    c->load_head = arena_alloc(a, n, sizeof *c->load_head, "contact", d);
    c->wall_row = arena_alloc(a, n, sizeof *c->wall_row, "contact", d);
    c->wall_damping = arena_alloc(a, n, sizeof *c->wall_row, "contact", d);
    c->point_edge = arena_alloc(a, (size_t)c->n_points, sizeof *c->point_edge, "contact", d);
    if (!c->load_head || !c->wall_row || !c->wall_damping || !c->point_edge) return ERR_MEMORY;
    for (int64_t k = 0; k < c->n_edges; k++)
        c->point_edge[c->edge[k].a] = c->point_edge[c->edge[k].b] = (int32_t)k;
    return ERR_OK;
}

/* --- what presses a point --- */

static void add_load(struct contact *c, int32_t point, int64_t pair, int part)
{
    const int64_t slot = CONTACT_LOADS * pair + part;
    c->load_next[slot] = c->load_head[point];
    c->load_head[point] = (int32_t)slot;
}

/* A wall is rigid and its points have no state: what they press is on the solid's points. */
static void list_loads(struct contact *c)
{
    memset(c->load_head, 0xff, (size_t)c->n_solid_points * sizeof *c->load_head);
    for (int64_t k = 0; k < c->n_pairs; k++) {
        if (!c->force[k].touches) continue;
        if (c->pair_point[k] < c->n_solid_points) {
            add_load(c, c->pair_point[k], k, 0);
        } else {
            add_load(c, c->edge[c->pair_edge[k]].a, k, 1);
            add_load(c, c->edge[c->pair_edge[k]].b, k, 2);
        }
    }
}

/* Notes an edge among the surfaces `on` a point; the surface's number, or MAX_LOADS. */
static int load_of_surface(const struct contact *c, int32_t edge, double distance,
                           struct normal_load on[MAX_LOADS], int *n)
{
    const int32_t group = c->group[c->edge[edge].a];
    int k = 0;
    while (k < *n && on[k].group != group) k++;
    if (k == MAX_LOADS) return k;
    if (k == *n) on[(*n)++] = (struct normal_load){group, edge, distance, {0}};
    if (distance < on[k].distance) on[k].edge = edge, on[k].distance = distance;
    return k;
}

static int loads_on(const struct contact *c, int32_t point, struct normal_load on[MAX_LOADS])
{
    int n = 0;
    for (int32_t slot = c->load_head[point]; slot >= 0; slot = c->load_next[slot]) {
        const int64_t pair = slot / CONTACT_LOADS;
        const int part = slot % CONTACT_LOADS;
        const struct contact_force *const from = &c->force[pair];
        const double *const f = part == 0 ? from->p : part == 1 ? from->a : from->b;
        const int32_t edge = part ? c->point_edge[c->pair_point[pair]] : c->pair_edge[pair];
        const int k = load_of_surface(c, edge, part ? (double)INFINITY : from->distance, on, &n);
        if (k == MAX_LOADS) continue;
        on[k].force[0] += f[0];
        on[k].force[1] += f[1];
    }
    return n;
}

/* --- places that move with an edge --- */

/* The first end and the line to the other, or a line of 1 m if both are the same. */
static void frame_of(const struct contact *c, int32_t edge, double e[2])
{
    const int32_t a = c->edge[edge].a, b = c->edge[edge].b;
    e[0] = a == b ? 1 : c->x[b] - c->x[a];
    e[1] = a == b ? 0 : c->y[b] - c->y[a];
}

/* Along the edge and across it, both in its lengths. */
static void place_on(const struct contact *c, int32_t edge, double x, double y, double place[2])
{
    const int32_t a = c->edge[edge].a;
    double e[2];
    frame_of(c, edge, e);
    const double dx = x - c->x[a], dy = y - c->y[a], length2 = e[0] * e[0] + e[1] * e[1];
    place[0] = (e[0] * dx + e[1] * dy) / length2;
    place[1] = (e[0] * dy - e[1] * dx) / length2;
}

/* --- force --- */

/* A tangential spring with the displacement u across the normal n, a dashpot and a slider. */
struct spring {
    int32_t edge; /* that its place moves with */
    double n[2], u[2], normal_force, force, stiffness, damping, friction;
};

static struct contact_law law_of(const struct contact *c, int32_t point, int32_t edge)
{
    return c->law[c->body[point] * (c->n_solids + c->n_walls) + c->body[c->edge[edge].a]];
}

/* Both halves of the force between a solid and a wall act on the points of the solid. */
static double halves(const struct contact *c, int32_t edge)
{
    return c->edge[edge].a < c->n_solid_points ? 1 : 1 / CONTACT_HALF;
}

static struct spring spring_constants(const struct contact *c, int32_t point, int32_t edge)
{
    const struct contact_law law = law_of(c, point, edge);
    const struct contact_constants q = contact_constants_of(c, &law, point, edge, 0);
    return (struct spring){
        .edge = edge,
        .stiffness = halves(c, edge) * law.shear * q.stiffness,
        .damping = halves(c, edge) * q.tangential_damping,
        .friction = q.friction,
    };
}

/* Edge of the place that a point holds to, if on this surface; else -1. */
static int32_t spring_edge(const struct contact *c, const struct particles *p, int32_t point,
                           int32_t group)
{
    const int64_t edge = p->stick_edge[c->index[point]] - 1;
    return edge >= 0 && edge < c->n_edges && c->group[c->edge[edge].a] == group ? (int32_t)edge
                                                                                : -1;
}

/* normal_force = 0: there is no friction. */
static struct spring spring_at(const struct contact *c, const struct particles *p, int32_t point,
                               const struct normal_load *on)
{
    const int32_t edge = spring_edge(c, p, point, on->group), i = c->index[point];
    struct spring h = spring_constants(c, point, edge < 0 ? on->edge : edge);
    const double *const f = on->force;
    h.normal_force = h.friction > 0 ? sqrt(f[0] * f[0] + f[1] * f[1]) : 0;
    if (!(h.normal_force > 0)) return h;
    for (int k = 0; k < 2; k++) h.n[k] = f[k] / h.normal_force;
    if (edge < 0) return h;
    const int32_t a = c->edge[edge].a;
    double e[2];
    frame_of(c, edge, e);
    const double x = c->x[a] + p->stick_along[i] * e[0] - p->stick_across[i] * e[1];
    const double y = c->y[a] + p->stick_along[i] * e[1] + p->stick_across[i] * e[0];
    const double d[2] = {c->x[point] - x, c->y[point] - y};
    for (int k = 0; k < 2; k++) h.u[k] = across(h.n, d, k);
    h.force = h.stiffness * sqrt(h.u[0] * h.u[0] + h.u[1] * h.u[1]);
    return h;
}

/* The edge bears the opposite force as if it reached to the point: both act along one line, and
 * the work of the spring is that of its energy. */
static void add_friction(struct contact *c, struct particles *p, int32_t point,
                         const struct spring *h)
{
    const int32_t a = c->edge[h->edge].a, b = c->edge[h->edge].b;
    const double w[2] = {c->vx[b] - c->vx[a], c->vy[b] - c->vy[a]};
    double at[2];
    place_on(c, h->edge, c->x[point], c->y[point], at);
    const double v[2] = {c->vx[point] - (c->vx[a] + at[0] * w[0] - at[1] * w[1]),
                         c->vy[point] - (c->vy[a] + at[0] * w[1] + at[1] * w[0])};
    double f[2];
    for (int k = 0; k < 2; k++) f[k] = -h->stiffness * h->u[k] - h->damping * across(h->n, v, k);
    const double size = sqrt(f[0] * f[0] + f[1] * f[1]), most = h->friction * h->normal_force;
    const double less = size > most ? most / size : 1;
    f[0] *= less;
    f[1] *= less;
    const double fb[2] = {-(at[0] * f[0] + at[1] * f[1]), -(at[0] * f[1] - at[1] * f[0])};
    const double fa[2] = {-f[0] - fb[0], -f[1] - fb[1]};
    contact_add_force(c, p, point, f);
    contact_add_force(c, p, a, fa);
    contact_add_force(c, p, b, fb);
}

void contact_friction_forces(struct contact *c, struct particles *p)
{
    list_loads(c);
    for (int32_t point = 0; point < c->n_solid_points; point++) {
        struct normal_load on[MAX_LOADS];
        const int n = loads_on(c, point, on);
        for (int k = 0; k < n; k++) {
            const struct spring h = spring_at(c, p, point, &on[k]);
            if (h.normal_force > 0) add_friction(c, p, point, &h);
        }
    }
}

double contact_friction_energy(struct contact *c, const struct particles *p)
{
    double sum = 0;
    list_loads(c);
    for (int32_t point = 0; point < c->n_solid_points; point++) {
        struct normal_load on[MAX_LOADS];
        const int n = loads_on(c, point, on);
        for (int k = 0; k < n; k++) {
            const struct spring h = spring_at(c, p, point, &on[k]);
            if (h.force > 0)
                sum += 0.5 * square(min2(h.force, h.friction * h.normal_force)) / h.stiffness;
        }
    }
    return sum;
}

/* --- after a step --- */

/* A point keeps to the surface that it holds to until it leaves it; then it takes the nearest.
 * -1: none. */
static int load_with_spring(const struct contact *c, const struct particles *p, int32_t point,
                            const struct normal_load *on, int n)
{
    int best = -1;
    for (int k = 0; k < n; k++) {
        if (!(spring_at(c, p, point, &on[k]).normal_force > 0)) continue;
        if (spring_edge(c, p, point, on[k].group) >= 0) return k;
        if (best < 0 || on[k].distance < on[best].distance) best = k;
    }
    return best;
}

void contact_slide(struct contact *c, struct particles *p)
{
    if (!c->friction) return;
    for (int32_t point = 0; point < c->n_solid_points; point++) {
        struct normal_load on[MAX_LOADS];
        const int n = loads_on(c, point, on), k = load_with_spring(c, p, point, on, n);
        const int32_t i = c->index[point];
        if (k < 0) {
            p->stick_edge[i] = 0;
            continue;
        }
        const struct spring h = spring_at(c, p, point, &on[k]);
        const double most = h.friction * h.normal_force, less = h.force > most ? most / h.force : 1;
        double place[2];
        place_on(c, on[k].edge, c->x[point] - less * h.u[0], c->y[point] - less * h.u[1], place);
        p->stick_edge[i] = on[k].edge + 1;
        p->stick_along[i] = place[0];
        p->stick_across[i] = place[1];
    }
}

/* --- before a step --- */

static double per_mass(const struct contact *c, const struct particles *p, int32_t point)
{
    return p->free[c->index[point]] / c->solid->body[c->body[point]].mass;
}

/* The rows of T-62a of a point that holds to a solid: the weights are those of add_friction(). */
static void add_spring_rows(struct contact *c, const struct particles *p, int32_t point,
                            const struct spring *h)
{
    const int32_t a = c->edge[h->edge].a, b = c->edge[h->edge].b;
    double at[2];
    place_on(c, h->edge, c->x[point], c->y[point], at);
    const double to_b = sqrt(square(at[0]) + square(at[1]));
    const double to_a = sqrt(square(1 - at[0]) + square(at[1]));
    const double all =
        p->free[c->index[point]] + to_a * p->free[c->index[a]] + to_b * p->free[c->index[b]];
    contact_add_row(c, p, point, all, h->stiffness, h->damping);
    contact_add_row(c, p, a, to_a * all, h->stiffness, h->damping);
    contact_add_row(c, p, b, to_b * all, h->stiffness, h->damping);
}

/* A point that holds to walls does so with one spring, whichever pairs press it. */
static void add_wall_spring(struct contact *c, const struct particles *p, int32_t point,
                            int32_t edge)
{
    const struct spring h = spring_constants(c, point, edge);
    if (!(h.friction > 0)) return;
    c->wall_row[point] = max2(c->wall_row[point], h.stiffness * per_mass(c, p, point));
    c->wall_damping[point] = max2(c->wall_damping[point], h.damping * per_mass(c, p, point));
}

void contact_friction_rows(struct contact *c, const struct particles *p, int64_t first, int64_t end)
{
    const int32_t point = c->pair_point[first];
    struct normal_load on[MAX_LOADS];
    int n = 0;
    for (int64_t k = first; k < end; k++) {
        const int32_t edge = c->pair_edge[k];
        if (!c->force[k].near) continue;
        if (point >= c->n_solid_points) {
            add_wall_spring(c, p, c->edge[edge].a, c->point_edge[point]);
            add_wall_spring(c, p, c->edge[edge].b, c->point_edge[point]);
        } else if (c->edge[edge].a >= c->n_solid_points) {
            add_wall_spring(c, p, point, edge);
        } else {
            load_of_surface(c, edge, c->force[k].distance, on, &n);
        }
    }
    for (int k = 0; k < n; k++) {
        const struct spring h = spring_constants(c, point, on[k].edge);
        if (h.friction > 0) add_spring_rows(c, p, point, &h);
    }
}
