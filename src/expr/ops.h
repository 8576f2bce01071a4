/* SPDX-License-Identifier: MIT
 * The stack program of a compiled expression, which expr/expr.c makes and expr/run.c runs. */
#pragma once

#include "base/base.h"

enum op_code {
    OP_NUMBER, /* no operand */
    OP_X,
    OP_Y,
    OP_T,
    OP_ADD, /* two operands */
    OP_SUB,
    OP_MUL,
    OP_DIV,
    OP_POW,
    OP_MIN,
    OP_MAX,
    OP_NEG, /* one */
    OP_SQRT,
    OP_SIN,
    OP_COS,
    OP_TAN,
    OP_SINH,
    OP_COSH,
    OP_TANH,
    OP_EXP,
    OP_LOG,
    OP_ROUND,
    OP_ABS,
    OP_TABLE
};

struct op {
    enum op_code code;
    union {
        double value;
        const struct expr_table *table;
    };
};

struct expr {
    int n;
    struct op *op;
    char *source;
};

/* Largest number of operands on the stack; the compiler has counted. */
enum { MAX_STACK = 64 };

SPHFSI_INLINE int operands(enum op_code code) { return code < OP_ADD ? 0 : code < OP_NEG ? 2 : 1; }

/* The result of an operation; `b` of two operands only. */
double expr_operate(const struct op *op, double a, double b);
