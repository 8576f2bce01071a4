/* SPDX-License-Identifier: MIT
 * What a case prescribes, at a time: gravity (T-70), motions, and the tables of both. */
#include "geometry/motion.h"
#include "base/elementary.h"

/* The row at or before a time, but not before the first nor the last one. */
static int table_row(const struct timed_table *table, double t)
{
    int low = 0, high = table->n - 1;
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        if (table->t[middle] <= t)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* --- gravity --- */

bool scene_gravity_varies(const struct scene *scene)
{
    const struct scene_expr *const e = &scene->top.gravity_in_time;
    return e->e[0] || e->e[1] || scene->gravity_data.n > 0;
}

void scene_gravity_at(const struct scene *scene, double t, double g[2])
{
    const struct timed_table *const table = &scene->gravity_data;
    t = max2(t, 0); /* while rest is sought (T-78) */
    for (int c = 0; c < 2; c++) {
        const struct expr *const e = scene->top.gravity_in_time.e[c];
        g[c] = e ? expr_at(e, t, 0) : scene->top.gravity[c];
    }
    if (table->n == 0) return;
    const int k = table_row(table, t);
    const double fraction = (t - table->t[k]) / (table->t[k + 1] - table->t[k]);
    const double u =
        min2(max2(fraction, 0), 1); /* constant before its first and after its last row */
    g[0] += table->x[k] + u * (table->x[k + 1] - table->x[k]);
    g[1] += table->y[k] + u * (table->y[k + 1] - table->y[k]);
}

/* --- motions: displacements or angles with their first two derivatives --- */

static struct expr_jet velocity_at(const struct scene_motion *motion,
                                   const struct timed_table *table, int c, double t)
{
    const struct expr *const e = motion->velocity_in_time.e[c];
    if (!e) return (struct expr_jet){motion->velocity[c] * t, motion->velocity[c], 0};
    const struct expr_jet now = expr_jet_at(e, t);
    const int last = table->n - 1, row = (int)min2(last, floor(t / table->t[last] * last));
    double from = table->t[row], d = (c ? table->y : table->x)[row];
    for (; t - from > table->t[1]; from += table->t[1]) /* a run that goes on after the end */
        d += expr_integral(e, from, from + table->t[1]);
    return (struct expr_jet){d + expr_integral(e, from, t), now.value, now.d1};
}

/* c1 t + c2 t^2 + ... by Horner's rule. */
static struct expr_jet polynomial_at(const struct number_list *c, double t)
{
    struct expr_jet p = {0, 0, 0};
    for (int k = c->n; k >= 0; k--) {
        p.d2 = p.d2 * t + 2 * p.d1;
        p.d1 = p.d1 * t + p.value;
        p.value = p.value * t + (k > 0 ? c->value[k - 1] : 0);
    }
    return p;
}

/* Cubic Hermite between two rows of a column; at rest before the first and after the last row. */
static struct expr_jet table_at(const struct timed_table *table, int column, double time)
{
    const double *const t = table->t, *const d = column ? table->y : table->x,
                        *const v = column ? table->vy : table->vx;
    const int last = table->n - 1;
    if (last < 0 || time <= t[0]) return (struct expr_jet){0, 0, 0};
    if (time >= t[last]) return (struct expr_jet){d[last], 0, 0};
    const int k = table_row(table, time);
    const double h = t[k + 1] - t[k], u = (time - t[k]) / h, jump = d[k + 1] - d[k];
    const double b = 3 * jump - h * (2 * v[k] + v[k + 1]);
    const double c = h * (v[k] + v[k + 1]) - 2 * jump;
    return (struct expr_jet){d[k] + u * (h * v[k] + u * (b + u * c)),
                             v[k] + u * (2 * b + 3 * u * c) / h, (2 * b + 6 * u * c) / (h * h)};
}

/* A (sin(w t + phase) - sin(phase)). */
static struct expr_jet sine_at(const struct scene_motion *motion, double amplitude, double t)
{
    const double w = motion->period > 0 ? 2 * PI / motion->period : 0,
                 phase = w * t + motion->phase;
    return (struct expr_jet){amplitude * (elementary_sin(phase) - elementary_sin(motion->phase)),
                             amplitude * (w * elementary_cos(phase)),
                             amplitude * (-w * w * elementary_sin(phase))};
}

static struct expr_jet turning_at(const struct scene_motion *motion,
                                  const struct timed_table *table, double t)
{
    const struct expr_jet p = polynomial_at(&motion->angle, t), tabled = table_at(table, 0, t),
                          s = sine_at(motion, motion->angle_amplitude, t);
    return (struct expr_jet){p.value + (s.value + tabled.value), p.d1 + (s.d1 + tabled.d1),
                             p.d2 + (s.d2 + tabled.d2)};
}

/* Its value at t = 0 is subtracted, so that a body starts where it was sampled. */
static struct expr_jet expression_at(const struct scene_expr *of, double t)
{
    if (!of->e[0]) return (struct expr_jet){0, 0, 0};
    struct expr_jet now = expr_jet_at(of->e[0], t);
    now.value -= expr_jet_at(of->e[0], 0).value;
    return now;
}

static struct motion_state moving_at(const struct scene_motion *motion,
                                     const struct timed_table *table, double t)
{
    struct motion_state m = {0};
    struct expr_jet d[2] = {{0, 0, 0}, {0, 0, 0}}, angle = {0, 0, 0};
    for (int c = 0; c < 2; c++) switch ((enum motion_kind)motion->kind) {
        case MOTION_VELOCITY: d[c] = velocity_at(motion, table, c, t); break;
        case MOTION_POLYNOMIAL:
            d[c] = polynomial_at(c ? &motion->poly_y : &motion->poly_x, t);
            break;
        case MOTION_TABLE: d[c] = table_at(table, c, t); break;
        case MOTION_SINE: d[c] = sine_at(motion, motion->amplitude[c], t); break;
        case MOTION_ROTATION: angle = turning_at(motion, table, t); break;
        case MOTION_EXPRESSION:
            d[c] = expression_at(c ? &motion->y : &motion->x, t);
            angle = expression_at(&motion->turn, t);
            break;
        }
    for (int c = 0; c < 2; c++) {
        m.d[c] = d[c].value;
        m.v[c] = d[c].d1;
        m.a[c] = d[c].d2;
        m.centre[c] = motion->centre[c];
    }
    m.angle = angle.value;
    m.rate = angle.d1;
    m.angular_acceleration = angle.d2;
    return m;
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
    if (hook && hook->at) {
        if (time >= 0)
            hook->at(hook->context, time, m.d, m.v, m.a); /* < 0: rest is sought (T-78) */
        return m;
    }
    if (motion_index >= scene_rigid_motion(scene, 0))
        return rigid_at(&scene->rigid_motion[motion_index - scene_rigid_motion(scene, 0)], time);
    const struct scene_motion *motion = &scene->motion[motion_index];
    if (time < motion->start) return m;
    const bool over = time >= motion->stop;
    const double end = over ? motion->stop : time;
    m = moving_at(motion, &scene->motion_data[motion_index], end - motion->start);
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
