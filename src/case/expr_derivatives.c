/* SPDX-License-Identifier: MIT
 * Exact derivatives of an expression in t: the stack program runs on numbers with their first two
 * derivatives. */
#include <math.h>

#include "case/expr.h"
#include "base/elementary.h"
#include "case/expr_ops.h"
#include "case/scene.h"

/* f(a) from f and its derivatives at a. At a stationary a, as in (t^2)^1.5 at 0, an infinite second
 * derivative is ignored if the first one is finite: its product with a'^2 goes to zero there. An
 * infinite first one is not ignored. */
static struct expr_jet chain(const struct expr_jet *a, double f, double first, double second)
{
    const double bend = a->d1 != 0 ? second * a->d1 * a->d1 : 0;
    return (struct expr_jet){f, first * a->d1, bend + first * a->d2};
}

static struct expr_jet unary(enum op_code code, struct expr_jet a)
{
    const double x = a.value;
    switch (code) {
    case OP_NEG: return (struct expr_jet){-x, -a.d1, -a.d2};
    case OP_SQRT: return chain(&a, sqrt(x), 0.5 / sqrt(x), -0.25 / (x * sqrt(x)));
    case OP_SIN: return chain(&a, elementary_sin(x), elementary_cos(x), -elementary_sin(x));
    case OP_COS: return chain(&a, elementary_cos(x), -elementary_sin(x), -elementary_cos(x));
    case OP_TAN:
        return chain(&a, elementary_tan(x), 1 + square(elementary_tan(x)),
                     2 * elementary_tan(x) * (1 + square(elementary_tan(x))));
    case OP_SINH: return chain(&a, elementary_sinh(x), elementary_cosh(x), elementary_sinh(x));
    case OP_COSH: return chain(&a, elementary_cosh(x), elementary_sinh(x), elementary_cosh(x));
    case OP_TANH:
        return chain(&a, elementary_tanh(x), 1 - square(elementary_tanh(x)),
                     -2 * elementary_tanh(x) * (1 - square(elementary_tanh(x))));
    case OP_EXP: return chain(&a, elementary_exp(x), elementary_exp(x), elementary_exp(x));
    case OP_LOG: return chain(&a, elementary_log(x), 1 / x, -1 / (x * x));
    case OP_ROUND: return (struct expr_jet){round(x), 0, 0};
    default: return x < 0 ? unary(OP_NEG, a) : a;
    }
}

/* For powers of t itself, such as t^2 at t = 0: avoids 0 times infinity. */
static struct expr_jet power(struct expr_jet a, struct expr_jet b)
{
    const double p = b.value, x = a.value;
    if (b.d1 == 0 && b.d2 == 0)
        return chain(&a, elementary_pow(x, p), p == 0 ? 0 : p * elementary_pow(x, p - 1),
                     p == 0 || p == 1 ? 0 : p * (p - 1) * elementary_pow(x, p - 2));
    const struct expr_jet log_a = unary(OP_LOG, a);
    const struct expr_jet exponent = {b.value * log_a.value,
                                      b.d1 * log_a.value + b.value * log_a.d1,
                                      b.d2 * log_a.value + 2 * b.d1 * log_a.d1 +
                                          b.value * log_a.d2};
    return unary(OP_EXP, exponent);
}

static struct expr_jet binary(enum op_code code, struct expr_jet a, struct expr_jet b)
{
    struct expr_jet q;
    switch (code) {
    case OP_ADD: return (struct expr_jet){a.value + b.value, a.d1 + b.d1, a.d2 + b.d2};
    case OP_SUB: return (struct expr_jet){a.value - b.value, a.d1 - b.d1, a.d2 - b.d2};
    case OP_MUL:
        return (struct expr_jet){a.value * b.value, a.d1 * b.value + a.value * b.d1,
                                 a.d2 * b.value + 2 * a.d1 * b.d1 + a.value * b.d2};
    case OP_DIV: /* a = q b, differentiated twice */
        q.value = a.value / b.value;
        q.d1 = (a.d1 - q.value * b.d1) / b.value;
        q.d2 = (a.d2 - 2 * q.d1 * b.d1 - q.value * b.d2) / b.value;
        return q;
    case OP_POW: return power(a, b);
    case OP_MIN: return a.value < b.value ? a : b;
    default: return a.value > b.value ? a : b;
    }
}

struct expr_jet expr_jet_at(const struct expr *e, double t)
{
    struct expr_jet stack[MAX_STACK] = {{0, 0, 0}};
    int top = -1;
    for (int k = 0; k < e->n; k++) {
        const struct op *const op = &e->op[k];
        if (op->code == OP_NUMBER || op->code == OP_X || op->code == OP_Y) {
            const bool time = op->code == OP_X;
            stack[++top] = (struct expr_jet){time ? t : op->value, time ? 1 : 0, 0};
        } else if (is_binary(op->code)) {
            top--;
            stack[top] = binary(op->code, stack[top], stack[top + 1]);
        } else {
            stack[top] = unary(op->code, stack[top]);
        }
    }
    return stack[0];
}

bool expr_steps(const struct expr *e)
{
    bool varies[MAX_STACK] = {false}; /* depends on t, for each operand */
    int top = -1;
    for (int k = 0; k < e->n; k++) {
        const enum op_code code = e->op[k].code;
        if (code == OP_NUMBER || code == OP_X || code == OP_Y) {
            varies[++top] = code == OP_X;
        } else if (is_binary(code)) {
            top--;
            varies[top] |= varies[top + 1];
        } else if (code == OP_ROUND && varies[top]) {
            return true;
        }
    }
    return false;
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
