/* SPDX-License-Identifier: MIT
 * Every allocation of an arena fails once: a sentence each time, nothing leaks, nothing crashes. */
#include "base/base.h"
#include "sphfsi.h"
#include "tiny.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

void setUp(void) {}

static void remove_files(void);

void tearDown(void)
{
    arena_fail_after(-1);
    remove_files();
}

/* A beam with a load and a clamp that moves. */
static const char beam[] =
    "dp = 1 cm\nend_time = 1\n[motion m]\nx = 0.1*t\n[solid bar]\nshape = box 0, 0, 0.5, "
    "0.04\n"
    "clamp = box 0, 0, 0.04, 0.04\nclamp_motion = m\ndensity = 1000\nyoung = 1e6\npoisson = 0.3\n"
    "[load end]\nbody = bar\nshape = box 0.4, 0, 0.5, 0.04\nforce = 30, 0\n";

/* Nearly all that a case can have; its files are written beside it. */
static const char rich[] = "dp = 10 mm\n"
                           "end_time = 1\n"
                           "gravity = 0, -9.81\n"
                           "[fluid w]\n"
                           "shape = box 0, 0, 0.3, 0.1\n"
                           "minus = box 0.14, 0, 0.18, 0.1\n"
                           "sound_speed = 20\n"
                           "artificial_viscosity = 0.02\n"
                           "laminar_viscosity = 1e-3\n"
                           "surface = 0.1\n"
                           "[wall bed]\n"
                           "shape = box -0.2, -0.04, 0.5, 0\n"
                           "slip = none\n"
                           "[wall slope]\n"
                           "shape = polyline thickness -0.04: 0.1, 0.25; 0.2, 0.3\n"
                           "[wall stamp]\n"
                           "shape = box 0.02, 0.42, 0.06, 0.46\n"
                           "motion = down\n"
                           "[motion down]\n"
                           "y = way(t)\n"
                           "[table way]\n"
                           "between = cubic\n"
                           "file = memory-table.tmp\n"
                           "[solid block]\n"
                           "shape = box 0.02, 0.36, 0.06, 0.42\n"
                           "clamp = box 0.02, 0.36, 0.06, 0.37\n"
                           "density = 1200\n"
                           "young = 1e5\n"
                           "poisson = 0.3\n"
                           "[solid post]\n"
                           "shape = box 0.14, -0.04, 0.18, 0.15\n"
                           "clamp = box 0.14, -0.04, 0.18, 0\n"
                           "density = 1100\n"
                           "young = 1 MPa\n"
                           "poisson = 0.4\n"
                           "[load push]\n"
                           "body = post\n"
                           "shape = box 0.14, 0.14, 0.18, 0.15\n"
                           "force = 0.1, 0\n"
                           "[contact all]\n"
                           "friction = 0.3\n"
                           "[inflow in]\n"
                           "from = 0, 0.1\n"
                           "to = 0, 0\n"
                           "speed = 0.1\n"
                           "[outflow out]\n"
                           "from = 0.3, 0\n"
                           "to = 0.3, 0.1\n"
                           "level = 0.1\n"
                           "[probe tip]\n"
                           "body = post\n"
                           "point = 0.16, 0.15\n"
                           "[probe p]\n"
                           "quantity = pressure\n"
                           "point = 0.05, 0.02\n"
                           "interval = 1 ms\n"
                           "average = 1 ms\n"
                           "[probe both]\n"
                           "quantity = force\n"
                           "body = post, block\n"
                           "[reference r]\n"
                           "probe = tip_dx_m\n"
                           "file = memory-reference.tmp\n";

static void write_file(const char *path, const char *text)
{
    FILE *const file = fopen(path, "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs(text, file);
    fclose(file);
}

static void write_files(void)
{
    write_file("memory-table.tmp", "0, 0\n0.5, -0.001\n1, -0.002\n");
    write_file("memory-reference.tmp", "0, 0\n0.5, 1e-3\n");
}

static void remove_files(void)
{
    remove("memory-table.tmp");
    remove("memory-reference.tmp");
}

static void no_force(void *context, const struct sphfsi_particles *p, double *ax, double *ay)
{
    (void)context, (void)p, (void)ax, (void)ay;
}

static void no_motion(void *context, double time, double d[2], double v[2], double a[2])
{
    (void)context, (void)time, (void)d, (void)v, (void)a;
}

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

static void building_a_rich_scene_fails_cleanly(void)
{
    write_files();
    each_allocation_fails(rich, 2);
}

/* Forces and motions of the program. */
static void settings_fail_cleanly(void)
{
    static sphfsi_force *const force = no_force;
    struct sphfsi_simulation *s;
    const struct sphfsi_options o = {.case_text = rich, .threads = 1};
    write_files();
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_create(&s, &o), sphfsi_error());
    for (int what = 0; what < 4; what++) {
        enum sphfsi_status status = SPHFSI_MEMORY;
        for (long n = 0; status; n++) {
            struct sphfsi_view view;
            TEST_ASSERT_TRUE(n < 20);
            arena_fail_after(n);
            status = what < 2 ? sphfsi_set_force(s, what ? SPHFSI_SOLID : SPHFSI_FLUID, force, NULL)
                     : what == 2 ? sphfsi_set_motion(s, "down", no_motion, NULL)
                                 : sphfsi_field(s, SPHFSI_SOLID, "stress", &view);
            TEST_ASSERT_TRUE_MESSAGE(status == SPHFSI_MEMORY || !status, sphfsi_error());
            TEST_ASSERT_TRUE(n > 0 || status == SPHFSI_MEMORY);
        }
        arena_fail_after(-1);
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_step(s, 1), sphfsi_error());
    sphfsi_free(s);
}

static void run_fails(const char *text, const char *folder, double until, int step)
{
    struct sphfsi_options o = {.case_text = text, .until = until, .threads = 1};
    enum sphfsi_status status = SPHFSI_MEMORY;
    for (long n = 0; status && n < 5000; n += step) {
        char name[32];
        snprintf(name, sizeof name, "%s%ld", folder, n);
        o.out = tiny_path(name);
        arena_fail_after(n);
        status = sphfsi_run(&o);
        TEST_ASSERT_TRUE_MESSAGE(status == SPHFSI_MEMORY || status == SPHFSI_OK, sphfsi_error());
    }
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, status);
}

static void a_run_fails_cleanly(void) { run_fails(tiny_case, "tiny", 0.0002, 7); }

static void a_rich_run_fails_cleanly(void)
{
    write_files();
    run_fails(rich, "rich", 0.0002, 3);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(building_fails_cleanly);
    RUN_TEST(building_a_rich_scene_fails_cleanly);
    RUN_TEST(settings_fail_cleanly);
    RUN_TEST(a_run_fails_cleanly);
    RUN_TEST(a_rich_run_fails_cleanly);
    return UNITY_END();
}
