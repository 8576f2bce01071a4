/* SPDX-License-Identifier: MIT
 * What a checkpoint is said to hold, and a run that goes on from one of another version. */
#include "output/checkpoint.h"
#include "rig.h"
#include "sphfsi.h"
#include "tiny.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static struct rig rig;
static struct checkpoint image;
static char said[100000], path[PATH_BYTES];

static void note(void *context, enum sphfsi_message kind, const char *text)
{
    (void)context;
    const size_t n = strlen(said);
    snprintf(said + n, sizeof said - n, "%s%s\n", kind == SPHFSI_WARNING ? "warning: " : "", text);
}

void setUp(void)
{
    rig_one_thread();
    said[0] = '\0';
}

void tearDown(void)
{
    rig_close(&rig);
    checkpoint_free(&image);
}

static void says(const char *line) { TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, line), said); }

static void store(const char *version)
{
    mkdir(tiny_path("ckpt"), 0777);
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_capture(&image, &rig.sim, "the case\nin two lines\n",
                                                     version, &rig.diag));
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_store(&image, tiny_path("ckpt"), path, &rig.diag));
}

static const struct sphfsi_options noting = {.message = note};

static void test_head_and_case(void)
{
    char line[PATH_BYTES + 200];
    rig_open(&rig, tiny_case, NULL);
    rig_steps(&rig, 3, 1);
    store("9.8.7");
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_inspect(path, &noting), sphfsi_error());
    snprintf(line, sizeof line, "%s: a valid checkpoint of %zu bytes, written by sphfsi 9.8.7\n",
             path, image.size);
    says(line);
    snprintf(line, sizeof line, "  time %.9g s, 3 steps\n", rig.sim.state.time);
    says(line);
    says("  fluid         100 particles\n");
    says("  solid          45 particles\n");
    says("the case\n");
    says("in two lines\n");
}

/* A run of the program's own, whose checkpoint claims another version: it goes on, with a word. */
static void test_another_version_is_said(void)
{
    struct sphfsi_options o = {.case_text = tiny_case,
                               .message = note,
                               .threads = 1,
                               .until = 0.001,
                               .out = tiny_path("run")};
    struct diag d = {.code = ERR_OK};
    char file[PATH_BYTES], text[PATH_BYTES + 200];
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_run(&o), sphfsi_error());
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_newest(&image, o.out, file, &d));
    const size_t n = strlen(sphfsi_version());
    size_t at = 0;
    while (memcmp(image.bytes + at, sphfsi_version(), n + 1) != 0) at++;
    image.bytes[at] = '9';
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_store(&image, o.out, file, &d));
    o.restart = 1;
    o.until = 0.002;
    said[0] = '\0';
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_run(&o), sphfsi_error());
    snprintf(text, sizeof text, "warning: %s was written by version 9%s, but this is %s: ", file,
             sphfsi_version() + 1, sphfsi_version());
    says(text);
    o.until = 0.003;
    said[0] = '\0';
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_run(&o), sphfsi_error());
    TEST_ASSERT_NULL_MESSAGE(strstr(said, "was written by version"), said);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_head_and_case);
    RUN_TEST(test_another_version_is_said);
    return UNITY_END();
}
