/* SPDX-License-Identifier: MIT
 * The n-th call of the system fails, alone or with all after it, for every n of a run, a restart, a
 * run that a guard stops, --explain, --preview and --inspect. What must not be lost is said; after
 * that the run goes on from its last checkpoint to the same bits, or is begun anew. test_inject.sh
 * does so to the whole program, but kills it, too, and takes every thirtieth call only. The linker
 * puts these in between:
 * --wrap: access stat lstat fstat flock ftruncate fsync rename unlink link lseek read write fclose
 * --wrap: fflush
 * --wrap: fread fdopen readlink getcwd realpath sysconf newlocale clock_gettime pthread_create
 * --wrap: rmdir
 * --wrap: mkdir posix_fallocate open_memstream */
#include "base/files.h"
#include "sphfsi.h"
#include "tiny.h"
#include "unity.h"

#include <errno.h>
#include <locale.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static atomic_long countdown = -1;
static bool broken; /* all later calls fail, too */
static atomic_bool hit;
static const char *which; /* the first that failed */
static int warnings;

static bool fails(const char *name)
{
    if (countdown < 0) return false;
    if (countdown > 0) {
        countdown--;
        return false;
    }
    if (hit && !broken) return false;
    if (!hit) which = name;
    hit = true;
    errno = EIO;
    return true;
}

#define FAILS(type, name, parameters, arguments, failure) \
    type __real_##name parameters;                        \
    type __wrap_##name parameters;                        \
    type __wrap_##name parameters { return fails(#name) ? (failure) : __real_##name arguments; }
FAILS(int, access, (const char *a, int b), (a, b), -1)
FAILS(int, stat, (const char *restrict a, struct stat *restrict b), (a, b), -1)
FAILS(int, lstat, (const char *restrict a, struct stat *restrict b), (a, b), -1)
FAILS(int, fstat, (int a, struct stat *b), (a, b), -1)
FAILS(int, flock, (int a, int b), (a, b), -1)
FAILS(int, ftruncate, (int a, off_t b), (a, b), -1)
FAILS(int, fsync, (int a), (a), -1)
FAILS(int, rename, (const char *a, const char *b), (a, b), -1)
FAILS(int, unlink, (const char *a), (a), -1)
FAILS(int, link, (const char *a, const char *b), (a, b), -1)
FAILS(int, rmdir, (const char *a), (a), -1)
FAILS(int, mkdir, (const char *a, mode_t b), (a, b), -1)
FAILS(off_t, lseek, (int a, off_t b, int c), (a, b, c), -1)
FAILS(ssize_t, read, (int a, void *b, size_t c), (a, b, c), -1)
FAILS(int, fflush, (FILE * a), (a), -1)
FAILS(size_t, fread, (void *restrict a, size_t b, size_t c, FILE *restrict d), (a, b, c, d), 0)
FAILS(FILE *, fdopen, (int a, const char *b), (a, b), NULL)
FAILS(ssize_t, readlink, (const char *restrict a, char *restrict b, size_t c), (a, b, c), -1)
FAILS(char *, getcwd, (char *a, size_t b), (a, b), NULL)
FAILS(char *, realpath, (const char *restrict a, char *restrict b), (a, b), NULL)
FAILS(long, sysconf, (int a), (a), -1)
FAILS(locale_t, newlocale, (int a, const char *b, locale_t c), (a, b, c), (locale_t)0)
FAILS(int, pthread_create,
      (pthread_t *restrict a, const pthread_attr_t *restrict b, void *(*c)(void *),
       void *restrict d),
      (a, b, c, d), EAGAIN)
FAILS(int, posix_fallocate, (int a, off_t b, off_t c), (a, b, c), ENOSPC)
FAILS(FILE *, open_memstream, (char **a, size_t *b), (a, b), NULL)
FAILS(int, fclose, (FILE * a), (a), (__real_fclose(a), EOF))

/* Half of it is written, as to a disk that is full. */
ssize_t __real_write(int fd, const void *from, size_t n);
ssize_t __wrap_write(int fd, const void *from, size_t n);
ssize_t __wrap_write(int fd, const void *from, size_t n)
{
    return __real_write(fd, from, fails("write") ? n / 2 : n);
}

/* The clocks of the run itself never fail. */
int __real_clock_gettime(clockid_t id, struct timespec *t);
int __wrap_clock_gettime(clockid_t id, struct timespec *t);
int __wrap_clock_gettime(clockid_t id, struct timespec *t)
{
    return id == CLOCK_THREAD_CPUTIME_ID && fails("clock_gettime") ? -1
                                                                   : __real_clock_gettime(id, t);
}

void setUp(void) {}
void tearDown(void) { countdown = -1; }

static char folder[PATH_BYTES], begun[PATH_BYTES];
static char whole[32]; /* the hash of a run of nothing but successes */

static void note(void *context, enum sphfsi_message kind, const char *text)
{
    (void)context, (void)text;
    warnings += kind == SPHFSI_WARNING && countdown >= 0 && hit;
}

static struct sphfsi_options options(void)
{
    static const char *const sets[] = {"output.snapshot_interval=0.2 ms",
                                       "output.checkpoint_interval=0.1 ms",
                                       "output.probe_interval=0.2 ms"};
    return (struct sphfsi_options){.case_path = "tests/fault/tiny.cfg",
                                   .until = 0.0004,
                                   .threads = 1,
                                   .sets = sets,
                                   .n_sets = 3,
                                   .out = folder,
                                   .message = note};
}

static enum sphfsi_status fresh(void)
{
    const struct sphfsi_options o = options();
    return sphfsi_run(&o);
}

static enum sphfsi_status restart(void)
{
    struct sphfsi_options o = options();
    o.restart = 1;
    return sphfsi_run(&o);
}

/* Steps that are far too long: a guard stops the run. */
static enum sphfsi_status stopped(void)
{
    static const char *const sets[] = {"numerics.fixed_step=2 ms",
                                       "output.checkpoint_interval=10 ms",
                                       "output.probe_interval=10 ms"};
    struct sphfsi_options o = options();
    o.sets = sets;
    o.until = 0.02;
    return sphfsi_run(&o);
}

static enum sphfsi_status explain(void)
{
    const struct sphfsi_options o = options();
    return sphfsi_explain(&o);
}

static enum sphfsi_status explain_json(void)
{
    const struct sphfsi_options o = options();
    return sphfsi_explain_json(&o);
}

static enum sphfsi_status preview(void)
{
    char path[PATH_BYTES + 8];
    struct sphfsi_options o = options();
    snprintf(path, sizeof path, "%s.svg", folder);
    o.out = path;
    return sphfsi_preview(&o);
}

static enum sphfsi_status inspect(void)
{
    const struct sphfsi_options o = options();
    return sphfsi_inspect(begun, &o);
}

static void hash_of(char hash[32])
{
    char path[PATH_BYTES + 16], *text;
    size_t size;
    struct diag d = {.code = ERR_OK};
    snprintf(path, sizeof path, "%s/summary.json", folder);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, file_read(path, &text, &size, &d), d.text);
    const char *const at = strstr(text, "\"state_hash\": ");
    TEST_ASSERT_NOT_NULL(at);
    snprintf(hash, 32, "%.18s", at + strlen("\"state_hash\": "));
    free(text);
}

static void begin(void)
{
    snprintf(folder, sizeof folder, "%s", tiny_path("begun"));
    snprintf(begun, sizeof begun, "%s", folder);
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, fresh(), sphfsi_error());
    hash_of(whole);
}

/* Goes on from the last checkpoint, or begins anew, to the bits of a run without faults. */
static void go_on(const char *message)
{
    char hash[32];
    if (restart() != SPHFSI_OK) {
        tiny_remove(folder);
        TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, fresh(), message);
    }
    hash_of(hash);
    TEST_ASSERT_EQUAL_STRING_MESSAGE(whole, hash, message);
}

static bool is_one_of(const char *names, const char *name)
{
    char word[32];
    snprintf(word, sizeof word, " %s ", name);
    return strstr(names, word) != NULL;
}

/* `expected`: the status without a fault. */
static void every_call(enum sphfsi_status (*work)(void), const char *what,
                       enum sphfsi_status expected, long least)
{
    const bool runs = work == fresh || work == restart;
    long n = 0, tried = 0, said = 0;
    for (int all = 0; all < 2; all++) {
        broken = all;
        hit = true;
        for (n = 0; hit; n += all ? 3 : 1) {
            char message[1500];
            TEST_ASSERT_TRUE_MESSAGE(n < 5000, what);
            snprintf(folder, sizeof folder, "%s", tiny_path(what));
            if (work == restart) {
                struct sphfsi_options o = options();
                o.until = 0.0002;
                TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_run(&o), sphfsi_error());
            }
            hit = false;
            warnings = 0;
            countdown = n;
            const enum sphfsi_status status = work();
            countdown = -1;
            snprintf(message, sizeof message, "%s, call %ld (%s%s): %d, %s", what, n, which,
                     all ? " and all later ones" : "", (int)status, sphfsi_error());
            tried += hit;
            said += status != expected || warnings;
            TEST_ASSERT_TRUE_MESSAGE(hit || status == expected, message);
            TEST_ASSERT_TRUE_MESSAGE(!status || sphfsi_error()[0], message);
            /* What was to be kept is lost if one of these fails. */
            const bool loses = hit && runs && is_one_of(" write fsync fflush ftruncate ", which);
            TEST_ASSERT_TRUE_MESSAGE(!loses || status != expected || warnings, message);
            if (hit && runs && n % 3 == 0) go_on(message);
            if (__real_access(folder, F_OK) == 0) tiny_remove(folder);
        }
        TEST_ASSERT_TRUE_MESSAGE(n > least, what);
    }
    printf("%s: %ld failures, %ld of them said\n", what, tried, said);
}

static void of_a_run(void) { every_call(fresh, "run", SPHFSI_OK, 50); }
static void of_a_restart(void) { every_call(restart, "restart", SPHFSI_OK, 50); }
static void of_a_stop(void) { every_call(stopped, "stop", SPHFSI_GUARD, 50); }
static void of_explain(void) { every_call(explain, "explain", SPHFSI_OK, 5); }
static void of_explain_json(void) { every_call(explain_json, "json", SPHFSI_OK, 5); }
static void of_preview(void) { every_call(preview, "preview", SPHFSI_OK, 5); }
static void of_inspect(void) { every_call(inspect, "inspect", SPHFSI_OK, 2); }

int main(void)
{
    if (!getenv("TMPDIR") && __real_access("/dev/shm", W_OK) == 0) setenv("TMPDIR", "/dev/shm", 0);
    UNITY_BEGIN();
    RUN_TEST(begin);
    RUN_TEST(of_a_run);
    RUN_TEST(of_a_restart);
    RUN_TEST(of_a_stop);
    RUN_TEST(of_explain);
    RUN_TEST(of_explain_json);
    RUN_TEST(of_preview);
    RUN_TEST(of_inspect);
    return UNITY_END();
}
