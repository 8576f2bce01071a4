/* SPDX-License-Identifier: MIT
 * Reference curves of probes: read from files, and how far a run is from them. */
#include "output/report.h"
#include "base/csv.h"
#include "base/files.h"
#include "case/case.h"

#include <stdlib.h>

/* Inserts a row by time: times of digitised points need not ascend. */
static void insert_row(struct reference *r, const double row[2])
{
    int k = r->n++;
    for (; k > 0 && r->t[k - 1] > row[0]; k--) {
        r->t[k] = r->t[k - 1];
        r->value[k] = r->value[k - 1];
    }
    r->t[k] = row[0];
    r->value[k] = row[1];
}

static enum err read_rows(struct reference *r, struct csv *csv, struct arena *a)
{
    double row[3];
    int more;
    TRY(arena_array(a, &r->t, csv->lines, "reference", csv->diag));
    TRY(arena_array(a, &r->value, csv->lines, "reference", csv->diag));
    while ((more = csv_row(csv, row)) > 0) insert_row(r, row);
    if (more == 0 && r->n == 0)
        return diag_fail(csv->diag, ERR_INPUT, "%s: contains no row of time and value", csv->path);
    return more < 0 ? ERR_INPUT : ERR_OK;
}

static enum err read_file(struct reference *r, const struct scene *scene, struct arena *a,
                          struct diag *d)
{
    struct diag why = {.code = ERR_OK};
    struct csv csv = {.columns = "time (s), value (SI)", .n = 2, .limit = HUGE_VAL, .diag = &why};
    enum err e = table_open(scene, &csv, r->from->file);
    if (!e) e = read_rows(r, &csv, a);
    csv_close(&csv);
    if (!e || e == ERR_MEMORY) return e ? diag_add(d, e, "%s", why.text) : e;
    return fail_at(d, scene, r->from->common.line, "[reference %s] file: %.400s",
                   r->from->common.name, why.text);
}

/* Searches the headers of all files for the column of a reference. */
static enum err find_column(struct reference *r, const struct scene *scene, int n,
                            const struct probe_file *files, struct diag *d)
{
    const char *const wanted = r->from->probe, *name;
    char list[301] = "";
    size_t length;
    for (r->file = 0; r->file < n; r->file++) {
        const char *const header = files[r->file].header;
        for (r->column = 1; (name = csv_field(header, r->column, &length)); r->column++)
            if (strlen(wanted) == length && strncmp(wanted, name, length) == 0) return ERR_OK;
        snprintf(list + strlen(list), sizeof list - strlen(list), "%s", strchr(header, ','));
    }
    return fail_at(d, scene, r->from->common.line,
                   "[reference %s] probe = %.80s: no such column; there are %s",
                   r->from->common.name, wanted, list + 1);
}

enum err references_open(struct references *r, const struct scene *scene, int n,
                         const struct probe_file *files, struct arena *a, struct diag *d)
{
    *r = (struct references){.n = scene->n_reference};
    TRY(arena_array(a, &r->item, r->n, "references", d));
    for (int k = 0; k < r->n; k++) {
        r->item[k] = (struct reference){.from = &scene->reference[k]};
        TRY(find_column(&r->item[k], scene, n, files, d));
        if (*scene->reference[k].file) TRY(read_file(&r->item[k], scene, a, d));
    }
    return ERR_OK;
}

/* --- comparison --- */

enum err curve_read(struct curve *curve, const char *path, int column, size_t spare, struct diag *d)
{
    char *csv;
    size_t size, rows = 1, length;
    TRY(file_read(path, &csv, &size, d));
    for (const char *at = csv; *at; at = csv_next_line(at)) rows++;
    *curve = (struct curve){.t = calloc((2 + spare) * rows, sizeof *curve->t)};
    curve->value = curve->t + rows;
    for (const char *line = csv_next_line(csv); curve->t && *line; line = csv_next_line(line)) {
        const char *const field = csv_field(line, column, &length);
        if (!strchr(line, '\n')) break; /* incomplete */
        if (!field) continue;
        curve->t[curve->n] = strtod(line, NULL);
        curve->value[curve->n++] = strtod(field, NULL);
    }
    free(csv);
    return curve->t ? ERR_OK
                    : diag_fail(d, ERR_MEMORY, "%s: no memory for its column %d", path, column);
}

/* `row` ends the interval of t; times ascend from call to call. */
static double at_time(const struct curve *curve, double t, int *row)
{
    while (*row < curve->n - 1 && curve->t[*row] < t) ++*row;
    const int before = *row > 0 ? *row - 1 : 0;
    const double span = curve->t[*row] - curve->t[before];
    const double fraction = span > 0 ? (t - curve->t[before]) / span : 0;
    return curve->value[before] + fraction * (curve->value[*row] - curve->value[before]);
}

/* The first local extremum within 0.5 % of the largest magnitude, as in
 * python/sphfsi/draw_probes.py. Of an oscillation this is always the same cycle, where round-off
 * would decide which one is the highest. */
static void find_peak(const struct curve *v, double from, double until, double *peak, double *when)
{
    double largest = 0;
    for (int k = 0; k < v->n; k++)
        if (v->t[k] >= from && v->t[k] <= until) largest = max2(largest, fabs(v->value[k]));
    *peak = *when = (double)NAN;
    for (int k = 0; k < v->n; k++) {
        const double here = fabs(v->value[k]);
        if (v->t[k] < from || v->t[k] > until) continue;
        if (!isnan(*peak) && here < fabs(*peak)) return;
        if (here < 0.995 * largest || here == fabs(*peak)) continue;
        *peak = v->value[k];
        *when = v->t[k];
    }
}

/* The reference at the times of the comparison, where both are known. */
static void reference_curve(const struct reference *r, const struct curve *curve, double from,
                            double until, struct curve *expected)
{
    expected->n = 0;
    const int rows = r->n > 1 ? r->n : curve->n;
    if (curve->n == 0) return;
    for (int k = 0; k < rows; k++) {
        const double t = r->n > 1 ? r->t[k] : curve->t[k];
        if (t < max2(from, curve->t[0]) || t > min2(until, curve->t[curve->n - 1])) continue;
        expected->t[expected->n] = t;
        expected->value[expected->n++] = r->n > 1    ? r->value[k]
                                         : r->n == 1 ? r->value[0]
                                                     : expr_at_arg(r->from->formula.e[0], t);
    }
}

static void compare(struct reference *r, const struct curve *curve, struct curve *expected)
{
    const double from = r->n > 1 ? max2(r->from->from, r->t[0]) : r->from->from;
    const double until = r->n > 1 ? min2(r->from->until, r->t[r->n - 1]) : r->from->until;
    struct score *const c = &r->score;
    *c = (struct score){0};
    reference_curve(r, curve, from, until, expected);
    find_peak(curve, from, until, &c->peak, &c->peak_time);
    find_peak(expected, from, until, &c->peak_reference, &c->peak_time_reference);
    for (int k = 0, row = curve->n > 1; k < expected->n; k++) {
        const double probe = at_time(curve, expected->t[k], &row), off = probe - expected->value[k];
        c->rms += off * off / expected->n;
        c->mean += off / expected->n;
        c->probe_mean += probe / expected->n;
        c->largest = max2(c->largest, fabs(off));
        c->scale = max2(c->scale, fabs(expected->value[k]));
    }
    c->points = expected->n;
    c->rms = sqrt(c->rms);
}

enum err reference_score(struct reference *r, const char *probes_csv, struct diag *d)
{
    struct curve curve;
    TRY(curve_read(&curve, probes_csv, r->column, 0, d));
    const size_t rows = (size_t)(r->n + curve.n) + 1;
    double *const numbers = malloc(2 * rows * sizeof *numbers);
    if (numbers) compare(r, &curve, &(struct curve){0, numbers, numbers + rows});
    free(numbers);
    free(curve.t);
    return numbers ? ERR_OK
                   : diag_fail(d, ERR_MEMORY, "%s: no memory to compare it with its references",
                               probes_csv);
}

/* --- results --- */

void references_write(struct json *j, const struct references *r)
{
    json_open(j, "references", '{');
    for (int k = 0; k < r->n; k++) {
        const struct scene_reference *const from = r->item[k].from;
        const struct score *const c = &r->item[k].score;
        json_open(j, from->common.name, '{');
        json_text(j, "probe", from->probe);
        json_text(j, "label", from->label);
        const double known = c->points > 0 ? 1 : (double)NAN;
        json_integer(j, "points", c->points);
        json_number(j, "rms", known * c->rms);
        json_number(j, "rms_relative", c->scale > 0 ? known * c->rms / c->scale : (double)NAN);
        json_number(j, "largest", known * c->largest);
        json_number(j, "mean", known * c->mean);
        json_number(j, "peak", known * c->peak);
        json_number(j, "peak_time", known * c->peak_time);
        json_number(j, "peak_reference", known * c->peak_reference);
        json_number(j, "peak_time_reference", known * c->peak_time_reference);
        json_number(j, "peak_error", known * (c->peak - c->peak_reference));
        json_number(j, "peak_time_error", known * (c->peak_time - c->peak_time_reference));
        json_close(j, '}');
    }
    json_close(j, '}');
}

void reference_line(const struct reference *r, char *text, size_t size)
{
    const struct score *const c = &r->score;
    const char *const name = r->from->label[0] ? r->from->label : r->from->common.name;
    const double percent = 100 / c->scale;
    char of_peak[48] = "", of_mean[80] = "", of_rms[48] = ""; /* of a reference of zero nothing */
    if (c->scale > 0) {
        snprintf(of_peak, sizeof of_peak, " (%.2g %% of the peak)", percent * c->rms);
        snprintf(of_mean, sizeof of_mean, " (%+.2g %%)", percent * c->mean);
        snprintf(of_rms, sizeof of_rms, " (%.2g %%)", percent * c->rms);
    }
    if (c->points == 0)
        snprintf(text, size, "%s: its times do not overlap with those of %s", r->from->probe, name);
    else if (r->n == 1)
        snprintf(text, size, "%s: mean %.4g, %+.2g%s off %s; RMS %.2g%s", r->from->probe,
                 c->probe_mean, c->mean, of_mean, name, c->rms, of_rms);
    else
        snprintf(text, size,
                 "%s: RMS %.3g%s from %s; peak %.4g at %.4g s instead of %.4g at %.4g s",
                 r->from->probe, c->rms, of_peak, name, c->peak, c->peak_time, c->peak_reference,
                 c->peak_time_reference);
}
