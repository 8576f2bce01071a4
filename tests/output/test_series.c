/* SPDX-License-Identifier: MIT
 * CSV series: numbers that lose nothing, rows that a restart keeps or drops. */
#include "output/rows.h"
#include "base/csv.h"
#include "tiny.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static struct diag diag;

void setUp(void) { diag = (struct diag){.code = ERR_OK}; }

void tearDown(void) {}

static void numbers_read_back_exactly(void)
{
    static const double values[] = {0, 0.1, 1.0 / 3, 6.62607015e-34, -1e300, 5e-324, 123456789.123};
    for (size_t k = 0; k < COUNT_OF(values); k++) {
        char text[NUMBER_TEXT];
        const int length = number_text(text, values[k]);
        TEST_ASSERT_EQUAL_INT((int)strlen(text), length);
        TEST_ASSERT_TRUE(strtod(text, NULL) == values[k]);
    }
    char text[NUMBER_TEXT];
    number_text(text, 0.1);
    TEST_ASSERT_EQUAL_STRING("0.1", text);
}

static void content_is(const char *name, const char *expected)
{
    char *bytes;
    size_t size;
    TEST_ASSERT_EQUAL_INT(ERR_OK, file_read(tiny_path(name), &bytes, &size, &diag));
    TEST_ASSERT_EQUAL_STRING(expected, bytes);
    free(bytes);
}

static void write_rows(const char *name, int n)
{
    struct series s;
    TEST_ASSERT_EQUAL_INT(ERR_OK, series_create(&s, tiny_folder(), name, "time_s,a", &diag));
    for (int k = 0; k < n; k++)
        TEST_ASSERT_EQUAL_INT(ERR_OK, series_row(&s, (double[]){k, 10 * k}, &diag));
    series_close(&s);
}

static void rows_are_written(void)
{
    write_rows("rows.csv", 3);
    content_is("rows.csv", "time_s,a\n0,0\n1,10\n2,20\n");
}

static void restart_drops_later_and_torn_rows(void)
{
    struct series s;
    double first[2], last;
    write_rows("cut.csv", 4);
    FILE *file = fopen(tiny_path("cut.csv"), "a");
    fputs("4,4", file);
    fclose(file);
    TEST_ASSERT_EQUAL_INT(ERR_OK, series_resume(&s, tiny_folder(), "cut.csv", "time_s,a", 2, first,
                                                &last, &diag));
    TEST_ASSERT_TRUE(first[0] == 0 && first[1] == 0 && last == 2);
    TEST_ASSERT_EQUAL_INT(ERR_OK, series_row(&s, (double[]){3, 31}, &diag));
    series_close(&s);
    content_is("cut.csv", "time_s,a\n0,0\n1,10\n2,20\n3,31\n");
}

static void a_torn_last_row_is_dropped_even_if_its_time_fits(void)
{
    struct series s;
    double last;
    write_rows("torn.csv", 1);
    FILE *file = fopen(tiny_path("torn.csv"), "a");
    fputs("1,1", file);
    fclose(file);
    TEST_ASSERT_EQUAL_INT(ERR_OK, series_resume(&s, tiny_folder(), "torn.csv", "time_s,a", 9, NULL,
                                                &last, &diag));
    series_close(&s);
    TEST_ASSERT_TRUE(last == 0);
    content_is("torn.csv", "time_s,a\n0,0\n");
}

static void other_columns_are_refused(void)
{
    struct series s;
    double last;
    write_rows("columns.csv", 1);
    TEST_ASSERT_EQUAL_INT(ERR_IO, series_resume(&s, tiny_folder(), "columns.csv", "time_s,b", 9,
                                                NULL, &last, &diag));
    TEST_ASSERT_NOT_NULL(strstr(diag.text, "time_s,a"));
    TEST_ASSERT_NOT_NULL(strstr(diag.text, "time_s,b"));
    content_is("columns.csv", "time_s,a\n0,0\n");
}

static void a_full_disk_is_reported(void)
{
    struct series s = {.columns = 2, .fd = -1};
    if (access("/dev/full", W_OK) != 0) TEST_IGNORE_MESSAGE("there is no /dev/full");
    TEST_ASSERT_EQUAL_INT(ERR_IO, series_create(&s, "/dev", "full", "time_s,a", &diag));
    TEST_ASSERT_NOT_NULL(strstr(diag.text, "/dev/full"));
    TEST_ASSERT_NOT_NULL(strstr(diag.text, "space"));
    series_close(&s);
}

static void a_link_is_not_written_through(void)
{
    struct series s;
    TEST_ASSERT_EQUAL_INT(0, symlink("/nowhere", tiny_path("link.csv")));
    TEST_ASSERT_EQUAL_INT(ERR_IO, series_create(&s, tiny_folder(), "link.csv", "a,b", &diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, "it is a symbolic link"), diag.text);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_link_is_not_written_through);
    RUN_TEST(numbers_read_back_exactly);
    RUN_TEST(rows_are_written);
    RUN_TEST(restart_drops_later_and_torn_rows);
    RUN_TEST(a_torn_last_row_is_dropped_even_if_its_time_fits);
    RUN_TEST(other_columns_are_refused);
    RUN_TEST(a_full_disk_is_reported);
    return UNITY_END();
}
