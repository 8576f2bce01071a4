/* SPDX-License-Identifier: MIT
 * The distance and the law of a point and an edge, and the list of near ones. */
#include "solid/contact.h"
#include "base/segment.h"

/* --- distance --- */

static struct contact_closest closest_of(const struct contact *contact, int32_t point, int32_t edge,
                                         double rise)
{
    const struct contact_point *const p = &contact->point[point],
                                      *const a = &contact->point[contact->edge[edge].a],
                                      *const b = &contact->point[contact->edge[edge].b];
    const struct segment_foot foot = segment_foot(p->x, a->x, b->x, rise);
    return (struct contact_closest){.point = p,
                                    .a = a,
                                    .b = b,
                                    .at = foot.part,
                                    .offset = {foot.offset[0], foot.offset[1]},
                                    .distance = foot.distance};
}

struct contact_closest contact_nearest(const struct contact *contact, int32_t point, int32_t edge)
{
    return closest_of(contact, point, edge, 0);
}

/* Distance below which a point and an end of an edge repel each other (T-61b). At least half a
 * spacing remains for the overlap. */
static double reach_of(const struct contact_law *law, const struct contact_point *point,
                       const struct contact_point *end)
{
    return law->reach + max2(point->inset + end->inset, -0.5 * law->spacing);
}

/* --- law --- */

/* Whether a point began within the kernel, of a body's smoothing length, of an edge's end. */
static bool initially_within(const struct contact *contact, const struct contact_point *point,
                             const struct contact_point *const end[2], int body)
{
    const double reach2 = square(KERNEL_REACH * contact->solid->body[body].h);
    for (int k = 0; k < 2; k++)
        if (square(point->X[0] - end[k]->X[0]) + square(point->X[1] - end[k]->X[1]) <= reach2)
            return true;
    return false;
}

/* Whether a clamp holds the solid of a pair to its wall there. */
static bool joined_by_clamp(const struct contact *contact, const struct contact_point *point,
                            const struct contact_point *const end[2])
{
    const bool first = point->body < contact->n_solids;
    const int one = first ? point->body : end[0]->body,
              wall = (first ? end[0]->body : point->body) - contact->n_solids;
    if (wall < 0 || !(first ? point->near_clamp : end[0]->near_clamp || end[1]->near_clamp))
        return false;
    return strcmp(contact->scene->solid[one].clamp_motion, contact->scene->wall[wall].motion) ==
               0 &&
           initially_within(contact, point, end, one);
}

/* The distance at which a pair begins, if it is to keep that in place of its reach; else infinite.
 * 0: they do not interact. The material keeps points apart that were initially within each other's
 * kernel in one body. So does a clamp for the wall, a hinge for what begins in its kernel. */
static double initial_distance(const struct contact *contact, const struct contact_point *point,
                               const struct contact_point *const end[2])
{
    if (point->group == end[0]->group)
        return initially_within(contact, point, end, point->body) ? 0 : (double)INFINITY;
    if (joined_by_clamp(contact, point, end) ||
        (point->near_hinge && point->near_hinge == end[0]->near_hinge))
        return 0;
    return point->initial_group == end[0]->group ? point->initial : (double)INFINITY;
}

bool contact_find_closest(const struct contact *contact, int32_t point, int32_t edge,
                          struct contact_closest *closest)
{
    const struct contact_point *const p = &contact->point[point],
                                      *const end[2] = {&contact->point[contact->edge[edge].a],
                                                       &contact->point[contact->edge[edge].b]};
    const struct contact_law *const law = contact_law_of(contact, p->body, end[0]->body);
    const double initial = law->on ? initial_distance(contact, p, end) : 0;
    if (!(initial > 0)) return false;
    const double apart[2] = {reach_of(law, p, end[0]), reach_of(law, p, end[1])};
    const double at_a = min2(initial, apart[0]), at_b = min2(initial, apart[1]);
    *closest = closest_of(contact, point, edge, at_b - at_a);
    closest->law = law;
    closest->reach_a = at_a;
    closest->reach_b = at_b;
    closest->reach = closest->at == 1 ? at_b : at_a + closest->at * (at_b - at_a);
    closest->min_reach = min2(at_a, at_b);
    closest->reach_apart = min2(apart[0], apart[1]);
    closest->left = closest->distance - (closest->reach - closest->min_reach);
    return true;
}

/* A point represents its own part of the outline. Damping as a fraction of 2 sqrt(k m), with the
 * mass m of the pair, m_a m_b/(m_a + m_b). */
struct contact_constants contact_constants_of(const struct contact_law *law,
                                              const struct contact_point *point)
{
    const double k = law->stiffness * point->width / law->spacing,
                 critical = 2 * sqrt(k * (1 / law->per_mass));
    return (struct contact_constants){
        .stiffness = CONTACT_HALF * k,
        .damping = CONTACT_HALF * law->damping * critical,
        .tangential_damping = law->friction > 0 ? CONTACT_HALF * 0.5 * critical : 0,
    };
}

/* --- forces on particles --- */

double contact_inv_mass(const struct contact *contact, const struct particles *particles,
                        const struct contact_point *point)
{
    if (point->body >= contact->n_solids) return 0;
    return particles->free[point->index] / contact->solid->body[point->body].mass;
}

void contact_add_force(struct contact *contact, struct particles *particles, int32_t point,
                       const double f[2])
{
    const struct contact_point *const p = &contact->point[point];
    const int rigid = contact_rigid_of(contact, p->body);
    if (rigid >= 0) {
        rigid_push(contact->rigid, rigid, &contact->motion[p->body - contact->n_solids], p->x, f);
        return;
    }
    if (p->body >= contact->n_solids) {
        contact->power -= f[0] * p->v[0] + f[1] * p->v[1];
        return;
    }
    const double per_mass = contact_inv_mass(contact, particles, p);
    particles->sx[p->index] += f[0] * per_mass;
    particles->sy[p->index] += f[1] * per_mass;
}

void contact_add_bound(struct contact *contact, const struct particles *particles, int32_t point,
                       double weight, double stiffness, double damping)
{
    struct contact_point *const p = &contact->point[point];
    const double per_mass = contact_inv_mass(contact, particles, p);
    p->omega2_bound += weight * stiffness * per_mass;
    p->damping_bound += weight * damping * per_mass;
}

void contact_add_body_bound(struct contact *contact, int body, const double x[2], const double *n,
                            double stiffness, double damping)
{
    const int k = contact_rigid_of(contact, body), wall = body - contact->n_solids;
    if (k < 0) return;
    const struct motion_state *const m = &contact->motion[wall];
    const double *const mass = contact->rigid->body[k].mass;
    const double arm[2] = {x[0] - m->centre[0] - m->d[0], x[1] - m->centre[1] - m->d[1]};
    const double arm2 = n ? square(arm[0] * n[1] - arm[1] * n[0]) : square(arm[0]) + square(arm[1]);
    const double per_mass = 1 / mass[0] + arm2 / mass[2];
    contact->body_omega2[wall] += stiffness * per_mass;
    contact->body_damping[wall] += damping * per_mass;
}

/* --- list --- */

/* The box around the solids' surfaces, widened: walls outside need no search. */
static struct box2 box_of_solids(const struct contact *contact, double more)
{
    struct box2 box = box2_empty();
    for (int64_t k = 0; k < contact->n_solid_points; k++)
        box2_include(&box, contact->point[k].x[0], contact->point[k].x[1]);
    for (int c = 0; c < 2; c++) box.low[c] -= more, box.high[c] += more;
    return box;
}

enum err contact_list_resize(struct contact *contact, int64_t max_pairs, struct diag *d)
{
    struct contact_pair *pair;
    TRY(arena_array(contact->arena, &pair, max_pairs, "contact", d));
    if (contact->n_pairs) memcpy(pair, contact->pair, (size_t)contact->n_pairs * sizeof *pair);
    contact->pair = pair;
    contact->max_pairs = max_pairs;
    return ERR_OK;
}

/* Lists a near point and edge; the edges of a point, whose pairs begin at `first`, ascend. */
static void list_pair(struct contact *contact, int32_t point, int32_t edge, int64_t first)
{
    struct contact_closest closest;
    if (!contact_find_closest(contact, point, edge, &closest) ||
        !(closest.distance < closest.reach + contact->margin))
        return;
    struct diag d = {0};
    /* Without memory for a longer list the run stops. */
    if (contact->n_pairs == contact->max_pairs &&
        contact_list_resize(contact, 2 * contact->max_pairs, &d)) {
        contact->list_full = true;
        return;
    }
    int64_t at = contact->n_pairs++;
    for (; at > first && contact->pair[at - 1].edge > edge; at--)
        contact->pair[at].edge = contact->pair[at - 1].edge;
    contact->pair[at].edge = edge;
    contact->pair[contact->n_pairs - 1].point = point;
}

void contact_list(struct contact *contact, double margin)
{
    double half2 = 0;
    for (int64_t k = 0; k < contact->n_edges; k++) {
        const struct contact_edge *const e = &contact->edge[k];
        const double *const a = contact->point[e->a].x, *const b = contact->point[e->b].x;
        contact->middle_x[k] = 0.5 * (a[0] + b[0]);
        contact->middle_y[k] = 0.5 * (a[1] + b[1]);
        half2 = max2(half2, 0.25 * (square(a[0] - b[0]) + square(a[1] - b[1])));
    }
    const double reach = contact->reach + margin + sqrt(half2);
    const struct box2 box = box_of_solids(contact, reach);
    contact->margin = margin;
    contact->grid.side = reach;
    point_grid_clear(&contact->grid);
    for (int64_t k = contact->n_edges - 1; k >= 0; k--)
        if (box2_contains(&box, contact->middle_x[k], contact->middle_y[k]))
            point_grid_insert(&contact->grid, k);
    contact->n_pairs = 0;
    for (int64_t k = 0; k < contact->n_points; k++) {
        struct contact_point *const p = &contact->point[k];
        memcpy(p->listed, p->x, sizeof p->listed);
        if (!box2_contains(&box, p->x[0], p->x[1])) continue;
        const int64_t first = contact->n_pairs;
        struct point_visit v = point_grid_visit(&contact->grid, p->x[0], p->x[1], reach);
        while (point_grid_next(&contact->grid, &v))
            list_pair(contact, (int32_t)k, (int32_t)v.k, first);
    }
    contact->stale = 0;
    contact->known = true;
}

/* --- positions of points --- */

void contact_place(struct contact *contact, const struct particles *particles, double time)
{
    const double far2 = square(0.5 * contact->margin);
    if (contact->n_moving_points > contact->n_solid_points) {
#pragma omp single
        for (int k = 0; k < contact->n_walls; k++) {
            contact->time = time;
            contact->motion[k] =
                motion_at(contact->scene, scene_wall_motion(contact->scene, k), time);
        }
    }
#pragma omp for schedule(static)
    for (int64_t k = 0; k < contact->n_moving_points; k++) {
        struct contact_point *const p = &contact->point[k];
        if (k < contact->n_solid_points) {
            p->x[0] = p->X[0] + particles->ux[p->index];
            p->x[1] = p->X[1] + particles->uy[p->index];
            p->v[0] = particles->vx[p->index];
            p->v[1] = particles->vy[p->index];
        } else {
            const struct motion_point at =
                motion_of_point(&contact->motion[p->body - contact->n_solids], p->X[0], p->X[1]);
            memcpy(p->x, at.x, sizeof p->x);
            memcpy(p->v, at.v, sizeof p->v);
        }
        /* A NaN counts as far. */
        if (!(square(p->x[0] - p->listed[0]) + square(p->x[1] - p->listed[1]) <= far2)) {
#pragma omp atomic write
            contact->stale = 1;
        }
    }
}
