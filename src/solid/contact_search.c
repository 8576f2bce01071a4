/* SPDX-License-Identifier: MIT
 * Positions of surface points, and the edges near them. */
#include "solid/contact_search.h"

#include "particles/kernel.h"

#include <math.h>
#include <string.h>

/* --- pairs --- */

/* The place on an edge where the distance less the reach is smallest if the reach rises by
 * `rise` from a to b (T-61c). */
static struct contact_foot foot_of(const struct contact *c, int32_t point, int32_t edge,
                                   double rise)
{
    const int32_t a = c->edge[edge].a, b = c->edge[edge].b;
    const double ex = c->x[b] - c->x[a], ey = c->y[b] - c->y[a], length2 = ex * ex + ey * ey;
    const double px = c->x[point] - c->x[a], py = c->y[point] - c->y[a];
    struct contact_foot f = {.x = px, .y = py};
    if (length2 > 0) f.at = (px * ex + py * ey) / length2;
    if (length2 > rise * rise)
        f.at += fabs(px * ey - py * ex) / length2 * rise / sqrt(length2 - rise * rise);
    else if (rise != 0)
        f.at = rise > 0;
    f.at = min2(1, max2(0, f.at));
    /* At an end of an edge: bitwise equal to the result of the neighbouring edge. */
    if (f.at == 1) {
        f.x = c->x[point] - c->x[b];
        f.y = c->y[point] - c->y[b];
    } else if (f.at > 0) {
        f.x -= f.at * ex;
        f.y -= f.at * ey;
    }
    f.distance = sqrt(f.x * f.x + f.y * f.y);
    return f;
}

struct contact_foot contact_nearest(const struct contact *c, int32_t point, int32_t edge)
{
    return foot_of(c, point, edge, 0);
}

struct contact_foot contact_foot(const struct contact *c, const struct contact_law *law,
                                 int32_t point, int32_t edge)
{
    const double at_a = contact_reach(c, law, point, c->edge[edge].a);
    const double at_b = contact_reach(c, law, point, c->edge[edge].b);
    struct contact_foot f = foot_of(c, point, edge, at_b - at_a);
    f.reach = f.at == 1 ? at_b : at_a + f.at * (at_b - at_a);
    f.min_reach = min2(at_a, at_b);
    return f;
}

/* Whether a point was initially within the kernel of an end of an edge, with the smoothing length
 * of a body. */
static bool initially_within(const struct contact *c, int32_t point, int32_t edge, int body)
{
    const int32_t end[2] = {c->edge[edge].a, c->edge[edge].b};
    const double reach2 = square(KERNEL_REACH * c->solid->body[body].h);
    for (int k = 0; k < 2; k++)
        if (square(c->X[point] - c->X[end[k]]) + square(c->Y[point] - c->Y[end[k]]) <= reach2)
            return true;
    return false;
}

/* Whether a clamp holds the solid of a pair to its wall there. */
static bool joined_by_clamp(const struct contact *c, int32_t point, int32_t edge)
{
    const int32_t a = c->edge[edge].a, b = c->edge[edge].b;
    const bool first = point < c->n_solid_points;
    const int one = c->body[first ? point : a], wall = c->body[first ? a : point] - c->n_solids;
    if (wall < 0 || !(first ? c->near_clamp[point] : c->near_clamp[a] || c->near_clamp[b]))
        return false;
    return strcmp(c->scene->solid[one].clamp_motion, c->scene->wall[wall].motion) == 0 &&
           initially_within(c, point, edge, one);
}

/* The material keeps points apart that were initially within each other's kernel in one body. A
 * clamp does so for its particles and the wall. */
struct contact_law contact_pair_law(const struct contact *c, int32_t point, int32_t edge)
{
    const struct contact_edge *const e = &c->edge[edge];
    struct contact_law law = c->law[c->body[point] * (c->n_solids + c->n_walls) + c->body[e->a]];
    law.initial = (double)INFINITY;
    if (!law.on) return law;
    if (c->group[point] == c->group[e->a])
        law.on = !initially_within(c, point, edge, c->body[point]);
    else if (joined_by_clamp(c, point, edge))
        law.on = false;
    else if (c->initial_group[point] == c->group[e->a])
        law.initial = c->initial[point];
    law.on = law.on && law.initial > 0;
    return law;
}

/* The box around the solids' surfaces, widened: walls outside need no search. */
struct box {
    double low[2], high[2];
};

static struct box box_of_solids(const struct contact *c, double more)
{
    struct box box = {{(double)INFINITY, (double)INFINITY}, {-(double)INFINITY, -(double)INFINITY}};
    for (int64_t k = 0; k < c->n_solid_points; k++) {
        box.low[0] = min2(box.low[0], c->x[k] - more);
        box.low[1] = min2(box.low[1], c->y[k] - more);
        box.high[0] = max2(box.high[0], c->x[k] + more);
        box.high[1] = max2(box.high[1], c->y[k] + more);
    }
    return box;
}

static bool in_box(const struct box *box, double x, double y)
{
    return x >= box->low[0] && x <= box->high[0] && y >= box->low[1] && y <= box->high[1];
}

enum err contact_list_resize(struct contact *c, int64_t max_pairs, struct diag *d)
{
    const size_t max = (size_t)max_pairs, n = (size_t)c->n_pairs;
    int32_t *const point = arena_alloc(c->arena, max, sizeof *point, "contact", d);
    int32_t *const edge = arena_alloc(c->arena, max, sizeof *edge, "contact", d);
    struct contact_force *const force = arena_alloc(c->arena, max, sizeof *force, "contact", d);
    int32_t *const load =
        arena_alloc(c->arena, c->friction ? CONTACT_LOADS * max : 0, sizeof *load, "contact", d);
    if (!point || !edge || !force || !load) return ERR_MEMORY;
    if (n) memcpy(point, c->pair_point, n * sizeof *point);
    if (n) memcpy(edge, c->pair_edge, n * sizeof *edge);
    c->pair_point = point;
    c->pair_edge = edge;
    c->force = force;
    c->load_next = load;
    c->max_pairs = max_pairs;
    return ERR_OK;
}

/* Lists a point and an edge if they are near enough; the edges of a point, whose pairs begin at
 * `first`, in ascending order. */
static void list_pair(struct contact *c, int32_t point, int32_t edge, int64_t first)
{
    const struct contact_law law = contact_pair_law(c, point, edge);
    if (!law.on) return;
    const double margin = c->margin[contact_with(c, point, edge)];
    const struct contact_foot foot = contact_foot(c, &law, point, edge);
    if (!(foot.distance < foot.reach + margin)) return;
    struct diag d = {0};
    /* Without memory for a longer list the run stops. */
    if (c->n_pairs == c->max_pairs && contact_list_resize(c, 2 * c->max_pairs, &d)) {
        c->list_full = true;
        return;
    }
    int64_t at = c->n_pairs++;
    for (; at > first && c->pair_edge[at - 1] > edge; at--) c->pair_edge[at] = c->pair_edge[at - 1];
    c->pair_edge[at] = edge;
    c->pair_point[c->n_pairs - 1] = point;
}

void contact_list(struct contact *c)
{
    double half2 = 0;
    const double margin = max2(c->margin[CONTACT_SELF], c->margin[CONTACT_OTHER]);
    const struct box box = box_of_solids(c, c->reach + margin + c->spacing);
    uint8_t *const skip = c->skip;
    for (int64_t k = 0; k < c->n_edges; k++) {
        const int32_t a = c->edge[k].a, b = c->edge[k].b;
        skip[k] = !in_box(&box, c->x[a], c->y[a]) && !in_box(&box, c->x[b], c->y[b]);
        if (skip[k]) continue;
        c->middle_x[k] = 0.5 * (c->x[a] + c->x[b]);
        c->middle_y[k] = 0.5 * (c->y[a] + c->y[b]);
        half2 = max2(half2, 0.25 * (square(c->x[a] - c->x[b]) + square(c->y[a] - c->y[b])));
    }
    const double reach = c->reach + margin + sqrt(half2);
    c->grid.side = reach;
    point_grid_clear(&c->grid);
    for (int64_t k = c->n_edges - 1; k >= 0; k--)
        if (!skip[k]) point_grid_insert(&c->grid, k);
    c->n_pairs = 0;
    for (int64_t k = 0; k < c->n_points; k++) {
        if (k >= c->n_solid_points && !in_box(&box, c->x[k], c->y[k])) continue;
        const int64_t first = c->n_pairs;
        struct point_visit v = point_grid_visit(&c->grid, c->x[k], c->y[k], reach);
        while (point_grid_next(&c->grid, &v)) list_pair(c, (int32_t)k, (int32_t)v.k, first);
    }
    memcpy(c->at_x, c->x, (size_t)c->n_points * sizeof *c->x);
    memcpy(c->at_y, c->y, (size_t)c->n_points * sizeof *c->y);
    c->stale = 0;
    c->known = true;
}

/* --- positions of points --- */

static void place_wall_point(struct contact *c, int64_t k)
{
    const struct motion_state *const m = &c->motion[c->body[k] - c->n_solids];
    const struct motion_point at = motion_of_point(m, c->X[k], c->Y[k]);
    c->x[k] = at.x[0];
    c->y[k] = at.x[1];
    c->vx[k] = at.v[0];
    c->vy[k] = at.v[1];
}

void contact_place(struct contact *c, const struct particles *p, double time)
{
    const double far2 = square(0.5 * min2(c->margin[CONTACT_SELF], c->margin[CONTACT_OTHER]));
    if (c->n_moving_points > c->n_solid_points) {
#pragma omp single
        for (int k = 0; k < c->n_walls; k++)
            c->motion[k] =
                motion_at(c->scene, scene_find_motion(c->scene, c->scene->wall[k].motion), time);
    }
#pragma omp for schedule(static)
    for (int64_t k = 0; k < c->n_moving_points; k++) {
        const int32_t i = c->index[k];
        if (k < c->n_solid_points) {
            c->x[k] = p->X[i] + p->ux[i];
            c->y[k] = p->Y[i] + p->uy[i];
            c->vx[k] = p->vx[i];
            c->vy[k] = p->vy[i];
        } else {
            place_wall_point(c, k);
        }
        /* A NaN counts as far. */
        if (!(square(c->x[k] - c->at_x[k]) + square(c->y[k] - c->at_y[k]) <= far2)) {
#pragma omp atomic write
            c->stale = 1;
        }
    }
}
