/* SPDX-License-Identifier: MIT
 * Where friction holds surfaces to each other (T-62). A point of a solid sticks to a place on the edge
 * that it touches. If the spring between both would exceed Coulomb's friction, the place slides. */
#include "solid/contact_law.h"

#include <math.h>

#include "base/elementary.h"

enum err contact_stick_create(struct contact *c, struct arena *a, struct diag *d)
{
    const size_t n = (size_t)c->n_solid_points;
    c->stick_x = arena_alloc(a, n, sizeof *c->stick_x, "contact", d);
    c->stick_y = arena_alloc(a, n, sizeof *c->stick_y, "contact", d);
    c->stick_group = arena_alloc(a, n, sizeof *c->stick_group, "contact", d);
    return c->stick_x && c->stick_y && c->stick_group ? ERR_OK : ERR_MEMORY;
}

void contact_find_stick(struct contact *c, const struct particles *p)
{
    if (!c->stick_x) return;
#pragma omp for schedule(static)
    for (int64_t k = 0; k < c->n_solid_points; k++) {
        const int64_t edge = p->stick_edge[c->index[k]] - 1;
        c->stick_group[k] = -1;
        if (edge < 0 || edge >= c->n_edges) continue;
        const int32_t a = c->edge[edge].a, b = c->edge[edge].b;
        const double s = p->stick_at[c->index[k]];
        c->stick_x[k] = c->x[k] - (c->x[a] + s * (c->x[b] - c->x[a]));
        c->stick_y[k] = c->y[k] - (c->y[a] + s * (c->y[b] - c->y[a]));
        c->stick_group[k] = c->group[a];
    }
}

/* Adds `part` of the displacement of a solid's point from its place on the group. */
static void add_stick(const struct contact *c, int32_t point, int32_t group, double part,
                      double d[2])
{
    if (point >= c->n_solid_points || c->stick_group[point] != group) return;
    d[0] += part * c->stick_x[point];
    d[1] += part * c->stick_y[point];
}

void contact_stick(const struct contact *c, int32_t point, int32_t a, int32_t b, double s,
                   double d[2])
{
    d[0] = d[1] = 0;
    if (!c->stick_x) return;
    if (point < c->n_solid_points) {
        add_stick(c, point, c->group[a], 1, d);
    } else {
        add_stick(c, a, c->group[point], s - 1, d);
        add_stick(c, b, c->group[point], -s, d);
    }
}

/* The place where a point of a solid sticks, after a step in which `edge` was the nearest. */
static void slide(const struct contact *c, struct particles *p, int32_t point, int32_t edge)
{
    const struct contact_law law = contact_pair_law(c, point, edge);
    const struct contact_foot foot = contact_foot(c, &law, point, edge);
    const struct pair q = pair_of(c, &law, point, edge, foot.least_reach);
    const int32_t a = c->edge[edge].a, b = c->edge[edge].b, i = c->index[point];
    const double r = foot.distance, n[2] = {foot.x / r, foot.y / r};
    double v[2], d[2];
    relative_velocity(c, point, edge, foot.at, v);
    contact_stick(c, point, a, b, foot.at, d);
    const double push =
        max2(0, elastic_force(&q, contact_left(&foot)) - q.damping * (v[0] * n[0] + v[1] * n[1]));
    const double pull = q.stiffness * elementary_hypot(across(n, d, 0), across(n, d, 1));
    const bool slides = pull > q.friction * push;
    if (!slides && p->stick_edge[i] == edge + 1) return;
    const double less = slides ? q.friction * push / pull : 1;
    const double x = c->x[b] - c->x[a], y = c->y[b] - c->y[a], length2 = x * x + y * y;
    const double along = across(n, d, 0) * x + across(n, d, 1) * y;
    p->stick_edge[i] = edge + 1;
    p->stick_at[i] = length2 > 0 ? foot.at - less * along / length2 : 0;
}

/* The nearest of the edges that a point touches with friction, from its pairs; -1: none. */
static int32_t nearest_edge(const struct contact *c, int64_t first, int64_t end)
{
    double nearest = (double)INFINITY;
    int32_t edge = -1;
    for (int64_t k = first; k < end; k++) {
        const int32_t point = c->pair_point[k];
        if (!c->force[k].touches) continue;
        const struct contact_law law = contact_pair_law(c, point, c->pair_edge[k]);
        const struct contact_foot foot = contact_foot(c, &law, point, c->pair_edge[k]);
        const double r = foot.distance;
        if (!(law.friction > 0) || !(r < nearest) || contact_left(&foot) <= 0) continue;
        nearest = r;
        edge = c->pair_edge[k];
    }
    return edge;
}

void contact_slide(struct contact *c, struct particles *p)
{
    if (!c->stick_x) return;
    int64_t k = 0;
    for (int32_t point = 0; point < c->n_solid_points; point++) {
        const int64_t first = k;
        while (k < c->n_pairs && c->pair_point[k] == point) k++;
        const int32_t edge = nearest_edge(c, first, k);
        if (edge >= 0)
            slide(c, p, point, edge);
        else
            p->stick_edge[c->index[point]] = 0;
    }
}
