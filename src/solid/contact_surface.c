/* SPDX-License-Identifier: MIT
 * Surfaces of solids and walls as lines through their outermost particles: the alpha shape of each
 * group (Edelsbrunner, Kirkpatrick and Seidel 1983). */
#include "solid/contact.h"
#include "base/segment.h"
#include "geometry/outline.h"
#include "solid/hinges.h"

/* Radius of the circle that rolls over the surface, in spacings. Four particles of a lattice cell
 * lie on a circle of 0.71, and a circle below 1 enters a slit of one missing row. Between these
 * values the surface of a body on the lattice does not depend on it. */
static const double roll = 0.85;

/* Particles of one kind that may have a surface. */
struct cloud {
    int64_t n;
    double *x, *y;
    const int32_t *section;
    int first_body;
    int32_t *point; /* [n] number at the surface; -1: inside */
};

static int body_of_cloud(const struct cloud *of, int64_t i)
{
    return of->first_body + of->section[i];
}

/* Particles of the same group within reach of the circles. */
enum { AROUND = 64 };
struct around {
    const struct cloud *of;
    int32_t self;
    double radius; /* of the circles */
    int n;
    int32_t item[AROUND];
};

/* Whether the circle about (x, y) contains none of the particles around but `other`. */
static bool empty_circle(const struct around *at, double x, double y, int32_t other)
{
    const double inside2 = square(at->radius * (1 - 1e-9));
    for (int k = 0; k < at->n; k++) {
        const int32_t i = at->item[k];
        if (i != other && square(at->of->x[i] - x) + square(at->of->y[i] - y) < inside2)
            return false;
    }
    return true;
}

/* Links of a particle to neighbours with higher numbers and a free side: edges of particles. */
static int64_t links_of(const struct around *at, struct contact_edge *link, int64_t n)
{
    const struct cloud *const of = at->of;
    const int32_t i = at->self;
    for (int k = 0; k < at->n; k++) {
        const int32_t j = at->item[k];
        if (j < i) continue;
        const double x = of->x[j] - of->x[i], y = of->y[j] - of->y[i], length2 = x * x + y * y;
        if (length2 == 0) continue;
        const double up = sqrt((square(at->radius) - 0.25 * length2) / length2);
        const double mx = of->x[i] + 0.5 * x, my = of->y[i] + 0.5 * y;
        const bool left = empty_circle(at, mx - up * y, my + up * x, j);
        const bool right = empty_circle(at, mx + up * y, my - up * x, j);
        if (left || right)
            link[n++] = left && !right ? (struct contact_edge){j, i, true}
                                       : (struct contact_edge){i, j, !left};
    }
    return n;
}

/* A grid of the points without `skip` (NULL: of all), which visits a cell in ascending order. */
static enum err grid_of(struct point_grid *g, double side, int64_t n, double *x, double *y,
                        const double *skip, struct arena *temp, struct diag *d)
{
    TRY(point_grid_create(g, side, n, x, y, temp, d));
    for (int64_t i = n - 1; i >= 0; i--)
        if (!skip || skip[i] == 0) point_grid_insert(g, i);
    return ERR_OK;
}

static enum err find_links(const struct contact *contact, const struct cloud *of,
                           struct arena *temp, struct contact_edge *link, int64_t *n_links,
                           struct diag *d)
{
    struct point_grid g;
    double side = 0;
    for (int64_t i = 0; i < of->n; i++)
        side = max2(side, 2 * roll * contact_dp(contact, body_of_cloud(of, i)));
    TRY(grid_of(&g, side, of->n, of->x, of->y, NULL, temp, d));
    *n_links = 0;
    for (int64_t i = 0; i < of->n; i++) {
        const int32_t group = contact->group[body_of_cloud(of, i)];
        struct around at = {of, (int32_t)i, roll * contact_dp(contact, body_of_cloud(of, i)),
                            .n = 0};
        struct point_visit v = point_grid_visit(&g, of->x[i], of->y[i], 2 * at.radius);
        while (point_grid_next(&g, &v))
            if (v.k != i && contact->group[body_of_cloud(of, v.k)] == group && at.n < AROUND)
                at.item[at.n++] = (int32_t)v.k;
        const int64_t before = *n_links;
        *n_links = links_of(&at, link, *n_links);
        for (int64_t k = before; k < *n_links; k++) of->point[link[k].a] = of->point[link[k].b] = 0;
        if (at.n == 0) of->point[i] = 0;
    }
    return ERR_OK;
}

/* Numbers particles at surfaces of bodies moved by a motion, or others, on from n_points. */
static void number_points(struct contact *contact, const struct cloud *of, bool moves)
{
    for (int64_t i = 0; i < of->n; i++) {
        const int body = body_of_cloud(of, i);
        const int32_t group = contact->group[body];
        if (of->point[i] < 0 || (group > contact->n_solids) != moves) continue;
        of->point[i] = (int32_t)contact->n_points++;
        contact->point[of->point[i]] = (struct contact_point){.index = (int32_t)i,
                                                              .body = body,
                                                              .group = group,
                                                              .X = {of->x[i], of->y[i]},
                                                              .x = {of->x[i], of->y[i]},
                                                              .initial_group = -1};
    }
}

static void add_edge(struct contact *contact, int32_t a, int32_t b, bool sided)
{
    contact->point[a].edge = contact->point[b].edge = (int32_t)contact->n_edges;
    contact->edge[contact->n_edges++] = (struct contact_edge){a, b, sided};
}

/* Edges, and the weights of points by their number (T-61a); 0 edges count as 1. */
static void set_edges(struct contact *contact, const struct cloud of[2],
                      struct contact_edge *const link[2], const int64_t n_links[2])
{
    for (int c = 0; c < 2; c++)
        for (int64_t k = 0; k < n_links[c]; k++) {
            const int32_t a = of[c].point[link[c][k].a], b = of[c].point[link[c][k].b];
            add_edge(contact, a, b, link[c][k].sided);
            contact->point[a].share++;
            contact->point[b].share++;
        }
    for (int32_t k = 0; k < contact->n_points; k++) {
        double *const share = &contact->point[k].share;
        if (*share == 0)
            add_edge(contact, k, k, false);
        else
            *share = (*share - 1) / *share;
    }
}

/* Marks the points near hinges. */
static void find_hinges(struct contact *contact)
{
    const struct hinges *const hinges = contact->solid->hinges;
    for (int k = hinges ? hinges->n - 1 : -1; k >= 0; k--) {
        const struct hinge *const h = &hinges->hinge[k];
        const double reach2 = square(KERNEL_REACH * contact->solid->body[h->body[0]].h);
        for (int64_t n = 0; n < contact->n_points; n++) {
            struct contact_point *const p = &contact->point[n];
            if (square(p->X[0] - h->at[0]) + square(p->X[1] - h->at[1]) < reach2)
                p->near_hinge = (int16_t)(k + 1);
        }
    }
}

/* Marks the points near clamps. */
static enum err find_clamps(struct contact *contact, const struct particles *solid,
                            struct arena *temp, struct diag *d)
{
    struct point_grid g;
    double side = 0;
    for (int k = 0; k < contact->n_solids; k++)
        side = max2(side, KERNEL_REACH * contact->solid->body[k].h);
    TRY(grid_of(&g, side, solid->n, solid->X, solid->Y, solid->free, temp, d));
    for (int64_t k = 0; k < contact->n_solid_points; k++) {
        struct contact_point *const p = &contact->point[k];
        const double reach = KERNEL_REACH * contact->solid->body[p->body].h;
        struct point_visit v = point_grid_visit(&g, p->X[0], p->X[1], reach);
        while (point_grid_next(&g, &v))
            p->near_clamp |= contact->group[solid->body[v.k]] == p->group;
    }
    return ERR_OK;
}

static enum err find_surface(struct contact *contact, struct arena *a,
                             const struct particles *solid, struct arena *temp, struct diag *d)
{
    const struct scene_points *const wall = &contact->scene->points[KIND_WALL];
    struct cloud of[] = {{.n = solid->n, .x = solid->X, .y = solid->Y, .section = solid->body},
                         {.n = contact->n_walls ? wall->n : 0,
                          .x = wall->x,
                          .y = wall->y,
                          .section = wall->body,
                          .first_body = contact->n_solids}};
    struct contact_edge *link[2];
    int64_t n_links[2], n = 0;
    for (int k = 0; k < 2; k++) {
        /* A planar graph of n points has fewer than 3 n edges. */
        TRY(arena_array(temp, &link[k], 3 * (size_t)of[k].n + 1, "contact", d));
        TRY(arena_array(a, &of[k].point, of[k].n, "contact", d));
        for (int64_t i = 0; i < of[k].n; i++) of[k].point[i] = -1;
        TRY(find_links(contact, &of[k], temp, link[k], &n_links[k], d));
        for (int64_t i = 0; i < of[k].n; i++) n += of[k].point[i] >= 0;
    }
    TRY(arena_array(a, &contact->point, n, "contact", d));
    TRY(arena_array(a, &contact->edge, n_links[0] + n_links[1] + n, "contact", d));
    contact->wall_point = of[1].point;
    number_points(contact, &of[0], false);
    contact->n_solid_points = contact->n_points;
    number_points(contact, &of[1], true);
    contact->n_moving_points = contact->n_points;
    number_points(contact, &of[1], false);
    set_edges(contact, of, link, n_links);
    find_hinges(contact);
    return find_clamps(contact, solid, temp, d);
}

/* --- how far surface points lie inside the outlines of the shapes that they sample (T-61b) --- */

static enum err find_regions(const struct contact *contact, struct body_outlines *region,
                             struct arena *a, struct diag *d)
{
    const struct scene *const scene = contact->scene;
    for (int k = 0; k < contact->n_solids; k++)
        TRY(body_outlines_of(&region[k], scene, &scene->solid[k].shape, &scene->solid[k].minus, a,
                             d));
    for (int k = 0; k < contact->n_walls; k++)
        TRY(body_outlines_of(&region[contact->n_solids + k], scene, &scene->wall[k].shape,
                             &scene->wall[k].minus, a, d));
    return ERR_OK;
}

/* A point of a group in search of the nearest place of the outline. */
struct outline_search {
    const struct contact *contact;
    const struct body_outlines *region; /* [bodies] */
    int group;
    double x, y, distance;
};

static bool inside(const struct outline_search *n, double x, double y)
{
    for (int k = 0; k < n->contact->n_bodies; k++)
        if (n->contact->group[k] == n->group && body_outlines_contain(&n->region[k], x, y))
            return true;
    return false;
}

/* Takes a place of a piece if it is nearer and on the union's outline: just beyond is outside. */
static void try_place(struct outline_search *n, double dx, double dy)
{
    const double distance = elementary_hypot(dx, dy);
    const double beyond = 1 + 1e-6;
    if (distance < n->distance && !inside(n, n->x + beyond * dx, n->y + beyond * dy))
        n->distance = distance;
}

static void try_piece(struct outline_search *n, const struct outline *o)
{
    if (n->x < o->box.low[0] - n->distance || n->x > o->box.high[0] + n->distance ||
        n->y < o->box.low[1] - n->distance || n->y > o->box.high[1] + n->distance)
        return;
    if (o->n == 0) {
        const double dx = n->x - o->centre[0], dy = n->y - o->centre[1];
        const double beyond = o->radius / elementary_hypot(dx, dy) - 1;
        if (dx != 0 || dy != 0) try_place(n, beyond * dx, beyond * dy);
        return;
    }
    for (int k = 0; k < o->n; k++) {
        const double *const a = o->pt[k], *const b = o->pt[k + 1 < o->n ? k + 1 : 0];
        const struct segment_foot f = segment_foot((const double[]){n->x, n->y}, a, b, 0);
        if (a[0] != b[0] || a[1] != b[1]) try_place(n, -f.offset[0], -f.offset[1]);
    }
}

/* Distance to the outline less half a spacing: zero on a lattice that fits, but for round-off. */
static double inset_of(struct outline_search n, double dp)
{
    n.distance = dp;
    for (int k = 0; k < n.contact->n_bodies; k++) {
        if (n.contact->group[k] != n.group) continue;
        for (int j = 0; j < n.region[k].add.n; j++) try_piece(&n, &n.region[k].add.item[j]);
        for (int j = 0; j < n.region[k].minus.n; j++) try_piece(&n, &n.region[k].minus.item[j]);
    }
    const double inset = n.distance - 0.5 * dp;
    return !(n.distance < dp) || fabs(inset) < 1e-6 * dp ? 0 : inset;
}

/* The length of outline that each point stands for: half of both edges, as seen from the
 * outline. At the end of a line it is a whole edge, for a single point a spacing. On a lattice
 * that fits it is the spacing, but for round-off. */
static void find_width(struct contact *contact)
{
    for (int64_t k = 0; k < contact->n_edges; k++) {
        struct contact_point *const a = &contact->point[contact->edge[k].a],
                                    *const b = &contact->point[contact->edge[k].b];
        const double length2 = square(b->X[0] - a->X[0]) + square(b->X[1] - a->X[1]);
        const double along = sqrt(max2(0, length2 - square(b->inset - a->inset)));
        a->width += (1 - a->share) * along;
        b->width += (1 - b->share) * along;
    }
    for (int64_t k = 0; k < contact->n_points; k++) {
        double *const width = &contact->point[k].width;
        const double dp = contact_dp(contact, contact->point[k].body);
        if (*width == 0 || fabs(*width - dp) < 1e-6 * dp) *width = dp;
    }
}

static enum err find_outlines(struct contact *contact, struct arena *temp, struct diag *d)
{
    struct body_outlines *region;
    TRY(arena_array(temp, &region, contact->n_bodies, "contact", d));
    TRY(find_regions(contact, region, temp, d));
    for (int64_t k = 0; k < contact->n_points; k++) {
        struct contact_point *const p = &contact->point[k];
        p->inset = inset_of((struct outline_search){contact, region, p->group, p->X[0], p->X[1], 0},
                            contact_dp(contact, p->body));
        contact->max_inset = max2(contact->max_inset, p->inset);
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
