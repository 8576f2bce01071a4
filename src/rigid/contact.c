/* SPDX-License-Identifier: MIT */
#include "rigid/forces.h"

#include <math.h>
#include <string.h>

#include "base/elementary.h"
#include "geometry/motion.h"
#include "geometry/outline.h"

/* The outlines of a wall or rigid body at the start, and where it is. */
struct rigid_shape {
    struct outlines add, minus;
    int rigid, motion; /* numbers; -1: none */
    struct motion_state now;
};

/* A place where the corner of one section is near the outline of another one. */
struct rigid_touch {
    int body[2]; /* -1: a wall */
    const struct touch_law *law;
    /* Along the normal from the second to the first, and across it: what a unit of impulse is to
     * each body, force and moment; the speed of walls, m/s; the impulses. */
    double along[2][2][3], wall_speed[2], impulse[RIGID_STAGES][2];
    double gap;   /* m */
    double leave; /* least speed at which it opens after an impact, m/s */
};

/* Contact of a body with a wall, or with a body before it. */
struct touch_law {
    double layer; /* distance that outlines keep, m; NAN: no contact */
    double friction, restitution;
};

struct rigid_contact {
    double reach;                /* a spacing, m */
    struct rigid_shape *shape;   /* [n_wall] */
    struct touch_law *law, *now; /* [rigid bodies][n_wall]; of the pair that is compared */
    int n, most;
    struct rigid_touch *touch;
};

/* --- outlines --- */

static bool is_inside(const struct rigid_shape *s, const double at[2])
{
    return outlines_find(&s->add, at[0], at[1]) >= 0 && outlines_find(&s->minus, at[0], at[1]) < 0;
}

/* A corner, in the axes of the section whose outline it is compared with. */
struct approach {
    struct rigid_contact *contact;
    const struct rigid_shape *of[2]; /* that of the corner and that of the outline */
    double at[2], radius;
    bool inside;
    struct rigid_touch *deepest; /* of a corner inside: there is no other */
};

/* Adds a place `at` of the outline with the normal n, from which the corner is at a distance. */
static void add_touch(struct approach *a, const double at[2], const double n[2], double distance)
{
    struct rigid_contact *const contact = a->contact;
    const double near = 1e-6 * contact->reach, gap = distance - a->radius - contact->now->layer;
    const double beyond[2] = {at[0] + near * n[0], at[1] + near * n[1]},
                 before[2] = {at[0] - near * n[0], at[1] - near * n[1]};
    const bool deep = distance < -1e-3 * near;
    /* A quarter of a spacing: deeper, the body passes through, of which a guard warns. */
    if (gap > contact->reach || gap < -contact->now->layer - 0.25 * contact->reach) return;
    if (a->inside ? distance > 1e-3 * near : deep) return;
    if (is_inside(a->of[1], beyond) || !is_inside(a->of[1], before)) return;
    struct rigid_touch *to = &contact->touch[contact->n];
    if (deep && a->deepest) {
        if (gap <= a->deepest->gap) return;
        to = a->deepest;
    } else if (contact->n == contact->most) {
        return;
    } else {
        contact->n++;
    }
    if (deep) a->deepest = to;
    const struct motion_state *const m = &a->of[1]->now;
    const double c = m->turn[0], s = m->turn[1];
    const double normal[2] = {c * n[0] - s * n[1], s * n[0] + c * n[1]};
    const struct motion_point place = motion_of_point(m, at[0], at[1]);
    *to = (struct rigid_touch){.gap = gap, .law = contact->now};
    for (int side = 0; side < 2; side++) {
        const struct motion_state *const of = &a->of[side]->now;
        const double sign = side ? -1 : 1, x = place.x[0] - of->centre[0] - of->d[0],
                     y = place.x[1] - of->centre[1] - of->d[1];
        to->body[side] = a->of[side]->rigid;
        const double v[2] = {of->v[0] - of->rate * y, of->v[1] + of->rate * x};
        for (int t = 0; t < 2; t++) {
            const double e[2] = {t ? -normal[1] : normal[0], t ? normal[0] : normal[1]};
            if (to->body[side] < 0) {
                to->wall_speed[t] += sign * (e[0] * v[0] + e[1] * v[1]);
                continue;
            }
            to->along[t][side][0] = sign * e[0];
            to->along[t][side][1] = sign * e[1];
            to->along[t][side][2] = sign * (x * e[1] - y * e[0]);
        }
    }
}

/* `sign`: -1 for a piece that is subtracted. */
static void approach_piece(struct approach *a, const struct outline *o, double sign)
{
    const double most = a->contact->reach + a->contact->now->layer + a->radius;
    const struct box2 place = {{a->at[0], a->at[1]}, {a->at[0], a->at[1]}};
    if (!box2_near(&place, &o->box, most)) return;
    if (o->n == 0) {
        const double x = a->at[0] - o->centre[0], y = a->at[1] - o->centre[1];
        const double r = elementary_hypot(x, y);
        if (r == 0) return;
        const double n[2] = {sign * x / r, sign * y / r};
        const double at[2] = {o->centre[0] + o->radius * x / r, o->centre[1] + o->radius * y / r};
        add_touch(a, at, n, sign * (r - o->radius));
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
            add_touch(a, at, n, n[0] * x + n[1] * y);
        }
        const double r = elementary_hypot(x, y); /* from a corner of the outline */
        if (r > 0 && !a->inside) add_touch(a, from, (const double[2]){x / r, y / r}, r);
    }
}

/* Where a corner, or a circle about its centre, is near the outline of another section. */
static void approach_corner(struct rigid_contact *contact, const struct rigid_shape *of,
                            const struct rigid_shape *other, const double at[2], double radius)
{
    const struct motion_state *const m = &other->now;
    const struct motion_point p = motion_of_point(&of->now, at[0], at[1]);
    const double x = p.x[0] - m->d[0] - m->centre[0], y = p.x[1] - m->d[1] - m->centre[1];
    struct approach a = {.contact = contact, .of = {of, other}, .radius = radius};
    a.at[0] = m->centre[0] + m->turn[0] * x + m->turn[1] * y;
    a.at[1] = m->centre[1] - m->turn[1] * x + m->turn[0] * y;
    a.inside = is_inside(other, a.at);
    for (int j = 0; j < other->add.n; j++) approach_piece(&a, &other->add.item[j], 1);
    for (int j = 0; j < other->minus.n; j++) approach_piece(&a, &other->minus.item[j], -1);
}

static void approach_shape(struct rigid_contact *contact, const struct rigid_shape *of,
                           const struct rigid_shape *other)
{
    for (int k = 0; k < of->add.n + of->minus.n; k++) {
        const bool hole = k >= of->add.n;
        const struct outline *const o = hole ? &of->minus.item[k - of->add.n] : &of->add.item[k];
        if (!o->n && !hole) approach_corner(contact, of, other, o->centre, o->radius);
        for (int i = 0; i < o->n; i++) approach_corner(contact, of, other, o->pt[i], 0);
    }
}

/* --- all touches --- */

static void place_shapes(struct rigid *rigid, double time)
{
    for (int w = 0; w < rigid->scene->n_wall; w++) {
        struct rigid_shape *const s = &rigid->contact->shape[w];
        s->now = motion_at(rigid->scene, s->motion, time);
        if (s->rigid < 0) continue;
        const double *const x = rigid->state[s->rigid].x;
        s->now = (struct motion_state){.d = {x[0], x[1]},
                                       .centre = {rigid->body[s->rigid].centre[0],
                                                  rigid->body[s->rigid].centre[1]},
                                       .angle = x[2],
                                       .turn = {elementary_cos(x[2]), elementary_sin(x[2])}};
    }
}

/* The touches of a body with a wall, or with a body before it. */
static void approach_pair(struct rigid *rigid, int k, int w)
{
    const struct rigid_shape *const shape = rigid->contact->shape,
                                    *const own = &shape[scene_rigid_wall(rigid->scene, k)];
    approach_shape(rigid->contact, own, &shape[w]);
    approach_shape(rigid->contact, &shape[w], own);
}

static enum err shape_create(struct rigid *rigid, int w, struct arena *a, struct diag *d)
{
    const struct scene *const scene = rigid->scene;
    struct rigid_shape *const s = &rigid->contact->shape[w];
    TRY(outlines_of(&s->add, scene, &scene->wall[w].shape, a, d));
    TRY(outlines_of(&s->minus, scene, &scene->wall[w].minus, a, d));
    s->rigid = w < scene_rigid_wall(scene, 0) ? -1 : w - scene_rigid_wall(scene, 0);
    s->motion = scene->wall[w].motion[0] ? scene_find_motion(scene, scene->wall[w].motion) : -1;
    for (int j = 0; j < s->add.n; j++) rigid->contact->most += 4 * (s->add.item[j].n + 4);
    for (int j = 0; j < s->minus.n; j++) rigid->contact->most += 4 * s->minus.item[j].n;
    return ERR_OK;
}

/* A layer of fluid stays between bodies that begin further apart, as between solids. A body on a
 * hinge may turn into what it touches at the start. */
static void set_law(struct rigid *rigid, int k, int w)
{
    const struct scene *const scene = rigid->scene;
    struct rigid_contact *const contact = rigid->contact;
    const int other = contact->shape[w].rigid;
    const bool hinged = scene->rigid[k].hinge.n || (other >= 0 && scene->rigid[other].hinge.n);
    const struct scene_contact *const from =
        scene_contact_of(scene, scene->n_solid + scene_rigid_wall(scene, k), scene->n_solid + w);
    struct touch_law *const law = contact->now = &contact->law[k * scene->n_wall + w];
    *law = (struct touch_law){.layer = (double)NAN};
    if (!from) return;
    *law = (struct touch_law){0, from->friction, from->restitution};
    contact->n = 0;
    approach_pair(rigid, k, w);
    law->layer = scene_contact_gap(scene, from);
    for (int j = 0; j < contact->n; j++)
        law->layer = max2(0, min2(law->layer, contact->touch[j].gap));
    if (contact->n && hinged) law->layer = (double)NAN;
}

enum err rigid_contact_create(struct rigid *rigid, struct arena *a, struct diag *d)
{
    const struct scene *const scene = rigid->scene;
    const size_t n = (size_t)scene->n_wall;
    struct rigid_contact *const contact = arena_alloc(a, 1, sizeof *contact, "rigid bodies", d);
    rigid->contact = contact;
    if (!contact) return ERR_MEMORY;
    contact->reach = scene->top.dp;
    contact->shape = arena_alloc(a, n, sizeof *contact->shape, "rigid bodies", d);
    contact->law = arena_alloc(a, n * (size_t)rigid->n, sizeof *contact->law, "rigid bodies", d);
    if (!contact->shape || !contact->law) return ERR_MEMORY;
    for (int w = 0; w < scene->n_wall; w++) TRY(shape_create(rigid, w, a, d));
    contact->touch =
        arena_alloc(a, (size_t)contact->most, sizeof *contact->touch, "rigid bodies", d);
    if (!contact->touch) return ERR_MEMORY;
    place_shapes(rigid, 0);
    for (int k = 0; k < rigid->n; k++)
        for (int w = 0; w < scene_rigid_wall(scene, k); w++) set_law(rigid, k, w);
    contact->n = 0;
    return ERR_OK;
}

/* --- impulses --- */

static struct rigid_row row_of(const struct rigid_touch *t, int across)
{
    return (struct rigid_row){t->body, t->along[across]};
}

/* T-102, T-102b: changes the impulse along the normal, or by friction across it, to what its own
 * equation asks for. Returns the change of the velocity. */
static double relax_touch(struct rigid *rigid, struct rigid_touch *t, enum rigid_stage stage,
                          int across, double dt)
{
    const struct rigid_row row = row_of(t, across);
    const double a = rigid_row_yields(rigid, row, stage);
    if (!(a > 0)) return 0;
    const double gap = stage == RIGID_PUSH ? t->gap : max2(t->gap, 0);
    const double least = across ? 0 : stage == RIGID_IMPACT ? max2(t->leave, -gap / dt) : -gap / dt;
    const double wall = stage == RIGID_PUSH ? 0 : t->wall_speed[across];
    const double rate = rigid_row_rate(rigid, row, stage) + wall - least;
    const double most = t->law->friction * t->impulse[stage][0];
    double *const impulse = &t->impulse[stage][across], before = *impulse;
    *impulse = across ? max2(-most, min2(most, before - rate / a)) : max2(0, before - rate / a);
    rigid_row_push(rigid, row, stage, *impulse - before);
    return fabs(*impulse - before) * a;
}

/* Projected Gauss-Seidel, in the order of the touches and hinges. */
static void find_impulses(struct rigid *rigid, enum rigid_stage stage,
                          const struct rigid_step *step)
{
    struct rigid_contact *const contact = rigid->contact;
    double largest = 1, first = 0;
    for (int turn = 0; turn < 1000 && largest > 1e-12 * first; turn++) {
        largest = 0;
        for (int j = 0; j < contact->n; j++) {
            struct rigid_touch *const t = &contact->touch[j];
            largest = max2(largest, relax_touch(rigid, t, stage, 0, step->dt));
            if (t->law->friction > 0 && stage != RIGID_PUSH)
                largest = max2(largest, relax_touch(rigid, t, stage, 1, step->dt));
        }
        largest = max2(largest, rigid_hinges_relax(rigid, stage, step));
        if (turn == 0) first = largest;
    }
}

/* What meets in this step rebounds. */
static void find_rebounds(const struct rigid *rigid, double dt)
{
    for (int j = 0; j < rigid->contact->n; j++) {
        struct rigid_touch *const t = &rigid->contact->touch[j];
        const double rate = rigid_row_rate(rigid, row_of(t, 0), RIGID_IMPACT) + t->wall_speed[0];
        const bool meets = rate + max2(t->gap, 0) / dt < 0 && t->law->restitution > 0;
        t->leave = meets ? -t->law->restitution * rate : -(double)INFINITY;
    }
}

/* Of the step, along the normal or across it. */
static double impulse_of(const struct rigid_touch *t, int across)
{
    return t->impulse[RIGID_IMPACT][across] + t->impulse[RIGID_STEP][across];
}

void rigid_touch(struct rigid *rigid, double time, const struct rigid_step *step)
{
    struct rigid_contact *const contact = rigid->contact;
    for (int k = 0; k < rigid->n; k++) memset(rigid->eq[k].touch, 0, sizeof rigid->eq[k].touch);
    place_shapes(rigid, time);
    contact->n = 0;
    for (int k = 0; k < rigid->n; k++)
        for (int w = 0; w < scene_rigid_wall(rigid->scene, k); w++) {
            contact->now = &contact->law[k * rigid->scene->n_wall + w];
            if (!isnan(contact->now->layer)) approach_pair(rigid, k, w);
        }
    find_rebounds(rigid, step->dt);
    rigid_hinges_begin(rigid, time);
    for (int stage = 0; stage < RIGID_STAGES; stage++)
        find_impulses(rigid, (enum rigid_stage)stage, step);
    for (int k = 0; k < rigid->n; k++)
        for (int c = 0; c < 3; c++) {
            rigid->eq[k].change[c] +=
                rigid->eq[k].touch[RIGID_IMPACT][c] + rigid->eq[k].touch[RIGID_STEP][c];
            rigid->eq[k].faster[c] += rigid->eq[k].touch[RIGID_STEP][c];
        }
    rigid_hinges_load(rigid);
    for (int j = 0; j < 2 * contact->n; j++) {
        const struct rigid_touch *const t = &contact->touch[j / 2];
        for (int side = 0; side < 2; side++)
            for (int c = 0; c < 3 && t->body[side] >= 0; c++)
                rigid->eq[t->body[side]].impulse[c] +=
                    impulse_of(t, j % 2) * t->along[j % 2][side][c];
    }
}

void rigid_contact_work(struct rigid *rigid)
{
    for (int j = 0; j < 2 * rigid->contact->n; j++) {
        const struct rigid_touch *const t = &rigid->contact->touch[j / 2];
        const int a = t->body[0], b = t->body[1], body = a < 0 ? b : a;
        const double impulse = impulse_of(t, j % 2);
        if (a < 0 || b < 0) {
            rigid->body[body].driven -= impulse * t->wall_speed[j % 2];
            continue;
        }
        double work = 0;
        for (int c = 0; c < 3; c++)
            work += impulse * t->along[j % 2][1][c] * rigid->body[b].mean[c];
        rigid->body[b].passed += work;
        rigid->body[a].passed -= work;
    }
}
