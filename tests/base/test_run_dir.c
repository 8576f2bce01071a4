/* SPDX-License-Identifier: MIT
 * The folder of a run: never overwritten, locked while a run lives, files whole or not at all. */
#include "base/files.h"
#include "tiny.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static struct diag diag;

void setUp(void) { diag = (struct diag){.code = ERR_OK}; }

void tearDown(void) {}

static void touch(const char *path)
{
    FILE *file = fopen(path, "w");
    TEST_ASSERT_NOT_NULL(file);
    fclose(file);
}

static void folders_above_are_made(void)
{
    struct run_dir f;
    TEST_ASSERT_EQUAL_INT(ERR_OK, run_dir_open(&f, tiny_path("a/b/c"), RUN_DIR_FRESH, &diag));
    run_dir_close(&f);
    TEST_ASSERT_EQUAL_INT(0, access(tiny_path("a/b/c"), F_OK));
    TEST_ASSERT_NOT_EQUAL(0, access(tiny_path("a/b/c/.lock"), F_OK));
}

static void results_are_not_overwritten(void)
{
    static const char *const names[] = {"summary.json", "probes.csv", "case.cfg", "x.ckpt"};
    for (size_t k = 0; k < COUNT_OF(names); k++) {
        struct run_dir f;
        char name[64];
        snprintf(name, sizeof name, "full%zu", k);
        mkdir(tiny_path(name), 0777);
        snprintf(name, sizeof name, "full%zu/%s", k, names[k]);
        touch(tiny_path(name));
        snprintf(name, sizeof name, "full%zu", k);
        diag.code = ERR_OK;
        TEST_ASSERT_EQUAL_INT(ERR_INPUT, run_dir_open(&f, tiny_path(name), RUN_DIR_FRESH, &diag));
        TEST_ASSERT_NOT_NULL(strstr(diag.text, names[k]));
        TEST_ASSERT_NOT_NULL(strstr(diag.text, "--restart"));
        TEST_ASSERT_NOT_NULL(strstr(diag.text, "--out"));
    }
}

static void other_files_do_no_harm(void)
{
    struct run_dir f;
    mkdir(tiny_path("notes"), 0777);
    touch(tiny_path("notes/readme.txt"));
    TEST_ASSERT_EQUAL_INT(ERR_OK, run_dir_open(&f, tiny_path("notes"), RUN_DIR_FRESH, &diag));
    run_dir_close(&f);
}

static void a_restart_needs_the_folder(void)
{
    struct run_dir f;
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, run_dir_open(&f, tiny_path("none"), RUN_DIR_CONTINUE, &diag));
    TEST_ASSERT_NOT_EQUAL(0, access(tiny_path("none"), F_OK));
}

static void a_second_run_is_refused(void)
{
    struct run_dir a, b;
    TEST_ASSERT_EQUAL_INT(ERR_OK, run_dir_open(&a, tiny_path("lock"), RUN_DIR_FRESH, &diag));
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, run_dir_open(&b, tiny_path("lock"), RUN_DIR_FRESH, &diag));
    char process[32];
    snprintf(process, sizeof process, "%ld", (long)getpid());
    TEST_ASSERT_NOT_NULL(strstr(diag.text, process));
    run_dir_close(&a);
    diag.code = ERR_OK;
    TEST_ASSERT_EQUAL_INT(ERR_OK, run_dir_open(&b, tiny_path("lock"), RUN_DIR_FRESH, &diag));
    run_dir_close(&b);
}

static void a_killed_run_leaves_no_lock(void)
{
    struct run_dir f;
    const pid_t child = fork();
    if (child == 0) {
        if (run_dir_open(&f, tiny_path("dead"), RUN_DIR_FRESH, &diag)) _exit(1);
        abort(); /* SIGABRT: nothing is cleaned up */
    }
    int status;
    waitpid(child, &status, 0);
    TEST_ASSERT_TRUE(WIFSIGNALED(status));
    TEST_ASSERT_EQUAL_INT(0, access(tiny_path("dead/.lock"), F_OK));
    TEST_ASSERT_EQUAL_INT(ERR_OK, run_dir_open(&f, tiny_path("dead"), RUN_DIR_FRESH, &diag));
    run_dir_close(&f);
}

static void what_cannot_be_made_is_named(void)
{
    struct run_dir f;
    touch(tiny_path("file"));
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, run_dir_open(&f, tiny_path("file/sub"), RUN_DIR_FRESH, &diag));
    TEST_ASSERT_NOT_NULL(strstr(diag.text, "file"));
}

static void a_file_is_replaced_whole_or_kept(void)
{
    struct atomic_file b;
    char *bytes;
    size_t size;
    for (int round = 0; round < 2; round++) {
        TEST_ASSERT_EQUAL_INT(ERR_OK, atomic_file_open(&b, tiny_folder(), "whole", &diag));
        fprintf(b.file, "round %d", round);
        TEST_ASSERT_EQUAL_INT(ERR_OK, atomic_file_commit(&b, &diag));
    }
    TEST_ASSERT_EQUAL_INT(ERR_OK, atomic_file_open(&b, tiny_folder(), "whole", &diag));
    fputs("given up", b.file);
    atomic_file_abandon(&b);
    TEST_ASSERT_EQUAL_INT(ERR_OK, file_read(tiny_path("whole"), &bytes, &size, &diag));
    TEST_ASSERT_EQUAL_STRING("round 1", bytes);
    free(bytes);
    TEST_ASSERT_NOT_EQUAL(0, access(tiny_path("whole.part"), F_OK));
}

static void a_path_that_is_too_long_is_counted(void)
{
    static char path[PATH_BYTES + 10];
    struct run_dir f;
    memset(path, 'a', sizeof path - 1);
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, run_dir_open(&f, path, RUN_DIR_FRESH, &diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text,
                                        "folder of the run: the path has 4105 characters"),
                                 diag.text);
    diag.code = ERR_OK;
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, run_dir_open(&f, "", RUN_DIR_FRESH, &diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, "the path has 0 characters"), diag.text);
}

/* Another that has not written its number yet. */
static void an_unnamed_owner_is_unknown(void)
{
    struct run_dir first, second;
    TEST_ASSERT_EQUAL_INT(ERR_OK, run_dir_open(&first, tiny_path("unnamed"), RUN_DIR_FRESH, &diag));
    TEST_ASSERT_EQUAL_INT(0, truncate(tiny_path("unnamed/.lock"), 0));
    TEST_ASSERT_EQUAL_INT(ERR_INPUT,
                          run_dir_open(&second, tiny_path("unnamed"), RUN_DIR_FRESH, &diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text,
                                        "another run (process unknown) is writing there"),
                                 diag.text);
    run_dir_close(&first);
}

/* Only what was made goes, from the inside out, and nothing that holds something. */
static void what_was_made_is_withdrawn(void)
{
    struct run_dir f;
    mkdir(tiny_path("own"), 0777);
    TEST_ASSERT_EQUAL_INT(ERR_OK, run_dir_open(&f, tiny_path("own/x//y"), RUN_DIR_FRESH, &diag));
    run_dir_withdraw(&f);
    TEST_ASSERT_NOT_EQUAL(0, access(tiny_path("own/x"), F_OK));
    TEST_ASSERT_EQUAL_INT(0, access(tiny_path("own"), F_OK));
    TEST_ASSERT_EQUAL_INT(ERR_OK, run_dir_open(&f, tiny_path("own/x/y"), RUN_DIR_FRESH, &diag));
    touch(tiny_path("own/x/note"));
    run_dir_withdraw(&f);
    TEST_ASSERT_NOT_EQUAL(0, access(tiny_path("own/x/y"), F_OK));
    TEST_ASSERT_EQUAL_INT(0, access(tiny_path("own/x/note"), F_OK));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(folders_above_are_made);
    RUN_TEST(results_are_not_overwritten);
    RUN_TEST(other_files_do_no_harm);
    RUN_TEST(a_restart_needs_the_folder);
    RUN_TEST(a_second_run_is_refused);
    RUN_TEST(a_killed_run_leaves_no_lock);
    RUN_TEST(what_cannot_be_made_is_named);
    RUN_TEST(a_file_is_replaced_whole_or_kept);
    RUN_TEST(a_path_that_is_too_long_is_counted);
    RUN_TEST(an_unnamed_owner_is_unknown);
    RUN_TEST(what_was_made_is_withdrawn);
    return UNITY_END();
}
