/* SPDX-License-Identifier: MIT
 * Words that a shell reads back as they were. */
#include "app/shell.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

static char out[QUOTED_BYTES];

void setUp(void) { memset(out, 'x', sizeof out); }
void tearDown(void) {}

static void test_plain_words_stay(void)
{
    shell_quote(out, "runs/gate-2,dp=0.5");
    TEST_ASSERT_EQUAL_STRING("runs/gate-2,dp=0.5", out);
}

static void test_others_are_quoted(void)
{
    static const char *const pairs[][2] = {{"", "''"},
                                           {"a b", "'a b'"},
                                           {"my run's", "'my run'\\''s'"},
                                           {"$HOME", "'$HOME'"}};
    for (size_t k = 0; k < sizeof pairs / sizeof pairs[0]; k++) {
        setUp();
        shell_quote(out, pairs[k][0]);
        TEST_ASSERT_EQUAL_STRING(pairs[k][1], out);
    }
}

/* What a shell makes of it. */
static void test_a_shell_reads_them_back(void)
{
    static const char text[] = "it's 100 % of `x` & \"y\"\\; * ?";
    char command[QUOTED_BYTES + 16], back[200] = "";
    shell_quote(out, text);
    snprintf(command, sizeof command, "printf %%s %s", out);
    FILE *const pipe = popen(command, "r");
    TEST_ASSERT_NOT_NULL(pipe);
    back[fread(back, 1, sizeof back - 1, pipe)] = '\0';
    pclose(pipe);
    TEST_ASSERT_EQUAL_STRING(text, back);
}

static void test_a_long_word_is_cut_within_its_quotes(void)
{
    static char text[2 * QUOTED_BYTES];
    memset(text, '\'', sizeof text - 1);
    shell_quote(out, text);
    const size_t n = strlen(out);
    TEST_ASSERT_TRUE(n < sizeof out && out[0] == '\'' && out[n - 1] == '\'');
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_plain_words_stay);
    RUN_TEST(test_others_are_quoted);
    RUN_TEST(test_a_shell_reads_them_back);
    RUN_TEST(test_a_long_word_is_cut_within_its_quotes);
    return UNITY_END();
}
