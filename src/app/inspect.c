/* SPDX-License-Identifier: MIT
 * --inspect: the time, the particles and the case of a checkpoint. */
#include "app/session.h"
#include "base/csv.h"
#include "output/checkpoint.h"

static void say_checkpoint(const char *path, const struct checkpoint *m,
                           const struct sphfsi_options *o)
{
    const struct checkpoint_info info = checkpoint_info(m);
    session_say(o, "%s: a valid checkpoint of %zu bytes, written by sphfsi %s", path, m->size,
                info.version);
    session_say(o, "  time %.9g s, %lld steps", info.time, (long long)info.steps);
    for (int k = 0; k < KIND_COUNT; k++)
        session_say(o, "  %-6s %10lld particles", kind_names[k], (long long)info.count[k]);
    session_say(o, "case:");
    for (const char *line = info.case_text; *line; line = csv_next_line(line))
        session_say(o, "%.*s", (int)strcspn(line, "\n"), line);
}

static enum err inspect_file(const char *path, const struct sphfsi_options *o, struct diag *d)
{
    struct checkpoint m = {0};
    char file[PATH_BYTES];
    const enum err e = checkpoint_find(&m, path, file, d);
    if (!e) say_checkpoint(file, &m, o);
    checkpoint_free(&m);
    if (e == ERR_IO) d->code = ERR_INPUT;
    return d->code;
}

enum sphfsi_status sphfsi_inspect(const char *file, const struct sphfsi_options *options)
{
    struct call c;
    if (!file) return call_null_argument("inspect", "file");
    enum err e = call_begin(&c, "inspect", options);
    if (!e) e = inspect_file(file, &c.options, &c.diag);
    return call_end(&c, e);
}
