/* SPDX-License-Identifier: MIT
 * Small dense systems of equations. */
#pragma once

#include "base/base.h"

/* Solves M z = z for the first n rows of a symmetric positive matrix with `stride` columns, of
 * which only the lower triangle is read; it is overwritten. Returns n, or the first row at which M
 * is (nearly) singular: elimination leaves at most `least` of the diagonal there. */
SPHFSI_INLINE int cholesky_solve(double *M, int n, int stride, double least, double *z)
{
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            double sum = M[i * stride + j];
            for (int k = 0; k < j; k++) sum -= M[i * stride + k] * M[j * stride + k];
            if (i == j && !(sum > least * M[i * stride + i])) return i;
            M[i * stride + j] = i == j ? sqrt(sum) : sum / M[j * stride + j];
        }
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < i; k++) z[i] -= M[i * stride + k] * z[k];
        z[i] /= M[i * stride + i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++) z[i] -= M[k * stride + i] * z[k];
        z[i] /= M[i * stride + i];
    }
    return n;
}
