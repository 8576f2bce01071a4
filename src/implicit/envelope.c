/* SPDX-License-Identifier: MIT
 * The factors L D L^T row by row, and the solution with them. */
#include "implicit/envelope.h"
#include "base/simd.h"

/* Vectors of one stride of columns. */
enum { STRIDE = ENVELOPE_ALIGN / LANES_DOUBLE };

enum err envelope_create(struct envelope *m, struct arena *a, int64_t n, const int64_t *first,
                         struct diag *d)
{
    static const char what[] = "matrix of the solid";
    *m = (struct envelope){.n = n};
    TRY(arena_array(a, &m->first, n, what, d));
    TRY(arena_array(a, &m->start, (size_t)n + 1, what, d));
    TRY(arena_array(a, &m->pivot, n, what, d));
    TRY(arena_array(a, &m->row, (size_t)n + ENVELOPE_ALIGN, what, d));
    m->start[0] = 0;
    for (int64_t i = 0; i < n; i++) {
        m->first[i] = first[i] - first[i] % ENVELOPE_ALIGN;
        const int64_t columns = i - m->first[i];
        m->start[i + 1] =
            m->start[i] + (columns + ENVELOPE_ALIGN - 1) / ENVELOPE_ALIGN * ENVELOPE_ALIGN;
    }
    TRY(arena_array(a, &m->value, m->start[n], what, d));
    envelope_clear(m);
    return ERR_OK;
}

void envelope_clear(struct envelope *m)
{
    memset(m->value, 0, (size_t)m->start[m->n] * sizeof *m->value);
    memset(m->pivot, 0, (size_t)m->n * sizeof *m->pivot);
    memset(m->row, 0, (size_t)(m->n + ENVELOPE_ALIGN) * sizeof *m->row);
}

/* Sum of a_k b_k; n is a multiple of the stride. Each of its sums is over one column of the
 * strides, and they are added by halving, whatever the width of a vector. */
static double dot(const double *a, const double *b, int64_t n)
{
    vdouble sum[STRIDE] = {{0}};
    for (int64_t k = 0; k < n; k += ENVELOPE_ALIGN)
        for (int s = 0; s < STRIDE; s++)
            sum[s] = vfma_double(vload_double(a + k + s * LANES_DOUBLE),
                                 vload_double(b + k + s * LANES_DOUBLE), sum[s]);
    for (int half = STRIDE / 2; half > 0; half /= 2)
        for (int s = 0; s < half; s++) sum[s] = sum[s] + sum[s + half];
    return vsum_double(sum[0]);
}

/* L_ij D_j = a_ij - sum of L_ik D_k L_jk over k < j, row by row. `row` has the products L_ik D_k
 * of row i that are known and is zero from there on. */
int64_t envelope_factor(struct envelope *m)
{
    int64_t negative = 0;
    for (int64_t i = 0; i < m->n; i++) {
        double *const of_i = m->value + m->start[i] - m->first[i], *const row = m->row;
        for (int64_t j = m->first[i]; j < i; j++) {
            const int64_t from = m->first[i] > m->first[j] ? m->first[i] : m->first[j];
            const int64_t end = m->first[j] + m->start[j + 1] - m->start[j];
            const double *const of_j = m->value + m->start[j] - m->first[j];
            row[j] = from < end ? of_i[j] - dot(row + from, of_j + from, end - from) : of_i[j];
        }
        double pivot = m->pivot[i];
        for (int64_t j = m->first[i]; j < i; j++) {
            of_i[j] = row[j] * m->pivot[j];
            pivot -= of_i[j] * row[j];
            row[j] = 0;
        }
        if (!(fabs(pivot) > 0) || !isfinite(pivot)) return -1;
        negative += pivot < 0;
        m->pivot[i] = 1 / pivot;
    }
    return negative;
}

void envelope_solve(const struct envelope *m, double *x)
{
    for (int64_t i = 0; i < m->n; i++)
        x[i] -= dot(m->value + m->start[i], x + m->first[i], m->start[i + 1] - m->start[i]);
    for (int64_t i = 0; i < m->n; i++) x[i] *= m->pivot[i];
    for (int64_t i = m->n - 1; i >= 0; i--) {
        const double *const of_i = m->value + m->start[i];
        double *const to = x + m->first[i];
        const vdouble less = vset_double(-x[i]);
        for (int64_t k = 0; k < m->start[i + 1] - m->start[i]; k += LANES_DOUBLE)
            vstore_double(to + k, vfma_double(vload_double(of_i + k), less, vload_double(to + k)));
    }
}
