/* SPDX-License-Identifier: MIT
 * Messages and their codes: the first failure, those added to it, and warnings. */
#include "base/base.h"

#include <stdarg.h>

int err_status(enum err e)
{
    return e == ERR_OK ? 0 : e == ERR_INPUT ? 1 : e == ERR_INTERRUPT ? 130 : 2;
}

enum err diag_fail(struct diag *d, enum err code, const char *format, ...)
{
    ASSERT(code != ERR_OK);
    if (d && d->code == ERR_OK) {
        va_list args;
        va_start(args, format);
        vsnprintf(d->text, sizeof d->text, format, args);
        va_end(args);
        d->code = code;
    }
    return code;
}

enum err diag_add(struct diag *d, enum err code, const char *format, ...)
{
    ASSERT(code != ERR_OK);
    if (!d) return code;
    char text[sizeof d->text];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (d->code == ERR_OK) return diag_fail(d, code, "%s", text);
    diag_more(d, text);
    return code;
}

int diag_count(const struct diag *d)
{
    int n = d->code != ERR_OK;
    for (const char *c = d->more; *c; c++) n += *c == '\n';
    return n;
}

void diag_warn(struct diag *d, const char *format, ...)
{
    if (!d || !d->warn) return;
    char text[sizeof d->text];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    d->warn(d->warn_context, text);
}

void diag_more(struct diag *d, const char *text)
{
    const size_t used = strlen(d->more), length = strlen(text);
    if (used + length + 2 > sizeof d->more) return;
    memcpy(d->more + used, text, length);
    memcpy(d->more + used + length, "\n", 2);
}
