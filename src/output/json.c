/* SPDX-License-Identifier: MIT
 * Indentation, commas and escapes. */
#include "output/json.h"
#include "base/csv.h"

static void quote(struct json *j, const char *text)
{
    fputc('"', j->file);
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        if (*c == '"' || *c == '\\')
            fprintf(j->file, "\\%c", *c);
        else if (*c < 0x20 || *c == 0x7f)
            fprintf(j->file, "\\u%04x", *c);
        else
            fputc(*c, j->file);
    }
    fputc('"', j->file);
}

/* Writes comma, line break, indent and name before a value. */
static void begin_value(struct json *j, const char *name)
{
    const int bit = 1 << j->depth;
    if (j->filled & bit) fputc(',', j->file);
    if (j->depth > 0) fprintf(j->file, "\n%*s", 2 * j->depth, "");
    j->filled |= bit;
    if (!name) return;
    quote(j, name);
    fputs(": ", j->file);
}

void json_open(struct json *j, const char *name, char bracket)
{
    begin_value(j, name);
    fputc(bracket, j->file);
    j->depth++;
    j->filled &= ~(1 << j->depth);
}

void json_close(struct json *j, char bracket)
{
    const int filled = j->filled & (1 << j->depth);
    j->depth--;
    if (filled) fprintf(j->file, "\n%*s", 2 * j->depth, "");
    fputc(bracket, j->file);
    if (j->depth == 0) fputc('\n', j->file);
}

static void number(struct json *j, double value)
{
    char text[NUMBER_TEXT];
    if (isfinite(value)) number_text(text, value);
    fputs(isfinite(value) ? text : "null", j->file);
}

void json_number(struct json *j, const char *name, double value)
{
    begin_value(j, name);
    number(j, value);
}

void json_integer(struct json *j, const char *name, int64_t value)
{
    begin_value(j, name);
    fprintf(j->file, "%lld", (long long)value);
}

void json_text(struct json *j, const char *name, const char *value)
{
    begin_value(j, name);
    quote(j, value);
}

void json_numbers(struct json *j, const char *name, const double *values, int n)
{
    begin_value(j, name);
    fputc('[', j->file);
    for (int k = 0; k < n; k++) {
        if (k > 0) fputs(", ", j->file);
        number(j, values[k]);
    }
    fputc(']', j->file);
}
