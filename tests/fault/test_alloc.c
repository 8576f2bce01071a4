/* SPDX-License-Identifier: MIT
 * The n-th allocation fails, for every n of a run from its first to its last one, and of a restart,
 * a fork, the parts of a solid, --inspect, --explain and --preview: a sentence and a status each
 * time, nothing leaks, no lock is left, and what was good stays good. The linker puts these in
 * between:
 * --wrap: malloc calloc realloc aligned_alloc free fopen fdopen opendir open_memstream
 * Those within HDF5, a shared library, are not: it says itself that it does not survive all of
 * them; a snapshot that fails is rehearsed by test_snapshot_faults.c and by full disks. */
#include "base/files.h"
#include "geometry/scene_points.h"
#include "rig.h"
#include "sphfsi.h"
#include "tiny.h"
#include "unity.h"

#include <dirent.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static atomic_long countdown = -1, live; /* parts of a solid are made by their threads */
static long failures;
static atomic_bool hit;

static bool fails(void)
{
    if (countdown < 0 || countdown-- > 0) return false;
    errno = ENOMEM;
    return hit = true;
}

static void *counted(void *memory)
{
    live += memory != NULL;
    return memory;
}

void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *old, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void __real_free(void *memory);
FILE *__real_fopen(const char *path, const char *mode);
FILE *__real_fdopen(int fd, const char *mode);
DIR *__real_opendir(const char *path);
FILE *__real_open_memstream(char **text, size_t *size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *old, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
void __wrap_free(void *memory);
FILE *__wrap_fopen(const char *path, const char *mode);
FILE *__wrap_fdopen(int fd, const char *mode);
DIR *__wrap_opendir(const char *path);
FILE *__wrap_open_memstream(char **text, size_t *size);

void *__wrap_malloc(size_t size) { return fails() ? NULL : counted(__real_malloc(size)); }

void *__wrap_calloc(size_t n, size_t size)
{
    return fails() ? NULL : counted(__real_calloc(n, size));
}

void *__wrap_realloc(void *old, size_t size)
{
    if (fails()) return NULL;
    void *const memory = __real_realloc(old, size);
    live += !old && memory;
    return memory;
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    return fails() ? NULL : counted(__real_aligned_alloc(alignment, size));
}

void __wrap_free(void *memory)
{
    live -= memory != NULL;
    __real_free(memory);
}

FILE *__wrap_fopen(const char *path, const char *mode)
{
    return fails() ? NULL : __real_fopen(path, mode);
}

FILE *__wrap_fdopen(int fd, const char *mode) { return fails() ? NULL : __real_fdopen(fd, mode); }

/* Its text is the caller's to free. */
FILE *__wrap_open_memstream(char **text, size_t *size)
{
    return fails() ? NULL : counted(__real_open_memstream(text, size));
}

DIR *__wrap_opendir(const char *path) { return fails() ? NULL : __real_opendir(path); }

void setUp(void) { countdown = -1; }

void tearDown(void) { countdown = -1; }

static char folder[PATH_BYTES], begun[PATH_BYTES], path[PATH_BYTES + 300];
static const char *const sets[] = {"output.snapshot_interval=0.2 ms",
                                   "output.checkpoint_interval=0.2 ms"};
static const char *const stiffer[] = {"gate.young=2e6"};

static struct sphfsi_options options(const char *out, double until)
{
    return (struct sphfsi_options){.case_path = "tests/fault/tiny.cfg",
                                   .until = until,
                                   .threads = 1,
                                   .sets = sets,
                                   .n_sets = 2,
                                   .out = out};
}

static enum sphfsi_status fresh(void)
{
    const struct sphfsi_options o = options(folder, 0.0004);
    return sphfsi_run(&o);
}

/* A body that touches another, held by a clamp that moves, under a load. */
static enum sphfsi_status driven(void)
{
    static const char text[] =
        "dp = 1 cm\nend_time = 1 s\n[motion m]\nx = 0.1*t\n[contact all]\n"
        "[solid a]\nshape = box 0, 0, 0.05, 0.03\nclamp = box 0, 0, 0.02, 0.03\n"
        "clamp_motion = m\ndensity = 1000\nyoung = 1 MPa\npoisson = 0.3\n"
        "[solid b]\nlike = a\nshape = box 0.06, 0, 0.09, 0.03\nclamp = box 0.08, 0, 0.09, 0.03\n"
        "[load end]\nbody = b\nshape = box 0.06, 0, 0.07, 0.03\nforce = 1, 0\n";
    const struct sphfsi_options o = {.case_text = text, .until = 1e-5, .threads = 1, .out = folder};
    return sphfsi_run(&o);
}

static enum sphfsi_status restart(void)
{
    struct sphfsi_options o = options(folder, 0.0008);
    o.restart = 1;
    return sphfsi_run(&o);
}

static enum sphfsi_status fork_it(void)
{
    struct sphfsi_options o = options(folder, 0.0006);
    o.fork = path;
    o.sets = stiffer;
    o.n_sets = 1;
    return sphfsi_run(&o);
}

static enum sphfsi_status inspect(void)
{
    const struct sphfsi_options o = {0};
    return sphfsi_inspect(path, &o);
}

static enum sphfsi_status explain(void)
{
    const struct sphfsi_options o = options(NULL, 0);
    return sphfsi_explain(&o);
}

static enum sphfsi_status explain_json(void)
{
    const struct sphfsi_options o = options(NULL, 0);
    return sphfsi_explain_json(&o);
}

static enum sphfsi_status preview(void)
{
    char image[PATH_BYTES + 8];
    snprintf(image, sizeof image, "%s.svg", folder);
    const struct sphfsi_options o = options(image, 0);
    const enum sphfsi_status status = sphfsi_preview(&o);
    unlink(image);
    return status;
}

static void push(void *context, const struct sphfsi_particles *p, double *ax, double *ay)
{
    (void)context;
    for (int64_t i = 0; i < p->n; i++) ax[i] = ay[i] = 1;
}

static void drive(void *context, double time, double d[2], double v[2], double a[2])
{
    (void)context, (void)time;
    d[0] = d[1] = v[0] = v[1] = a[0] = a[1] = 0;
}

/* A program's own force and motion; the case has one of its own. */
static enum sphfsi_status library(void)
{
    static const char text[] =
        "dp = 1 cm\nend_time = 1 s\n[motion m]\nx = 0.05*t^2\n"
        "[solid a]\nshape = box 0, 0, 0.05, 0.04\nclamp = box 0, 0, 0.02, 0.04\n"
        "clamp_motion = m\ndensity = 1000\nyoung = 1 MPa\npoisson = 0.3\n";
    const struct sphfsi_options o = {.case_text = text, .threads = 1};
    struct sphfsi_simulation *s;
    enum sphfsi_status status = sphfsi_create(&s, &o);
    if (!status) status = sphfsi_set_force(s, SPHFSI_SOLID, push, NULL);
    if (!status) status = sphfsi_set_motion(s, "m", drive, NULL);
    if (!status) status = sphfsi_step(s, 1);
    const char *const said = sphfsi_error();
    TEST_ASSERT_TRUE(!status || said[0]);
    const enum sphfsi_status freed = sphfsi_free(s);
    return status ? status : freed;
}

static void begin(void)
{
    snprintf(begun, sizeof begun, "%s", tiny_path("begun"));
    const struct sphfsi_options o = options(begun, 0.0004);
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_run(&o), sphfsi_error());
    DIR *dir = opendir(begun);
    for (const struct dirent *e; (e = readdir(dir)) != NULL;)
        if (strstr(e->d_name, ".ckpt")) snprintf(path, sizeof path, "%s/%s", begun, e->d_name);
    closedir(dir);
}

static void copy_begun(void)
{
    static const char *const names[] = {"case.cfg", "ledger.csv", "probes.csv", "fields.vtkhdf",
                                        "summary.json"};
    char from[PATH_BYTES + 300], to[PATH_BYTES + 300];
    TEST_ASSERT_EQUAL_INT(0, mkdir(folder, 0777));
    for (size_t k = 0; k <= COUNT_OF(names); k++) {
        const char *name = k < COUNT_OF(names) ? names[k] : strrchr(path, '/') + 1;
        snprintf(from, sizeof from, "%s/%s", begun, name);
        snprintf(to, sizeof to, "%s/%s", folder, name);
        struct diag d = {.code = ERR_OK};
        char *bytes = NULL;
        size_t size;
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, file_read(from, &bytes, &size, &d), d.text);
        FILE *file = fopen(to, "wb");
        TEST_ASSERT_EQUAL_INT(size, fwrite(bytes, 1, size, file));
        fclose(file);
        free(bytes);
    }
}

static int count_checkpoints(void)
{
    int n = 0;
    DIR *dir = opendir(folder);
    for (const struct dirent *e; (e = readdir(dir)) != NULL;)
        n += strstr(e->d_name, ".ckpt") != NULL;
    closedir(dir);
    return n;
}

static void judge(enum sphfsi_status status, long n, const char *what)
{
    char message[1024], lock[PATH_BYTES + 300];
    snprintf(message, sizeof message, "%s, allocation %ld: %s", what, n, sphfsi_error());
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, live, message);
    snprintf(lock, sizeof lock, "%s/.lock", folder);
    TEST_ASSERT_TRUE_MESSAGE(access(lock, F_OK) != 0, message);
    /* The checkpoint that a restart began from is there, or a later one. */
    const bool begun_before = strcmp(what, "restart") == 0;
    TEST_ASSERT_TRUE_MESSAGE(!begun_before || count_checkpoints() > 0, message);
    if (!status || strcmp(what, "parts") == 0) return;
    const bool sequence = strstr(sphfsi_error(), "memory") != NULL;
    TEST_ASSERT_TRUE_MESSAGE(sequence, message);
    TEST_ASSERT_TRUE_MESSAGE(status == SPHFSI_MEMORY || status == SPHFSI_IO ||
                                 status == SPHFSI_INPUT,
                             message);
}

static void every_one(enum sphfsi_status (*work)(void), const char *what, long least)
{
    long n = 0;
    for (hit = true; hit; n++) {
        TEST_ASSERT_TRUE_MESSAGE(n < 20000, what);
        char name[64];
        snprintf(name, sizeof name, "%s%ld", what, n);
        snprintf(folder, sizeof folder, "%s", tiny_path(name));
        if (work == restart) copy_begun();
        hit = false;
        live = 0;
        countdown = n;
        const enum sphfsi_status status = work();
        countdown = -1;
        failures += hit;
        judge(status, n, what);
        TEST_ASSERT_TRUE_MESSAGE(hit || status == SPHFSI_OK, sphfsi_error());
        if (access(folder, F_OK) == 0) tiny_remove(folder);
    }
    char message[64];
    snprintf(message, sizeof message, "%s: %ld allocations only", what, n);
    TEST_ASSERT_TRUE_MESSAGE(n > least, message);
}

static void of_a_run(void) { every_one(fresh, "run", 100); }

static void of_a_driven_body(void) { every_one(driven, "driven", 100); }

static void of_a_restart(void) { every_one(restart, "restart", 100); }

static void of_a_fork(void) { every_one(fork_it, "fork", 100); }

static void of_inspect(void) { every_one(inspect, "inspect", 1); }

static void of_explain(void) { every_one(explain, "explain", 100); }

static void of_explain_json(void) { every_one(explain_json, "json", 100); }

static void of_preview(void) { every_one(preview, "preview", 50); }

static void of_a_library(void) { every_one(library, "library", 50); }

int main(void)
{
    if (!getenv("TMPDIR") && access("/dev/shm", W_OK) == 0) setenv("TMPDIR", "/dev/shm", 0);
    UNITY_BEGIN();
    RUN_TEST(begin);
    RUN_TEST(of_a_run);
    RUN_TEST(of_a_driven_body);
    RUN_TEST(of_a_restart);
    RUN_TEST(of_a_fork);
    RUN_TEST(of_inspect);
    RUN_TEST(of_explain);
    RUN_TEST(of_explain_json);
    RUN_TEST(of_preview);
    RUN_TEST(of_a_library);
    printf("found: %ld failing allocations\n", failures);
    return UNITY_END();
}
