/* SPDX-License-Identifier: MIT
 * Runs the stack program of an expression: on numbers, or on numbers with their first two
 * derivatives in t. The compiler has counted: all operands exist, MAX_STACK suffices, one value
 * remains. */
#include "expr/expr.h"
#include "base/elementary.h"
#include "expr/ops.h"

double expr_operate(enum op_code code, double a, double b)
{
    switch (code) {
    case OP_ADD: return a + b;
    case OP_SUB: return a - b;
    case OP_MUL: return a * b;
    case OP_DIV: return a / b;
    case OP_POW: return elementary_pow(a, b);
    case OP_MIN: return a < b ? a : b;
    case OP_MAX: return a > b ? a : b;
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

double expr_at(const struct expr *e, double x, double y) { return expr_at_time(e, x, y, 0); }

double expr_at_time(const struct expr *e, double x, double y, double t)
{
    double stack[MAX_STACK] = {0};
    int top = -1;
    for (int k = 0; k < e->n; k++) {
        const enum op_code code = e->op[k].code;
        if (operands(code) == 0) {
            const double leaf[] = {e->op[k].value, x, y, t};
            stack[++top] = leaf[code];
            continue;
        }
        top -= operands(code) - 1;
        stack[top] = expr_operate(code, stack[top], stack[top + 1]);
    }
    return stack[0];
}

void expr_fix_time(struct expr *fixed, const struct expr *e, double t)
{
    struct op *const op = fixed->op;
    int n = 0;
    for (int k = 0; k < e->n; k++) {
        const enum op_code code = e->op[k].code;
        const int used = operands(code);
        bool number = used > 0;
        for (int j = 1; j <= used; j++) number &= op[n - j].code == OP_NUMBER;
        if (!number) {
            op[n++] = code == OP_T ? (struct op){OP_NUMBER, t} : e->op[k];
            continue;
        }
        n -= used - 1;
        op[n - 1].value = expr_operate(code, op[n - 1].value, op[n].value);
    }
    fixed->n = n;
}

enum err expr_copy(struct expr **copy, const struct expr *e, struct arena *a, struct diag *d)
{
    *copy = arena_alloc(a, 1, sizeof **copy, "expression", d);
    struct op *const op = arena_alloc(a, (size_t)e->n, sizeof *op, "expression", d);
    if (!*copy || !op) return ERR_MEMORY;
    **copy = (struct expr){e->n, memcpy(op, e->op, (size_t)e->n * sizeof *op), e->source};
    return ERR_OK;
}

bool expr_varies(const struct expr *e)
{
    for (int k = 0; k < e->n; k++)
        if (e->op[k].code == OP_T) return true;
    return false;
}

bool expr_is_number(const struct expr *e) { return e->n == 1 && e->op[0].code == OP_NUMBER; }

const char *expr_source(const struct expr *e) { return e->source; }

/* --- derivatives --- */

/* f(a) from its value and its derivatives at a. At a stationary a, as in (t^2)^1.5 at 0, an
 * infinite second derivative is ignored if the first one is finite: its product with a'^2 goes to
 * zero there. An infinite first one is not ignored. */
static struct expr_jet chain(const struct expr_jet *a, double f, double first, double second)
{
    const double bend = a->d1 != 0 ? second * a->d1 * a->d1 : 0;
    return (struct expr_jet){f, first * a->d1, bend + first * a->d2};
}

static struct expr_jet unary_jet(enum op_code code, struct expr_jet a)
{
    const double x = a.value, f = expr_operate(code, x, 0);
    switch (code) {
    case OP_SQRT: return chain(&a, f, 0.5 / f, -0.25 / (x * f));
    case OP_SIN: return chain(&a, f, elementary_cos(x), -f);
    case OP_COS: return chain(&a, f, -elementary_sin(x), -f);
    case OP_TAN: return chain(&a, f, 1 + square(f), 2 * f * (1 + square(f)));
    case OP_SINH: return chain(&a, f, elementary_cosh(x), f);
    case OP_COSH: return chain(&a, f, elementary_sinh(x), f);
    case OP_TANH: return chain(&a, f, 1 - square(f), -2 * f * (1 - square(f)));
    case OP_EXP: return chain(&a, f, f, f);
    case OP_LOG: return chain(&a, f, 1 / x, -1 / (x * x));
    case OP_ROUND: return (struct expr_jet){f, 0, 0};
    case OP_ABS:
        if (!(x < 0)) return a;
        /* fall through */
    default: return (struct expr_jet){-x, -a.d1, -a.d2};
    }
}

static struct expr_jet product_jet(struct expr_jet a, struct expr_jet b)
{
    return (struct expr_jet){a.value * b.value, a.d1 * b.value + a.value * b.d1,
                             a.d2 * b.value + 2 * a.d1 * b.d1 + a.value * b.d2};
}

/* For powers of t itself, such as t^2 at t = 0: avoids 0 times infinity. */
static struct expr_jet power_jet(struct expr_jet a, struct expr_jet b)
{
    const double p = b.value, x = a.value;
    if (b.d1 == 0 && b.d2 == 0)
        return chain(&a, elementary_pow(x, p), p == 0 ? 0 : p * elementary_pow(x, p - 1),
                     p == 0 || p == 1 ? 0 : p * (p - 1) * elementary_pow(x, p - 2));
    return unary_jet(OP_EXP, product_jet(b, unary_jet(OP_LOG, a)));
}

static struct expr_jet binary_jet(enum op_code code, struct expr_jet a, struct expr_jet b)
{
    struct expr_jet q;
    switch (code) {
    case OP_ADD: return (struct expr_jet){a.value + b.value, a.d1 + b.d1, a.d2 + b.d2};
    case OP_SUB: return (struct expr_jet){a.value - b.value, a.d1 - b.d1, a.d2 - b.d2};
    case OP_MUL: return product_jet(a, b);
    case OP_DIV: /* a = q b, differentiated twice */
        q.value = a.value / b.value;
        q.d1 = (a.d1 - q.value * b.d1) / b.value;
        q.d2 = (a.d2 - 2 * q.d1 * b.d1 - q.value * b.d2) / b.value;
        return q;
    case OP_POW: return power_jet(a, b);
    case OP_MIN: return a.value < b.value ? a : b;
    default: return a.value > b.value ? a : b;
    }
}

struct expr_jet expr_jet_at(const struct expr *e, double t)
{
    struct expr_jet stack[MAX_STACK] = {{0, 0, 0}};
    int top = -1;
    for (int k = 0; k < e->n; k++) {
        const enum op_code code = e->op[k].code;
        top += 1 - operands(code);
        if (operands(code) == 0)
            stack[top] =
                code == OP_X ? (struct expr_jet){t, 1, 0} : (struct expr_jet){e->op[k].value, 0, 0};
        else
            stack[top] = operands(code) == 1 ? unary_jet(code, stack[top])
                                             : binary_jet(code, stack[top], stack[top + 1]);
    }
    return stack[0];
}

double expr_integral(const struct expr *e, double from, double to)
{
    const double half = 0.5 * (to - from), middle = 0.5 * (to + from), off = half * sqrt(0.6);
    return half *
           (5 * expr_jet_at(e, middle - off).value + 8 * expr_jet_at(e, middle).value +
            5 * expr_jet_at(e, middle + off).value) /
           9;
}

/* Difference of a change from the one predicted by the slopes at both ends. */
static double unexplained(double from, double to, double slope_from, double slope_to, double dt)
{
    return fabs(to - from - 0.5 * (slope_from + slope_to) * dt);
}

static bool follows(double from, double to, double slope_from, double slope_to, double dt)
{
    const double slopes = fabs(slope_from) + fabs(slope_to);
    return unexplained(from, to, slope_from, slope_to, dt) <=
           0.1 * slopes * dt + 1e-12 * (fabs(from) + fabs(to));
}

/* Jump of the value and of the velocity: a pole of even order has the same value and no net
 * velocity on its two sides. */
static double mismatch(const struct expr_jet *a, const struct expr_jet *b, double dt)
{
    return unexplained(a->value, b->value, a->d1, b->d1, dt) +
           dt * unexplained(a->d1, b->d1, a->d2, b->d2, dt);
}

bool expr_jumps(const struct expr *e, double from, double to, double size, double *at)
{
    enum { HALVINGS = 30 };
    struct expr_jet a = expr_jet_at(e, from), b = expr_jet_at(e, to);
    for (int k = 0; k < HALVINGS; k++) {
        const double dt = to - from;
        if (follows(a.value, b.value, a.d1, b.d1, dt) && follows(a.d1, b.d1, a.d2, b.d2, dt))
            return false;
        const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
        const struct expr_jet m = expr_jet_at(e, middle);
        *at = middle;
        if (!isfinite(m.value)) return true;
        if (mismatch(&a, &m, half) >= mismatch(&m, &b, half)) {
            to = middle;
            b = m;
        } else {
            from = middle;
            a = m;
        }
    }
    return fabs(b.value - a.value) > size;
}
