/* SPDX-License-Identifier: MIT
 * The functions of include/sphfsi.h on a whole case. */
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

/* --- what is done with a scene that was read, or with its simulation at time zero --- */

struct request {
    const char *name;
    bool simulation; /* is needed */
    enum err (*act)(struct session *x, const struct sphfsi_options *o, const char *path,
                    struct diag *d);
};

static enum sphfsi_status respond(const struct request *request,
                                  const struct sphfsi_options *options, const char *path)
{
    struct call c;
    enum err e = call_begin(&c, request->name, options);
    struct session *const x = e ? NULL : calloc(1, sizeof *x);
    if (!e && !x) e = diag_fail(&c.diag, ERR_MEMORY, "%s: no memory", request->name);
    if (!e)
        e = request->simulation ? session_open(x, &c.options, &c.diag)
                                : session_read(x, &c.options, &c.diag);
    if (!e) {
        e = request->act(x, &c.options, path, &c.diag);
        session_close(x);
    }
    free(x);
    return call_end(&c, e);
}

enum sphfsi_status sphfsi_explain(const struct sphfsi_options *options)
{
    static const struct request request = {"explain", true, explain_text};
    return respond(&request, options, NULL);
}

enum sphfsi_status sphfsi_explain_json(const struct sphfsi_options *options)
{
    static const struct request request = {"explain", true, explain_json};
    return respond(&request, options, NULL);
}

static enum err write_effective(struct session *x, const struct sphfsi_options *o, const char *path,
                                struct diag *d)
{
    (void)o;
    return scene_write(&x->scene, path, d);
}

enum sphfsi_status sphfsi_effective(const struct sphfsi_options *options, const char *path)
{
    static const struct request request = {"case", false, write_effective};
    return path ? respond(&request, options, path) : call_without("effective", "path");
}

static enum err draw(struct session *x, const struct sphfsi_options *o, const char *path,
                     struct diag *d)
{
    char file[PATH_BYTES];
    int length;
    const char *const name = session_name(o, &length);
    (void)path;
    if (o->out)
        snprintf(file, sizeof file, "%s", o->out);
    else
        snprintf(file, sizeof file, "preview-%.*s.svg", length, name);
    TRY(preview_draw(&x->scene, file, d));
    session_say(o, "%s: picture of the case at the start; open it in a browser", file);
    return ERR_OK;
}

enum sphfsi_status sphfsi_preview(const struct sphfsi_options *options)
{
    static const struct request request = {"preview", false, draw};
    return respond(&request, options, NULL);
}

static enum err cite(struct session *x, const struct sphfsi_options *o, const char *path,
                     struct diag *d)
{
    (void)path, (void)d;
    manual_cite(&x->scene, effects_of_scene(&x->scene), o);
    return ERR_OK;
}

enum sphfsi_status sphfsi_cite(const struct sphfsi_options *options)
{
    static const struct request request = {"cite", false, cite};
    return respond(&request, options, NULL);
}

enum sphfsi_status sphfsi_inspect(const char *file, const struct sphfsi_options *options)
{
    struct call c;
    if (!file) return call_without("inspect", "file");
    enum err e = call_begin(&c, "inspect", options);
    if (!e) e = inspect_file(file, &c.options, &c.diag);
    return call_end(&c, e);
}

enum sphfsi_status sphfsi_keys(const struct sphfsi_options *options)
{
    struct call c;
    const enum err e = call_begin(&c, "keys", options);
    if (!e) manual_keys(&c.options);
    return call_end(&c, e);
}

enum sphfsi_status sphfsi_keys_json(const struct sphfsi_options *options)
{
    struct call c;
    enum err e = call_begin(&c, "keys", options);
    if (!e) e = manual_keys_json(&c.options, &c.diag);
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
