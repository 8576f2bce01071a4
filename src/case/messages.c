/* SPDX-License-Identifier: MIT
 * What is wrong with a case file, in one sentence that begins with the place. */
#include "case/case.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum err bad_line(struct reader *r, int line, const char *format, ...)
{
    char text[700], place[LOCATION_TEXT];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    scene_location(r->scene, line, place);
    return diag_fail(r->diag, ERR_INPUT, "%s: %s", place, text);
}

enum err bad_entry(struct reader *r, const struct entry *e, const char *format, ...)
{
    char text[700];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (!e->set) return bad_line(r, e->line, "%s", text);
    return diag_fail(r->diag, ERR_INPUT, "--set %.100s: %s", e->set, text);
}

enum err bad_value(struct reader *r, const struct entry *e, const char *format, ...)
{
    char text[600];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    const bool cut = strlen(e->value) > 60;
    return bad_entry(r, e, "%s = %.60s%s: %s", e->key, e->value, cut ? "..." : "", text);
}
