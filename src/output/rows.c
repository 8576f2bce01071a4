/* SPDX-License-Identifier: MIT
 * When rows are due, their interpolation, and the files that they are written to. */
#include "output/rows.h"

#include <stdlib.h>

static const char ledger_header[] =
#define LEDGER(name, unit, meaning) "," #name "_" unit
    LEDGER_COLUMNS(LEDGER)
#undef LEDGER
    ;

/* --- times of outputs --- */

double due_round(double time)
{
    char text[32];
    snprintf(text, sizeof text, "%.12g", time);
    return strtod(text, NULL);
}

double due_time(const struct due *u)
{
    return u->interval > 0 ? due_round((double)u->k * u->interval) : (double)INFINITY;
}

void due_pass(struct due *u, double time)
{
    const int64_t near = u->interval > 0 ? (int64_t)(time / u->interval) : 0;
    if (near > u->k) u->k = near;
    while (due_time(u) <= time) u->k++;
}

/* --- states --- */

static void read_state(const struct row_files *r, struct rows *f, struct simulation *sim,
                       bool whole)
{
    f->whole = whole;
    if (f->file < 0)
        *(struct ledger *)(void *)f->now = simulation_ledger(sim);
    else
        probes_sample(r->probes, sim, f->file, !whole, f->now, f->now_rate);
}

/* T-76a: a column between both states, by Hermite's cubic where its rate is known, else linear. */
static double between(const struct rows *f, int c, double time)
{
    const double turn = 2 * PI, from = f->before[c], dt = f->now[0] - f->before[0];
    double to = f->now[c];
    if (!(time < f->now[0])) return to;
    const double s = (time - f->before[0]) / dt, left = 1 - s;
    if (isnan(from) || isnan(to)) return s < 0.5 ? from : to; /* such as the level of a dry place */
    if (f->angle[c]) to += turn * nearbyint((from - to) / turn);
    double value = left * from + s * to;
    if (!isnan(f->before_rate[c]))
        value = left * left * (1 + 2 * s) * from + s * s * (1 + 2 * left) * to +
                dt * s * left * (left * f->before_rate[c] - s * f->now_rate[c]);
    return f->angle[c] ? value - turn * nearbyint(value / turn) : value;
}

/* --- means --- */

/* T-76: adds the part of the step between both readings that the next row's mean covers. */
static void add_to_mean(const struct rows *f, const struct probe *probe)
{
    struct probe_mean *const m = probe->mean;
    const double from = max2(f->before[0], f->next - probe->given->average);
    const double to = min2(f->now[0], f->next), row = (double)f->due.k;
    if (f->before[0] < 0 || !(from < to)) return;
    if (m->row != row) *m = (struct probe_mean){.row = row};
    for (int c = 0; c < probe->columns; c++)
        m->sum[c] += (to - from) * 0.5 *
                     (between(f, probe->column + c, from) + between(f, probe->column + c, to));
    m->covered += to - from;
    m->time = to;
}

static void put_mean(const struct rows *f, const struct probe *probe, double *row)
{
    const struct probe_mean *const m = probe->mean;
    if (m->row != (double)f->due.k) return;
    for (int c = 0; c < probe->columns; c++) row[probe->column + c] = m->sum[c] / m->covered;
}

/* Calls a function for each probe of a file that has a mean. */
#define FOR_MEANS(r, f, probe)                                                                  \
    for (struct probe *probe = (r)->probes->probe; probe < (r)->probes->probe + (r)->probes->n; \
         probe++)                                                                               \
        if (probe->mean && probe->file == (f)->file)

/* --- rows --- */

/* A step may pass the end and may hold any number of rows. The first row of a file has no state
 * before. */
static bool rows_end(const struct row_files *r, const struct rows *f)
{
    const bool stopped = r->stop && *r->stop && isfinite(r->end) && f->before[0] >= 0;
    return stopped || f->next > r->end;
}

/* Writes the rows up to the present state. Those after the end or a stop are left to a restart,
 * with the state before. */
static enum err write_rows(const struct row_files *r, struct rows *f, struct diag *d)
{
    double row[SERIES_MAX_COLUMNS];
    while (f->next > f->now[0] || !rows_end(r, f)) {
        FOR_MEANS(r, f, probe) add_to_mean(f, probe);
        if (f->next > f->now[0]) {
            f->before[0] = -1;
            break;
        }
        if (r->ledger) {
            row[0] = f->next;
            for (int c = 1; c < f->columns; c++) row[c] = between(f, c, f->next);
            FOR_MEANS(r, f, probe) put_mean(f, probe, row);
            TRY(series_row(&f->series, row, d));
        }
        due_pass(&f->due, f->next);
        f->next = due_time(&f->due);
    }
    return ERR_OK;
}

static enum err follow_file(const struct row_files *r, struct rows *f, struct simulation *sim,
                            double until, struct diag *d)
{
    const bool whole = r->ledger && f->next <= until;
    const size_t bytes = (size_t)f->columns * sizeof(double);
    if (until < f->next - f->window) return ERR_OK;
    if (f->now[0] == sim->state.time) {
        if (whole && !f->whole) read_state(r, f, sim, whole);
        return ERR_OK;
    }
    if (f->now[0] >= 0) { /* else that of a restart, if it is needed */
        memcpy(f->before, f->now, bytes);
        memcpy(f->before_rate, f->now_rate, bytes);
    }
    read_state(r, f, sim, whole);
    return write_rows(r, f, d);
}

static enum err follow(void *context, struct simulation *sim, double until, struct diag *d)
{
    const struct row_files *const r = context;
    sim->observer.next = (double)INFINITY;
    for (int k = 0; k < r->n; k++) {
        struct rows *const f = &r->file[k];
        TRY(follow_file(r, f, sim, until, d));
        sim->observer.next = min2(sim->observer.next, f->next - f->window);
    }
    return ERR_OK;
}

void rows_follow(struct row_files *r, struct simulation *sim)
{
    if (r->n > 0) sim->observer = (struct observer){follow, r, -(double)INFINITY};
}

/* --- files --- */

static void add_file(struct row_files *r, struct rows f)
{
    f.series = (struct series){.fd = -1, .columns = f.columns};
    r->file[r->n++] = f;
}

static void list_files(struct row_files *r, const struct scene *scene)
{
    for (int k = 0; k < r->probes->n_files; k++) {
        const struct probe_file *const from = &r->probes->file[k];
        struct rows f = {.name = from->name, .header = from->header, .file = k};
        f.columns = from->columns;
        f.due.interval = from->interval;
        for (int m = 0; m < r->probes->n; m++)
            if (r->probes->probe[m].file == k)
                f.window = max2(f.window, r->probes->probe[m].given->average);
        if (r->ledger || f.window > 0) add_file(r, f);
    }
    struct rows f = {.name = "ledger.csv", .header = ledger_header + 1, .file = -1};
    f.columns = (int)(sizeof(struct ledger) / sizeof(double));
    f.due.interval = scene->output.ledger_interval;
    if (r->ledger) add_file(r, f);
}

static enum err allocate(const struct row_files *r, struct rows *f, struct arena *a,
                         double *carried, struct diag *d)
{
    const size_t n = (size_t)f->columns;
    TRY(arena_array(a, &f->angle, n, "rows", d));
    TRY(arena_array(a, &f->now, 2 * n, "rows", d));
    f->now_rate = f->now + n;
    f->before = carried;
    f->before_rate = carried + n;
    for (size_t c = 0; c < n; c++) f->before_rate[c] = f->now_rate[c] = (double)NAN;
    f->before[0] = f->now[0] = -1;
    for (int k = 0; f->file >= 0 && k < r->probes->n; k++) {
        const struct probe *const probe = &r->probes->probe[k];
        if (probe->file == f->file && probe->given->quantity == PROBE_POSE)
            f->angle[probe->column + 2] = true;
    }
    return ERR_OK;
}

enum err rows_create(struct row_files *r, struct probes *p, struct simulation *sim, bool ledger,
                     struct arena *a, struct diag *d)
{
    enum { MEAN = sizeof(struct probe_mean) / sizeof(double) };
    const bool ends = ledger && simulation_batch(sim) == 1; /* of a batch: all its rows */
    *r = (struct row_files){.probes = p,
                            .ledger = ledger,
                            .end = ends ? sim->scene->top.end_time : HUGE_VAL};
    TRY(arena_array(a, &r->file, (size_t)p->n_files + 1, "rows", d));
    list_files(r, sim->scene);
    size_t n = 0;
    for (int k = 0; k < r->n; k++) n += 2 * (size_t)r->file[k].columns;
    for (int k = 0; k < p->n; k++) n += p->probe[k].given->average > 0 ? MEAN : 0;
    double *carried = arena_alloc(a, n, sizeof *carried, "rows", d);
    if (!carried) return ERR_MEMORY;
    sim->carried.n = (int64_t)n;
    sim->carried.value = carried;
    for (int k = 0; k < p->n; k++) {
        if (!(p->probe[k].given->average > 0)) continue;
        p->probe[k].mean = (struct probe_mean *)(void *)carried;
        *p->probe[k].mean = (struct probe_mean){.row = -1};
        carried += MEAN;
    }
    for (int k = 0; k < r->n; k++) {
        TRY(allocate(r, &r->file[k], a, carried, d));
        carried += 2 * r->file[k].columns;
    }
    return ERR_OK;
}

enum err rows_start(struct row_files *r, const char *folder, double time, struct diag *d)
{
    for (int k = 0; k < r->n; k++) {
        struct rows *const f = &r->file[k];
        TRY(series_create(&f->series, folder, f->name, f->header, d));
        f->before[0] = -1;
        f->next = time;
    }
    return ERR_OK;
}

enum err rows_resume(struct row_files *r, const char *folder, double time, struct ledger *first,
                     struct diag *d)
{
    double row[SERIES_MAX_COLUMNS], last;
    for (int k = 0; k < r->n; k++) {
        struct rows *const f = &r->file[k];
        TRY(series_resume(&f->series, folder, f->name, f->header, time, f->file < 0 ? row : NULL,
                          &last, d));
        /* Behind the end of that run its last step may have left rows. */
        due_pass(&f->due, f->before[0] < 0 ? time : max2(last, f->before[0]));
        f->next = due_time(&f->due);
    }
    memcpy(first, row, sizeof *first);
    return ERR_OK;
}

enum err rows_sync(const struct row_files *r, struct diag *d)
{
    for (int k = 0; k < r->n; k++) TRY(series_sync(&r->file[k].series, d));
    return ERR_OK;
}

void rows_close(struct row_files *r)
{
    for (int k = 0; k < r->n; k++) series_close(&r->file[k].series);
}
