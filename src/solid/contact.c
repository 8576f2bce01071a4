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
static void end_force(const struct contact *contact, const struct contact_law *law,
                      const struct contact_constants *q, int32_t point, int32_t end, double f[2])
{
    const double offset[2] = {contact->x[point] - contact->x[end],
                              contact->y[point] - contact->y[end]};
    const double v[2] = {contact->vx[point] - contact->vx[end],
                         contact->vy[point] - contact->vy[end]};
    point_force(q, offset, contact_reach(contact, law, point, end), v, f);
}

/* T-61a: an edge acts with its full force, less the fraction that its end points exert, which
 * the edges that meet there divide among them. The place on the edge is that of the largest
 * overlap (T-61b), so its change contributes nothing to the derivative of the potential. */
static bool pair_force(const struct contact *contact, int32_t point, int32_t edge,
                       struct contact_force *out)
{
    const struct contact_law law = contact_pair_law(contact, point, edge);
    if (!law.on) return false;
    const struct contact_foot foot = contact_foot(contact, &law, point, edge);
    if (!(foot.distance < foot.reach)) return false;
    const struct contact_constants q =
        contact_constants_of(contact, &law, point, edge, foot.min_reach);
    const int32_t a = contact->edge[edge].a, b = contact->edge[edge].b;
    const double s = foot.at, offset[2] = {foot.x, foot.y};
    double v[2], f[2], fa[2], fb[2];
    relative_velocity(contact, point, edge, s, v);
    point_force(&q, offset, foot.reach, v, f);
    out->distance = foot.distance;
    end_force(contact, &law, &q, point, a, fa);
    end_force(contact, &law, &q, point, b, fb);
    for (int k = 0; k < 2; k++) {
        const double ga = contact->share[a] * fa[k], gb = contact->share[b] * fb[k];
        out->p[k] = f[k] - ga - gb;
        out->a[k] = ga - (1 - s) * f[k];
        out->b[k] = gb - s * f[k];
    }
    return true;
}

/* Of T-61 at a place of an edge where the reach is `reach`. */
static double place_energy(const struct contact *contact, const struct contact_constants *q,
                           int32_t point, int32_t a, int32_t b, double s, double reach)
{
    const double offset[2] = {contact->x[point] - ((1 - s) * contact->x[a] + s * contact->x[b]),
                              contact->y[point] - ((1 - s) * contact->y[a] + s * contact->y[b])};
    const double r = elementary_hypot(offset[0], offset[1]), left = r - (reach - q->min_reach);
    return left < q->min_reach ? elastic_energy(q, left) : 0;
}

static double pair_energy(const struct contact *contact, int32_t point, int32_t edge)
{
    const struct contact_law law = contact_pair_law(contact, point, edge);
    if (!law.on) return 0;
    const struct contact_foot foot = contact_foot(contact, &law, point, edge);
    if (!(foot.distance < foot.reach)) return 0;
    const struct contact_constants q =
        contact_constants_of(contact, &law, point, edge, foot.min_reach);
    const int32_t a = contact->edge[edge].a, b = contact->edge[edge].b;
    const double at_a = contact_reach(contact, &law, point, a),
                 at_b = contact_reach(contact, &law, point, b);
    return place_energy(contact, &q, point, a, b, foot.at, foot.reach) -
           contact->share[a] * place_energy(contact, &q, point, a, a, 0, at_a) -
           contact->share[b] * place_energy(contact, &q, point, b, b, 0, at_b);
}

/* --- forces --- */

static void list_if_stale(struct contact *contact)
{
    if (!contact->stale) return;
#pragma omp barrier
#pragma omp single
    contact_list(contact);
}

/* All threads together. */
static void find_forces(struct contact *contact)
{
#pragma omp for schedule(static)
    for (int64_t k = 0; k < contact->n_pairs; k++) {
        struct contact_force *const f = &contact->force[k];
        f->touches = pair_force(contact, contact->pair_point[k], contact->pair_edge[k], f);
    }
}

void contact_forces(struct contact *contact, struct particles *particles, double time)
{
    contact_place(contact, particles, time);
    list_if_stale(contact);
    find_forces(contact);
    /* By one thread, in the order of the list: the same sums on any number of threads. */
#pragma omp single
    {
        contact->power = 0;
        for (int64_t k = 0; k < contact->n_pairs; k++) {
            const struct contact_force *const f = &contact->force[k];
            if (!f->touches) continue;
            const int32_t point = contact->pair_point[k],
                          a = contact->edge[contact->pair_edge[k]].a;
            contact->touched |=
                contact->body[a] < contact->n_solids && contact->body[point] != contact->body[a];
            contact_add_force(contact, particles, point, f->p);
            contact_add_force(contact, particles, a, f->a);
            contact_add_force(contact, particles, contact->edge[contact->pair_edge[k]].b, f->b);
        }
        if (contact->friction) contact_friction_forces(contact, particles);
    }
}

/* Number of spacings that two points may approach in excess of their present speeds times the
 * time. */
#define GAIN 0.25
/* Surfaces nearer than this many times their reach count in the step bound. */
#define NEAR 1.25
/* Skin of the list in spacings: pairs are listed again when points have moved by it. */
#define SKIN 1.0

double contact_energy(struct contact *contact, const struct particles *particles, double time)
{
    if (contact->known && !contact->near) return 0;
    contact_place(contact, particles, time);
    if (contact->known) {
        list_if_stale(contact);
    } else {
        for (int k = 0; k < CONTACT_WITH; k++) contact->margin[k] = SKIN * contact->spacing;
        contact_list(contact);
        contact->near = contact->n_pairs > 0;
    }
    double sum = 0;
    for (int64_t k = 0; k < contact->n_pairs; k++)
        sum += pair_energy(contact, contact->pair_point[k], contact->pair_edge[k]);
    if (!contact->friction) return sum;
    find_forces(contact);
    return sum + contact_friction_energy(contact, particles);
}

/* --- before a step --- */

/* Mean displacement since the list was made, and mean velocity, of a group's points. */
struct contact_mean {
    double n, x, y, vx, vy;
};

static void find_means(struct contact *contact)
{
    memset(contact->mean, 0, (size_t)contact->n_groups * sizeof *contact->mean);
    for (int64_t k = 0; k < contact->n_solid_points; k++) {
        struct contact_mean *const m = &contact->mean[contact->group[k]];
        m->n++;
        m->x += contact->x[k] - contact->at_x[k];
        m->y += contact->y[k] - contact->at_y[k];
        m->vx += contact->vx[k];
        m->vy += contact->vy[k];
    }
    for (int g = 0; g < contact->n_groups; g++) {
        struct contact_mean *const m = &contact->mean[g];
        const double per = m->n > 0 ? 1 / m->n : 0;
        *m = (struct contact_mean){m->n, per * m->x, per * m->y, per * m->vx, per * m->vy};
    }
}

/* Largest distance that two points may have approached since the list was made, and their speed. */
struct relative_motion {
    double moved[CONTACT_WITH], speed[CONTACT_WITH];
};

static struct relative_motion relative_motion_of(const struct contact *contact)
{
    double far2[3] = {0}, speed2[3] = {0}; /* relative to their group; of solids; of walls */
    for (int64_t k = 0; k < contact->n_solid_points; k++) {
        const struct contact_mean *const m = &contact->mean[contact->group[k]];
        const double x = contact->x[k] - contact->at_x[k], y = contact->y[k] - contact->at_y[k];
        far2[0] = max2(far2[0], square(x - m->x) + square(y - m->y));
        far2[1] = max2(far2[1], x * x + y * y);
        speed2[0] =
            max2(speed2[0], square(contact->vx[k] - m->vx) + square(contact->vy[k] - m->vy));
        speed2[1] = max2(speed2[1], square(contact->vx[k]) + square(contact->vy[k]));
    }
    for (int64_t k = contact->n_solid_points; k < contact->n_moving_points; k++) {
        far2[2] = max2(far2[2], square(contact->x[k] - contact->at_x[k]) +
                                    square(contact->y[k] - contact->at_y[k]));
        speed2[2] = max2(speed2[2], square(contact->vx[k]) + square(contact->vy[k]));
    }
    return (struct relative_motion){
        .moved = {2 * sqrt(far2[0]), sqrt(far2[1]) + sqrt(max2(far2[1], far2[2]))},
        .speed = {2 * sqrt(speed2[0]), sqrt(speed2[1]) + sqrt(max2(speed2[1], speed2[2]))},
    };
}

/* Fraction of the distance to a surface that a point may move in a step (T-62b). */
#define ADVANCE 0.25

static double moves_freely(const struct contact *contact, const struct particles *particles,
                           int32_t point)
{
    return point < contact->n_solid_points ? particles->free[contact->index[point]] : 0;
}

/* T-62a: a pair's part of the rows of M^-1 K by Gershgorin, at its position at the end of the
 * step. */
static void add_rows(struct contact *contact, const struct particles *particles, int64_t pair,
                     const struct contact_constants *q, const struct contact_foot *foot,
                     double left)
{
    const int32_t k = contact->pair_point[pair];
    const struct contact_edge *const e = &contact->edge[contact->pair_edge[pair]];
    const double s = foot->at;
    const double own = s == 0 ? 1 - contact->share[e->a] : s == 1 ? 1 - contact->share[e->b] : 1;
    const double both = moves_freely(contact, particles, k) +
                        (1 - s) * moves_freely(contact, particles, e->a) +
                        s * moves_freely(contact, particles, e->b);
    const double stiffness = own * both * elastic_stiffness(q, left);
    const double damping = own * both * q->damping;
    contact_add_row(contact, particles, k, 1, stiffness, damping);
    contact_add_row(contact, particles, e->a, 1 - s, stiffness, damping);
    contact_add_row(contact, particles, e->b, s, stiffness, damping);
}

static void find_depth(struct contact *contact, int32_t point, int32_t edge, double overlap)
{
    if (!(overlap > contact->deepest.overlap)) return;
    contact->deepest =
        (struct contact_depth){overlap, contact->x[point], contact->y[point], contact->body[point],
                               contact->body[contact->edge[edge].a]};
}

/* Distance beyond the reach within which a pair matters in the coming time `span`. */
static double distance_near(const struct contact *contact, double speed, double span)
{
    return max2((NEAR - 1) * contact->reach, GAIN * contact->spacing) + 1.5 * span * speed;
}

/* An overlap in parts of that at which the law of a pair that begins apart is infinite. */
static double overlap_of(const struct contact *contact, const struct contact_law *law,
                         int32_t point, int32_t edge, double overlap)
{
    const struct contact_edge *const e = &contact->edge[edge];
    struct contact_law apart = *law;
    apart.initial = (double)INFINITY;
    const double gap = law->reach - law->spacing;
    const double min_reach = min2(contact_reach(contact, &apart, point, e->a),
                                  contact_reach(contact, &apart, point, e->b));
    return (overlap - gap) / (min_reach - gap);
}

static void watch_pair(struct contact *contact, const struct particles *particles, int64_t pair,
                       double longest, double span)
{
    contact->force[pair].near = false;
    const int32_t point = contact->pair_point[pair], edge = contact->pair_edge[pair];
    const struct contact_law law = contact_pair_law(contact, point, edge);
    const struct contact_foot foot = contact_foot(contact, &law, point, edge);
    const double r = foot.distance, left = contact_clearance(&foot), min_reach = foot.min_reach;
    double v[2];
    relative_velocity(contact, point, edge, foot.at, v);
    if (r > foot.reach + distance_near(contact, sqrt(v[0] * v[0] + v[1] * v[1]), span)) return;
    contact->near = true;
    find_depth(contact, point, edge, overlap_of(contact, &law, point, edge, min_reach - left));
    const double closing = r > 0 ? max2(0, -(v[0] * foot.x + v[1] * foot.y) / r) : 0;
    if (closing > 0)
        contact->approach =
            min2(contact->approach,
                 (max2(0, left - min_reach) + ADVANCE * min2(left, min_reach)) / closing);
    const double then = max2(left - closing * longest, (1 - ADVANCE) * min2(left, min_reach));
    if (then > NEAR * min_reach) return;
    contact->force[pair].near = true;
    contact->force[pair].distance = r;
    const struct contact_constants q = contact_constants_of(contact, &law, point, edge, min_reach);
    add_rows(contact, particles, pair, &q, &foot, then);
}

/* Notes the depth of a point behind the nearest edge of another body if it has passed the
 * surface, from the pairs of this point. */
static void watch_side(struct contact *contact, int64_t first, int64_t end)
{
    double nearest = (double)INFINITY;
    int32_t edge = 0;
    bool inside = false;
    const int32_t point = contact->pair_point[first];
    for (int64_t k = first; k < end; k++) {
        if (contact_with(contact, point, contact->pair_edge[k]) == CONTACT_SELF) continue;
        const struct contact_foot f = contact_nearest(contact, point, contact->pair_edge[k]);
        if (!(f.distance < nearest)) continue;
        const struct contact_edge *const e = &contact->edge[contact->pair_edge[k]];
        const double side = (contact->x[e->b] - contact->x[e->a]) * f.y -
                            (contact->y[e->b] - contact->y[e->a]) * f.x;
        nearest = f.distance;
        edge = contact->pair_edge[k];
        inside = e->sided && f.at > 0 && f.at < 1 && side > 0;
    }
    if (inside && nearest > 0)
        find_depth(contact, point, edge,
                   1 + nearest / contact_pair_law(contact, point, edge).spacing);
}

static void watch_pairs(struct contact *contact, const struct particles *particles, double longest,
                        double span)
{
    memset(contact->row, 0, (size_t)contact->n_solid_points * sizeof *contact->row);
    memset(contact->row_damping, 0, (size_t)contact->n_solid_points * sizeof *contact->row);
    if (contact->friction)
        memset(contact->wall_row, 0, (size_t)contact->n_solid_points * sizeof *contact->wall_row);
    if (contact->friction)
        memset(contact->wall_damping, 0,
               (size_t)contact->n_solid_points * sizeof *contact->wall_row);
    for (int64_t first = 0, end; first < contact->n_pairs; first = end) {
        for (end = first;
             end < contact->n_pairs && contact->pair_point[end] == contact->pair_point[first];
             end++)
            watch_pair(contact, particles, end, longest, span);
        watch_side(contact, first, end);
        if (contact->friction) contact_friction_rows(contact, particles, first, end);
    }
    for (int64_t k = 0; k < contact->n_solid_points; k++) {
        contact->omega2 =
            max2(contact->omega2, contact->row[k] + (contact->friction ? contact->wall_row[k] : 0));
        contact->damping =
            max2(contact->damping,
                 contact->row_damping[k] + (contact->friction ? contact->wall_damping[k] : 0));
    }
}

bool contact_watch(struct contact *contact, const struct particles *particles, double time,
                   double longest, double span)
{
    contact_place(contact, particles, time);
    find_means(contact);
    const struct relative_motion motion = relative_motion_of(contact);
    double want[CONTACT_WITH];
    bool holds = contact->known;
    for (int k = 0; k < CONTACT_WITH; k++) {
        want[k] = distance_near(contact, motion.speed[k], span);
        holds = holds && contact->margin[k] - motion.moved[k] >= want[k];
    }
    if (!holds) {
        for (int k = 0; k < CONTACT_WITH; k++)
            contact->margin[k] = want[k] + SKIN * contact->spacing;
        contact_list(contact);
    }
    contact->near = false;
    contact->omega2 = contact->damping = 0;
    contact->approach = (double)INFINITY;
    contact->deepest = (struct contact_depth){0};
    if (contact->n_pairs) watch_pairs(contact, particles, longest, span);
    return contact->near;
}

void contact_forget(struct contact *contact, const struct particles *walls)
{
    /* Walls have been sorted; their numbers give the order of sampling. */
    int64_t first = INT64_MAX;
    for (int64_t i = 0; i < walls->n; i++)
        if (walls->id[i] < first) first = walls->id[i];
    for (int64_t i = 0; i < walls->n && contact->n_walls; i++) {
        const int32_t k = contact->wall_point[walls->id[i] - first];
        if (k < contact->n_moving_points) continue;
        contact->x[k] = walls->x[i];
        contact->y[k] = walls->y[i];
    }
    contact->known = false;
}

void contact_name(const struct contact *contact, int body, char text[CONTACT_NAME])
{
    if (body < contact->n_solids)
        snprintf(text, CONTACT_NAME, "[solid %s]", contact->scene->solid[body].common.name);
    else
        snprintf(text, CONTACT_NAME, "[wall %s]",
                 contact->scene->wall[body - contact->n_solids].common.name);
}

/* --- start --- */

/* Modulus of a layer between two surfaces that is as stiff as half a spacing of each body, in
 * series; a wall is rigid. Of two equal bodies each is compressed by half of the overlap. */
static double layer_modulus(const struct contact *contact, int a, int b, double spacing)
{
    const struct solid_body *const one = &contact->solid->body[a];
    double yields = one->dp / one->young;
    if (b < contact->n_solids) yields += contact->solid->body[b].dp / contact->solid->body[b].young;
    return 2 * spacing / yields;
}

/* Stiffness of the same layer in shear, in parts of that in compression. */
static double layer_shear(const struct contact *contact, int a, int b)
{
    const struct solid_body *const one = &contact->solid->body[a], *const two =
                                                                       &contact->solid->body[b];
    double yields = one->dp / one->young, shears = one->dp / one->mu;
    if (b < contact->n_solids) {
        yields += two->dp / two->young;
        shears += two->dp / two->mu;
    }
    return yields / shears;
}

/* A pressure p leaves an overlap of spacing p/(stiffness E + p), E of the layer (T-61). */
static void set_law(struct contact *contact, const struct scene_contact *from, int a, int b)
{
    const bool wall = b >= contact->n_solids;
    const struct solid_body *const one = &contact->solid->body[a];
    const double spacing = 0.5 * (one->dp + contact_dp(contact, b));
    /* A body that folds: what begins near in it may be nearer than a layer of fluid. */
    const bool own = !wall && one->bond == contact->solid->body[b].bond;
    const double reach = spacing + (own ? from->gap : scene_contact_gap(contact->scene, from));
    const int n = contact->n_solids + contact->n_walls;
    contact->law[a * n + b] = contact->law[b * n + a] = (struct contact_law){
        .on = true,
        .spacing = spacing,
        .reach = reach,
        .stiffness = from->stiffness * layer_modulus(contact, a, b, spacing),
        .shear = layer_shear(contact, a, b),
        .damping = from->damping,
        .friction = from->friction,
    };
    contact->reach = max2(contact->reach, reach);
    contact->spacing = max2(contact->spacing, spacing);
}

static void set_laws(struct contact *contact)
{
    for (int a = 0; a < contact->n_solids; a++)
        for (int b = a; b < contact->n_solids + contact->n_walls; b++) {
            const struct scene_contact *const from = scene_contact_of(contact->scene, a, b);
            if (from) set_law(contact, from, a, b);
        }
}

/* Lists the pairs that begin within their reach of another group. */
static void list_initial_pairs(struct contact *contact)
{
    contact->margin[CONTACT_SELF] = -contact->reach;
    contact->margin[CONTACT_OTHER] = 0;
    for (int64_t k = 0; k < contact->n_points; k++) contact->initial_group[k] = -1;
    contact_list(contact);
}

/* Whether a pair of the list begins within its reach; its distance. */
static bool begins_near(const struct contact *contact, int64_t pair, double *distance)
{
    const int32_t point = contact->pair_point[pair], edge = contact->pair_edge[pair];
    const struct contact_law law = contact_pair_law(contact, point, edge);
    const struct contact_foot foot = contact_foot(contact, &law, point, edge);
    *distance = contact_nearest(contact, point, edge).distance;
    return foot.distance < foot.reach;
}

/* Bodies that begin with less than a layer of fluid between them anywhere need not keep one. */
static void drop_layers(struct contact *contact)
{
    const int n = contact->n_solids + contact->n_walls;
    double r;
    list_initial_pairs(contact);
    for (int64_t k = 0; k < contact->n_pairs; k++) {
        const int a = contact->body[contact->pair_point[k]],
                  b = contact->body[contact->edge[contact->pair_edge[k]].a];
        const struct scene_contact *const from = scene_contact_of(contact->scene, a, b);
        struct contact_law *const law = &contact->law[a * n + b];
        if (begins_near(contact, k, &r))
            law->reach = contact->law[b * n + a].reach = law->spacing + from->gap;
    }
}

/* Stores initial distances from other groups that are below the reach. Bodies on lattices that do
 * not fit, and particles clamped within a wall, start without repulsion and keep that distance. */
static void set_initial_distances(struct contact *contact)
{
    list_initial_pairs(contact);
    for (int64_t k = 0; k < contact->n_pairs; k++) {
        const int32_t point = contact->pair_point[k],
                      group = contact->group[contact->edge[contact->pair_edge[k]].a];
        double r;
        if (!begins_near(contact, k, &r)) continue;
        if (contact->initial_group[point] >= 0 && r >= contact->initial[point]) continue;
        contact->initial[point] = r;
        contact->initial_group[point] = group;
    }
    contact->margin[CONTACT_SELF] = contact->margin[CONTACT_OTHER] = 0;
    contact->known = false;
    contact->n_pairs = 0;
    contact->stale = 1;
}

static enum err create_list(struct contact *contact, struct arena *a, struct diag *d)
{
    const size_t n = (size_t)contact->n_solid_points, edges = (size_t)contact->n_edges;
    const size_t groups = (size_t)contact->n_groups, walls = (size_t)contact->n_walls;
    contact->row = arena_alloc(a, n, sizeof *contact->row, "contact", d);
    contact->row_damping = arena_alloc(a, n, sizeof *contact->row, "contact", d);
    contact->middle_x = arena_alloc(a, edges, sizeof *contact->middle_x, "contact", d);
    contact->middle_y = arena_alloc(a, edges, sizeof *contact->middle_y, "contact", d);
    contact->skip = arena_alloc(a, edges, sizeof *contact->skip, "contact", d);
    contact->mean = arena_alloc(a, groups, sizeof *contact->mean, "contact", d);
    contact->motion = arena_alloc(a, walls, sizeof *contact->motion, "contact", d);
    if (!contact->row || !contact->row_damping || !contact->middle_x || !contact->middle_y ||
        !contact->skip || !contact->mean || !contact->motion)
        return ERR_MEMORY;
    TRY(contact_list_resize(contact, 4 * contact->n_solid_points + 64, d));
    return point_grid_create(&contact->grid, contact->reach, contact->n_edges, contact->middle_x,
                             contact->middle_y, a, d);
}

static bool meets_walls(const struct scene *scene)
{
    for (int a = 0; a < scene->n_solid; a++)
        for (int b = 0; b < scene->n_wall; b++)
            if (scene_contact_of(scene, a, scene->n_solid + b)) return true;
    return false;
}

enum err contact_create(struct contact *contact, struct arena *a, const struct scene *scene,
                        const struct solid *solid, const struct particles *particles,
                        struct diag *d)
{
    *contact =
        (struct contact){.scene = scene, .arena = a, .solid = solid, .n_solids = scene->n_solid};
    contact->friction = particles->stick_edge;
    contact->n_walls = meets_walls(scene) ? scene->n_wall : 0;
    contact->n_groups = scene->n_solid + scene->n_motion + 1;
    const size_t n = (size_t)(contact->n_solids + contact->n_walls);
    contact->law = arena_alloc(a, n * n, sizeof *contact->law, "contact", d);
    if (!contact->law) return ERR_MEMORY;
    set_laws(contact);
    TRY(contact_surface_create(contact, a, particles, d));
    contact->reach += 2 * contact->max_outer;
    TRY(create_list(contact, a, d));
    drop_layers(contact);
    set_initial_distances(contact);
    return contact->friction ? contact_friction_create(contact, a, d) : ERR_OK;
}
