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

/* What is done with a scene that was read, or with a session. */
enum action { EFFECTIVE, PREVIEW, CITE, EXPLAIN, EXPLAIN_JSON };

static enum err show_scene(enum action action, const struct scene *scene,
                           const struct sphfsi_options *o, const char *path, struct diag *d)
{
    char picture[PATH_BYTES];
    if (action == EFFECTIVE) return scene_write(scene, path, d);
    if (action == CITE) {
        manual_cite(scene, effects_of_scene(scene), o);
        return ERR_OK;
    }
    preview_path(o, picture);
    TRY(preview_draw(scene, picture, d));
    session_say(o, "%s: picture of the case at the start; open it in a browser", picture);
    return ERR_OK;
}

static enum err show(enum action action, struct session *x, struct sphfsi_options *o,
                     const char *path, struct diag *d)
{
    struct heard h = {.text = NULL};
    if (action == EXPLAIN_JSON) heard_begin(&h, o);
    enum err e = action < EXPLAIN ? session_read(x, o, d) : session_open(x, o, d);
    if (!e && action < EXPLAIN) {
        e = show_scene(action, &x->scene, o, path, d);
        scene_free(&x->scene);
    } else if (!e) {
        e = action == EXPLAIN ? explain_text(x, o, d) : explain_json(x, &h, o, d);
        session_close(x);
    }
    free(h.text);
    return e;
}

/* `path`: of the file that sphfsi_effective writes. */
static enum sphfsi_status act(const char *name, const struct sphfsi_options *options,
                              enum action action, const char *path)
{
    struct call c;
    enum err e = call_begin(&c, name, options);
    struct session *const x = e ? NULL : calloc(1, sizeof *x);
    if (!e && !x)
        e = diag_fail(&c.diag, ERR_MEMORY, "%s: no memory for %zu bytes", name, sizeof *x);
    if (x) e = show(action, x, &c.options, path, &c.diag);
    free(x);
    return call_end(&c, e);
}

enum sphfsi_status sphfsi_explain(const struct sphfsi_options *options)
{
    return act("explain", options, EXPLAIN, NULL);
}

enum sphfsi_status sphfsi_explain_json(const struct sphfsi_options *options)
{
    return act("explain", options, EXPLAIN_JSON, NULL);
}

enum sphfsi_status sphfsi_effective(const struct sphfsi_options *options, const char *path)
{
    if (!path) return call_without("effective", "path");
    return act("case", options, EFFECTIVE, path);
}

enum sphfsi_status sphfsi_preview(const struct sphfsi_options *options)
{
    return act("preview", options, PREVIEW, NULL);
}

enum sphfsi_status sphfsi_cite(const struct sphfsi_options *options)
{
    return act("cite", options, CITE, NULL);
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
