/* SPDX-License-Identifier: MIT
 * Symmetric matrices of which each row is stored from its first entry to the diagonal, and their
 * factors L D L^T. The sums have one order on every machine. */
#pragma once

#include "base/base.h"

/* Rows begin and end at multiples of so many columns. */
enum { ENVELOPE_ALIGN = 16 };

struct envelope {
    int64_t n;
    int64_t *first; /* [n] first column of a row, a multiple of ENVELOPE_ALIGN */
    int64_t *start; /* [n + 1] of the row's values */
    double *value;  /* entries below the diagonal, zero from there on: of the matrix, then of L */
    double *pivot;  /* [n] the diagonal, then 1/D */
    double *row;    /* [n, padded] */
};

/* A matrix of n rows whose rows begin no later than first[k]; all entries are zero. */
enum err envelope_create(struct envelope *m, struct arena *a, int64_t n, const int64_t *first,
                         struct diag *d) SPHFSI_CHECKED;

void envelope_clear(struct envelope *m);

/* Adds to the entry in row i and column k <= i. */
SPHFSI_INLINE void envelope_add(const struct envelope *m, int64_t i, int64_t k, double value)
{
    if (k == i)
        m->pivot[i] += value;
    else
        m->value[m->start[i] + k - m->first[i]] += value;
}

/* Replaces the matrix by its factors. Returns the number of negative pivots; -1: a bad one. */
int64_t envelope_factor(struct envelope *m);

/* x = A^-1 x with the factors of A; x has n items, and ENVELOPE_ALIGN more that are numbers. */
void envelope_solve(const struct envelope *m, double *x);
