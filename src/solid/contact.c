/* SPDX-License-Identifier: MIT
 * The force of contact, its energy, and the bounds of the step that follow from it. */
#include "solid/contact.h"

/* --- potential of a pair --- */

/* T-61: k R^2 (r/R - 1 - ln(r/R)), infinite at the least reach R; r = R less the overlap. */
static double elastic_energy(double stiffness, double min_reach, double r)
{
    if (!(r < min_reach)) return 0;
    const double s = r / min_reach;
    return stiffness * square(min_reach) * (s - 1 - elementary_log(s));
}

/* The derivative of the energy, k R (R/r - 1), and its second derivative, k (R/r)^2. */
static double elastic_force(double stiffness, double min_reach, double r)
{
    return stiffness * min_reach * (min_reach / r - 1);
}
static double elastic_stiffness(double stiffness, double min_reach, double r)
{
    return stiffness * square(min_reach / min2(r, min_reach));
}

/* Velocity of a point relative to a place on an edge. */
static void relative_velocity(const struct contact_closest *closest, double v[2])
{
    for (int c = 0; c < 2; c++)
        v[c] = closest->point->v[c] -
               ((1 - closest->at) * closest->a->v[c] + closest->at * closest->b->v[c]);
}

/* --- forces of a pair --- */

/* f_n of T-62 for a point at `offset` from a place on an edge where it repels it with the reach
 * `reach`, with the relative velocity v. The dashpot does not make it attract. */
static void point_force(const struct contact_constants *q, const struct contact_closest *closest,
                        const double offset[2], double reach, const double v[2], double f[2])
{
    f[0] = f[1] = 0;
    const double r = sqrt(offset[0] * offset[0] + offset[1] * offset[1]),
                 left = r - (reach - closest->min_reach);
    if (!(left < closest->min_reach) || left <= 0) return;
    const double n[2] = {offset[0] / r, offset[1] / r}, along = v[0] * n[0] + v[1] * n[1];
    const double normal =
        max2(0, elastic_force(q->stiffness, closest->min_reach, left) - q->damping * along);
    f[0] = normal * n[0];
    f[1] = normal * n[1];
}

/* The force of an end of the edge. */
static void end_force(const struct contact_constants *q, const struct contact_closest *closest,
                      const struct contact_point *end, double reach, double f[2])
{
    const struct contact_point *const p = closest->point;
    const double offset[2] = {p->x[0] - end->x[0], p->x[1] - end->x[1]};
    const double v[2] = {p->v[0] - end->v[0], p->v[1] - end->v[1]};
    point_force(q, closest, offset, reach, v, f);
}

/* Whether the point of a pair is within reach of the edge. */
static bool touches(const struct contact *contact, const struct contact_pair *pair,
                    struct contact_closest *closest, struct contact_constants *q)
{
    if (!contact_find_closest(contact, pair->point, pair->edge, closest) ||
        !(closest->distance < closest->reach))
        return false;
    *q = contact_constants_of(closest->law, closest->point);
    return true;
}

/* T-61a: an edge acts with its full force, less the fraction that its end points exert, which
 * the edges that meet there divide among them. The place on the edge is that of the largest
 * overlap (T-61b), so its change contributes nothing to the derivative of the potential. */
static void pair_force(const struct contact *contact, struct contact_pair *pair)
{
    struct contact_closest closest;
    struct contact_constants q;
    double v[2], f[2], fa[2], fb[2];
    pair->touches = touches(contact, pair, &closest, &q);
    if (!pair->touches) return;
    relative_velocity(&closest, v);
    point_force(&q, &closest, closest.offset, closest.reach, v, f);
    end_force(&q, &closest, closest.a, closest.reach_a, fa);
    end_force(&q, &closest, closest.b, closest.reach_b, fb);
    pair->distance = closest.distance;
    for (int c = 0; c < 2; c++) {
        const double ga = closest.a->share * fa[c], gb = closest.b->share * fb[c];
        pair->force[0][c] = f[c] - ga - gb;
        pair->force[1][c] = ga - (1 - closest.at) * f[c];
        pair->force[2][c] = gb - closest.at * f[c];
    }
}

/* Energy of T-61 at the place s of an edge from a to b where the reach is `reach`. */
static double place_energy(const struct contact_constants *q, const struct contact_closest *closest,
                           const struct contact_point *a, const struct contact_point *b, double s,
                           double reach)
{
    const double *const x = closest->point->x;
    const double r = elementary_hypot(x[0] - ((1 - s) * a->x[0] + s * b->x[0]),
                                      x[1] - ((1 - s) * a->x[1] + s * b->x[1]));
    return elastic_energy(q->stiffness, closest->min_reach, r - (reach - closest->min_reach));
}

static double pair_energy(const struct contact *contact, const struct contact_pair *pair)
{
    struct contact_closest closest;
    struct contact_constants q;
    if (!touches(contact, pair, &closest, &q)) return 0;
    return place_energy(&q, &closest, closest.a, closest.b, closest.at, closest.reach) -
           closest.a->share * place_energy(&q, &closest, closest.a, closest.a, 0, closest.reach_a) -
           closest.b->share * place_energy(&q, &closest, closest.b, closest.b, 0, closest.reach_b);
}

/* --- forces --- */

static void list_if_stale(struct contact *contact)
{
    if (!contact->stale) return;
#pragma omp barrier
#pragma omp single
    contact_list(contact, contact->margin);
}

/* All threads together. */
static void find_forces(struct contact *contact)
{
#pragma omp for schedule(static)
    for (int64_t k = 0; k < contact->n_pairs; k++) pair_force(contact, &contact->pair[k]);
}

static bool moves_by_itself(const struct contact *contact, int body)
{
    return body < contact->n_solids || contact_rigid_of(contact, body) >= 0;
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
        if (contact->rigid) rigid_clear_push(contact->rigid);
        for (int64_t k = 0; k < contact->n_pairs; k++) {
            const struct contact_pair *const pair = &contact->pair[k];
            if (!pair->touches) continue;
            const int32_t a = contact->edge[pair->edge].a, b = contact->edge[pair->edge].b;
            const int one = contact->point[pair->point].body, other = contact->point[a].body;
            contact->touched |=
                one != other && moves_by_itself(contact, one) && moves_by_itself(contact, other);
            contact_add_force(contact, particles, pair->point, pair->force[0]);
            contact_add_force(contact, particles, a, pair->force[1]);
            contact_add_force(contact, particles, b, pair->force[2]);
        }
        if (contact->friction) contact_friction(contact, particles, particles);
        /* The work of driven walls is booked as one number, too. */
        contact->touched |= contact->power != 0;
    }
}

/* Spacings that points may approach more than by their speeds. Doubling it changes no bits. */
#define APPROACH_MARGIN 0.25
/* Surfaces nearer than this many times their reach count in the step bound: forces may bring them
 * nearer than their present velocity does, by which their distance after the step is found. */
#define NEAR 1.25
/* Skin of the list in spacings: pairs are listed again when points have moved by it. The bits do
 * not depend on it: a thicker one has more pairs, which are listed less often. */
#define SKIN 1.0

double contact_energy(struct contact *contact, const struct particles *particles, double time)
{
    if (contact->known && !contact->near) return 0;
    contact_place(contact, particles, time);
    if (contact->known) {
        list_if_stale(contact);
    } else {
        contact_list(contact, SKIN * contact->spacing);
        contact->near = contact->n_pairs > 0;
    }
    double sum = 0;
    for (int64_t k = 0; k < contact->n_pairs; k++) sum += pair_energy(contact, &contact->pair[k]);
    if (!contact->friction) return sum;
    find_forces(contact);
    return sum + contact_friction(contact, particles, NULL);
}

/* --- before a step --- */

/* Fraction of the distance to a surface that a point may move in a step (T-62b). */
#define ADVANCE 0.25

static double moves_freely(const struct contact *contact, const struct particles *particles,
                           const struct contact_point *point)
{
    return point->body < contact->n_solids ? particles->free[point->index] : 0;
}

/* T-62a: a pair's part of the rows of M^-1 K by Gershgorin, at its place after the step. */
static void add_rows(struct contact *contact, const struct particles *particles,
                     const struct contact_pair *pair, const struct contact_closest *closest,
                     double left)
{
    const struct contact_edge *const e = &contact->edge[pair->edge];
    const struct contact_constants q = contact_constants_of(closest->law, closest->point);
    const double s = closest->at;
    const double own = s == 0 ? 1 - closest->a->share : s == 1 ? 1 - closest->b->share : 1;
    const double both = moves_freely(contact, particles, closest->point) +
                        (1 - s) * moves_freely(contact, particles, closest->a) +
                        s * moves_freely(contact, particles, closest->b);
    const double stiffness = own * both * elastic_stiffness(q.stiffness, closest->min_reach, left);
    const double damping = own * both * q.damping;
    contact_add_bound(contact, particles, pair->point, 1, stiffness, damping);
    contact_add_bound(contact, particles, e->a, 1 - s, stiffness, damping);
    contact_add_bound(contact, particles, e->b, s, stiffness, damping);
    if (!contact->rigid) return;
    const struct contact_point *const p = closest->point;
    const double r = closest->distance;
    const double n[2] = {closest->offset[0] / r, closest->offset[1] / r};
    const double alone = own * elastic_stiffness(q.stiffness, closest->min_reach, left);
    contact_add_body_bound(contact, p->body, p->x, r > 0 ? n : NULL, alone, own * q.damping);
    contact_add_body_bound(contact, closest->a->body, p->x, r > 0 ? n : NULL, alone,
                           own * q.damping);
}

static void find_depth(struct contact *contact, const struct contact_closest *closest,
                       double overlap)
{
    if (overlap > contact->deepest.overlap)
        contact->deepest =
            (struct contact_depth){overlap, closest->point->x[0], closest->point->x[1],
                                   closest->point->body, closest->a->body};
}

/* Distance beyond the reach within which a pair matters in the coming time `span`. */
static double distance_near(const struct contact *contact, double speed, double span)
{
    return max2((NEAR - 1) * contact->reach, APPROACH_MARGIN * contact->spacing) +
           1.5 * span * speed;
}

static void watch_pair(struct contact *contact, const struct particles *particles,
                       struct contact_pair *pair, double longest, double span)
{
    struct contact_closest closest;
    double v[2];
    pair->near = false;
    if (!contact_find_closest(contact, pair->point, pair->edge, &closest)) return;
    const double r = closest.distance, left = closest.left, min_reach = closest.min_reach;
    relative_velocity(&closest, v);
    if (r > closest.reach + distance_near(contact, sqrt(v[0] * v[0] + v[1] * v[1]), span)) return;
    contact->near = true;
    /* The overlap in parts of that at which the law of a pair that begins apart is infinite. */
    const double gap = closest.law->reach - closest.law->spacing;
    find_depth(contact, &closest, (min_reach - left - gap) / (closest.reach_apart - gap));
    const double closing =
        r > 0 ? max2(0, -(v[0] * closest.offset[0] + v[1] * closest.offset[1]) / r) : 0;
    if (closing > 0)
        contact->step_before_contact =
            min2(contact->step_before_contact,
                 (max2(0, left - min_reach) + ADVANCE * min2(left, min_reach)) / closing);
    const double then = max2(left - closing * longest, (1 - ADVANCE) * min2(left, min_reach));
    if (then > NEAR * min_reach) return;
    pair->near = true;
    pair->distance = r;
    add_rows(contact, particles, pair, &closest, then);
}

/* Notes the depth of a point behind the nearest edge of another body, from its pairs. */
static void watch_side(struct contact *contact, int64_t first, int64_t end)
{
    struct contact_closest nearest = {.distance = (double)INFINITY};
    bool inside = false;
    for (int64_t k = first; k < end; k++) {
        const struct contact_pair *const pair = &contact->pair[k];
        const struct contact_closest f = contact_nearest(contact, pair->point, pair->edge);
        if (f.point->group == f.a->group || !(f.distance < nearest.distance)) continue;
        const double side =
            (f.b->x[0] - f.a->x[0]) * f.offset[1] - (f.b->x[1] - f.a->x[1]) * f.offset[0];
        nearest = f;
        inside = contact->edge[pair->edge].sided && f.at > 0 && f.at < 1 && side > 0;
    }
    if (!inside || !(nearest.distance > 0)) return;
    const double spacing = contact_law_of(contact, nearest.point->body, nearest.a->body)->spacing;
    find_depth(contact, &nearest, 1 + nearest.distance / spacing);
}

static void watch_pairs(struct contact *contact, const struct particles *particles, double longest,
                        double span)
{
    for (int64_t k = 0; k < contact->n_solid_points; k++) {
        struct contact_point *const p = &contact->point[k];
        p->omega2_bound = p->damping_bound = p->wall_omega2_bound = p->wall_damping_bound = 0;
    }
    for (int k = 0; k < contact->n_walls; k++)
        contact->body_omega2[k] = contact->body_damping[k] = 0;
    for (int64_t first = 0, end; first < contact->n_pairs; first = end) {
        for (end = first;
             end < contact->n_pairs && contact->pair[end].point == contact->pair[first].point;
             end++)
            watch_pair(contact, particles, &contact->pair[end], longest, span);
        watch_side(contact, first, end);
        if (contact->friction) contact_friction_bounds(contact, particles, first, end);
    }
    for (int64_t k = 0; k < contact->n_solid_points; k++) {
        const struct contact_point *const p = &contact->point[k];
        contact->omega2 = max2(contact->omega2, p->omega2_bound + p->wall_omega2_bound);
        contact->damping = max2(contact->damping, p->damping_bound + p->wall_damping_bound);
    }
    double omega2 = 0, damping = 0;
    for (int k = 0; k < contact->n_walls; k++) {
        omega2 = max2(omega2, contact->body_omega2[k]);
        damping = max2(damping, contact->body_damping[k]);
    }
    contact->omega2 += omega2;
    contact->damping += damping;
}

bool contact_watch(struct contact *contact, const struct particles *particles, double time,
                   double longest, double span)
{
    contact_place(contact, particles, time);
    double moved2[2] = {0}, speed2[2] = {0}; /* of solids, of walls */
    for (int64_t k = 0; k < contact->n_moving_points; k++) {
        const struct contact_point *const p = &contact->point[k];
        const int of = k >= contact->n_solid_points;
        moved2[of] =
            max2(moved2[of], square(p->x[0] - p->listed[0]) + square(p->x[1] - p->listed[1]));
        speed2[of] = max2(speed2[of], square(p->v[0]) + square(p->v[1]));
    }
    /* The most that two points may have approached since the list was made, and their speed. */
    const double moved = sqrt(moved2[0]) + sqrt(max2(moved2[0], moved2[1])),
                 speed = sqrt(speed2[0]) + sqrt(max2(speed2[0], speed2[1])),
                 want = distance_near(contact, speed, span);
    if (!contact->known || !(contact->margin - moved >= want))
        contact_list(contact, want + SKIN * contact->spacing);
    contact->near = false;
    contact->omega2 = contact->damping = 0;
    contact->step_before_contact = (double)INFINITY;
    contact->deepest = (struct contact_depth){0};
    watch_pairs(contact, particles, longest, span);
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
        contact->point[k].x[0] = walls->x[i];
        contact->point[k].x[1] = walls->y[i];
    }
    contact->known = false;
}

const struct scene_section_common *contact_section(const struct contact *contact, int body)
{
    return body < contact->n_solids ? &contact->scene->solid[body].common
                                    : &contact->scene->wall[body - contact->n_solids].common;
}

/* --- start --- */

/* A pressure p leaves an overlap of spacing p/(stiffness E + p) (T-61). E is that of a layer as
 * stiff as half a spacing of each body, in series; a wall is rigid. Of two equal bodies each is
 * compressed by half of the overlap. */
static void set_law(struct contact *contact, const struct scene_contact *from, int a, int b)
{
    const double spacing = 0.5 * (contact_dp(contact, a) + contact_dp(contact, b));
    /* A body that folds: what begins near in it may be nearer than a layer of fluid. */
    const bool own = contact->group[a] == contact->group[b];
    const double reach = spacing + (own ? from->gap : scene_contact_gap(contact->scene, from));
    double compliance = 0, shears = 0, per_mass = 0;
    for (int k = 0; k < 2; k++) {
        const struct solid_body *const body = &contact->solid->body[k ? b : a];
        if ((k ? b : a) >= contact->n_solids) continue;
        compliance += body->dp / body->young;
        shears += body->dp / body->mu;
        per_mass += 1 / body->mass;
    }
    const double stiffness = from->stiffness * (2 * spacing / compliance);
    *contact_law_of(contact, a, b) = *contact_law_of(contact, b, a) = (struct contact_law){
        .on = true,
        .spacing = spacing,
        .reach = reach,
        .stiffness = stiffness,
        .per_mass = per_mass,
        .shear = compliance / shears,
        .damping = from->damping,
        .friction = from->friction,
    };
    contact->reach = max2(contact->reach, reach);
    contact->first_omega2 =
        max2(contact->first_omega2,
             stiffness * per_mass * max2(contact_dp(contact, a), contact_dp(contact, b)) / spacing);
    contact->spacing = max2(contact->spacing, spacing);
}

/* Whether a pair of the list is of two groups and begins within its reach. */
static bool begins_near(const struct contact *contact, const struct contact_pair *pair)
{
    struct contact_closest closest;
    return contact_find_closest(contact, pair->point, pair->edge, &closest) &&
           closest.point->group != closest.a->group && closest.distance < closest.reach;
}

/* Bodies that begin with less than a layer of fluid between them anywhere need not keep one. */
static void drop_layers(struct contact *contact)
{
    contact_list(contact, 0);
    for (int64_t k = 0; k < contact->n_pairs; k++) {
        const struct contact_pair *const pair = &contact->pair[k];
        const int a = contact->point[pair->point].body,
                  b = contact->point[contact->edge[pair->edge].a].body;
        struct contact_law *const law = contact_law_of(contact, a, b);
        if (begins_near(contact, pair))
            law->reach = contact_law_of(contact, b, a)->reach =
                law->spacing + scene_contact_of(contact->scene, a, b)->gap;
    }
}

/* Stores initial distances from other groups that are below the reach. Bodies on lattices that do
 * not fit, and particles clamped within a wall, start without repulsion and keep that distance. */
static void set_initial_distances(struct contact *contact)
{
    contact_list(contact, 0);
    for (int64_t k = 0; k < contact->n_pairs; k++) {
        const struct contact_pair *const pair = &contact->pair[k];
        const struct contact_closest f = contact_nearest(contact, pair->point, pair->edge);
        struct contact_point *const point = &contact->point[pair->point];
        if (!begins_near(contact, pair)) continue;
        if (point->initial_group >= 0 && f.distance >= point->initial) continue;
        point->initial = f.distance;
        point->initial_group = f.a->group;
    }
    contact->known = false;
    contact->n_pairs = 0;
    contact->stale = 1;
}

/* Bonded solids form one group; so do walls that move together or are at rest. */
static enum err bodies_create(struct contact *contact, struct arena *a, struct diag *d)
{
    const struct scene *const scene = contact->scene;
    contact->n_solids = scene->n_solid;
    contact->n_walls = effects_of_scene(scene) & FX_CONTACT_WALL ? scene->n_wall : 0;
    contact->n_bodies = contact->n_solids + contact->n_walls;
    const size_t n = (size_t)contact->n_bodies;
    TRY(arena_array(a, &contact->law, n * n, "contact", d));
    TRY(arena_array(a, &contact->group, n, "contact", d));
    TRY(arena_array(a, &contact->motion, contact->n_walls, "contact", d));
    TRY(arena_array(a, &contact->body_omega2, contact->n_walls, "contact", d));
    TRY(arena_array(a, &contact->body_damping, contact->n_walls, "contact", d));
    for (int k = 0; k < contact->n_solids; k++) contact->group[k] = contact->solid->body[k].bond;
    for (int k = 0; k < contact->n_walls; k++)
        contact->group[contact->n_solids + k] = contact->n_solids + 1 + scene_wall_motion(scene, k);
    return ERR_OK;
}

enum err contact_create(struct contact *contact, struct arena *a, const struct scene *scene,
                        const struct solid *solid, const struct particles *particles,
                        struct diag *d)
{
    *contact = (struct contact){.scene = scene, .arena = a, .solid = solid};
    contact->friction = particles->stick_edge;
    TRY(bodies_create(contact, a, d));
    for (int one = 0; one < contact->n_solids; one++)
        for (int other = one; other < contact->n_bodies; other++) {
            const struct scene_contact *const from = scene_contact_of(scene, one, other);
            if (from) set_law(contact, from, one, other);
        }
    TRY(contact_surface_create(contact, a, particles, d));
    contact->reach += 2 * contact->max_inset;
    const size_t edges = (size_t)contact->n_edges;
    TRY(arena_array(a, &contact->middle_x, edges, "contact", d));
    TRY(arena_array(a, &contact->middle_y, edges, "contact", d));
    TRY(point_grid_create(&contact->grid, contact->reach, contact->n_edges, contact->middle_x,
                          contact->middle_y, a, d));
    TRY(contact_list_resize(contact, 4 * contact->n_solid_points + 64, d));
    drop_layers(contact);
    set_initial_distances(contact);
    return ERR_OK;
}
