/* SPDX-License-Identifier: MIT
 * Gravity as a function of time (T-70): numbers, expressions in t, and a table that is added to
 * them. */
#include "case/case.h"

#include <math.h>

bool scene_gravity_varies(const struct scene *s)
{
    const struct scene_expr *const e = &s->top.gravity_in_time;
    return e->e[0] || e->e[1] || s->gravity_data.n > 0;
}

void scene_gravity_at(const struct scene *s, double t, double g[2])
{
    const struct scene_table *const table = &s->gravity_data;
    t = max2(t, 0); /* while rest is sought (T-78) */
    for (int c = 0; c < 2; c++) {
        const struct expr *const e = s->top.gravity_in_time.e[c];
        g[c] = e ? scene_expr_at(e, t, 0) : s->top.gravity[c];
    }
    if (table->n == 0) return;
    const int k = table_row(table, t);
    const double share = (t - table->t[k]) / (table->t[k + 1] - table->t[k]);
    const double u =
        min2(max2(share, 0), 1); /* before its first and after its last row the table is constant */
    g[0] += table->x[k] + u * (table->x[k + 1] - table->x[k]);
    g[1] += table->y[k] + u * (table->y[k + 1] - table->y[k]);
}

/* A record of a shaken tank usually ends at zero; one that does not goes on as a constant. */
static void warn_of_end(const struct scene *s, int line, struct diag *d)
{
    const struct scene_table *const table = &s->gravity_data;
    const int last = table->n - 1;
    const bool acts = table->x[last] != 0 || table->y[last] != 0;
    if (!acts || table->t[last] >= s->top.end_time * (1 - 1e-9)) return;
    warn_at(d, s, line,
            "gravity_file = %.200s ends at t = %.6g s, before end_time = %.6g s: the "
            "acceleration of its last row, (%g, %g) m/s^2, then stays; continue the table, add a "
            "row of zeros, or use end_time = %.6g s",
            s->top.gravity_file, table->t[last], s->top.end_time, table->x[last], table->y[last],
            table->t[last]);
}

/* An accelerometer at rest shows gravity, which the table would add a second time. */
static void warn_of_double(const struct scene *s, int line, struct diag *d)
{
    const struct scene_table *const table = &s->gravity_data;
    const double *const g = s->top.gravity;
    const double size2 = square(g[0]) + square(g[1]);
    double sum[2] = {0, 0}, time = table->t[table->n - 1] - table->t[0];
    for (int k = 0; k + 1 < table->n; k++) {
        const double half = 0.5 * (table->t[k + 1] - table->t[k]) / time;
        sum[0] += half * (table->x[k] + table->x[k + 1]);
        sum[1] += half * (table->y[k] + table->y[k + 1]);
    }
    if (!(size2 > 0 && fabs(sum[0] * g[0] + sum[1] * g[1]) > 0.9 * size2)) return;
    warn_at(d, s, line,
            "gravity_file = %.200s has a mean of (%.3g, %.3g) m/s^2, so it seems to contain "
            "gravity. It is added to `gravity`, which gives (%.3g, %.3g) m/s^2; leave gravity "
            "out of one of them",
            s->top.gravity_file, sum[0], sum[1], g[0] + sum[0], g[1] + sum[1]);
}

enum err gravity_load(struct scene *s, struct diag *d)
{
    static const struct table_kind kind = {"a table of gravity", "time (s), gx (m/s^2), gy (m/s^2)",
                                           false};
    if (!*s->top.gravity_file) return ERR_OK;
    const int line = scene_line(s, SECTION_top, 0, "gravity_file");
    TRY(table_load(s, &s->gravity_data, &kind, s->top.gravity_file, line, "gravity_file", d));
    warn_of_end(s, line, d);
    warn_of_double(s, line, d);
    return ERR_OK;
}
