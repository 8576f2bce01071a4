/* SPDX-License-Identifier: MIT */
#include "base/error.h"

#include <stdarg.h>
#include <stdio.h>

static const struct {
    int status;
    const char *meaning;
} error_rows[] = {
#define ERROR(name, status, meaning) {status, meaning},
#include "base/errors.def"
#undef ERROR
};

int err_status(enum err e)
{
    ASSERT((size_t)e < COUNT_OF(error_rows));
    return error_rows[e].status;
}

const char *err_meaning(enum err e)
{
    ASSERT((size_t)e < COUNT_OF(error_rows));
    return error_rows[e].meaning;
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
