/* SPDX-License-Identifier: MIT
 * The functions of include/sphfsi.h on a whole case. */
#include "app/call.h"
#include "app/explain.h"
#include "base/files.h"
#include "app/inspect.h"
#include "app/manual.h"
#include "case/params.h"
#include "app/preview.h"
#include "app/run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *sphfsi_version(void) { return SPHFSI_VERSION; }

int sphfsi_exit_status(enum sphfsi_status status, int signal_number)
{
    if (status == SPHFSI_INTERRUPT && signal_number > 0 && signal_number < 128)
        return 128 + signal_number;
    return (unsigned)status <= SPHFSI_INTERRUPT ? err_status((enum err)status) : 2;
}

const char *sphfsi_nearest(const char *word, const char *const *names, int n)
{
    struct nearest best = {0};
    for (int k = 0; word && names && k < n; k++)
        if (names[k]) nearest_offer(&best, word, names[k]);
    return best.name;
}

enum sphfsi_status sphfsi_run(const struct sphfsi_options *options)
{
    struct call c;
    enum err e = call_begin(&c, "run", options);
    if (!e) e = run_case(&c.options, &c.diag);
    return call_end(&c, e);
}

/* What is done with a session, by its name; `with` says what else it needs. */
typedef enum err session_work(struct session *x, struct call *c, void *with);

static enum err with_session(struct call *c, const char *name, session_work *work, void *with)
{
    struct session *const x = calloc(1, sizeof *x);
    if (!x) return diag_fail(&c->diag, ERR_MEMORY, "%s: no memory for %zu bytes", name, sizeof *x);
    const enum err e = work(x, c, with);
    free(x);
    return e;
}

/* As data if there are warnings to put into it. */
static enum err explain_work(struct session *x, struct call *c, void *heard)
{
    TRY(session_open(x, &c->options, &c->diag));
    const enum err e = heard ? explain_data(x, heard, &c->options, &c->diag)
                             : explain_session(x, &c->options, &c->diag);
    session_close(x);
    return e;
}

enum sphfsi_status sphfsi_explain(const struct sphfsi_options *options)
{
    struct call c;
    enum err e = call_begin(&c, "explain", options);
    if (!e) e = with_session(&c, "explain", explain_work, NULL);
    return call_end(&c, e);
}

enum sphfsi_status sphfsi_explain_json(const struct sphfsi_options *options)
{
    struct call c;
    struct heard h = {0};
    enum err e = call_begin(&c, "explain", options);
    if (!e) {
        heard_begin(&h, &c.options);
        e = with_session(&c, "explain", explain_work, &h);
    }
    free(h.text);
    return call_end(&c, e);
}

static enum err effective_work(struct session *x, struct call *c, void *path)
{
    TRY(session_read(x, &c->options, &c->diag));
    const enum err e = scene_write(&x->scene, path, &c->diag);
    scene_free(&x->scene);
    return e;
}

enum sphfsi_status sphfsi_effective(const struct sphfsi_options *options, const char *path)
{
    struct call c;
    if (!path) return call_without("effective", "path");
    char *const to = (char *)(uintptr_t)path;
    enum err e = call_begin(&c, "effective", options);
    if (!e) e = with_session(&c, "case", effective_work, to);
    return call_end(&c, e);
}

enum sphfsi_status sphfsi_inspect(const char *file, const struct sphfsi_options *options)
{
    struct call c;
    if (!file) return call_without("inspect", "file");
    enum err e = call_begin(&c, "inspect", options);
    if (!e) e = inspect_file(file, &c.options, &c.diag);
    return call_end(&c, e);
}

static void preview_path(const struct sphfsi_options *o, char path[PATH_BYTES])
{
    const char *name = o->case_path ? o->case_path : "case";
    if (strrchr(name, '/')) name = strrchr(name, '/') + 1;
    const size_t length = strlen(name);
    const bool cfg = length > 4 && strcmp(name + length - 4, ".cfg") == 0;
    if (o->out)
        snprintf(path, PATH_BYTES, "%s", o->out);
    else
        snprintf(path, PATH_BYTES, "preview-%.*s.svg", (int)(cfg ? length - 4 : length), name);
}

static enum err preview_work(struct session *x, struct call *c, void *unused)
{
    (void)unused;
    char path[PATH_BYTES];
    TRY(session_read(x, &c->options, &c->diag));
    preview_path(&c->options, path);
    const enum err e = preview_draw(&x->scene, path, &c->diag);
    if (!e)
        session_say(&c->options, "%s: picture of the case at the start; open it in a browser",
                    path);
    scene_free(&x->scene);
    return e;
}

enum sphfsi_status sphfsi_preview(const struct sphfsi_options *options)
{
    struct call c;
    enum err e = call_begin(&c, "preview", options);
    if (!e) e = with_session(&c, "preview", preview_work, NULL);
    return call_end(&c, e);
}

static enum err cite_work(struct session *x, struct call *c, void *unused)
{
    (void)unused;
    TRY(session_read(x, &c->options, &c->diag));
    manual_cite(&x->scene, effects_of_scene(&x->scene), &c->options);
    scene_free(&x->scene);
    return ERR_OK;
}

enum sphfsi_status sphfsi_cite(const struct sphfsi_options *options)
{
    struct call c;
    enum err e = call_begin(&c, "cite", options);
    if (!e) e = with_session(&c, "cite", cite_work, NULL);
    return call_end(&c, e);
}

enum sphfsi_status sphfsi_keys(const struct sphfsi_options *options)
{
    struct call c;
    const enum err e = call_begin(&c, "keys", options);
    if (!e) manual_keys(&c.options);
    return call_end(&c, e);
}

const char *sphfsi_template_name(int k) { return k < 0 ? NULL : manual_template_name(k); }

const char *sphfsi_template(const char *name)
{
    struct diag d = {.code = ERR_OK};
    struct nearest near = {0};
    char list[256] = "";
    if (!name) return call_without("template", "name"), NULL;
    const char *const text = manual_template(name);
    if (text) return text;
    for (int k = 0; manual_template_name(k); k++) {
        const size_t at = strlen(list);
        snprintf(list + at, sizeof list - at, "%s%s", k ? ", " : "", manual_template_name(k));
        nearest_offer(&near, name, manual_template_name(k));
    }
    call_result(&d, diag_fail(&d, ERR_INPUT, "there is no template '%.60s'%s%s; known: %s", name,
                              near.name ? "; the nearest name is " : "", near.name ? near.name : "",
                              list));
    return NULL;
}
