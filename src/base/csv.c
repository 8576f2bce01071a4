/* SPDX-License-Identifier: MIT
 * Numbers as text, and the reader of tables. */
#include "base/csv.h"
#include "base/files.h"

#include <ctype.h>
#include <stdlib.h>

enum { CSV_MAX_LINES = 1000000 };

int number_text(char text[NUMBER_TEXT], double value)
{
    int length = 0;
    for (int digits = 15; digits <= 17; digits++) {
        length = snprintf(text, NUMBER_TEXT, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    return length;
}

const char *csv_next_line(const char *at)
{
    at += strcspn(at, "\n");
    return *at ? at + 1 : at;
}

const char *csv_field(const char *line, int k, size_t *length)
{
    for (;; k--) {
        const bool quoted = *line == '"';
        line += quoted;
        *length = strcspn(line, quoted ? "\"\n" : ",\n");
        if (k == 0) return line;
        line += *length;
        line += strcspn(line, ",\n");
        if (*line++ != ',') return NULL;
    }
}

enum err csv_open(struct csv *c, const char *file)
{
    TRY(text_read(file, c->path, "a table", &c->text, c->diag));
    c->at = c->text + (strncmp(c->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0); /* a byte-order mark */
    c->line = 0;
    c->lines = !*c->text;
    c->begun = false;
    for (char *at = c->text; (at = strchr(at, '\r')); at++)
        if (at[1] != '\n') *at = '\n'; /* a line may end with CR alone */
    for (const char *at = c->text; *at; at++) c->lines += *at == '\n' || !at[1];
    if (c->lines > CSV_MAX_LINES)
        return diag_add(c->diag, ERR_INPUT, "%s: more than %d lines; use fewer rows", c->path,
                        CSV_MAX_LINES);
    return ERR_OK;
}

void csv_close(struct csv *c)
{
    free(c->text);
    c->text = NULL;
}

/* Whether 0,5;1 stands here: it has two columns for one reader, three for another. */
static const char *doubtful_separator(const char *at, size_t length)
{
    const char *const other = memchr(at, ';', length) ? "semicolons" : "tabs";
    if (*other == 't' && !memchr(at, '\t', length)) return NULL;
    for (size_t k = 1; k + 1 < length; k++)
        if (at[k] == ',' && isdigit((unsigned char)at[k - 1]) && isdigit((unsigned char)at[k + 1]))
            return other;
    return NULL;
}

static int read_numbers(struct csv *c, const char *line, double *row)
{
    const size_t length = strcspn(line, "#\r\n");
    const char *const doubtful = doubtful_separator(line, length), *at = line;
    const char *const blanks = " \t\r";
    if (doubtful) {
        diag_add(c->diag, ERR_INPUT,
                 "%s:%d: commas and %s in one row; write decimal numbers with a point, as 0.5, and "
                 "separate all columns by the same character",
                 c->path, c->line, doubtful);
        return -1;
    }
    for (int k = 0; k < c->n; k++) {
        char *end;
        row[k] = strtod(at, &end);
        if (*at == '\n' || end == at || !isfinite(row[k]) || fabs(row[k]) > c->limit) {
            diag_add(c->diag, ERR_INPUT, "%s:%d: %d numbers are expected: %s; here `%.*s`", c->path,
                     c->line, c->n, c->columns, (int)(length < 60 ? length : 60), line);
            return -1;
        }
        at = end + strspn(end, blanks);
        if (k + 1 < c->n && (*at == ',' || *at == ';')) at += 1 + strspn(at + 1, blanks);
    }
    if (!*at || *at == '\n' || *at == '#' || c->more) return 1;
    diag_add(c->diag, ERR_INPUT, "%s:%d: more than %d columns; %s are expected", c->path, c->line,
             c->n, c->columns);
    return -1;
}

/* Names begin with a letter, a quote or a bracket, and are no number, as inf or "0.1" is. */
static bool is_names(const char *at)
{
    const char *const name = at + strspn(at, "\"'([");
    char *end;
    strtod(name, &end);
    return (name > at || isalpha((unsigned char)*at)) &&
           (end == name || isalnum((unsigned char)*end) || *end == '_');
}

int csv_row(struct csv *c, double *row)
{
    while (*c->at) {
        const char *const at = c->at + strspn(c->at, " \t\r");
        c->at = csv_next_line(c->at);
        c->line++;
        if (!*at || *at == '\n' || *at == '#') continue;
        const bool names = !c->begun && is_names(at);
        c->begun = true;
        if (!names) return read_numbers(c, at, row);
    }
    return 0;
}
