/* SPDX-License-Identifier: MIT
 * Cases at the limits of what is read: lengths, depths and counts, tables, values that only
 * together are wrong. */
#include "case/params.h"
#include "case/scene.h"
#include "check/check.h"
#include "geometry/scene_points.h"
#include "unity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TOP "dp = 1 mm\nend_time = 1 s\n"
#define SOLID \
    "[solid a]\nshape = box 0, 0, 10 mm, 20 mm\ndensity = 1000\nyoung = 1 MPa\npoisson = 0.3\n"
#define FLUID "[fluid w]\nshape = box 0, 0, 20 mm, 20 mm\n"
#define WATER FLUID "sound_speed = 20\n"

static struct scene scene;
static struct diag diag;
static char warned[4000];
static char long_text[400000];

static void note(void *context, const char *text)
{
    (void)context;
    snprintf(warned + strlen(warned), sizeof warned - strlen(warned), "%s\n", text);
}

void setUp(void)
{
    diag = (struct diag){.warn = note};
    warned[0] = long_text[0] = '\0';
}

void tearDown(void) {}

static enum err load(const char *text)
{
    setUp();
    return scene_load_text(&scene, text, "l.cfg", 0, NULL, &diag);
}

static void refuses(const char *text, const char *message)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_INPUT, load(text), message);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, message), diag.text);
}

static void takes(const char *text)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, load(text), diag.text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, check_scene(&scene, &diag), diag.text);
    scene_free(&scene);
}

/* Appends so many times what `item` makes of a number. */
static void repeat(char *text, const char *item, int n)
{
    for (char *at = text + strlen(text); n > 0; n--) at += sprintf(at, item, n);
}

static void test_values_that_do_not_fit_together(void)
{
    static const struct {
        const char *text, *message;
    } row[] = {
        {TOP FLUID "max_pressure = 1e12\n[numerics]\nsound_factor = 1000\n",
         "l.cfg:3: [fluid w] Eq. 3 gives a speed of sound of 3.16228e+07 m/s, above the limit of "
         "1e7; "
         "reduce `max_speed` or `max_pressure`"},
        {TOP SOLID "joined = a\n",
         "l.cfg:3: [solid a] joined = a: a body cannot be joined to itself"},
        {TOP SOLID
         "clamp = box 0, 0, 10 mm, 5 mm\nclamp_motion = m\n[motion m]\nstart = 2\nstop = 2\n"
         "x = t\n",
         "l.cfg:10: [motion m] start = 2 s must come before stop = 2 s"},
        {TOP WATER "[probe p]\nquantity = force\n",
         "l.cfg:6: [probe p] needs `body`, the solids or walls that are measured"},
        {TOP SOLID "[probe p]\npoint = 5 mm, 5 mm\n",
         "l.cfg:8: [probe p] needs `body`, the body that is measured"},
        {TOP SOLID "[probe p]\nquantity = reaction\nbody = a\n",
         "l.cfg:8: [probe p] measures the force that holds a, but nothing does"},
        {TOP SOLID "[probe p]\nquantity = pressure\npoint = 0, 0\n",
         "l.cfg:8: [probe p] measures pressure, but there is no fluid"},
        {TOP WATER "[probe p]\nquantity = flux\npoint = 0, 0\nto = 0, 0\n",
         "l.cfg:6: [probe p] measures the flux through the line from `point` to `to`; the two "
         "points "
         "must differ"},
        {TOP WATER "[probe p]\nquantity = pressure\npoint = 0, 0\nbody = w\n",
         "l.cfg:6: [probe p] measures pressure of the fluid, at a fixed point; leave `body` out"},
        {TOP WATER "[outflow o]\nfrom = 20 mm, 0\nto = 20 mm, 20 mm\nlevel = 0.02\npressure = 3\n",
         "l.cfg:6: [outflow o] has both `pressure` and `level`"},
        {TOP WATER "[outflow o]\nfrom = 20 mm, 0\nto = 20 mm, 20 mm\nlevel = 0.02\n",
         "l.cfg:6: [outflow o] level = 0.02 m needs gravity that points down, but gravity is 0, 0 "
         "m/s^2"},
        {TOP WATER "[inflow o]\nfrom = 0, 0\nto = 0, 20 mm\nspeed = 1\npressure = 3\n",
         "l.cfg:6: [inflow o] has more than one of `speed`, `velocity` and `pressure`; keep one"},
    };
    for (size_t k = 0; k < COUNT_OF(row); k++) refuses(row[k].text, row[k].message);
}

/* Up to the end and no longer. */
static void test_gravity_at_the_end(void)
{
    refuses("dp = 1 mm\nend_time = 1\ngravity = 0, 1/(1 - t)\n" WATER,
            "component 2 is not finite at t = 1 s");
    takes("dp = 1 mm\nend_time = 1\ngravity = 0, 1/(1.001 - t)\n" WATER);
}

static void test_shifting_that_goes_wrong_is_warned_of(void)
{
    takes(TOP "scheme = paper\n" WATER
              "shifting = 10\nshifting_speed = largest\nartificial_viscosity = 0.1\n"
              "[numerics]\ncfl = 0.51\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warned,
                                        "shifting = 10 times numerics.cfl = 0.51 is above 5"),
                                 warned);
}

/* What an open boundary gives the fluid beyond its speed of sound, of 20 m/s. */
static void test_fast_open_boundaries_are_warned_of(void)
{
    const char *const text = TOP WATER "[inflow i]\nfrom = 0, 20 mm\nto = 0, 0\n%s\n";
    static const char *const row[][2] = {
        {"speed = 7", "gives the fluid up to 7 m/s, above 0.3 of the fluid's speed of sound"},
        {"speed = 5", NULL},
        {"pressure = -1e5", "gives the fluid up to 1e+05 Pa, which changes its density"},
        {"pressure = 1e4", NULL},
    };
    char all[1024];
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        snprintf(all, sizeof all, text, row[k][0]);
        takes(all);
        if (row[k][1]) {
            TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warned, row[k][1]), warned);
        } else {
            TEST_ASSERT_NULL_MESSAGE(strstr(warned, "gives the fluid"), warned);
        }
    }
    snprintf(all, sizeof all, text, "velocity = 0, 1");
    refuses(all, "its velocity is along the line everywhere and at all times");
}

static void test_sliding_along_one_side_is_warned_of(void)
{
    const char *const warning = "sides = one drags the fluid that slides along [solid a]";
    const char *const body = TOP
        "[numerics]\nsides = one\n" WATER
        "laminar_viscosity = 1e-3\n[solid a]\nshape = box 30 mm, 0, 50 mm, 10 mm\ndensity = 1100\n"
        "young = 1e5\npoisson = 0.3\nslip = %s\n";
    char text[1024];
    snprintf(text, sizeof text, body, "free");
    takes(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warned, warning), warned);
    snprintf(text, sizeof text, body, "none");
    takes(text);
    TEST_ASSERT_NULL_MESSAGE(strstr(warned, warning), warned);
    takes(TOP "[numerics]\nsides = one\n" WATER "[wall b]\nshape = box 0, -5 mm, 20 mm, 0\n");
    TEST_ASSERT_NULL_MESSAGE(strstr(warned, "sides = one"), warned);
}

/* A constant that needs 32 others, each the next one, is read; one that needs 33 is not. */
static void test_area_of_a_polygon(void)
{
    refuses(TOP SOLID "shape = polygon 0, 0; 1, 0; 0, 1.9e-12\n",
            "the polygon has no area; check its points");
    /* A sliver that has one holds no particle. */
    refuses(TOP SOLID "shape = polygon 0, 0; 1, 0; 0, 2.1e-12\n",
            "shape 2 of [solid a] contains no particle");
}

static void test_depth_of_constants(void)
{
    for (int n = 32; n <= 33; n++) {
        sprintf(long_text, TOP "title = t\n[constants]\n");
        for (int k = 0; k < n; k++)
            sprintf(long_text + strlen(long_text), "c%d = 1 + c%d\n", k, k + 1);
        sprintf(long_text + strlen(long_text), "c%d = 1\n" SOLID, n);
        char *const text = strdup(long_text);
        if (n == 32)
            takes(text);
        else
            refuses(text, "a chain of constants that use each other has more than 32 members");
        free(text);
    }
}

static void test_number_of_constants(void)
{
    for (int n = 512; n <= 513; n++) {
        sprintf(long_text, TOP SOLID "[constants]\n");
        repeat(long_text, "c%d = 1\n", n);
        char *const text = strdup(long_text);
        if (n == 512)
            takes(text);
        else
            refuses(text, "more than 512 constants are given; write some as numbers");
        free(text);
    }
}

static void test_number_of_points(void)
{
    for (int n = 4096; n <= 4097; n++) {
        sprintf(long_text, TOP SOLID "[wall w]\nshape = polyline thickness 4 mm: 0, 0.1");
        for (int k = 1; k < n; k++) sprintf(long_text + strlen(long_text), "; %d um, 0.1", 10 * k);
        strcat(long_text, "\n");
        char *const text = strdup(long_text);
        if (n == 4096)
            takes(text);
        else
            refuses(text, "more than 4096 points are given; use fewer points or several shapes");
        free(text);
    }
}

static void test_paths_that_are_too_long(void)
{
    memset(long_text, 'a', 5000);
    long_text[5000] = '\0';
    setUp();
    memset(long_text, 'a', 5000);
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, scene_load_text(&scene, TOP SOLID, long_text, 0, NULL, &diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, "the path of the case file is longer than"),
                                 diag.text);
}

static void test_a_file_that_is_too_long(void)
{
    FILE *const file = fopen("test_case_limits.tmp", "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs(TOP SOLID, file);
    for (int k = 0; k < (4 << 20) / 64; k++) fprintf(file, "# %-61d\n", k);
    fclose(file);
    setUp();
    TEST_ASSERT_EQUAL_INT(ERR_INPUT,
                          scene_load_text(&scene, NULL, "test_case_limits.tmp", 0, NULL, &diag));
    remove("test_case_limits.tmp");
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(diag.text, "test_case_limits.tmp: longer than 4194304 bytes; is it a case file?"),
        diag.text);
}

/* --- tables --- */

static enum err load_table(const char *bytes, size_t n)
{
    FILE *const file = fopen("test_case_limits.tmp", "wb");
    TEST_ASSERT_NOT_NULL(file);
    fwrite(bytes, 1, n, file);
    fclose(file);
    const enum err e =
        load(TOP SOLID "clamp = box 0, 0, 10 mm, 5 mm\nclamp_motion = m\n[motion m]\n"
                       "x = way(t)\n[table way]\ncolumn = 3\nfile = test_case_limits.tmp\n");
    remove("test_case_limits.tmp");
    return e;
}

static void test_tables(void)
{
    static const struct {
        const char *rows, *message;
    } row[] = {
        {"t, x, y\n0, 0, 0\n0.5 1e-3\t2e-3\n# more\n\n1; 0; 0\n", NULL},
        {"time, x, y\nnames, again, here\n0, 0, 0\n",
         "test_case_limits.tmp:2: 3 numbers are expected"},
        {"0, 0, 0\n1, inf, 0\n", "test_case_limits.tmp:2: 3 numbers are expected"},
        {"0, 0, 0\n1, 2e15, 0\n", "test_case_limits.tmp:2: 3 numbers are expected"},
        {"0, 0, 0\n1, 0, 0, 0\n", NULL},
        {"0, 0, 0\n1, 0, 0\n1, 0, 0\n",
         "test_case_limits.tmp:3: the first column must increase, but 1 follows 1"},
        {"-1, 0, 1e-3\n1, 0, 0\n", NULL},
        {"0, 0, 0\n", "needs two rows or more; there is 1"},
        {"0;0;0\n1;0,5;0\n", "test_case_limits.tmp:2: commas and semicolons in one row"},
        {"0\t0\t0\n0,5\t0\n", "test_case_limits.tmp:2: commas and tabs"},
        {"0,\t0,\t0\n1,\t0,\t0\n", NULL},
        {"0; 0; 0\n1; 0; 0 # rise of 1,5 m\n", NULL},
        {"# nothing\n", "needs two rows or more; there are 0"},
    };
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        const enum err e = load_table(row[k].rows, strlen(row[k].rows));
        TEST_ASSERT_EQUAL_INT_MESSAGE(row[k].message ? ERR_INPUT : ERR_OK, e, diag.text);
        if (!row[k].message) scene_free(&scene);
        const char *const said = row[k].message ? row[k].message : "";
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, said), diag.text);
    }
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, load_table("0 0 0\n1 0\0 0\n", 13));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, "test_case_limits.tmp:2: a byte of value 0"),
                                 diag.text);
}

static void test_long_tables(void)
{
    static char bytes[12000000];
    size_t n = 0;
    for (int k = 0; k <= 1000000; k++) n += (size_t)sprintf(bytes + n, "%d 0 0\n", k);
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, load_table(bytes, n));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, "more than 1000000 lines; use fewer rows"),
                                 diag.text);
}

static void test_a_folder_is_no_table(void)
{
    refuses(TOP SOLID "clamp = box 0, 0, 10 mm, 5 mm\n[table way]\nfile = .\n",
            "l.cfg:10: [table way] file: .: is not a file");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_values_that_do_not_fit_together);
    RUN_TEST(test_gravity_at_the_end);
    RUN_TEST(test_shifting_that_goes_wrong_is_warned_of);
    RUN_TEST(test_fast_open_boundaries_are_warned_of);
    RUN_TEST(test_sliding_along_one_side_is_warned_of);
    RUN_TEST(test_area_of_a_polygon);
    RUN_TEST(test_depth_of_constants);
    RUN_TEST(test_number_of_constants);
    RUN_TEST(test_number_of_points);
    RUN_TEST(test_paths_that_are_too_long);
    RUN_TEST(test_a_file_that_is_too_long);
    RUN_TEST(test_tables);
    RUN_TEST(test_long_tables);
    RUN_TEST(test_a_folder_is_no_table);
    return UNITY_END();
}
