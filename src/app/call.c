/* SPDX-License-Identifier: MIT */
#include "app/call.h"

#include "app/session.h"

#include <stdio.h>

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

enum sphfsi_status call_without(const char *name, const char *what)
{
    struct diag d = {.code = ERR_OK};
    return call_result(&d, diag_fail(&d, ERR_INPUT, "%s: the %s is NULL", name, what));
}

static void guarded_message(void *context, enum sphfsi_message kind, const char *text)
{
    const struct call *const c = context;
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
    if (given->message) c->options.message = guarded_message;
    if (given->progress) c->options.progress = guarded_progress;
    c->diag = session_diag(&c->options);
    return ERR_OK;
}

enum sphfsi_status call_end(struct call *c, enum err e)
{
    if (c->given) host_use(c->host);
    return call_result(&c->diag, e);
}
