/* SPDX-License-Identifier: MIT
 * Surfaces of solids and walls as lines through their outermost particles: the alpha shape of each
 * group (Edelsbrunner, Kirkpatrick and Seidel 1983). */
#include "solid/contact.h"

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
    const double *x, *y;
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
    int32_t self, group;
    double limit2;
    int n;
    int32_t item[AROUND];
};

static void note(void *context, int32_t item)
{
    struct around *const at = context;
    const struct cloud *const of = at->of;
    if (item == at->self || of->group[item] != at->group || at->n >= AROUND) return;
    const double x = of->x[item] - of->x[at->self], y = of->y[item] - of->y[at->self];
    if (x * x + y * y < at->limit2) at->item[at->n++] = item;
}

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

static enum err find_links(const struct cloud *of, struct arena *temp, struct link *link,
                           int64_t *n_links, struct diag *d)
{
    struct contact_grid g = {.x = of->x, .y = of->y};
    TRY(contact_grid_create(&g, temp, of->n, d));
    for (int64_t i = 0; i < of->n; i++) g.side = max2(g.side, 2 * roll * of->dp[i]);
    contact_grid_fill(&g, of->n, NULL);
    *n_links = 0;
    for (int64_t i = 0; i < of->n; i++) {
        struct around at = {of, (int32_t)i, of->group[i], square(2 * roll * of->dp[i]), 0, {0}};
        contact_grid_find(&g, of->x[i], of->y[i], 2 * roll * of->dp[i], note, &at);
        const int64_t before = *n_links;
        *n_links = links_of(&at, link, *n_links);
        for (int64_t k = before; k < *n_links; k++) of->point[link[k].a] = of->point[link[k].b] = 0;
        if (at.n == 0) of->point[i] = 0;
    }
    return ERR_OK;
}

/* Numbers the particles at the surface of groups from `first` to before `end` on from c->n_points. */
static void number_points(struct contact *c, const struct cloud *of, int32_t first, int32_t end)
{
    for (int64_t i = 0; i < of->n; i++) {
        if (of->point[i] < 0 || of->group[i] < first || of->group[i] >= end) continue;
        const int64_t k = of->point[i] = (int32_t)c->n_points++;
        c->index[k] = (int32_t)i;
        c->body[k] = of->body[i];
        c->group[k] = of->group[i];
        c->X[k] = c->x[k] = of->x[i];
        c->Y[k] = c->y[k] = of->y[i];
    }
}

static void add_edges(struct contact *c, const struct cloud *of, const struct link *link,
                      int64_t n_links)
{
    for (int64_t k = 0; k < n_links; k++) {
        const int32_t a = of->point[link[k].a], b = of->point[link[k].b];
        c->edge[c->n_edges++] = (struct contact_edge){a, b, link[k].sided};
        c->share[a]++;
        c->share[b]++;
    }
}

/* Converts the number of edges at each point to its weight (T-61a); 0 edges count as 1. */
static void set_shares(struct contact *c)
{
    for (int64_t k = 0; k < c->n_points; k++) {
        if (c->share[k] == 0)
            c->edge[c->n_edges++] = (struct contact_edge){(int32_t)k, (int32_t)k, false};
        else
            c->share[k] = (c->share[k] - 1) / c->share[k];
    }
}

static enum err points_create(struct contact *c, struct arena *a, size_t n, struct diag *d)
{
    int32_t **const number[] = {&c->index, &c->body, &c->group, &c->began_group};
    double **const place[] = {&c->X,    &c->Y,    &c->x,     &c->y,     &c->vx,    &c->vy,
                              &c->at_x, &c->at_y, &c->began, &c->share, &c->outer, &c->width};
    for (size_t k = 0; k < COUNT_OF(number); k++)
        if (!(*number[k] = arena_alloc(a, n, sizeof(int32_t), "contact", d))) return ERR_MEMORY;
    for (size_t k = 0; k < COUNT_OF(place); k++)
        if (!(*place[k] = arena_alloc(a, n, sizeof(double), "contact", d))) return ERR_MEMORY;
    return ERR_OK;
}

static enum err cloud_create(struct cloud *of, struct arena *temp, int64_t n, const double *x,
                             const double *y, struct diag *d)
{
    *of = (struct cloud){.n = n, .x = x, .y = y};
    of->body = arena_alloc(temp, (size_t)n, sizeof *of->body, "contact", d);
    of->group = arena_alloc(temp, (size_t)n, sizeof *of->group, "contact", d);
    of->point = arena_alloc(temp, (size_t)n, sizeof *of->point, "contact", d);
    of->dp = arena_alloc(temp, (size_t)n, sizeof *of->dp, "contact", d);
    return of->body && of->group && of->point && of->dp ? ERR_OK : ERR_MEMORY;
}

/* Bonded solids form one group; so do walls that move together or are at rest. */
static enum err make_clouds(struct contact *c, const struct particles *solid, struct cloud of[2],
                            struct arena *temp, struct diag *d)
{
    const struct scene *const scene = c->scene;
    const struct scene_points *const wall = &scene->points[KIND_WALL];
    TRY(cloud_create(&of[0], temp, solid->n, solid->X, solid->Y, d));
    TRY(cloud_create(&of[1], temp, c->n_walls ? wall->n : 0, wall->x, wall->y, d));
    for (int64_t i = 0; i < of[0].n; i++) {
        of[0].body[i] = solid->body[i];
        of[0].group[i] = c->solid->body[solid->body[i]].bond;
        of[0].dp[i] = c->solid->body[solid->body[i]].dp;
    }
    for (int64_t i = 0; i < of[1].n; i++) {
        const int motion = scene_find_motion(scene, scene->wall[wall->body[i]].motion);
        of[1].body[i] = c->n_solids + wall->body[i];
        of[1].group[i] = c->n_solids + 1 + motion;
        of[1].dp[i] = scene->top.dp;
    }
    return ERR_OK;
}

struct holder {
    struct contact *c;
    const struct particles *solid;
    int64_t point;
};

static void note_clamp(void *context, int32_t particle)
{
    const struct holder *const h = context;
    if (h->c->solid->body[h->solid->body[particle]].bond == h->c->group[h->point])
        h->c->held[h->point] = 1;
}

/* Marks the points near clamps. */
static enum err find_held(struct contact *c, struct arena *a, const struct particles *solid,
                          struct arena *temp, struct diag *d)
{
    struct contact_grid g = {.x = solid->X, .y = solid->Y};
    TRY(contact_grid_create(&g, temp, solid->n, d));
    uint8_t *const free = arena_alloc(temp, (size_t)solid->n, sizeof *free, "contact", d);
    c->held = arena_alloc(a, (size_t)c->n_points, sizeof *c->held, "contact", d);
    if (!free || !c->held) return ERR_MEMORY;
    for (int64_t i = 0; i < solid->n; i++) free[i] = solid->free[i] != 0;
    for (int k = 0; k < c->n_solids; k++) g.side = max2(g.side, KERNEL_REACH * c->solid->body[k].h);
    contact_grid_fill(&g, solid->n, free);
    for (int64_t k = 0; k < c->n_solid_points; k++) {
        struct holder h = {c, solid, k};
        contact_grid_find(&g, c->X[k], c->Y[k], KERNEL_REACH * c->solid->body[c->body[k]].h,
                          note_clamp, &h);
    }
    return ERR_OK;
}

static enum err find_surface(struct contact *c, struct arena *a, const struct particles *solid,
                             struct arena *temp, struct diag *d)
{
    struct cloud of[2];
    struct link *link[2];
    int64_t n_links[2], n = 0;
    TRY(make_clouds(c, solid, of, temp, d));
    for (int k = 0; k < 2; k++) {
        /* A planar graph of n points has fewer than 3 n edges. */
        link[k] = arena_alloc(temp, 3 * (size_t)of[k].n + 1, sizeof *link[k], "contact", d);
        if (!link[k]) return ERR_MEMORY;
        for (int64_t i = 0; i < of[k].n; i++) of[k].point[i] = -1;
        TRY(find_links(&of[k], temp, link[k], &n_links[k], d));
        for (int64_t i = 0; i < of[k].n; i++) n += of[k].point[i] >= 0;
    }
    TRY(points_create(c, a, (size_t)n, d));
    c->edge = arena_alloc(a, (size_t)(n_links[0] + n_links[1] + n), sizeof *c->edge, "contact", d);
    c->wall_point = arena_alloc(a, (size_t)of[1].n, sizeof *c->wall_point, "contact", d);
    if (!c->edge || !c->wall_point) return ERR_MEMORY;
    /* Solids, walls that move, walls at rest. */
    number_points(c, &of[0], 0, c->n_solids);
    c->n_solid_points = c->n_points;
    number_points(c, &of[1], c->n_solids + 1, c->n_groups);
    c->n_moving_points = c->n_points;
    number_points(c, &of[1], c->n_solids, c->n_solids + 1);
    for (int k = 0; k < 2; k++) add_edges(c, &of[k], link[k], n_links[k]);
    set_shares(c);
    for (int64_t i = 0; i < of[1].n; i++) c->wall_point[i] = of[1].point[i];
    return find_held(c, a, solid, temp, d);
}

enum err contact_find_surface(struct contact *c, struct arena *a, const struct particles *solid,
                              struct diag *d)
{
    struct arena temp = {.limit = a->limit};
    const enum err e = find_surface(c, a, solid, &temp, d);
    arena_free(&temp);
    return e;
}
