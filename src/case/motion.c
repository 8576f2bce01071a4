/* SPDX-License-Identifier: MIT
 * Prescribed motion: a velocity, a polynomial of time, a table, a sine, a rotation, or expressions
 * in time. */
#include "case/case.h"
#include "base/elementary.h"

#include "case/expr.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Slopes of the monotone cubic (Fritsch and Carlson 1980, with the harmonic mean of Brodlie): no
 * overshoot between rows. Zero at both ends, where the motion starts and ends at rest. */
static void set_slopes(int n, const double *t, const double *d, double *v)
{
    for (int k = 1; k + 1 < n; k++) {
        const double h0 = t[k] - t[k - 1], h1 = t[k + 1] - t[k];
        const double s0 = (d[k] - d[k - 1]) / h0, s1 = (d[k + 1] - d[k]) / h1;
        const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
        v[k] = s0 * s1 > 0 ? (w0 + w1) / (w0 / s0 + w1 / s1) : 0;
    }
}

/* --- the way of a velocity that depends on time --- */

enum { WAY_PIECES = 4096 };

static double velocity_of(const struct scene_motion *m, int c, double t)
{
    const struct expr *const e = m->velocity_in_time.e[c];
    return e ? expr_jet_at(e, t).value : m->velocity[c];
}

/* Gauss-Legendre quadrature with three points, exact for polynomials of order 5. */
static double way_between(const struct scene_motion *m, int c, double from, double to)
{
    const double half = 0.5 * (to - from), middle = 0.5 * (to + from), off = half * sqrt(0.6);
    return half *
           (5 * velocity_of(m, c, middle - off) + 8 * velocity_of(m, c, middle) +
            5 * velocity_of(m, c, middle + off)) /
           9;
}

/* Rows of the way at equal times until the end of the case, so that it is a function of time
 * alone. */
static enum err load_way(struct scene *scene, const struct scene_motion *m,
                         struct scene_table *table, struct diag *d)
{
    const double until_end = min2(scene->top.end_time, m->stop) - m->start;
    const double length = until_end > 0 ? until_end : scene->top.end_time;
    const int n = WAY_PIECES + 1;
    table->t = arena_alloc(&scene->arena, (size_t)n, sizeof *table->t, "motions", d);
    table->x = arena_alloc(&scene->arena, (size_t)n, sizeof *table->x, "motions", d);
    table->y = arena_alloc(&scene->arena, (size_t)n, sizeof *table->y, "motions", d);
    if (!table->t || !table->x || !table->y) return ERR_MEMORY;
    table->n = n;
    for (int k = 1; k < n; k++) {
        table->t[k] = length * k / WAY_PIECES;
        table->x[k] = table->x[k - 1] + way_between(m, 0, table->t[k - 1], table->t[k]);
        table->y[k] = table->y[k - 1] + way_between(m, 1, table->t[k - 1], table->t[k]);
    }
    return ERR_OK;
}

static struct motion_state velocity_at(const struct scene_motion *motion,
                                       const struct scene_table *table, double t)
{
    struct motion_state m = {0};
    for (int c = 0; c < 2; c++) {
        m.v[c] = motion->velocity[c];
        m.d[c] = motion->velocity[c] * t;
    }
    if (table->n == 0) return m;
    const int last = table->n - 1, row = (int)min2(last, floor(t / table->t[last] * last));
    for (int c = 0; c < 2; c++) {
        const struct expr *const e = motion->velocity_in_time.e[c];
        if (!e) continue;
        const struct expr_jet now = expr_jet_at(e, t);
        m.v[c] = now.value;
        m.a[c] = now.d1;
        double from = table->t[row];
        m.d[c] = (c ? table->y : table->x)[row];
        for (; t - from > table->t[1]; from += table->t[1]) /* a run that goes on after the end */
            m.d[c] += way_between(motion, c, from, from + table->t[1]);
        m.d[c] += way_between(motion, c, from, t);
    }
    return m;
}

enum err motion_load(struct scene *scene, struct diag *d)
{
    static const struct table_kind kind = {"a motion", "time (s), dx (m), dy (m)", true};
    scene->motion_data = arena_alloc(&scene->arena, (size_t)scene->n_motion,
                                     sizeof *scene->motion_data, "motions", d);
    if (!scene->motion_data) return ERR_MEMORY;
    enum err bad = ERR_OK;
    for (int k = 0; k < scene->n_motion; k++) {
        const struct scene_motion *m = &scene->motion[k];
        struct scene_table *const table = &scene->motion_data[k];
        const struct scene_expr *const v = &m->velocity_in_time;
        if (m->kind == MOTION_VELOCITY && (v->e[0] || v->e[1])) TRY(load_way(scene, m, table, d));
        const bool tabled = m->kind == MOTION_TABLE || (m->kind == MOTION_ROTATION && *m->file);
        if (!tabled) continue;
        char name[2 * SCENE_NAME];
        snprintf(name, sizeof name, "[motion %s] file", m->common.name);
        const enum err e = table_load(scene, table, &kind, m->file, m->common.line, name, d);
        if (e != ERR_OK && e != ERR_INPUT) return e;
        if (e) bad = e;
        if (e) continue;
        set_slopes(table->n, table->t, table->x, table->vx);
        set_slopes(table->n, table->t, table->y, table->vy);
    }
    return bad;
}

/* --- evaluation --- */

/* c1 t + c2 t^2 + ... with its first two derivatives, by Horner's rule. */
static void polynomial_at(const struct number_list *c, double t, double *d, double *v, double *a)
{
    double p = 0, p1 = 0, p2 = 0;
    for (int k = c->n; k >= 0; k--) {
        p2 = p2 * t + 2 * p1;
        p1 = p1 * t + p;
        p = p * t + (k > 0 ? c->value[k - 1] : 0);
    }
    *d = p;
    *v = p1;
    *a = p2;
}

/* Cubic Hermite between row k and the next. */
static void hermite_at(const double *t, const double *d, const double *v, int k, double time,
                       double *value, double *slope, double *curvature)
{
    const double h = t[k + 1] - t[k], u = (time - t[k]) / h;
    const double jump = d[k + 1] - d[k];
    const double b = 3 * jump - h * (2 * v[k] + v[k + 1]);
    const double c = h * (v[k] + v[k + 1]) - 2 * jump;
    *value = d[k] + u * (h * v[k] + u * (b + u * c));
    *slope = v[k] + u * (2 * b + 3 * u * c) / h;
    *curvature = (2 * b + 6 * u * c) / (h * h);
}

static struct motion_state table_at(const struct scene_table *table, double t)
{
    struct motion_state m = {0};
    const int n = table->n;
    if (n == 0 || t <= table->t[0]) return m;
    if (t >= table->t[n - 1]) {
        m.d[0] = table->x[n - 1];
        m.d[1] = table->y[n - 1];
        return m;
    }
    const int low = table_row(table, t);
    hermite_at(table->t, table->x, table->vx, low, t, &m.d[0], &m.v[0], &m.a[0]);
    hermite_at(table->t, table->y, table->vy, low, t, &m.d[1], &m.v[1], &m.a[1]);
    return m;
}

/* sin(w t + phase) - sin(phase) with its first two derivatives. */
static void sine_at(const struct scene_motion *motion, double t, double *d, double *v, double *a)
{
    const double phase = motion->phase;
    const double w = motion->period > 0 ? 2 * PI / motion->period : 0;
    *d = elementary_sin(w * t + phase) - elementary_sin(phase);
    *v = w * elementary_cos(w * t + phase);
    *a = -w * w * elementary_sin(w * t + phase);
}

static void turning_at(const struct scene_motion *motion, const struct scene_table *table, double t,
                       struct motion_state *m)
{
    double d, v, a;
    sine_at(motion, t, &d, &v, &a);
    polynomial_at(&motion->angle, t, &m->angle, &m->rate, &m->angular_acceleration);
    const struct motion_state tabled = table_at(table, t);
    m->angle += motion->angle_amplitude * d + tabled.d[0];
    m->rate += motion->angle_amplitude * v + tabled.v[0];
    m->angular_acceleration += motion->angle_amplitude * a + tabled.a[0];
    memcpy(m->centre, motion->centre, sizeof m->centre);
}

/* Subtracted so that a body starts where it was sampled, and the derivatives are exact. */
static void expression_at(const struct scene_expr *of, double t, double *d, double *v, double *a)
{
    if (!of->e[0]) return;
    const struct expr_jet now = expr_jet_at(of->e[0], t);
    *d = now.value - expr_jet_at(of->e[0], 0).value;
    *v = now.d1;
    *a = now.d2;
}

static struct motion_state moving_at(const struct scene_motion *motion,
                                     const struct scene_table *table, double t)
{
    struct motion_state m = {0};
    switch ((enum motion_kind)motion->kind) {
    case MOTION_VELOCITY: return velocity_at(motion, table, t);
    case MOTION_POLYNOMIAL:
        polynomial_at(&motion->poly_x, t, &m.d[0], &m.v[0], &m.a[0]);
        polynomial_at(&motion->poly_y, t, &m.d[1], &m.v[1], &m.a[1]);
        return m;
    case MOTION_TABLE: return table_at(table, t);
    case MOTION_SINE:
        for (int c = 0; c < 2; c++) {
            sine_at(motion, t, &m.d[c], &m.v[c], &m.a[c]);
            m.d[c] *= motion->amplitude[c];
            m.v[c] *= motion->amplitude[c];
            m.a[c] *= motion->amplitude[c];
        }
        return m;
    case MOTION_ROTATION: turning_at(motion, table, t, &m); return m;
    case MOTION_EXPRESSION:
        expression_at(&motion->x, t, &m.d[0], &m.v[0], &m.a[0]);
        expression_at(&motion->y, t, &m.d[1], &m.v[1], &m.a[1]);
        expression_at(&motion->turn, t, &m.angle, &m.rate, &m.angular_acceleration);
        memcpy(m.centre, motion->centre, sizeof m.centre);
        return m;
    }
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

static struct motion_state prescribed_at(const struct scene *scene, int motion_index, double time)
{
    struct motion_state m = {0};
    if (motion_index < 0 || motion_index >= scene->n_motion) return m;
    const struct motion_hook *const hook =
        scene->motion_hook ? &scene->motion_hook[motion_index] : NULL;
    if (hook && hook->at) {
        if (time < 0) return m; /* while rest is sought (T-78) */
        hook->at(hook->context, time, m.d, m.v, m.a);
        return m;
    }
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
