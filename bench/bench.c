/* SPDX-License-Identifier: MIT
 * Cost of a step: ns per fluid particle and evaluation by phase, ns per solid particle and step, of
 * a snapshot and a checkpoint; and the machine's rates of fma and copying for comparison. Prints
 * CSV. bench_bench [--large] [--reps N] [--out FILE]      --large: a million fluid particles as
 * well */
#include "output/checkpoint.h"
#include "counter.h"
#include "base/simd.h"
#include "time/simulation.h"
#include "output/snapshot.h"
#include "geometry/scene_points.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#ifdef _OPENMP
#include <omp.h>
#endif

enum { MAX_REPS = 99 };

struct bench {
    FILE *out;
    int reps, all_threads, counter;
    double sample[PHASE_COUNT + 1][MAX_REPS]; /* of the current run, by phase; last row: the sum */
    double instructions[MAX_REPS];            /* of the current run, if it has one thread */
};

/* --- output --- */

static int compare_double(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_row(const struct bench *b, const char *what, const char *variant, int64_t n,
                      int threads, const char *part, const char *unit, double *sample)
{
    qsort(sample, (size_t)b->reps, sizeof *sample, compare_double);
    const double median = 0.5 * (sample[(b->reps - 1) / 2] + sample[b->reps / 2]);
    fprintf(b->out, "%s,%s,%lld,%d,%s,%s,%.4g,%.4g,%.4g\n", what, variant, (long long)n, threads,
            part, unit, median, sample[0], sample[b->reps - 1]);
    fflush(b->out);
}

/* The value of a line of /proc/cpuinfo that begins with `key`; NULL: another line. */
static const char *info_value(char *line, const char *key)
{
    const size_t n = strlen(key);
    if (strncmp(line, key, n) != 0 || line[n] != '\t') return NULL;
    line[strcspn(line, "\n")] = '\0';
    const char *const colon = strchr(line, ':');
    return colon && colon[1] == ' ' ? colon + 2 : NULL;
}

/* The processor's name with family and model: the name alone may mean several generations. */
static void find_processor(char name[256])
{
    static const char *const keys[] = {"model name", "cpu family", "model"};
    static const char *const words[] = {"", " family ", " model "};
    char line[256], found[COUNT_OF(keys)][64] = {{0}};
    FILE *const info = fopen("/proc/cpuinfo", "r");
    while (info && fgets(line, sizeof line, info))
        for (size_t k = 0; k < COUNT_OF(keys); k++) {
            const char *const value = info_value(line, keys[k]);
            if (value && !found[k][0]) snprintf(found[k], sizeof found[k], "%s", value);
        }
    if (info) fclose(info);
    snprintf(name, 256, "%s", found[0][0] ? found[0] : "unknown processor");
    for (size_t k = 1; k < COUNT_OF(keys); k++) {
        const size_t n = strlen(name);
        if (found[k][0]) snprintf(name + n, 256 - n, "%s%s", words[k], found[k]);
    }
}

static void print_machine(const struct bench *b)
{
    char cpu[256];
    find_processor(cpu);
#ifdef __clang__
    const char *const compiler = "";
#else
    const char *const compiler = "gcc ";
#endif
    double load[1] = {-1};
    if (getloadavg(load, 1) < 1) load[0] = -1;
    fprintf(b->out,
            "# %s, %d threads, load %.1f before the start; vectors of %d float, %d double\n", cpu,
            b->all_threads, load[0], LANES_FLOAT, LANES_DOUBLE);
    fprintf(b->out, "# %s%s\n", compiler, __VERSION__);
    fprintf(b->out, "what,variant,particles,threads,part,unit,median,min,max\n");
}

/* --- the machine --- */

/* Independent chains of fma: enough to hide the latency, few enough for sixteen registers. */
enum { CHAINS = 10, ROUNDS = 2000000 };

static double run_float(void)
{
    vfloat x[CHAINS];
    for (int c = 0; c < CHAINS; c++) x[c] = vset_float((float)c);
    const vfloat a = vset_float(0.999f), b = vset_float(0.001f);
    for (int k = 0; k < ROUNDS; k++)
        for (int c = 0; c < CHAINS; c++) x[c] = vfma_float(x[c], a, b);
    double sum = 0;
    for (int c = 0; c < CHAINS; c++)
        for (int l = 0; l < LANES_FLOAT; l++) sum += (double)x[c][l];
    return sum;
}

static double run_double(void)
{
    vdouble x[CHAINS];
    for (int c = 0; c < CHAINS; c++) x[c] = vset_double(c);
    const vdouble a = vset_double(0.999), b = vset_double(0.001);
    for (int k = 0; k < ROUNDS; k++)
        for (int c = 0; c < CHAINS; c++) x[c] = vfma_double(x[c], a, b);
    double sum = 0;
    for (int c = 0; c < CHAINS; c++) sum += x[c][0];
    return sum;
}

static void bench_fma(struct bench *b, int threads, const char *name, double (*run)(void),
                      int lanes)
{
    double sum = 0;
    for (int r = -1; r < b->reps; r++) { /* round -1 raises the clock rate */
        const double start = wall_clock();
#pragma omp parallel num_threads(threads) reduction(+ : sum)
        sum += run();
        const double seconds = wall_clock() - start;
        if (r >= 0) b->sample[0][r] = 1e-9 * threads * (double)CHAINS * ROUNDS * lanes / seconds;
    }
    if (isnan(sum)) puts("# unused"); /* so that the compiler keeps the chains */
    print_row(b, "machine", "fma", 0, threads, name, "1e9/s", b->sample[0]);
}

/* Arrays larger than any cache; each thread first touches and copies its own part. */
static void bench_copy(struct bench *b, int threads)
{
    const size_t n = (size_t)1 << 27;
    char *const from = malloc(n), *const to = malloc(n);
    for (int r = -1; from && to && r < b->reps; r++) {
        const double start = wall_clock();
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int k = 0; k < threads; k++) {
            const size_t begin = n * (size_t)k / (size_t)threads,
                         end = n * (size_t)(k + 1) / (size_t)threads;
            if (r < 0) memset(from + begin, 1, end - begin);
            memcpy(to + begin, from + begin, end - begin);
        }
        if (r >= 0) b->sample[0][r] = 2e-9 * (double)n / (wall_clock() - start);
    }
    if (from && to)
        print_row(b, "machine", "copy", 0, threads, "read + write", "GB/s", b->sample[0]);
    free(from);
    free(to);
}

/* --- simulations --- */

struct sim {
    struct scene scene;
    struct simulation s;
    struct diag diag;
};

static bool sim_open(struct sim *x, const char *text)
{
    memset(x, 0, sizeof *x);
    if (scene_load_text(&x->scene, text, "bench.cfg", 0, NULL, &x->diag)) {
        fprintf(stderr, "%s\n", x->diag.text);
        return false;
    }
    if (simulation_create(&x->s, &x->scene, &x->diag)) {
        fprintf(stderr, "%s\n", x->diag.text);
        scene_free(&x->scene);
        return false;
    }
    return true;
}

static void sim_close(struct sim *x)
{
    simulation_free(&x->s);
    scene_free(&x->scene);
}

/* A tank with a swirl of a twentieth of the speed of sound, so that particles are sorted as often
 * as in a flow. */
static void fluid_case(char *text, size_t size, double n, bool rich, const char *precision)
{
    snprintf(text, size,
             "dp = %.17g\nend_time = 1e6\ngravity = 0, -9.81\nintegrator = leapfrog\n"
             "precision = %s\n"
             "[fluid water]\nshape = box 0, 0, 1, 1\nsound_speed = 50\nsurface = 1\n"
             "artificial_viscosity = %g\ndensity_diffusion = %g\n"
             "velocity = 2.5*sin(3.14159*x)*cos(3.14159*y), -2.5*cos(3.14159*x)*sin(3.14159*y)\n"
             "[wall tank]\nshape = polyline thickness -%.17g: 0, 1.2; 0, 0; 1, 0; 1, 1.2\n",
             1 / sqrt(n), precision, rich ? 0.05 : 0.0, rich ? 0.1 : 0.0, 4 / sqrt(n));
}

/* Steps of a repetition: enough for some six sorts in each. */
enum { FLUID_STEPS = 100 };

/* One repetition; false if a guard stopped it. */
static bool time_steps(struct bench *b, struct sim *x, int rep)
{
    double before[PHASE_COUNT];
    memcpy(before, x->s.phase_seconds, sizeof before);
    const int64_t evaluations = x->s.state.evaluations;
    const double instructions = counter_read(b->counter);
    for (int k = 0; k < FLUID_STEPS; k++) {
        if (!simulation_step(&x->s, 1e6, &x->diag)) continue;
        fprintf(stderr, "%s\n", x->diag.text);
        return false;
    }
    if (rep < 0) return true;
    const double each =
        1 / (double)(x->s.state.evaluations - evaluations) / (double)x->s.particles[KIND_FLUID].n;
    b->instructions[rep] = each * (counter_read(b->counter) - instructions);
    b->sample[PHASE_COUNT][rep] = 0;
    for (int p = 0; p < PHASE_COUNT; p++) {
        b->sample[p][rep] = 1e9 * each * (x->s.phase_seconds[p] - before[p]);
        b->sample[PHASE_COUNT][rep] += b->sample[p][rep];
    }
    return true;
}

static void print_per_particle(const struct bench *b, const struct sim *x, int threads,
                               const char *part, const char *unit, double *seconds)
{
    const int64_t n = x->s.particles[KIND_FLUID].n;
    for (int r = 0; r < b->reps; r++) seconds[r] *= 1e9 / (double)n;
    print_row(b, "fluid", x->s.fluid.variant->name, n, threads, part, unit, seconds);
}

/* Cost of a snapshot and a checkpoint, in a temporary folder. The first snapshot creates the file
 * and is not counted. */
static void bench_output(struct bench *b, struct sim *x, int threads)
{
    char folder[] = "bench-XXXXXX", kept[PATH_BYTES] = "";
    struct snapshots snapshots = {.folder = ""};
    struct checkpoint image = {0};
    if (!mkdtemp(folder)) {
        perror(folder);
        return;
    }
    enum err e = snapshots_create(&snapshots, folder, &x->scene, "bench", &x->diag);
    for (int r = -1; !e && r < b->reps; r++) {
        x->s.state.time += 1;
        simulation_refresh(&x->s);
        const double start = wall_clock();
        e = snapshots_write(&snapshots, &x->s, &x->diag);
        const double between = wall_clock();
        if (!e) e = checkpoint_capture(&image, &x->s, "", "bench", &x->diag);
        if (!e) e = checkpoint_store(&image, folder, kept, &x->diag);
        if (r < 0) continue;
        b->sample[0][r] = between - start;
        b->sample[1][r] = wall_clock() - between;
    }
    if (e) fprintf(stderr, "%s\n", x->diag.text);
    if (!e) {
        print_per_particle(b, x, threads, "snapshot", "ns/particle", b->sample[0]);
        print_per_particle(b, x, threads, "checkpoint", "ns/particle", b->sample[1]);
    }
    snapshots_close(&snapshots);
    checkpoint_free(&image);
    unlink(snapshots.path);
    unlink(kept);
    if (rmdir(folder)) perror(folder);
}

/* Pairs that a sweep computes, per fluid particle. */
static double pairs_of(const struct simulation *sim)
{
    static struct neighbour_clusters around;
    static struct cluster_list near;
    const struct cell_list *const list = &sim->cells.list[KIND_FLUID];
    const struct cluster_boxes *const boxes = &sim->fluid.packed[KIND_FLUID].boxes;
    const int32_t n = list->n_active;
    int64_t clusters = 0;
    for (int32_t m = 0; m < fluid_chunk_count(n); m++) {
        const int32_t first = fluid_chunk_start(n, m), end = fluid_chunk_start(n, m + 1);
        for (int32_t k = first; k < end; k++) {
            neighbour_clusters_collect(&around, boxes, &sim->cells, KIND_FLUID, list->active[k],
                                       sim->fluid.k.h, clusters_of(list, first, end));
            for (int32_t own = 0; own < clusters_in(list, list->active[k]); own++) {
                cluster_list_build_half(&near, &around, boxes);
                clusters += near.n;
            }
        }
    }
    return (double)(clusters * CLUSTER * CLUSTER) / (double)sim->particles[KIND_FLUID].n;
}

static void bench_fluid(struct bench *b, double n, bool rich, const char *precision, int threads)
{
    static const enum phase parts[] = {PHASE_sort, PHASE_packed, PHASE_wall, PHASE_fluid,
                                       PHASE_update};
    char text[1024];
    struct sim x;
    fluid_case(text, sizeof text, n, rich, precision);
    if (!sim_open(&x, text)) return;
    bool sound = true;
    for (int r = -1; sound && r < b->reps; r++) sound = time_steps(b, &x, r);
    const int64_t count = x.s.particles[KIND_FLUID].n;
    const char *const variant = x.s.fluid.variant->name;
    for (size_t k = 0; sound && k < COUNT_OF(parts); k++)
        print_row(b, "fluid", variant, count, threads, phase_table[parts[k]].name,
                  "ns/particle/evaluation", b->sample[parts[k]]);
    if (sound)
        print_row(b, "fluid", variant, count, threads, "all", "ns/particle/evaluation",
                  b->sample[PHASE_COUNT]);
    if (sound && threads == 1 && b->counter >= 0)
        print_row(b, "fluid", variant, count, threads, "instructions", "1/particle/evaluation",
                  b->instructions);
    if (sound && rich) bench_output(b, &x, threads);
    const double bytes = (double)x.s.arena.bytes / (double)count;
    for (int r = 0; r < b->reps; r++) b->sample[0][r] = bytes;
    print_row(b, "fluid", variant, count, threads, "memory", "bytes/particle", b->sample[0]);
    const double pairs = pairs_of(&x.s);
    for (int r = 0; r < b->reps; r++) b->sample[0][r] = pairs;
    print_row(b, "fluid", variant, count, threads, "pairs", "1/particle", b->sample[0]);
    sim_close(&x);
}

/* A swinging plate, 20 particles across. */
static void bench_solid(struct bench *b, const char *form, const char *precision, int threads)
{
    enum { STEPS = 200 };
    char text[1024], variant[64];
    struct sim x;
    snprintf(variant, sizeof variant, "%s (%s)", form, precision);
    snprintf(text, sizeof text,
             "dp = 1 mm\nend_time = 1\nprecision = %s\n"
             "[solid plate]\nshape = box 0, 0, 0.22, 0.02\nclamp = box 0, 0, 0.02, 0.02\n"
             "density = 1000\nyoung = 2e6\npoisson = 0.3975\nvelocity = 0, 0.5*x/(0.22 m)\n%s",
             precision,
             strcmp(form, "paper") == 0 ? "gradient = linear\nhourglass_form = printed\n" : "");
    if (!sim_open(&x, text)) return;
    struct particles *const particles = &x.s.particles[KIND_SOLID];
    x.s.solid.centred = false;
    for (int r = -1; r < b->reps; r++) {
        const double start = wall_clock();
        solid_advance(&x.s.solid, particles, x.s.dt_solid, STEPS);
        if (r >= 0) b->sample[0][r] = 1e9 * (wall_clock() - start) / STEPS / (double)particles->n;
    }
    print_row(b, "solid", variant, particles->n, threads, "step", "ns/particle/step", b->sample[0]);
    const struct solid *const solid = &x.s.solid;
    double slots = 0;
    for (int64_t k = 0; k < solid->n_packs; k++)
        slots += solid->pack[k].n_slots * solid->sweeps->lanes;
    for (int r = 0; r < b->reps; r++) b->sample[0][r] = slots / (double)particles->n;
    print_row(b, "solid", variant, particles->n, threads, "slots", "1/particle", b->sample[0]);
    sim_close(&x);
}

static void bench_all(struct bench *b, int threads, double largest)
{
    thread_use(threads);
    bench_fma(b, threads, "float", run_float, LANES_FLOAT);
    bench_fma(b, threads, "double", run_double, LANES_DOUBLE);
    bench_copy(b, threads);
    bench_solid(b, "default", "mixed", threads);
    bench_solid(b, "paper", "mixed", threads);
    bench_solid(b, "default", "double", threads);
    for (double n = 1e4; n <= largest; n *= 10) {
        for (int rich = 0; rich < 2; rich++) {
            bench_fluid(b, n, rich, "mixed", threads);
            bench_fluid(b, n, rich, "double", threads);
        }
    }
}

int main(int argc, char **argv)
{
    struct bench b = {.out = stdout,
                      .reps = 5,
                      .all_threads = thread_count(),
                      .counter = counter_open()};
    double largest = 1e5;
    for (int k = 1; k < argc; k++) {
        const bool more = k + 1 < argc;
        if (strcmp(argv[k], "--large") == 0) {
            largest = 1e6;
        } else if (more && strcmp(argv[k], "--reps") == 0) {
            b.reps = (int)max2(1, min2(MAX_REPS, atof(argv[++k])));
        } else if (more && strcmp(argv[k], "--out") == 0) {
            b.out = fopen(argv[++k], "w");
            if (!b.out) return perror(argv[k]), 1;
        } else {
            fprintf(stderr, "usage: %s [--large] [--reps N] [--out FILE]\n", argv[0]);
            return 1;
        }
    }
    print_machine(&b);
    bench_all(&b, 1, largest);
    if (b.all_threads > 1) bench_all(&b, b.all_threads, largest);
    if (b.out != stdout) fclose(b.out);
    return 0;
}
