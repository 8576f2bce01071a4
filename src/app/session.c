/* SPDX-License-Identifier: MIT
 * What each call of the library begins and ends with, and how a session reads its case. */
#include "app/session.h"
#include "check/check.h"
#include "geometry/scene_points.h"
#include "output/rows.h"
#include "time/timestep.h"

#include <stdarg.h>
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

static void say(const struct sphfsi_options *o, enum sphfsi_message kind, const char *format,
                va_list args)
{
    char text[2048];
    if (!o->message) return;
    vsnprintf(text, sizeof text, format, args);
    o->message(o->context, kind, text);
}

void session_say(const struct sphfsi_options *o, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    say(o, SPHFSI_NOTE, format, args);
    va_end(args);
}

void session_result(const struct sphfsi_options *o, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    say(o, SPHFSI_RESULT, format, args);
    va_end(args);
}

/* --- a call --- */

static _Thread_local char last_error[sizeof((struct diag *)0)->text];
static _Thread_local char more_errors[sizeof((struct diag *)0)->more];

const char *sphfsi_error(void) { return last_error; }

const char *sphfsi_more_errors(void) { return more_errors; }

enum sphfsi_status call_result(const struct diag *d, enum err e)
{
    if (e) snprintf(last_error, sizeof last_error, "%s", d->text);
    if (e) snprintf(more_errors, sizeof more_errors, "%s", d->more);
    return (enum sphfsi_status)e;
}

enum sphfsi_status call_null_argument(const char *name, const char *what)
{
    struct diag d = {.code = ERR_OK};
    return call_result(&d, diag_fail(&d, ERR_INPUT, "%s: the %s is NULL", name, what));
}

static void guarded_message(void *context, enum sphfsi_message kind, const char *text)
{
    struct call *const c = context;
    if (kind == SPHFSI_WARNING) diag_more(&c->warned, text);
    if (!c->given->message) return;
    const struct host mine = host_use(c->host);
    c->given->message(c->given->context, kind, text);
    host_use(mine);
}

static void guarded_progress(void *context, const struct sphfsi_progress *p)
{
    const struct call *const c = context;
    const struct host mine = host_use(c->host);
    c->given->progress(c->given->context, p);
    host_use(mine);
}

static enum err check_sets(const struct sphfsi_options *o, const char *name, struct diag *d)
{
    if (o->n_sets < 0 || (o->n_sets > 0 && !o->sets))
        return diag_fail(d, ERR_INPUT, "%s: n_sets = %d, and sets is %s", name, o->n_sets,
                         o->sets ? "given" : "NULL");
    for (int k = 0; k < o->n_sets; k++)
        if (!o->sets[k]) return diag_fail(d, ERR_INPUT, "%s: sets[%d] is NULL", name, k);
    return ERR_OK;
}

enum err call_begin(struct call *c, const char *name, const struct sphfsi_options *given)
{
    *c = (struct call){.diag = {.code = ERR_OK}};
    if (!given) return diag_fail(&c->diag, ERR_INPUT, "%s: the options are NULL", name);
    TRY(check_sets(given, name, &c->diag));
    struct host before;
    TRY(host_enter(&before, 0, &c->diag));
    c->host = before;
    c->given = given;
    c->options = *given;
    c->options.context = c;
    c->options.message = guarded_message;
    if (given->progress) c->options.progress = guarded_progress;
    c->diag = session_diag(&c->options);
    return ERR_OK;
}

enum sphfsi_status call_end(struct call *c, enum err e)
{
    if (c->given) host_use(c->host);
    return call_result(&c->diag, e);
}

enum err session_json(const struct sphfsi_options *o, json_writer *write, void *context,
                      struct diag *d)
{
    char *text = NULL;
    size_t size;
    struct json j = {.file = open_memstream(&text, &size)};
    if (!j.file) return diag_fail(d, ERR_MEMORY, "json: no memory for the text");
    enum err e = write(&j, context, d);
    if (fclose(j.file) != 0 && !e) e = diag_fail(d, ERR_MEMORY, "json: no memory for the text");
    if (!e && o->message) o->message(o->context, SPHFSI_NOTE, text);
    free(text);
    return e;
}

/* --- a session --- */

const char *session_name(const struct sphfsi_options *o, int *length)
{
    const char *const path = o->case_path ? o->case_path : "case";
    const char *const name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    const int n = (int)strlen(name);
    *length = n > 4 && strcmp(name + n - 4, ".cfg") == 0 ? n - 4 : n;
    return name;
}

/* Default intervals depend on end_time of the case, not on --until: rows stay the same. */
static void set_default_times(struct scene *scene, double until)
{
    struct scene_output *out = &scene->output;
    const double end = scene->top.end_time;
    if (out->probe_interval == 0) out->probe_interval = end / 1000;
    if (out->ledger_interval == 0) out->ledger_interval = end / 1000;
    if (out->snapshot_interval == 0) out->snapshot_interval = end / 20;
    scene->top.end_time = due_round(until > 0 ? until : end);
}

static enum err check_options(const struct sphfsi_options *o, struct diag *d)
{
    if (!o->case_path && !o->case_text)
        return diag_fail(d, ERR_INPUT, "options: set case_path or case_text");
    if (o->threads < 0)
        return diag_fail(d, ERR_INPUT,
                         "threads = %d: use 1 or more, or 0 for as many as are useful", o->threads);
    if (!(o->until >= 0 && o->until <= 1e9))
        return diag_fail(d, ERR_INPUT, "until = %g must be above 0 and at most 1e9 seconds",
                         o->until);
    return ERR_OK;
}

/* The largest number of threads for a scene: what the options or OMP_NUM_THREADS ask for, reduced
 * with a warning to what the scene can use. Without either: at most `offered`. */
static int choose_threads(const struct scene *scene, const struct sphfsi_options *o, int offered,
                          struct diag *d)
{
    const char *const variable = getenv("OMP_NUM_THREADS");
    const int64_t n = scene->points[KIND_FLUID].n + scene->points[KIND_SOLID].n;
    const int asked = o->threads > 0 ? o->threads : variable && *variable ? offered : 0;
    const int limit = thread_limit(n), useful = thread_useful(n);
    if (asked == 0) return useful < offered ? useful : offered;
    if (asked <= limit) return asked;
    diag_warn(d,
              "%s = %d is too many: %lld particles on %d cores can use at most %d thread%s, so the "
              "run uses %d; give that number or fewer",
              o->threads > 0 ? "threads" : "OMP_NUM_THREADS", asked, (long long)n, thread_cores(),
              limit, limit == 1 ? "" : "s", limit);
    return limit;
}

static enum err read_case(struct session *session, const struct sphfsi_options *o, struct diag *d)
{
    TRY(check_options(o, d));
    const int largest = THREADS_PER_CORE * thread_cores();
    const int asked = o->threads > 0 ? o->threads : thread_count();
    thread_use(asked < largest ? asked : largest);
    TRY(scene_load_text(&session->scene, o->case_text, o->case_path ? o->case_path : "case",
                        o->n_sets, o->sets, d));
    const enum err e = check_scene(&session->scene, d);
    if (e)
        scene_free(&session->scene);
    else
        set_default_times(&session->scene, o->until);
    return e;
}

void session_close(struct session *session)
{
    simulation_free(&session->simulation);
    scene_free(&session->scene);
}

/* Most steps, and most rows or files. `step`: the longest of the program; keys: times between two,
 * 0: not set. */
static enum err check_counts(const struct scene *scene, double step, struct diag *d)
{
    static const double max_steps = 1e10, max_outputs = 1e7;
    static const struct {
        enum section_id section;
        const char *key, *what;
    } between[] = {{SECTION_numerics, "fixed_step", "steps"},
                   {SECTION_output, "probe_interval", "rows"},
                   {SECTION_output, "ledger_interval", "rows"},
                   {SECTION_output, "snapshot_interval", "snapshots"},
                   {SECTION_output, "checkpoint_interval", "checkpoints"},
                   {SECTION_probe, "interval", "rows"}};
    const double end = scene->top.end_time;
    for (size_t k = 0; k < COUNT_OF(between); k++)
        for (int j = 0; j < section_count(scene, between[k].section); j++) {
            const char *const key = between[k].key;
            const double most = between[k].section == SECTION_numerics ? max_steps : max_outputs;
            const double time = param_number(param_find(between[k].section, key),
                                             section_at(scene, between[k].section, j));
            if (time > 0 && end / time > most)
                return fail_at(d, scene, key_line(scene, between[k].section, j, key),
                               "%s = %g s gives %.3g %s until %g s, more than the limit of %g; "
                               "choose at least %.3g s",
                               key, time, end / time, between[k].what, end, most, end / most);
        }
    if (scene->numerics.fixed_step > end)
        return fail_at(d, scene, key_line(scene, SECTION_numerics, 0, "fixed_step"),
                       "fixed_step = %g s is longer than the run, which ends at %g s; choose a "
                       "shorter step",
                       scene->numerics.fixed_step, end);
    if (step >= end / max_steps) return ERR_OK;
    return fail_at(d, scene, key_line(scene, SECTION_top, 0, "end_time"),
                   "the run needs about %.3g steps of %.3g s until end_time = %g s, more than the "
                   "limit of %g; choose at most %.3g s",
                   end / step, step, end, max_steps, max_steps * step);
}

/* Puts the name of the case before a message from code that does not know it. */
static void name_case(const struct scene *scene, struct diag *d)
{
    const struct scene_place at = scene_place(scene, LINE_NONE);
    char text[sizeof d->text];
    if (!d || d->code != ERR_INPUT) return;
    if (strncmp(d->text, at.text, strlen(at.text)) == 0 || strncmp(d->text, "--set", 5) == 0)
        return;
    memcpy(text, d->text, sizeof text);
    snprintf(d->text, sizeof d->text, "%s: %.*s", at.text, (int)(sizeof text - sizeof at - 8),
             text);
}

enum err session_open(struct session *session, const struct sphfsi_options *o, struct diag *d)
{
    const int offered = thread_count();
    const double begin = thread_clock();
    TRY(read_case(session, o, d));
    thread_use(choose_threads(&session->scene, o, offered, d));
    const enum err e = simulation_create(&session->simulation, &session->scene, d);
    if (e) {
        name_case(&session->scene, d);
        scene_free(&session->scene);
        return e;
    }
    session->opening = thread_clock() - begin;
    const double step = timestep_longest(&session->simulation);
    const enum err counted = check_counts(&session->scene, step, d);
    if (counted) session_close(session);
    return counted;
}

enum sphfsi_status call_of_case(const char *name, const struct sphfsi_options *given,
                                bool simulation, case_action *act)
{
    struct call c;
    enum err e = call_begin(&c, name, given);
    struct session *const session = e ? NULL : calloc(1, sizeof *session);
    if (!e && !session) e = diag_fail(&c.diag, ERR_MEMORY, "%s: no memory", name);
    if (!e)
        e = simulation ? session_open(session, &c.options, &c.diag)
                       : read_case(session, &c.options, &c.diag);
    if (!e) {
        e = act(session, &c.options, &c.diag);
        session_close(session);
    }
    free(session);
    return call_end(&c, e);
}

static enum err write_effective(struct session *session, const struct sphfsi_options *o,
                                struct diag *d)
{
    return scene_write(&session->scene, o->out, d);
}

enum sphfsi_status sphfsi_effective(const struct sphfsi_options *options, const char *path)
{
    if (!path) return call_null_argument("effective", "path");
    struct sphfsi_options to_path = options ? *options : (struct sphfsi_options){0};
    to_path.out = path;
    return call_of_case("case", options ? &to_path : NULL, false, write_effective);
}

/* --- small functions of the public header --- */

const char *sphfsi_version(void) { return SPHFSI_VERSION; }

int sphfsi_exit_status(enum sphfsi_status status, int signal_number)
{
    if (status == SPHFSI_INTERRUPT && signal_number > 0 && signal_number < 128)
        return 128 + signal_number;
    return (unsigned)status <= SPHFSI_INTERRUPT ? err_status((enum err)status) : 2;
}
