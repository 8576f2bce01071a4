/* SPDX-License-Identifier: MIT
 * What worker.js calls: one simulation at a time, through include/sphfsi.h. Texts are UTF-8 with a
 * zero at their end. */
#include "base/simd.h"
#include "sphfsi.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT(name) __attribute__((export_name(#name)))

static struct sphfsi_simulation *simulation;
static char messages[1 << 14]; /* warnings and notes since the last sphfsi_create, a line each */
static float *points;          /* x, y (m) and value of each particle */
static int64_t capacity;       /* of `points`, particles */

/* Whether vfma rounds once. For a = b = 1 + e, c = -(1 + 2 e) that gives e^2, otherwise 0. */
EXPORT(fused) int fused(void)
{
    volatile float f = 0x1p-23f;
    volatile double d = 0x1p-52;
    const vfloat a = vset_float(1 + f), b = vset_float(-1 - 2 * f);
    const vdouble x = vset_double(1 + d), y = vset_double(-1 - 2 * d);
    const vfloat s = vfma_float(a, a, b);
    const vdouble t = vfma_double(x, x, y);
    for (int l = 0; l < LANES_FLOAT; l++)
        if (s[l] != f * f) return 0;
    for (int l = 0; l < LANES_DOUBLE; l++)
        if (t[l] != d * d) return 0;
    return 1;
}

EXPORT(version) const char *version(void) { return SPHFSI_VERSION; }

/* Memory for a text that the page writes. */
EXPORT(reserve) char *reserve(size_t bytes) { return malloc(bytes); }
EXPORT(release) void release(char *text) { free(text); }

static void keep_message(void *context, enum sphfsi_message kind, const char *text)
{
    (void)context;
    const size_t used = strlen(messages);
    snprintf(messages + used, sizeof messages - used, "%s%s\n",
             kind == SPHFSI_WARNING ? "warning: " : "", text);
}

/* Replaces the simulation by that of a case; frees both texts. `sets`: a change `key=value` on each
 * line. */
EXPORT(create) int create(char *name, char *text, char *sets, double until)
{
    enum { MOST = 64 };
    const char *set[MOST];
    int n = 0;
    for (char *line = strtok(sets, "\n"); line && n < MOST; line = strtok(NULL, "\n"))
        set[n++] = line;
    const struct sphfsi_options options = {.case_path = name,
                                           .case_text = text,
                                           .sets = set,
                                           .n_sets = n,
                                           .threads = 1,
                                           .until = until,
                                           .message = keep_message};
    messages[0] = '\0';
    sphfsi_free(simulation);
    const enum sphfsi_status status = sphfsi_create(&simulation, &options);
    free(name);
    free(text);
    free(sets);
    return (int)status;
}

EXPORT(error) const char *error(void) { return sphfsi_error(); }
EXPORT(more_errors) const char *more_errors(void) { return sphfsi_more_errors(); }
EXPORT(said) const char *said(void) { return messages; }

/* One step, which ends at the next output of the program's run at the latest. */
EXPORT(step) int step(double next) { return (int)sphfsi_step(simulation, next); }
EXPORT(next_output) double next_output(void) { return sphfsi_next_output(simulation); }
EXPORT(now) double now(void) { return sphfsi_time(simulation); }
EXPORT(end) double end(void) { return sphfsi_end_time(simulation); }
EXPORT(steps) double steps(void) { return (double)sphfsi_steps(simulation); }
EXPORT(count) int count(int kind) { return (int)sphfsi_count(simulation, (enum sphfsi_kind)kind); }

/* The state's hash as 16 digits. */
EXPORT(hash) const char *hash(void)
{
    static char text[17];
    snprintf(text, sizeof text, "%016llx", (unsigned long long)sphfsi_hash(simulation));
    return text;
}

EXPORT(probe_column) const char *probe_column_of(int probe, int column)
{
    return sphfsi_probe_column(simulation, probe, column);
}

EXPORT(probe) const double *probe(int k)
{
    static double values[SPHFSI_PROBE_COLUMNS];
    return sphfsi_probe(simulation, sphfsi_probe_name(simulation, k), values) ? NULL : values;
}

static const double *field(enum sphfsi_kind kind, const char *name, int *components)
{
    struct sphfsi_view view;
    if (sphfsi_field(simulation, kind, name, &view) || view.type != SPHFSI_DOUBLE) return NULL;
    *components = view.components;
    return view.data;
}

/* Size of the first two components, or the only one. */
static float size_of(const double *v, int components)
{
    return (float)(components == 1 ? v[0] : __builtin_sqrt(v[0] * v[0] + v[1] * v[1]));
}

/* x, y and the value of a field for each particle; without such a field the value is 0. NULL: no
 * memory. */
EXPORT(particles) const float *particles(int kind_number, const char *name)
{
    const enum sphfsi_kind kind = (enum sphfsi_kind)kind_number;
    const int64_t n = sphfsi_count(simulation, kind);
    int wide = 1, three = 3;
    if (n > capacity) {
        free(points);
        points = malloc((size_t)n * 3 * sizeof *points);
        capacity = points ? n : 0;
    }
    /* The field comes first: positions may move in memory when it is computed. */
    const double *const value = field(kind, name, &wide);
    const double *const at = field(kind, "Points", &three);
    if (!points || !at) return NULL;
    for (int64_t i = 0; i < n; i++) {
        points[3 * i] = (float)at[3 * i];
        points[3 * i + 1] = (float)at[3 * i + 1];
        points[3 * i + 2] = value ? size_of(value + i * wide, wide) : 0;
    }
    return points;
}
