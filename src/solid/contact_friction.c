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

enum err contact_friction_create(struct contact *contact, struct arena *a, struct diag *d)
{
    const size_t n = (size_t)contact->n_solid_points;
    contact->load_head = arena_alloc(a, n, sizeof *contact->load_head, "contact", d);
    contact->wall_row = arena_alloc(a, n, sizeof *contact->wall_row, "contact", d);
    contact->wall_damping = arena_alloc(a, n, sizeof *contact->wall_row, "contact", d);
    contact->point_edge =
        arena_alloc(a, (size_t)contact->n_points, sizeof *contact->point_edge, "contact", d);
    if (!contact->load_head || !contact->wall_row || !contact->wall_damping || !contact->point_edge)
        return ERR_MEMORY;
    for (int64_t k = 0; k < contact->n_edges; k++)
        contact->point_edge[contact->edge[k].a] = contact->point_edge[contact->edge[k].b] =
            (int32_t)k;
    return ERR_OK;
}

/* --- what presses a point --- */

static void add_load(struct contact *contact, int32_t point, int64_t pair, int part)
{
    const int64_t slot = CONTACT_LOADS * pair + part;
    contact->load_next[slot] = contact->load_head[point];
    contact->load_head[point] = (int32_t)slot;
}

/* A wall is rigid and its points have no state: what they press is on the solid's points. */
static void list_loads(struct contact *contact)
{
    memset(contact->load_head, 0xff, (size_t)contact->n_solid_points * sizeof *contact->load_head);
    for (int64_t k = 0; k < contact->n_pairs; k++) {
        if (!contact->force[k].touches) continue;
        if (contact->pair_point[k] < contact->n_solid_points) {
            add_load(contact, contact->pair_point[k], k, 0);
        } else {
            add_load(contact, contact->edge[contact->pair_edge[k]].a, k, 1);
            add_load(contact, contact->edge[contact->pair_edge[k]].b, k, 2);
        }
    }
}

/* Notes an edge among the surfaces `on` a point; the surface's number, or MAX_LOADS. */
static int load_of_surface(const struct contact *contact, int32_t edge, double distance,
                           struct normal_load on[MAX_LOADS], int *n)
{
    const int32_t group = contact->group[contact->edge[edge].a];
    int k = 0;
    while (k < *n && on[k].group != group) k++;
    if (k == MAX_LOADS) return k;
    if (k == *n) on[(*n)++] = (struct normal_load){group, edge, distance, {0}};
    if (distance < on[k].distance) on[k].edge = edge, on[k].distance = distance;
    return k;
}

static int loads_on(const struct contact *contact, int32_t point, struct normal_load on[MAX_LOADS])
{
    int n = 0;
    for (int32_t slot = contact->load_head[point]; slot >= 0; slot = contact->load_next[slot]) {
        const int64_t pair = slot / CONTACT_LOADS;
        const int part = slot % CONTACT_LOADS;
        const struct contact_force *const from = &contact->force[pair];
        const double *const f = part == 0 ? from->p : part == 1 ? from->a : from->b;
        const int32_t edge =
            part ? contact->point_edge[contact->pair_point[pair]] : contact->pair_edge[pair];
        const int k =
            load_of_surface(contact, edge, part ? (double)INFINITY : from->distance, on, &n);
        if (k == MAX_LOADS) continue;
        on[k].force[0] += f[0];
        on[k].force[1] += f[1];
    }
    return n;
}

/* --- places that move with an edge --- */

/* The first end and the line to the other, or a line of 1 m if both are the same. */
static void frame_of(const struct contact *contact, int32_t edge, double e[2])
{
    const int32_t a = contact->edge[edge].a, b = contact->edge[edge].b;
    e[0] = a == b ? 1 : contact->x[b] - contact->x[a];
    e[1] = a == b ? 0 : contact->y[b] - contact->y[a];
}

/* Along the edge and across it, both in its lengths. */
static void place_on(const struct contact *contact, int32_t edge, double x, double y,
                     double place[2])
{
    const int32_t a = contact->edge[edge].a;
    double e[2];
    frame_of(contact, edge, e);
    const double dx = x - contact->x[a], dy = y - contact->y[a],
                 length2 = e[0] * e[0] + e[1] * e[1];
    place[0] = (e[0] * dx + e[1] * dy) / length2;
    place[1] = (e[0] * dy - e[1] * dx) / length2;
}

/* --- force --- */

/* A tangential spring with the displacement u across the normal n, a dashpot and a slider. */
struct spring {
    int32_t edge; /* that its place moves with */
    double n[2], u[2], normal_force, force, stiffness, damping, friction;
};

static struct contact_law law_of(const struct contact *contact, int32_t point, int32_t edge)
{
    return contact->law[contact->body[point] * (contact->n_solids + contact->n_walls) +
                        contact->body[contact->edge[edge].a]];
}

/* Both halves of the force between a solid and a wall act on the points of the solid. */
static double halves(const struct contact *contact, int32_t edge)
{
    return contact->edge[edge].a < contact->n_solid_points ? 1 : 1 / CONTACT_HALF;
}

static struct spring spring_constants(const struct contact *contact, int32_t point, int32_t edge)
{
    const struct contact_law law = law_of(contact, point, edge);
    const struct contact_constants q = contact_constants_of(contact, &law, point, edge, 0);
    return (struct spring){
        .edge = edge,
        .stiffness = halves(contact, edge) * law.shear * q.stiffness,
        .damping = halves(contact, edge) * q.tangential_damping,
        .friction = q.friction,
    };
}

/* Edge of the place that a point holds to, if on this surface; else -1. */
static int32_t spring_edge(const struct contact *contact, const struct particles *particles,
                           int32_t point, int32_t group)
{
    const int64_t edge = particles->stick_edge[contact->index[point]] - 1;
    return edge >= 0 && edge < contact->n_edges && contact->group[contact->edge[edge].a] == group
               ? (int32_t)edge
               : -1;
}

/* normal_force = 0: there is no friction. */
static struct spring spring_at(const struct contact *contact, const struct particles *particles,
                               int32_t point, const struct normal_load *on)
{
    const int32_t edge = spring_edge(contact, particles, point, on->group),
                  i = contact->index[point];
    struct spring h = spring_constants(contact, point, edge < 0 ? on->edge : edge);
    const double *const f = on->force;
    h.normal_force = h.friction > 0 ? sqrt(f[0] * f[0] + f[1] * f[1]) : 0;
    if (!(h.normal_force > 0)) return h;
    for (int k = 0; k < 2; k++) h.n[k] = f[k] / h.normal_force;
    if (edge < 0) return h;
    const int32_t a = contact->edge[edge].a;
    double e[2];
    frame_of(contact, edge, e);
    const double x =
        contact->x[a] + particles->stick_along[i] * e[0] - particles->stick_across[i] * e[1];
    const double y =
        contact->y[a] + particles->stick_along[i] * e[1] + particles->stick_across[i] * e[0];
    const double d[2] = {contact->x[point] - x, contact->y[point] - y};
    for (int k = 0; k < 2; k++) h.u[k] = across(h.n, d, k);
    h.force = h.stiffness * sqrt(h.u[0] * h.u[0] + h.u[1] * h.u[1]);
    return h;
}

/* The edge bears the opposite force as if it reached to the point: both act along one line, and
 * the work of the spring is that of its energy. */
static void add_friction(struct contact *contact, struct particles *particles, int32_t point,
                         const struct spring *h)
{
    const int32_t a = contact->edge[h->edge].a, b = contact->edge[h->edge].b;
    const double w[2] = {contact->vx[b] - contact->vx[a], contact->vy[b] - contact->vy[a]};
    double at[2];
    place_on(contact, h->edge, contact->x[point], contact->y[point], at);
    const double v[2] = {contact->vx[point] - (contact->vx[a] + at[0] * w[0] - at[1] * w[1]),
                         contact->vy[point] - (contact->vy[a] + at[0] * w[1] + at[1] * w[0])};
    double f[2];
    for (int k = 0; k < 2; k++) f[k] = -h->stiffness * h->u[k] - h->damping * across(h->n, v, k);
    const double size = sqrt(f[0] * f[0] + f[1] * f[1]), most = h->friction * h->normal_force;
    const double less = size > most ? most / size : 1;
    f[0] *= less;
    f[1] *= less;
    const double fb[2] = {-(at[0] * f[0] + at[1] * f[1]), -(at[0] * f[1] - at[1] * f[0])};
    const double fa[2] = {-f[0] - fb[0], -f[1] - fb[1]};
    contact_add_force(contact, particles, point, f);
    contact_add_force(contact, particles, a, fa);
    contact_add_force(contact, particles, b, fb);
}

void contact_friction_forces(struct contact *contact, struct particles *particles)
{
    list_loads(contact);
    for (int32_t point = 0; point < contact->n_solid_points; point++) {
        struct normal_load on[MAX_LOADS];
        const int n = loads_on(contact, point, on);
        for (int k = 0; k < n; k++) {
            const struct spring h = spring_at(contact, particles, point, &on[k]);
            if (h.normal_force > 0) add_friction(contact, particles, point, &h);
        }
    }
}

double contact_friction_energy(struct contact *contact, const struct particles *particles)
{
    double sum = 0;
    list_loads(contact);
    for (int32_t point = 0; point < contact->n_solid_points; point++) {
        struct normal_load on[MAX_LOADS];
        const int n = loads_on(contact, point, on);
        for (int k = 0; k < n; k++) {
            const struct spring h = spring_at(contact, particles, point, &on[k]);
            if (h.force > 0)
                sum += 0.5 * square(min2(h.force, h.friction * h.normal_force)) / h.stiffness;
        }
    }
    return sum;
}

/* --- after a step --- */

/* A point keeps to the surface that it holds to until it leaves it; then it takes the nearest.
 * -1: none. */
static int load_with_spring(const struct contact *contact, const struct particles *particles,
                            int32_t point, const struct normal_load *on, int n)
{
    int best = -1;
    for (int k = 0; k < n; k++) {
        if (!(spring_at(contact, particles, point, &on[k]).normal_force > 0)) continue;
        if (spring_edge(contact, particles, point, on[k].group) >= 0) return k;
        if (best < 0 || on[k].distance < on[best].distance) best = k;
    }
    return best;
}

void contact_slide(struct contact *contact, struct particles *particles)
{
    if (!contact->friction) return;
    for (int32_t point = 0; point < contact->n_solid_points; point++) {
        struct normal_load on[MAX_LOADS];
        const int n = loads_on(contact, point, on),
                  k = load_with_spring(contact, particles, point, on, n);
        const int32_t i = contact->index[point];
        if (k < 0) {
            particles->stick_edge[i] = 0;
            continue;
        }
        const struct spring h = spring_at(contact, particles, point, &on[k]);
        const double most = h.friction * h.normal_force, less = h.force > most ? most / h.force : 1;
        double place[2];
        place_on(contact, on[k].edge, contact->x[point] - less * h.u[0],
                 contact->y[point] - less * h.u[1], place);
        particles->stick_edge[i] = on[k].edge + 1;
        particles->stick_along[i] = place[0];
        particles->stick_across[i] = place[1];
    }
}

/* --- before a step --- */

static double per_mass(const struct contact *contact, const struct particles *particles,
                       int32_t point)
{
    return particles->free[contact->index[point]] / contact->solid->body[contact->body[point]].mass;
}

/* The rows of T-62a of a point that holds to a solid: the weights are those of add_friction(). */
static void add_spring_rows(struct contact *contact, const struct particles *particles,
                            int32_t point, const struct spring *h)
{
    const int32_t a = contact->edge[h->edge].a, b = contact->edge[h->edge].b;
    double at[2];
    place_on(contact, h->edge, contact->x[point], contact->y[point], at);
    const double to_b = sqrt(square(at[0]) + square(at[1]));
    const double to_a = sqrt(square(1 - at[0]) + square(at[1]));
    const double all = particles->free[contact->index[point]] +
                       to_a * particles->free[contact->index[a]] +
                       to_b * particles->free[contact->index[b]];
    contact_add_row(contact, particles, point, all, h->stiffness, h->damping);
    contact_add_row(contact, particles, a, to_a * all, h->stiffness, h->damping);
    contact_add_row(contact, particles, b, to_b * all, h->stiffness, h->damping);
}

/* A point that holds to walls does so with one spring, whichever pairs press it. */
static void add_wall_spring(struct contact *contact, const struct particles *particles,
                            int32_t point, int32_t edge)
{
    const struct spring h = spring_constants(contact, point, edge);
    if (!(h.friction > 0)) return;
    contact->wall_row[point] =
        max2(contact->wall_row[point], h.stiffness * per_mass(contact, particles, point));
    contact->wall_damping[point] =
        max2(contact->wall_damping[point], h.damping * per_mass(contact, particles, point));
}

void contact_friction_rows(struct contact *contact, const struct particles *particles,
                           int64_t first, int64_t end)
{
    const int32_t point = contact->pair_point[first];
    struct normal_load on[MAX_LOADS];
    int n = 0;
    for (int64_t k = first; k < end; k++) {
        const int32_t edge = contact->pair_edge[k];
        if (!contact->force[k].near) continue;
        if (point >= contact->n_solid_points) {
            add_wall_spring(contact, particles, contact->edge[edge].a, contact->point_edge[point]);
            add_wall_spring(contact, particles, contact->edge[edge].b, contact->point_edge[point]);
        } else if (contact->edge[edge].a >= contact->n_solid_points) {
            add_wall_spring(contact, particles, point, edge);
        } else {
            load_of_surface(contact, edge, contact->force[k].distance, on, &n);
        }
    }
    for (int k = 0; k < n; k++) {
        const struct spring h = spring_constants(contact, point, on[k].edge);
        if (h.friction > 0) add_spring_rows(contact, particles, point, &h);
    }
}
