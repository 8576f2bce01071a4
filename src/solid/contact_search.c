/* SPDX-License-Identifier: MIT
 * Positions of surface points, and the edges near them. */
#include "solid/contact_search.h"

#include "particles/kernel.h"

#include <math.h>
#include <string.h>

/* --- pairs --- */

/* The place on an edge where the distance less the reach is smallest if the reach rises by
 * `rise` from a to b (T-61c). */
static struct contact_foot foot_of(const struct contact *contact, int32_t point, int32_t edge,
                                   double rise)
{
    const int32_t a = contact->edge[edge].a, b = contact->edge[edge].b;
    const double ex = contact->x[b] - contact->x[a], ey = contact->y[b] - contact->y[a],
                 length2 = ex * ex + ey * ey;
    const double px = contact->x[point] - contact->x[a], py = contact->y[point] - contact->y[a];
    struct contact_foot f = {.x = px, .y = py};
    if (length2 > 0) f.at = (px * ex + py * ey) / length2;
    if (length2 > rise * rise)
        f.at += fabs(px * ey - py * ex) / length2 * rise / sqrt(length2 - rise * rise);
    else if (rise != 0)
        f.at = rise > 0;
    f.at = min2(1, max2(0, f.at));
    /* At an end of an edge: bitwise equal to the result of the neighbouring edge. */
    if (f.at == 1) {
        f.x = contact->x[point] - contact->x[b];
        f.y = contact->y[point] - contact->y[b];
    } else if (f.at > 0) {
        f.x -= f.at * ex;
        f.y -= f.at * ey;
    }
    f.distance = sqrt(f.x * f.x + f.y * f.y);
    return f;
}

struct contact_foot contact_nearest(const struct contact *contact, int32_t point, int32_t edge)
{
    return foot_of(contact, point, edge, 0);
}

struct contact_foot contact_foot(const struct contact *contact, const struct contact_law *law,
                                 int32_t point, int32_t edge)
{
    const double at_a = contact_reach(contact, law, point, contact->edge[edge].a);
    const double at_b = contact_reach(contact, law, point, contact->edge[edge].b);
    struct contact_foot f = foot_of(contact, point, edge, at_b - at_a);
    f.reach = f.at == 1 ? at_b : at_a + f.at * (at_b - at_a);
    f.min_reach = min2(at_a, at_b);
    return f;
}

/* Whether a point was initially within the kernel of an end of an edge, with the smoothing length
 * of a body. */
static bool initially_within(const struct contact *contact, int32_t point, int32_t edge, int body)
{
    const int32_t end[2] = {contact->edge[edge].a, contact->edge[edge].b};
    const double reach2 = square(KERNEL_REACH * contact->solid->body[body].h);
    for (int k = 0; k < 2; k++)
        if (square(contact->X[point] - contact->X[end[k]]) +
                square(contact->Y[point] - contact->Y[end[k]]) <=
            reach2)
            return true;
    return false;
}

/* Whether a clamp holds the solid of a pair to its wall there. */
static bool joined_by_clamp(const struct contact *contact, int32_t point, int32_t edge)
{
    const int32_t a = contact->edge[edge].a, b = contact->edge[edge].b;
    const bool first = point < contact->n_solid_points;
    const int one = contact->body[first ? point : a],
              wall = contact->body[first ? a : point] - contact->n_solids;
    if (wall < 0 ||
        !(first ? contact->near_clamp[point] : contact->near_clamp[a] || contact->near_clamp[b]))
        return false;
    return strcmp(contact->scene->solid[one].clamp_motion, contact->scene->wall[wall].motion) ==
               0 &&
           initially_within(contact, point, edge, one);
}

/* The material keeps points apart that were initially within each other's kernel in one body. A
 * clamp does so for its particles and the wall, a hinge for what begins within its kernel. */
struct contact_law contact_pair_law(const struct contact *contact, int32_t point, int32_t edge)
{
    const struct contact_edge *const e = &contact->edge[edge];
    struct contact_law law =
        contact->law[contact->body[point] * (contact->n_solids + contact->n_walls) +
                     contact->body[e->a]];
    law.initial = (double)INFINITY;
    if (!law.on) return law;
    if (contact->group[point] == contact->group[e->a])
        law.on = !initially_within(contact, point, edge, contact->body[point]);
    else if (joined_by_clamp(contact, point, edge) ||
             (contact->near_hinge[point] &&
              contact->near_hinge[point] == contact->near_hinge[e->a]))
        law.on = false;
    else if (contact->initial_group[point] == contact->group[e->a])
        law.initial = contact->initial[point];
    law.on = law.on && law.initial > 0;
    return law;
}

/* The box around the solids' surfaces, widened: walls outside need no search. */
struct box {
    double low[2], high[2];
};

static struct box box_of_solids(const struct contact *contact, double more)
{
    struct box box = {{(double)INFINITY, (double)INFINITY}, {-(double)INFINITY, -(double)INFINITY}};
    for (int64_t k = 0; k < contact->n_solid_points; k++) {
        box.low[0] = min2(box.low[0], contact->x[k] - more);
        box.low[1] = min2(box.low[1], contact->y[k] - more);
        box.high[0] = max2(box.high[0], contact->x[k] + more);
        box.high[1] = max2(box.high[1], contact->y[k] + more);
    }
    return box;
}

static bool in_box(const struct box *box, double x, double y)
{
    return x >= box->low[0] && x <= box->high[0] && y >= box->low[1] && y <= box->high[1];
}

enum err contact_list_resize(struct contact *contact, int64_t max_pairs, struct diag *d)
{
    const size_t max = (size_t)max_pairs, n = (size_t)contact->n_pairs;
    int32_t *const point = arena_alloc(contact->arena, max, sizeof *point, "contact", d);
    int32_t *const edge = arena_alloc(contact->arena, max, sizeof *edge, "contact", d);
    struct contact_force *const force =
        arena_alloc(contact->arena, max, sizeof *force, "contact", d);
    int32_t *const load = arena_alloc(contact->arena, contact->friction ? CONTACT_LOADS * max : 0,
                                      sizeof *load, "contact", d);
    if (!point || !edge || !force || !load) return ERR_MEMORY;
    if (n) memcpy(point, contact->pair_point, n * sizeof *point);
    if (n) memcpy(edge, contact->pair_edge, n * sizeof *edge);
    contact->pair_point = point;
    contact->pair_edge = edge;
    contact->force = force;
    contact->load_next = load;
    contact->max_pairs = max_pairs;
    return ERR_OK;
}

/* Lists a point and an edge if they are near enough; the edges of a point, whose pairs begin at
 * `first`, in ascending order. */
static void list_pair(struct contact *contact, int32_t point, int32_t edge, int64_t first)
{
    const struct contact_law law = contact_pair_law(contact, point, edge);
    if (!law.on) return;
    const double margin = contact->margin[contact_with(contact, point, edge)];
    const struct contact_foot foot = contact_foot(contact, &law, point, edge);
    if (!(foot.distance < foot.reach + margin)) return;
    struct diag d = {0};
    /* Without memory for a longer list the run stops. */
    if (contact->n_pairs == contact->max_pairs &&
        contact_list_resize(contact, 2 * contact->max_pairs, &d)) {
        contact->list_full = true;
        return;
    }
    int64_t at = contact->n_pairs++;
    for (; at > first && contact->pair_edge[at - 1] > edge; at--)
        contact->pair_edge[at] = contact->pair_edge[at - 1];
    contact->pair_edge[at] = edge;
    contact->pair_point[contact->n_pairs - 1] = point;
}

void contact_list(struct contact *contact)
{
    double half2 = 0;
    const double margin = max2(contact->margin[CONTACT_SELF], contact->margin[CONTACT_OTHER]);
    const struct box box = box_of_solids(contact, contact->reach + margin + contact->spacing);
    uint8_t *const skip = contact->skip;
    for (int64_t k = 0; k < contact->n_edges; k++) {
        const int32_t a = contact->edge[k].a, b = contact->edge[k].b;
        skip[k] = !in_box(&box, contact->x[a], contact->y[a]) &&
                  !in_box(&box, contact->x[b], contact->y[b]);
        if (skip[k]) continue;
        contact->middle_x[k] = 0.5 * (contact->x[a] + contact->x[b]);
        contact->middle_y[k] = 0.5 * (contact->y[a] + contact->y[b]);
        half2 = max2(half2, 0.25 * (square(contact->x[a] - contact->x[b]) +
                                    square(contact->y[a] - contact->y[b])));
    }
    const double reach = contact->reach + margin + sqrt(half2);
    contact->grid.side = reach;
    point_grid_clear(&contact->grid);
    for (int64_t k = contact->n_edges - 1; k >= 0; k--)
        if (!skip[k]) point_grid_insert(&contact->grid, k);
    contact->n_pairs = 0;
    for (int64_t k = 0; k < contact->n_points; k++) {
        if (k >= contact->n_solid_points && !in_box(&box, contact->x[k], contact->y[k])) continue;
        const int64_t first = contact->n_pairs;
        struct point_visit v =
            point_grid_visit(&contact->grid, contact->x[k], contact->y[k], reach);
        while (point_grid_next(&contact->grid, &v))
            list_pair(contact, (int32_t)k, (int32_t)v.k, first);
    }
    memcpy(contact->at_x, contact->x, (size_t)contact->n_points * sizeof *contact->x);
    memcpy(contact->at_y, contact->y, (size_t)contact->n_points * sizeof *contact->y);
    contact->stale = 0;
    contact->known = true;
}

/* --- positions of points --- */

static void place_wall_point(struct contact *contact, int64_t k)
{
    const struct motion_state *const m = &contact->motion[contact->body[k] - contact->n_solids];
    const struct motion_point at = motion_of_point(m, contact->X[k], contact->Y[k]);
    contact->x[k] = at.x[0];
    contact->y[k] = at.x[1];
    contact->vx[k] = at.v[0];
    contact->vy[k] = at.v[1];
}

void contact_place(struct contact *contact, const struct particles *particles, double time)
{
    const double far2 =
        square(0.5 * min2(contact->margin[CONTACT_SELF], contact->margin[CONTACT_OTHER]));
    if (contact->n_moving_points > contact->n_solid_points) {
#pragma omp single
        for (int k = 0; k < contact->n_walls; k++)
            contact->motion[k] =
                motion_at(contact->scene,
                          scene_find_motion(contact->scene, contact->scene->wall[k].motion), time);
    }
#pragma omp for schedule(static)
    for (int64_t k = 0; k < contact->n_moving_points; k++) {
        const int32_t i = contact->index[k];
        if (k < contact->n_solid_points) {
            contact->x[k] = particles->X[i] + particles->ux[i];
            contact->y[k] = particles->Y[i] + particles->uy[i];
            contact->vx[k] = particles->vx[i];
            contact->vy[k] = particles->vy[i];
        } else {
            place_wall_point(contact, k);
        }
        /* A NaN counts as far. */
        if (!(square(contact->x[k] - contact->at_x[k]) + square(contact->y[k] - contact->at_y[k]) <=
              far2)) {
#pragma omp atomic write
            contact->stale = 1;
        }
    }
}
