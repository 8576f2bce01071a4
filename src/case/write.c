/* SPDX-License-Identifier: MIT
 * The effective case: all values in SI units, constants evaluated. */
#include "case/case.h"
#include "base/csv.h"
#include "base/hash.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdlib.h>

#ifndef SPHFSI_VERSION
#define SPHFSI_VERSION "(unversioned build)"
#endif

static void write_real(FILE *out, const char *before, double value)
{
    char text[NUMBER_TEXT];
    number_text(text, value);
    fprintf(out, "%s%s", before, text);
}

static void write_number(FILE *out, double value, const char *unit)
{
    const bool bare = !unit || strcmp(unit, "1") == 0 || strcmp(unit, "SI") == 0;
    write_real(out, "", value);
    if (!bare) fprintf(out, " %s", strncmp(unit, "1/", 2) == 0 ? unit + 1 : unit);
}

static void write_reals(FILE *out, int n, const double *value)
{
    for (int k = 0; k < n; k++) write_real(out, k ? ", " : "", value[k]);
}

static void write_text(FILE *out, const char *text)
{
    const size_t length = strlen(text);
    const bool quoted =
        !length || strchr(text, '#') || strchr(" \t\"", text[0]) || strchr(" \t", text[length - 1]);
    fprintf(out, quoted ? "\"%s\"" : "%s", text);
}

static void write_shape(FILE *out, const char *key, const struct shape *s)
{
    const bool filled = s->bare && s->kind == SHAPE_POLYGON; /* a line without its last point */
    fprintf(out, "%s = %s%s", key, shape_words[filled ? SHAPE_POLYLINE : s->kind],
            s->bare ? ": " : " ");
    if (s->kind == SHAPE_BOX) {
        write_reals(out, 4, s->pt[0]);
    } else if (s->kind == SHAPE_CIRCLE) {
        write_reals(out, 3, (const double[]){s->pt[0][0], s->pt[0][1], s->size});
    } else {
        const bool band = s->kind == SHAPE_POLYLINE && !s->bare;
        if (band) write_real(out, "thickness ", s->size);
        if (band) fputs(": ", out);
        for (int k = 0; k < s->n + filled; k++) {
            write_real(out, k ? "; " : "", s->pt[k][0]);
            write_real(out, ", ", s->pt[k][1]);
        }
    }
    fprintf(out, "\n");
}

/* The folder of a path with all links resolved and a / at its end; false: it cannot be found. */
static bool real_directory(const char *path, char folder[PATH_MAX])
{
    char head[PATH_MAX];
    const char *const slash = strrchr(path, '/');
    snprintf(head, sizeof head, "%.*s", slash ? (int)(slash - path) + 1 : 1, slash ? path : ".");
    if (!realpath(head, folder) || strlen(folder) + 2 > PATH_MAX) return false;
    if (strcmp(folder, "/") != 0) strcat(folder, "/");
    return true;
}

/* A file given relative to the case, as a path relative to the folder of the effective case; for
 * the standard output, which has none, an absolute one. */
static void relocate(const struct scene *scene, const char *name, const char *path,
                     char moved[2 * PATH_MAX])
{
    char file[PATH_MAX], there[PATH_MAX], here[PATH_MAX];
    const char *const slash = strrchr(name, '/');
    size_t common = 0, n = 0;
    if (!*name || name[0] == '/' || !scene_file(scene, name, file, sizeof file) ||
        !real_directory(file, there) || !real_directory(path, here))
        return;
    if (strncmp(path, "/dev/", 5) == 0) *here = '\0';
    for (size_t k = 0; here[k] && here[k] == there[k]; k++)
        if (here[k] == '/') common = k + 1;
    for (const char *c = here + common; (c = strchr(c, '/')) != NULL && n < PATH_MAX; c++)
        n += (size_t)snprintf(moved + n, 2 * PATH_MAX - n, "../");
    snprintf(moved + n, 2 * PATH_MAX - n, "%s%s", there + common, slash ? slash + 1 : name);
}

static void write_param(FILE *out, const struct scene *scene, const struct param *param,
                        const char *section, const char *path)
{
    const void *const value = section + param->offset;
    const double *const number = value;
    const struct shape_list *const shapes = value;
    const struct hinge_list *const hinges = value;
    char text[2 * PATH_MAX];
    const bool may_be_absent =
        param->type > PARAM_VECTOR || isnan(param->number.value) || isnan(param->vector_default[0]);
    if (may_be_absent && param_is_default(param, section)) return;
    if (!param_repeats(param)) fprintf(out, "%s = ", param->key);
    switch (param->type) {
    case PARAM_REAL: write_number(out, *number, param->unit); break;
    case PARAM_INTEGER: fprintf(out, "%d", *(const int *)value); break;
    case PARAM_CHOICE: fputs(param_choice(param, *(const int *)value).text, out); break;
    case PARAM_TEXT:
        snprintf(text, sizeof text, "%s", (const char *)value);
        if (strcmp(param->key, "file") == 0) relocate(scene, value, path, text);
        write_text(out, text);
        break;
    case PARAM_VECTOR:
    case PARAM_EXPR:
        for (int k = 0; k < param->count; k++) {
            const struct expr *const e = param_expr(param, section, k);
            fputs(k ? ", " : "", out);
            if (e)
                fputs(expr_source(e), out);
            else
                write_number(out, number[k], param->unit);
        }
        break;
    case PARAM_SHAPES:
        for (int k = 0; k < shapes->n; k++) write_shape(out, param->key, &shapes->item[k]);
        return;
    case PARAM_HINGES:
        for (int k = 0; k < hinges->n; k++) {
            fprintf(out, "%s = ", param->key);
            write_reals(out, 2, hinges->item[k].at);
            fprintf(out, "%s%s\n", *hinges->item[k].other ? ", " : "", hinges->item[k].other);
        }
        return;
    }
    fprintf(out, "\n");
}

/* By which a restart sees that the file has changed. */
static void write_contents(FILE *out, const struct expr_table *table)
{
    const size_t bytes = (size_t)table->n * sizeof *table->x;
    const uint64_t x = hash_bytes(HASH_START, table->x, bytes);
    fprintf(out, "# file of %d rows, checksum %" PRIx64 "\n", table->n,
            hash_bytes(x, table->y, bytes));
}

static void write_section(FILE *out, const struct scene *scene, enum section_id id, int index,
                          const char *path)
{
    const void *const section = section_at(scene, id, index);
    if (id != SECTION_top) fprintf(out, "\n%s\n", section_title(section).text);
    if (id == SECTION_table) write_contents(out, &scene->function[index]);
    for (int k = 0; k < PARAM_COUNT; k++)
        if (param_table[k].section == id && strcmp(param_table[k].key, "like") != 0)
            write_param(out, scene, &param_table[k], section, path);
}

/* Expressions in x and y keep their text, so their constants are written too. */
static void write_constants(FILE *out, const struct scene *scene)
{
    static const char *const symbol[] = {"kg", "m", "s"};
    if (scene->n_constants) fprintf(out, "\n[constants]\n");
    for (int k = 0; k < scene->n_constants; k++) {
        const struct scene_constant *const c = &scene->constant[k];
        const bool unit = c->dim.kind != DIM_PLAIN;
        const char *before = " ";
        fprintf(out, "%s = ", c->name);
        write_real(out, "", c->value);
        for (int u = 0; u < 3 && unit; u++) {
            if (c->dim.power[u] == 0) continue;
            fprintf(out, c->dim.power[u] == 1 ? "%s%s" : "%s%s^%.9g", before, symbol[u],
                    c->dim.power[u]);
            before = "*";
        }
        if (unit && *before == ' ') fprintf(out, " rad"); /* a ratio: a number with a unit */
        fprintf(out, "\n");
    }
}

enum err scene_write(const struct scene *scene, const char *path, struct diag *d)
{
    FILE *out = fopen(path, "w");
    if (!out) return diag_fail(d, ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    fprintf(out, "# The case in effect, every default written out, in SI units; sphfsi %s.\n%s\n",
            SPHFSI_VERSION,
            scene->off_lattice
                ? "# Bodies are off the lattice, so their sampled sizes depend on dp.\n"
                : "");
    write_section(out, scene, SECTION_top, 0, path);
    write_constants(out, scene);
    for (int id = SECTION_top + 1; id < SECTION_COUNT; id++)
        for (int k = 0; k < case_given_count(scene, (enum section_id)id); k++)
            write_section(out, scene, (enum section_id)id, k, path);
    const bool failed = ferror(out) != 0;
    if (fclose(out) != 0 || failed)
        return diag_fail(d, ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    return ERR_OK;
}
