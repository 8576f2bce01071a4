/* SPDX-License-Identifier: MIT
 * Scenes that can be read, but not be sampled or divided into cells: too wide, too narrow, or with
 * an opening in a body. The message says what would be right. */
#include "geometry/scene_points.h"
#include "time/simulation.h"
#include "unity.h"

#include <string.h>

#define SOLID "density = 1000\nyoung = 1e6\npoisson = 0.3\n"
#define CHANNEL                                                                 \
    "dp = 1 cm\nend_time = 1\n[domain]\nlower = -0.3, -0.1\nupper = 0.4, 0.2\n" \
    "[fluid w]\nshape = box 0, 0, 0.2, 0.1\nsound_speed = 20\n[wall b]\n"       \
    "shape = box -0.2, -0.04, 0.4, 0\nshape = box -0.2, 0.1, 0.4, 0.14\n"       \
    "[inflow i]\nfrom = 0, 0.1\nto = 0, 0\nvelocity = 0.1, 0\n"                 \
    "[outflow o]\nfrom = 0.2, 0\nto = 0.2, 0.1\npressure = 0\n"

static struct scene scene;
static struct simulation simulation;
static struct diag diag;

void setUp(void) { diag = (struct diag){.code = ERR_OK}; }
void tearDown(void) {}

/* Reads, samples and builds. */
static enum err build(const char *text)
{
    setUp();
    enum err e = scene_load_text(&scene, text, "g.cfg", 0, NULL, &diag);
    if (e) return e;
    e = simulation_create(&simulation, &scene, &diag);
    if (!e) simulation_free(&simulation);
    scene_free(&scene);
    return e;
}

static const struct {
    const char *text, *message;
} refused[] = {
    {"dp = 1 cm\nend_time = 1\n[domain]\nlower = 0, -0.1\nupper = 0.06, 0.3\nperiodic = x\n"
     "[fluid w]\nshape = box 0, 0, 0.06, 0.1\nsound_speed = 20\n",
     "periodic in x and only 0.06 m wide there; at least 0.126 m is needed"},
    {"dp = 1 cm\nend_time = 1\n[domain]\nlower = -0.1, 0\nupper = 0.3, 0.06\nperiodic = y\n"
     "[fluid w]\nshape = box 0, 0, 0.1, 0.06\nsound_speed = 20\n",
     "periodic in y and only 0.06 m wide there"},
    {CHANNEL "[solid s]\nshape = box -0.06, 0.03, -0.02, 0.07\n" SOLID,
     "[inflow i] lies in [solid s] at (-0.025, 0.065) m: move the line"},
    {"dp = 1 mm\nend_time = 1\n[domain]\nlower = -1, -1\nupper = 1, 1\n"
     "[fluid w]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\n"
     "[inflow i]\nfrom = 2e7, 0\nto = 0, 0\nspeed = 0.1\n",
     "buffer for more than 1e8 particles"},
    {"dp = 1 mm\nend_time = 1\n[solid w]\nshape = box 0, 0, 0.1, 0.1\n"
     "shape = box 5000000, 0, 5000000.1, 0.1\n" SOLID,
     "in shapes that span 5.15e+11 cells"},
};

static void test_each_is_refused(void)
{
    for (size_t k = 0; k < COUNT_OF(refused); k++) {
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_INPUT, build(refused[k].text), refused[k].message);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, refused[k].message), diag.text);
    }
}

static void test_the_channel_itself_is_not(void)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, build(CHANNEL), diag.text);
}

/* The sentences of one scene, in one run. */
static void must_tell(const char *text, int n, const char *const *message)
{
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, build(text));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, message[0]), diag.text);
    int lines = 1;
    for (const char *c = diag.more; *c; c++) lines += *c == '\n';
    TEST_ASSERT_EQUAL_INT_MESSAGE(n, lines, diag.more);
    for (int k = 1; k < n; k++)
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.more, message[k]), diag.more);
}

static void test_all_problems_are_told_at_once(void)
{
    must_tell("dp = 1 cm\nend_time = 1\n"
              "[fluid w]\nshape = box 0, 0, 0.1, 0.1\nshape = box 0.2, 0, 0.202, 0.1\n"
              "sound_speed = 20\n"
              "[wall b]\nshape = box 0.3, 0, 0.302, 0.1\nshape = box 0, -0.04, 0.3, 0\n",
              2,
              (const char *const[]){"g.cfg:8: shape 1 of [wall b] contains no particle",
                                    "g.cfg:5: shape 2 of [fluid w] contains no particle"});
    must_tell("dp = 1 cm\nend_time = 1\n"
              "[solid a]\nshape = box 0, 0, 0.01, 0.1\n" SOLID "clamp = box 1, 1, 2, 2\n"
              "clamp = box 3, 3, 4, 4\n[solid c]\nshape = box 1, 0, 1.01, 0.1\n" SOLID,
              4,
              (const char *const[]){"g.cfg:8: clamp 1 of [solid a]",
                                    "g.cfg:9: clamp 2 of [solid a]",
                                    "[solid a] is 1 particle thick",
                                    "[solid c] is 1 particle thick"});
    must_tell("dp = 1 cm\nend_time = 1\n[domain]\nlower = -1, -1\nupper = 1, 1\n"
              "[fluid w]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\nvelocity = 1/(x - x), 0\n"
              "[solid a]\nshape = box 0.2, 0, 0.3, 0.1\n" SOLID
              "[probe p]\nquantity = displacement\nbody = a\npoint = 0.5, 0.5\n"
              "[probe q]\nquantity = pressure\npoint = 50, 50\n",
              3,
              (const char *const[]){"[probe p] point (0.5, 0.5) lies about",
                                    "[probe q] point (50, 50) lies outside of the domain",
                                    "[fluid w] velocity is not finite"});
}

#define TOP "dp = 1 cm\nend_time = 1\n"
#define THIN "[solid t]\nshape = box 1, 0, 1.01, 0.1\n" SOLID

/* The geometry of a case is checked once its values are right. */
static void test_wrong_values_are_told_alone(void)
{
    static const struct {
        const char *text, *message;
    } wrong[] = {
        {"dp = -1 cm\nend_time = 1\n" THIN, "dp = -1 cm"},
        {TOP "[solid a]\nshape = box 0, 0\n" SOLID THIN, "shape = box 0, 0"},
        {TOP "[solid a]\nshap = box 0, 0, 0.1, 0.1\n" SOLID THIN, "did you mean `shape`"},
        {TOP "[solid a]\nlike = nobody\nshape = box 0, 0, 0.1, 0.1\n" THIN, "like = nobody"},
        {TOP "[numerics]\nh_over_dp = 9\n" THIN, "h_over_dp = 9"},
        {TOP "[solid a]\nshape = box 0, 0, 0.1, 0.1\nqqqqqqqqqq = 1\n" SOLID THIN, "unknown key"},
        {TOP
         "[solid a]\nshape = box 0, 0, 0.1, 0.1\ndensity = -1\nyoung = 1e6\npoisson = 0.3\n" THIN,
         "density = -1"},
        {TOP "what is this?\n" THIN, "neither `key = value`"},
        /* Probes lie in a domain that is not known. */
        {TOP "[domain]\nlower = 0\n[fluid w]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\n"
             "[probe q]\nquantity = pressure\npoint = 50, 50\n",
         "lower = 0"},
    };
    for (size_t k = 0; k < COUNT_OF(wrong); k++)
        must_tell(wrong[k].text, 1, (const char *const[]){wrong[k].message});
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_is_refused);
    RUN_TEST(test_the_channel_itself_is_not);
    RUN_TEST(test_all_problems_are_told_at_once);
    RUN_TEST(test_wrong_values_are_told_alone);
    return UNITY_END();
}
