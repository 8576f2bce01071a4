/* SPDX-License-Identifier: MIT
 * [table]: files of numbers as functions of expressions, their slopes, and files that are
 * refused. */
#include "case/params.h"
#include "geometry/scene_points.h"
#include "geometry/motion.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define CASE                                                                                   \
    "dp = 1 mm\nend_time = 1 s\n[fluid w]\nshape = box 0, 0, 20 mm, 20 mm\nsound_speed = 20\n" \
    "[wall bed]\nshape = box 0, -5 mm, 20 mm, 0\nmotion = move\n"
#define FILE_OF(name) "[table " name "]\nfile = test_tables.tmp\n"

static struct scene scene, again;
static struct diag diag;

void setUp(void) { diag = (struct diag){0}; }

void tearDown(void)
{
    scene_free(&scene);
    scene_free(&again);
    remove("test_tables.tmp");
}

static enum err read(const char *text, const char *rows)
{
    FILE *const file = fopen("test_tables.tmp", "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs(rows, file);
    fclose(file);
    return scene_load_text(&scene, text, "t.cfg", 0, NULL, &diag);
}

static void must_read(const char *text, const char *rows)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, read(text, rows), diag.text);
}

static void expect(double time, double d, double v, double a)
{
    const struct motion_state m = motion_at(&scene, 0, time);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, d, m.d[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-11, v, m.v[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, a, m.a[0]);
}

#define MOVES(x) CASE "[motion move]\nx = " x "\n" FILE_OF("way")
static const char rows[] = "t,d\n# a comment\n0.1 0.01 # one\n0.2; 0.04\n0.4,0\n";

/* At a row the slope is that of the segment that follows. */
static void test_linear_between_rows_and_constant_outside(void)
{
    must_read(MOVES("way(t)"), rows);
    expect(0, 0, 0, 0);
    expect(0.1, 0, 0.3, 0);
    expect(0.15, 0.015, 0.3, 0);
    expect(0.2, 0.03, -0.2, 0);
    expect(0.3, 0.01, -0.2, 0);
    expect(0.4, -0.01, 0, 0);
    expect(9, -0.01, 0, 0);
}

/* Its argument may be any expression; where that falls, what follows a row is before it. */
static void test_the_argument_is_an_expression(void)
{
    must_read(MOVES("2*way(0.5 - t) + way(t^2)"), rows);
    expect(0, 0, 0, 0);
    expect(0.1, 0, 0.4, 0);
    expect(0.3, 2 * 0.04, -0.6, 0);
    expect(0.4, 2 * 0.01 + 0.018, 2 * 0 + 0.3 * 0.8, 0.3 * 2);
}

/* The side after a kink, for the other functions with one. */
static void test_kinks_have_the_slope_that_follows(void)
{
    must_read(MOVES("max(t, 0.5) + max(0.25, t) + min(t, 0.75) + min(0.75, t) + abs(0.25 - t)"),
              rows);
    expect(0.25, 0.25, 1 + 2 + 1, 0);
    expect(0.5, 1.25, 2 + 2 + 1, 0);
    expect(0.75, 2.5, 2 + 1, 0);
}

static void test_a_cubic_is_smooth_and_does_not_overshoot(void)
{
    must_read(MOVES("way(t)") "between = cubic\n", "0 0\n0.1 0.01\n0.2 0.04\n0.3 0.04\n0.5 0\n");
    struct motion_state before = motion_at(&scene, 0, 0);
    const double step = 1e-4;
    for (int k = -100; k < 7000; k++) {
        const struct motion_state m = motion_at(&scene, 0, k * step);
        TEST_ASSERT_TRUE(isfinite(m.a[0]) && m.d[0] <= 0.04 + 1e-15 && m.d[0] >= -1e-15);
        TEST_ASSERT_DOUBLE_WITHIN(0.02, before.v[0], m.v[0]);
        TEST_ASSERT_DOUBLE_WITHIN(5e-6, before.d[0] + 0.5 * step * (before.v[0] + m.v[0]), m.d[0]);
        before = m;
    }
    expect(0.1, 0.01, 0.15, motion_at(&scene, 0, 0.1).a[0]);
    expect(0.3, 0.04, 0, motion_at(&scene, 0, 0.3).a[0]);
    expect(0.5, 0, 0, 0);
}

/* One file, a [table] for each column; also in constants and at the top. */
static void test_columns(void)
{
    must_read("gravity = a(t), b(t) - 1\n" CASE
              "[motion move]\n" FILE_OF("a") "column = 2\n" FILE_OF(
                  "b") "column = n\n[constants]\nn = 3\nc = 10*a(0.1)\n",
              "0, 1, 4\n0.2, 2, -2\n");
    double g[2];
    scene_gravity_at(&scene, 0.05, g);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 1.25, g[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 1.5, g[1]);
    TEST_ASSERT_EQUAL_DOUBLE(3, scene.top.gravity[1]);
    TEST_ASSERT_EQUAL_DOUBLE(15, scene.constant[1].value);
}

static void test_the_effective_case_finds_the_file(void)
{
    must_read(MOVES("way(t)"), rows);
    TEST_ASSERT_EQUAL_INT(ERR_OK, scene_write(&scene, "tests/test_tables.cfg.tmp", &diag));
    const enum err e = scene_load_text(&again, NULL, "tests/test_tables.cfg.tmp", 0, NULL, &diag);
    remove("tests/test_tables.cfg.tmp");
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, e, diag.text);
    TEST_ASSERT_EQUAL_STRING("../test_tables.tmp", again.table[0].file);
    TEST_ASSERT_EQUAL_DOUBLE(motion_at(&scene, 0, 0.17).d[0], motion_at(&again, 0, 0.17).d[0]);
}

/* As a spreadsheet writes a file, with a byte-order mark, semicolons and CRLF. */
static void test_a_file_of_a_spreadsheet(void)
{
    must_read(MOVES("way(t)"), "\xEF\xBB\xBFt;d\r\n0.1;0.01\r\n0.2;0.04\r\n");
    expect(0.15, 0.015, 0.3, 0);
    scene_free(&scene);
    must_read(MOVES("way(t)"), "\xEF\xBB\xBF"
                               "0.1\t0.01\r\n0.2\t0.04\r\n");
    expect(0.15, 0.015, 0.3, 0);
}

/* Quotes as R and pandas write them; units in brackets; CR alone at the end of a line. */
static void test_names_of_columns_and_line_ends(void)
{
    static const char *const first[] = {"\"t\",\"v\"\n", "(s),(m)\n", "infiltration\n", "inf_1\n",
                                        "t,d\r"};
    for (size_t k = 0; k < COUNT_OF(first); k++) {
        char text[100];
        snprintf(text, sizeof text, "%s0.1,0.01%c0.2,0.04\n", first[k], k == 4 ? '\r' : '\n');
        must_read(MOVES("way(t)"), text);
        expect(0.15, 0.015, 0.3, 0);
        scene_free(&scene);
    }
}

static void refuses(const char *text, const char *numbers, const char *message)
{
    diag = (struct diag){0};
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_INPUT, read(text, numbers), message);
    TEST_ASSERT_EQUAL_STRING(message, diag.text);
}

/* One sentence each: what uses a bad table says nothing more. */
static void test_bad_tables_are_refused(void)
{
    static const struct {
        const char *rows, *why;
    } each[] = {
        {"0, 0\n", "test_tables.tmp: a table needs two rows or more; there is 1"},
        {"", "test_tables.tmp: a table needs two rows or more; there are 0"},
        {"0, 0\n0.2, 1\n0.1, 1\n",
         "test_tables.tmp:3: the first column must increase, but 0.1 follows 0.2"},
        {"0, 0\n0.2, 1, 2\n",
         "test_tables.tmp:2: more than 2 columns; argument, value (or `column = 3`) are expected"},
        {"0, 0\n0.2\n", "test_tables.tmp:2: 2 numbers are expected: argument, value (or `column = "
                        "3`); here `0.2`"},
        {"\"0\",\"0\"\n0.1, 1\n0.2, 2\n",
         "test_tables.tmp:1: 2 numbers are expected: argument, value (or `column = 3`); here "
         "`\"0\",\"0\"`"},
        {"inf, 0\n0.2, 1\n", "test_tables.tmp:1: 2 numbers are expected: argument, value (or "
                             "`column = 3`); here `inf, 0`"},
        {"0, 0\n0.2, nan\n", "test_tables.tmp:2: 2 numbers are expected: argument, value (or "
                             "`column = 3`); here `0.2, nan`"},
    };
    for (size_t k = 0; k < COUNT_OF(each); k++) {
        char message[400];
        snprintf(message, sizeof message, "t.cfg:12: [table way] file: %s", each[k].why);
        refuses(MOVES("way(t)"), each[k].rows, message);
    }
    refuses(MOVES("way(t)") "column = 4\n", "0, 1, 2\n1, 2, 3\n",
            "t.cfg:12: [table way] file: test_tables.tmp:1: 4 numbers are expected: argument, "
            "value in column 4; here `0, 1, 2`");
    static const char bytes[] = "0, 0\n0.1, 0\0, 5\n0.2, 2\n";
    FILE *const file = fopen("test_zero_byte.tmp", "wb");
    fwrite(bytes, 1, sizeof bytes - 1, file);
    fclose(file);
    refuses(CASE "[motion move]\n[table way]\nfile = test_zero_byte.tmp\n", "",
            "t.cfg:11: [table way] file: test_zero_byte.tmp:2: a byte of value 0; a table is plain "
            "text");
    remove("test_zero_byte.tmp");
    refuses(CASE "[motion move]\n[table way]\nfile = none.csv\n", "",
            "t.cfg:11: [table way] file: none.csv: cannot be read: No such file or directory");
}

static void test_bad_names_are_refused(void)
{
    refuses(CASE "[motion move]\n" FILE_OF("sin"), rows,
            "t.cfg:10: [table sin] has the name of a function; rename it");
    refuses(CASE "[motion move]\n" FILE_OF("2-d"), rows,
            "t.cfg:10: [table 2-d] is a function 2-d(...) of expressions, so its name must be "
            "letters, digits and _, a letter first");
    refuses(CASE "[motion move]\n[table way]\n", rows,
            "t.cfg:10: [table way] lacks `file`: file of rows with the argument, which increases, "
            "and the value");
    refuses(MOVES("wat(t)"), rows,
            "t.cfg:10: x = wat(t): unknown function `wat`; did you mean `way`?");
    refuses(MOVES("foobar(t)"), rows, "t.cfg:10: x = foobar(t): unknown function `foobar`");
    refuses(MOVES("way"), rows, "t.cfg:10: x = way: `way` is a [table]; write `way(t)`");
}

static void test_a_table_cannot_depend_on_a_table(void)
{
#define BY(column) \
    CASE "[motion move]\n[table way]\ncolumn = " column "\nfile = test_tables.tmp\n[constants]\n"
    refuses(BY("way(0)"), rows,
            "t.cfg:11: column = way(0): a value of a [table] cannot depend on the table `way`");
    refuses(BY("n") "n = way(0)\n", rows,
            "t.cfg:11: column = n: a value of a [table] cannot depend on the table `way`, needed "
            "for `n`");
    refuses(BY("n") "n = 2*h\nh = way(1)\n", rows,
            "t.cfg:11: column = n: a value of a [table] cannot depend on the table `way`, needed "
            "for `h`");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_linear_between_rows_and_constant_outside);
    RUN_TEST(test_the_argument_is_an_expression);
    RUN_TEST(test_kinks_have_the_slope_that_follows);
    RUN_TEST(test_a_cubic_is_smooth_and_does_not_overshoot);
    RUN_TEST(test_columns);
    RUN_TEST(test_the_effective_case_finds_the_file);
    RUN_TEST(test_a_file_of_a_spreadsheet);
    RUN_TEST(test_names_of_columns_and_line_ends);
    RUN_TEST(test_bad_tables_are_refused);
    RUN_TEST(test_bad_names_are_refused);
    RUN_TEST(test_a_table_cannot_depend_on_a_table);
    return UNITY_END();
}
