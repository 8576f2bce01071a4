/* SPDX-License-Identifier: MIT
 * The functions of include/sphfsi.h on a whole case. */
#include "app/call.h"
#include "app/actions.h"
#include "base/files.h"
#include "case/params.h"

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

/* What is done with a session; `path`: of the file that sphfsi_effective writes. */
typedef enum err session_action(struct session *x, struct sphfsi_options *o, const char *path,
                                struct diag *d);

static enum sphfsi_status act(const char *name, const struct sphfsi_options *options,
                              session_action *action, const char *path)
{
    struct call c;
    enum err e = call_begin(&c, name, options);
    struct session *const x = e ? NULL : calloc(1, sizeof *x);
    if (!e && !x)
        e = diag_fail(&c.diag, ERR_MEMORY, "%s: no memory for %zu bytes", name, sizeof *x);
    if (x) e = action(x, &c.options, path, &c.diag);
    free(x);
    return call_end(&c, e);
}

static enum err explain(struct session *x, struct sphfsi_options *o, const char *path,
                        struct diag *d)
{
    (void)path;
    TRY(session_open(x, o, d));
    const enum err e = explain_text(x, o, d);
    session_close(x);
    return e;
}

enum sphfsi_status sphfsi_explain(const struct sphfsi_options *options)
{
    return act("explain", options, explain, NULL);
}

static enum err explain_as_json(struct session *x, struct sphfsi_options *o, const char *path,
                                struct diag *d)
{
    (void)path;
    struct heard h;
    heard_begin(&h, o);
    enum err e = session_open(x, o, d);
    if (!e) {
        e = explain_json(x, &h, o, d);
        session_close(x);
    }
    free(h.text);
    return e;
}

enum sphfsi_status sphfsi_explain_json(const struct sphfsi_options *options)
{
    return act("explain", options, explain_as_json, NULL);
}

static enum err effective(struct session *x, struct sphfsi_options *o, const char *path,
                          struct diag *d)
{
    TRY(session_read(x, o, d));
    const enum err e = scene_write(&x->scene, path, d);
    scene_free(&x->scene);
    return e;
}

enum sphfsi_status sphfsi_effective(const struct sphfsi_options *options, const char *path)
{
    if (!path) return call_without("effective", "path");
    return act("case", options, effective, path);
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

static enum err preview(struct session *x, struct sphfsi_options *o, const char *path,
                        struct diag *d)
{
    (void)path;
    char to[PATH_BYTES];
    TRY(session_read(x, o, d));
    preview_path(o, to);
    const enum err e = preview_draw(&x->scene, to, d);
    if (!e) session_say(o, "%s: picture of the case at the start; open it in a browser", to);
    scene_free(&x->scene);
    return e;
}

enum sphfsi_status sphfsi_preview(const struct sphfsi_options *options)
{
    return act("preview", options, preview, NULL);
}

static enum err cite(struct session *x, struct sphfsi_options *o, const char *path, struct diag *d)
{
    (void)path;
    TRY(session_read(x, o, d));
    manual_cite(&x->scene, effects_of_scene(&x->scene), o);
    scene_free(&x->scene);
    return ERR_OK;
}

enum sphfsi_status sphfsi_cite(const struct sphfsi_options *options)
{
    return act("cite", options, cite, NULL);
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
