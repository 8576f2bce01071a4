/* SPDX-License-Identifier: MIT */
#define _GNU_SOURCE /* memfd_create */
#include "fuzz.h"

#include "output/checkpoint.h"
#include "output/report.h"
#include "output/rows.h"
#include "expr/expr.h"
#include "case/scene.h"
#include "geometry/scene_points.h"
#include "geometry/motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static char *text_of(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);
    if (!text) abort();
    if (size) memcpy(text, data, size);
    text[size] = '\0';
    return text;
}

/* A failure must have a sentence and leave nothing; a success must have no failure. */
static void judge(enum err e, const struct diag *d)
{
    if (e != d->code || (e && strlen(d->text) < 10)) abort();
}

int fuzz_case(const uint8_t *data, size_t size)
{
    struct scene scene;
    struct diag d = {.code = ERR_OK};
    char *text = text_of(data, size);
    const enum err e = scene_load_text(&scene, text, "x.cfg", 0, NULL, &d);
    judge(e, &d);
    if (e && scene.arena.blocks) abort();
    if (!e) scene_free(&scene);
    free(text);
    return 0;
}

static bool find_name(void *context, const char *name, struct quantity *q, char why[EXPR_WHY])
{
    (void)context, (void)why;
    *q = (struct quantity){.value = 0.5};
    return strcmp(name, "H") == 0;
}

int fuzz_expr(const uint8_t *data, size_t size)
{
    const struct expr_names names = {.find = find_name, .scope = EXPR_IN_SPACE};
    struct arena a = {0};
    struct diag d = {.code = ERR_OK};
    struct expr *e;
    struct dim dim;
    struct quantity q;
    char why[EXPR_WHY] = "", *text = text_of(data, size);
    const struct slice slice = {text, size};
    if (expr_compile(&e, slice, &names, &dim, &a, why, &d) == ERR_OK)
        expr_at(e, 0.25, -3);
    else if (!why[0])
        abort();
    why[0] = '\0';
    if (!expr_value(slice, &(struct expr_names){.find = find_name}, &q, why) && !why[0]) abort();
    arena_free(&a);
    free(text);
    return 0;
}

static const char table_case[] =
    "dp = 1 cm\nend_time = 1\n[wall w]\nshape = box 0, 0, 0.03, 0.03\nmotion = m\n"
    "[fluid f]\nshape = box 0.03, 0, 0.05, 0.02\nsound_speed = 10\n"
    "[motion m]\nx = a(t)\ny = b(t)\n[table a]\ncolumn = 2\nfile = ";
static const char second_table[] = "\n[table b]\ncolumn = 3\nbetween = cubic\nfile = ";

/* The table is a file of its own in memory, so that nothing is written to a disk. */
int fuzz_motion(const uint8_t *data, size_t size)
{
    static int fd = -1;
    static struct scene scene;
    if (fd < 0) fd = memfd_create("table", 0);
    if (fd < 0 || ftruncate(fd, 0) != 0 || pwrite(fd, data, size, 0) != (ssize_t)size) return 0;
    char text[sizeof table_case + sizeof second_table + 64];
    snprintf(text, sizeof text, "%s/proc/self/fd/%d%s/proc/self/fd/%d\n", table_case, fd,
             second_table, fd);
    struct diag d = {.code = ERR_OK};
    const enum err e = scene_load_text(&scene, text, "x.cfg", 0, NULL, &d);
    judge(e, &d);
    if (e) return 0;
    for (int k = -1; k < 12; k++) {
        const struct motion_state m = motion_at(&scene, 0, 0.1 * k);
        if (!isfinite(m.d[0]) || !isfinite(m.d[1])) abort();
    }
    scene_free(&scene);
    return 0;
}

/* --- files of rows: on a disk of memory, in one folder for each process --- */

static char rows_folder[64];

static void remove_rows(void)
{
    char path[128];
    snprintf(path, sizeof path, "%s/rows.csv", rows_folder);
    unlink(path);
    snprintf(path, sizeof path, "%s/probes.csv", rows_folder);
    unlink(path);
    rmdir(rows_folder);
}

static const char *write_rows(const char *name, const uint8_t *data, size_t size)
{
    static char path[2][128];
    static int next;
    if (!rows_folder[0]) {
        snprintf(rows_folder, sizeof rows_folder, "%s/sphfsi-fuzz-XXXXXX",
                 access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
        if (!mkdtemp(rows_folder)) abort();
        atexit(remove_rows);
    }
    next = !next;
    snprintf(path[next], sizeof path[next], "%s/%s", rows_folder, name);
    FILE *const file = fopen(path[next], "wb");
    if (!file || fwrite(data, 1, size, file) != size) abort();
    fclose(file);
    return path[next];
}

/* Up to the first byte of value 0 the file of a reference, behind it the probes that are compared.
 */
int fuzz_reference(const uint8_t *data, size_t size)
{
    static const char header[] = "time_s,P_dx_m,P_dy_m";
    const uint8_t *const zero = size ? memchr(data, 0, size) : NULL;
    const size_t first = zero ? (size_t)(zero - data) : size;
    char text[512];
    snprintf(text, sizeof text,
             "dp = 1 cm\nend_time = 1\n[solid s]\nshape = box 0, 0, 0.05, 0.05\n"
             "density = 1000\nyoung = 1e6\npoisson = 0.3\n[probe P]\nbody = s\n"
             "point = 0.05, 0.05\n[reference r]\nprobe = P_dy_m\nfile = %s\n",
             write_rows("rows.csv", data, first));
    const char *const probes =
        write_rows("probes.csv", zero ? zero + 1 : data, zero ? size - first - 1 : size);
    static struct scene scene;
    struct references r = {0};
    struct diag d = {.code = ERR_OK};
    if (scene.top.dp == 0 && scene_load_text(&scene, text, "/x.cfg", 0, NULL, &d)) abort();
    struct arena a = {0};
    const struct probe_file file = {.header = header};
    enum err e = references_open(&r, &scene, 1, &file, &a, &d);
    judge(e, &d);
    if (!e) {
        e = reference_score(r.item, probes, &d);
        judge(e, &d);
        if (!e && r.item->score.points < 0) abort();
    }
    arena_free(&a);
    return 0;
}

/* The rows of a run that is continued at half a second. */
int fuzz_series(const uint8_t *data, size_t size)
{
    struct series s = {.fd = -1};
    struct diag d = {.code = ERR_OK};
    double first[3], last;
    write_rows("rows.csv", data, size);
    const enum err e =
        series_resume(&s, rows_folder, "rows.csv", "time_s,x,y", 0.5, first, &last, &d);
    judge(e, &d);
    if (!e && !(last <= 0.5)) abort();
    if (!e) judge(series_row(&s, (const double[]){0.5, 1, 2}, &d), &d);
    series_close(&s);
    return 0;
}

/* --- checkpoints --- */

static const char small_case[] =
    "dp = 1 cm\nend_time = 0.02 s\ngravity = 0, -9.81\n[fluid water]\nshape = box 0, 0, 0.03, "
    "0.02\n"
    "sound_speed = 20\nsurface = 0.02\n[wall tank]\nshape = box 0, -0.02, 0.04, 0\n[solid gate]\n"
    "shape = box 0.03, 0, 0.06, 0.03\ndensity = 1100\nyoung = 1e6\npoisson = 0.4\n";

static struct scene small_scene;

static void open_small(struct simulation *sim)
{
    struct diag d = {.code = ERR_OK};
    if (small_scene.top.dp == 0 && scene_load_text(&small_scene, small_case, "x.cfg", 0, NULL, &d))
        abort();
    if (simulation_create(sim, &small_scene, &d)) abort();
}

/* One for all inputs, since building it takes longer than all else: a checkpoint replaces the whole
 * state, whatever the one before it left. */
static struct simulation small;
static bool small_open;

static void close_small(void)
{
    simulation_free(&small);
    scene_free(&small_scene);
}

static struct simulation *small_simulation(void)
{
    if (!small_open) {
        open_small(&small);
        atexit(close_small);
    }
    small_open = true;
    return &small;
}

int fuzz_write_checkpoint(const char *path, int steps)
{
    struct simulation sim;
    struct checkpoint m = {0};
    struct diag d = {.code = ERR_OK};
    open_small(&sim);
    for (int k = 0; k < steps; k++)
        if (simulation_step(&sim, 1, &d)) abort();
    if (checkpoint_capture(&m, &sim, small_case, "0", &d)) abort();
    checkpoint_seal(&m);
    FILE *file = fopen(path, "wb");
    const bool written = file && fwrite(m.bytes, 1, m.size, file) == m.size;
    const bool closed = file && fclose(file) == 0;
    checkpoint_free(&m);
    simulation_free(&sim);
    return !(written && closed);
}

/* First as it is, then with the sums, the length and the magic put right: whoever wrote them, the
 * reader must not fall over what the blocks say. A state that is taken must bear a step. */
int fuzz_checkpoint(const uint8_t *data, size_t size)
{
    struct checkpoint m = {.bytes = malloc(size + 1), .size = size, .capacity = size};
    struct diag d = {.code = ERR_OK};
    if (!m.bytes) abort();
    if (size) memcpy(m.bytes, data, size);
    judge(checkpoint_check(&m, "x.ckpt", &d), &d);
    d.code = ERR_OK;
    if (size < 160) {
        checkpoint_free(&m);
        return 0;
    }
    const uint64_t length = size;
    memcpy(m.bytes, "SPHFSICK", 8);
    memcpy(m.bytes + 32, &length, sizeof length);
    checkpoint_seal(&m);
    enum err e = checkpoint_check(&m, "x.ckpt", &d);
    judge(e, &d);
    if (!e) {
        struct block block;
        checkpoint_info(&m);
        for (size_t at = 0; checkpoint_block(&m, &at, &block);)
            if (block.count < 0 || !block.data) abort();
        d.code = ERR_OK;
        e = checkpoint_apply(&m, small_simulation(), &d);
        judge(e, &d);
        if (!e) judge(simulation_step(small_simulation(), small.state.time + 1e-5, &d), &d);
        d.code = ERR_OK;
        e = checkpoint_fork(&m, small_simulation(), &d);
        judge(e, &d);
        if (!e) judge(simulation_step(small_simulation(), small.state.time + 1e-5, &d), &d);
    }
    checkpoint_free(&m);
    return 0;
}
