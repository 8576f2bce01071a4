/* SPDX-License-Identifier: MIT
 * Recursive descent to a small stack program; constant parts are evaluated during parsing. So a
 * value without x and y is a program of one number. */
#include "case/expr.h"
#include "base/elementary.h"
#include "case/expr_ops.h"
#include "case/scene.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

static bool say(struct compiler *c, const char *format, ...) SPHFSI_PRINTF(2, 3);
static bool say(struct compiler *c, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(c->why, EXPR_WHY, format, args);
    va_end(args);
    return false;
}

static bool parse_sum(struct compiler *c, struct dim *dim);
static bool parse_factor(struct compiler *c, struct dim *dim);

static int peek(struct compiler *c)
{
    while (c->rest.length && (*c->rest.at == ' ' || *c->rest.at == '\t')) {
        c->rest.at++;
        c->rest.length--;
    }
    return c->rest.length ? (unsigned char)*c->rest.at : 0;
}

static void skip(struct compiler *c, size_t n)
{
    c->rest.at += n;
    c->rest.length -= n;
}

static double run_unary(enum op_code code, double a)
{
    switch (code) {
    case OP_NEG: return -a;
    case OP_SQRT: return sqrt(a);
    case OP_SIN: return elementary_sin(a);
    case OP_COS: return elementary_cos(a);
    case OP_TAN: return elementary_tan(a);
    case OP_SINH: return elementary_sinh(a);
    case OP_COSH: return elementary_cosh(a);
    case OP_TANH: return elementary_tanh(a);
    case OP_EXP: return elementary_exp(a);
    case OP_LOG: return elementary_log(a);
    case OP_ROUND: return round(a);
    default: return fabs(a);
    }
}

static double run_binary(enum op_code code, double a, double b)
{
    switch (code) {
    case OP_ADD: return a + b;
    case OP_SUB: return a - b;
    case OP_MUL: return a * b;
    case OP_DIV: return a / b;
    case OP_POW: return elementary_pow(a, b);
    case OP_MIN: return a < b ? a : b;
    default: return a > b ? a : b;
    }
}

static bool push(struct compiler *c, enum op_code code, double value)
{
    if (c->n == MAX_OPS)
        return say(c, "the expression has more than %d operations; use [constants] for parts of it",
                   MAX_OPS);
    if (c->stack == MAX_STACK)
        return say(
            c, "the expression needs more than %d values at once; use [constants] for parts of it",
            MAX_STACK);
    c->op[c->n++] = (struct op){code, value};
    c->stack++;
    return true;
}

/* Appends an operation, or evaluates it if its operands are numbers. */
static bool operate(struct compiler *c, enum op_code code)
{
    const int operands = is_binary(code) ? 2 : 1;
    c->stack -= operands - 1;
    struct op *last = &c->op[c->n - 1];
    const bool number =
        last->code == OP_NUMBER && (operands == 1 || c->op[c->n - 2].code == OP_NUMBER);
    if (!number) {
        if (c->n == MAX_OPS)
            return say(
                c, "the expression has more than %d operations; use [constants] for parts of it",
                MAX_OPS);
        c->op[c->n++] = (struct op){code, 0};
        return true;
    }
    if (code == OP_DIV && last->value == 0) return say(c, "division by zero");
    if (operands == 2) {
        last[-1].value = run_binary(code, last[-1].value, last->value);
        c->n--;
        last--;
    } else {
        last->value = run_unary(code, last->value);
    }
    if (!isfinite(last->value)) return say(c, "the result is not a finite number");
    return true;
}

/* --- dimensions --- */

static bool is_pure(const struct dim *d)
{
    return fabs(d->m) < 1e-9 && fabs(d->kg) < 1e-9 && fabs(d->s) < 1e-9;
}

/* Of a sum, a minimum: both must agree; a plain number adopts the other's. */
static bool join_dims(struct compiler *c, struct dim *a, const struct dim *b)
{
    if (a->kind == DIM_ANY || b->kind == DIM_PLAIN) return true;
    if (b->kind == DIM_ANY || a->kind == DIM_PLAIN) {
        *a = *b;
        return true;
    }
    const struct dim difference = {DIM_KNOWN, a->m - b->m, a->kg - b->kg, a->s - b->s};
    if (is_pure(&difference)) return true;
    char left[DIM_TEXT], right[DIM_TEXT];
    dim_text(a, left);
    dim_text(b, right);
    return say(c, "%s and %s cannot be added or compared", left, right);
}

/* a times b^sign. */
static bool multiply_dims(struct compiler *c, struct dim *a, const struct dim *b, double sign)
{
    if (a->kind == DIM_ANY || b->kind == DIM_ANY) {
        a->kind = DIM_ANY;
        return true;
    }
    if (a->kind == DIM_PLAIN && b->kind == DIM_PLAIN) return true;
    const bool plain = a->kind != b->kind;
    a->kind = DIM_KNOWN;
    a->m += sign * b->m;
    a->kg += sign * b->kg;
    a->s += sign * b->s;
    if (plain && is_pure(a)) *a = (struct dim){DIM_PLAIN, 0, 0, 0};
    if (fabs(a->m) > 99 || fabs(a->kg) > 99 || fabs(a->s) > 99)
        return say(c, "the unit of the result has a power above 99; check the exponents");
    return true;
}

static bool pure_argument(struct compiler *c, const char *what, const struct dim *d)
{
    if (d->kind != DIM_KNOWN || is_pure(d)) return true;
    char text[DIM_TEXT];
    dim_text(d, text);
    return say(c, "%s of %s; it needs a number without a unit", what, text);
}

/* Of base^exponent; the exponent, if it is a number, is the last operation. */
static bool power_dims(struct compiler *c, struct dim *base, const struct dim *exponent)
{
    if (!pure_argument(c, "the power", exponent)) return false;
    if (base->kind == DIM_KNOWN && !is_pure(base)) {
        const struct op *last = &c->op[c->n - 1];
        if (last->code != OP_NUMBER)
            return say(c, "a quantity with a unit has an exponent that depends on x, y or t; the "
                          "exponent must be a number");
        const double p = last->value;
        if (fabs(p) > 9)
            return say(c, "a quantity with a unit has an exponent outside the range -9 to 9");
        base->m *= p;
        base->kg *= p;
        base->s *= p;
    }
    if (exponent->kind == DIM_ANY) base->kind = DIM_ANY;
    return true;
}

/* --- grammar --- */

static bool parse_number(struct compiler *c, struct dim *dim)
{
    char digits[64];
    size_t n = 0;
    bool exponent = false;
    while (n < c->rest.length) {
        const char ch = c->rest.at[n];
        const char next = n + 1 < c->rest.length ? c->rest.at[n + 1] : '\0';
        const char after = n + 2 < c->rest.length ? c->rest.at[n + 2] : '\0';
        const bool signed_digit = (next == '+' || next == '-') && isdigit((unsigned char)after);
        if ((ch == 'e' || ch == 'E') && !exponent &&
            (isdigit((unsigned char)next) || signed_digit)) {
            exponent = true;
            if (n + 1 >= sizeof digits - 1)
                return say(c, "the number has more than 60 characters; shorten it");
            digits[n++] = ch;
        } else if (!isdigit((unsigned char)ch) && ch != '.') {
            break;
        }
        if (n >= sizeof digits - 1)
            return say(c, "the number has more than 60 characters; shorten it");
        digits[n] = c->rest.at[n];
        n++;
    }
    digits[n] = '\0';
    char *end;
    struct quantity q = {strtod(digits, &end), {DIM_PLAIN, 0, 0, 0}};
    if (*end || end == digits) return say(c, "`%s` is not a number", digits);
    if (!isfinite(q.value)) return say(c, "%s is too large; the largest number is 1.8e308", digits);
    skip(c, n);
    const int next = peek(c);
    if (next == '%' || isalpha(next) || next == '_') {
        c->why[0] = '\0';
        if (!unit_read(&c->rest, &q, c->why)) {
            const size_t length = identifier_length(c->rest);
            if (c->why[0]) return false;
            const char *const near = unit_nearest(c->rest.at, length);
            if (near)
                return say(c, "`%.*s` after %s is not a unit; did you mean `%s`?", (int)length,
                           c->rest.at, digits, near);
            return say(c,
                       "`%.*s` after %s is not a unit (units: m km cm mm um, s min ms us, kg g, N, "
                       "Pa kPa MPa GPa, Hz kHz, rad deg, %%)",
                       (int)(length < 40 ? length : 40), c->rest.at, digits);
        }
        if (!isfinite(q.value))
            return say(c, "%s with its unit is too large; the largest number is 1.8e308", digits);
    }
    *dim = q.dim;
    return push(c, OP_NUMBER, q.value);
}

static bool parse_call(struct compiler *c, const struct function *f, struct dim *dim)
{
    skip(c, 1);
    if (!parse_sum(c, dim)) return false;
    const bool two = is_binary(f->code);
    if (two) {
        if (peek(c) != ',') return say(c, "%s needs two values: %s(a, b)", f->name, f->name);
        skip(c, 1);
        struct dim other = {0};
        if (!parse_sum(c, &other) || !join_dims(c, dim, &other)) return false;
    }
    if (peek(c) != ')') return say(c, "`(` after %s is not closed", f->name);
    skip(c, 1);
    if (f->code == OP_SQRT) {
        dim->m /= 2;
        dim->kg /= 2;
        dim->s /= 2;
    } else if (!two && f->code != OP_ABS) {
        if (!pure_argument(c, f->name, dim)) return false;
        if (dim->kind == DIM_KNOWN) dim->kind = DIM_PLAIN;
    }
    return operate(c, f->code);
}

static bool parse_constant(struct compiler *c, const char *name, struct dim *dim)
{
    if (strcmp(name, "pi") == 0) return push(c, OP_NUMBER, PI);
    if (strcmp(name, "t") == 0 && c->names->scope == EXPR_IN_TIME) {
        dim->kind = DIM_ANY;
        return push(c, OP_X, 0); /* evaluated at x = t */
    }
    if (strcmp(name, "t") == 0 && c->names->scope == EXPR_IN_BOTH) {
        dim->kind = DIM_ANY;
        return push(c, OP_T, 0);
    }
    if (strcmp(name, "x") == 0 || strcmp(name, "y") == 0) {
        if (c->names->scope != EXPR_IN_SPACE && c->names->scope != EXPR_IN_BOTH)
            return say(c, "`%s` is known only in keys that take an expression in x and y", name);
        dim->kind = DIM_ANY;
        return push(c, name[0] == 'x' ? OP_X : OP_Y, 0);
    }
    struct quantity q = {0, {DIM_PLAIN, 0, 0, 0}};
    c->why[0] = '\0';
    if (c->names->find(c->names->context, name, &q, c->why)) {
        *dim = q.dim;
        return push(c, OP_NUMBER, q.value);
    }
    if (c->why[0]) return false;
    return say(c, "unknown name `%s`", name);
}

static bool parse_name(struct compiler *c, struct dim *dim)
{
    const size_t length = identifier_length(c->rest);
    if (length >= EXPR_NAME)
        return say(c, "a name has more than %d characters; shorten it", EXPR_NAME - 1);
    char name[EXPR_NAME];
    memcpy(name, c->rest.at, length);
    name[length] = '\0';
    const struct slice start = c->rest;
    skip(c, length);
    const bool call = peek(c) == '(';
    for (size_t k = 0; call && k < COUNT_OF(functions); k++) {
        if (strcmp(functions[k].name, name) == 0) return parse_call(c, &functions[k], dim);
    }
    if (call) return say(c, "unknown function `%s`", name);
    struct quantity unit = {1, {DIM_PLAIN, 0, 0, 0}};
    if (unit_known(name) && strcmp(name, "g") != 0) {
        c->rest = start;
        if (!unit_read(&c->rest, &unit, c->why)) return false;
        *dim = unit.dim;
        return push(c, OP_NUMBER, unit.value);
    }
    return parse_constant(c, name, dim);
}

/* Whether a digit is followed by a comma and a digit: 0,005. */
static bool is_decimal_comma(const struct compiler *c)
{
    return c->rest.length > 1 && c->rest.at[0] == ',' && isdigit((unsigned char)c->rest.at[1]) &&
           c->rest.at > c->start && isdigit((unsigned char)c->rest.at[-1]);
}

/* An invalid character, and what was probably meant. */
static bool unexpected(struct compiler *c, int ch, const char *expected)
{
    char rest[16] = "";
    memcpy(rest, c->rest.at, c->rest.length < 4 ? c->rest.length : 4);
    const char *const strange = ch >= 0x80 ? strange_character(rest) : NULL;
    if (strange) return say(c, "%s is expected, not %s", expected, strange);
    if (is_decimal_comma(c))
        return say(c, "`,` where %s is expected; a decimal number is written with a point: %s",
                   expected, "0.005");
    if (ch == '/' && c->rest.at > c->start && c->rest.at[-1] == '/')
        return say(c, "`//` where %s is expected; a comment begins with #", expected);
    if (isprint(ch)) return say(c, "`%c` where %s is expected", ch, expected);
    return say(c, "a character outside ASCII (byte %d) where %s is expected", ch, expected);
}

static bool parse_primary(struct compiler *c, struct dim *dim)
{
    *dim = (struct dim){DIM_PLAIN, 0, 0, 0};
    const int ch = peek(c);
    if (ch == 0) return say(c, "a value is missing");
    if (isdigit(ch) || ch == '.') return parse_number(c, dim);
    if (isalpha(ch) || ch == '_') return parse_name(c, dim);
    if (ch == '(') {
        skip(c, 1);
        if (!parse_sum(c, dim)) return false;
        if (peek(c) != ')') return say(c, "`(` is not closed");
        skip(c, 1);
        return true;
    }
    return unexpected(c, ch, "a value");
}

static bool parse_power(struct compiler *c, struct dim *dim)
{
    if (!parse_primary(c, dim)) return false;
    if (peek(c) != '^') return true;
    skip(c, 1);
    struct dim exponent = {0};
    return parse_factor(c, &exponent) && power_dims(c, dim, &exponent) && operate(c, OP_POW);
}

static bool parse_factor(struct compiler *c, struct dim *dim)
{
    if (c->nesting == MAX_NESTING)
        return say(
            c, "parentheses or signs are nested more than %d deep; use [constants] for parts of it",
            MAX_NESTING);
    c->nesting++;
    const int ch = peek(c);
    bool good;
    if (ch == '-' || ch == '+') {
        skip(c, 1);
        good = parse_factor(c, dim) && (ch == '+' || operate(c, OP_NEG));
    } else {
        good = parse_power(c, dim);
    }
    c->nesting--;
    return good;
}

static bool parse_product(struct compiler *c, struct dim *dim)
{
    if (!parse_factor(c, dim)) return false;
    for (;;) {
        const int ch = peek(c);
        if (ch != '*' && ch != '/') return true;
        skip(c, 1);
        struct dim other = {0};
        if (!parse_factor(c, &other)) return false;
        if (!multiply_dims(c, dim, &other, ch == '*' ? 1 : -1)) return false;
        if (!operate(c, ch == '*' ? OP_MUL : OP_DIV)) return false;
    }
}

static bool parse_sum(struct compiler *c, struct dim *dim)
{
    if (!parse_product(c, dim)) return false;
    for (;;) {
        const int ch = peek(c);
        if (ch != '+' && ch != '-') return true;
        skip(c, 1);
        struct dim other = {0};
        if (!parse_product(c, &other) || !join_dims(c, dim, &other)) return false;
        if (!operate(c, ch == '+' ? OP_ADD : OP_SUB)) return false;
    }
}

static bool parse_all(struct compiler *c, struct dim *dim)
{
    if (!parse_sum(c, dim)) return false;
    const int ch = peek(c);
    if (ch == 0 && c->rest.length == 0) return true;
    if (ch == ')') return say(c, "`)` without `(`");
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
    struct expr *e = arena_alloc(a, 1, sizeof *e, "expression", d);
    if (!e) return ERR_MEMORY;
    e->op = arena_alloc(a, (size_t)c.n, sizeof *e->op, "expression", d);
    e->source = arena_alloc(a, text.length + 1, 1, "expression", d);
    if (!e->op || !e->source) return ERR_MEMORY;
    memcpy(e->op, c.op, (size_t)c.n * sizeof *e->op);
    memcpy(e->source, text.at, text.length);
    e->n = c.n;
    *result = e;
    return ERR_OK;
}

enum err expr_copy(struct expr **copy, const struct expr *e, struct arena *a, struct diag *d)
{
    *copy = arena_alloc(a, 1, sizeof **copy, "expression", d);
    if (!*copy) return ERR_MEMORY;
    **copy = *e;
    (*copy)->op = arena_alloc(a, (size_t)e->n, sizeof *e->op, "expression", d);
    if (!(*copy)->op) return ERR_MEMORY;
    memcpy((*copy)->op, e->op, (size_t)e->n * sizeof *e->op);
    return ERR_OK;
}

void expr_fix_time(struct expr *fixed, const struct expr *e, double t)
{
    struct op *const op = fixed->op;
    int n = 0;
    for (int k = 0; k < e->n; k++) {
        const enum op_code code = e->op[k].code;
        const bool leaf = code == OP_NUMBER || code == OP_X || code == OP_Y || code == OP_T;
        const int operands = leaf ? 0 : is_binary(code) ? 2 : 1;
        bool number = operands > 0;
        for (int j = 1; j <= operands; j++) number &= op[n - j].code == OP_NUMBER;
        if (!number) {
            op[n++] = code == OP_T ? (struct op){OP_NUMBER, t} : e->op[k];
            continue;
        }
        n -= operands - 1;
        op[n - 1].value = operands == 2 ? run_binary(code, op[n - 1].value, op[n].value)
                                        : run_unary(code, op[n - 1].value);
    }
    fixed->n = n;
}

bool expr_varies(const struct expr *e)
{
    for (int k = 0; k < e->n; k++)
        if (e->op[k].code == OP_T) return true;
    return false;
}

bool expr_is_number(const struct expr *e) { return e->n == 1 && e->op[0].code == OP_NUMBER; }

const char *expr_source(const struct expr *e) { return e->source; }

double scene_expr_at(const struct expr *e, double x, double y)
{
    return scene_expr_at_time(e, x, y, 0);
}

double scene_expr_at_time(const struct expr *e, double x, double y, double t)
{
    /* The compiler has counted: all operands exist, MAX_STACK suffices, one value remains. */
    double stack[MAX_STACK] = {0};
    int top = -1;
    for (int k = 0; k < e->n; k++) {
        const struct op *op = &e->op[k];
        if (op->code == OP_NUMBER) {
            stack[++top] = op->value;
        } else if (op->code == OP_X || op->code == OP_Y || op->code == OP_T) {
            stack[++top] = op->code == OP_X ? x : op->code == OP_Y ? y : t;
        } else if (is_binary(op->code)) {
            top--;
            stack[top] = run_binary(op->code, stack[top], stack[top + 1]);
        } else {
            stack[top] = run_unary(op->code, stack[top]);
        }
    }
    return stack[0];
}

const char *expr_reserved(const char *name)
{
    if (strcmp(name, "pi") == 0) return "the number pi";
    if (strcmp(name, "x") == 0 || strcmp(name, "y") == 0) return "a coordinate";
    for (size_t k = 0; k < COUNT_OF(functions); k++)
        if (strcmp(functions[k].name, name) == 0) return "a function";
    if (unit_known(name) && strcmp(name, "g") != 0) return "a unit";
    return NULL;
}
