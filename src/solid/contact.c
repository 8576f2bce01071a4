/* SPDX-License-Identifier: MIT */
#include "solid/contact.h"

#include "base/elementary.h"
#include "solid/contact_friction.h"
#include "solid/contact_law.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- forces of a pair --- */

/* f_n of T-62 for a point at `offset` from a place on an edge where it repels it with the reach
 * `reach`, with the relative velocity v. The dashpot may reduce the repulsion but not turn it
 * into attraction. */
static void point_force(const struct contact_constants *q, const double offset[2], double reach,
                        const double v[2], double f[2])
{
    f[0] = f[1] = 0;
    const double r = sqrt(offset[0] * offset[0] + offset[1] * offset[1]),
                 left = r - (reach - q->min_reach);
    if (!(left < q->min_reach) || left <= 0) return;
    const double n[2] = {offset[0] / r, offset[1] / r}, along = v[0] * n[0] + v[1] * n[1];
    const double normal = max2(0, elastic_force(q, left) - q->damping * along);
    f[0] = normal * n[0];
    f[1] = normal * n[1];
}

/* The same for an end of the edge. */
static void end_force(const struct contact *c, const struct contact_law *law,
                      const struct contact_constants *q, int32_t point, int32_t end, double f[2])
{
    const double offset[2] = {c->x[point] - c->x[end], c->y[point] - c->y[end]};
    const double v[2] = {c->vx[point] - c->vx[end], c->vy[point] - c->vy[end]};
    point_force(q, offset, contact_reach(c, law, point, end), v, f);
}

/* T-61a: an edge acts with its full force, less the fraction that its end points exert, which
 * the edges that meet there divide among them. The place on the edge is that of the largest
 * overlap (T-61b), so its change contributes nothing to the derivative of the potential. */
static bool pair_force(const struct contact *c, int32_t point, int32_t edge,
                       struct contact_force *out)
{
    const struct contact_law law = contact_pair_law(c, point, edge);
    if (!law.on) return false;
    const struct contact_foot foot = contact_foot(c, &law, point, edge);
    if (!(foot.distance < foot.reach)) return false;
    const struct contact_constants q = contact_constants_of(c, &law, point, edge, foot.min_reach);
    const int32_t a = c->edge[edge].a, b = c->edge[edge].b;
    const double s = foot.at, offset[2] = {foot.x, foot.y};
    double v[2], f[2], fa[2], fb[2];
    relative_velocity(c, point, edge, s, v);
    point_force(&q, offset, foot.reach, v, f);
    out->distance = foot.distance;
    end_force(c, &law, &q, point, a, fa);
    end_force(c, &law, &q, point, b, fb);
    for (int k = 0; k < 2; k++) {
        const double ga = c->share[a] * fa[k], gb = c->share[b] * fb[k];
        out->p[k] = f[k] - ga - gb;
        out->a[k] = ga - (1 - s) * f[k];
        out->b[k] = gb - s * f[k];
    }
    return true;
}

/* Of T-61 at a place of an edge where the reach is `reach`. */
static double place_energy(const struct contact *c, const struct contact_constants *q,
                           int32_t point, int32_t a, int32_t b, double s, double reach)
{
    const double offset[2] = {c->x[point] - ((1 - s) * c->x[a] + s * c->x[b]),
                              c->y[point] - ((1 - s) * c->y[a] + s * c->y[b])};
    const double r = elementary_hypot(offset[0], offset[1]), left = r - (reach - q->min_reach);
    return left < q->min_reach ? elastic_energy(q, left) : 0;
}

static double pair_energy(const struct contact *c, int32_t point, int32_t edge)
{
    const struct contact_law law = contact_pair_law(c, point, edge);
    if (!law.on) return 0;
    const struct contact_foot foot = contact_foot(c, &law, point, edge);
    if (!(foot.distance < foot.reach)) return 0;
    const struct contact_constants q = contact_constants_of(c, &law, point, edge, foot.min_reach);
    const int32_t a = c->edge[edge].a, b = c->edge[edge].b;
    const double at_a = contact_reach(c, &law, point, a), at_b = contact_reach(c, &law, point, b);
    return place_energy(c, &q, point, a, b, foot.at, foot.reach) -
           c->share[a] * place_energy(c, &q, point, a, a, 0, at_a) -
           c->share[b] * place_energy(c, &q, point, b, b, 0, at_b);
}

/* --- forces --- */

static void list_if_stale(struct contact *c)
{
    if (!c->stale) return;
#pragma omp barrier
#pragma omp single
    contact_list(c);
}

/* All threads together. */
static void find_forces(struct contact *c)
{
#pragma omp for schedule(static)
    for (int64_t k = 0; k < c->n_pairs; k++) {
        struct contact_force *const f = &c->force[k];
        f->touches = pair_force(c, c->pair_point[k], c->pair_edge[k], f);
    }
}

void contact_forces(struct contact *c, struct particles *p, double time)
{
    contact_place(c, p, time);
    list_if_stale(c);
    find_forces(c);
    /* By one thread, in the order of the list: the same sums on any number of threads. */
#pragma omp single
    {
        c->power = 0;
        for (int64_t k = 0; k < c->n_pairs; k++) {
            const struct contact_force *const f = &c->force[k];
            if (!f->touches) continue;
            const int32_t point = c->pair_point[k], a = c->edge[c->pair_edge[k]].a;
            c->touched |= c->body[a] < c->n_solids && c->body[point] != c->body[a];
            contact_add_force(c, p, point, f->p);
            contact_add_force(c, p, a, f->a);
            contact_add_force(c, p, c->edge[c->pair_edge[k]].b, f->b);
        }
        if (c->friction) contact_friction_forces(c, p);
    }
}

/* Number of spacings that two points may approach in excess of their present speeds times the
 * time. */
#define GAIN 0.25
/* Surfaces nearer than this many times their reach count in the step bound. */
#define NEAR 1.25
/* Skin of the list in spacings: pairs are listed again when points have moved by it. */
#define SKIN 1.0

double contact_energy(struct contact *c, const struct particles *p, double time)
{
    if (c->known && !c->near) return 0;
    contact_place(c, p, time);
    if (c->known) {
        list_if_stale(c);
    } else {
        for (int k = 0; k < CONTACT_WITH; k++) c->margin[k] = SKIN * c->spacing;
        contact_list(c);
        c->near = c->n_pairs > 0;
    }
    double sum = 0;
    for (int64_t k = 0; k < c->n_pairs; k++)
        sum += pair_energy(c, c->pair_point[k], c->pair_edge[k]);
    if (!c->friction) return sum;
    find_forces(c);
    return sum + contact_friction_energy(c, p);
}

/* --- before a step --- */

/* Mean displacement since the list was made, and mean velocity, of a group's points. */
struct contact_mean {
    double n, x, y, vx, vy;
};

static void find_means(struct contact *c)
{
    memset(c->mean, 0, (size_t)c->n_groups * sizeof *c->mean);
    for (int64_t k = 0; k < c->n_solid_points; k++) {
        struct contact_mean *const m = &c->mean[c->group[k]];
        m->n++;
        m->x += c->x[k] - c->at_x[k];
        m->y += c->y[k] - c->at_y[k];
        m->vx += c->vx[k];
        m->vy += c->vy[k];
    }
    for (int g = 0; g < c->n_groups; g++) {
        struct contact_mean *const m = &c->mean[g];
        const double per = m->n > 0 ? 1 / m->n : 0;
        *m = (struct contact_mean){m->n, per * m->x, per * m->y, per * m->vx, per * m->vy};
    }
}

/* Largest distance that two points may have approached since the list was made, and their speed. */
struct relative_motion {
    double moved[CONTACT_WITH], speed[CONTACT_WITH];
};

static struct relative_motion relative_motion_of(const struct contact *c)
{
    double far2[3] = {0}, speed2[3] = {0}; /* relative to their group; of solids; of walls */
    for (int64_t k = 0; k < c->n_solid_points; k++) {
        const struct contact_mean *const m = &c->mean[c->group[k]];
        const double x = c->x[k] - c->at_x[k], y = c->y[k] - c->at_y[k];
        far2[0] = max2(far2[0], square(x - m->x) + square(y - m->y));
        far2[1] = max2(far2[1], x * x + y * y);
        speed2[0] = max2(speed2[0], square(c->vx[k] - m->vx) + square(c->vy[k] - m->vy));
        speed2[1] = max2(speed2[1], square(c->vx[k]) + square(c->vy[k]));
    }
    for (int64_t k = c->n_solid_points; k < c->n_moving_points; k++) {
        far2[2] = max2(far2[2], square(c->x[k] - c->at_x[k]) + square(c->y[k] - c->at_y[k]));
        speed2[2] = max2(speed2[2], square(c->vx[k]) + square(c->vy[k]));
    }
    return (struct relative_motion){
        .moved = {2 * sqrt(far2[0]), sqrt(far2[1]) + sqrt(max2(far2[1], far2[2]))},
        .speed = {2 * sqrt(speed2[0]), sqrt(speed2[1]) + sqrt(max2(speed2[1], speed2[2]))},
    };
}

/* Fraction of the distance to a surface that a point may move in a step (T-62b). */
#define ADVANCE 0.25

static double moves_freely(const struct contact *c, const struct particles *p, int32_t point)
{
    return point < c->n_solid_points ? p->free[c->index[point]] : 0;
}

/* T-62a: a pair's part of the rows of M^-1 K by Gershgorin, at its position at the end of the
 * step. */
static void add_rows(struct contact *c, const struct particles *p, int64_t pair,
                     const struct contact_constants *q, const struct contact_foot *foot,
                     double left)
{
    const int32_t k = c->pair_point[pair];
    const struct contact_edge *const e = &c->edge[c->pair_edge[pair]];
    const double s = foot->at;
    const double own = s == 0 ? 1 - c->share[e->a] : s == 1 ? 1 - c->share[e->b] : 1;
    const double both =
        moves_freely(c, p, k) + (1 - s) * moves_freely(c, p, e->a) + s * moves_freely(c, p, e->b);
    const double stiffness = own * both * elastic_stiffness(q, left);
    const double damping = own * both * q->damping;
    contact_add_row(c, p, k, 1, stiffness, damping);
    contact_add_row(c, p, e->a, 1 - s, stiffness, damping);
    contact_add_row(c, p, e->b, s, stiffness, damping);
}

static void find_depth(struct contact *c, int32_t point, int32_t edge, double overlap)
{
    if (!(overlap > c->deepest.overlap)) return;
    c->deepest = (struct contact_depth){overlap, c->x[point], c->y[point], c->body[point],
                                        c->body[c->edge[edge].a]};
}

/* Distance beyond the reach within which a pair matters in the coming time `span`. */
static double distance_near(const struct contact *c, double speed, double span)
{
    return max2((NEAR - 1) * c->reach, GAIN * c->spacing) + 1.5 * span * speed;
}

/* An overlap in parts of that at which the law of a pair that begins apart is infinite. */
static double overlap_of(const struct contact *c, const struct contact_law *law, int32_t point,
                         int32_t edge, double overlap)
{
    const struct contact_edge *const e = &c->edge[edge];
    struct contact_law apart = *law;
    apart.initial = (double)INFINITY;
    const double gap = law->reach - law->spacing;
    const double min_reach =
        min2(contact_reach(c, &apart, point, e->a), contact_reach(c, &apart, point, e->b));
    return (overlap - gap) / (min_reach - gap);
}

static void watch_pair(struct contact *c, const struct particles *p, int64_t pair, double longest,
                       double span)
{
    c->force[pair].near = false;
    const int32_t point = c->pair_point[pair], edge = c->pair_edge[pair];
    const struct contact_law law = contact_pair_law(c, point, edge);
    const struct contact_foot foot = contact_foot(c, &law, point, edge);
    const double r = foot.distance, left = contact_clearance(&foot), min_reach = foot.min_reach;
    double v[2];
    relative_velocity(c, point, edge, foot.at, v);
    if (r > foot.reach + distance_near(c, sqrt(v[0] * v[0] + v[1] * v[1]), span)) return;
    c->near = true;
    find_depth(c, point, edge, overlap_of(c, &law, point, edge, min_reach - left));
    const double closing = r > 0 ? max2(0, -(v[0] * foot.x + v[1] * foot.y) / r) : 0;
    if (closing > 0)
        c->approach = min2(c->approach,
                           (max2(0, left - min_reach) + ADVANCE * min2(left, min_reach)) / closing);
    const double then = max2(left - closing * longest, (1 - ADVANCE) * min2(left, min_reach));
    if (then > NEAR * min_reach) return;
    c->force[pair].near = true;
    c->force[pair].distance = r;
    const struct contact_constants q = contact_constants_of(c, &law, point, edge, min_reach);
    add_rows(c, p, pair, &q, &foot, then);
}

/* Notes the depth of a point behind the nearest edge of another body if it has passed the
 * surface, from the pairs of this point. */
static void watch_side(struct contact *c, int64_t first, int64_t end)
{
    double nearest = (double)INFINITY;
    int32_t edge = 0;
    bool inside = false;
    const int32_t point = c->pair_point[first];
    for (int64_t k = first; k < end; k++) {
        if (contact_with(c, point, c->pair_edge[k]) == CONTACT_SELF) continue;
        const struct contact_foot f = contact_nearest(c, point, c->pair_edge[k]);
        if (!(f.distance < nearest)) continue;
        const struct contact_edge *const e = &c->edge[c->pair_edge[k]];
        const double side = (c->x[e->b] - c->x[e->a]) * f.y - (c->y[e->b] - c->y[e->a]) * f.x;
        nearest = f.distance;
        edge = c->pair_edge[k];
        inside = e->sided && f.at > 0 && f.at < 1 && side > 0;
    }
    if (inside && nearest > 0)
        find_depth(c, point, edge, 1 + nearest / contact_pair_law(c, point, edge).spacing);
}

static void watch_pairs(struct contact *c, const struct particles *p, double longest, double span)
{
    memset(c->row, 0, (size_t)c->n_solid_points * sizeof *c->row);
    memset(c->row_damping, 0, (size_t)c->n_solid_points * sizeof *c->row);
    if (c->friction) memset(c->wall_row, 0, (size_t)c->n_solid_points * sizeof *c->wall_row);
    if (c->friction) memset(c->wall_damping, 0, (size_t)c->n_solid_points * sizeof *c->wall_row);
    for (int64_t first = 0, end; first < c->n_pairs; first = end) {
        for (end = first; end < c->n_pairs && c->pair_point[end] == c->pair_point[first]; end++)
            watch_pair(c, p, end, longest, span);
        watch_side(c, first, end);
        if (c->friction) contact_friction_rows(c, p, first, end);
    }
    for (int64_t k = 0; k < c->n_solid_points; k++) {
        c->omega2 = max2(c->omega2, c->row[k] + (c->friction ? c->wall_row[k] : 0));
        c->damping = max2(c->damping, c->row_damping[k] + (c->friction ? c->wall_damping[k] : 0));
    }
}

bool contact_watch(struct contact *c, const struct particles *p, double time, double longest,
                   double span)
{
    contact_place(c, p, time);
    find_means(c);
    const struct relative_motion motion = relative_motion_of(c);
    double want[CONTACT_WITH];
    bool holds = c->known;
    for (int k = 0; k < CONTACT_WITH; k++) {
        want[k] = distance_near(c, motion.speed[k], span);
        holds = holds && c->margin[k] - motion.moved[k] >= want[k];
    }
    if (!holds) {
        for (int k = 0; k < CONTACT_WITH; k++) c->margin[k] = want[k] + SKIN * c->spacing;
        contact_list(c);
    }
    c->near = false;
    c->omega2 = c->damping = 0;
    c->approach = (double)INFINITY;
    c->deepest = (struct contact_depth){0};
    if (c->n_pairs) watch_pairs(c, p, longest, span);
    return c->near;
}

void contact_forget(struct contact *c, const struct particles *walls)
{
    /* Walls have been sorted; their numbers give the order of sampling. */
    int64_t first = INT64_MAX;
    for (int64_t i = 0; i < walls->n; i++)
        if (walls->id[i] < first) first = walls->id[i];
    for (int64_t i = 0; i < walls->n && c->n_walls; i++) {
        const int32_t k = c->wall_point[walls->id[i] - first];
        if (k < c->n_moving_points) continue;
        c->x[k] = walls->x[i];
        c->y[k] = walls->y[i];
    }
    c->known = false;
}

void contact_name(const struct contact *c, int body, char text[CONTACT_NAME])
{
    if (body < c->n_solids)
        snprintf(text, CONTACT_NAME, "[solid %s]", c->scene->solid[body].common.name);
    else
        snprintf(text, CONTACT_NAME, "[wall %s]", c->scene->wall[body - c->n_solids].common.name);
}

/* --- start --- */

/* Modulus of a layer between two surfaces that is as stiff as half a spacing of each body, in
 * series; a wall is rigid. Of two equal bodies each is compressed by half of the overlap. */
static double layer_modulus(const struct contact *c, int a, int b, double spacing)
{
    const struct solid_body *const one = &c->solid->body[a];
    double yields = one->dp / one->young;
    if (b < c->n_solids) yields += c->solid->body[b].dp / c->solid->body[b].young;
    return 2 * spacing / yields;
}

/* Stiffness of the same layer in shear, in parts of that in compression. */
static double layer_shear(const struct contact *c, int a, int b)
{
    const struct solid_body *const one = &c->solid->body[a], *const two = &c->solid->body[b];
    double yields = one->dp / one->young, shears = one->dp / one->mu;
    if (b < c->n_solids) {
        yields += two->dp / two->young;
        shears += two->dp / two->mu;
    }
    return yields / shears;
}

/* A pressure p leaves an overlap of spacing p/(stiffness E + p), E of the layer (T-61). */
static void set_law(struct contact *c, const struct scene_contact *from, int a, int b)
{
    const bool wall = b >= c->n_solids;
    const struct solid_body *const one = &c->solid->body[a];
    const double spacing = 0.5 * (one->dp + contact_dp(c, b));
    /* A body that folds: what begins near in it may be nearer than a layer of fluid. */
    const bool own = !wall && one->bond == c->solid->body[b].bond;
    const double reach = spacing + (own ? from->gap : scene_contact_gap(c->scene, from));
    const int n = c->n_solids + c->n_walls;
    c->law[a * n + b] = c->law[b * n + a] = (struct contact_law){
        .on = true,
        .spacing = spacing,
        .reach = reach,
        .stiffness = from->stiffness * layer_modulus(c, a, b, spacing),
        .shear = layer_shear(c, a, b),
        .damping = from->damping,
        .friction = from->friction,
    };
    c->reach = max2(c->reach, reach);
    c->spacing = max2(c->spacing, spacing);
}

static void set_laws(struct contact *c)
{
    for (int a = 0; a < c->n_solids; a++)
        for (int b = a; b < c->n_solids + c->n_walls; b++) {
            const struct scene_contact *const from = scene_contact_of(c->scene, a, b);
            if (from) set_law(c, from, a, b);
        }
}

/* Lists the pairs that begin within their reach of another group. */
static void list_initial_pairs(struct contact *c)
{
    c->margin[CONTACT_SELF] = -c->reach;
    c->margin[CONTACT_OTHER] = 0;
    for (int64_t k = 0; k < c->n_points; k++) c->initial_group[k] = -1;
    contact_list(c);
}

/* Whether a pair of the list begins within its reach; its distance. */
static bool begins_near(const struct contact *c, int64_t pair, double *distance)
{
    const int32_t point = c->pair_point[pair], edge = c->pair_edge[pair];
    const struct contact_law law = contact_pair_law(c, point, edge);
    const struct contact_foot foot = contact_foot(c, &law, point, edge);
    *distance = contact_nearest(c, point, edge).distance;
    return foot.distance < foot.reach;
}

/* Bodies that begin with less than a layer of fluid between them anywhere need not keep one. */
static void drop_layers(struct contact *c)
{
    const int n = c->n_solids + c->n_walls;
    double r;
    list_initial_pairs(c);
    for (int64_t k = 0; k < c->n_pairs; k++) {
        const int a = c->body[c->pair_point[k]], b = c->body[c->edge[c->pair_edge[k]].a];
        const struct scene_contact *const from = scene_contact_of(c->scene, a, b);
        struct contact_law *const law = &c->law[a * n + b];
        if (begins_near(c, k, &r)) law->reach = c->law[b * n + a].reach = law->spacing + from->gap;
    }
}

/* Stores initial distances from other groups that are below the reach. Bodies on lattices that do
 * not fit, and particles clamped within a wall, start without repulsion and keep that distance. */
static void set_initial_distances(struct contact *c)
{
    list_initial_pairs(c);
    for (int64_t k = 0; k < c->n_pairs; k++) {
        const int32_t point = c->pair_point[k], group = c->group[c->edge[c->pair_edge[k]].a];
        double r;
        if (!begins_near(c, k, &r)) continue;
        if (c->initial_group[point] >= 0 && r >= c->initial[point]) continue;
        c->initial[point] = r;
        c->initial_group[point] = group;
    }
    c->margin[CONTACT_SELF] = c->margin[CONTACT_OTHER] = 0;
    c->known = false;
    c->n_pairs = 0;
    c->stale = 1;
}

static enum err create_list(struct contact *c, struct arena *a, struct diag *d)
{
    const size_t n = (size_t)c->n_solid_points, edges = (size_t)c->n_edges;
    const size_t groups = (size_t)c->n_groups, walls = (size_t)c->n_walls;
    c->row = arena_alloc(a, n, sizeof *c->row, "contact", d);
    c->row_damping = arena_alloc(a, n, sizeof *c->row, "contact", d);
    c->middle_x = arena_alloc(a, edges, sizeof *c->middle_x, "contact", d);
    c->middle_y = arena_alloc(a, edges, sizeof *c->middle_y, "contact", d);
    c->skip = arena_alloc(a, edges, sizeof *c->skip, "contact", d);
    c->mean = arena_alloc(a, groups, sizeof *c->mean, "contact", d);
    c->motion = arena_alloc(a, walls, sizeof *c->motion, "contact", d);
    if (!c->row || !c->row_damping || !c->middle_x || !c->middle_y || !c->skip || !c->mean ||
        !c->motion)
        return ERR_MEMORY;
    TRY(contact_list_resize(c, 4 * c->n_solid_points + 64, d));
    return point_grid_create(&c->grid, c->reach, c->n_edges, c->middle_x, c->middle_y, a, d);
}

static bool meets_walls(const struct scene *s)
{
    for (int a = 0; a < s->n_solid; a++)
        for (int b = 0; b < s->n_wall; b++)
            if (scene_contact_of(s, a, s->n_solid + b)) return true;
    return false;
}

enum err contact_create(struct contact *c, struct arena *a, const struct scene *scene,
                        const struct solid *s, const struct particles *solid, struct diag *d)
{
    *c = (struct contact){.scene = scene, .arena = a, .solid = s, .n_solids = scene->n_solid};
    c->friction = solid->stick_edge;
    c->n_walls = meets_walls(scene) ? scene->n_wall : 0;
    c->n_groups = scene->n_solid + scene->n_motion + 1;
    const size_t n = (size_t)(c->n_solids + c->n_walls);
    c->law = arena_alloc(a, n * n, sizeof *c->law, "contact", d);
    if (!c->law) return ERR_MEMORY;
    set_laws(c);
    TRY(contact_surface_create(c, a, solid, d));
    c->reach += 2 * c->max_outer;
    TRY(create_list(c, a, d));
    drop_layers(c);
    set_initial_distances(c);
    return c->friction ? contact_friction_create(c, a, d) : ERR_OK;
}
