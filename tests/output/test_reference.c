/* SPDX-License-Identifier: MIT
 * Comparison of probes with the references that a case names: by hand-made rows. */
#include "output/report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tiny.h"
#include "unity.h"
#include "geometry/scene_points.h"

static struct scene scene;
static struct arena arena;
static struct references references;
static struct diag diag;

static const char head[] =
    "dp = 0.1\nend_time = 1\n[constants]\nw = 2\n[solid s]\nshape = box 0, 0, 1, 1\n"
    "density = 1\nyoung = 1\npoisson = 0\n[probe P]\nbody = s\npoint = 0.5, 0.5\n"
    "[reference r]\nprobe = P_dx_m\n";

void setUp(void)
{
    memset(&arena, 0, sizeof arena);
    diag = (struct diag){.code = ERR_OK};
}

void tearDown(void)
{
    remove(tiny_path("r.csv"));
    arena_free(&arena);
    scene_free(&scene);
}

static void put(const char *name, const char *text)
{
    FILE *file = fopen(tiny_path(name), "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs(text, file);
    fclose(file);
}

static enum err open_with(const char *lines, const char *header)
{
    char text[1000];
    snprintf(text, sizeof text, "%s%s", head, lines);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK,
                              scene_load_text(&scene, text, tiny_path("a.cfg"), 0, NULL, &diag),
                              diag.text);
    const struct probe_file file = {.header = header};
    return references_open(&references, &scene, 1, &file, &arena, &diag);
}

static struct score score_of(const char *lines, const char *rows)
{
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, open_with(lines, "time_s,P_dx_m,P_dy_m"), diag.text);
    put("probes.csv", rows);
    TEST_ASSERT_EQUAL(ERR_OK, reference_score(references.item, tiny_path("probes.csv"), &diag));
    return references.item->score;
}

static void test_file_is_compared_at_its_rows(void)
{
    /* The rows stand backwards and with a comment; the probe is interpolated to 1, 2, 2. */
    put("r.csv", "# by hand\ntime_s,value\n0.5,5\n0.25,3\n0,1\n9,99\n");
    const struct score c =
        score_of("file = r.csv\n", "time_s,P_dx_m,P_dy_m\n0,1,7\n0.5,3,7\n1,2,7\n");
    TEST_ASSERT_EQUAL(3, c.points);
    TEST_ASSERT_EQUAL_DOUBLE(sqrt((0 + 1 + 4) / 3.0), c.rms);
    TEST_ASSERT_EQUAL_DOUBLE(2, c.largest);
    TEST_ASSERT_EQUAL_DOUBLE(-1, c.mean);
    TEST_ASSERT_EQUAL_DOUBLE(3, c.peak);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, c.peak_time);
    TEST_ASSERT_EQUAL_DOUBLE(5, c.peak_reference);
}

static void test_formula_and_window(void)
{
    const struct score c = score_of("formula = w*t\nfrom = 0.5\n",
                                    "time_s,P_dx_m,P_dy_m\n0,9,0\n0.5,1,0\n1,1,0\n2,4,0\n3,0");
    TEST_ASSERT_EQUAL(3, c.points); /* the torn last row is none */
    TEST_ASSERT_EQUAL_DOUBLE(sqrt(1 / 3.0), c.rms);
    TEST_ASSERT_EQUAL_DOUBLE(4, c.peak);
    TEST_ASSERT_EQUAL_DOUBLE(4, c.scale);
}

static void test_one_row_is_constant_and_the_first_of_equal_peaks_counts(void)
{
    put("r.csv", "0 2\n");
    const struct score c =
        score_of("file = r.csv\n", "time_s,P_dx_m,P_dy_m\n0,0,0\n0.4,1.98,0\n0.6,0,0\n1,-1.992,0\n"
                                   "2,0,0\n3,2,0\n4,0,0\n");
    TEST_ASSERT_EQUAL(7, c.points);
    TEST_ASSERT_EQUAL_DOUBLE(-1.992, c.peak); /* 1.98 is 1 % below the largest */
    TEST_ASSERT_EQUAL_DOUBLE(1, c.peak_time);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, (1.98 - 1.992 + 2) / 7 - 2, c.mean);
}

static void test_nothing_in_common(void)
{
    const struct score c = score_of("formula = t\nfrom = 5\n", "time_s,P_dx_m,P_dy_m\n0,0,0\n");
    TEST_ASSERT_EQUAL(0, c.points);
    char text[300];
    reference_line(&references.item[0], text, sizeof text);
    TEST_ASSERT_EQUAL_STRING("P_dx_m: its times do not overlap with those of r", text);
}

/* One row of the probe, and two at the same time, of which the first is met first; rows that lack
 * the column are passed over, and a point ends at a comment or at the end of the file. */
static void test_few_and_odd_rows(void)
{
    put("r.csv", " \t# nothing\n\r\n0 2\t\n1, 4");
    const struct score one = score_of("file = r.csv\n", "time_s,P_dx_m,P_dy_m\n1,3,0\n");
    TEST_ASSERT_EQUAL(1, one.points);
    TEST_ASSERT_EQUAL_DOUBLE(-1, one.mean);
    scene_free(&scene);
    const struct score two =
        score_of("file = r.csv\n", "time_s,P_dx_m,P_dy_m\n0,1,0\n0.5\n1,3,0\n1,5,0\n");
    TEST_ASSERT_EQUAL(2, two.points);
    TEST_ASSERT_EQUAL_DOUBLE(-1, two.mean);
    scene_free(&scene);
    const struct score late =
        score_of("file = r.csv\nuntil = 0.5\n", "time_s,P_dx_m,P_dy_m\n0,1,0\n0.4,2,0\n1,9,0\n");
    TEST_ASSERT_EQUAL(1, late.points);
    TEST_ASSERT_EQUAL_DOUBLE(2, late.peak);
}

/* More lines than are read. */
static void test_a_file_of_too_many_lines(void)
{
    FILE *file = fopen(tiny_path("r.csv"), "w");
    for (int k = 0; k <= 1000000; k++) fputs("\n", file);
    fclose(file);
    TEST_ASSERT_EQUAL(ERR_INPUT, open_with("file = r.csv\n", "time_s,P_dx_m"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, "r.csv: more than 1000000 lines"), diag.text);
}

/* Zero everywhere: an error has no per cent. */
static void test_a_reference_of_zero(void)
{
    const struct score c = score_of("formula = 0*t\n", "time_s,P_dx_m,P_dy_m\n0,0,0\n1,1,0\n");
    TEST_ASSERT_EQUAL_DOUBLE(0, c.scale);
    char text[300];
    reference_line(&references.item[0], text, sizeof text);
    TEST_ASSERT_EQUAL_STRING("P_dx_m: RMS 0.707 from r; peak 1 at 1 s instead of 0 at 0 s", text);
}

/* Each reference of a file begins with no points. */
static void test_two_references_of_a_probe(void)
{
    TEST_ASSERT_EQUAL(ERR_OK,
                      open_with("formula = w*t\n[reference q]\nprobe = P_dy_m\nformula = 0\n",
                                "time_s,P_dx_m,P_dy_m"));
    put("probes.csv", "time_s,P_dx_m,P_dy_m\n0,0,3\n1,3,3\n2,4,3\n");
    for (int k = 0; k < 2; k++)
        TEST_ASSERT_EQUAL(ERR_OK,
                          reference_score(&references.item[k], tiny_path("probes.csv"), &diag));
    TEST_ASSERT_EQUAL(3, references.item[0].score.points);
    TEST_ASSERT_EQUAL(3, references.item[1].score.points);
    TEST_ASSERT_EQUAL_DOUBLE(sqrt(1 / 3.0), references.item[0].score.rms);
    TEST_ASSERT_EQUAL_DOUBLE(3, references.item[1].score.rms);
}

static void refuses(const char *lines, const char *header, const char *words)
{
    TEST_ASSERT_EQUAL(ERR_INPUT, open_with(lines, header));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, words), diag.text);
}

static void test_missing_file(void)
{
    refuses("file = none.csv\n", "time_s,P_dx_m", "a.cfg:13: [reference r] file: ");
}

static void test_malformed_row(void)
{
    put("r.csv", "time_s,value\n0,1\n0.1,two\n");
    refuses("file = r.csv\n", "time_s,P_dx_m",
            "r.csv:3: 2 numbers are expected: time (s), value (SI); here `0.1,two`");
}

static void test_third_column(void)
{
    put("r.csv", "0,1,2\n");
    refuses("file = r.csv\n", "time_s,P_dx_m", "r.csv:1: more than 2 columns");
}

static void test_empty_file(void)
{
    put("r.csv", "# nothing\ntime_s,value\n");
    refuses("file = r.csv\n", "time_s,P_dx_m", "contains no row of time and value");
}

static void test_unknown_column(void)
{
    refuses("formula = 0\n", "time_s,P_dy_m,Q_p_Pa",
            "[reference r] probe = P_dx_m: no such column; there are P_dy_m,Q_p_Pa");
}

static void said(const char *lines, const char *rows, const char *want)
{
    char text[300];
    score_of(lines, rows);
    reference_line(&references.item[0], text, sizeof text);
    TEST_ASSERT_EQUAL_STRING(want, text);
    tearDown();
    setUp();
}

/* A constant has a mean to be off, a curve a peak. Comments, blanks and line ends of any kind. */
static void test_what_is_said(void)
{
    static const char rows[] = "time_s,P_dx_m,P_dy_m\n0,1,0\n0.5,3,0\n1,2,0\n";
    put("r.csv", "# one row\r\n  \t\r\nt, value\r\n0.5 ,\t2\r\n");
    said("file = r.csv\nlabel = others\n", rows,
         "P_dx_m: mean 2, +0 (+0 %) off others; RMS 0.82 (41 %)");
    put("r.csv", "0 1\n0.5 2\n 1 1");
    said("file = r.csv\n", rows,
         "P_dx_m: RMS 0.816 (41 % of the peak) from r; peak 3 at 0.5 s instead of 2 at 0.5 s");
    put("r.csv", "5 1\n6 2\n");
    said("file = r.csv\n", rows, "P_dx_m: its times do not overlap with those of r");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_file_is_compared_at_its_rows);
    RUN_TEST(test_formula_and_window);
    RUN_TEST(test_one_row_is_constant_and_the_first_of_equal_peaks_counts);
    RUN_TEST(test_nothing_in_common);
    RUN_TEST(test_few_and_odd_rows);
    RUN_TEST(test_a_file_of_too_many_lines);
    RUN_TEST(test_a_reference_of_zero);
    RUN_TEST(test_two_references_of_a_probe);
    RUN_TEST(test_missing_file);
    RUN_TEST(test_malformed_row);
    RUN_TEST(test_third_column);
    RUN_TEST(test_empty_file);
    RUN_TEST(test_unknown_column);
    RUN_TEST(test_what_is_said);
    return UNITY_END();
}
