/* SPDX-License-Identifier: MIT
 * Tables of gravity and of motions: from files, or the path of a velocity that depends on time. */
#include "case/case.h"
#include "base/csv.h"

enum err table_open(const struct scene *scene, struct csv *csv, const char *name, int line,
                    const char *key, struct diag *d)
{
    char path[4096 + SCENE_TEXT];
    struct diag why = {.code = ERR_OK};
    if (!scene_file(scene, name, path, sizeof path))
        return fail_at(d, scene, line, "the path of %s is too long", name);
    csv->path = name;
    csv->diag = &why;
    const enum err e = csv_open(csv, path);
    csv->diag = d;
    if (e && csv->text) return diag_add(d, e, "%s", why.text);
    if (e)
        return diag_add(d, e == ERR_MEMORY ? e : ERR_INPUT, "%s: %s: %.400s",
                        scene_place(scene, line).text, key, why.text);
    return ERR_OK;
}

/* Columns for a number of rows. */
static enum err table_allocate(struct scene *scene, struct scene_table *table, int rows,
                               struct diag *d)
{
    double **const columns[] = {&table->t, &table->x, &table->y, &table->vx, &table->vy};
    for (size_t k = 0; k < COUNT_OF(columns); k++)
        TRY(arena_array(&scene->arena, columns[k], rows, "table", d));
    return ERR_OK;
}

/* `what` it is of, with its columns; of a motion: its first row is zero. */
struct table_kind {
    const char *what, *columns;
    bool from_rest;
};

static enum err read_table(struct scene *scene, struct scene_table *table,
                           const struct table_kind *kind, struct csv *csv)
{
    double row[3];
    int more;
    TRY(table_allocate(scene, table, csv->lines, csv->diag));
    for (; (more = csv_row(csv, row)) > 0; table->n++) {
        const int k = table->n;
        if (k > 0 && row[0] <= table->t[k - 1])
            return diag_add(csv->diag, ERR_INPUT,
                            "%s:%d: times must increase, but %g s follows %g s", csv->path,
                            csv->line, row[0], table->t[k - 1]);
        if (k == 0 && kind->from_rest && (row[0] < 0 || row[1] != 0 || row[2] != 0))
            return diag_add(csv->diag, ERR_INPUT,
                            "%s:%d: the first row must have a time of 0 or later and no "
                            "displacement, usually `0, 0, 0`",
                            csv->path, csv->line);
        table->t[k] = row[0];
        table->x[k] = row[1];
        table->y[k] = row[2];
    }
    if (more == 0 && table->n < 2)
        return diag_add(csv->diag, ERR_INPUT, "%s: %s needs two rows or more; there %s %d",
                        csv->path, kind->what, table->n == 1 ? "is" : "are", table->n);
    return more < 0 ? ERR_INPUT : ERR_OK;
}

static enum err table_load(struct scene *scene, struct scene_table *table,
                           const struct table_kind *kind, const char *name, int line,
                           const char *key, struct diag *d)
{
    struct csv csv = {.columns = kind->columns, .n = 3, .limit = 1e9};
    enum err e = table_open(scene, &csv, name, line, key, d);
    if (!e) e = read_table(scene, table, kind, &csv);
    csv_close(&csv);
    return e;
}

/* --- tables of motions --- */

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

/* --- the path of a velocity that depends on time --- */

enum { PATH_PIECES = 4096 };

/* Rows of the path at equal times until the end of the case, so that it is a function of time
 * alone. */
static enum err load_path(struct scene *scene, const struct scene_motion *m,
                          struct scene_table *table, struct diag *d)
{
    const double until_end = min2(scene->top.end_time, m->stop) - m->start;
    const double length = until_end > 0 ? until_end : scene->top.end_time;
    TRY(table_allocate(scene, table, PATH_PIECES + 1, d));
    table->n = PATH_PIECES + 1;
    for (int k = 1; k < table->n; k++) {
        table->t[k] = length * k / PATH_PIECES;
        for (int c = 0; c < 2; c++) {
            const struct expr *const e = m->velocity_in_time.e[c];
            double *const path = c ? table->y : table->x;
            if (e) path[k] = path[k - 1] + expr_integral(e, table->t[k - 1], table->t[k]);
        }
    }
    return ERR_OK;
}

/* Gravity is one table, each motion another; problems of all of them are reported together. */
enum err case_load_tables(struct scene *scene, struct diag *d)
{
    static const struct table_kind gravity = {"a table of gravity",
                                              "time (s), gx (m/s^2), gy (m/s^2)", false},
                                   moved = {"a motion", "time (s), dx (m), dy (m)", true};
    TRY(arena_array(&scene->arena, &scene->motion_data, scene->n_motion, "motions", d));
    enum err bad = ERR_OK;
    if (*scene->top.gravity_file)
        bad = table_load(scene, &scene->gravity_data, &gravity, scene->top.gravity_file,
                         scene_line(scene, SECTION_top, 0, "gravity_file"), "gravity_file", d);
    for (int k = 0; k < scene->n_motion && (!bad || bad == ERR_INPUT); k++) {
        const struct scene_motion *const m = &scene->motion[k];
        struct scene_table *const table = &scene->motion_data[k];
        const struct scene_expr *const v = &m->velocity_in_time;
        if (m->kind == MOTION_VELOCITY && (v->e[0] || v->e[1])) TRY(load_path(scene, m, table, d));
        if (!*m->file) continue; /* of a table or a rotation */
        char name[2 * SCENE_NAME];
        snprintf(name, sizeof name, "[motion %s] file", m->common.name);
        const enum err e = table_load(scene, table, &moved, m->file, m->common.line, name, d);
        if (e) bad = e;
        if (e) continue;
        set_slopes(table->n, table->t, table->x, table->vx);
        set_slopes(table->n, table->t, table->y, table->vy);
    }
    return bad;
}
