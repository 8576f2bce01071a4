/* SPDX-License-Identifier: MIT */
#include "app/forecast.h"

#include "app/evidence.h"
#include "base/files.h"
#include "case/params.h"
#include "output/probes.h"
#include "output/series.h"
#include "time/timestep.h"

#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#ifndef SPHFSI_VERSION
#define SPHFSI_VERSION "(unversioned build)"
#endif

enum { CACHE_BYTES = 1 << 20, FIRST_STEPS = 20, ROWS_MEASURED = 5 };
/* Assumed parallel efficiency of each further thread; docs/accuracy.md compares it with measurements. */
static const double thread_efficiency = 0.93;
/* Repeats are short, so that other work on the machine does not disturb all of them. */
static const double calibration_seconds = 1.0, repeat_seconds = 0.005;

/* --- the cache: lines of a key and numbers; of equal keys the last line is valid --- */

/* Continues the hash with the first line of a file that begins with `start`. */
static uint64_t hash_file_line(uint64_t h, const char *path, const char *start)
{
    char line[256];
    FILE *file = fopen(path, "r");
    if (!file) return h;
    while (fgets(line, sizeof line, file))
        if (strncmp(line, start, strlen(start)) == 0) {
            h = hash_bytes(h, line, strlen(line));
            break;
        }
    fclose(file);
    return h;
}

/* Identifies the machine, the program, and all settings of the scene that the cost of a step depends on. */
static uint64_t cache_key(const struct simulation *s)
{
    const struct scene *const c = s->scene;
    uint64_t h = hash_bytes(HASH_START, SPHFSI_VERSION, sizeof SPHFSI_VERSION);
    struct stat program;
    h = hash_file_line(h, "/proc/cpuinfo", "model name");
    if (stat("/proc/self/exe", &program) == 0) {
        h = hash_bytes(h, &program.st_mtime, sizeof program.st_mtime);
        h = hash_bytes(h, &program.st_size, sizeof program.st_size);
    }
    const int words[] = {(int)s->effects,
                         (int)(s->effects >> 32),
                         c->top.integrator,
                         c->top.precision,
                         s->solid.sweeps ? s->solid.sweeps->lanes : 0,
                         c->numerics.suction};
    h = hash_bytes(h, words, sizeof words);
    const double numbers[] = {c->numerics.h_over_dp, c->numerics.solid_h_over_dp, c->numerics.skin};
    h = hash_bytes(h, numbers, sizeof numbers);
    for (int k = 0; k < c->n_solid; k++) {
        const int form[] = {c->solid[k].law, c->solid[k].gradient, c->solid[k].hourglass_form};
        h = hash_bytes(h, form, sizeof form);
    }
    for (int k = 0; k < KIND_COUNT;
         k++) { /* sizes by quarters of an octave: caches, walls, overhead */
        const int size = s->kind[k].n ? (int)lround(4 * log2((double)s->kind[k].n)) : -1;
        h = hash_bytes(h, &size, sizeof size);
    }
    return h;
}

static bool cache_path(char path[PATH_BYTES], bool make)
{
    const char *const root = getenv("XDG_CACHE_HOME"), *const home = getenv("HOME");
    char folder[PATH_BYTES];
    if (root && root[0] == '/')
        snprintf(folder, sizeof folder, "%.3000s", root);
    else if (home && home[0] == '/')
        snprintf(folder, sizeof folder, "%.3000s/.cache", home);
    else
        return false;
    if (make) mkdir(folder, 0777);
    const size_t n = strlen(folder);
    snprintf(folder + n, sizeof folder - n, "/sphfsi");
    if (make) mkdir(folder, 0777);
    return path_join(path, folder, "costs", NULL) == ERR_OK;
}

static bool read_costs(const char *line, uint64_t key, struct unit_costs *c)
{
    char *at;
    if (strtoull(line, &at, 16) != key || *at != ' ') return false;
    double number[3 + PHASE_COUNT];
    for (int k = 0; k < 3 + PHASE_COUNT; k++) {
        char *const start = at;
        number[k] = strtod(start, &at);
        if (at == start || !isfinite(number[k]) || number[k] < 0 || number[k] > 1e3) return false;
    }
    if (*at != '\n') return false;
    *c = (struct unit_costs){.fluid = number[0],
                             .solid = number[1],
                             .evaluations = number[2],
                             .cached = true};
    memcpy(c->phase_fraction, number + 3, sizeof c->phase_fraction);
    return true;
}

static bool cache_find(uint64_t key, struct unit_costs *c)
{
    char path[PATH_BYTES], *text;
    size_t size;
    bool found = false;
    struct stat info;
    if (!cache_path(path, false) || lstat(path, &info) != 0 || !S_ISREG(info.st_mode)) return false;
    if (file_read(path, &text, &size, NULL)) return false;
    for (const char *line = text; line && *line; line = strchr(line, '\n'), line += line != NULL)
        found |= read_costs(line, key, c);
    free(text);
    return found;
}

/* Appends a line with one write(); a file above CACHE_BYTES is replaced. */
static void cache_keep(uint64_t key, const struct unit_costs *c)
{
    char path[PATH_BYTES], line[64 + 32 * (3 + PHASE_COUNT)];
    struct stat info;
    if (!cache_path(path, true)) return;
    if (stat(path, &info) == 0 && info.st_size > CACHE_BYTES) unlink(path);
    int n = snprintf(line, sizeof line, "%016llx %.4g %.4g %.4g", (unsigned long long)key, c->fluid,
                     c->solid, c->evaluations);
    for (int k = 0; k < PHASE_COUNT; k++)
        n += snprintf(line + n, sizeof line - (size_t)n, " %.4g", c->phase_fraction[k]);
    line[n++] = '\n';
    /* Neither through a link, which may lead anywhere, nor into a pipe, which would wait for a reader. */
    const int fd =
        open(path, O_WRONLY | O_APPEND | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
    if (fd < 0) return;
    FILE *file = fstat(fd, &info) == 0 && S_ISREG(info.st_mode) ? fdopen(fd, "a") : NULL;
    if (!file) {
        close(fd);
        return;
    }
    setvbuf(file, NULL, _IOFBF, sizeof line);
    fwrite(line, 1, (size_t)n, file);
    fclose(file);
}

/* --- calibration --- */

/* CPU time of this thread, s: it does not include the time of other programs. */
static double work_clock(void)
{
    struct timespec t;
    if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t) != 0) return wall_clock();
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The least CPU time per step of all repeats, since other work on the machine can only add to it, and the
 * least time of each phase. Not every repeat sorts, so sorting counts with its mean, limited to 5 % of a
 * step. */
struct least {
    double step, phase[PHASE_COUNT], sort_mean;
    int64_t steps, substeps, evaluations;
    int64_t n_start; /* fluid particles */
};

/* Whether half of the fluid of the start is still there: what falls out of the domain costs nothing. */
static bool has_fluid_of_start(const struct simulation *s, int64_t n_start)
{
    return 2 * s->kind[KIND_FLUID].n >= n_start;
}

static enum err take_steps(struct least *least, struct simulation *s, struct diag *d)
{
    const double end = s->scene->top.end_time, begin = wall_clock();
    const double work = work_clock();
    const struct state before = s->state;
    double phase[PHASE_COUNT];
    memcpy(phase, s->phase_seconds, sizeof phase);
    do {
        TRY(simulation_step(s, end, d));
    } while (s->state.time < end && wall_clock() - begin < repeat_seconds &&
             has_fluid_of_start(s, least->n_start));
    const double steps = (double)(s->state.steps - before.steps);
    const double each = (work_clock() - work) / steps;
    least->step = least->steps ? min2(least->step, each) : each;
    for (int k = 0; k < PHASE_COUNT; k++) {
        const double seconds = (s->phase_seconds[k] - phase[k]) / steps;
        least->phase[k] = least->steps ? min2(least->phase[k], seconds) : seconds;
    }
    least->sort_mean += s->phase_seconds[PHASE_sort] - phase[PHASE_sort];
    least->steps += s->state.steps - before.steps;
    least->substeps += s->state.solid_substeps - before.solid_substeps;
    least->evaluations += s->state.evaluations - before.evaluations;
    return ERR_OK;
}

static void set_costs(struct unit_costs *c, struct least *l, const struct simulation *s)
{
    const double n_fluid = (double)s->kind[KIND_FLUID].n, n_solid = (double)s->kind[KIND_SOLID].n;
    const double steps = (double)l->steps;
    double all = 0;
    l->phase[PHASE_sort] = 0;
    for (int k = 0; k < PHASE_COUNT; k++) all += l->phase[k];
    l->phase[PHASE_sort] = min2(l->sort_mean / steps, 0.05 * all);
    all += l->phase[PHASE_sort];
    for (int k = 0; k < PHASE_COUNT; k++) c->phase_fraction[k] = all > 0 ? l->phase[k] / all : 0;
    all = min2(all, l->step);
    const double solid =
        n_fluid > 0 ? all * (c->phase_fraction[PHASE_solid] + c->phase_fraction[PHASE_contact])
                    : all;
    c->evaluations = (double)l->evaluations / steps;
    if (n_solid > 0 && l->substeps > 0) c->solid = solid * steps / (double)l->substeps / n_solid;
    if (n_fluid > 0) c->fluid = (all - solid) / c->evaluations / n_fluid;
}

static enum err calibrate(struct unit_costs *c, struct simulation *s, struct diag *d)
{
    const uint64_t key = cache_key(s);
    const double end = s->scene->top.end_time;
    struct least least = {.n_start = s->kind[KIND_FLUID].n};
    /* The first step is not measured: it includes the first touch of memory and the first sort. It also finds
     * the bounds of the time step. */
    TRY(simulation_step(s, end, d));
    /* A guard that stops the run in these steps is reported. */
    const double start = wall_clock();
    for (int k = 0; k < FIRST_STEPS && s->state.time < end && has_fluid_of_start(s, least.n_start);
         k++) {
        if (wall_clock() - start > 0.5 * calibration_seconds) break;
        TRY(simulation_step(s, end, d));
    }
    if (cache_find(key, c)) return ERR_OK;
    const double begin = wall_clock();
    /* A guard that stops the run later is not: the run will report it. */
    struct diag ignored = {.code = ERR_OK};
    enum err e = ERR_OK;
    while (!e && s->state.time < end && wall_clock() - begin < calibration_seconds &&
           has_fluid_of_start(s, least.n_start))
        e = take_steps(&least, s, &ignored);
    if (e && e != ERR_GUARD) return diag_fail(d, e, "%s", ignored.text);
    if (least.steps == 0) return ERR_OK;
    set_costs(c, &least, s);
    cache_keep(key, c);
    return ERR_OK;
}

/* The time of all rows of the run by what one takes now, the least of several. The first row may evaluate the
 * rates anew, which is counted with the steps. */
static enum err measure_rows(struct unit_costs *c, struct simulation *s, struct diag *d)
{
    const double end = s->scene->top.end_time;
    struct probes probes;
    TRY(probes_create(&probes, s, &s->arena, d));
    for (int file = -1; file < probes.n_files; file++) {
        double least = HUGE_VAL, row[SERIES_MAX_COLUMNS];
        for (int k = 0; k < ROWS_MEASURED; k++) {
            const double begin = wall_clock();
            if (file < 0)
                simulation_ledger(s);
            else
                probes_sample(&probes, s, file, row);
            least = min2(least, wall_clock() - begin);
        }
        const double interval =
            file < 0 ? s->scene->output.ledger_interval : probes.file[file].interval;
        c->rows += max2(0, least) * end / interval;
    }
    return ERR_OK;
}

enum err forecast_calibrate(struct unit_costs *c, struct simulation *s, struct diag *d)
{
    *c = (struct unit_costs){0};
    TRY(calibrate(c, s, d));
    return measure_rows(c, s, d);
}

enum err forecast_open(struct session *x, const struct sphfsi_options *o, int *threads,
                       struct diag *d)
{
    struct sphfsi_options one = *o;
    const int offered = thread_count();
    if (o->threads >= 0) one.threads = 1;
    TRY(session_open(x, &one, d));
    *threads = session_threads(&x->scene, o, offered, d);
    return ERR_OK;
}

void forecast_close(struct session *x, int threads)
{
    session_close(x);
    thread_use(threads);
}

/* --- the run --- */

/* The step of Eq. 28b with an estimate of the pairs' approach speed. In the five shipped flows its mean was
 * 0.6 to 0.9 of `max_speed`. Without `max_speed` the largest value so far is used. */
static double expected_step(const struct simulation *s)
{
    const double limit = timestep_fluid_limit(s), fixed = s->scene->numerics.fixed_step;
    if (fixed > 0) return fixed;
    double speed = 0;
    for (int k = 0; k < s->scene->n_fluid; k++) speed = max2(speed, s->scene->fluid[k].max_speed);
    const double approach = max2(0.75 * speed, s->fluid.extremes.approach);
    return limit * s->fluid.k.c0 / (s->fluid.k.c0 + approach);
}

/* Number of steps, which must end at every output time. Only the shortest interval counts, also of a probe
 * that has its own, or the grid that has all of them (T-34d): the others are usually multiples of it. */
static double count_steps(const struct simulation *s, double dt)
{
    const struct scene_output *const out = &s->scene->output;
    double piece = s->scene->top.end_time;
    if (s->scene->n_probe > 0) piece = min2(piece, out->probe_interval);
    for (int k = 0; k < s->scene->n_probe; k++)
        if (s->scene->probe[k].interval > 0) piece = min2(piece, s->scene->probe[k].interval);
    piece = min2(piece, min2(out->ledger_interval, out->snapshot_interval));
    if (out->checkpoint_interval > 0) piece = min2(piece, out->checkpoint_interval);
    if (s->output_grid > 0) piece = s->output_grid;
    return s->scene->top.end_time / piece * max2(1, ceil(piece / dt - 1e-6));
}

/* Bytes of all files: rows, two checkpoints, and uncompressed snapshots twice, as during the run. */
static double disk_bytes(const struct simulation *s, double scale)
{
    enum { BYTES_OF_SNAPSHOT = 140, BYTES_OF_ROW = 18 }; /* a particle; a number */
    const struct scene_output *const out = &s->scene->output;
    double particles = 0, state = 0;
    for (int k = 0; k < KIND_COUNT; k++) {
        particles += (double)s->kind[k].n;
        state += (double)particles_bytes(&s->kind[k]);
    }
    const double end = s->scene->top.end_time;
    const double rows =
        end / out->ledger_interval * 12 +
        (s->scene->n_probe ? end / out->probe_interval * (1 + 2 * s->scene->n_probe) : 0);
    return (2 * (end / out->snapshot_interval + 1) * BYTES_OF_SNAPSHOT * particles + 2 * state) /
               (scale * scale) +
           BYTES_OF_ROW * rows;
}

struct forecast forecast_run(const struct unit_costs *c, const struct simulation *s, int threads,
                             double scale)
{
    const double n_fluid = (double)s->kind[KIND_FLUID].n / (scale * scale);
    const double n_solid = (double)s->kind[KIND_SOLID].n / (scale * scale);
    const double dt_solid = scale * s->dt_solid;
    struct forecast f = {.dt = scale * (n_fluid > 0 ? expected_step(s) : s->dt_solid),
                         .particles = n_fluid + n_solid};
    if (n_fluid > 0 && n_solid > 0 && !(s->effects & FX_MULTIRATE)) f.dt = min2(f.dt, dt_solid);
    const double end = s->scene->top.end_time;
    f.steps = count_steps(s, f.dt);
    f.dt = end / f.steps;
    if (n_solid > 0)
        f.substeps = f.steps * (s->effects & FX_MULTIRATE ? max2(1, ceil(f.dt / dt_solid)) : 1);
    f.evaluations = f.steps * c->evaluations;
    const double ledger_evaluations = end / s->scene->output.ledger_interval;
    f.seconds =
        (f.evaluations + ledger_evaluations) * n_fluid * c->fluid + f.substeps * n_solid * c->solid;
    f.seconds /= 1 + thread_efficiency * (threads - 1);
    f.seconds += c->rows; /* by one thread */
    /* The session has the memory of one thread. */
    const double shared = (double)(s->arena.bytes + s->scene->arena.bytes - s->fluid.thread_bytes);
    f.memory = shared / (scale * scale) + threads * (double)s->fluid.thread_bytes;
    f.disk = disk_bytes(s, scale);
    return f;
}

/* --- the error --- */

/* Least and largest error of the study's cases of a kind, each at its finest resolution that is no finer than
 * n; `coarser`: than all of a case. */
struct band {
    double low, high;
    bool coarser;
};

static struct band band_of(enum scene_kind kind, const char *accuracy, double n)
{
    struct band band = {.low = (double)INFINITY};
    char before[EVIDENCE_TEXT] = "";
    double best = -1;
    struct evidence row;
    for (const char *rest = evidence_first(); evidence_next(&rest, &row);) {
        if (row.kind != kind || strcmp(row.accuracy, accuracy) != 0) continue;
        if (strcmp(before, row.name) != 0) {
            if (best >= 0) band.low = min2(band.low, best), band.high = max2(band.high, best);
            snprintf(before, sizeof before, "%s", row.name);
            best = -1;
            band.coarser |= row.resolution > n;
        }
        if (row.resolution <= n || best < 0) best = row.percent;
    }
    if (best >= 0) band.low = min2(band.low, best), band.high = max2(band.high, best);
    return band;
}

/* Particles across the thinner side of a body, or over the height of the fluid. */
static double particles_across(const struct scene *s, enum kind kind, int body)
{
    const struct scene_points *const p = &s->points[kind];
    const struct scene_lattice *const l =
        kind == KIND_SOLID ? &s->solid_lattice[body] : &s->lattice;
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, at[2], n[2];
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i] != body) continue;
        lattice_place(l, p->x[i], p->y[i], at);
        for (int c = 0; c < 2; c++) low[c] = min2(low[c], at[c]), high[c] = max2(high[c], at[c]);
    }
    for (int c = 0; c < 2; c++) n[c] = floor((high[c] - low[c]) / l->spacing[c] + 1.5);
    return kind == KIND_SOLID ? min2(n[0], n[1]) : n[1];
}

static void say_error(const struct scene *s, enum kind kind, int body, const char *accuracy,
                      const struct sphfsi_options *o)
{
    const enum scene_kind like = kind == KIND_FLUID ? SCENE_FLUID
                                 : s->n_fluid       ? SCENE_COUPLED
                                                    : SCENE_SOLID;
    const double n = particles_across(s, kind, body);
    const struct band band = band_of(like, accuracy, n);
    const char *const name =
        kind == KIND_FLUID ? s->fluid[body].common.name : s->solid[body].common.name;
    char range[64];
    snprintf(range, sizeof range, band.low < 0.9 * band.high ? "%.2g %% to %.2g %%" : "%.2g %%",
             band.low, band.high);
    const bool moves =
        kind == KIND_SOLID && s->solid[body].clamp.n == 0 && !scene_is_bonded(s, body);
    if (moves || !isfinite(band.low))
        session_say(
            o,
            "  %s: %.0f particles across; error unknown, because docs/accuracy.md has no case of "
            "this kind",
            name, n);
    else if (band.coarser)
        session_say(o,
                    "  %s: %.0f particles across, fewer than in all cases of this kind in "
                    "docs/accuracy.md, so the error is not known; use a finer dp",
                    name, n);
    else if (kind == KIND_FLUID)
        session_say(o,
                    "  %s: %.0f particles over its height: error of about %s (cases of this kind, "
                    "docs/accuracy.md)",
                    name, n, range);
    else
        session_say(o,
                    "  %s: %.0f particles across: error of the tip displacement about %s (cases of "
                    "this kind, docs/accuracy.md)",
                    name, n, range);
}

void forecast_say_errors(const struct scene *s, const struct sphfsi_options *o)
{
    /* The study runs the paper's scheme at accuracy = standard only. */
    const bool paper = s->n_fluid && s->top.scheme == SCHEME_PAPER;
    char accuracy[SCENE_NAME] = "paper";
    if (paper) {
        session_say(o, "expected error with scheme = paper, at accuracy = standard");
    } else {
        param_choice_name(param_find(SECTION_top, "accuracy"), s->top.accuracy, accuracy);
        session_say(o, "expected error at accuracy = %s", accuracy);
    }
    for (int k = 0; k < s->n_solid; k++) say_error(s, KIND_SOLID, k, accuracy, o);
    for (int k = 0; k < s->n_fluid && s->n_solid == 0; k++)
        say_error(s, KIND_FLUID, k, accuracy, o);
}

void forecast_say_preset(const struct scene *s, const struct sphfsi_options *o)
{
    if (scene_given(s, SECTION_top, 0, "accuracy")) forecast_say_errors(s, o);
}
