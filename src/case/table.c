/* SPDX-License-Identifier: MIT
 * Tables of a case: rows of a time and two values. */
#include "case/case.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { MAX_ROWS = 1000000 };

/* A table this many times as long as the run has mostly another unit of time. */
enum { LONG_TABLE = 100 };

/* The columns are separated by commas or blanks. */

struct table_file {
    FILE *file;
    const char *path;
    int line;
    const struct table_kind *kind;
    struct diag *diag;
};

static bool decimal_comma(const char *text)
{
    for (const char *c = text; (c = strchr(c, ',')) != NULL; c++)
        if (c > text && c[-1] >= '0' && c[-1] <= '9' && c[1] >= '0' && c[1] <= '9') return true;
    return false;
}

/* 1: a row; 0: end of the file; -1: failed, in the diag. Lines that begin with # are comments, and
 * so is a header that begins with a letter. */
static int read_row(struct table_file *t, double row[3])
{
    char text[512];
    /* Bytes that fgets does not write stay 1, so the last zero is the terminating one. */
    while (memset(text, 1, sizeof text), fgets(text, sizeof text, t->file)) {
        t->line++;
        const size_t length = strlen(text);
        if (memchr(text + length + 1, 0, sizeof text - length - 1)) {
            diag_add(t->diag, ERR_INPUT, "%s:%d: a zero byte; a table is plain text%s", t->path,
                     t->line,
                     strncmp(text, "\xFF\xFE", 2) == 0 || strncmp(text, "\xFE\xFF", 2) == 0
                         ? ", not UTF-16: save it as UTF-8"
                         : "");
            return -1;
        }
        const char *at = text + strspn(text, " \t\r\n");
        const bool head =
            t->line == 1 && ((*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z'));
        if (length == sizeof text - 1 && text[length - 1] != '\n') {
            diag_add(t->diag, ERR_INPUT, "%s:%d: the line has more than %zu characters", t->path,
                     t->line, sizeof text - 2);
            return -1;
        }
        if (!*at || *at == '#' || head) continue;
        /* 0,5;1 has two columns for one reader, three for another. */
        if (decimal_comma(at) && (strchr(at, ';') || strchr(at, '\t'))) {
            diag_add(t->diag, ERR_INPUT,
                     "%s:%d: commas and %s: if a comma stands for a decimal point, write a point, "
                     "as in 0.5; if not, separate the columns by one of the two",
                     t->path, t->line, strchr(at, ';') ? "semicolons" : "tabs");
            return -1;
        }
        for (int k = 0; k < 3; k++) {
            char *end;
            row[k] = strtod(at, &end);
            if (end == at || !isfinite(row[k]) || fabs(row[k]) > 1e9) {
                diag_add(t->diag, ERR_INPUT, "%s:%d: three numbers are expected: %s", t->path,
                         t->line, t->kind->columns);
                return -1;
            }
            at = end + strspn(end, " \t\r\n");
            if (*at == ',' || *at == ';') at += 1 + strspn(at + 1, " \t\r\n");
        }
        if (!*at) return 1;
        diag_add(t->diag, ERR_INPUT, "%s:%d: more than three columns; %s are expected", t->path,
                 t->line, t->kind->columns);
        return -1;
    }
    if (!ferror(t->file)) return 0;
    diag_add(t->diag, ERR_INPUT, "%s: cannot be read: %s", t->path, strerror(errno));
    return -1;
}

static enum err fill_table(struct scene_table *table, struct table_file *t, int rows)
{
    double row[3];
    rewind(t->file);
    t->line = 0;
    for (table->n = 0; table->n < rows; table->n++) {
        const int k = table->n;
        if (read_row(t, row) != 1)
            return diag_add(t->diag, ERR_INPUT, "%s: changed while it was read", t->path);
        if (k > 0 && row[0] <= table->t[k - 1])
            return diag_add(t->diag, ERR_INPUT, "%s:%d: times must increase, but %g s follows %g s",
                            t->path, t->line, row[0], table->t[k - 1]);
        if (k == 0 && t->kind->from_rest && (row[0] < 0 || row[1] != 0 || row[2] != 0))
            return diag_add(t->diag, ERR_INPUT,
                            "%s:%d: the first row must have a time of 0 or later and no "
                            "displacement, usually `0, 0, 0`",
                            t->path, t->line);
        table->t[k] = row[0];
        table->x[k] = row[1];
        table->y[k] = row[2];
    }
    return ERR_OK;
}

static enum err read_table(struct scene *s, struct scene_table *table, struct table_file *t)
{
    double row[3];
    int rows = 0, more;
    while ((more = read_row(t, row)) > 0)
        if (++rows > MAX_ROWS)
            return diag_add(t->diag, ERR_INPUT, "%s: more than %d rows; use fewer", t->path,
                            MAX_ROWS);
    if (more < 0) return ERR_INPUT;
    if (rows < 2)
        return diag_add(t->diag, ERR_INPUT, "%s: %s needs two rows or more; there %s %d", t->path,
                        t->kind->what, rows == 1 ? "is" : "are", rows);
    double **const columns[] = {&table->t, &table->x, &table->y, &table->vx, &table->vy};
    for (size_t k = 0; k < COUNT_OF(columns); k++) {
        *columns[k] = arena_alloc(&s->arena, (size_t)rows, sizeof(double), "table", t->diag);
        if (!*columns[k]) return ERR_MEMORY;
    }
    return fill_table(table, t, rows);
}

enum err table_load(struct scene *s, struct scene_table *table, const struct table_kind *kind,
                    const char *name, int line, const char *key, struct diag *d)
{
    char path[4096 + SCENE_TEXT], place[LOCATION_TEXT];
    scene_location(s, line, place);
    if (!scene_file(s, name, path, sizeof path))
        return diag_add(d, ERR_INPUT, "%s: the path of %s is too long", place, name);
    /* Opening a pipe would wait for its writer. */
    struct stat info;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return diag_add(d, ERR_INPUT, "%s: %s = %s is not a regular file", place, key, name);
    FILE *file = fopen(path, "r");
    if (!file)
        return diag_add(d, ERR_INPUT, "%s: %s = %s cannot be opened: %s", place, key, name,
                        strerror(errno));
    struct table_file t = {file, name, 0, kind, d};
    const enum err err = read_table(s, table, &t);
    fclose(file);
    const double last = err ? 0 : table->t[table->n - 1];
    if (last > LONG_TABLE * s->top.end_time)
        diag_warn(d,
                  "%s: %s = %.200s lasts until t = %g s, of which the run uses the first %g s "
                  "(end_time): its times are in seconds, not in milliseconds",
                  place, key, name, last, s->top.end_time);
    return err;
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
