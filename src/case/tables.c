/* SPDX-License-Identifier: MIT
 * Tables: functions of expressions; gravity and motions from files, or the path of a velocity that
 * depends on time. */
#include "case/case.h"
#include "base/csv.h"

/* Messages are in the diag of csv. */
static enum err open_file(const struct scene *scene, struct csv *csv, const char *name)
{
    char path[4096 + SCENE_TEXT];
    csv->path = name;
    if (scene_file(scene, name, path, sizeof path)) return csv_open(csv, path);
    return diag_add(csv->diag, ERR_INPUT, "the path of %s is too long", name);
}

/* --- functions --- */

static enum err read_rows(struct scene *scene, struct expr_table *table, struct csv *csv)
{
    double row[CSV_COLUMNS];
    int more;
    TRY(arena_array(&scene->arena, &table->x, csv->lines, "table", csv->diag));
    TRY(arena_array(&scene->arena, &table->y, csv->lines, "table", csv->diag));
    int n = 0;
    for (; (more = csv_row(csv, row)) > 0; n++) {
        if (n > 0 && row[0] <= table->x[n - 1])
            return diag_add(csv->diag, ERR_INPUT,
                            "%s:%d: the first column must increase, but %g follows %g", csv->path,
                            csv->line, row[0], table->x[n - 1]);
        table->x[n] = row[0];
        table->y[n] = row[csv->n - 1];
    }
    if (more < 0) return ERR_INPUT;
    if (n < 2)
        return diag_add(csv->diag, ERR_INPUT, "%s: a table needs two rows or more; there %s %d",
                        csv->path, n == 1 ? "is" : "are", n);
    table->n = n;
    return ERR_OK;
}

static enum err load_function(struct reader *r, int k)
{
    struct scene *const scene = r->scene;
    const struct scene_table *const given = r->section = &scene->table[k];
    struct expr_table *const table = &scene->function[k];
    const char *const name = given->common.name, *const meaning = expr_reserved(name);
    const bool chosen = scene_given(scene, SECTION_table, k, "column");
    struct diag why = {.code = ERR_OK};
    char columns[64] = "argument, value (or `column = 3`)";
    if (chosen) snprintf(columns, sizeof columns, "argument, value in column %d", given->column);
    struct csv csv = {.columns = columns,
                      .n = given->column,
                      .more = chosen,
                      .limit = 1e15,
                      .diag = &why};
    if (meaning) return bad_section(r, "has the name of %s; rename it", meaning);
    if (slice_identifier(slice_of(name)).length < strlen(name))
        return bad_section(r, "is a function %s(...) of expressions, so its name must be letters, "
                              "digits and _, a letter first",
                           name);
    if (!*given->file) return ERR_OK; /* reported as missing */
    enum err e = open_file(scene, &csv, given->file);
    if (!e) e = read_rows(scene, table, &csv);
    csv_close(&csv);
    if (e == ERR_MEMORY) return diag_add(r->diag, e, "%s", why.text);
    if (e) return bad_key(r, "file", NULL, "file: %.400s", why.text);
    if (!given->between) return ERR_OK;
    TRY(arena_array(&scene->arena, &table->slope, table->n, "table", r->diag));
    expr_table_smooth(table);
    return ERR_OK;
}

enum err case_load_functions(struct reader *r)
{
    const int n = r->scene->n_table;
    TRY(arena_array(&r->scene->arena, &r->scene->function, n, "tables", r->diag));
    for (int k = 0; k < n; k++) TRY(case_go_on(r, load_function(r, k)));
    return ERR_OK;
}

/* One whose file is bad is a problem that is stored already. */
const struct expr_table *case_function(void *context, const char *name, char why[EXPR_WHY])
{
    struct reader *const r = context;
    const struct scene *const scene = r->scene;
    const int k = scene_find(scene, SECTION_table, name);
    if (k >= 0 && scene->function[k].n > 0) return &scene->function[k];
    r->cause_named |= k >= 0 || r->incomplete;
    struct nearest near = {0};
    for (int j = 0; j < scene->n_table; j++)
        nearest_offer(&near, name, scene->table[j].common.name);
    if (near.name) snprintf(why, EXPR_WHY, "unknown function `%s`%s", name, nearest_hint(&near));
    return NULL;
}

/* --- gravity and motions --- */

enum err table_open(const struct scene *scene, struct csv *csv, const char *name, int line,
                    const char *key, struct diag *d)
{
    struct diag why = {.code = ERR_OK};
    csv->diag = &why;
    const enum err e = open_file(scene, csv, name);
    csv->diag = d;
    if (e && csv->text) return diag_add(d, e, "%s", why.text);
    if (e)
        return diag_add(d, e == ERR_MEMORY ? e : ERR_INPUT, "%s: %s: %.400s",
                        scene_place(scene, line).text, key, why.text);
    return ERR_OK;
}

/* Columns for a number of rows. */
static enum err table_allocate(struct scene *scene, struct timed_table *table, int rows,
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

static enum err read_table(struct scene *scene, struct timed_table *table,
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

static enum err table_load(struct scene *scene, struct timed_table *table,
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
                          struct timed_table *table, struct diag *d)
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
        struct timed_table *const table = &scene->motion_data[k];
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
