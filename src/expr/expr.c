/* SPDX-License-Identifier: MIT
 * Recursive descent to a small stack program; constant parts are evaluated during parsing. So a
 * value without x, y and t is a program of one number. */
#include "expr/expr.h"
#include "expr/ops.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdlib.h>

static const struct function {
    const char *name;
    enum op_code code;
} functions[] = {
    {"sqrt", OP_SQRT}, {"sin", OP_SIN},   {"cos", OP_COS}, {"tan", OP_TAN}, {"sinh", OP_SINH},
    {"cosh", OP_COSH}, {"tanh", OP_TANH}, {"exp", OP_EXP}, {"log", OP_LOG}, {"round", OP_ROUND},
    {"abs", OP_ABS},   {"min", OP_MIN},   {"max", OP_MAX},
};

enum { MAX_OPS = 1024, MAX_NESTING = 64 };

struct compiler {
    struct slice rest;
    const char *start; /* of the text */
    const struct expr_names *names;
    int nesting;
    int stack; /* operands on the stack at run time */
    int n;
    struct op op[MAX_OPS];
    char *why;
};

static bool fail(struct compiler *c, const char *format, ...) SPHFSI_PRINTF(2, 3);
static bool fail(struct compiler *c, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(c->why, EXPR_WHY, format, args);
    va_end(args);
    return false;
}

static bool parse_sum(struct compiler *c, struct dim *dim);
static bool parse_factor(struct compiler *c, struct dim *dim);

/* The next character after blanks; 0 at the end. */
static int peek(struct compiler *c)
{
    c->rest = slice_trimmed(c->rest);
    return c->rest.length ? (unsigned char)*c->rest.at : 0;
}

/* Whether it is the given one, which is then taken. */
static bool take(struct compiler *c, int ch)
{
    if (peek(c) != ch) return false;
    c->rest = slice_after(c->rest, 1);
    return true;
}

/* Appends an operation, or evaluates it if its operands are numbers. */
static bool append(struct compiler *c, struct op op)
{
    const int used = operands(op.code);
    struct op *const first = c->op + c->n - used, *const last = first + (used == 2);
    bool number = used > 0;
    for (int k = 0; k < used; k++) number &= first[k].code == OP_NUMBER;
    c->stack += 1 - used;
    if (c->stack > MAX_STACK)
        return fail(
            c, "the expression needs more than %d values at once; use [constants] for parts of it",
            MAX_STACK);
    if (!number && c->n == MAX_OPS)
        return fail(c,
                    "the expression has more than %d operations; use [constants] for parts of it",
                    MAX_OPS);
    if (!number) {
        c->op[c->n++] = op;
        return true;
    }
    if (op.code == OP_DIV && last->value == 0) return fail(c, "division by zero");
    first->value = expr_operate(&op, first->value, last->value);
    c->n -= used - 1;
    return isfinite(first->value) || fail(c, "the result is not a finite number");
}

static bool operate(struct compiler *c, enum op_code code, double value)
{
    return append(c, (struct op){.code = code, .value = value});
}

/* --- dimensions --- */

static const struct dim pure = {DIM_KNOWN, {0, 0, 0}};

/* Units of a sum or a minimum: both must agree; a plain number adopts those of the other. */
static bool join_dims(struct compiler *c, struct dim *a, const struct dim *b)
{
    if (a->kind == DIM_ANY || b->kind == DIM_PLAIN) return true;
    if (b->kind == DIM_ANY || a->kind == DIM_PLAIN) {
        *a = *b;
        return true;
    }
    if (dim_same(a, b)) return true;
    return fail(c, "%s and %s cannot be added or compared", dim_text(a).text, dim_text(b).text);
}

/* a times b^sign. */
static bool multiply_dims(struct compiler *c, struct dim *a, const struct dim *b, double sign)
{
    const bool plain = a->kind != b->kind;
    bool large = false;
    if (a->kind == DIM_ANY || b->kind == DIM_ANY) a->kind = DIM_ANY;
    if (a->kind == DIM_ANY || (a->kind == DIM_PLAIN && !plain)) return true;
    a->kind = DIM_KNOWN;
    for (int k = 0; k < 3; k++) {
        a->power[k] += sign * b->power[k];
        large |= fabs(a->power[k]) > 99;
    }
    if (large) return fail(c, "the unit of the result has a power above 99; check the exponents");
    if (plain && dim_same(a, &pure)) *a = (struct dim){DIM_PLAIN, {0, 0, 0}};
    return true;
}

static void scale_dim(struct dim *a, double power)
{
    for (int k = 0; k < 3; k++) a->power[k] *= power;
}

static bool pure_argument(struct compiler *c, const char *what, const struct dim *d)
{
    if (d->kind != DIM_KNOWN || dim_same(d, &pure)) return true;
    return fail(c, "%s of %s; it needs a number without a unit", what, dim_text(d).text);
}

/* Units of base^exponent; the exponent, if it is a number, is the last operation. */
static bool power_dims(struct compiler *c, struct dim *base, const struct dim *exponent)
{
    const struct op *const last = &c->op[c->n - 1];
    if (!pure_argument(c, "the power", exponent)) return false;
    if (base->kind == DIM_KNOWN && !dim_same(base, &pure)) {
        if (last->code != OP_NUMBER)
            return fail(c, "a quantity with a unit has an exponent that depends on x, y or t; the "
                           "exponent must be a number");
        if (fabs(last->value) > 9)
            return fail(c, "a quantity with a unit has an exponent outside the range -9 to 9");
        scale_dim(base, last->value);
    }
    if (exponent->kind == DIM_ANY) base->kind = DIM_ANY;
    return true;
}

/* --- grammar --- */

static bool parse_number(struct compiler *c, struct dim *dim)
{
    char digits[64], *end;
    const size_t n = number_length(c->rest);
    if (n >= sizeof digits) return fail(c, "the number has more than 60 characters; shorten it");
    memcpy(digits, c->rest.at, n);
    digits[n] = '\0';
    struct quantity q = {strtod(digits, &end), {DIM_PLAIN, {0, 0, 0}}};
    if (*end || end == digits) return fail(c, "`%s` is not a number", digits);
    c->rest = slice_after(c->rest, n);
    const int next = peek(c);
    c->why[0] = '\0';
    if ((next == '%' || isalpha(next) || next == '_') && !unit_read(&c->rest, &q, c->why)) {
        const struct slice word = slice_identifier(c->rest);
        const int shown = (int)(word.length < 40 ? word.length : 40);
        if (c->why[0]) return false;
        return fail(c,
                    "`%.*s` after %s is not a unit (units: m km cm mm um, s min ms us, kg g, N, "
                    "Pa kPa MPa GPa, Hz kHz, rad deg, %%)",
                    shown, word.at, digits);
    }
    if (!isfinite(q.value))
        return fail(c, "%s is too large; the largest number is 1.8e308", digits);
    *dim = q.dim;
    return operate(c, OP_NUMBER, q.value);
}

static bool close_call(struct compiler *c, const char *name)
{
    if (take(c, ')')) return true;
    if (peek(c) == ',') return fail(c, "%s has too many values", name);
    return fail(c, "`(` after %s is not closed", name);
}

static bool parse_call(struct compiler *c, const struct function *f, struct dim *dim)
{
    const bool two = operands(f->code) == 2;
    struct dim other = {0};
    if (!take(c, '(') || !parse_sum(c, dim)) return false;
    if (two && !take(c, ',')) return fail(c, "%s needs two values: %s(a, b)", f->name, f->name);
    if (two && (!parse_sum(c, &other) || !join_dims(c, dim, &other))) return false;
    if (!close_call(c, f->name)) return false;
    if (f->code == OP_SQRT) {
        scale_dim(dim, 0.5);
    } else if (!two && f->code != OP_ABS) {
        if (!pure_argument(c, f->name, dim)) return false;
        if (dim->kind == DIM_KNOWN) dim->kind = DIM_PLAIN;
    }
    return operate(c, f->code, 0);
}

/* A table takes and gives SI values, whatever they are of. */
static bool parse_table(struct compiler *c, const char *name, struct dim *dim)
{
    c->why[0] = '\0';
    const struct expr_table *const table =
        c->names->table ? c->names->table(c->names->context, name, c->why) : NULL;
    if (!table) return c->why[0] ? false : fail(c, "unknown function `%s`", name);
    if (!take(c, '(') || !parse_sum(c, dim) || !close_call(c, name)) return false;
    if (dim->kind != DIM_ANY) *dim = (struct dim){DIM_PLAIN, {0, 0, 0}};
    return append(c, (struct op){.code = OP_TABLE, .table = table});
}

/* pi, a coordinate, the time, the elongation, or a constant. */
static bool parse_constant(struct compiler *c, const char *name, struct dim *dim)
{
    const enum expr_scope scope = c->names->scope;
    const bool t = strcmp(name, "t") == 0, x = strcmp(name, "x") == 0, y = strcmp(name, "y") == 0,
               e = strcmp(name, "e") == 0;
    if (strcmp(name, "pi") == 0) return operate(c, OP_NUMBER, PI);
    if ((t && scope & EXPR_IN_TIME) || ((x || y) && scope & EXPR_IN_SPACE) ||
        (e && scope == EXPR_IN_ELONGATION)) {
        dim->kind = DIM_ANY; /* an expression in t or e alone is evaluated at x = t or x = e */
        return operate(c, y ? OP_Y : t && scope == EXPR_IN_BOTH ? OP_T : OP_X, 0);
    }
    if (x || y)
        return fail(c, "`%s` is known only in keys that take an expression in x and y", name);
    struct quantity q = {0, {DIM_PLAIN, {0, 0, 0}}};
    c->why[0] = '\0';
    if (c->names->find(c->names->context, name, &q, c->why)) {
        *dim = q.dim;
        return operate(c, OP_NUMBER, q.value);
    }
    return c->why[0] ? false : fail(c, "unknown name `%s`", name);
}

static bool parse_name(struct compiler *c, struct dim *dim)
{
    const struct slice word = slice_identifier(c->rest);
    struct quantity unit = {1, {DIM_PLAIN, {0, 0, 0}}};
    char name[EXPR_NAME] = "";
    if (word.length >= EXPR_NAME)
        return fail(c, "a name has more than %d characters; shorten it", EXPR_NAME - 1);
    memcpy(name, word.at, word.length);
    const struct slice after = slice_trimmed(slice_after(c->rest, word.length));
    const bool call = after.length && *after.at == '(';
    if (!call && unit_known(name) && strcmp(name, "g") != 0) {
        if (!unit_read(&c->rest, &unit, c->why)) return false;
        *dim = unit.dim;
        return operate(c, OP_NUMBER, unit.value);
    }
    c->rest = after;
    for (size_t k = 0; call && k < COUNT_OF(functions); k++)
        if (strcmp(functions[k].name, name) == 0) return parse_call(c, &functions[k], dim);
    return call ? parse_table(c, name, dim) : parse_constant(c, name, dim);
}

/* An invalid character, and what was probably meant. */
static bool unexpected(struct compiler *c, int ch, const char *expected)
{
    const char *const at = c->rest.at;
    const int before = at > c->start ? (unsigned char)at[-1] : 0;
    const int after = c->rest.length > 1 ? (unsigned char)at[1] : 0;
    if (ch == ',' && isdigit(before) && isdigit(after)) /* as in 0,005 */
        return fail(c, "`,` where %s is expected; a decimal number is written with a point: 0.005",
                    expected);
    if (ch == '/' && before == '/')
        return fail(c, "`//` where %s is expected; a comment begins with #", expected);
    if (isprint(ch)) return fail(c, "`%c` where %s is expected", ch, expected);
    return fail(c,
                "a character outside ASCII, such as a no-break space, a typographic minus or a "
                "micro sign, where %s is expected",
                expected);
}

static bool parse_primary(struct compiler *c, struct dim *dim)
{
    *dim = (struct dim){DIM_PLAIN, {0, 0, 0}};
    const int ch = peek(c);
    if (ch == 0) return fail(c, "a value is missing");
    if (isdigit(ch) || ch == '.') return parse_number(c, dim);
    if (isalpha(ch) || ch == '_') return parse_name(c, dim);
    if (!take(c, '(')) return unexpected(c, ch, "a value");
    return parse_sum(c, dim) && (take(c, ')') || fail(c, "`(` is not closed"));
}

static bool parse_power(struct compiler *c, struct dim *dim)
{
    struct dim exponent = {0};
    if (!parse_primary(c, dim)) return false;
    if (!take(c, '^')) return true;
    return parse_factor(c, &exponent) && power_dims(c, dim, &exponent) && operate(c, OP_POW, 0);
}

static bool parse_factor(struct compiler *c, struct dim *dim)
{
    if (c->nesting == MAX_NESTING)
        return fail(
            c, "parentheses or signs are nested more than %d deep; use [constants] for parts of it",
            MAX_NESTING);
    c->nesting++;
    const bool good = take(c, '-')   ? parse_factor(c, dim) && operate(c, OP_NEG, 0)
                      : take(c, '+') ? parse_factor(c, dim)
                                     : parse_power(c, dim);
    c->nesting--;
    return good;
}

static bool parse_product(struct compiler *c, struct dim *dim)
{
    if (!parse_factor(c, dim)) return false;
    for (;;) {
        const bool times = take(c, '*');
        struct dim other = {0};
        if (!times && !take(c, '/')) return true;
        if (!parse_factor(c, &other) || !multiply_dims(c, dim, &other, times ? 1 : -1) ||
            !operate(c, times ? OP_MUL : OP_DIV, 0))
            return false;
    }
}

static bool parse_sum(struct compiler *c, struct dim *dim)
{
    if (!parse_product(c, dim)) return false;
    for (;;) {
        const bool plus = take(c, '+');
        struct dim other = {0};
        if (!plus && !take(c, '-')) return true;
        if (!parse_product(c, &other) || !join_dims(c, dim, &other) ||
            !operate(c, plus ? OP_ADD : OP_SUB, 0))
            return false;
    }
}

static bool parse_all(struct compiler *c, struct dim *dim)
{
    if (!parse_sum(c, dim)) return false;
    const int ch = peek(c);
    if (c->rest.length == 0) return true;
    if (ch == ')') return fail(c, "`)` without `(`");
    return unexpected(c, ch, "an operator");
}

bool expr_value(struct slice text, const struct expr_names *names, struct quantity *result,
                char why[EXPR_WHY])
{
    struct expr_names fixed = *names;
    fixed.scope = EXPR_FIXED;
    struct compiler c = {.rest = text, .start = text.at, .names = &fixed, .why = why};
    if (!parse_all(&c, &result->dim)) return false;
    result->value = c.op[0].value;
    return true;
}

enum err expr_compile(struct expr **result, struct slice text, const struct expr_names *names,
                      struct dim *dim, struct arena *a, char why[EXPR_WHY], struct diag *d)
{
    struct compiler c = {.rest = text, .start = text.at, .names = names, .why = why};
    if (!parse_all(&c, dim)) return ERR_INPUT;
    char *const source = arena_alloc(a, text.length + 1, 1, "expression", d);
    if (!source) return ERR_MEMORY;
    memcpy(source, text.at, text.length);
    return expr_copy(result, &(struct expr){c.n, c.op, source}, a, d);
}

const char *expr_reserved(const char *name)
{
    if (strcmp(name, "pi") == 0) return "the number pi";
    if (strcmp(name, "x") == 0 || strcmp(name, "y") == 0) return "a coordinate";
    for (size_t k = 0; k < COUNT_OF(functions); k++)
        if (strcmp(functions[k].name, name) == 0) return "a function";
    return unit_known(name) && strcmp(name, "g") != 0 ? "a unit" : NULL;
}
