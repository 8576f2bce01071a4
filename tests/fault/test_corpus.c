/* SPDX-License-Identifier: MIT
 * Replays the inputs that the fuzzers have kept (corpus/<target>/ in tests/fuzz/corpus.tar.gz),
 * each of which once reached code that no other did, and what once failed. In any build, under any
 * sanitizer. With an argument: writes fresh seeds of the checkpoint fuzzer to that folder. */
#include "base/files.h"
#include "fuzz.h"
#include "tiny.h"
#include "unity.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>

static int replayed;

void setUp(void) { replayed = 0; }

void tearDown(void) {}

static void replay_file(const char *path, int (*target)(const uint8_t *, size_t))
{
    struct diag d = {.code = ERR_OK};
    char *bytes;
    size_t size;
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, file_read(path, &bytes, &size, &d), d.text);
    TEST_ASSERT_EQUAL_INT(0, target((const uint8_t *)bytes, size));
    free(bytes);
    replayed++;
}

static void replay(const char *name, int (*target)(const uint8_t *, size_t))
{
    char folder[PATH_BYTES], path[PATH_BYTES];
    snprintf(folder, sizeof folder, "%s/%s", tiny_path("corpus"), name);
    DIR *dir = opendir(folder);
    TEST_ASSERT_NOT_NULL_MESSAGE(dir, folder);
    for (const struct dirent *entry; (entry = readdir(dir)) != NULL;) {
        if (entry->d_name[0] == '.') continue;
        TEST_ASSERT_EQUAL_INT(ERR_OK, path_join(path, folder, entry->d_name, NULL));
        replay_file(path, target);
    }
    closedir(dir);
    TEST_ASSERT_TRUE_MESSAGE(replayed > 3, folder);
}

static void unpack(void)
{
    char command[PATH_BYTES];
    snprintf(command, sizeof command, "tar -xzf tests/fuzz/corpus.tar.gz -C '%s'", tiny_path("."));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, system(command), command);
}

static void cases(void) { replay("case", fuzz_case); }

static void expressions(void) { replay("expr", fuzz_expr); }

static void motion_tables(void) { replay("motion", fuzz_motion); }

static void references(void) { replay("reference", fuzz_reference); }

static void rows_of_a_run(void) { replay("series", fuzz_series); }

static void checkpoints(void) { replay("checkpoint", fuzz_checkpoint); }

/* Of the format as it is now, which the kept ones may no longer be. */
static void a_fresh_checkpoint(void)
{
    char path[PATH_BYTES];
    snprintf(path, sizeof path, "%s", tiny_path("fresh.ckpt"));
    TEST_ASSERT_EQUAL_INT(0, fuzz_write_checkpoint(path, 3));
    replay_file(path, fuzz_checkpoint);
}

static int write_seeds(const char *folder)
{
    for (int steps = 0; steps <= 3; steps += 3) {
        char name[32], path[PATH_BYTES];
        snprintf(name, sizeof name, "steps-%d", steps);
        if (path_join(path, folder, name, NULL) || fuzz_write_checkpoint(path, steps)) return 1;
    }
    return 0;
}

int main(int argc, char **argv)
{
    if (argc > 1) return write_seeds(argv[1]);
    UNITY_BEGIN();
    RUN_TEST(unpack);
    RUN_TEST(cases);
    RUN_TEST(expressions);
    RUN_TEST(motion_tables);
    RUN_TEST(references);
    RUN_TEST(rows_of_a_run);
    RUN_TEST(checkpoints);
    RUN_TEST(a_fresh_checkpoint);
    return UNITY_END();
}
