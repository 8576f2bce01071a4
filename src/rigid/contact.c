/* SPDX-License-Identifier: MIT
 * Pairs of a corner and a piece of outline of rigid bodies and walls that may touch (T-102). */
#include "rigid/forces.h"
#include "geometry/motion.h"
#include "geometry/outline.h"

/* The outlines of a wall or rigid body at the start, and where it is. */
struct rigid_shape {
    struct body_outlines of;
    int rigid, motion; /* numbers; -1: none */
    struct motion_state now;
};

/* Contact of a body with a wall, or with a body before it. */
struct pair_law {
    double layer; /* distance that outlines keep, m; NAN: no contact */
    double friction, restitution;
};

struct rigid_contact {
    double reach;               /* a spacing, m */
    struct rigid_shape *shape;  /* [n_wall] */
    struct pair_law *law, *now; /* [rigid bodies][n_wall]; of the pair that is compared */
    int most;                   /* pairs */
};

/* --- outlines --- */

/* A corner, in the axes of the section whose outline it is compared with. */
struct approach {
    struct rigid *rigid;
    const struct rigid_shape *of[2]; /* that of the corner and that of the outline */
    double at[2], radius;
    bool inside;
    struct rigid_row *deepest; /* of a corner inside: there is no other */
};

/* The rows of a place with the normal n: along it, and across it for friction. */
static void set_rows(const struct approach *a, const double at[2], const double n[2], double gap,
                     struct rigid_row *row)
{
    const struct pair_law *const law = a->rigid->contact->now;
    const struct motion_state *const m = &a->of[1]->now;
    const double c = m->turn[0], s = m->turn[1];
    const double normal[2] = {c * n[0] - s * n[1], s * n[0] + c * n[1]};
    const struct motion_point place = motion_of_point(m, at[0], at[1]);
    row[0].gap = gap;
    row[0].restitution = law->restitution;
    row[1].friction = law->friction;
    for (int t = 0; t < 2; t++) {
        const double e[2] = {t ? -normal[1] : normal[0], t ? normal[0] : normal[1]};
        row[t].other_rate = 0;
        for (int side = 0; side < 2; side++) {
            const struct motion_state *const of = &a->of[side]->now;
            const double arm[2] = {place.x[0] - of->centre[0] - of->d[0],
                                   place.x[1] - of->centre[1] - of->d[1]};
            const double v[2] = {of->v[0] - of->rate * arm[1], of->v[1] + of->rate * arm[0]};
            if (row[t].body[side] < 0)
                row[t].other_rate += (side ? -1 : 1) * (e[0] * v[0] + e[1] * v[1]);
            else
                rigid_row_along(&row[t], side, arm, e);
        }
    }
}

/* Adds a place `at` of the outline with the normal n, from which the corner is at a distance. */
static void add_pair(struct approach *a, const double at[2], const double n[2], double distance)
{
    struct rigid_contact *const contact = a->rigid->contact;
    const double near = 1e-6 * contact->reach, gap = distance - a->radius - contact->now->layer;
    const double beyond[2] = {at[0] + near * n[0], at[1] + near * n[1]},
                 before[2] = {at[0] - near * n[0], at[1] - near * n[1]};
    const bool deep = distance < -1e-3 * near;
    /* A quarter of a spacing: deeper, the body passes through, of which a guard warns. */
    if (gap > contact->reach || gap < -contact->now->layer - 0.25 * contact->reach) return;
    if (a->inside ? distance > 1e-3 * near : deep) return;
    const struct body_outlines *const o = &a->of[1]->of;
    if (body_outlines_contain(o, beyond[0], beyond[1]) ||
        !body_outlines_contain(o, before[0], before[1]))
        return;
    struct rigid_row *to = deep ? a->deepest : NULL;
    if (to && gap <= to->gap) return;
    if (!to) {
        const int body[2] = {a->of[0]->rigid, a->of[1]->rigid};
        a->rigid->crowded |= a->rigid->n_rows == 2 * contact->most;
        if (a->rigid->crowded) return;
        to = rigid_add_row(a->rigid, RIGID_GAP, body);
        (void)rigid_add_row(a->rigid, RIGID_FRICTION, body);
    }
    if (deep) a->deepest = to;
    set_rows(a, at, n, gap, to);
}

/* `sign`: -1 for a piece that is subtracted. */
static void approach_piece(struct approach *a, const struct outline *o, double sign)
{
    const double most = a->rigid->contact->reach + a->rigid->contact->now->layer + a->radius;
    const struct box2 place = {{a->at[0], a->at[1]}, {a->at[0], a->at[1]}};
    if (!box2_near(&place, &o->box, most)) return;
    if (o->n == 0) {
        const double x = a->at[0] - o->centre[0], y = a->at[1] - o->centre[1];
        const double r = elementary_hypot(x, y);
        if (r == 0) return;
        const double n[2] = {sign * x / r, sign * y / r};
        const double at[2] = {o->centre[0] + o->radius * x / r, o->centre[1] + o->radius * y / r};
        add_pair(a, at, n, sign * (r - o->radius));
        return;
    }
    const double turn = polygon_area(o->n, o->pt) > 0 ? sign : -sign;
    for (int k = 0; k < o->n; k++) {
        const double *const from = o->pt[k], *const to = o->pt[k + 1 < o->n ? k + 1 : 0];
        const double ex = to[0] - from[0], ey = to[1] - from[1];
        const double length = elementary_hypot(ex, ey);
        const double x = a->at[0] - from[0], y = a->at[1] - from[1];
        const double part = length > 0 ? (x * ex + y * ey) / square(length) : -1;
        if (part >= 0 && part <= 1) {
            const double n[2] = {turn * ey / length, -turn * ex / length};
            const double at[2] = {from[0] + part * ex, from[1] + part * ey};
            add_pair(a, at, n, n[0] * x + n[1] * y);
        }
        const double r = elementary_hypot(x, y); /* from a corner of the outline */
        if (r > 0 && !a->inside) add_pair(a, from, (const double[2]){x / r, y / r}, r);
    }
}

/* Where a corner, or a circle about its centre, is near the outline of another section. */
static void approach_corner(struct rigid *rigid, const struct rigid_shape *of,
                            const struct rigid_shape *other, const double at[2], double radius)
{
    const struct motion_point p = motion_of_point(&of->now, at[0], at[1]);
    struct approach a = {.rigid = rigid, .of = {of, other}, .radius = radius};
    motion_initial(&other->now, p.x, a.at);
    a.inside = body_outlines_contain(&other->of, a.at[0], a.at[1]);
    for (int j = 0; j < other->of.add.n; j++) approach_piece(&a, &other->of.add.item[j], 1);
    for (int j = 0; j < other->of.minus.n; j++) approach_piece(&a, &other->of.minus.item[j], -1);
}

static void approach_shape(struct rigid *rigid, const struct rigid_shape *of,
                           const struct rigid_shape *other)
{
    for (int k = 0; k < of->of.add.n + of->of.minus.n; k++) {
        const bool hole = k >= of->of.add.n;
        const struct outline *const o =
            hole ? &of->of.minus.item[k - of->of.add.n] : &of->of.add.item[k];
        if (!o->n && !hole) approach_corner(rigid, of, other, o->centre, o->radius);
        for (int i = 0; i < o->n; i++) approach_corner(rigid, of, other, o->pt[i], 0);
    }
}

/* --- all pairs --- */

static void place_shapes(struct rigid *rigid, double time)
{
    for (int w = 0; w < rigid->scene->n_wall; w++) {
        struct rigid_shape *const s = &rigid->contact->shape[w];
        s->now = s->rigid < 0 ? motion_at(rigid->scene, s->motion, time)
                              : rigid_placed(rigid, s->rigid, rigid->state[s->rigid].x);
    }
}

/* The pairs of a body with a wall, or with a body before it. */
static void approach_pair(struct rigid *rigid, int k, int w)
{
    const struct rigid_shape *const shape = rigid->contact->shape,
                                    *const own = &shape[scene_rigid_wall(rigid->scene, k)];
    approach_shape(rigid, own, &shape[w]);
    approach_shape(rigid, &shape[w], own);
}

static enum err shape_create(struct rigid *rigid, int w, struct arena *a, struct diag *d)
{
    const struct scene *const scene = rigid->scene;
    struct rigid_shape *const s = &rigid->contact->shape[w];
    TRY(body_outlines_of(&s->of, scene, &scene->wall[w].shape, &scene->wall[w].minus, a, d));
    s->rigid = w < scene_rigid_wall(scene, 0) ? -1 : w - scene_rigid_wall(scene, 0);
    s->motion = scene_wall_motion(scene, w);
    for (int j = 0; j < s->of.add.n; j++) rigid->contact->most += 4 * (s->of.add.item[j].n + 4);
    for (int j = 0; j < s->of.minus.n; j++) rigid->contact->most += 4 * s->of.minus.item[j].n;
    return ERR_OK;
}

/* A layer of fluid stays between bodies that begin further apart, as between solids. Bodies that
 * overlap at the start keep that overlap: to part them would add energy. A body on a hinge may turn
 * into what it touches at the start. */
static void set_law(struct rigid *rigid, int k, int w)
{
    const struct scene *const scene = rigid->scene;
    struct rigid_contact *const contact = rigid->contact;
    const int other = contact->shape[w].rigid;
    const bool hinged = scene->rigid[k].hinge.n || (other >= 0 && scene->rigid[other].hinge.n);
    const struct scene_contact *const from =
        scene_contact_of(scene, scene->n_solid + scene_rigid_wall(scene, k), scene->n_solid + w);
    struct pair_law *const law = contact->now = &contact->law[k * scene->n_wall + w];
    *law = (struct pair_law){.layer = (double)NAN};
    if (!from) return;
    *law = (struct pair_law){0, from->friction, from->restitution};
    rigid->n_rows = 0;
    approach_pair(rigid, k, w);
    law->layer = scene_contact_gap(scene, from);
    for (int j = 0; j < rigid->n_rows; j += 2) law->layer = min2(law->layer, rigid->row[j].gap);
    if (rigid->n_rows && hinged) law->layer = (double)NAN;
}

enum err rigid_contact_create(struct rigid *rigid, struct arena *a, struct diag *d)
{
    const struct scene *const scene = rigid->scene;
    const size_t n = (size_t)scene->n_wall;
    struct rigid_contact *const contact = arena_alloc(a, 1, sizeof *contact, "rigid bodies", d);
    rigid->contact = contact;
    if (!contact) return ERR_MEMORY;
    contact->reach = scene->top.dp;
    TRY(arena_array(a, &contact->shape, n, "rigid bodies", d));
    TRY(arena_array(a, &contact->law, n * (size_t)rigid->n, "rigid bodies", d));
    for (int w = 0; w < scene->n_wall; w++) TRY(shape_create(rigid, w, a, d));
    const size_t rows =
        2 * (size_t)contact->most + 4 * (size_t)rigid->n_hinges + (size_t)rigid->n_springs;
    TRY(arena_array(a, &rigid->row, rows, "rigid bodies", d));
    place_shapes(rigid, 0);
    for (int k = 0; k < rigid->n; k++)
        for (int w = 0; w < scene_rigid_wall(scene, k); w++) set_law(rigid, k, w);
    rigid->n_rows = 0;
    return ERR_OK;
}

void rigid_add_pairs(struct rigid *rigid, double time)
{
    struct rigid_contact *const contact = rigid->contact;
    place_shapes(rigid, time);
    for (int k = 0; k < rigid->n; k++)
        for (int w = 0; w < scene_rigid_wall(rigid->scene, k); w++) {
            contact->now = &contact->law[k * rigid->scene->n_wall + w];
            if (!isnan(contact->now->layer)) approach_pair(rigid, k, w);
        }
}
