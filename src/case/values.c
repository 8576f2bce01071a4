/* SPDX-License-Identifier: MIT
 * Values of a case file by the type of their key: numbers, choices, texts, expressions, shapes. */
#include "case/case.h"

static enum err check_range(struct reader *r, const struct param *param, double value)
{
    const bool low = param->low.open ? value > param->low.value : value >= param->low.value;
    const bool high = param->high.open ? value < param->high.value : value <= param->high.value;
    if (low && high) return ERR_OK;
    char unit[40] = "";
    if (param->unit && strcmp(param->unit, "1") != 0)
        snprintf(unit, sizeof unit, " %s", param->unit);
    return bad_value(r, "out of range: it must be %s %g%s and %s %g%s",
                     param->low.open ? "above" : "at least", param->low.value, unit,
                     param->high.open ? "below" : "at most", param->high.value, unit);
}

static enum err read_integer(struct reader *r, const struct param *param, int *value)
{
    double number = 0;
    TRY(case_number(r, slice_of(r->entry->value), "1", &number));
    TRY(check_range(r, param, number));
    if (number != floor(number)) return bad_value(r, "a whole number is expected");
    *value = (int)number;
    return ERR_OK;
}

static enum err read_choice(struct reader *r, const struct param *param, int *value)
{
    enum { MAX_CHOICES = 32 };
    struct choice_name name[MAX_CHOICES];
    struct nearest near = {0};
    for (int k = 0; k < MAX_CHOICES; k++) {
        name[k] = param_choice(param, k);
        if (!*name[k].text) break;
        nearest_offer(&near, r->entry->value, name[k].text);
        if (strcmp(name[k].text, r->entry->value) != 0) continue;
        *value = k;
        return ERR_OK;
    }
    if (near.name) return bad_value(r, "did you mean `%s`? Known: %s", near.name, param->choices);
    return bad_value(r, "unknown choice; known: %s", param->choices);
}

/* Texts are written to JSON, HDF5 and plots, which all need UTF-8. */
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

static enum err read_text(struct reader *r, char value[SCENE_TEXT])
{
    struct slice text = slice_of(r->entry->value);
    if (text.length >= 2 && *text.at == '"') {
        text.at++;
        text.length -= 2;
    }
    if (text.length >= SCENE_TEXT)
        return bad_value(r, "the text is longer than %d bytes; shorten it", SCENE_TEXT - 1);
    if (!is_utf8(text))
        return bad_entry(r, "`%s` is not UTF-8 text; save the file as UTF-8", r->entry->key);
    memset(value, 0, SCENE_TEXT);
    memcpy(value, text.at, text.length);
    return ERR_OK;
}

/* The number of pieces between commas is that of the components. */
static enum err check_count(struct reader *r, const struct param *param)
{
    const int n = slice_count(slice_of(r->entry->value), ',');
    const char *const verb = n == 1 ? "is" : "are";
    if (n == param->count) return ERR_OK;
    if (param->type == PARAM_VECTOR)
        return bad_value(r, "two components are expected, `%s = X, Y`; there %s %d%s", param->key,
                         verb, n, comma_hint(r->entry->value));
    return bad_value(r, "%s expected, with commas between them; there %s %d",
                     param->count == 1 ? "one expression is" : "two expressions are", verb, n);
}

static enum err read_list(struct reader *r, const struct param *param, double *value)
{
    struct slice rest = slice_of(r->entry->value), piece = rest;
    for (; slice_next(&rest, ',', &piece); value++) {
        TRY(case_number(r, piece, param->unit, value));
        /* The largest range of params.def: squares and products of such values are finite. */
        if (!(fabs(*value) <= 1e15))
            return bad_value(r, "out of range: the magnitude must be 1e15 or less");
    }
    return ERR_OK;
}

static enum err read_expressions(struct reader *r, const struct param *param,
                                 struct scene_expr *field)
{
    const struct expr_names names = case_names(r, param->scope);
    struct slice rest = slice_of(r->entry->value), piece = rest;
    TRY(check_count(r, param));
    for (int k = 0; slice_next(&rest, ',', &piece); k++) {
        char why[EXPR_WHY];
        struct dim dim = {0};
        r->cause_named = false;
        const enum err err =
            expr_compile(&field->e[k], piece, &names, &dim, &r->scene->arena, why, r->diag);
        if (err == ERR_INPUT) return case_bad_expression(r, why);
        if (err) return err;
        TRY(case_check_dim(r, &dim, param->unit));
    }
    return ERR_OK;
}

/* Numbers, or expressions if they depend on t. */
static enum err read_time_vector(struct reader *r, const struct param *param, void *section)
{
    double *const value = (double *)(void *)((char *)section + param->offset);
    struct scene_expr *const in_time = (void *)((char *)section + param->expr_offset);
    TRY(read_expressions(r, param, in_time));
    for (int k = 0; k < 2; k++) {
        value[k] = expr_at_arg(in_time->e[k], 0);
        if (!(fabs(value[k]) <= 1e15))
            return bad_value(
                r, "component %d at t = 0 must be a finite number of magnitude 1e15 or less",
                k + 1);
        if (expr_is_number(in_time->e[k])) in_time->e[k] = NULL;
    }
    return ERR_OK;
}

enum err case_value(struct reader *r, const struct param *param, void *section)
{
    void *const place = (char *)section + param->offset;
    switch (param->type) {
    case PARAM_REAL:
        TRY(case_number(r, slice_of(r->entry->value), param->unit, place));
        return check_range(r, param, *(double *)place);
    case PARAM_INTEGER: return read_integer(r, param, place);
    case PARAM_CHOICE: return read_choice(r, param, place);
    case PARAM_TEXT: return read_text(r, place);
    case PARAM_VECTOR:
        if (param->expr_offset) return read_time_vector(r, param, section);
        TRY(check_count(r, param));
        return read_list(r, param, place);
    case PARAM_EXPR: return read_expressions(r, param, place);
    case PARAM_SHAPES: return case_shape(r, place);
    case PARAM_HINGES: break;
    }
    return case_hinge(r, place);
}
