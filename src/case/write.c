/* SPDX-License-Identifier: MIT
 * The effective case: all values in SI units, constants evaluated. */
#include "case/case.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef SPHFSI_VERSION
#define SPHFSI_VERSION "(unversioned build)"
#endif

/* The shortest decimal that is read back as the same double; seventeen digits always suffice. */
static void write_real(FILE *out, double value)
{
    char text[40];
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    fputs(text, out);
}

static void write_number(FILE *out, double value, const char *unit)
{
    const bool bare = !unit || strcmp(unit, "1") == 0 || strcmp(unit, "SI") == 0;
    write_real(out, value);
    if (!bare) fprintf(out, " %s", strncmp(unit, "1/", 2) == 0 ? unit + 1 : unit);
}

static void write_reals(FILE *out, int n, const double *value)
{
    for (int k = 0; k < n; k++) {
        if (k) fputs(", ", out);
        write_real(out, value[k]);
    }
}

static void write_text(FILE *out, const char *text)
{
    const size_t length = strlen(text);
    const bool quoted =
        !length || strchr(text, '#') || strchr(" \t\"", text[0]) || strchr(" \t", text[length - 1]);
    fprintf(out, quoted ? "\"%s\"" : "%s", text);
}

static void write_points(FILE *out, const struct shape *shape)
{
    for (int k = 0; k < shape->n; k++) {
        if (k) fputs("; ", out);
        write_reals(out, 2, shape->pt[k]);
    }
}

static void write_shape(FILE *out, const char *key, const struct shape *shape)
{
    fprintf(out, "%s = ", key);
    switch (shape->kind) {
    case SHAPE_BOX:
        fputs("box ", out);
        write_reals(out, 4, shape->pt[0]);
        break;
    case SHAPE_CIRCLE:
        fputs("circle ", out);
        write_reals(out, 3, (const double[]){shape->pt[0][0], shape->pt[0][1], shape->size});
        break;
    case SHAPE_POLYGON:
        fputs("polygon ", out);
        write_points(out, shape);
        break;
    case SHAPE_POLYLINE:
        fputs("polyline thickness ", out);
        write_real(out, shape->size);
        fputs(": ", out);
        write_points(out, shape);
        break;
    }
    fprintf(out, "\n");
}

/* The folder of a path with all links resolved and a / at its end; false: it cannot be
 * determined. */
static bool real_directory(const char *path, char *folder, size_t size)
{
    char head[4096 + SCENE_TEXT];
    const char *slash = strrchr(path, '/');
    snprintf(head, sizeof head, "%.*s", slash ? (int)(slash - path) + 1 : 1, slash ? path : ".");
    char *real = realpath(head, NULL);
    if (!real) return false;
    const int n = snprintf(folder, size, "%s/", strcmp(real, "/") == 0 ? "" : real);
    free(real);
    return n > 0 && (size_t)n < size;
}

/* A file given relative to the case, as a path relative to the folder of the effective case. */
static void relocate(const struct scene *scene, const char *name, const char *path,
                     char text[SCENE_TEXT])
{
    char file[4096 + SCENE_TEXT], there[4096], here[4096], seen[SCENE_TEXT];
    const char *slash = strrchr(name, '/');
    snprintf(text, SCENE_TEXT, "%s", name);
    if (!*name || name[0] == '/' || !scene_file(scene, name, file, sizeof file)) return;
    if (!real_directory(file, there, sizeof there) || !real_directory(path, here, sizeof here))
        return;
    size_t common = 0;
    for (size_t k = 0; here[k] && here[k] == there[k]; k++)
        if (here[k] == '/') common = k + 1;
    size_t n = 0;
    seen[0] = '\0';
    for (const char *c = here + common; *c; c++)
        if (*c == '/' && n < sizeof seen) n += (size_t)snprintf(seen + n, sizeof seen - n, "../");
    if (n >= sizeof seen) return;
    const int end =
        snprintf(seen + n, sizeof seen - n, "%s%s", there + common, slash ? slash + 1 : name);
    if (end >= 0 && n + (size_t)end < sizeof seen) snprintf(text, SCENE_TEXT, "%s", seen);
}

static void write_param(FILE *out, const struct scene *scene, const struct param *param,
                        const char *section, const char *path)
{
    const void *const value = section + param->offset;
    const double *const number = value;
    const struct number_list *const list = value;
    const struct scene_expr *const field = value;
    const struct shape_list *const shapes = value;
    char name[SCENE_NAME], text[SCENE_TEXT];
    if (param->type == PARAM_REAL && isnan(*number)) return;
    if (param->type == PARAM_NUMBERS && !list->n) return;
    const bool expression = param->type == PARAM_FIELD_EXPR || param->type == PARAM_TIME_EXPR ||
                            param->type == PARAM_FLOW_EXPR;
    if (expression && !field->e[0]) return;
    if (param->type == PARAM_SHAPES) {
        for (int k = 0; k < shapes->n; k++) write_shape(out, param->key, &shapes->item[k]);
        return;
    }
    fprintf(out, "%s = ", param->key);
    switch (param->type) {
    case PARAM_REAL: write_number(out, *number, param->unit); break;
    case PARAM_INTEGER: fprintf(out, "%d", *(const int *)value); break;
    case PARAM_CHOICE:
        param_choice_name(param, *(const int *)value, name);
        fprintf(out, "%s", name);
        break;
    case PARAM_TEXT:
        if (strcmp(param->key, "file") == 0 || strcmp(param->key, "gravity_file") == 0)
            relocate(scene, value, path, text);
        else
            snprintf(text, sizeof text, "%s", (const char *)value);
        write_text(out, text);
        break;
    case PARAM_VECTOR:
    case PARAM_TIME_VECTOR:
        for (int k = 0; k < 2; k++) {
            const struct expr *const e = param_in_time(param, section, k);
            if (k) fprintf(out, ", ");
            if (e)
                fputs(expr_source(e), out);
            else
                write_number(out, number[k], param->unit);
        }
        break;
    case PARAM_NUMBERS: write_reals(out, list->n, list->value); break;
    case PARAM_FIELD_EXPR:
    case PARAM_TIME_EXPR:
    case PARAM_FLOW_EXPR:
        for (int k = 0; k < param->count; k++)
            fprintf(out, "%s%s", k ? ", " : "", expr_source(field->e[k]));
        break;
    case PARAM_SHAPES: break;
    }
    fprintf(out, "\n");
}

static void write_section(FILE *out, const struct scene *scene, enum section_id id, int index,
                          const char *path)
{
    const char *const section = section_at(scene, id, index);
    const struct scene_section_common *common = (const void *)section;
    if (id != SECTION_top)
        fprintf(out, "\n[%s%s%s]\n", section_table[id].word, section_table[id].named ? " " : "",
                common->name);
    for (int k = 0; k < PARAM_COUNT; k++) {
        const struct param *param = &param_table[k];
        if (param->section != id || strcmp(param->key, "like") == 0) continue;
        write_param(out, scene, param, section, path);
    }
}

/* Expressions in x and y keep their text, so their constants are written too. */
static void write_constants(FILE *out, const struct scene *scene)
{
    if (scene->n_constants) fprintf(out, "\n[constants]\n");
    for (int k = 0; k < scene->n_constants; k++) {
        const struct scene_constant *c = &scene->constant[k];
        fprintf(out, "%s = ", c->name);
        write_real(out, c->value);
        const char *const symbol[] = {"kg", "m", "s"};
        const double power[] = {c->kg, c->m, c->s};
        const char *before = " ";
        for (int u = 0; u < 3 && !c->plain; u++) {
            if (power[u] == 0) continue;
            fprintf(out, power[u] == 1 ? "%s%s" : "%s%s^%.9g", before, symbol[u], power[u]);
            before = "*";
        }
        if (!c->plain && *before == ' ') fprintf(out, " rad"); /* a ratio: a number with a unit */
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
        for (int k = 0; k < section_count(scene, (enum section_id)id); k++)
            write_section(out, scene, (enum section_id)id, k, path);
    const bool failed = ferror(out) != 0;
    if (fclose(out) != 0 || failed)
        return diag_fail(d, ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    return ERR_OK;
}
