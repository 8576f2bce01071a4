/* SPDX-License-Identifier: MIT
 * Prescribed motion: constant velocity, a polynomial of time, a table, a sine, a rotation, or expressions
 * in time. */
#include "case/case.h"

#include "case/expr.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { MAX_ROWS = 1000000 };

/* --- table files: time, dx, dy in columns, commas or spaces between them --- */

struct table_file {
    FILE *file;
    const char *path;
    int line;
    struct diag *diag;
};

/* 1: a row; 0: end of the file; -1: failed, in the diag. Lines that begin with # are comments, and
 * so is a head that begins with a letter. */
static int read_row(struct table_file *t, double row[3])
{
    char text[512];
    /* What fgets does not write stays 1, so the last zero is the one that it has put. */
    while (memset(text, 1, sizeof text), fgets(text, sizeof text, t->file)) {
        t->line++;
        const size_t length = strlen(text);
        if (memchr(text + length + 1, 0, sizeof text - length - 1)) {
            diag_fail(t->diag, ERR_INPUT, "%s:%d: a zero byte; a table is plain text", t->path,
                      t->line);
            return -1;
        }
        const char *at = text + strspn(text, " \t\r\n");
        const bool head =
            t->line == 1 && ((*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z'));
        if (length == sizeof text - 1 && text[length - 1] != '\n') {
            diag_fail(t->diag, ERR_INPUT, "%s:%d: a line of more than %zu characters", t->path,
                      t->line, sizeof text - 2);
            return -1;
        }
        if (!*at || *at == '#' || head) continue;
        for (int k = 0; k < 3; k++) {
            char *end;
            row[k] = strtod(at, &end);
            if (end == at || !isfinite(row[k]) || fabs(row[k]) > 1e9) {
                diag_fail(t->diag, ERR_INPUT,
                          "%s:%d: three numbers are expected: time (s), dx (m), dy (m)", t->path,
                          t->line);
                return -1;
            }
            at = end + strspn(end, " \t\r\n");
            if (*at == ',' || *at == ';') at += 1 + strspn(at + 1, " \t\r\n");
        }
        if (!*at) return 1;
        diag_fail(t->diag, ERR_INPUT,
                  "%s:%d: more than three columns; time (s), dx (m), dy (m) are "
                  "expected",
                  t->path, t->line);
        return -1;
    }
    if (!ferror(t->file)) return 0;
    diag_fail(t->diag, ERR_INPUT, "%s: cannot be read: %s", t->path, strerror(errno));
    return -1;
}

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

static enum err fill_table(struct motion_table *table, struct table_file *t, int rows)
{
    double row[3];
    rewind(t->file);
    t->line = 0;
    for (table->n = 0; table->n < rows; table->n++) {
        const int k = table->n;
        if (read_row(t, row) != 1)
            return diag_fail(t->diag, ERR_INPUT, "%s: changed while it was read", t->path);
        if (k > 0 && row[0] <= table->t[k - 1])
            return diag_fail(t->diag, ERR_INPUT, "%s:%d: time %g s does not come after %g s",
                             t->path, t->line, row[0], table->t[k - 1]);
        if (k == 0 && (row[0] < 0 || row[1] != 0 || row[2] != 0))
            return diag_fail(t->diag, ERR_INPUT,
                             "%s:%d: the first row must be a time of 0 or more "
                             "and no displacement, `0, 0, 0` as a rule",
                             t->path, t->line);
        table->t[k] = row[0];
        table->dx[k] = row[1];
        table->dy[k] = row[2];
    }
    set_slopes(table->n, table->t, table->dx, table->vx);
    set_slopes(table->n, table->t, table->dy, table->vy);
    return ERR_OK;
}

static enum err read_table(struct scene *s, struct motion_table *table, struct table_file *t)
{
    double row[3];
    int rows = 0, more;
    while ((more = read_row(t, row)) > 0)
        if (++rows > MAX_ROWS)
            return diag_fail(t->diag, ERR_INPUT, "%s: more than %d rows", t->path, MAX_ROWS);
    if (more < 0) return ERR_INPUT;
    if (rows < 2)
        return diag_fail(t->diag, ERR_INPUT, "%s: a motion needs two rows or more; there %s %d",
                         t->path, rows == 1 ? "is" : "are", rows);
    double **const columns[] = {&table->t, &table->dx, &table->dy, &table->vx, &table->vy};
    for (size_t k = 0; k < COUNT_OF(columns); k++) {
        *columns[k] =
            arena_alloc(&s->arena, (size_t)rows, sizeof(double), "table of a motion", t->diag);
        if (!*columns[k]) return ERR_MEMORY;
    }
    return fill_table(table, t, rows);
}

enum err motion_load(struct scene *s, struct diag *d)
{
    s->motion_data =
        arena_alloc(&s->arena, (size_t)s->n_motion, sizeof *s->motion_data, "motions", d);
    if (!s->motion_data) return ERR_MEMORY;
    for (int k = 0; k < s->n_motion; k++) {
        const struct scene_motion *m = &s->motion[k];
        const bool tabled = m->kind == MOTION_TABLE || (m->kind == MOTION_ROTATION && *m->file);
        if (!tabled) continue;
        char path[4096 + SCENE_TEXT], place[LOCATION_TEXT];
        scene_location(s, m->common.line, place);
        if (!scene_file(s, m->file, path, sizeof path))
            return diag_fail(d, ERR_INPUT, "%s: the path of %s is too long", place, m->file);
        /* Opening a pipe would wait for whoever writes to it. */
        struct stat info;
        if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
            return diag_fail(d, ERR_INPUT, "%s: [motion %s] file = %s is not a regular file", place,
                             m->common.name, m->file);
        FILE *file = fopen(path, "r");
        if (!file)
            return diag_fail(d, ERR_INPUT, "%s: [motion %s] file = %s cannot be opened: %s", place,
                             m->common.name, m->file, strerror(errno));
        struct table_file t = {file, m->file, 0, d};
        const enum err err = read_table(s, &s->motion_data[k], &t);
        fclose(file);
        if (err) return err;
    }
    return ERR_OK;
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

static struct motion_state table_at(const struct motion_table *table, double t)
{
    struct motion_state m = {0};
    const int n = table->n;
    if (n == 0 || t <= table->t[0]) return m;
    if (t >= table->t[n - 1]) {
        m.d[0] = table->dx[n - 1];
        m.d[1] = table->dy[n - 1];
        return m;
    }
    int low = 0, high = n - 1;
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        if (table->t[middle] <= t)
            low = middle;
        else
            high = middle;
    }
    hermite_at(table->t, table->dx, table->vx, low, t, &m.d[0], &m.v[0], &m.a[0]);
    hermite_at(table->t, table->dy, table->vy, low, t, &m.d[1], &m.v[1], &m.a[1]);
    return m;
}

/* sin(w t + phase) - sin(phase) with its first two derivatives. */
static void sine_at(const struct scene_motion *motion, double t, double *d, double *v, double *a)
{
    const double phase = motion->phase;
    const double w = motion->period > 0 ? 2 * PI / motion->period : 0;
    *d = sin(w * t + phase) - sin(phase);
    *v = w * cos(w * t + phase);
    *a = -w * w * sin(w * t + phase);
}

static void turning_at(const struct scene_motion *motion, const struct motion_table *table,
                       double t, struct motion_state *m)
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

/* So that a body starts where it was sampled, and the derivatives are exact. */
static void expression_at(const struct scene_expr *of, double t, double *d, double *v, double *a)
{
    if (!of->e[0]) return;
    const struct expr_jet now = expr_jet_at(of->e[0], t);
    *d = now.value - expr_jet_at(of->e[0], 0).value;
    *v = now.d1;
    *a = now.d2;
}

static struct motion_state moving_at(const struct scene_motion *motion,
                                     const struct motion_table *table, double t)
{
    struct motion_state m = {0};
    switch ((enum motion_kind)motion->kind) {
    case MOTION_VELOCITY:
        for (int c = 0; c < 2; c++) {
            m.v[c] = motion->velocity[c];
            m.d[c] = motion->velocity[c] * t;
        }
        return m;
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
    const double c = cos(m->angle), s = sin(m->angle);
    const double arm[2] = {c * from[0] - s * from[1], s * from[0] + c * from[1]};
    for (int k = 0; k < 2; k++) {
        const double across = k == 0 ? -arm[1] : arm[0];
        /* So that what does not turn keeps its bits. */
        p.x[k] = m->angle == 0 ? place[k] + m->d[k] : m->centre[k] + arm[k] + m->d[k];
        p.v[k] = m->v[k] + m->rate * across;
        p.a[k] = m->a[k] + m->angular_acceleration * across - m->rate * m->rate * arm[k];
    }
    return p;
}

struct motion_state motion_at(const struct scene *s, int motion_index, double time)
{
    struct motion_state m = {0};
    if (motion_index < 0 || motion_index >= s->n_motion) return m;
    const struct motion_hook *const hook = s->motion_hook ? &s->motion_hook[motion_index] : NULL;
    if (hook && hook->at) {
        hook->at(hook->context, time, m.d, m.v, m.a);
        return m;
    }
    const struct scene_motion *motion = &s->motion[motion_index];
    if (time < motion->start) return m;
    const bool over = time >= motion->stop;
    const double end = over ? motion->stop : time;
    m = moving_at(motion, &s->motion_data[motion_index], end - motion->start);
    if (!over) return m;
    memset(m.v, 0, sizeof m.v);
    memset(m.a, 0, sizeof m.a);
    m.rate = m.angular_acceleration = 0;
    return m;
}
