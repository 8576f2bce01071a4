/* SPDX-License-Identifier: MIT
 * Friction (T-62c, T-62d): a point of a solid holds to a place that moves with the surface which it presses.
 * If the spring between both would exceed Coulomb's friction, the place slides. */
#include "solid/contact_law.h"

#include <math.h>
#include <string.h>

/* The parts of a pair: the point; the ends of the edge. */
enum { PARTS = 3 };

/* A surface that presses a point of a solid. */
struct press {
    int32_t group, edge; /* the nearest edge of that surface */
    double distance, force[2];
};

/* More surfaces than these at one point have no friction. */
enum { SURFACES = 4 };

enum err contact_friction_create(struct contact *c, struct arena *a, struct diag *d)
{
    const size_t n = (size_t)c->n_solid_points;
    c->press_head = arena_alloc(a, n, sizeof *c->press_head, "contact", d);
    c->press_next = arena_alloc(a, PARTS * (size_t)c->most_pairs, sizeof(int32_t), "contact", d);
    c->hold = arena_alloc(a, n, sizeof *c->hold, "contact", d);
    c->hold_damping = arena_alloc(a, n, sizeof *c->hold, "contact", d);
    c->edge_at = arena_alloc(a, (size_t)c->n_points, sizeof *c->edge_at, "contact", d);
    if (!c->press_head || !c->press_next || !c->hold || !c->hold_damping || !c->edge_at)
        return ERR_MEMORY;
    for (int64_t k = 0; k < c->n_edges; k++)
        c->edge_at[c->edge[k].a] = c->edge_at[c->edge[k].b] = (int32_t)k;
    return ERR_OK;
}

bool contact_friction_grow(struct contact *c, int64_t most, struct diag *d)
{
    if (!c->press_head) return true;
    int32_t *const next = arena_alloc(c->arena, PARTS * (size_t)most, sizeof *next, "contact", d);
    if (next) c->press_next = next;
    return next;
}

/* --- what presses a point --- */

static void note_press(struct contact *c, int32_t point, int64_t pair, int part)
{
    const int64_t slot = PARTS * pair + part;
    c->press_next[slot] = c->press_head[point];
    c->press_head[point] = (int32_t)slot;
}

/* A wall is rigid and its points have no state: what they press is on the solid's points. */
static void find_presses(struct contact *c)
{
    memset(c->press_head, 0xff, (size_t)c->n_solid_points * sizeof *c->press_head);
    for (int64_t k = 0; k < c->n_pairs; k++) {
        if (!c->force[k].touches) continue;
        if (c->pair_point[k] < c->n_solid_points) {
            note_press(c, c->pair_point[k], k, 0);
        } else {
            note_press(c, c->edge[c->pair_edge[k]].a, k, 1);
            note_press(c, c->edge[c->pair_edge[k]].b, k, 2);
        }
    }
}

/* Notes an edge among the surfaces `on` a point; the surface's number, or SURFACES. */
static int note_surface(const struct contact *c, int32_t edge, double distance,
                        struct press on[SURFACES], int *n)
{
    const int32_t group = c->group[c->edge[edge].a];
    int k = 0;
    while (k < *n && on[k].group != group) k++;
    if (k == SURFACES) return k;
    if (k == *n) on[(*n)++] = (struct press){group, edge, distance, {0}};
    if (distance < on[k].distance) on[k].edge = edge, on[k].distance = distance;
    return k;
}

static int presses_on(const struct contact *c, int32_t point, struct press on[SURFACES])
{
    int n = 0;
    for (int32_t slot = c->press_head[point]; slot >= 0; slot = c->press_next[slot]) {
        const int64_t pair = slot / PARTS;
        const int part = slot % PARTS;
        const struct contact_force *const from = &c->force[pair];
        const double *const f = part == 0 ? from->p : part == 1 ? from->a : from->b;
        const int32_t edge = part ? c->edge_at[c->pair_point[pair]] : c->pair_edge[pair];
        const int k = note_surface(c, edge, part ? (double)INFINITY : from->distance, on, &n);
        if (k == SURFACES) continue;
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

/* What holds a point: a spring with the displacement u across the normal n, a dashpot, a slider. */
struct hold {
    int32_t edge; /* that the place moves with */
    double n[2], u[2], push, pull, stiffness, grip, friction;
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

static struct hold constants_of(const struct contact *c, int32_t point, int32_t edge)
{
    const struct contact_law law = law_of(c, point, edge);
    const struct pair q = pair_of(c, &law, point, edge, 0);
    return (struct hold){
        .edge = edge,
        .stiffness = halves(c, edge) * law.shear * q.stiffness,
        .grip = halves(c, edge) * q.grip,
        .friction = q.friction,
    };
}

/* Edge of the place that a point holds to, if on this surface; else -1. */
static int32_t edge_held(const struct contact *c, const struct particles *p, int32_t point,
                         int32_t group)
{
    const int64_t edge = p->stick_edge[c->index[point]] - 1;
    return edge >= 0 && edge < c->n_edges && c->group[c->edge[edge].a] == group ? (int32_t)edge
                                                                                : -1;
}

/* push = 0: there is no friction. */
static struct hold hold_of(const struct contact *c, const struct particles *p, int32_t point,
                           const struct press *on)
{
    const int32_t edge = edge_held(c, p, point, on->group), i = c->index[point];
    struct hold h = constants_of(c, point, edge < 0 ? on->edge : edge);
    const double *const f = on->force;
    h.push = h.friction > 0 ? sqrt(f[0] * f[0] + f[1] * f[1]) : 0;
    if (!(h.push > 0)) return h;
    for (int k = 0; k < 2; k++) h.n[k] = f[k] / h.push;
    if (edge < 0) return h;
    const int32_t a = c->edge[edge].a;
    double e[2];
    frame_of(c, edge, e);
    const double x = c->x[a] + p->stick_along[i] * e[0] - p->stick_across[i] * e[1];
    const double y = c->y[a] + p->stick_along[i] * e[1] + p->stick_across[i] * e[0];
    const double d[2] = {c->x[point] - x, c->y[point] - y};
    for (int k = 0; k < 2; k++) h.u[k] = across(h.n, d, k);
    h.pull = h.stiffness * sqrt(h.u[0] * h.u[0] + h.u[1] * h.u[1]);
    return h;
}

/* The edge bears the opposite force as if it reached to the point: both act along one line, and the work of
 * the spring is that of its energy. */
static void rub(struct contact *c, struct particles *p, int32_t point, const struct hold *h)
{
    const int32_t a = c->edge[h->edge].a, b = c->edge[h->edge].b;
    const double w[2] = {c->vx[b] - c->vx[a], c->vy[b] - c->vy[a]};
    double at[2];
    place_on(c, h->edge, c->x[point], c->y[point], at);
    const double v[2] = {c->vx[point] - (c->vx[a] + at[0] * w[0] - at[1] * w[1]),
                         c->vy[point] - (c->vy[a] + at[0] * w[1] + at[1] * w[0])};
    double f[2];
    for (int k = 0; k < 2; k++) f[k] = -h->stiffness * h->u[k] - h->grip * across(h->n, v, k);
    const double size = sqrt(f[0] * f[0] + f[1] * f[1]), most = h->friction * h->push;
    const double less = size > most ? most / size : 1;
    f[0] *= less;
    f[1] *= less;
    const double fb[2] = {-(at[0] * f[0] + at[1] * f[1]), -(at[0] * f[1] - at[1] * f[0])};
    const double fa[2] = {-f[0] - fb[0], -f[1] - fb[1]};
    contact_add_force(c, p, point, f);
    contact_add_force(c, p, a, fa);
    contact_add_force(c, p, b, fb);
}

void contact_rub(struct contact *c, struct particles *p)
{
    if (!c->press_head) return;
    find_presses(c);
    for (int32_t point = 0; point < c->n_solid_points; point++) {
        struct press on[SURFACES];
        const int n = presses_on(c, point, on);
        for (int k = 0; k < n; k++) {
            const struct hold h = hold_of(c, p, point, &on[k]);
            if (h.push > 0) rub(c, p, point, &h);
        }
    }
}

double contact_friction_energy(struct contact *c, const struct particles *p)
{
    double sum = 0;
    find_presses(c);
    for (int32_t point = 0; point < c->n_solid_points; point++) {
        struct press on[SURFACES];
        const int n = presses_on(c, point, on);
        for (int k = 0; k < n; k++) {
            const struct hold h = hold_of(c, p, point, &on[k]);
            if (h.pull > 0) sum += 0.5 * square(min2(h.pull, h.friction * h.push)) / h.stiffness;
        }
    }
    return sum;
}

/* --- after a step --- */

/* A point keeps to the surface that it holds to until it leaves it; then it takes the nearest. -1: none. */
static int surface_to_hold(const struct contact *c, const struct particles *p, int32_t point,
                           const struct press *on, int n)
{
    int best = -1;
    for (int k = 0; k < n; k++) {
        if (!(hold_of(c, p, point, &on[k]).push > 0)) continue;
        if (edge_held(c, p, point, on[k].group) >= 0) return k;
        if (best < 0 || on[k].distance < on[best].distance) best = k;
    }
    return best;
}

void contact_slide(struct contact *c, struct particles *p)
{
    if (!c->press_head) return;
    for (int32_t point = 0; point < c->n_solid_points; point++) {
        struct press on[SURFACES];
        const int n = presses_on(c, point, on), k = surface_to_hold(c, p, point, on, n);
        const int32_t i = c->index[point];
        if (k < 0) {
            p->stick_edge[i] = 0;
            continue;
        }
        const struct hold h = hold_of(c, p, point, &on[k]);
        const double most = h.friction * h.push, less = h.pull > most ? most / h.pull : 1;
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

static void add_row(struct contact *c, const struct particles *p, int32_t point, double weight,
                    const struct hold *h)
{
    c->row[point] += weight * h->stiffness * per_mass(c, p, point);
    c->row_damping[point] += weight * h->grip * per_mass(c, p, point);
}

/* The rows of T-62a of a point that holds to a solid: the weights are those of rub(). */
static void add_rows(struct contact *c, const struct particles *p, int32_t point,
                     const struct hold *h)
{
    const int32_t a = c->edge[h->edge].a, b = c->edge[h->edge].b;
    double at[2];
    place_on(c, h->edge, c->x[point], c->y[point], at);
    const double to_b = sqrt(square(at[0]) + square(at[1]));
    const double to_a = sqrt(square(1 - at[0]) + square(at[1]));
    const double all =
        p->free[c->index[point]] + to_a * p->free[c->index[a]] + to_b * p->free[c->index[b]];
    add_row(c, p, point, all, h);
    add_row(c, p, a, to_a * all, h);
    add_row(c, p, b, to_b * all, h);
}

/* A point that holds to walls does so with one spring, whichever pairs press it. */
static void hold_to_wall(struct contact *c, const struct particles *p, int32_t point, int32_t edge)
{
    const struct hold h = constants_of(c, point, edge);
    if (!(h.friction > 0)) return;
    c->hold[point] = max2(c->hold[point], h.stiffness * per_mass(c, p, point));
    c->hold_damping[point] = max2(c->hold_damping[point], h.grip * per_mass(c, p, point));
}

void contact_watch_friction(struct contact *c, const struct particles *p, int64_t first,
                            int64_t end)
{
    if (!c->press_head) return;
    const int32_t point = c->pair_point[first];
    struct press on[SURFACES];
    int n = 0;
    for (int64_t k = first; k < end; k++) {
        const int32_t edge = c->pair_edge[k];
        if (!c->force[k].near) continue;
        if (point >= c->n_solid_points) {
            hold_to_wall(c, p, c->edge[edge].a, c->edge_at[point]);
            hold_to_wall(c, p, c->edge[edge].b, c->edge_at[point]);
        } else if (c->edge[edge].a >= c->n_solid_points) {
            hold_to_wall(c, p, point, edge);
        } else {
            note_surface(c, edge, c->force[k].distance, on, &n);
        }
    }
    for (int k = 0; k < n; k++) {
        const struct hold h = constants_of(c, point, on[k].edge);
        if (h.friction > 0) add_rows(c, p, point, &h);
    }
}
