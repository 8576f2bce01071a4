/* SPDX-License-Identifier: MIT
 * JSON as it is written, against a text made by hand. */
#include "output/json.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>

static char *text;
static size_t size;
static struct json j;

void setUp(void) { j = (struct json){.file = open_memstream(&text, &size)}; }
void tearDown(void) { free(text); }

static void written(const char *want)
{
    fclose(j.file);
    TEST_ASSERT_EQUAL_STRING(want, text);
}

static void test_commas_indents_and_the_last_newline(void)
{
    json_open(&j, NULL, '{');
    json_number(&j, "a", 0.5);
    json_open(&j, "b", '[');
    json_integer(&j, NULL, -3);
    json_open(&j, NULL, '{');
    json_close(&j, '}');
    json_close(&j, ']');
    json_numbers(&j, "c", (const double[]){1, 2.25, -3e20}, 3);
    json_open(&j, "d", '{');
    json_text(&j, "e", "f");
    json_close(&j, '}');
    json_close(&j, '}');
    written("{\n"
            "  \"a\": 0.5,\n"
            "  \"b\": [\n"
            "    -3,\n"
            "    {}\n"
            "  ],\n"
            "  \"c\": [1, 2.25, -3e+20],\n"
            "  \"d\": {\n"
            "    \"e\": \"f\"\n"
            "  }\n"
            "}\n");
}

static void test_what_json_does_not_know(void)
{
    json_numbers(&j, NULL, (const double[]){(double)NAN, (double)INFINITY, 0}, 3);
    written("[null, null, 0]");
}

static void test_characters_that_are_escaped(void)
{
    json_text(&j, "a\"b", "c \\d\n\x01\x7f\xc3\xa9");
    written("\"a\\\"b\": \"c \\\\d\\u000a\\u0001\\u007f\xc3\xa9\"");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_commas_indents_and_the_last_newline);
    RUN_TEST(test_what_json_does_not_know);
    RUN_TEST(test_characters_that_are_escaped);
    return UNITY_END();
}
