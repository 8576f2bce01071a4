/* SPDX-License-Identifier: MIT
 * Every allocation of an arena fails once: a sentence each time, nothing leaks, nothing crashes. */
#include "base/base.h"
#include "sphfsi.h"
#include "tiny.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

void setUp(void) {}

void tearDown(void) { arena_fail_after(-1); }

/* A beam with a load and a clamp that moves. */
static const char beam[] =
    "dp = 1 cm\nend_time = 1\n[motion m]\nvelocity = 0.1, 0\n[solid bar]\nshape = box 0, 0, 0.5, "
    "0.04\n"
    "clamp = box 0, 0, 0.04, 0.04\nclamp_motion = m\ndensity = 1000\nyoung = 1e6\npoisson = 0.3\n"
    "[load end]\nbody = bar\nshape = box 0.4, 0, 0.5, 0.04\nforce = 30, 0\n";

static void each_allocation_fails(const char *text, int threads)
{
    const struct sphfsi_options o = {.case_text = text, .threads = threads};
    enum sphfsi_status status = SPHFSI_MEMORY;
    long n = 0;
    for (; status && n < 5000; n++) {
        struct sphfsi_simulation *s;
        arena_fail_after(n);
        status = sphfsi_create(&s, &o);
        if (status) {
            TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_MEMORY, status, sphfsi_error());
            TEST_ASSERT_NOT_NULL_MESSAGE(strstr(sphfsi_error(), "memory"), sphfsi_error());
            TEST_ASSERT_NULL(s);
        }
        sphfsi_free(s);
    }
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, status);
    TEST_ASSERT_TRUE(n > 50);
}

static void building_fails_cleanly(void)
{
    each_allocation_fails(tiny_case, 0);
    each_allocation_fails(beam, 2);
}

static void a_run_fails_cleanly(void)
{
    struct sphfsi_options o = {.case_text = tiny_case, .until = 0.0002};
    enum sphfsi_status status = SPHFSI_MEMORY;
    for (long n = 0; status && n < 5000; n += 7) {
        char name[32];
        snprintf(name, sizeof name, "run%ld", n);
        o.out = tiny_path(name);
        arena_fail_after(n);
        status = sphfsi_run(&o);
        TEST_ASSERT_TRUE_MESSAGE(status == SPHFSI_MEMORY || status == SPHFSI_OK, sphfsi_error());
    }
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, status);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(building_fails_cleanly);
    RUN_TEST(a_run_fails_cleanly);
    return UNITY_END();
}
