/* SPDX-License-Identifier: MIT
 * Numbers of a case file: pieces of a value, named constants, numbers with units. */
#include "case/case.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { MAX_CONSTANT_DEPTH = 32 };

struct slice slice_of(const char *text) { return (struct slice){text, strlen(text)}; }

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

const char *case_comma_hint(const char *value)
{
    for (const char *c = value; (c = strchr(c, ',')) != NULL; c++)
        if (c > value && isdigit((unsigned char)c[-1]) && isdigit((unsigned char)c[1]))
            return "; a comma separates numbers, and a decimal number is written with a point: "
                   "0.005";
    return "";
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
    if (meaning) {
        r->misnamed = e->key;
        return bad_entry(r, e, "a constant cannot be named `%s`: that is %s; rename it", e->key,
                         meaning);
    }
    if (param_find(SECTION_top, e->key))
        return bad_entry(
            r, e,
            "a constant cannot be named `%s`: that is a key at the top of the file; rename it",
            e->key);
    for (int k = 0; k < r->n_constants; k++) {
        const struct entry *old = r->constants[k].entry;
        if (strcmp(old->key, e->key) == 0)
            return bad_entry(r, e, "`%s` is given twice, first in line %d; leave one out", e->key,
                             old->line);
    }
    if (r->n_constants == CASE_MAX_CONSTANTS)
        return bad_entry(r, e, "more than %d constants are given; write some as numbers",
                         CASE_MAX_CONSTANTS);
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
            TRY(case_go_on(r, collect_constant(r, &r->entries[k])));
    for (int k = 0; k < r->n_entries; k++) {
        const struct entry *e = &r->entries[k];
        if (r->sections[e->section].id != SECTION_top) continue;
        const struct param *param = param_find(SECTION_top, e->key);
        bool known = !param || param->type != PARAM_REAL;
        for (int c = 0; c < r->n_constants; c++)
            known |= strcmp(r->constants[c].entry->key, e->key) == 0;
        if (!known) r->constants[r->n_constants++] = (struct constant){.entry = e};
    }
    return ERR_OK;
}

static bool evaluate_constant(struct reader *r, struct constant *c, char why[EXPR_WHY])
{
    const char *const name = c->entry->key;
    if (c->state == CONSTANT_DONE) return true;
    if (c->state == CONSTANT_BUSY) {
        snprintf(why, EXPR_WHY, "`%s` depends on itself", name);
        return false;
    }
    if (r->depth == MAX_CONSTANT_DEPTH) {
        snprintf(why, EXPR_WHY,
                 "a chain of constants that use each other has more than %d members; write some as "
                 "numbers",
                 MAX_CONSTANT_DEPTH);
        return false;
    }
    const struct expr_names names = {r, case_name, EXPR_FIXED};
    char inner[EXPR_WHY];
    c->state = CONSTANT_BUSY;
    r->depth++;
    const bool good = expr_value(slice_of(c->entry->value), &names, &c->q, inner);
    r->depth--;
    c->state = good ? CONSTANT_DONE : CONSTANT_TEXT;
    if (good) {
        const struct param *param = param_find(SECTION_top, name);
        if (param && c->q.dim.kind == DIM_PLAIN && dim_fits(&c->q.dim, param->unit)) {
            /* `dp = 0.001` is a length in all uses of dp. */
            struct slice unit = slice_of(param->unit);
            struct quantity one = {1, {DIM_KNOWN, 0, 0, 0}};
            if (unit_read(&unit, &one, inner)) c->q.dim = one.dim;
        }
        return true;
    }
    if (r->cause_named)
        snprintf(why, EXPR_WHY, "%s", inner);
    else
        snprintf(why, EXPR_WHY, "%.200s, needed for `%s`", inner, name);
    r->cause_named = true;
    return false;
}

/* A unit followed by digits, as in kg/m3: then as it is written, m^3. */
static bool unit_with_power(const char *name, char unit[EXPR_NAME])
{
    const size_t length = strcspn(name, "0123456789");
    snprintf(unit, EXPR_NAME, "%.*s", (int)length, name);
    if (!name[length] || name[length + strspn(name + length, "0123456789")] || !unit_known(unit))
        return false;
    snprintf(unit, EXPR_NAME, "%.*s^%.*s", (int)length, name, 8, name + length);
    return true;
}

bool case_name(void *context, const char *name, struct quantity *q, char why[EXPR_WHY])
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
    /* It may be defined in an invalid line. */
    r->cause_named |= r->lost;
    char unit[EXPR_NAME];
    if (unit_with_power(name, unit))
        snprintf(why, EXPR_WHY, "unknown name `%s`; did you mean the unit `%s`?", name, unit);
    else if (strcmp(name, "t") == 0)
        snprintf(why, EXPR_WHY,
                 "unknown name `t`: the time is known only in keys that take an expression in t "
                 "(of a [motion]: `velocity`, `x`, `y`, `turn`)");
    else if (near.name)
        snprintf(why, EXPR_WHY, "unknown name `%s`; did you mean `%s`?", name, near.name);
    else
        snprintf(why, EXPR_WHY, "unknown name `%s`; define it in [constants]", name);
    return false;
}

/* For the end of a message about quantities that do not fit: a --set that leaves out the unit which
 * a constant has in the file; or "". */
static const char *unit_left_out(struct reader *r, char text[300])
{
    for (int k = 0; k < r->n_constants; k++) {
        struct constant *const c = &r->constants[k];
        const struct entry *const e = c->entry;
        const struct expr_names names = {r, case_name, EXPR_FIXED};
        struct quantity before;
        char why[EXPR_WHY];
        if (!e->replaces || !evaluate_constant(r, c, why) || c->q.dim.kind != DIM_PLAIN) continue;
        if (!expr_value(slice_of(e->replaces), &names, &before, why)) continue;
        if (before.dim.kind != DIM_KNOWN) continue;
        snprintf(text, 300, "; --set %.60s has no unit, but the case has `%.60s = %.60s`: give one",
                 e->set, e->key, e->replaces);
        return text;
    }
    return "";
}

/* Whether a value has the name of a constant that cannot have it, as in `s, 2*s`. */
static bool uses_misnamed(const struct reader *r, const struct entry *e)
{
    const size_t length = r->misnamed ? strlen(r->misnamed) : 0;
    for (const char *at = e->value; length && (at = strstr(at, r->misnamed)) != NULL; at++) {
        const bool begins = at == e->value || !(isalnum((unsigned char)at[-1]) || at[-1] == '_');
        const char after = at[length];
        if (begins && !(isalnum((unsigned char)after) || after == '_')) return true;
    }
    return false;
}

/* A consequence of a problem already reported is not reported again. */
enum err case_bad_expression(struct reader *r, const struct entry *e, const char *why)
{
    if (uses_misnamed(r, e)) return ERR_INPUT;
    if (r->cause_named && r->n_problems > 0) return ERR_INPUT;
    char unit[300];
    const bool slashes = strstr(e->value, "//") && !strstr(why, "comment");
    return bad_value(r, e, "%s%s%s", why, unit_left_out(r, unit),
                     slashes ? "; `//` begins no comment here, # does" : "");
}

enum err case_all_constants(struct reader *r)
{
    struct scene *scene = r->scene;
    scene->constant = arena_alloc(&scene->arena, (size_t)r->n_constants, sizeof *scene->constant,
                                  "constants", r->diag);
    if (!scene->constant) return ERR_MEMORY;
    for (int k = 0; k < r->n_constants; k++) {
        const struct entry *e = r->constants[k].entry;
        const struct expr_names names = {r, case_name, EXPR_FIXED};
        struct quantity q = {0};
        char why[EXPR_WHY];
        /* Evaluates it again from its text, so that the message names the error. */
        r->cause_named = false;
        if (!expr_value(slice_of(e->value), &names, &q, why)) {
            TRY(case_go_on(r, case_bad_expression(r, e, why)));
            continue;
        }
        if (r->sections[e->section].id != SECTION_constants) continue;
        struct scene_constant *c = &scene->constant[scene->n_constants++];
        snprintf(c->name, sizeof c->name, "%s", e->key);
        c->value = q.value;
        c->plain = q.dim.kind == DIM_PLAIN;
        c->kg = q.dim.kg;
        c->m = q.dim.m;
        c->s = q.dim.s;
    }
    return ERR_OK;
}

/* --- numbers with units --- */

enum err case_check_dim(struct reader *r, const struct entry *e, const struct dim *dim,
                        const char *unit)
{
    if (dim_fits(dim, unit)) return ERR_OK;
    if (uses_misnamed(r, e)) return ERR_INPUT;
    char have[DIM_TEXT], want[DIM_TEXT], left_out[300];
    dim_text(dim, have);
    unit_dim_text(unit, want);
    return bad_value(r, e, "%s where %s is expected%s", have, want, unit_left_out(r, left_out));
}

enum err case_number(struct reader *r, const struct entry *e, struct slice text, const char *unit,
                     double *value)
{
    const struct expr_names names = {r, case_name, EXPR_FIXED};
    struct quantity q = {0};
    char why[EXPR_WHY];
    r->cause_named = false;
    if (!expr_value(text, &names, &q, why)) return case_bad_expression(r, e, why);
    TRY(case_check_dim(r, e, &q.dim, unit));
    *value = q.value;
    return ERR_OK;
}
