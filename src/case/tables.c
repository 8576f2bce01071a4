/* SPDX-License-Identifier: MIT
 * Files of tables, and the functions of expressions that they are. */
#include "case/case.h"
#include "base/csv.h"

enum err table_open(const struct scene *scene, struct csv *csv, const char *name)
{
    char path[4096 + SCENE_TEXT];
    csv->path = name;
    if (scene_file(scene, name, path, sizeof path)) return csv_open(csv, path);
    return diag_add(csv->diag, ERR_INPUT, "the path of %s is too long", name);
}

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
    struct csv csv = {
        .columns = columns, .n = given->column, .more = chosen, .limit = 1e15, .diag = &why};
    if (meaning) return bad_section(r, "has the name of %s; rename it", meaning);
    if (slice_identifier(slice_of(name)).length < strlen(name))
        return bad_section(r,
                           "is a function %s(...) of expressions, so its name must be letters, "
                           "digits and _, a letter first",
                           name);
    if (!*given->file) return ERR_OK; /* reported as missing */
    enum err e = table_open(scene, &csv, given->file);
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

/* One whose file is bad is a problem stored already. There are none while [table] is read. */
const struct expr_table *case_function(void *context, const char *name, char why[EXPR_WHY])
{
    struct reader *const r = context;
    const struct scene *const scene = r->scene;
    const int k = scene_find(scene, SECTION_table, name);
    if (k >= 0 && !scene->function) {
        snprintf(why, EXPR_WHY, "a value of a [table] cannot depend on the table `%s`", name);
        return NULL;
    }
    if (k >= 0 && scene->function[k].n > 0) return &scene->function[k];
    r->cause_named |= k >= 0 || r->incomplete;
    struct nearest near = {0};
    for (int j = 0; j < scene->n_table; j++)
        nearest_offer(&near, name, scene->table[j].common.name);
    if (near.name) snprintf(why, EXPR_WHY, "unknown function `%s`%s", name, nearest_hint(&near));
    return NULL;
}
