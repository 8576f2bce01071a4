/* SPDX-License-Identifier: MIT
 * Coulomb friction (T-62c, T-62d): a tangential spring with a slider between a point of a solid
 * and a place that moves with the surface which it presses. */
#include "solid/contact.h"

/* --- what presses a point --- */

/* The surface of an edge among the n that press a point, with the nearest edge; NULL: too many. */
static struct pressing_surface *surface_of_edge(const struct contact *contact, int32_t edge,
                                                double distance,
                                                struct pressing_surface surface[MOST_SURFACES],
                                                int *n)
{
    const int32_t group = contact->point[contact->edge[edge].a].group;
    int k = 0;
    while (k < *n && surface[k].group != group) k++;
    if (k == MOST_SURFACES) return NULL;
    if (k == *n) surface[(*n)++] = (struct pressing_surface){group, edge, distance, {0}};
    if (distance < surface[k].distance) surface[k].edge = edge, surface[k].distance = distance;
    return &surface[k];
}

static void add_surface_force(const struct contact *contact, int32_t point, int32_t edge,
                              double distance, const double force[2])
{
    struct contact_point *const p = &contact->point[point];
    struct pressing_surface *const surface =
        surface_of_edge(contact, edge, distance, p->surface, &p->n_surfaces);
    if (surface)
        for (int c = 0; c < 2; c++) surface->force[c] += force[c];
}

/* A wall is rigid and its points have no state: what they press is on the solid's points. */
static void collect_surface_forces(struct contact *contact)
{
    for (int64_t k = 0; k < contact->n_solid_points; k++) contact->point[k].n_surfaces = 0;
    for (int64_t k = contact->n_pairs - 1; k >= 0; k--) {
        const struct contact_pair *const pair = &contact->pair[k];
        if (!pair->touches) continue;
        if (pair->point < contact->n_solid_points) {
            add_surface_force(contact, pair->point, pair->edge, pair->distance, pair->force[0]);
            continue;
        }
        const int32_t edge = contact->point[pair->point].edge;
        const struct contact_edge *const e = &contact->edge[pair->edge];
        add_surface_force(contact, e->b, edge, (double)INFINITY, pair->force[2]);
        add_surface_force(contact, e->a, edge, (double)INFINITY, pair->force[1]);
    }
}

/* --- places that move with an edge --- */

/* The line from the first end to the other, or a line of 1 m if both are the same. */
static void line_of(const struct contact *contact, int32_t edge, double e[2])
{
    const double *const a = contact->point[contact->edge[edge].a].x,
                        *const b = contact->point[contact->edge[edge].b].x;
    e[0] = a == b ? 1 : b[0] - a[0];
    e[1] = a == b ? 0 : b[1] - a[1];
}

/* Along the edge and across it, both in its lengths. */
static void place_on(const struct contact *contact, int32_t edge, const double x[2],
                     double place[2])
{
    const double *const a = contact->point[contact->edge[edge].a].x;
    double e[2];
    line_of(contact, edge, e);
    const double dx = x[0] - a[0], dy = x[1] - a[1], length2 = e[0] * e[0] + e[1] * e[1];
    place[0] = (e[0] * dx + e[1] * dy) / length2;
    place[1] = (e[0] * dy - e[1] * dx) / length2;
}

/* --- force --- */

/* Component c of a vector's part across the direction n. */
static double across(const double n[2], const double v[2], int c)
{
    return v[c] - (v[0] * n[0] + v[1] * n[1]) * n[c];
}

/* A tangential spring with the displacement u across the normal n, a dashpot and a slider. */
struct friction_spring {
    int32_t edge; /* that its place moves with */
    double n[2], u[2], normal_force, force, stiffness, damping, friction;
};

/* Both halves of the force between a solid and a wall act on the points of the solid. */
static struct friction_spring spring_constants(const struct contact *contact, int32_t point,
                                               int32_t edge)
{
    const struct contact_point *const p = &contact->point[point];
    const int body = contact->point[contact->edge[edge].a].body;
    const struct contact_law *const law = contact_law_of(contact, p->body, body);
    const struct contact_constants q = contact_constants_of(law, p);
    const double halves = body < contact->n_solids ? 1 : 1 / CONTACT_HALF;
    return (struct friction_spring){
        .edge = edge,
        .stiffness = halves * law->shear * q.stiffness,
        .damping = halves * q.tangential_damping,
        .friction = law->friction,
    };
}

/* Edge of the place that a point holds to, if on this surface; else -1. */
static int32_t spring_edge(const struct contact *contact, const struct particles *particles,
                           int32_t point, int32_t group)
{
    const int64_t edge = particles->stick_edge[contact->point[point].index] - 1;
    if (edge < 0 || edge >= contact->n_edges) return -1;
    return contact->point[contact->edge[edge].a].group == group ? (int32_t)edge : -1;
}

/* normal_force = 0: there is no friction. */
static struct friction_spring spring_at(const struct contact *contact,
                                        const struct particles *particles, int32_t point,
                                        const struct pressing_surface *on)
{
    const int32_t edge = spring_edge(contact, particles, point, on->group),
                  i = contact->point[point].index;
    struct friction_spring h = spring_constants(contact, point, edge < 0 ? on->edge : edge);
    const double *const f = on->force;
    h.normal_force = h.friction > 0 ? sqrt(f[0] * f[0] + f[1] * f[1]) : 0;
    if (!(h.normal_force > 0)) return h;
    for (int c = 0; c < 2; c++) h.n[c] = f[c] / h.normal_force;
    if (edge < 0) return h;
    const double *const x = contact->point[point].x, *const a =
                                                         contact->point[contact->edge[edge].a].x;
    const double along = particles->stick_along[i], aside = particles->stick_across[i];
    double e[2];
    line_of(contact, edge, e);
    const double d[2] = {x[0] - (a[0] + along * e[0] - aside * e[1]),
                         x[1] - (a[1] + along * e[1] + aside * e[0])};
    for (int c = 0; c < 2; c++) h.u[c] = across(h.n, d, c);
    h.force = h.stiffness * sqrt(h.u[0] * h.u[0] + h.u[1] * h.u[1]);
    return h;
}

/* The edge bears the opposite force, along the same line: the spring's work is its energy's. */
static void add_friction(struct contact *contact, struct particles *particles, int32_t point,
                         const struct friction_spring *h)
{
    const int32_t a = contact->edge[h->edge].a, b = contact->edge[h->edge].b;
    const double *const vp = contact->point[point].v, *const va = contact->point[a].v,
                        *const vb = contact->point[b].v;
    const double w[2] = {vb[0] - va[0], vb[1] - va[1]};
    double at[2], f[2];
    place_on(contact, h->edge, contact->point[point].x, at);
    const double v[2] = {vp[0] - (va[0] + at[0] * w[0] - at[1] * w[1]),
                         vp[1] - (va[1] + at[0] * w[1] + at[1] * w[0])};
    for (int c = 0; c < 2; c++) f[c] = -h->stiffness * h->u[c] - h->damping * across(h->n, v, c);
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

double contact_friction(struct contact *contact, const struct particles *particles,
                        struct particles *move)
{
    double sum = 0;
    collect_surface_forces(contact);
    for (int32_t point = 0; point < contact->n_solid_points; point++) {
        const struct contact_point *const p = &contact->point[point];
        for (int k = 0; k < p->n_surfaces; k++) {
            const struct friction_spring h = spring_at(contact, particles, point, &p->surface[k]);
            if (move && h.normal_force > 0)
                add_friction(contact, move, point, &h);
            else if (!move && h.force > 0)
                sum += 0.5 * square(min2(h.force, h.friction * h.normal_force)) / h.stiffness;
        }
    }
    return sum;
}

/* --- after a step --- */

/* A point keeps to a surface until it leaves it; then it takes the nearest. NULL: none. */
static const struct pressing_surface *
surface_with_spring(const struct contact *contact, const struct particles *particles, int32_t point)
{
    const struct contact_point *const p = &contact->point[point];
    const struct pressing_surface *best = NULL;
    for (const struct pressing_surface *on = p->surface; on < p->surface + p->n_surfaces; on++) {
        if (!(spring_at(contact, particles, point, on).normal_force > 0)) continue;
        if (spring_edge(contact, particles, point, on->group) >= 0) return on;
        if (!best || on->distance < best->distance) best = on;
    }
    return best;
}

void contact_slide(struct contact *contact, struct particles *particles)
{
    if (!contact->friction) return;
    for (int32_t point = 0; point < contact->n_solid_points; point++) {
        const struct pressing_surface *const on = surface_with_spring(contact, particles, point);
        const int32_t i = contact->point[point].index;
        if (!on) {
            particles->stick_edge[i] = 0;
            continue;
        }
        const struct friction_spring h = spring_at(contact, particles, point, on);
        const double most = h.friction * h.normal_force, less = h.force > most ? most / h.force : 1;
        const double *const x = contact->point[point].x;
        double place[2];
        place_on(contact, on->edge, (const double[]){x[0] - less * h.u[0], x[1] - less * h.u[1]},
                 place);
        particles->stick_edge[i] = on->edge + 1;
        particles->stick_along[i] = place[0];
        particles->stick_across[i] = place[1];
    }
}

/* --- before a step --- */

/* The rows of T-62a of a point that holds to a solid: the weights are those of add_friction(). */
static void add_spring_bounds(struct contact *contact, const struct particles *particles,
                              int32_t point, const struct friction_spring *h)
{
    const int32_t a = contact->edge[h->edge].a, b = contact->edge[h->edge].b;
    double at[2];
    place_on(contact, h->edge, contact->point[point].x, at);
    const double to_b = sqrt(square(at[0]) + square(at[1]));
    const double to_a = sqrt(square(1 - at[0]) + square(at[1]));
    const double all = particles->free[contact->point[point].index] +
                       to_a * particles->free[contact->point[a].index] +
                       to_b * particles->free[contact->point[b].index];
    contact_add_bound(contact, particles, point, all, h->stiffness, h->damping);
    contact_add_bound(contact, particles, a, to_a * all, h->stiffness, h->damping);
    contact_add_bound(contact, particles, b, to_b * all, h->stiffness, h->damping);
}

/* A point that holds to walls does so with one spring, whichever pairs press it. */
static void add_wall_spring(struct contact *contact, const struct particles *particles,
                            int32_t point, int32_t edge)
{
    const struct friction_spring h = spring_constants(contact, point, edge);
    struct contact_point *const p = &contact->point[point];
    const double per_mass = contact_inv_mass(contact, particles, p);
    if (!(h.friction > 0)) return;
    contact_add_body_bound(contact, contact->point[contact->edge[edge].a].body, p->x, NULL,
                           h.stiffness, h.damping);
    p->wall_omega2_bound = max2(p->wall_omega2_bound, h.stiffness * per_mass);
    p->wall_damping_bound = max2(p->wall_damping_bound, h.damping * per_mass);
}

void contact_friction_bounds(struct contact *contact, const struct particles *particles,
                             int64_t first, int64_t end)
{
    const int32_t point = contact->pair[first].point;
    struct pressing_surface on[MOST_SURFACES];
    int n = 0;
    for (int64_t k = first; k < end; k++) {
        const struct contact_pair *const pair = &contact->pair[k];
        const struct contact_edge *const e = &contact->edge[pair->edge];
        if (!pair->near) continue;
        if (point >= contact->n_solid_points) {
            add_wall_spring(contact, particles, e->a, contact->point[point].edge);
            add_wall_spring(contact, particles, e->b, contact->point[point].edge);
        } else if (e->a >= contact->n_solid_points) {
            add_wall_spring(contact, particles, point, pair->edge);
        } else {
            surface_of_edge(contact, pair->edge, pair->distance, on, &n);
        }
    }
    for (int k = 0; k < n; k++) {
        const struct friction_spring h = spring_constants(contact, point, on[k].edge);
        if (h.friction > 0) add_spring_bounds(contact, particles, point, &h);
    }
}
