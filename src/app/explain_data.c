/* SPDX-License-Identifier: MIT
 * What explain_session says, as JSON. */
#include "app/explain.h"

#include "app/forecast.h"
#include "check/check.h"
#include "output/report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void hear(void *context, enum sphfsi_message kind, const char *text)
{
    struct heard *const h = context;
    const size_t length = strlen(text);
    char *const more = kind == SPHFSI_WARNING ? realloc(h->text, h->n + length + 2) : NULL;
    if (more) {
        memcpy(more + h->n, text, length);
        memcpy(more + h->n + length, "\n", 2);
        h->text = more;
        h->n += length + 1;
    }
    h->message(h->context, kind, text);
}

void heard_begin(struct heard *h, struct sphfsi_options *o)
{
    *h = (struct heard){.message = o->message, .context = o->context};
    if (!o->message) return;
    o->message = hear;
    o->context = h;
}

static void write_warnings(struct json *j, const struct heard *h)
{
    char text[sizeof((struct diag *)0)->text];
    json_open(j, "warnings", '[');
    for (const char *at = h->text; at && *at; at += strcspn(at, "\n") + 1) {
        snprintf(text, sizeof text, "%.*s", (int)strcspn(at, "\n"), at);
        json_text(j, NULL, text);
    }
    json_close(j, ']');
}

static void write_scene(struct json *j, const struct session *x)
{
    const struct scene *const c = &x->scene;
    json_text(j, "title", c->top.title);
    json_text(j, "case", c->path);
    json_number(j, "dp", c->top.dp);
    json_number(j, "end_time", c->top.end_time);
    json_open(j, "particles", '{');
    for (int k = 0; k < KIND_COUNT; k++) json_integer(j, kind_names[k], x->simulation.kind[k].n);
    json_close(j, '}');
}

static void write_fields(struct json *j, const struct simulation *s)
{
    json_open(j, "fields", '{');
    for (int k = 0; k < KIND_COUNT; k++) {
        json_open(j, kind_names[k], '[');
        for (int f = 0; f < field_count && s->kind[k].capacity; f++)
            if (field_array(&s->kind[k], &field_table[f])) json_text(j, NULL, field_table[f].name);
        json_close(j, ']');
    }
    json_close(j, '}');
}

static void write_bounds(struct json *j, const struct simulation *s)
{
    int binding = -1;
    json_open(j, "time_step_bounds", '{');
    for (int k = 0; k < BOUND_COUNT; k++) {
        const double bound = s->dt_bound[k];
        if (!isfinite(bound) || !(bound > 0) || k == BOUND_output) continue;
        json_number(j, bound_names[k], bound);
        if (binding < 0 || bound < s->dt_bound[binding]) binding = k;
    }
    json_close(j, '}');
    json_text(j, "time_step_bound", binding < 0 ? "none" : bound_names[binding]);
    if (s->kind[KIND_SOLID].n > 0) json_number(j, "solid_time_step", s->dt_solid);
}

static void write_cost(struct json *j, const struct simulation *s, const struct unit_costs *c)
{
    const struct forecast f = forecast_run(c, s);
    json_open(j, "cost", '{');
    json_integer(j, "threads", thread_count());
    json_number(j, "time_step", f.dt);
    json_number(j, "steps", f.steps);
    json_number(j, "solid_substeps", f.substeps);
    json_number(j, "wall_seconds", f.seconds);
    json_number(j, "row_seconds", c->rows);
    json_number(j, "memory_bytes", f.memory);
    json_number(j, "disk_bytes", f.disk);
    json_open(j, "phase_shares", '{');
    for (int k = 0; k < PHASE_COUNT; k++)
        if (k != PHASE_output && c->phase_fraction[k] > 0)
            json_number(j, phase_table[k].name, c->phase_fraction[k]);
    json_close(j, '}');
    json_close(j, '}');
}

static enum err write_all(FILE *file, struct session *x, const struct heard *h, struct diag *d)
{
    struct json j = {.file = file};
    struct simulation *const s = &x->simulation;
    struct unit_costs c;
    json_open(&j, NULL, '{');
    write_scene(&j, x);
    report_effects(&j, s);
    write_fields(&j, s);
    const enum err e = forecast_measure(&c, s, d);
    check_simulation(s, d);
    TRY(e);
    write_bounds(&j, s);
    write_cost(&j, s, &c);
    report_derived(&j, &x->scene);
    report_parameters(&j, &x->scene);
    write_warnings(&j, h);
    json_close(&j, '}');
    return ERR_OK;
}

enum err explain_data(struct session *x, const struct heard *h, const struct sphfsi_options *o,
                      struct diag *d)
{
    char *text = NULL;
    size_t size;
    FILE *const file = open_memstream(&text, &size);
    if (!file) return diag_fail(d, ERR_MEMORY, "explain: no memory for its text");
    enum err e = write_all(file, x, h, d);
    if (fclose(file) != 0 && !e) e = diag_fail(d, ERR_MEMORY, "explain: no memory for its text");
    if (!e && o->message) o->message(o->context, SPHFSI_NOTE, text);
    free(text);
    return e;
}
