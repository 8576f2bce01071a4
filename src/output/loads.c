/* SPDX-License-Identifier: MIT
 * Loads of the summary: the largest means of forces over time, and their impulse (T-76b). */
#include "base/files.h"
#include "output/report.h"

#include <stdlib.h>

/* The mean of largest magnitude over as many intervals between rows as come next to the window, two
 * at least, and where it begins. `sum` is the integral up to each row. */
static double largest_mean(const struct curve *c, const double *sum, double window, double *from)
{
    const double n = c->n > 1 ? nearbyint(window / (c->t[1] - c->t[0])) : 0;
    double mean = *from = (double)NAN;
    for (int k = 0, end = (int)n; n >= 2 && n < c->n && end < c->n; k++, end++) {
        const double here = (sum[end] - sum[k]) / (c->t[end] - c->t[k]);
        if (!(fabs(here) <= fabs(mean))) mean = here, *from = c->t[k];
    }
    return mean;
}

static void write_column(struct json *j, const struct curve *c, double *sum, double window)
{
    const double windows[] = {1e-3, 5e-3, 20e-3, window};
    const int n = window > 0 ? 4 : 3;
    double mean[4], from[4], impulse[4], top[2] = {0};
    for (int k = 0; k < c->n; k++) {
        if (fabs(c->value[k]) > fabs(top[0])) top[0] = c->value[k], top[1] = c->t[k];
        if (k > 0)
            sum[k] = sum[k - 1] + 0.5 * (c->t[k] - c->t[k - 1]) * (c->value[k] + c->value[k - 1]);
    }
    for (int k = 0; k < n; k++) {
        mean[k] = largest_mean(c, sum, windows[k], &from[k]);
        impulse[k] = mean[k] * windows[k];
    }
    json_numbers(j, "window", windows, n);
    json_numbers(j, "largest_mean", mean, n);
    json_numbers(j, "from", from, n);
    json_numbers(j, "impulse", impulse, n);
    json_number(j, "impulse_of_run", c->n > 0 ? sum[c->n - 1] : 0);
    json_number(j, "largest_single_row", top[0]);
    json_number(j, "largest_single_row_time", top[1]);
}

enum err loads_write(struct json *j, const char *folder, const struct probes *probes,
                     const struct scene *scene, struct diag *d)
{
    char path[PATH_BYTES], name[PROBE_COLUMN_TEXT];
    for (int p = 0; p < probes->n; p++) {
        const struct probe *const probe = &probes->probe[p];
        if (probe->quantity != PROBE_FORCE && probe->quantity != PROBE_REACTION &&
            probe->quantity != PROBE_SURFACE_PRESSURE)
            continue;
        TRY(path_join(path, folder, probes->file[probe->file].name, d));
        for (int c = 0; probe_column(&scene->probe[p], c, name, sizeof name); c++) {
            struct curve curve;
            TRY(curve_read(&curve, path, probe->column + c, 1, d));
            json_open(j, name, '{');
            write_column(j, &curve, curve.value + curve.n, scene->probe[p].load_window);
            json_close(j, '}');
            free(curve.t);
        }
    }
    return ERR_OK;
}
