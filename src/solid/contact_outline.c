/* SPDX-License-Identifier: MIT
 * How far surface points lie inside the outlines of the shapes that they sample (T-61b). */
#include "geometry/outline.h"
#include "solid/contact_law.h"

#include "base/elementary.h"

#include <math.h>

/* Shapes of a solid or wall. */
struct region {
    struct outlines add, minus;
    int group;
};

struct regions {
    int n;
    struct region *item;
    double *scratch;
};

static enum err cut(struct regions *r, const struct scene *scene, int group,
                    const struct shape_list *add, const struct shape_list *minus, struct arena *a,
                    struct diag *d)
{
    struct region *const to = &r->item[r->n++];
    to->group = group;
    TRY(outlines_of(&to->add, scene, add, a, d));
    return outlines_of(&to->minus, scene, minus, a, d);
}

static enum err create(struct regions *r, const struct contact *c, struct arena *a, struct diag *d)
{
    const struct scene *const s = c->scene;
    *r = (struct regions){0};
    r->item = arena_alloc(a, (size_t)(c->n_solids + c->n_walls), sizeof *r->item, "contact", d);
    if (!r->item) return ERR_MEMORY;
    for (int k = 0; k < c->n_solids; k++)
        TRY(cut(r, s, c->solid->body[k].bond, &s->solid[k].shape, &s->solid[k].minus, a, d));
    for (int k = 0; k < c->n_walls; k++)
        TRY(cut(r, s, c->n_solids + 1 + scene_find_motion(s, s->wall[k].motion), &s->wall[k].shape,
                &s->wall[k].minus, a, d));
    int most = 2;
    for (int k = 0; k < r->n; k++) {
        const int add = outlines_capacity(&r->item[k].add);
        const int minus = outlines_capacity(&r->item[k].minus);
        most = add > most ? add : most;
        most = minus > most ? minus : most;
    }
    r->scratch = arena_alloc(a, (size_t)most, sizeof *r->scratch, "contact", d);
    return r->scratch ? ERR_OK : ERR_MEMORY;
}

static bool in_any(const struct outlines *o, double x, double y, double *scratch)
{
    for (int k = 0; k < o->n; k++)
        if (outline_contains(&o->item[k], x, y, scratch)) return true;
    return false;
}

static bool inside(const struct regions *r, int group, double x, double y)
{
    for (int k = 0; k < r->n; k++) {
        const struct region *const of = &r->item[k];
        if (of->group == group && in_any(&of->add, x, y, r->scratch) &&
            !in_any(&of->minus, x, y, r->scratch))
            return true;
    }
    return false;
}

/* A point in search of the nearest place of the outline. */
struct nearest {
    const struct regions *regions;
    int group;
    double x, y, distance;
};

/* Takes a place of a piece if it is nearer and on the outline of the union: just beyond it is
 * outside. */
static void try_place(struct nearest *n, double x, double y)
{
    const double dx = x - n->x, dy = y - n->y, distance = elementary_hypot(dx, dy);
    if (!(distance < n->distance)) return;
    const double beyond = 1 + 1e-6;
    if (inside(n->regions, n->group, n->x + beyond * dx, n->y + beyond * dy)) return;
    n->distance = distance;
}

static void try_piece(struct nearest *n, const struct outline *o)
{
    if (n->x < o->low[0] - n->distance || n->x > o->high[0] + n->distance ||
        n->y < o->low[1] - n->distance || n->y > o->high[1] + n->distance)
        return;
    if (o->n == 0) {
        const double dx = n->x - o->centre[0], dy = n->y - o->centre[1];
        const double r = elementary_hypot(dx, dy);
        if (r > 0)
            try_place(n, o->centre[0] + o->radius / r * dx, o->centre[1] + o->radius / r * dy);
        return;
    }
    for (int k = 0; k < o->n; k++) {
        const double *const a = o->pt[k], *const b = o->pt[k + 1 < o->n ? k + 1 : 0];
        const double ex = b[0] - a[0], ey = b[1] - a[1], length2 = ex * ex + ey * ey;
        if (length2 == 0) continue;
        const double along = (n->x - a[0]) * ex + (n->y - a[1]) * ey;
        const double s = min2(1, max2(0, along / length2));
        try_place(n, a[0] + s * ex, a[1] + s * ey);
    }
}

/* Distance to the outline less half a spacing. On a lattice that fits it is zero, but for
 * round-off. */
static double outer_of(const struct regions *r, int group, double x, double y, double dp)
{
    struct nearest n = {r, group, x, y, dp};
    for (int k = 0; k < r->n; k++) {
        if (r->item[k].group != group) continue;
        for (int j = 0; j < r->item[k].add.n; j++) try_piece(&n, &r->item[k].add.item[j]);
        for (int j = 0; j < r->item[k].minus.n; j++) try_piece(&n, &r->item[k].minus.item[j]);
    }
    if (!(n.distance < dp)) return 0;
    const double outer = n.distance - 0.5 * dp;
    return fabs(outer) < 1e-6 * dp ? 0 : outer;
}

/* The length of outline that each point stands for: half of both edges, as seen from the outline. At the
 * end of a line it is a whole edge, for a single point a spacing. On a lattice that fits it is the
 * spacing, but for round-off. */
static void find_width(struct contact *c)
{
    for (int64_t k = 0; k < c->n_edges; k++) {
        const int32_t a = c->edge[k].a, b = c->edge[k].b;
        const double length2 = square(c->X[b] - c->X[a]) + square(c->Y[b] - c->Y[a]);
        const double along = sqrt(max2(0, length2 - square(c->outer[b] - c->outer[a])));
        c->width[a] += (1 - c->share[a]) * along;
        c->width[b] += (1 - c->share[b]) * along;
    }
    for (int64_t k = 0; k < c->n_points; k++) {
        const double dp = dp_of(c, c->body[k]);
        if (c->width[k] == 0 || fabs(c->width[k] - dp) < 1e-6 * dp) c->width[k] = dp;
    }
}

static enum err find_outer(struct contact *c, struct arena *temp, struct diag *d)
{
    struct regions r;
    TRY(create(&r, c, temp, d));
    for (int64_t k = 0; k < c->n_points; k++) {
        const double dp = dp_of(c, c->body[k]);
        c->outer[k] = outer_of(&r, c->group[k], c->X[k], c->Y[k], dp);
        c->most_outer = max2(c->most_outer, c->outer[k]);
    }
    find_width(c);
    return ERR_OK;
}

enum err contact_find_outer(struct contact *c, struct arena *a, struct diag *d)
{
    struct arena temp = {.limit = a->limit};
    const enum err e = find_outer(c, &temp, d);
    arena_free(&temp);
    return e;
}
