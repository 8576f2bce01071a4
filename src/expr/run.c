/* SPDX-License-Identifier: MIT
 * Runs the stack program of an expression: on numbers, or on numbers with their first two
 * derivatives in t. The compiler has counted: all operands exist, MAX_STACK suffices, one value
 * remains. */
#include "expr/expr.h"
#include "base/elementary.h"
#include "expr/ops.h"

/* --- tables --- */

/* The row at or before an argument, or before it if the argument falls (`back`), so that the
 * segment to the next row follows; but not before the first nor the last one. */
static int table_row(const struct expr_table *table, double x, bool back)
{
    int low = 0, high = table->n - 1;
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        if (back ? table->x[middle] < x : table->x[middle] <= x)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Value and derivatives of a table: between rows linear, with slopes cubic; outside constant. */
static struct expr_jet table_at(const struct expr_table *table, double x, bool back)
{
    const int last = table->n - 1, k = table_row(table, x, back);
    const double *const X = table->x, *const Y = table->y, *const v = table->slope;
    if (back ? x <= X[0] : x < X[0]) return (struct expr_jet){Y[0], 0, 0};
    if (back ? x > X[last] : x >= X[last]) return (struct expr_jet){Y[last], 0, 0};
    const double h = X[k + 1] - X[k], u = (x - X[k]) / h, jump = Y[k + 1] - Y[k];
    if (!v) return (struct expr_jet){Y[k] + u * jump, jump / h, 0};
    const double b = 3 * jump - h * (2 * v[k] + v[k + 1]);
    const double c = h * (v[k] + v[k + 1]) - 2 * jump;
    return (struct expr_jet){Y[k] + u * (h * v[k] + u * (b + u * c)),
                             v[k] + u * (2 * b + 3 * u * c) / h, (2 * b + 6 * u * c) / (h * h)};
}

/* Slopes of the monotone cubic (Fritsch and Carlson 1980, with the harmonic mean of Brodlie): no
 * overshoot between rows. Zero at both ends, so that it continues smoothly outside. */
void expr_table_smooth(struct expr_table *table)
{
    const double *const X = table->x, *const Y = table->y;
    for (int k = 1; k + 1 < table->n; k++) {
        const double h0 = X[k] - X[k - 1], h1 = X[k + 1] - X[k];
        const double s0 = (Y[k] - Y[k - 1]) / h0, s1 = (Y[k + 1] - Y[k]) / h1;
        const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
        table->slope[k] = s0 * s1 > 0 ? (w0 + w1) / (w0 / s0 + w1 / s1) : 0;
    }
}

/* --- values --- */

double expr_operate(const struct op *op, double a, double b)
{
    switch (op->code) {
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
    case OP_TABLE: return table_at(op->table, a, false).value;
    default: return fabs(a); /* OP_ABS */
    }
}

double expr_at(const struct expr *e, double x, double y) { return expr_at_time(e, x, y, 0); }
double expr_at_arg(const struct expr *e, double x) { return expr_at_time(e, x, 0, 0); }

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
        stack[top] = expr_operate(&e->op[k], stack[top], stack[top + 1]);
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
            op[n++] = code == OP_T ? (struct op){.code = OP_NUMBER, .value = t} : e->op[k];
            continue;
        }
        n -= used - 1;
        op[n - 1].value = expr_operate(&e->op[k], op[n - 1].value, op[n].value);
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

double expr_table_end(const struct expr *e, enum expr_scope scope)
{
    const enum op_code time = scope == EXPR_IN_BOTH ? OP_T : OP_X;
    double end = (double)INFINITY;
    for (int k = 1; k < e->n; k++) {
        const struct expr_table *const table = e->op[k].table;
        if (e->op[k].code != OP_TABLE || e->op[k - 1].code != time) continue;
        const int last = table->n - 1;
        if (!table->slope && table->y[last] != table->y[last - 1]) end = min2(end, table->x[last]);
    }
    return end;
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

/* At a kink, of the side that t moves to. */
static struct expr_jet table_jet(const struct expr_table *table, struct expr_jet a)
{
    const struct expr_jet f = table_at(table, a.value, a.d1 < 0);
    return chain(&a, f.value, f.d1, f.d2);
}

static struct expr_jet unary_jet(const struct op *op, struct expr_jet a)
{
    const double x = a.value, f = expr_operate(op, x, 0);
    switch (op->code) {
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
    case OP_TABLE: return table_jet(op->table, a);
    case OP_ABS:
        if (!(x < 0 || (x == 0 && a.d1 < 0))) return a;
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
    const struct op log = {.code = OP_LOG}, exp = {.code = OP_EXP};
    return unary_jet(&exp, product_jet(b, unary_jet(&log, a)));
}

/* Whether a is the less just after now, if not now. */
static bool is_less(const struct expr_jet *a, const struct expr_jet *b)
{
    if (a->value != b->value) return a->value < b->value;
    return a->d1 != b->d1 ? a->d1 < b->d1 : a->d2 < b->d2;
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
    case OP_MIN: return is_less(&a, &b) ? a : b;
    default: return is_less(&b, &a) ? a : b;
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
            stack[top] = operands(code) == 1 ? unary_jet(&e->op[k], stack[top])
                                             : binary_jet(code, stack[top], stack[top + 1]);
    }
    return stack[0];
}

/* --- integral --- */

/* An integral is halved at most so often. Jumps that cancel are looked for in the first, to 1/256
 * of it: near a zero of the function their test sees round-off, and halving would not end. */
enum { INTEGRAL_HALVINGS = 18, HALVINGS_FOR_JUMPS = 8 };

/* Halves an interval as long as its Gauss-Legendre quadrature with three points, and the slope in
 * its middle, are not what values and slopes at its ends say; those see a kink that no point has
 * passed, and the slope jumps that cancel. Near zero the slope would see round-off in the end.
 * `size`: that of the whole. */
static double integral_of(const struct expr *e, const struct expr_jet *a, const struct expr_jet *b,
                          double from, double to, double size, int halvings)
{
    const double length = to - from, middle = 0.5 * (to + from), off = 0.5 * length * sqrt(0.6);
    const struct expr_jet m = expr_jet_at(e, middle);
    const double left = expr_at_arg(e, middle - off), right = expr_at_arg(e, middle + off);
    const double gauss = length * (5 * left + 8 * m.value + 5 * right) / 18;
    const double ends = length * (0.5 * (a->value + b->value) + length * (a->d1 - b->d1) / 12);
    const double chord = b->value - a->value;
    const double bend = halvings > INTEGRAL_HALVINGS - HALVINGS_FOR_JUMPS
                            ? length * m.d1 - 1.5 * chord + 0.25 * length * (a->d1 + b->d1)
                            : 0;
    const double here = fabs(a->value) + fabs(b->value) + fabs(left) + fabs(right);
    size = max2(size, fabs(length) * here);
    if (halvings == 0 || fabs(gauss - ends) + fabs(length * bend) <= 1e-11 * size) return gauss;
    return integral_of(e, a, &m, from, middle, size, halvings - 1) +
           integral_of(e, &m, b, middle, to, size, halvings - 1);
}

/* The next row, before an end, of the tables of the coordinate alone. */
static double next_row(const struct expr *e, double from, double end)
{
    for (int k = 1; k < e->n; k++) {
        if (e->op[k].code != OP_TABLE || e->op[k - 1].code != OP_X) continue;
        const struct expr_table *const table = e->op[k].table;
        const int row = from < table->x[0] ? 0 : table_row(table, from, false) + 1;
        if (table->x[row] > from) end = min2(end, table->x[row]);
    }
    return end;
}

double expr_integral(const struct expr *e, double from, double to)
{
    if (to < from) return -expr_integral(e, to, from);
    double sum = 0;
    for (double at = from, next; at < to; at = next) {
        next = next_row(e, at, to);
        /* With the slopes within the part, not after it. */
        const struct expr_jet a = expr_jet_at(e, at), b = expr_jet_at(e, nextafter(next, at));
        sum += integral_of(e, &a, &b, at, next, 0, INTEGRAL_HALVINGS);
    }
    return sum;
}

/* --- jumps --- */

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

/* Jump of value and velocity: a pole of even order has equal values and no net velocity. */
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
