/* SPDX-License-Identifier: MIT
 * Settings of the command line that name what is not there, and numbers, units and sections that
 * only just are none: each is refused with what would be right. */
#include "geometry/scene_points.h"
#include "geometry/motion.h"
#include "unity.h"

#include <string.h>

#define TOP "dp = 10 mm\nend_time = 1 s\n"
#define SOLID \
    "[solid a]\nshape = box 0, 0, 50 mm, 100 mm\ndensity = 1000\nyoung = 1 MPa\npoisson = 0.3\n"
#define WATER "[fluid w]\nshape = box 0.2, 0, 0.3, 0.1\nsound_speed = 20\n"
#define PROBE "[probe M]\nbody = a\npoint = 50 mm, 50 mm\n"
#define LONG "a_key_that_is_longer_than_any_name_may_be_in_a_case_and_longer_and_longer_still"

#define FOUR(unit) "*1 " unit "^9*1 " unit "^9*1 " unit "^9*1 " unit "^9"
#define FACTORS(unit) FOUR(unit) FOUR(unit) FOUR(unit)

static struct scene scene;
static struct diag diag;

void setUp(void) { diag = (struct diag){.code = ERR_OK}; }
void tearDown(void) {}

static enum err load(const char *text, const char *set)
{
    setUp();
    return scene_load_text(&scene, text, "s.cfg", set != NULL, &set, &diag);
}

static const struct {
    const char *text, *set, *message;
} refused[] = {
    /* Names of sections and keys. */
    {TOP SOLID, "soild.young=1e6", "the case has no section `soild`"},
    {TOP SOLID, "zzzzzzzzzz.young=1e6", "the case has no section `zzzzzzzzzz`"},
    {TOP, "zzzzzzzzzz.young=1e6", "the case has no section `zzzzzzzzzz`"},
    {TOP SOLID, "solid.young=1e6", "there is no section `solid`; did you mean `a`?"},
    {TOP SOLID "[solid b]\nlike = a\nshape = box 0.2, 0, 0.3, 0.1\n", "solid.young=1e6",
     "there is no section `solid`; did you mean `a`?"},
    {TOP SOLID, "top.dp=1", "the case has no section `top`"},
    {TOP SOLID, "a.yuong=1e6", "did you mean `young`?"},
    {TOP SOLID, "a.zzzzzzzzzzz=1e6", "unknown key `zzzzzzzzzzz`"},
    {TOP SOLID, "zzzzzzzzzzz=1e6", "unknown key or constant `zzzzzzzzzzz`"},
    {TOP SOLID, "yield=1e6", "did you mean `title`?"},
    {TOP SOLID WATER, "artificial_viscosity=1", "write `a.artificial_viscosity`"},
    {TOP SOLID, ".young=1e6", "write key=value or section.key=value"},
    {TOP SOLID, LONG "=1", "write key=value or section.key=value"},
    {TOP SOLID, "young", "write key=value or section.key=value"},
    {TOP SOLID, "a.young=1\001", "control byte 1"},
    {TOP SOLID, "1a.young=1", "the case has no section `1a`"},
    {TOP "[constant]\nA = 1\n" SOLID, NULL, "did you mean `constants`?"},
    {TOP "[zzzzzzzzzz]\nA = 1\n" SOLID, NULL, "[zzzzzzzzzz]; --keys lists them"},
    /* Numbers and units. */
    {TOP SOLID, "dp=1.2.3 mm", "`1.2.3` is not a number"},
    {TOP SOLID, "dp=. mm", "`.` is not a number"},
    {TOP SOLID, "dp=0,005", "a decimal number is written with a point: 0.005"},
    {TOP SOLID, "dp=1 mm^10", "must be a number from -9 to 9"},
    {TOP SOLID, "dp=1 mm^", "must be a number from -9 to 9"},
    {TOP SOLID, "dp=1 mm^1.2.3", "must be a number from -9 to 9"},
    {TOP SOLID, "a.young=1 m^9" FACTORS("m"), "the unit of the result has a power above 99"},
    {TOP SOLID, "a.young=1 kg^9" FACTORS("kg"), "the unit of the result has a power above 99"},
    {TOP SOLID, "a.young=1 s^9" FACTORS("s"), "the unit of the result has a power above 99"},
    {TOP SOLID, "a.young=sin(1 m)", "sin of a length (m)"},
    {TOP SOLID, "a.young=1 zzzz", "`zzzz` after 1 is not a unit"},
    /* Values that do not fit together. */
    {TOP WATER "[motion m]\nstop = -1\n[wall b]\nshape = box 0, -30 mm, 0.4, 0\nmotion = m\n", NULL,
     "must come before stop = -1 s"},
    {TOP SOLID
     "[load l]\nbody = a\nshape = box 0, 0, 10 mm, 10 mm\nforce = 1, 0\ntraction = 1, 0\n",
     NULL, "and has both"},
    {TOP SOLID "[load l]\nbody = a\nshape = box 0, 0, 10 mm, 10 mm\n", NULL, "and has neither"},
    {TOP SOLID, "gravity=0, -1 m/s^2*0.1/(t/s - 0.5)",
     "..., -1 m/s^2*0.1/(t/s - 0.5): component 2 is not finite at t = 0.5 s"},
    {TOP SOLID, "gravity=-1 m/s^2*0.1/(t/s - 0.5), 0",
     "0.1/(t/s - 0.5), ...: component 1 is not finite at t = 0.5 s"},
    {TOP SOLID PROBE "[reference r]\nprobe = Mx\nformula = 1\n", NULL,
     "no probe has such a column"},
    {TOP SOLID "clamp = box 0, 0, 50 mm, 10 mm\nclamp_motion = m\n[motion m]\nx = t\n"
               "start = -1\n[relax]\n",
     NULL, "with [relax] no motion may begin before"},
    {TOP SOLID, "numerics.solid_h_over_dp=0.5", "solid_h_over_dp = 0.5 is too small"},
};

static void test_each_is_refused(void)
{
    for (size_t k = 0; k < COUNT_OF(refused); k++) {
        const char *const what = refused[k].set ? refused[k].set : refused[k].text;
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_INPUT, load(refused[k].text, refused[k].set), what);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, refused[k].message), diag.text);
    }
}

/* What is right beside what is refused above. */
static void test_valid_sets_are_taken(void)
{
    static const char *const sets[] = {"dp =\t10 mm", "dp=+10 mm", "dp=--10 mm", " dp = 1 %*1 m",
                                       "solid a.young=1 MPa"};
    for (size_t k = 0; k < COUNT_OF(sets); k++) {
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, load(TOP SOLID, sets[k]), diag.text);
        TEST_ASSERT_TRUE(scene.top.dp == 0.01 && scene.solid[0].young == 1e6);
        scene_free(&scene);
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, load(TOP SOLID, "gravity=-1, 0"), diag.text);
    TEST_ASSERT_TRUE(scene.top.gravity[0] == -1 && scene.top.gravity[1] == 0);
    scene_free(&scene);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, load(TOP SOLID, "gravity=-1 m/s^2*(1 + t/s), 0"),
                                  diag.text);
    double g[2];
    scene_gravity_at(&scene, 1, g);
    TEST_ASSERT_TRUE(scene_gravity_varies(&scene) && g[0] == -2 && g[1] == 0);
    scene_free(&scene);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_is_refused);
    RUN_TEST(test_valid_sets_are_taken);
    return UNITY_END();
}
