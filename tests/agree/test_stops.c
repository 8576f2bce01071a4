/* SPDX-License-Identifier: MIT
 * A run stopped after any of its steps and continued, on another number of threads, ends with the
 * bits, the rows and the snapshots of the run that was not stopped: between two sortings, within a
 * cycle of Verlet, with sub-steps, right at an output that has not been written yet, after the last
 * step. Every other time the run goes on behind the checkpoint, so that rows and snapshots have to
 * be dropped. */
#include "base/files.h"
#include "case/params.h"
#include "output/snapshot_file.h"
#include "sphfsi.h"
#include "tiny.h"
#include "unity.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

static struct sphfsi_requests requests;
static int64_t stop_after, save_after, steps_done;
static int stops;            /* of all forms */
static int64_t stop_in_step; /* a step of this number, while its rows are written; 0: none */

void setUp(void) {}

void tearDown(void) {}

static void watch(void *context, const struct sphfsi_progress *p)
{
    (void)context;
    steps_done = p->steps;
    if (p->steps >= stop_after) requests.stop = SIGTERM;
    const struct itimerval soon = {.it_value = {0, 3000}};
    if (stop_in_step > 0 && p->steps + 1 == stop_in_step) setitimer(ITIMER_REAL, &soon, NULL);
    /* Looked at after the next step, or batch of steps of a lone solid. */
    if (save_after > 0 && p->steps + 1 >= save_after) requests.checkpoint = 1, save_after = -1;
}

struct form {
    const char *name, *file; /* of a shipped case; NULL: the tiny one */
    int every;               /* stop after every so many steps; negative: so many times */
    const char *sets[24];
};

static enum sphfsi_status run(const struct form *f, const char *out, int threads, bool restart,
                              const char *checkpoint)
{
    int n = 0;
    while (n < (int)COUNT_OF(f->sets) && f->sets[n]) n++;
    requests = (struct sphfsi_requests){.checkpoint = save_after == 1};
    const struct sphfsi_options o = {.case_path = f->file,
                                     .case_text = f->file ? NULL : tiny_case,
                                     .sets = f->sets,
                                     .n_sets = n,
                                     .threads = threads,
                                     .out = out,
                                     .restart = restart,
                                     .restart_file = checkpoint,
                                     .requests = &requests,
                                     .progress = watch,
                                     .progress_interval = 1e-12};
    const enum sphfsi_status status = sphfsi_run(&o);
    char message[PATH_BYTES];
    snprintf(message, sizeof message, "%s: %s", f->name, sphfsi_error());
    const enum sphfsi_status wanted = requests.stop ? SPHFSI_INTERRUPT : SPHFSI_OK;
    TEST_ASSERT_EQUAL_INT_MESSAGE(wanted, status, message);
    return status;
}

/* --- comparing --- */

static char *read_all(const char *folder, const char *name, size_t *size)
{
    static char *bytes;
    char path[PATH_BYTES + 300];
    struct diag d = {.code = ERR_OK};
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (file_read(path, &bytes, size, &d)) TEST_FAIL_MESSAGE(d.text);
    return bytes;
}

static void same_file(const char *a, const char *b, const char *name, const char *what)
{
    size_t n, m;
    char *const x = read_all(a, name, &n), *const y = read_all(b, name, &m);
    TEST_ASSERT_TRUE_MESSAGE(strcmp(x, y) == 0, what);
    free(x);
    free(y);
}

static void same_hash(const char *a, const char *b, const char *what)
{
    size_t n, m;
    char *const x = read_all(a, "summary.json", &n), *const y = read_all(b, "summary.json", &m);
    const char *const from = strstr(x, "\"state_hash\""), *const to = strstr(y, "\"state_hash\"");
    TEST_ASSERT_TRUE_MESSAGE(from && to, what);
    TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(from, to, strcspn(from, "\n") + 1, what);
    free(x);
    free(y);
}

enum { COLUMNS_MOST = 6 }; /* of a dataset */

static void same_snapshots(const char *a, const char *b, const char *what)
{
    hid_t file[2];
    const char *const folder[2] = {a, b};
    int64_t rows[2][D_COUNT];
    for (int k = 0; k < 2; k++) {
        char path[PATH_BYTES + 300];
        snprintf(path, sizeof path, "%s/fields.vtkhdf", folder[k]);
        file[k] = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
        const int64_t n = snapshot_file_steps(file[k]);
        TEST_ASSERT_TRUE_MESSAGE(n > 1 && snapshot_file_rows(file[k], n, rows[k]), what);
    }
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(rows[0], rows[1], sizeof rows[0], what);
    for (int k = 0; k < D_COUNT; k++) {
        const size_t bytes = ((size_t)rows[0][k] + 1) * COLUMNS_MOST * 8;
        void *const x = calloc(bytes, 1), *const y = calloc(bytes, 1);
        const bool there = snapshot_file_first(file[0], (enum data)k, rows[0][k], x);
        TEST_ASSERT_TRUE(there == snapshot_file_first(file[1], (enum data)k, rows[1][k], y));
        /* The scenes have no beams. */
        TEST_ASSERT_TRUE(there == !(k >= D_THICKNESS && k <= D_CURVATURE));
        if (there) TEST_ASSERT_EQUAL_MEMORY_MESSAGE(x, y, bytes, what);
        free(x);
        free(y);
    }
    H5Fclose(file[0]);
    H5Fclose(file[1]);
}

static void same(const char *a, const char *b, const char *what)
{
    same_file(a, b, "case.cfg", what);
    DIR *dir = opendir(a);
    TEST_ASSERT_NOT_NULL_MESSAGE(dir, a);
    int rows = 0;
    for (const struct dirent *e; (e = readdir(dir)) != NULL;) {
        if (!strstr(e->d_name, ".csv")) continue;
        same_file(a, b, e->d_name, what);
        rows++;
    }
    closedir(dir);
    TEST_ASSERT_TRUE_MESSAGE(rows > 0, what);
    same_hash(a, b, what);
    same_snapshots(a, b, what);
}

/* --- stopping --- */

/* The first checkpoint of the folder by its name. */
static void oldest(const char *folder, char path[PATH_BYTES + 300])
{
    DIR *dir = opendir(folder);
    TEST_ASSERT_NOT_NULL(dir);
    char first[256] = "step-x";
    for (const struct dirent *e; (e = readdir(dir)) != NULL;)
        if (strncmp(e->d_name, "step-", 5) == 0 && strcmp(e->d_name, first) < 0)
            snprintf(first, sizeof first, "%s", e->d_name);
    closedir(dir);
    snprintf(path, PATH_BYTES + 300, "%s/%s", folder, first);
}

static void stop_and_go_on(const struct form *f, const char *whole, int64_t at)
{
    char name[64], what[160], cut[PATH_BYTES], checkpoint[PATH_BYTES + 300];
    snprintf(name, sizeof name, "stop%d", stops++);
    snprintf(cut, sizeof cut, "%s", tiny_path(name));
    snprintf(what, sizeof what, "%s, stopped after step %ld", f->name, (long)at);
    const bool behind = stops % 2 != 0;
    stop_after = at + (behind ? 3 : 0);
    save_after = behind ? at : -1;
    run(f, cut, 1, false, NULL);
    oldest(cut, checkpoint);
    stop_after = INT64_MAX;
    save_after = -1;
    run(f, cut, 2, true, behind ? checkpoint : NULL);
    same(whole, cut, what);
    tiny_remove(cut);
}

static void sweep(const struct form *f)
{
    char whole[PATH_BYTES];
    snprintf(whole, sizeof whole, "%s", tiny_path(f->name));
    stop_after = INT64_MAX;
    save_after = -1;
    run(f, whole, 1, false, NULL);
    const int64_t steps = steps_done;
    TEST_ASSERT_TRUE_MESSAGE(steps >= 8, f->name);
    const int64_t stride = f->every > 0 ? f->every : steps / -f->every;
    for (int64_t at = stride; at <= steps; at += stride) stop_and_go_on(f, whole, at);
    tiny_remove(whole);
}

/* Sortings every few steps (a thin skin), and outputs that meet in places and differ in others. */
#define TINY                                                                                     \
    "end_time=3 ms", "output.probe_interval=0.3 ms", "output.ledger_interval=0.5 ms",            \
        "output.snapshot_interval=1.5 ms", "numerics.skin=0.002", "water.velocity=1 m/s, 0 m/s", \
        "P.interval=0.2 ms"

/* --- a stop while rows are written --- */

static void stop_now(int number) { requests.stop = number == SIGALRM ? SIGTERM : 0; }

/* The time that the rows reach. */
static double last_row(const char *folder)
{
    size_t size;
    char *const rows = read_all(folder, "probes.csv", &size);
    rows[size - 1] = '\0';
    const double time = strtod(strrchr(rows, '\n') + 1, NULL);
    free(rows);
    return time;
}

/* The rest of the step's rows is left to the restart, which may be stopped as well. */
static void between_rows(void)
{
    const struct form f = {"between rows", NULL, 1, {TINY, "output.probe_interval=0.01 us"}};
    char whole[PATH_BYTES], cut[PATH_BYTES];
    int left = 0;
    snprintf(whole, sizeof whole, "%s", tiny_path("whole"));
    snprintf(cut, sizeof cut, "%s", tiny_path("cut"));
    stop_after = INT64_MAX;
    save_after = -1;
    run(&f, whole, 1, false, NULL);
    signal(SIGALRM, stop_now);
    for (stop_in_step = 1; stop_in_step < 4;) {
        run(&f, cut, 1, stop_in_step > 1, NULL);
        const double stopped = strtod(strstr(sphfsi_error(), " at ") + 4, NULL);
        left += last_row(cut) < stopped - 1e-6;
        stop_in_step = steps_done + 1;
    }
    stop_in_step = 0;
    run(&f, cut, 1, true, NULL);
    same(whole, cut, f.name);
    TEST_ASSERT_TRUE(left > 0);
}

/* The integrator of this number, "integrator=NAME", or false: the case knows no more. */
static bool integrator_of(int k, char text[64])
{
    const char *at = param_find(SECTION_top, "integrator")->choices;
    for (; k > 0 && (at = strchr(at, '|')) != NULL; k--) at++;
    if (at) snprintf(text, 64, "integrator=%.*s", (int)strcspn(at, "|"), at);
    return at != NULL;
}

static void every_integrator_with_sub_steps(void)
{
    char integrator[64], name[96];
    for (int k = 0; integrator_of(k, integrator); k++) {
        snprintf(name, sizeof name, "tiny, %s", integrator);
        sweep(&(struct form){name, NULL, 1, {TINY, integrator, "numerics.verlet_reset=7"}});
    }
}

static void every_integrator_at_a_single_rate(void)
{
    char integrator[64], name[96];
    for (int k = 0; integrator_of(k, integrator); k++) {
        snprintf(name, sizeof name, "tiny, single rate, %s", integrator);
        sweep(&(struct form){name,
                             NULL,
                             1,
                             {TINY, integrator, "numerics.verlet_reset=7", "numerics.multirate=off",
                              "precision=double", "water.diffusion_form=antuono"}});
    }
}

/* --- shipped cases: the lines `short NAME END SETTING...` of test_restart_cases.sh --- */

enum { MORE = 5 }; /* settings that are added to those of a line */

/* The next word, without its quotes, ends the text where it stood; NULL: there is none. A line that
 * ends in a backslash goes on in the next one. */
static char *next_word(char **at)
{
    char *c = *at + strspn(*at, " \\");
    while (c[0] == '\n' && c[-1] == '\\') c += 1 + strspn(c + 1, " \\");
    if (*c == '\n' || !*c) return NULL;
    const bool quoted = *c == '"';
    char *const word = c + quoted, *const end = word + strcspn(word, quoted ? "\"" : " \n");
    *at = end + (*end == '"');
    if (*end == '\n') {
        memmove(word - 1, word, (size_t)(end - word)); /* the end of the line stays */
        end[-1] = '\0';
        return word - 1;
    }
    *end = '\0';
    if (!quoted) ++*at;
    return word;
}

/* Three stops each, at steps that no output chose. */
static void stop_case(char *at)
{
    static int cases;
    char name[128], settings[MORE][64], *word;
    const char *const case_name = next_word(&at);
    const double end = strtod(next_word(&at), NULL);
    char file[256];
    snprintf(file, sizeof file, "cases/%s.cfg", case_name);
    snprintf(name, sizeof name, "%s", case_name);
    snprintf(settings[0], sizeof settings[0], "end_time=%.12g", end);
    snprintf(settings[1], sizeof settings[1], "output.probe_interval=%.12g", 0.15 * end);
    snprintf(settings[2], sizeof settings[2], "output.ledger_interval=%.12g", 0.15 * end);
    snprintf(settings[3], sizeof settings[3], "output.snapshot_interval=%.12g", 0.5 * end);
    if (!integrator_of(cases, settings[4])) integrator_of(cases = 0, settings[4]);
    cases++;
    struct form f = {name, file, -3, {NULL}};
    int n = 0;
    while (n < MORE) f.sets[n] = settings[n], n++;
    while ((word = next_word(&at)) != NULL) {
        TEST_ASSERT_TRUE(n + 1 < (int)COUNT_OF(f.sets));
        f.sets[n++] = word;
    }
    sweep(&f);
}

static void shipped_cases(void)
{
    static const char begin[] = "\nshort ";
    size_t size;
    char *const text = read_all("tests/agree", "test_restart_cases.sh", &size);
    int cases = 0;
    for (char *at = text; (at = strstr(at, begin)) != NULL; cases++) {
        char line[1024];
        at += sizeof begin - 1;
        snprintf(line, sizeof line, "%s", at);
        stop_case(line);
    }
    free(text);
    TEST_ASSERT_TRUE(cases >= 5);
}

int main(void)
{
    /* In memory where that is possible: thousands of synced files say nothing here. */
    if (!getenv("TMPDIR") && access("/dev/shm", W_OK) == 0) setenv("TMPDIR", "/dev/shm", 0);
    UNITY_BEGIN();
    RUN_TEST(shipped_cases);
    RUN_TEST(between_rows);
    RUN_TEST(every_integrator_with_sub_steps);
    RUN_TEST(every_integrator_at_a_single_rate);
    printf("found: %d stops\n", stops);
    return UNITY_END();
}
