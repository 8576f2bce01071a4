/* SPDX-License-Identifier: MIT
 * Positions of surface points, and the edges near them. */
#include "solid/contact.h"

#include "particles/kernel.h"

#include <math.h>
#include <string.h>

/* --- positions by cell --- */

static int64_t cell_of(const struct contact_grid *g, double x)
{
    return (int64_t)floor(x / g->side);
}

enum err contact_grid_create(struct contact_grid *g, struct arena *a, int64_t n, struct diag *d)
{
    uint32_t size = 64;
    while (size < (uint64_t)n) size *= 2;
    g->mask = size - 1;
    g->head = arena_alloc(a, size, sizeof *g->head, "contact", d);
    g->next = arena_alloc(a, (size_t)n, sizeof *g->next, "contact", d);
    return g->head && g->next ? ERR_OK : ERR_MEMORY;
}

void contact_grid_fill(struct contact_grid *g, int64_t n, const uint8_t *skip)
{
    memset(g->head, 0xff, ((size_t)g->mask + 1) * sizeof *g->head);
    for (int64_t k = n - 1; k >= 0; k--) {
        if (skip && skip[k]) continue;
        const uint32_t slot = hash_cell(cell_of(g, g->x[k]), cell_of(g, g->y[k]), g->mask);
        g->next[k] = g->head[slot];
        g->head[slot] = (int32_t)k;
    }
}

void contact_grid_find(const struct contact_grid *g, double x, double y, double reach,
                       contact_visit *found, void *context)
{
    const int64_t i0 = cell_of(g, x - reach), i1 = cell_of(g, x + reach);
    const int64_t j0 = cell_of(g, y - reach), j1 = cell_of(g, y + reach);
    for (int64_t j = j0; j <= j1; j++) {
        for (int64_t i = i0; i <= i1; i++) {
            for (int32_t k = g->head[hash_cell(i, j, g->mask)]; k >= 0; k = g->next[k]) {
                /* Several cells may have the same slot. */
                if (cell_of(g, g->x[k]) != i || cell_of(g, g->y[k]) != j) continue;
                if (square(g->x[k] - x) + square(g->y[k] - y) < reach * reach) found(context, k);
            }
        }
    }
}

/* --- pairs --- */

/* The place on an edge where the distance less the reach is smallest if the reach rises by `rise` from a
 * to b (T-61c). */
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
    f.least_reach = min2(at_a, at_b);
    return f;
}

/* Whether a point was initially within the kernel of an end of an edge, with the smoothing length
 * of a body. */
static bool began_within(const struct contact *c, int32_t point, int32_t edge, int body)
{
    const int32_t end[2] = {c->edge[edge].a, c->edge[edge].b};
    const double reach2 = square(KERNEL_REACH * c->solid->body[body].h);
    for (int k = 0; k < 2; k++)
        if (square(c->X[point] - c->X[end[k]]) + square(c->Y[point] - c->Y[end[k]]) <= reach2)
            return true;
    return false;
}

/* Whether a clamp holds the solid of a pair to its wall there. */
static bool held_together(const struct contact *c, int32_t point, int32_t edge)
{
    const int32_t a = c->edge[edge].a, b = c->edge[edge].b;
    const bool first = point < c->n_solid_points;
    const int one = c->body[first ? point : a], wall = c->body[first ? a : point] - c->n_solids;
    if (wall < 0 || !(first ? c->held[point] : c->held[a] || c->held[b])) return false;
    return strcmp(c->scene->solid[one].clamp_motion, c->scene->wall[wall].motion) == 0 &&
           began_within(c, point, edge, one);
}

/* The material keeps points apart that were initially within each other's kernel in one body. A
 * clamp does so for its particles and the wall. */
struct contact_law contact_pair_law(const struct contact *c, int32_t point, int32_t edge)
{
    const struct contact_edge *const e = &c->edge[edge];
    struct contact_law law = c->law[c->body[point] * (c->n_solids + c->n_walls) + c->body[e->a]];
    law.began = (double)INFINITY;
    if (!law.on) return law;
    if (c->group[point] == c->group[e->a])
        law.on = !began_within(c, point, edge, c->body[point]);
    else if (held_together(c, point, edge))
        law.on = false;
    else if (c->began_group[point] == c->group[e->a])
        law.began = c->began[point];
    law.on = law.on && law.began > 0;
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

/* Enlarges the list; if there is no memory for it, the run stops. */
static bool grow(struct contact *c)
{
    struct diag d = {0};
    const int64_t most = 2 * c->most_pairs;
    int32_t *const point = arena_alloc(c->arena, (size_t)most, sizeof *point, "contact", &d);
    int32_t *const edge = arena_alloc(c->arena, (size_t)most, sizeof *edge, "contact", &d);
    struct contact_force *const force =
        arena_alloc(c->arena, (size_t)most, sizeof *force, "contact", &d);
    if (!point || !edge || !force || !contact_friction_grow(c, most, &d)) return false;
    memcpy(point, c->pair_point, (size_t)c->n_pairs * sizeof *point);
    memcpy(edge, c->pair_edge, (size_t)c->n_pairs * sizeof *edge);
    c->pair_point = point;
    c->pair_edge = edge;
    c->force = force;
    c->most_pairs = most;
    return true;
}

struct lister {
    struct contact *c;
    int32_t point;
    int64_t first; /* of the point's pairs */
};

/* Keeps an edge if it is near enough, in ascending order of edges. */
static void keep_pair(void *context, int32_t edge)
{
    const struct lister *const l = context;
    struct contact *const c = l->c;
    const struct contact_law law = contact_pair_law(c, l->point, edge);
    if (!law.on) return;
    const double margin = c->margin[contact_with(c, l->point, edge)];
    const struct contact_foot foot = contact_foot(c, &law, l->point, edge);
    if (!(foot.distance < foot.reach + margin)) return;
    if (c->n_pairs == c->most_pairs && !grow(c)) {
        c->list_full = true;
        return;
    }
    int64_t at = c->n_pairs++;
    for (; at > l->first && c->pair_edge[at - 1] > edge; at--)
        c->pair_edge[at] = c->pair_edge[at - 1];
    c->pair_edge[at] = edge;
    c->pair_point[c->n_pairs - 1] = l->point;
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
    contact_grid_fill(&c->grid, c->n_edges, skip);
    c->n_pairs = 0;
    for (int64_t k = 0; k < c->n_points; k++) {
        if (k >= c->n_solid_points && !in_box(&box, c->x[k], c->y[k])) continue;
        struct lister l = {c, (int32_t)k, c->n_pairs};
        contact_grid_find(&c->grid, c->x[k], c->y[k], reach, keep_pair, &l);
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
