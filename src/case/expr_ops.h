/* SPDX-License-Identifier: MIT
 * The stack program of a compiled expression (case/expr.c), for the code that runs it. */
#ifndef SPHFSI_CASE_EXPR_OPS_H
#define SPHFSI_CASE_EXPR_OPS_H

#include "base/base.h"

enum op_code {
    OP_NUMBER,
    OP_X,
    OP_Y,
    OP_T,
    OP_ADD,
    OP_SUB,
    OP_MUL,
    OP_DIV,
    OP_POW,
    OP_MIN,
    OP_MAX, /* with two operands: from OP_ADD on */
    OP_NEG,
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
    OP_ABS
};

struct op {
    enum op_code code;
    double value;
};

struct expr {
    int n;
    struct op *op;
    char *source;
};

/* Largest number of operands on the stack; the compiler has counted. */
enum { MAX_STACK = 64 };

SPHFSI_INLINE bool is_binary(enum op_code code) { return code >= OP_ADD && code <= OP_MAX; }

#endif
