/* SPDX-License-Identifier: MIT
 * Named constants, and numbers with units. */
#include "case/case.h"

enum { MAX_CONSTANT_DEPTH = 32 };

struct expr_names case_names(struct reader *r, enum expr_scope scope)
{
    return (struct expr_names){r, case_name, scope, case_function};
}

/* --- constants --- */

static struct constant *find_constant(struct reader *r, const char *name)
{
    for (int k = 0; k < r->n_constants; k++)
        if (strcmp(r->constants[k].entry->key, name) == 0) return &r->constants[k];
    return NULL;
}

static enum err collect_constant(struct reader *r)
{
    const struct entry *const e = r->entry;
    const char *const meaning =
        param_find(SECTION_top, e->key) ? "a key at the top of the file" : expr_reserved(e->key);
    const struct constant *const before = find_constant(r, e->key);
    if (meaning)
        return bad_entry(r, "a constant cannot be named `%s`: that is %s; rename it", e->key,
                         meaning);
    if (before)
        return bad_entry(r, "`%s` is given twice, first in line %d; leave one out", e->key,
                         before->entry->line);
    if (r->n_constants == CASE_MAX_CONSTANTS)
        return bad_entry(r, "more than %d constants are given; write some as numbers",
                         CASE_MAX_CONSTANTS);
    r->constants[r->n_constants++] = (struct constant){.entry = e};
    return ERR_OK;
}

enum err case_collect_constants(struct reader *r)
{
    const int before = r->n_problems;
    TRY(arena_array(&r->temp, &r->constants, CASE_MAX_CONSTANTS + (size_t)PARAM_COUNT, "constants",
                    r->diag));
    for (int k = 0; k < r->n_entries; k++) {
        r->entry = &r->entries[k];
        if (r->sections[r->entry->section].id == SECTION_constants)
            TRY(case_go_on(r, collect_constant(r)));
    }
    for (int k = 0; k < r->n_entries; k++) {
        const struct entry *const e = &r->entries[k];
        const struct param *const param = param_find(SECTION_top, e->key);
        if (r->sections[e->section].id == SECTION_top && param && param->type == PARAM_REAL &&
            !find_constant(r, e->key))
            r->constants[r->n_constants++] = (struct constant){.entry = e};
    }
    return r->n_problems > before ? ERR_INPUT : ERR_OK;
}

static bool evaluate_constant(struct reader *r, struct constant *c, char why[EXPR_WHY])
{
    const struct expr_names names = case_names(r, EXPR_FIXED);
    const char *const name = c->entry->key;
    if (c->state == CONSTANT_DONE) return true;
    if (c->state == CONSTANT_BUSY) {
        snprintf(why, EXPR_WHY, "`%s` depends on itself", name);
        r->cause_named = true;
        return false;
    }
    if (r->depth > MAX_CONSTANT_DEPTH) {
        snprintf(why, EXPR_WHY,
                 "a chain of constants that use each other has more than %d members; write some as "
                 "numbers",
                 MAX_CONSTANT_DEPTH);
        return false;
    }
    c->state = CONSTANT_BUSY;
    r->depth++;
    const bool good = expr_value(slice_of(c->entry->value), &names, &c->q, why);
    r->depth--;
    c->state = good ? CONSTANT_DONE : CONSTANT_TEXT;
    const struct param *const param = param_find(SECTION_top, name);
    if (good && param && c->q.dim.kind == DIM_PLAIN) /* `dp = 0.001` is a length in all its uses */
        c->q.dim = unit_dim(param->unit);
    return good;
}

bool case_name(void *context, const char *name, struct quantity *q, char why[EXPR_WHY])
{
    struct reader *const r = context;
    struct constant *const c = find_constant(r, name);
    if (c && evaluate_constant(r, c, why)) {
        *q = c->q;
        return true;
    }
    if (c) {
        const size_t used = strlen(why);
        if (!r->cause_named) snprintf(why + used, EXPR_WHY - used, ", needed for `%.64s`", name);
        r->cause_named = true;
        return false;
    }
    r->cause_named |= r->incomplete; /* it may be defined in an invalid line */
    struct nearest near = {0};
    for (int k = 0; k < r->n_constants; k++) nearest_offer(&near, name, r->constants[k].entry->key);
    if (strcmp(name, "t") == 0)
        snprintf(why, EXPR_WHY,
                 "unknown name `t`: the time is known only in keys that take an expression in t");
    else if (scene_find(r->scene, SECTION_table, name) >= 0)
        snprintf(why, EXPR_WHY, "`%s` is a [table]; write `%s(t)`", name, name);
    else
        snprintf(why, EXPR_WHY, "unknown name `%s`%s", name,
                 near.name ? nearest_hint(&near) : "; define it in [constants]");
    return false;
}

/* A consequence of a problem already reported is not reported again. */
enum err case_bad_expression(struct reader *r, const char *why)
{
    if (r->cause_named && r->n_problems > 0) return ERR_INPUT;
    return bad_value(r, "%s", why);
}

enum err case_all_constants(struct reader *r)
{
    struct scene *const scene = r->scene;
    TRY(arena_array(&scene->arena, &scene->constant, r->n_constants, "constants", r->diag));
    for (int k = 0; k < r->n_constants; k++) {
        struct constant *const c = &r->constants[k];
        char why[EXPR_WHY];
        r->cause_named = false;
        r->entry = c->entry;
        if (!evaluate_constant(r, c, why))
            TRY(case_go_on(r, case_bad_expression(r, why)));
        else if (r->sections[c->entry->section].id == SECTION_constants) {
            struct scene_constant *const to = &scene->constant[scene->n_constants++];
            snprintf(to->name, sizeof to->name, "%s", c->entry->key);
            to->value = c->q.value;
            to->dim = c->q.dim;
        }
    }
    return ERR_OK;
}

/* --- numbers with units --- */

enum err case_check_dim(struct reader *r, const struct dim *dim, const char *unit)
{
    const struct dim expected = unit_dim(unit);
    if (dim_fits(dim, unit)) return ERR_OK;
    return bad_value(r, "%s where %s is expected", dim_text(dim).text, dim_text(&expected).text);
}

enum err case_number(struct reader *r, struct slice text, const char *unit, double *value)
{
    const struct expr_names names = case_names(r, EXPR_FIXED);
    struct quantity q = {0};
    char why[EXPR_WHY];
    r->cause_named = false;
    if (!expr_value(text, &names, &q, why)) return case_bad_expression(r, why);
    TRY(case_check_dim(r, &q.dim, unit));
    *value = q.value;
    return ERR_OK;
}
