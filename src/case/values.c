/* SPDX-License-Identifier: MIT
 * Values of a case file: constants, numbers with units, choices, texts, expressions. */
#include "case/case.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MAX_CONSTANT_DEPTH = 32 };

static struct slice whole(const char *text) { return (struct slice){text, strlen(text)}; }

static struct slice trimmed(struct slice s)
{
    while (s.length && (*s.at == ' ' || *s.at == '\t')) {
        s.at++;
        s.length--;
    }
    while (s.length && (s.at[s.length - 1] == ' ' || s.at[s.length - 1] == '\t')) s.length--;
    return s;
}

bool slice_next(struct slice *rest, char separator, struct slice *piece)
{
    if (!rest->at) return false;
    int open = 0;
    size_t n = 0;
    while (n < rest->length && (rest->at[n] != separator || open > 0)) {
        open += rest->at[n] == '(';
        open -= rest->at[n] == ')';
        n++;
    }
    *piece = trimmed((struct slice){rest->at, n});
    if (n == rest->length)
        rest->at = NULL;
    else
        *rest = (struct slice){rest->at + n + 1, rest->length - n - 1};
    return true;
}

int slice_count(struct slice text, char separator)
{
    struct slice piece;
    int n = 0;
    while (n <= CASE_MAX_POINTS && slice_next(&text, separator, &piece)) n++;
    return n;
}

/* --- constants --- */

static enum err collect_constant(struct reader *r, const struct entry *e)
{
    const char *const meaning = expr_reserved(e->key);
    if (meaning)
        return bad_entry(r, e, "a constant cannot be named `%s`: that is %s", e->key, meaning);
    if (param_find(SECTION_top, e->key))
        return bad_entry(r, e,
                         "a constant cannot be named `%s`: that is a key at the top of the file",
                         e->key);
    for (int k = 0; k < r->n_constants; k++) {
        const struct entry *old = r->constants[k].entry;
        if (strcmp(old->key, e->key) == 0)
            return bad_entry(r, e, "%s is given already, in line %d", e->key, old->line);
    }
    if (r->n_constants == CASE_MAX_CONSTANTS)
        return bad_entry(r, e, "more than %d constants", CASE_MAX_CONSTANTS);
    r->constants[r->n_constants++] = (struct constant){.entry = e};
    return ERR_OK;
}

enum err case_collect_constants(struct reader *r)
{
    r->constants = arena_alloc(&r->temp, CASE_MAX_CONSTANTS + (size_t)PARAM_COUNT,
                               sizeof *r->constants, "constants", r->diag);
    if (!r->constants) return ERR_MEMORY;
    for (int k = 0; k < r->n_entries; k++)
        if (r->sections[r->entries[k].section].id == SECTION_constants)
            TRY(collect_constant(r, &r->entries[k]));
    for (int k = 0; k < r->n_entries; k++) {
        const struct entry *e = &r->entries[k];
        if (r->sections[e->section].id != SECTION_top) continue;
        const struct param *p = param_find(SECTION_top, e->key);
        bool known = !p || p->type != PARAM_REAL;
        for (int c = 0; c < r->n_constants; c++)
            known |= strcmp(r->constants[c].entry->key, e->key) == 0;
        if (!known) r->constants[r->n_constants++] = (struct constant){.entry = e};
    }
    return ERR_OK;
}

static bool find_name(void *context, const char *name, struct quantity *q, char why[EXPR_WHY]);

static bool evaluate_constant(struct reader *r, struct constant *c, char why[EXPR_WHY])
{
    const char *const name = c->entry->key;
    if (c->state == CONSTANT_DONE) return true;
    if (c->state == CONSTANT_BUSY) {
        snprintf(why, EXPR_WHY, "`%s` depends on itself", name);
        return false;
    }
    if (r->depth == MAX_CONSTANT_DEPTH) {
        snprintf(why, EXPR_WHY, "constants wait for later constants more than %d deep",
                 MAX_CONSTANT_DEPTH);
        return false;
    }
    const struct expr_names names = {r, find_name, EXPR_FIXED};
    char inner[EXPR_WHY];
    c->state = CONSTANT_BUSY;
    r->depth++;
    const bool good = expr_value(whole(c->entry->value), &names, &c->q, inner);
    r->depth--;
    c->state = good ? CONSTANT_DONE : CONSTANT_TEXT;
    if (good) {
        const struct param *p = param_find(SECTION_top, name);
        if (p && c->q.dim.kind == DIM_PLAIN && dim_fits(&c->q.dim, p->unit)) {
            /* `dp = 0.001` is a length wherever dp is used. */
            struct slice unit = whole(p->unit);
            struct quantity one = {1, {DIM_KNOWN, 0, 0, 0}};
            if (unit_read(&unit, &one, inner)) c->q.dim = one.dim;
        }
        return true;
    }
    if (strstr(inner, ", needed for ")) /* the root of the trouble is named */
        snprintf(why, EXPR_WHY, "%s", inner);
    else
        snprintf(why, EXPR_WHY, "%.200s, needed for `%s`", inner, name);
    return false;
}

static bool find_name(void *context, const char *name, struct quantity *q, char why[EXPR_WHY])
{
    struct reader *r = context;
    struct nearest near = {0};
    for (int k = 0; k < r->n_constants; k++) {
        struct constant *c = &r->constants[k];
        nearest_offer(&near, name, c->entry->key);
        if (strcmp(c->entry->key, name) != 0) continue;
        if (!evaluate_constant(r, c, why)) return false;
        *q = c->q;
        return true;
    }
    if (near.name)
        snprintf(why, EXPR_WHY, "unknown name `%s`; did you mean `%s`?", name, near.name);
    else
        snprintf(why, EXPR_WHY, "unknown name `%s`; define it in [constants]", name);
    return false;
}

enum err case_all_constants(struct reader *r)
{
    struct scene *s = r->scene;
    s->constant =
        arena_alloc(&s->arena, (size_t)r->n_constants, sizeof *s->constant, "constants", r->diag);
    if (!s->constant) return ERR_MEMORY;
    for (int k = 0; k < r->n_constants; k++) {
        const struct entry *e = r->constants[k].entry;
        const struct expr_names names = {r, find_name, EXPR_FIXED};
        struct quantity q = {0};
        char why[EXPR_WHY];
        /* Once more from its text, so that the message names what is wrong right here. */
        if (!expr_value(whole(e->value), &names, &q, why)) return bad_value(r, e, "%s", why);
        if (r->sections[e->section].id != SECTION_constants) continue;
        struct scene_constant *c = &s->constant[s->n_constants++];
        snprintf(c->name, sizeof c->name, "%s", e->key);
        c->value = q.value;
        c->plain = q.dim.kind == DIM_PLAIN;
        c->kg = q.dim.kg;
        c->m = q.dim.m;
        c->s = q.dim.s;
    }
    return ERR_OK;
}

/* --- values --- */

static enum err check_dim(struct reader *r, const struct entry *e, const struct dim *dim,
                          const char *unit)
{
    if (dim_fits(dim, unit)) return ERR_OK;
    char have[DIM_TEXT], want[DIM_TEXT];
    dim_text(dim, have);
    unit_dim_text(unit, want);
    return bad_value(r, e, "%s where %s is expected", have, want);
}

enum err case_number(struct reader *r, const struct entry *e, struct slice text, const char *unit,
                     double *value)
{
    const struct expr_names names = {r, find_name, EXPR_FIXED};
    struct quantity q = {0};
    char why[EXPR_WHY];
    if (!expr_value(text, &names, &q, why)) return bad_value(r, e, "%s", why);
    TRY(check_dim(r, e, &q.dim, unit));
    *value = q.value;
    return ERR_OK;
}

static enum err check_range(struct reader *r, const struct entry *e, const struct param *p,
                            double value)
{
    const bool low = p->low_open ? value > p->low : value >= p->low;
    const bool high = p->high_open ? value < p->high : value <= p->high;
    if (low && high) return ERR_OK;
    const char *unit = p->unit && strcmp(p->unit, "1") != 0 ? p->unit : "";
    return bad_value(r, e, "out of range: it must be %s %g%s%s and %s %g%s%s",
                     p->low_open ? "above" : "at least", p->low, *unit ? " " : "", unit,
                     p->high_open ? "below" : "at most", p->high, *unit ? " " : "", unit);
}

static enum err read_integer(struct reader *r, const struct entry *e, const struct param *p,
                             int *value)
{
    double number = 0;
    TRY(case_number(r, e, whole(e->value), "1", &number));
    TRY(check_range(r, e, p, number));
    if (number != floor(number)) return bad_value(r, e, "a whole number is expected");
    *value = (int)number;
    return ERR_OK;
}

enum { CHOICES_MOST = 32 };

static enum err read_choice(struct reader *r, const struct entry *e, const struct param *p,
                            int *value)
{
    struct slice rest = whole(p->choices), name;
    struct nearest near = {0};
    char names[CHOICES_MOST][SCENE_NAME];
    for (int k = 0; k < CHOICES_MOST && slice_next(&rest, '|', &name); k++) {
        snprintf(names[k], SCENE_NAME, "%.*s", (int)name.length, name.at);
        if (strcmp(names[k], e->value) == 0) {
            *value = k;
            return ERR_OK;
        }
        nearest_offer(&near, e->value, names[k]);
    }
    if (near.name) return bad_value(r, e, "did you mean `%s`? Known: %s", near.name, p->choices);
    return bad_value(r, e, "unknown choice; known: %s", p->choices);
}

/* Texts go into JSON, HDF5 and plots, which all want UTF-8. */
static bool is_utf8(struct slice text)
{
    int follow = 0;
    for (size_t k = 0; k < text.length; k++) {
        const unsigned char c = (unsigned char)text.at[k];
        if (follow) {
            if ((c & 0xC0) != 0x80) return false;
            follow--;
        } else if (c >= 0x80) {
            follow = c >= 0xC2 && c < 0xE0   ? 1
                     : (c & 0xF0) == 0xE0    ? 2
                     : c >= 0xF0 && c < 0xF5 ? 3
                                             : 0;
            if (!follow) return false;
        }
    }
    return follow == 0;
}

static enum err read_text(struct reader *r, const struct entry *e, char value[SCENE_TEXT])
{
    struct slice text = whole(e->value);
    if (text.length >= 2 && *text.at == '"') {
        text.at++;
        text.length -= 2;
    }
    if (text.length >= SCENE_TEXT) return bad_value(r, e, "longer than %d bytes", SCENE_TEXT - 1);
    if (!is_utf8(text)) return bad_entry(r, e, "%s is not UTF-8 text", e->key);
    memset(value, 0, SCENE_TEXT);
    memcpy(value, text.at, text.length);
    return ERR_OK;
}

static enum err read_vector(struct reader *r, const struct entry *e, const struct param *p,
                            double value[2])
{
    struct slice rest = whole(e->value), piece = rest;
    const int n = slice_count(rest, ',');
    if (n != 2)
        return bad_value(r, e, "two components are expected, `%s = X, Y`; there %s %d", p->key,
                         n == 1 ? "is" : "are", n);
    for (int k = 0; k < 2 && slice_next(&rest, ',', &piece); k++) {
        TRY(case_number(r, e, piece, p->unit, &value[k]));
        if (!(fabs(value[k]) <= 1e15)) return bad_value(r, e, "out of range: beyond 1e15");
    }
    return ERR_OK;
}

static enum err read_numbers(struct reader *r, const struct entry *e, const struct param *p,
                             struct number_list *list)
{
    struct slice rest = whole(e->value), piece = rest;
    const int n = slice_count(rest, ',');
    if (n > CASE_MAX_POINTS) return bad_value(r, e, "more than %d numbers", CASE_MAX_POINTS);
    list->value = arena_alloc(&r->scene->arena, (size_t)n, sizeof *list->value, "numbers", r->diag);
    if (!list->value) return ERR_MEMORY;
    for (list->n = 0; list->n < n && slice_next(&rest, ',', &piece); list->n++)
        TRY(case_number(r, e, piece, p->unit, &list->value[list->n]));
    return ERR_OK;
}

static enum err read_field(struct reader *r, const struct entry *e, const struct param *p,
                           struct scene_expr *field)
{
    struct slice rest = whole(e->value), piece = rest;
    const int n = slice_count(rest, ',');
    if (n != p->count)
        return bad_value(r, e, "%s expected, with commas between them; there %s %d",
                         p->count == 1 ? "one expression is" : "two expressions are",
                         n == 1 ? "is" : "are", n);
    const struct expr_names names = {r, find_name,
                                     p->type == PARAM_TIME_EXPR ? EXPR_IN_TIME : EXPR_IN_SPACE};
    for (int k = 0; k < n && slice_next(&rest, ',', &piece); k++) {
        char why[EXPR_WHY];
        struct dim dim = {0};
        const enum err err =
            expr_compile(&field->e[k], piece, &names, &dim, &r->scene->arena, why, r->diag);
        if (err == ERR_INPUT) return bad_value(r, e, "%s", why);
        if (err) return err;
        TRY(check_dim(r, e, &dim, p->unit));
    }
    return ERR_OK;
}

enum err case_value(struct reader *r, const struct entry *e, const struct param *p, void *section)
{
    void *const place = (char *)section + p->offset;
    switch (p->type) {
    case PARAM_REAL:
        TRY(case_number(r, e, whole(e->value), p->unit, place));
        return check_range(r, e, p, *(double *)place);
    case PARAM_INTEGER: return read_integer(r, e, p, place);
    case PARAM_CHOICE: return read_choice(r, e, p, place);
    case PARAM_TEXT: return read_text(r, e, place);
    case PARAM_VECTOR: return read_vector(r, e, p, place);
    case PARAM_FIELD_EXPR:
    case PARAM_TIME_EXPR: return read_field(r, e, p, place);
    case PARAM_SHAPES: return case_shape(r, e, place);
    case PARAM_NUMBERS: return read_numbers(r, e, p, place);
    }
    return ERR_OK;
}
