/* SPDX-License-Identifier: MIT
 * Rows of CSV: fields between commas, those with a comma inside between double quotes. */
#include "app/evidence.h"

#include "app/embedded.h"

#include <stdlib.h>

/* The field at `at`, which moves behind it, but not beyond the end of the line. */
static void read_field(const char **at, char field[EVIDENCE_TEXT])
{
    const bool quoted = **at == '"';
    const char *const start = *at + quoted;
    const size_t length = strcspn(start, quoted ? "\"\n" : ",\n");
    const size_t kept = length < EVIDENCE_TEXT ? length : EVIDENCE_TEXT - 1;
    memcpy(field, start, kept);
    field[kept] = '\0';
    *at = start + length;
    *at += strcspn(*at, ",\n");
    if (**at == ',') ++*at;
}

const char *evidence_first(void)
{
    const char *text = embedded_text("data/evidence.csv");
    while (*text == '#') text += strcspn(text, "\n") + 1;
    return text + strcspn(text, "\n") + 1; /* behind the names of the columns */
}

bool evidence_next(const char **rest, struct evidence *row)
{
    char kind[EVIDENCE_TEXT], number[EVIDENCE_TEXT];
    const char *at = *rest;
    if (!*at) return false;
    read_field(&at, kind);
    row->kind = kind[0] == 's' ? SCENE_SOLID : kind[0] == 'f' ? SCENE_FLUID : SCENE_COUPLED;
    read_field(&at, row->accuracy);
    read_field(&at, row->name);
    read_field(&at, row->error);
    read_field(&at, number);
    row->resolution = strtod(number, NULL);
    read_field(&at, row->what);
    read_field(&at, number);
    row->percent = strtod(number, NULL);
    *rest = at + (*at == '\n');
    return true;
}
