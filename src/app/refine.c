/* SPDX-License-Identifier: MIT */
#include "app/refine.h"

#include "base/files.h"
#include "base/threads.h"
#include "output/json.h"
#include "app/run.h"
#include "app/session.h"
#include "output/checkpoint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_RUNS = 6 };

struct refinement {
    const struct sphfsi_options *options;
    struct diag *diag;
    char folder[PATH_BYTES];
    int runs;
    double ratio, dp; /* dp: of the finest */
    bool off_lattice; /* a body is not the same in all resolutions */
};

/* Values of a column whose convergence is analysed. */
enum measure { FINAL, PEAK, SETTLED, MEASURES };
static const char *const measure_names[MEASURES] = {"final", "peak", "settled"};

/* Units of the columns of ledger.csv; the first is the time. */
static const char *const ledger_units[] = {
#define LEDGER(column, unit, meaning) unit,
    LEDGER_COLUMNS(LEDGER)
#undef LEDGER
};

/* Richardson extrapolation; band: grid convergence index with a factor of 1.25 (Roache 1994; Celik et
 * al. 2008), the order taken as 2 at most. Where the values do not converge monotonically, or slower
 * than with order 0.5, three times the largest difference (after Eca and Hoekstra 2014). */
static struct convergence without_order(const double value[3], const char *why)
{
    const double widest =
        max2(max2(fabs(value[1] - value[0]), fabs(value[2] - value[1])), fabs(value[2] - value[0]));
    return (struct convergence){.extrapolated = value[0],
                                .band = 3 * widest,
                                .order = NAN,
                                .resolved = 3 * widest <= fabs(value[0]),
                                .why = widest > 0 ? why : "no difference"};
}

struct convergence converge(const double value[3], double ratio)
{
    const double fine = value[1] - value[0], coarse = value[2] - value[1];
    struct convergence c = without_order(value, "not monotone");
    if (!isfinite(value[0]) || !isfinite(value[1]) || !isfinite(value[2])) {
        c.why = "not finite";
        c.band = NAN;
        c.resolved = false;
        return c;
    }
    if (!(fine / coarse > 0)) return c;
    c.order = log(coarse / fine) / log(ratio);
    c.ordered = c.order >= 0.5;
    c.why = c.ordered ? "" : "slower than order 0.5";
    if (!c.ordered) return c;
    const double gain = pow(ratio, min2(c.order, 2)) - 1;
    c.extrapolated = value[0] - fine / gain;
    c.band = 1.25 * fabs(fine) / gain;
    c.resolved = c.band <= fabs(value[0]);
    return c;
}

bool errors_agree(const double *fine, const double *middle, const double *coarse, int64_t n)
{
    double product = 0, first = 0, second = 0;
    for (int64_t i = 0; i < n; i++) {
        const double a = middle[i] - fine[i], b = coarse[i] - middle[i];
        product += a * b;
        first += a * a;
        second += b * b;
    }
    return product >= 0 && square(product) >= 0.5 * first * second;
}

/* --- the runs --- */

static double spacing(const struct refinement *x, int k)
{
    return x->dp * pow(x->ratio, x->runs - 1 - k);
}

/* Options of one run: the dp set last, its own folder. */
struct one_run {
    struct sphfsi_options options;
    char dp[40], out[PATH_BYTES];
    const char **sets;
};

static enum err prepare(struct one_run *one, const struct refinement *x, int k)
{
    char name[40];
    snprintf(one->dp, sizeof one->dp, "dp=%.17g", spacing(x, k));
    snprintf(name, sizeof name, "dp-%.6g", spacing(x, k));
    TRY(path_join(one->out, x->folder, name, x->diag));
    const int n = x->options->n_sets;
    one->sets = calloc((size_t)n + 1, sizeof *one->sets);
    if (!one->sets) return diag_fail(x->diag, ERR_MEMORY, "refine: no memory");
    for (int i = 0; i < n; i++) one->sets[i] = x->options->sets[i];
    one->sets[n] = one->dp;
    one->options = *x->options;
    one->options.sets = one->sets;
    one->options.n_sets = n + 1;
    one->options.out = one->out;
    return ERR_OK;
}

/* Whether the case can be read in this resolution: checked before any run, since runs may take hours. It
 * could be read at its own dp, so what is wrong comes from the resolution. */
static enum err try_case(struct refinement *x, int k)
{
    struct one_run one = {.dp = ""};
    struct session *const s = calloc(1, sizeof *s);
    struct diag why = {.code = ERR_OK};
    enum err e = s ? prepare(&one, x, k) : diag_fail(x->diag, ERR_MEMORY, "refine: no memory");
    if (!e && (e = session_read(s, &one.options, &why)) == ERR_OK) {
        x->off_lattice |= s->scene.off_lattice;
        scene_free(&s->scene);
    } else if (why.code) {
        diag_fail(
            x->diag, e,
            "refine: at dp = %.6g m, %.4g times the case's: %.500s; for a finer first run, use "
            "a smaller --ratio, or start from a finer dp (--set dp=...)",
            spacing(x, k), spacing(x, k) / x->dp, why.text);
    }
    free(one.sets);
    free(s);
    return e;
}

static bool has(const char *folder, const char *name)
{
    char path[PATH_BYTES];
    struct stat info;
    return path_join(path, folder, name, NULL) == ERR_OK && stat(path, &info) == 0;
}

static bool has_checkpoint(const char *folder)
{
    struct image m = {0};
    struct diag quiet = {.code = ERR_OK};
    char path[PATH_BYTES];
    const bool found = checkpoint_newest(&m, folder, path, &quiet) == ERR_OK;
    checkpoint_free(&m);
    return found;
}

/* Removes the files of a run that was killed before its first checkpoint, so that it can start again. */
static void remove_partial_run(const char *folder)
{
    static const char *const names[] = {"probes.csv", "ledger.csv", "fields.vtkhdf",
                                        "fields.vtkhdf.spare", "case.cfg"};
    char path[PATH_BYTES];
    for (size_t k = 0; k < COUNT_OF(names); k++)
        if (path_join(path, folder, names[k], NULL) == ERR_OK) unlink(path);
}

/* Whether the folder holds a finished run of exactly this case. Of another case the restart reports it. */
static bool is_done(const struct refinement *x, const struct one_run *one)
{
    char summary[PATH_BYTES], path[PATH_BYTES], part[PATH_BYTES];
    char *text = NULL, *there = NULL, *here = NULL;
    size_t size;
    struct diag quiet = {.code = ERR_OK};
    struct session *const s = calloc(1, sizeof *s);
    bool done = s && path_join(summary, one->out, "summary.json", &quiet) == ERR_OK &&
                path_join(path, one->out, "case.cfg", &quiet) == ERR_OK &&
                path_join(part, one->out, "case.cfg.part", &quiet) == ERR_OK &&
                file_read(summary, &text, &size, &quiet) == ERR_OK &&
                strstr(text, "\"exit_reason\": \"finished\"") &&
                session_read(s, &one->options, &quiet) == ERR_OK;
    if (done) {
        done = scene_write(&s->scene, part, &quiet) == ERR_OK &&
               file_read(part, &here, &size, &quiet) == ERR_OK &&
               file_read(path, &there, &size, &quiet) == ERR_OK &&
               strcmp(here + strcspn(here, "\n"), there + strcspn(there, "\n")) == 0;
        unlink(part);
        scene_free(&s->scene);
    }
    free(text);
    free(there);
    free(here);
    free(s);
    if (done) session_say(x->options, "%s is finished already", one->out);
    return done;
}

static enum err run_one(struct refinement *x, int k)
{
    struct one_run one = {.dp = ""};
    TRY(prepare(&one, x, k));
    session_say(x->options, "run %d of %d: dp = %.6g m in %s", k + 1, x->runs, spacing(x, k),
                one.out);
    one.options.restart = has(one.out, "summary.json") || has_checkpoint(one.out);
    if (!one.options.restart) remove_partial_run(one.out);
    const int offered = thread_count();
    const enum err e = is_done(x, &one) ? ERR_OK : run_case(&one.options, x->diag);
    thread_use(offered); /* the next run has more particles */
    free(one.sets);
    return e;
}

/* --- their values --- */

/* A file of a run in the folder of its resolution; k = runs - 1: the finest. */
static enum err path_of(const struct refinement *x, int k, const char *file, char path[PATH_BYTES])
{
    char name[40], folder[PATH_BYTES];
    snprintf(name, sizeof name, "dp-%.6g", spacing(x, k));
    TRY(path_join(folder, x->folder, name, x->diag));
    return path_join(path, folder, file, x->diag);
}

/* What is known of one column of a run. */
struct column {
    double measure[MEASURES];
    double *late; /* its values in the last quarter of the time */
    int64_t rows; /* of these */
};

/* The next row: `at` moves to it; false: there is none. */
static bool next_line(const char **at)
{
    const char *const end = strchr(*at, '\n');
    if (!end || !end[1]) return false;
    *at = end + 1;
    return true;
}

static enum err allocate_late(const char *csv, double from, int columns, struct column *to,
                              struct arena *a, struct diag *d)
{
    size_t rows = 0;
    for (const char *at = csv; next_line(&at);) rows += strtod(at, NULL) >= from;
    for (int c = 0; c < columns; c++) {
        to[c] = (struct column){.late = arena_alloc(a, rows, sizeof(double), "values", d)};
        if (!to[c].late) return ERR_MEMORY;
    }
    return ERR_OK;
}

/* Each column of a file; the number of columns, the time's not counted. */
static enum err measure_text(const char *csv, int columns, struct column *to, struct arena *a,
                             struct diag *d)
{
    double end = 0;
    for (const char *at = csv; next_line(&at);) end = strtod(at, NULL);
    const double from = 0.75 * end;
    TRY(allocate_late(csv, from, columns, to, a, d));
    for (const char *at = csv; next_line(&at);) {
        char *stop;
        const double t = strtod(at, &stop);
        for (int c = 0; c < columns && *stop == ','; c++) {
            const double v = strtod(stop + 1, &stop);
            double *const measure = to[c].measure;
            measure[FINAL] = v;
            if (fabs(v) > fabs(measure[PEAK])) measure[PEAK] = v;
            if (t < from) continue;
            measure[SETTLED] += v;
            to[c].late[to[c].rows++] = v;
        }
    }
    for (int c = 0; c < columns; c++)
        if (to[c].rows > 0) to[c].measure[SETTLED] /= (double)to[c].rows;
    return ERR_OK;
}

static enum err measure_run(const struct refinement *x, int k, const char *file, int columns,
                            struct column *to, struct arena *a)
{
    char path[PATH_BYTES], *csv;
    size_t size;
    TRY(path_of(x, k, file, path));
    TRY(file_read(path, &csv, &size, x->diag));
    const enum err e = measure_text(csv, columns, to, a, x->diag);
    free(csv);
    return e;
}

/* An order from three final values is chance if the differences of the runs are not those of one error. */
static struct convergence converge_columns(const struct refinement *x, enum measure m,
                                           const struct column *const run[3])
{
    const double value[3] = {run[0]->measure[m], run[1]->measure[m], run[2]->measure[m]};
    const struct convergence c = converge(value, x->ratio);
    const int64_t n = run[0]->rows;
    if (m != FINAL || !c.ordered || run[1]->rows != n || run[2]->rows != n) return c;
    if (errors_agree(run[0]->late, run[1]->late, run[2]->late, n)) return c;
    return without_order(value, "noise");
}

/* Two significant digits, without an exponent up to a million. */
static const char *two_digits(char text[32], double v)
{
    const double step = fabs(v) >= 100 && fabs(v) < 1e6 ? pow(10, floor(log10(fabs(v))) - 1) : 0;
    snprintf(text, 32, step > 0 ? "%.0f" : "%.2g", step > 0 ? step * round(v / step) : v);
    return text;
}

static void print_row(const struct refinement *x, const char *name, const double value[3],
                      const struct convergence *c)
{
    char order[32] = "none", limit[32] = "none", percent[40] = "", digits[32];
    if (c->ordered) snprintf(order, sizeof order, "%.2f", c->order);
    if (c->resolved) snprintf(limit, sizeof limit, "%.5g", c->extrapolated);
    if (value[0] != 0 && isfinite(c->band))
        snprintf(percent, sizeof percent, " (%s %%)",
                 two_digits(digits, 100 * c->band / fabs(value[0])));
    session_result(x->options, "  %-8s %12.5g %12.5g %12.5g %12s  %5s  +- %s%s%s%s%s", name,
                   value[2], value[1], value[0], limit, order, two_digits(digits, c->band), percent,
                   *c->why ? "; " : "", c->why, c->resolved ? "" : "; no result");
}

static void say_value(const struct refinement *x, struct json *j, enum measure m,
                      const struct column *const run[3], bool print)
{
    const struct convergence c = converge_columns(x, m, run);
    const double value[3] = {run[0]->measure[m], run[1]->measure[m], run[2]->measure[m]};
    if (print) print_row(x, measure_names[m], value, &c);
    json_open(j, measure_names[m], '{');
    json_numbers(j, "values", value, 3);
    json_number(j, "order", c.ordered ? c.order : (double)NAN);
    json_text(j, "why_no_order", c.why);
    json_number(j, "extrapolated", c.resolved ? c.extrapolated : (double)NAN);
    json_number(j, "band", c.band);
    json_close(j, '}');
}

/* Reports the columns of one file. Of the ledger only energies that end at other than zero are printed. */
static void say_columns(const struct refinement *x, struct json *j, const char *header, int columns,
                        bool ledger, struct column *const run[3])
{
    const char *name = header;
    for (int c = 0; c < columns; c++) {
        char text[2 * SCENE_NAME];
        name += strcspn(name, ",") + 1;
        snprintf(text, sizeof text, "%.*s", (int)strcspn(name, ","), name);
        const bool print = !ledger || (c + 1 < (int)COUNT_OF(ledger_units) &&
                                       strcmp(ledger_units[c + 1], "J_per_m") == 0 &&
                                       run[0][c].measure[FINAL] != 0);
        if (print) session_result(x->options, "%s", text);
        json_open(j, text, '{');
        const struct column *const of[3] = {&run[0][c], &run[1][c], &run[2][c]};
        for (int m = 0; m < MEASURES; m++) say_value(x, j, (enum measure)m, of, print);
        json_close(j, '}');
    }
}

static enum err report_file(const struct refinement *x, struct json *j, const char *file,
                            bool ledger)
{
    struct arena arena = {0};
    char path[PATH_BYTES], *header;
    size_t size;
    TRY(path_of(x, x->runs - 1, file, path));
    TRY(file_read(path, &header, &size, x->diag));
    header[strcspn(header, "\n")] = '\0';
    int columns = 0;
    for (const char *at = header; (at = strchr(at, ',')) != NULL; at++) columns++;
    struct column *run[3];
    enum err e = ERR_OK;
    for (int k = 0; k < 3 && !e; k++) {
        run[k] = arena_alloc(&arena, (size_t)columns, sizeof *run[k], "values", x->diag);
        e = run[k] ? measure_run(x, x->runs - 1 - k, file, columns, run[k], &arena) : ERR_MEMORY;
    }
    if (!e) say_columns(x, j, header, columns, ledger, run);
    arena_free(&arena);
    free(header);
    return e;
}

static enum err report_probes(const struct refinement *x, const struct scene *scene, struct json *j)
{
    bool shared = false;
    for (int k = 0; k < scene->n_probe; k++) shared |= !(scene->probe[k].interval > 0);
    if (shared) TRY(report_file(x, j, "probes.csv", false));
    for (int k = 0; k < scene->n_probe; k++) {
        char file[SCENE_NAME + 16];
        snprintf(file, sizeof file, "probes_%s.csv", scene->probe[k].common.name);
        if (scene->probe[k].interval > 0) TRY(report_file(x, j, file, false));
    }
    return ERR_OK;
}

static void say_head(const struct refinement *x, struct json *j)
{
    const double dp[3] = {x->dp, x->dp * x->ratio, x->dp * x->ratio * x->ratio};
    json_numbers(j, "dp", dp, 3);
    json_integer(j, "off_lattice", x->off_lattice);
    session_result(x->options,
                   "dp (m)     %12.5g %12.5g %12.5g extrapolated  order  band of the finest", dp[2],
                   dp[1], dp[0]);
}

static void say_foot(const struct refinement *x)
{
    session_result(
        x->options,
        "peak: value of largest magnitude; settled: mean of the last quarter; band: grid "
        "convergence index or, if there is no order, 3 times the largest difference");
    session_result(x->options, "no result: the band is larger than the value of the finest run, so "
                               "not even the sign is known");
    session_result(x->options, "noise: in the last quarter the differences of the runs are not "
                               "proportional to each other, so no final value is reliable");
    if (x->off_lattice)
        session_result(x->options,
                       "bodies are off the lattice in some of these resolutions, so their "
                       "sizes differ and the orders are not reliable");
}

static enum err report_all(const struct refinement *x, const struct scene *scene)
{
    struct atomic_file out;
    TRY(atomic_file_open(&out, x->folder, "refine.json", x->diag));
    struct json j = {.file = out.file};
    json_open(&j, NULL, '{');
    say_head(x, &j);
    enum err e = report_probes(x, scene, &j);
    json_open(&j, "ledger", '{');
    if (!e) e = report_file(x, &j, "ledger.csv", true);
    json_close(&j, '}');
    json_close(&j, '}');
    say_foot(x);
    if (!e) return atomic_file_commit(&out, x->diag);
    atomic_file_abandon(&out);
    return e;
}

static enum err check(struct refinement *x)
{
    if (x->options->restart || x->options->fork)
        return diag_fail(
            x->diag, ERR_INPUT,
            "--refine continues an interrupted study by itself; leave out --restart and --fork");
    if (x->runs < 3 || x->runs > MOST_RUNS)
        return diag_fail(x->diag, ERR_INPUT,
                         "refine: %d resolutions are given, but 3 to %d are allowed", x->runs,
                         MOST_RUNS);
    if (!(x->ratio >= 1.1 && x->ratio <= 4))
        return diag_fail(x->diag, ERR_INPUT,
                         "refine: the ratio of resolutions is %g, but 1.1 to 4 is allowed",
                         x->ratio);
    for (int k = 0; k < x->runs; k++) TRY(try_case(x, k));
    return ERR_OK;
}

enum err refine_case(const struct sphfsi_options *o, int runs, double ratio, struct diag *d)
{
    struct refinement x = {.options = o, .diag = d, .runs = runs, .ratio = ratio};
    TRY(run_dir_of_case(o, x.folder, d));
    struct session *const s = calloc(1, sizeof *s);
    if (!s) return diag_fail(d, ERR_MEMORY, "refine: no memory for %zu bytes", sizeof *s);
    struct diag quiet = {.code = ERR_OK}; /* each run prints its own warnings */
    enum err e = session_read(s, o, &quiet);
    if (e) {
        free(s);
        if (d) memcpy(d->more, quiet.more, sizeof d->more);
        return diag_fail(d, e, "%s", quiet.text);
    }
    x.dp = s->scene.top.dp;
    e = check(&x);
    for (int k = 0; k < runs && !e; k++) e = run_one(&x, k);
    if (!e) e = report_all(&x, &s->scene);
    scene_free(&s->scene);
    free(s);
    return e;
}
