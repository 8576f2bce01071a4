/* SPDX-License-Identifier: MIT
 * What a case prescribes, at a time: gravity (T-70) and motions. */
#include "geometry/motion.h"
#include "base/elementary.h"

bool scene_gravity_varies(const struct scene *scene)
{
    const struct scene_expr *const e = &scene->top.gravity_in_time;
    return e->e[0] || e->e[1];
}

void scene_gravity_at(const struct scene *scene, double t, double g[2])
{
    for (int c = 0; c < 2; c++) {
        const struct expr *const e = scene->top.gravity_in_time.e[c];
        g[c] = e ? expr_at_arg(e, max2(t, 0)) : scene->top.gravity[c]; /* < 0: T-78 seeks rest */
    }
}

/* --- motions --- */

/* The displacement at t = 0 is subtracted, so that a body starts where it was sampled. */
static struct expr_jet displacement_at(const struct scene_expr *of, double t)
{
    if (!of->e[0]) return (struct expr_jet){0, 0, 0};
    struct expr_jet now = expr_jet_at(of->e[0], t);
    now.value -= expr_jet_at(of->e[0], 0).value;
    return now;
}

static struct motion_state moving_at(const struct scene_motion *motion, double t)
{
    const struct expr_jet x = displacement_at(&motion->x, t), y = displacement_at(&motion->y, t),
                          turn = displacement_at(&motion->turn, t);
    return (struct motion_state){.d = {x.value, y.value},
                                 .v = {x.d1, y.d1},
                                 .a = {x.d2, y.d2},
                                 .centre = {motion->centre[0], motion->centre[1]},
                                 .angle = turn.value,
                                 .rate = turn.d1,
                                 .angular_acceleration = turn.d2};
}

struct motion_point motion_of_point(const struct motion_state *m, double X, double Y)
{
    struct motion_point p;
    const double from[2] = {X - m->centre[0], Y - m->centre[1]}, place[2] = {X, Y};
    const double c = m->turn[0], s = m->turn[1];
    const double arm[2] = {c * from[0] - s * from[1], s * from[0] + c * from[1]};
    for (int k = 0; k < 2; k++) {
        const double across = k == 0 ? -arm[1] : arm[0];
        /* Without rotation the bits do not change. */
        p.x[k] = m->angle == 0 ? place[k] + m->d[k] : m->centre[k] + arm[k] + m->d[k];
        p.v[k] = m->v[k] + m->rate * across;
        p.a[k] = m->a[k] + m->angular_acceleration * across - m->rate * m->rate * arm[k];
    }
    return p;
}

/* A rigid body keeps its accelerations within a step. */
static struct motion_state rigid_at(const struct rigid_motion *rigid, double time)
{
    struct motion_state m = rigid->now;
    const double since = time - rigid->time;
    for (int c = 0; c < 2; c++) {
        m.d[c] += since * (m.v[c] + 0.5 * since * m.a[c]);
        m.v[c] += since * m.a[c];
    }
    m.angle += since * (m.rate + 0.5 * since * m.angular_acceleration);
    m.rate += since * m.angular_acceleration;
    return m;
}

static struct motion_state prescribed_at(const struct scene *scene, int motion_index, double time)
{
    struct motion_state m = {0};
    if (motion_index < 0 || motion_index >= scene->n_motion) return m;
    const struct motion_hook *const hook =
        scene->motion_hook ? &scene->motion_hook[motion_index] : NULL;
    if (hook && hook->move) {
        if (time >= 0)
            hook->move(hook->context, time, m.d, m.v, m.a); /* < 0: rest is sought (T-78) */
        return m;
    }
    if (motion_index >= scene_rigid_motion(scene, 0))
        return rigid_at(&scene->rigid_motion[motion_index - scene_rigid_motion(scene, 0)], time);
    const struct scene_motion *motion = &scene->motion[motion_index];
    if (time < motion->start) return m;
    const bool over = time >= motion->stop;
    const double end = over ? motion->stop : time;
    m = moving_at(motion, end - motion->start);
    if (!over) return m;
    memset(m.v, 0, sizeof m.v);
    memset(m.a, 0, sizeof m.a);
    m.rate = m.angular_acceleration = 0;
    return m;
}

struct motion_state motion_at(const struct scene *scene, int motion_index, double time)
{
    struct motion_state m = prescribed_at(scene, motion_index, time);
    m.turn[0] = elementary_cos(m.angle);
    m.turn[1] = elementary_sin(m.angle);
    return m;
}

void motion_initial(const struct motion_state *m, const double x[2], double X[2])
{
    const double dx = x[0] - m->d[0] - m->centre[0], dy = x[1] - m->d[1] - m->centre[1];
    X[0] = m->centre[0] + m->turn[0] * dx + m->turn[1] * dy;
    X[1] = m->centre[1] - m->turn[1] * dx + m->turn[0] * dy;
}
