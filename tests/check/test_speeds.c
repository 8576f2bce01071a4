/* SPDX-License-Identifier: MIT
 * Speeds that the materials cannot follow are warned of before a run, and known to it; bodies that
 * are joined but apart are refused where a case is drawn. */
#include "warned.h"

void setUp(void) { warnings[0] = '\0'; }

void tearDown(void) { scene_free(&scene); }

/* A warning that has these words, or none at all. */
static void warns(const char *text, const char *words)
{
    read_as("fast.cfg", text);
    if (!words) {
        TEST_ASSERT_EQUAL_STRING("", warnings);
        return;
    }
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, words), warnings);
}

#define HEAD "dp = 10 mm\nend_time = 1 s\n"
#define BASIN                                                                             \
    HEAD "[fluid water]\nshape = box 0, 0, 0.2, 0.1\nsound_speed = 10\nvelocity = 1, 0\n" \
         "[wall tank]\nshape = polyline thickness -40 mm: 0, 0.2; 0, 0; 0.2, 0\n"         \
         "[wall paddle]\nshape = box 0.2, 0, 0.24, 0.2\nmotion = m\n[motion m]\n"
#define BALL \
    HEAD "[solid ball]\nshape = box 0, 0, 0.1, 0.1\ndensity = 1000\nyoung = 1e6\npoisson = 0.3\n"

static void test_walls(void)
{
    warns(BASIN "x = 0.4*sin(10*t)\n",
          "fast.cfg:12: [motion m] moves [wall paddle] at up to 4 m/s, above 0.3 of");
    TEST_ASSERT_EQUAL_DOUBLE(4, scene.given_speed);
    warns(BASIN "y = 2.9*t\n", NULL);
    warns(BASIN "x = 1e-7*sin(1e6*t)\n",
          "fast.cfg:12: [motion m] changes its velocity of 0.1 m/s within 1e-06 s, but a time");
    warns(BASIN "x = 0.01*(1 - cos(20*t))\n", NULL);
}

static void test_fluid_at_the_start(void)
{
    static const char water[] = HEAD "[fluid w]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 10\n";
    char text[300];
    snprintf(text, sizeof text, "%svelocity = 30*y, 2\n", water);
    warns(text, "fast.cfg:6: [fluid w] begins with up to 3.48");
    snprintf(text, sizeof text, "%svelocity = 10*y, 2\n", water);
    warns(text, NULL);
}

static void test_bodies_at_the_start(void)
{
    warns(BALL "velocity = 32, 0\n", "fast.cfg:8: [solid ball] begins with up to 32 m/s, faster "
                                     "than waves in it, sqrt(young/density) = 31.6 m/s");
    warns(BALL "velocity = 31, 0\n", NULL);
}

/* Said with what else is wrong, and without a simulation. */
static void test_joined_bodies_that_are_apart(void)
{
    struct diag diag = {.warn = note};
    static const char apart[] =
        BALL "[solid two]\nlike = ball\nshape = box 0.2, 0, 0.3, 0.1\njoined = ball\n"
             "[solid three]\nlike = ball\nshape = box 0.1, 0, 0.15, 0.1\njoined = ball\n";
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, scene_load_text(&scene, apart, "fast.cfg", 0, NULL, &diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(diag.text, "fast.cfg:11: [solid two] is joined to [solid ball], but lies more than"),
        diag.text);
    TEST_ASSERT_NULL_MESSAGE(strstr(diag.more, "three"), diag.more);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_walls);
    RUN_TEST(test_fluid_at_the_start);
    RUN_TEST(test_bodies_at_the_start);
    RUN_TEST(test_joined_bodies_that_are_apart);
    return UNITY_END();
}
