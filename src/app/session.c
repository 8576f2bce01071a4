/* SPDX-License-Identifier: MIT */
#include "app/session.h"
#include "geometry/load.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static void forward_warning(void *context, const char *text)
{
    const struct sphfsi_options *o = context;
    o->message(o->context, SPHFSI_WARNING, text);
}

struct diag session_diag(const struct sphfsi_options *o)
{
    struct diag d = {.code = ERR_OK};
    if (o->message) {
        d.warn = forward_warning;
        d.warn_context = (void *)(uintptr_t)o;
    }
    return d;
}

void session_say(const struct sphfsi_options *o, const char *format, ...)
{
    if (!o->message) return;
    char text[2048];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    o->message(o->context, SPHFSI_NOTE, text);
}

double session_time(double time)
{
    char text[32];
    snprintf(text, sizeof text, "%.12g", time);
    return strtod(text, NULL);
}

static enum err check_interval(const struct scene *scene, const char *key, double interval,
                               struct diag *d)
{
    const double least = 1e-9 * scene->top.end_time;
    if (interval == 0 || interval >= least) return ERR_OK;
    return diag_fail(d, ERR_INPUT,
                     "%s: %s = %g s is less than %g s, 1e-9 of end_time; choose a longer one",
                     scene->path, key, interval, least);
}

/* Default intervals depend on end_time of the case, not on --until, so that a shortened run writes the same
 * rows and takes the same steps as the whole one. */
static enum err settle_times(struct scene *scene, double until, struct diag *d)
{
    struct scene_output *out = &scene->output;
    const double end = scene->top.end_time;
    if (out->probe_interval == 0) out->probe_interval = end / 1000;
    if (out->ledger_interval == 0) out->ledger_interval = end / 1000;
    if (out->snapshot_interval == 0) out->snapshot_interval = end / 20;
    scene->top.end_time = session_time(until > 0 ? until : end);
    TRY(check_interval(scene, "[output] probe_interval", out->probe_interval, d));
    TRY(check_interval(scene, "[output] ledger_interval", out->ledger_interval, d));
    TRY(check_interval(scene, "[output] snapshot_interval", out->snapshot_interval, d));
    TRY(check_interval(scene, "[output] checkpoint_interval", out->checkpoint_interval, d));
    for (int k = 0; k < scene->n_probe; k++)
        TRY(check_interval(scene, "[probe] interval", scene->probe[k].interval, d));
    return ERR_OK;
}

static enum err check_options(const struct sphfsi_options *o, struct diag *d)
{
    if (!o->case_path && !o->case_text)
        return diag_fail(d, ERR_INPUT, "options: set case_path or case_text");
    if (o->threads < 0 || o->threads > 4096)
        return diag_fail(d, ERR_INPUT,
                         "threads = %d: from 1 to 4096 are possible, or 0 for the number that "
                         "OpenMP chooses",
                         o->threads);
    if (!(o->until >= 0 && o->until <= 1e9))
        return diag_fail(d, ERR_INPUT, "until = %g: more than 0 and up to 1e9 seconds are possible",
                         o->until);
    return ERR_OK;
}

enum err session_read(struct session *x, const struct sphfsi_options *o, struct diag *d)
{
    TRY(check_options(o, d));
    if (o->threads > 0) thread_use(o->threads);
    if (o->case_text)
        TRY(scene_load_text(&x->scene, o->case_text, o->case_path ? o->case_path : "case",
                            o->n_sets, o->sets, d));
    else
        TRY(scene_load(&x->scene, o->case_path, o->n_sets, o->sets, d));
    const enum err e = settle_times(&x->scene, o->until, d);
    if (e) scene_free(&x->scene);
    return e;
}

enum err session_open(struct session *x, const struct sphfsi_options *o, struct diag *d)
{
    TRY(session_read(x, o, d));
    const enum err e = simulation_create(&x->simulation, &x->scene, d);
    if (e) scene_free(&x->scene);
    return e;
}

void session_close(struct session *x)
{
    simulation_free(&x->simulation);
    scene_free(&x->scene);
}
