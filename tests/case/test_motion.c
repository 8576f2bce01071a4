/* SPDX-License-Identifier: MIT
 * Prescribed motion: at rest before and after, velocity and acceleration the derivatives of the
 * displacement in between. */
#include "case/scene.h"
#include "check/check.h"
#include "geometry/scene_points.h"
#include "geometry/motion.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define HEAD                                                                                   \
    "dp = 1 mm\nend_time = 1 s\n[fluid w]\nshape = box 0, 0, 20 mm, 20 mm\nsound_speed = 20\n" \
    "[wall bed]\nshape = box 0, -5 mm, 20 mm, 0\nmotion = move\n[motion move]\n"

static struct scene scene;
static struct diag diag;

static enum err read(const char *motion)
{
    char text[2048];
    snprintf(text, sizeof text, "%s%s", HEAD, motion);
    diag = (struct diag){0};
    return scene_load_text(&scene, text, "motion.cfg", 0, NULL, &diag);
}

static void must_read(const char *motion)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, read(motion), diag.text);
}

static void must_read_expression(const char *x)
{
    char text[128];
    snprintf(text, sizeof text, "x = %s\n", x);
    must_read(text);
}

static void expect(double time, double dx, double vx, double ax)
{
    const struct motion_state m = motion_at(&scene, 0, time);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, dx, m.d[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, vx, m.v[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, ax, m.a[0]);
}

void setUp(void) {}

void tearDown(void)
{
    scene_free(&scene);
    remove("test_motion.tmp");
}

static void test_between_start_and_stop(void)
{
    must_read("x = 2 m/s*t\nstart = 0.25\nstop = 0.75\n");
    expect(0, 0, 0, 0);
    expect(0.25, 0, 2, 0);
    expect(0.5, 0.5, 2, 0);
    expect(0.75, 1, 0, 0);
    expect(9, 1, 0, 0);
}

static void test_nothing_given_is_rest(void)
{
    must_read("");
    expect(0.5, 0, 0, 0);
}

static void test_polynomial(void)
{
    must_read("x = t + 2*t^2 + 3*t^3\ny = t^2\nstart = 1\nstop = 3\n");
    expect(0.5, 0, 0, 0);
    expect(2, 1 + 2 + 3, 1 + 4 + 9, 4 + 18);
    expect(4, 2 + 8 + 24, 0, 0);
    TEST_ASSERT_EQUAL_DOUBLE(1, motion_at(&scene, 0, 2).d[1]);
    TEST_ASSERT_EQUAL_DOUBLE(4, motion_at(&scene, 0, 9).d[1]);
}

static struct motion_point moved_point(double t, double X, double Y)
{
    const struct motion_state m = motion_at(&scene, 0, t);
    return motion_of_point(&m, X, Y);
}

/* A quarter turn a second about (1, 2): (3, 2) goes to (1, 4), with velocity (pi/2) 2 to the left
 * and acceleration (pi/2)^2 2 towards the centre. */
static void test_rotation_by_hand(void)
{
    must_read("centre = 1, 2\nturn = pi/2*t\nstop = 2\n");
    const struct motion_point p = moved_point(1, 3, 2);
    const double x[2] = {1, 4}, v[2] = {-M_PI, 0}, a[2] = {0, -M_PI * M_PI / 2};
    for (int c = 0; c < 2; c++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, x[c], p.x[c]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, v[c], p.v[c]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, a[c], p.a[c]);
    }
    const struct motion_point late =
        moved_point(7, 3, 2); /* after the stop: half a turn, at rest */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -1, late.x[0]);
    TEST_ASSERT_TRUE(late.v[0] == 0 && late.v[1] == 0 && late.a[0] == 0 && late.a[1] == 0);
}

/* Velocity and acceleration are the derivatives of the place (central differences over 2e-4 s are
 * good to 1e-8 of f'''), and distances do not change. */
static void test_rotation_is_rigid_and_smooth(void)
{
    must_read("centre = 0.01, 0.02\nturn = 0.5*t - t^2 + 0.2*sin(2*pi*t + 0.3)\n");
    const double h = 1e-4;
    for (double t = 0.1; t < 0.95; t += 0.17) {
        const struct motion_point before = moved_point(t - h, 0.3, -0.1),
                                  p = moved_point(t, 0.3, -0.1);
        const struct motion_point after = moved_point(t + h, 0.3, -0.1), q = moved_point(t, 0, 0.2);
        for (int c = 0; c < 2; c++) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, (after.x[c] - before.x[c]) / (2 * h), p.v[c]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, (after.v[c] - before.v[c]) / (2 * h), p.a[c]);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, hypot(0.3, 0.3), hypot(p.x[0] - q.x[0], p.x[1] - q.x[1]));
    }
}

/* An angle of zero leaves the bits of a place alone. */
static void test_no_rotation_is_the_limit(void)
{
    must_read("centre = 0.1, 0.7\nturn = 0*t\n");
    const struct motion_point p = moved_point(0.5, 0.3, 1.0 / 3);
    TEST_ASSERT_TRUE(p.x[0] == 0.3 && p.x[1] == 1.0 / 3 && p.v[0] == 0 && p.a[1] == 0);
}

/* x = 0.1 sin(2 pi t) + 0.3: from where the body is; velocity and acceleration by hand. After the
 * stop it rests where it has come to. */
static void test_expression_by_hand(void)
{
    must_read("x = 0.1*sin(2*pi*t) + 0.3\nstart = 0.5\nstop = 1.75\n");
    const double w = 2 * M_PI;
    expect(0.4, 0, 0, 0);
    expect(0.5, 0, 0.1 * w, 0);
    expect(0.625, 0.1 * sqrt(0.5), 0.1 * w * sqrt(0.5), -0.1 * w * w * sqrt(0.5));
    expect(1.25, -0.1, 0, 0.1 * w * w);
    expect(9, 0.1, 0, 0);
}

/* Every function of the language: derivatives against central differences, at times where none has
 * a kink. */
static void test_derivatives_of_every_function(void)
{
    static const char *const each[] = {"sqrt(t + 1)",
                                       "sin(3*t)",
                                       "cos(t*t)",
                                       "tan(0.5*t)",
                                       "sinh(t)",
                                       "cosh(2*t)",
                                       "tanh(t - 0.2)",
                                       "exp(-t)*t",
                                       "log(1 + t)",
                                       "round(2.6)*t",
                                       "abs(t - 2)",
                                       "abs(t)",
                                       "min(t, t^3)",
                                       "max(t, t^3)",
                                       "-t^2",
                                       "(t^2)^1.5",
                                       "t^3",
                                       "(1 + t)^-1.5",
                                       "(1 + t)^t",
                                       "2^t",
                                       "t/(1 + t^2)",
                                       "(t + 1)^0 - 2*t",
                                       "min(t/0.1, 1)*sin(2*pi*t)"};
    for (size_t k = 0; k < COUNT_OF(each); k++) {
        must_read_expression(each[k]);
        for (double t = 0.15; t < 0.95; t += 0.2) {
            const double h = 1e-4;
            const struct motion_state before = motion_at(&scene, 0, t - h),
                                      now = motion_at(&scene, 0, t),
                                      after = motion_at(&scene, 0, t + h);
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-6, (after.d[0] - before.d[0]) / (2 * h), now.v[0],
                                              each[k]);
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-5, (after.v[0] - before.v[0]) / (2 * h), now.a[0],
                                              each[k]);
        }
        scene_free(&scene);
    }
}

static void refuses(const char *motion, const char *message)
{
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, read(motion));
    TEST_ASSERT_EQUAL_STRING(message, diag.text);
}

static void test_bad_expressions(void)
{
    refuses("x = 0.1*log(t)\n",
            "motion.cfg:9: [motion move] 0.1*log(t): displacement, velocity or acceleration is not "
            "finite 0 s after `start`; change the expression");
    refuses("y = sqrt(0.5 - t)\n",
            "motion.cfg:9: [motion move] sqrt(0.5 - t): displacement, velocity or acceleration is "
            "not finite 0.5 s after `start`; change the expression");
    refuses("x = 0.1*sin(2*pi*x)\n",
            "motion.cfg:10: x = 0.1*sin(2*pi*x): `x` is known only in keys that take an expression "
            "in x and y");
    refuses("x = sqrt(t^2)\n",
            "motion.cfg:9: [motion move] sqrt(t^2): displacement, velocity or acceleration is not "
            "finite 0 s after `start`; change the expression");
}

/* A body is nowhere moved without a velocity; what is steep, quick or has a kink is not a jump. */
static void test_jumps_and_poles(void)
{
    refuses("x = 0.1*round(t)\n",
            "motion.cfg:10: [motion move] x = 0.1*round(t) jumps or is not finite 0.5 s after "
            "`start`, so the velocity is undefined; use a continuous expression");
    refuses("x = t\nturn = t + 1e-3*(t - 0.33337)/abs(t - 0.33337)\n",
            "motion.cfg:11: [motion move] turn = t + 1e-3*(t - 0.33337)/abs(t - 0.33337) jumps or "
            "is not finite 0.33337 s after `start`, so the velocity is undefined; use a continuous "
            "expression");
    static const char *const bad[] = {"1e-6/(t - 0.33337)", "1e-9/(t - 0.33337)^2",
                                      "1e-6*tan(20*t)", "log(abs(t - 0.4443))",
                                      "1e-9/(t - 0.3335)^2",
                                      /* by 2e-6 of its size */
                                      "1 + 1e-6*(t - 0.33337)/abs(t - 0.33337)"};
    for (size_t k = 0; k < COUNT_OF(bad); k++) {
        char text[128];
        snprintf(text, sizeof text, "y = %s\n", bad[k]);
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_INPUT, read(text), bad[k]);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, "jumps or is not finite 0."), diag.text);
    }
    static const char *const good[] = {"1 + 4e-7*(t - 0.33337)/abs(t - 0.33337)",
                                       "0.1*tanh(1e6*(t - 0.33337))",
                                       "0.1*cos(1000*pi*t)",
                                       "0.1*sin(12345*t)",
                                       "abs(t - 0.33337)",
                                       "1000 + max(t, 0.33337)",
                                       "round(3*0.7)*t",
                                       "exp(-1e6*(t - 0.5)^2)",
                                       "0.1*sin(2*pi*t)^3"};
    for (size_t k = 0; k < COUNT_OF(good); k++) {
        must_read_expression(good[k]);
        scene_free(&scene);
    }
}

static char warnings[2048];

static void note(void *context, const char *text)
{
    (void)context;
    snprintf(warnings, sizeof warnings, "%s", text);
}

/* Reads a case of 1 s with a table; the last warning is kept. */
static void read_warned(const char *text, const char *table)
{
    FILE *const file = fopen("test_motion.tmp", "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs(table, file);
    fclose(file);
    diag = (struct diag){.warn = note};
    warnings[0] = '\0';
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK,
                                  scene_load_text(&scene, text, "motion.cfg", 0, NULL, &diag),
                                  diag.text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, check_scene(&scene, &diag), diag.text);
    scene_free(&scene);
}

/* What moves in its last row stops there; what rests there, or lasts as long as the run, does
 * not. */
static void test_a_table_that_ends_in_motion_is_warned_of(void)
{
    static const char moved[] = HEAD "x = way(t)\n[table way]\nfile = test_motion.tmp\n";
    read_warned(moved, "0, 0\n0.5, 1e-3\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(warnings, "motion.cfg:10: [motion move] x = way(t): its table ends at t = 0.5 s, "
                         "before end_time = 1 s, and its last two rows differ"),
        warnings);
    read_warned(moved, "0, 0\n0.5, 1e-3\n0.6, 1e-3\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
    read_warned(moved, "0, 0\n1, 1e-3\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
    read_warned(HEAD "x = way(t)\n[table way]\nbetween = cubic\nfile = test_motion.tmp\n",
                "0, 0\n0.2, 1e-4\n0.5, 1e-3\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
    read_warned(HEAD "x = t^3 + way(t)\n[table way]\nfile = test_motion.tmp\n",
                "0, 0\n0.5, 1e-3\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "its table ends at t = 0.5 s"), warnings);
}

/* Gravity stays at its last value; a load has x and y beside the time. */
static void test_tables_of_other_keys_that_end_too_early_are_warned_of(void)
{
    static const char *const use[][3] = {
        {"way(t)", "way(x)", "motion.cfg:3: gravity = way(t): its table ends at t = 0.5 s"},
        {"0", "2*way(t)", "motion.cfg:13: [load l] force = 2*way(t): its table ends"},
        {"0", "way(x)", ""}};
    for (int k = 0; k < 3; k++) {
        char text[600];
        snprintf(text, sizeof text,
                 "dp = 1 mm\nend_time = 1\ngravity = %s, 0\n[beam b]\n"
                 "shape = polyline: 0, 0; 0.1, 0\nthickness = 1 mm\nyoung = 1e7\n"
                 "density = 1000\nclamp = 0, 0\n[load l]\nbody = b\nshape = box 0.05, -1, 1, 1\n"
                 "force = 0, %s\n[table way]\nfile = test_motion.tmp\n",
                 use[k][0], use[k][1]);
        read_warned(text, "0, 0\n0.5, 1e-3\n");
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, use[k][2]), warnings);
        TEST_ASSERT_TRUE_MESSAGE(*use[k][2] || !*warnings, warnings);
    }
}

static void test_a_motion_at_rest_is_warned_of(void)
{
    static const char *const rest[] = {"", "y = 2\n", "x = 2*3 mm\nturn = 1\n"};
    for (size_t k = 0; k < COUNT_OF(rest); k++) {
        char text[512];
        snprintf(text, sizeof text, "%s%s", HEAD, rest[k]);
        read_warned(text, "");
        TEST_ASSERT_EQUAL_STRING(
            "motion.cfg:9: [motion move] moves nothing, unless a program sets it: x, y and turn "
            "are displacements as expressions in t, for example y = 1.5 m/s*t",
            warnings);
    }
    read_warned(HEAD "x = 0.1\nturn = t\n", "");
    TEST_ASSERT_EQUAL_STRING("", warnings);
}

static void test_no_motion_is_rest(void)
{
    must_read("x = t\ny = t\n");
    const struct motion_state m = motion_at(&scene, -1, 0.5);
    TEST_ASSERT_EQUAL_DOUBLE(0, m.d[0] + m.v[0] + m.a[0] + m.d[1] + m.v[1] + m.a[1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_between_start_and_stop);
    RUN_TEST(test_nothing_given_is_rest);
    RUN_TEST(test_polynomial);
    RUN_TEST(test_rotation_by_hand);
    RUN_TEST(test_rotation_is_rigid_and_smooth);
    RUN_TEST(test_no_rotation_is_the_limit);
    RUN_TEST(test_expression_by_hand);
    RUN_TEST(test_derivatives_of_every_function);
    RUN_TEST(test_bad_expressions);
    RUN_TEST(test_jumps_and_poles);
    RUN_TEST(test_a_table_that_ends_in_motion_is_warned_of);
    RUN_TEST(test_tables_of_other_keys_that_end_too_early_are_warned_of);
    RUN_TEST(test_a_motion_at_rest_is_warned_of);
    RUN_TEST(test_no_motion_is_rest);
    return UNITY_END();
}
