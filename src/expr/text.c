/* SPDX-License-Identifier: MIT
 * Pieces of the text of a value. */
#include "expr/expr.h"

#include <ctype.h>

struct slice slice_of(const char *text) { return (struct slice){text, strlen(text)}; }

struct slice slice_after(struct slice s, size_t n)
{
    return (struct slice){s.at + n, s.length - n};
}

struct slice slice_trimmed(struct slice s)
{
    while (s.length && (*s.at == ' ' || *s.at == '\t')) s = slice_after(s, 1);
    while (s.length && (s.at[s.length - 1] == ' ' || s.at[s.length - 1] == '\t')) s.length--;
    return s;
}

bool slice_next(struct slice *rest, char separator, struct slice *piece)
{
    if (!rest->at) return false;
    int open = 0;
    size_t n = 0;
    for (; n < rest->length && (rest->at[n] != separator || open > 0); n++)
        open += (rest->at[n] == '(') - (rest->at[n] == ')');
    *piece = slice_trimmed((struct slice){rest->at, n});
    *rest = n == rest->length ? (struct slice){NULL, 0} : slice_after(*rest, n + 1);
    return true;
}

int slice_count(struct slice text, char separator)
{
    struct slice piece;
    int n = 0;
    while (slice_next(&text, separator, &piece)) n++;
    return n;
}

struct slice slice_identifier(struct slice s)
{
    size_t n = 0;
    while (n < s.length && (s.at[n] == '_' || isalpha((unsigned char)s.at[n]) ||
                            (n > 0 && isdigit((unsigned char)s.at[n]))))
        n++;
    return (struct slice){s.at, n};
}

static size_t digits_length(struct slice s, size_t n)
{
    while (n < s.length && (isdigit((unsigned char)s.at[n]) || s.at[n] == '.')) n++;
    return n;
}

size_t number_length(struct slice s)
{
    const size_t n = digits_length(s, 0);
    size_t e = n;
    if (e < s.length && (s.at[e] == 'e' || s.at[e] == 'E')) e++;
    if (e > n && e < s.length && (s.at[e] == '+' || s.at[e] == '-')) e++;
    return e > n && e < s.length && isdigit((unsigned char)s.at[e]) ? digits_length(s, e) : n;
}

const char *comma_hint(const char *value)
{
    for (const char *c = value; (c = strchr(c, ',')) != NULL; c++)
        if (c > value && isdigit((unsigned char)c[-1]) && isdigit((unsigned char)c[1]))
            return "; a comma separates numbers, and a decimal number is written with a point: "
                   "0.005";
    return "";
}
