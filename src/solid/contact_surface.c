/* SPDX-License-Identifier: MIT
 * Surfaces of solids and walls as lines through their outermost particles: the alpha shape of each
 * group (Edelsbrunner, Kirkpatrick and Seidel 1983). */
#include "solid/contact_surface.h"

#include "base/elementary.h"
#include "geometry/outline.h"
#include "particles/kernel.h"

#include <math.h>
#include <string.h>

/* Radius of the circle that rolls over the surface, in spacings. Four particles of a lattice cell
 * lie on a circle of 0.71, and a circle below 1 enters a slit of one missing row. Between these
 * values the surface of a body on the lattice does not depend on it. */
static const double roll = 0.85;

/* Particles of one kind that may have a surface. */
struct cloud {
    int64_t n;
    double *x, *y;
    int32_t *body, *group;
    double *dp;
    int32_t *point; /* [n] number at the surface; -1: inside */
};

/* Two neighbours with a free side. */
struct link {
    int32_t a, b;
    bool sided;
};

/* Particles of the same group within reach of the circles. */
enum { AROUND = 64 };
struct around {
    const struct cloud *of;
    int32_t self;
    int n;
    int32_t item[AROUND];
};

/* Whether the circle about (x, y) contains none of the particles around but `other`. */
static bool empty_circle(const struct around *at, double x, double y, double radius, int32_t other)
{
    const double inside2 = square(radius * (1 - 1e-9));
    for (int k = 0; k < at->n; k++) {
        const int32_t i = at->item[k];
        if (i != other && square(at->of->x[i] - x) + square(at->of->y[i] - y) < inside2)
            return false;
    }
    return true;
}

/* Links of a particle to neighbours with higher numbers. */
static int64_t links_of(const struct around *at, struct link *link, int64_t n)
{
    const struct cloud *const of = at->of;
    const int32_t i = at->self;
    const double radius = roll * of->dp[i];
    for (int k = 0; k < at->n; k++) {
        const int32_t j = at->item[k];
        if (j < i) continue;
        const double x = of->x[j] - of->x[i], y = of->y[j] - of->y[i], length2 = x * x + y * y;
        if (length2 == 0) continue;
        const double up = sqrt((square(radius) - 0.25 * length2) / length2);
        const double mx = of->x[i] + 0.5 * x, my = of->y[i] + 0.5 * y;
        const bool left = empty_circle(at, mx - up * y, my + up * x, radius, j);
        const bool right = empty_circle(at, mx + up * y, my - up * x, radius, j);
        if (left || right)
            link[n++] = left && !right ? (struct link){j, i, true} : (struct link){i, j, !left};
    }
    return n;
}

/* A grid of the points without `skip`, NULL: of all, which visits those of a cell in ascending
 * order. */
static enum err grid_of(struct point_grid *g, double side, int64_t n, double *x, double *y,
                        const double *skip, struct arena *temp, struct diag *d)
{
    TRY(point_grid_create(g, side, n, x, y, temp, d));
    for (int64_t i = n - 1; i >= 0; i--)
        if (!skip || skip[i] == 0) point_grid_insert(g, i);
    return ERR_OK;
}

static enum err find_links(const struct cloud *of, struct arena *temp, struct link *link,
                           int64_t *n_links, struct diag *d)
{
    struct point_grid g;
    double side = 0;
    for (int64_t i = 0; i < of->n; i++) side = max2(side, 2 * roll * of->dp[i]);
    TRY(grid_of(&g, side, of->n, of->x, of->y, NULL, temp, d));
    *n_links = 0;
    for (int64_t i = 0; i < of->n; i++) {
        struct around at = {.of = of, .self = (int32_t)i};
        struct point_visit v = point_grid_visit(&g, of->x[i], of->y[i], 2 * roll * of->dp[i]);
        while (point_grid_next(&g, &v))
            if (v.k != i && of->group[v.k] == of->group[i] && at.n < AROUND)
                at.item[at.n++] = (int32_t)v.k;
        const int64_t before = *n_links;
        *n_links = links_of(&at, link, *n_links);
        for (int64_t k = before; k < *n_links; k++) of->point[link[k].a] = of->point[link[k].b] = 0;
        if (at.n == 0) of->point[i] = 0;
    }
    return ERR_OK;
}

/* Numbers the particles at the surface of groups from `first` to before `end` on from
 * c->n_points. */
static void number_points(struct contact *contact, const struct cloud *of, int32_t first,
                          int32_t end)
{
    for (int64_t i = 0; i < of->n; i++) {
        if (of->point[i] < 0 || of->group[i] < first || of->group[i] >= end) continue;
        const int64_t k = of->point[i] = (int32_t)contact->n_points++;
        contact->index[k] = (int32_t)i;
        contact->body[k] = of->body[i];
        contact->group[k] = of->group[i];
        contact->X[k] = contact->x[k] = of->x[i];
        contact->Y[k] = contact->y[k] = of->y[i];
    }
}

static void add_edges(struct contact *contact, const struct cloud *of, const struct link *link,
                      int64_t n_links)
{
    for (int64_t k = 0; k < n_links; k++) {
        const int32_t a = of->point[link[k].a], b = of->point[link[k].b];
        contact->edge[contact->n_edges++] = (struct contact_edge){a, b, link[k].sided};
        contact->share[a]++;
        contact->share[b]++;
    }
}

/* Converts the number of edges at each point to its weight (T-61a); 0 edges count as 1. */
static void set_shares(struct contact *contact)
{
    for (int64_t k = 0; k < contact->n_points; k++) {
        if (contact->share[k] == 0)
            contact->edge[contact->n_edges++] =
                (struct contact_edge){(int32_t)k, (int32_t)k, false};
        else
            contact->share[k] = (contact->share[k] - 1) / contact->share[k];
    }
}

static enum err points_create(struct contact *contact, struct arena *a, size_t n, struct diag *d)
{
    int32_t **const number[] = {&contact->index, &contact->body, &contact->group,
                                &contact->initial_group};
    double **const place[] = {&contact->X,       &contact->Y,     &contact->x,     &contact->y,
                              &contact->vx,      &contact->vy,    &contact->at_x,  &contact->at_y,
                              &contact->initial, &contact->share, &contact->outer, &contact->width};
    for (size_t k = 0; k < COUNT_OF(number); k++)
        if (!(*number[k] = arena_alloc(a, n, sizeof(int32_t), "contact", d))) return ERR_MEMORY;
    for (size_t k = 0; k < COUNT_OF(place); k++)
        if (!(*place[k] = arena_alloc(a, n, sizeof(double), "contact", d))) return ERR_MEMORY;
    return ERR_OK;
}

static enum err cloud_create(struct cloud *of, struct arena *temp, int64_t n, double *x, double *y,
                             struct diag *d)
{
    *of = (struct cloud){.n = n, .x = x, .y = y};
    of->body = arena_alloc(temp, (size_t)n, sizeof *of->body, "contact", d);
    of->group = arena_alloc(temp, (size_t)n, sizeof *of->group, "contact", d);
    of->point = arena_alloc(temp, (size_t)n, sizeof *of->point, "contact", d);
    of->dp = arena_alloc(temp, (size_t)n, sizeof *of->dp, "contact", d);
    return of->body && of->group && of->point && of->dp ? ERR_OK : ERR_MEMORY;
}

/* Bonded solids form one group; so do walls that move together or are at rest. */
static enum err make_clouds(struct contact *contact, const struct particles *solid,
                            struct cloud of[2], struct arena *temp, struct diag *d)
{
    const struct scene *const scene = contact->scene;
    const struct scene_points *const wall = &scene->points[KIND_WALL];
    TRY(cloud_create(&of[0], temp, solid->n, solid->X, solid->Y, d));
    TRY(cloud_create(&of[1], temp, contact->n_walls ? wall->n : 0, wall->x, wall->y, d));
    for (int64_t i = 0; i < of[0].n; i++) {
        of[0].body[i] = solid->body[i];
        of[0].group[i] = contact->solid->body[solid->body[i]].bond;
        of[0].dp[i] = contact->solid->body[solid->body[i]].dp;
    }
    for (int64_t i = 0; i < of[1].n; i++) {
        const int motion = scene_find_motion(scene, scene->wall[wall->body[i]].motion);
        of[1].body[i] = contact->n_solids + wall->body[i];
        of[1].group[i] = contact->n_solids + 1 + motion;
        of[1].dp[i] = scene->top.dp;
    }
    return ERR_OK;
}

/* Marks the points near hinges. */
static enum err find_hinges(struct contact *contact, struct arena *a, struct diag *d)
{
    const struct hinges *const hinges = contact->solid->hinges;
    contact->near_hinge =
        arena_alloc(a, (size_t)contact->n_points, sizeof *contact->near_hinge, "contact", d);
    if (!contact->near_hinge) return ERR_MEMORY;
    for (int k = hinges ? hinges->n - 1 : -1; k >= 0; k--) {
        const struct hinge *const h = &hinges->hinge[k];
        const double reach2 = square(KERNEL_REACH * contact->solid->body[h->body[0]].h);
        for (int64_t n = 0; n < contact->n_points; n++)
            if (square(contact->X[n] - h->at[0]) + square(contact->Y[n] - h->at[1]) < reach2)
                contact->near_hinge[n] = (int16_t)(k + 1);
    }
    return ERR_OK;
}

/* Marks the points near clamps. */
static enum err find_clamps(struct contact *contact, struct arena *a, const struct particles *solid,
                            struct arena *temp, struct diag *d)
{
    struct point_grid g;
    double side = 0;
    for (int k = 0; k < contact->n_solids; k++)
        side = max2(side, KERNEL_REACH * contact->solid->body[k].h);
    TRY(grid_of(&g, side, solid->n, solid->X, solid->Y, solid->free, temp, d));
    contact->near_clamp =
        arena_alloc(a, (size_t)contact->n_points, sizeof *contact->near_clamp, "contact", d);
    if (!contact->near_clamp) return ERR_MEMORY;
    for (int64_t k = 0; k < contact->n_solid_points; k++) {
        const double reach = KERNEL_REACH * contact->solid->body[contact->body[k]].h;
        struct point_visit v = point_grid_visit(&g, contact->X[k], contact->Y[k], reach);
        while (point_grid_next(&g, &v))
            contact->near_clamp[k] |=
                contact->solid->body[solid->body[v.k]].bond == contact->group[k];
    }
    return ERR_OK;
}

static enum err find_surface(struct contact *contact, struct arena *a,
                             const struct particles *solid, struct arena *temp, struct diag *d)
{
    struct cloud of[2];
    struct link *link[2];
    int64_t n_links[2], n = 0;
    TRY(make_clouds(contact, solid, of, temp, d));
    for (int k = 0; k < 2; k++) {
        /* A planar graph of n points has fewer than 3 n edges. */
        link[k] = arena_alloc(temp, 3 * (size_t)of[k].n + 1, sizeof *link[k], "contact", d);
        if (!link[k]) return ERR_MEMORY;
        for (int64_t i = 0; i < of[k].n; i++) of[k].point[i] = -1;
        TRY(find_links(&of[k], temp, link[k], &n_links[k], d));
        for (int64_t i = 0; i < of[k].n; i++) n += of[k].point[i] >= 0;
    }
    TRY(points_create(contact, a, (size_t)n, d));
    contact->edge =
        arena_alloc(a, (size_t)(n_links[0] + n_links[1] + n), sizeof *contact->edge, "contact", d);
    contact->wall_point =
        arena_alloc(a, (size_t)of[1].n, sizeof *contact->wall_point, "contact", d);
    if (!contact->edge || !contact->wall_point) return ERR_MEMORY;
    /* Solids, walls that move, walls at rest. */
    number_points(contact, &of[0], 0, contact->n_solids);
    contact->n_solid_points = contact->n_points;
    number_points(contact, &of[1], contact->n_solids + 1, contact->n_groups);
    contact->n_moving_points = contact->n_points;
    number_points(contact, &of[1], contact->n_solids, contact->n_solids + 1);
    for (int k = 0; k < 2; k++) add_edges(contact, &of[k], link[k], n_links[k]);
    set_shares(contact);
    for (int64_t i = 0; i < of[1].n; i++) contact->wall_point[i] = of[1].point[i];
    TRY(find_hinges(contact, a, d));
    return find_clamps(contact, a, solid, temp, d);
}

/* --- how far surface points lie inside the outlines of the shapes that they sample (T-61b) --- */

/* Shapes of a solid or wall. */
struct region {
    struct outlines add, minus;
    int group;
};

struct regions {
    int n;
    struct region *item;
};

static enum err add_region(struct regions *r, const struct scene *scene, int group,
                           const struct shape_list *add, const struct shape_list *minus,
                           struct arena *a, struct diag *d)
{
    struct region *const to = &r->item[r->n++];
    to->group = group;
    TRY(outlines_of(&to->add, scene, add, a, d));
    return outlines_of(&to->minus, scene, minus, a, d);
}

static enum err regions_create(struct regions *r, const struct contact *contact, struct arena *a,
                               struct diag *d)
{
    const struct scene *const scene = contact->scene;
    *r = (struct regions){0};
    r->item = arena_alloc(a, (size_t)(contact->n_solids + contact->n_walls), sizeof *r->item,
                          "contact", d);
    if (!r->item) return ERR_MEMORY;
    for (int k = 0; k < contact->n_solids; k++)
        TRY(add_region(r, scene, contact->solid->body[k].bond, &scene->solid[k].shape,
                       &scene->solid[k].minus, a, d));
    for (int k = 0; k < contact->n_walls; k++)
        TRY(add_region(r, scene,
                       contact->n_solids + 1 + scene_find_motion(scene, scene->wall[k].motion),
                       &scene->wall[k].shape, &scene->wall[k].minus, a, d));
    return ERR_OK;
}

static bool inside(const struct regions *r, int group, double x, double y)
{
    for (int k = 0; k < r->n; k++) {
        const struct region *const of = &r->item[k];
        if (of->group == group && outlines_find(&of->add, x, y) >= 0 &&
            outlines_find(&of->minus, x, y) < 0)
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

/* The length of outline that each point stands for: half of both edges, as seen from the
 * outline. At the end of a line it is a whole edge, for a single point a spacing. On a lattice
 * that fits it is the spacing, but for round-off. */
static void find_width(struct contact *contact)
{
    for (int64_t k = 0; k < contact->n_edges; k++) {
        const int32_t a = contact->edge[k].a, b = contact->edge[k].b;
        const double length2 =
            square(contact->X[b] - contact->X[a]) + square(contact->Y[b] - contact->Y[a]);
        const double along = sqrt(max2(0, length2 - square(contact->outer[b] - contact->outer[a])));
        contact->width[a] += (1 - contact->share[a]) * along;
        contact->width[b] += (1 - contact->share[b]) * along;
    }
    for (int64_t k = 0; k < contact->n_points; k++) {
        const double dp = contact_dp(contact, contact->body[k]);
        if (contact->width[k] == 0 || fabs(contact->width[k] - dp) < 1e-6 * dp)
            contact->width[k] = dp;
    }
}

static enum err find_outlines(struct contact *contact, struct arena *temp, struct diag *d)
{
    struct regions r;
    TRY(regions_create(&r, contact, temp, d));
    for (int64_t k = 0; k < contact->n_points; k++) {
        const double dp = contact_dp(contact, contact->body[k]);
        contact->outer[k] = outer_of(&r, contact->group[k], contact->X[k], contact->Y[k], dp);
        contact->max_outer = max2(contact->max_outer, contact->outer[k]);
    }
    find_width(contact);
    return ERR_OK;
}

enum err contact_surface_create(struct contact *contact, struct arena *a,
                                const struct particles *solid, struct diag *d)
{
    struct arena temp = {.limit = a->limit};
    enum err e = find_surface(contact, a, solid, &temp, d);
    if (!e) e = find_outlines(contact, &temp, d);
    arena_free(&temp);
    return e;
}
