/* SPDX-License-Identifier: MIT
 * Gravity as a function of time (T-70): numbers, expressions in t, and a table that is added to
 * them. */
#include "case/case.h"

#include <math.h>

bool scene_gravity_varies(const struct scene *scene)
{
    const struct scene_expr *const e = &scene->top.gravity_in_time;
    return e->e[0] || e->e[1] || scene->gravity_data.n > 0;
}

void scene_gravity_at(const struct scene *scene, double t, double g[2])
{
    const struct scene_table *const table = &scene->gravity_data;
    t = max2(t, 0); /* while rest is sought (T-78) */
    for (int c = 0; c < 2; c++) {
        const struct expr *const e = scene->top.gravity_in_time.e[c];
        g[c] = e ? scene_expr_at(e, t, 0) : scene->top.gravity[c];
    }
    if (table->n == 0) return;
    const int k = table_row(table, t);
    const double fraction = (t - table->t[k]) / (table->t[k + 1] - table->t[k]);
    const double u =
        min2(max2(fraction, 0), 1); /* constant before its first and after its last row */
    g[0] += table->x[k] + u * (table->x[k + 1] - table->x[k]);
    g[1] += table->y[k] + u * (table->y[k + 1] - table->y[k]);
}

enum err gravity_load(struct scene *scene, struct diag *d)
{
    static const struct table_kind kind = {"a table of gravity", "time (s), gx (m/s^2), gy (m/s^2)",
                                           false};
    if (!*scene->top.gravity_file) return ERR_OK;
    const int line = scene_line(scene, SECTION_top, 0, "gravity_file");
    return table_load(scene, &scene->gravity_data, &kind, scene->top.gravity_file, line,
                      "gravity_file", d);
}
