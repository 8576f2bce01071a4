/* SPDX-License-Identifier: MIT
 * Tables of a case: rows of a time and two values. */
#include "case/case.h"

#include "base/csv.h"

#include <math.h>
#include <stdio.h>

enum err table_open(const struct scene *scene, struct csv *csv, const char *name, int line,
                    const char *key, struct diag *d)
{
    char path[4096 + SCENE_TEXT], place[LOCATION_TEXT];
    struct diag why = {.code = ERR_OK};
    scene_location(scene, line, place);
    if (!scene_file(scene, name, path, sizeof path))
        return diag_add(d, ERR_INPUT, "%s: the path of %s is too long", place, name);
    csv->path = name;
    csv->diag = &why;
    const enum err e = csv_open(csv, path);
    csv->diag = d;
    if (e && csv->text) return diag_add(d, e, "%s", why.text);
    if (e)
        return diag_add(d, e == ERR_MEMORY ? e : ERR_INPUT, "%s: %s: %.400s", place, key, why.text);
    return ERR_OK;
}

enum err table_allocate(struct scene *scene, struct scene_table *table, int rows, struct diag *d)
{
    double **const columns[] = {&table->t, &table->x, &table->y, &table->vx, &table->vy};
    for (size_t k = 0; k < COUNT_OF(columns); k++) {
        *columns[k] = arena_alloc(&scene->arena, (size_t)rows, sizeof(double), "table", d);
        if (!*columns[k]) return ERR_MEMORY;
    }
    return ERR_OK;
}

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

enum err table_load(struct scene *scene, struct scene_table *table, const struct table_kind *kind,
                    const char *name, int line, const char *key, struct diag *d)
{
    struct csv csv = {.columns = kind->columns, .n = 3, .limit = 1e9};
    enum err e = table_open(scene, &csv, name, line, key, d);
    if (!e) e = read_table(scene, table, kind, &csv);
    csv_close(&csv);
    return e;
}

int table_row(const struct scene_table *table, double t)
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
