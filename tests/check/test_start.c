/* SPDX-License-Identifier: MIT
 * Starts that are hardly meant are warned of: fluid beside its container, fluid without its
 * weight's pressure, motions near the speed of sound, inflows above the surface, probes inside
 * walls. */
#include "warned.h"

#include <stdio.h>
#include <string.h>

static void read(const char *text) { read_as("start.cfg", text); }

static void expect(const char *text)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, text), warnings);
}

void setUp(void) {}

void tearDown(void) { scene_free(&scene); }

#define HEAD "dp = 5 mm\nend_time = 1 s\ngravity = 0, -9.81\n"
#define WATER "[fluid water]\nsound_speed = 10\nsurface = 0.05\n"
#define TANK                                                                         \
    "[wall tank]\nshape = box -0.02, -0.02, 0.12, 0\nshape = box -0.02, 0, 0, 0.1\n" \
    "shape = box 0.1, 0, 0.12, 0.1\n"

static void test_fluid_a_little_beside_its_wall(void)
{
    read(HEAD WATER "shape = box 0, 0, 0.1, 0.05\n" TANK);
    TEST_ASSERT_EQUAL_STRING("", warnings);
    read(HEAD WATER "shape = box 0.005, 0, 0.1, 0.05\n" TANK);
    expect("start.cfg:4: [fluid water] begins one dp = 0.005 m away from [wall tank]");
    /* Wider: a dam break. Above the fluid: a lid. */
    read(HEAD WATER "shape = box 0, 0, 0.09, 0.05\n" TANK);
    TEST_ASSERT_EQUAL_STRING("", warnings);
    read(HEAD WATER "shape = box 0, 0, 0.1, 0.05\n" TANK
                    "[wall lid]\nshape = box -0.02, 0.06, 0.12, 0.08\n");
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "begins"), warnings);
    /* A beam five spacings away, whose dummies are nearer. */
    read("dp = 5 mm\nend_time = 1 s\n[fluid water]\nsound_speed = 10\nshape = box 0, 0, 0.1, 0.05\n"
         "[beam b]\nshape = polyline: 0, 0.075; 0.1, 0.075\nclamp = 0, 0.075\n"
         "thickness = 1 mm\ndensity = 1000\nyoung = 1e9\n");
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "begins"), warnings);
}

static void test_points_far_from_rigid_bodies(void)
{
#define BOX "[rigid a]\nshape = box 0.1, 0, 0.2, 0.2\ndensity = 500\n"
#define LINE "[spring s]\nbody = a\nstiffness = 1\n"
    read(HEAD BOX "centre = 0.1, 0.3\n" LINE "from = 0.3, 0\nto = 9, 9\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
    read(HEAD BOX LINE "from = 3, 3\nto = 9, 9\n");
    expect("start.cfg:10: [spring s] from = 3, 3 is further from [rigid a] than the body is long");
    read(HEAD BOX "centre = 0.15, 0.5\n" LINE "from = 0.2, 0\nto = 9, 9\n");
    expect("start.cfg:7: [rigid a] centre = 0.15, 0.5 is further from");
    read(HEAD BOX "[rigid b]\nshape = circle 1, 0, 0.1\ndensity = 1\n" LINE
                  "other = b\nfrom = 0.2, 0\nto = 2, 0\n");
    expect("[spring s] to = 2, 0 is further from [rigid b]");
#undef BOX
#undef LINE
}

static void test_fluid_without_the_pressure_of_its_weight(void)
{
    read(HEAD "[fluid water]\nsound_speed = 10\nshape = box 0, 0, 0.1, 0.05\n" TANK);
    expect("start.cfg:4: [fluid water] begins without the pressure of its weight");
    expect("weight, 490 Pa, so");
    read(HEAD "[fluid water]\nsound_speed = 10\nshape = box 0, 0, 0.1, 0.05\n"
              "pressure = 1000*9.81*(0.05 - y)\n" TANK);
    TEST_ASSERT_EQUAL_STRING("", warnings);
    /* What falls has none. With a surface it would form a jet. */
    read(HEAD "[fluid drop]\nsound_speed = 10\nshape = box 0, 0.05, 0.1, 0.1\n" TANK);
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "weight"), warnings);
    read(HEAD
         "[fluid drop]\nsound_speed = 10\nsurface = 0.1\nshape = box 0, 0.05, 0.1, 0.1\n" TANK);
    expect("[fluid drop] has a `surface`, but nothing to stand on: the pressure at its lower end "
           "begins with up to 490 Pa");
}

static void test_a_body_force_that_drives_a_periodic_flow(void)
{
#define ARRAY                                                                            \
    "dp = 5 mm\nend_time = 1 s\n[wall post]\nshape = circle 0.05, 0.05, 0.02\n"          \
    "[fluid water]\nsound_speed = 10\nshape = box 0, 0, 0.1, 0.1\nminus = circle 0.05, " \
    "0.05, 0.02\n[domain]\nlower = 0, 0\nupper = 0.1, 0.1\nperiodic = xy\n"
    read("gravity = 0.5, 0\n" ARRAY);
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "weight"), warnings);
    /* A film on a slope: its bed bears the part of gravity across it. */
#define FILM                                                                                 \
    "dp = 5 mm\nend_time = 1 s\ngravity = 3, -9\n[wall bed]\nshape = box 0, -0.02, 0.1, 0\n" \
    "[domain]\nlower = 0, -0.1\nupper = 0.1, 0.2\nperiodic = x\n[fluid water]\n"             \
    "sound_speed = 10\nshape = box 0, 0, 0.1, 0.05\n"
    read(FILM);
    expect("weight, 450 Pa, so");
    expect("add `pressure`");
}

static void test_a_motion_near_the_speed_of_sound(void)
{
#define DRIVEN HEAD WATER "shape = box 0, 0, 0.1, 0.05\n" TANK "motion = shake\n"
    read(DRIVEN "[motion shake]\nx = 2.9/6.3*cos(6.3*t)\n");
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "[motion shake]"), warnings);
    read(DRIVEN "[motion shake]\nx = 4/6.3*cos(6.3*t)\n");
    expect("[motion shake] moves [wall tank] at up to 4 m/s, above 0.3 of the fluid's speed of "
           "sound, 10 m/s");
    expect("sound_speed = 40 or more");
    /* 90 turns a second where 90 degrees were meant, 0.1 m off its axis. */
    read(DRIVEN "[motion shake]\nturn = 90*t\n");
    expect("angles are in radians");
}

static void test_an_inflow_above_the_surface(void)
{
#define CHANNEL                                                                               \
    HEAD WATER "shape = box 0, 0, 0.4, 0.05\n[wall bed]\nshape = box -0.06, -0.02, 0.46, 0\n" \
               "[outflow o]\nfrom = 0.4, 0\nto = 0.4, 0.1\nlevel = 0.05\n"                    \
               "[inflow i]\nfrom = 0, 0.1\nto = 0, 0\nvelocity = 0.1, 0\n"
    read(CHANNEL);
    expect("the line of [inflow i] lets fluid pass up to y = 0.1 m");
    expect("Above the surface fluid falls in; `level = 0.05 m` prevents this");
    read(CHANNEL "level = 0.05\n");
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "lets fluid pass up to"), warnings);
}

static void test_probes_inside_a_wall(void)
{
#define PROBED HEAD WATER "shape = box 0, 0, 0.1, 0.05\n" TANK "[probe p]\n"
    read(PROBED "quantity = velocity\npoint = 0.05, -0.01\n");
    expect("its velocity comes from fluid within 2 h");
    read(PROBED "quantity = level\npoint = 0.05, -0.01\n");
    expect("so its value is the height of the point");
    read(PROBED "quantity = velocity\npoint = 0.05, 0.02\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
}

static void test_the_moment_on_a_wall_that_turns(void)
{
#define DRUM(slip, motion)                                                                 \
    "dp = 5 mm\nend_time = 1 s\n[fluid oil]\nshape = circle 0, 0, 0.1\nsound_speed = 10\n" \
    "laminar_viscosity = 1e-3\npressure = 50\n[wall drum]\nshape = circle 0, 0, 0.12\n"    \
    "minus = circle 0, 0, 0.1\n" slip motion "[probe p]\nquantity = force\nbody = drum\n"
    read(DRUM("slip = none\n", "motion = m\n[motion m]\nturn = t\n"));
    expect("[wall drum] turns with slip = none: the viscous moment on it is off by 2 mu A omega");
    read(DRUM("slip = none\n", "motion = m\n[motion m]\nturn = t\n"));
    expect("mu = 1 Pa s");
    /* A free body, which turns by it; a clamped one does not. */
#define FLOATER                                                               \
    "dp = 5 mm\nend_time = 1 s\n[fluid oil]\nshape = circle 0, 0, 0.1\n"      \
    "minus = circle 0, 0, 0.03\nsound_speed = 10\nlaminar_viscosity = 1e-3\n" \
    "[solid ball]\nshape = circle 0, 0, 0.03\ndensity = 1000\nyoung = 1 MPa\npoisson = 0.3\n"
    read(FLOATER "slip = none\n");
    expect("[solid ball] is free to turn with slip = none: the viscous moment on it is off by");
    read(FLOATER "slip = none\nclamp = circle 0, 0, 0.012\n");
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "free to turn"), warnings);
    read(FLOATER);
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "free to turn"), warnings);
    read(DRUM("slip = none\n", "motion = m\n[motion m]\nx = t\n"));
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "moment on it"), warnings);
    read(DRUM("", "motion = m\n[motion m]\nturn = t\n"));
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "moment on it"), warnings);
}

static void test_a_body_that_is_thrown(void)
{
#define BALL \
    HEAD "[solid ball]\nshape = circle 0, 0, 0.03\ndensity = 1000\nyoung = 1 MPa\npoisson = 0.3\n"
    read(BALL);
    expect("[solid ball] has no clamp");
    read(BALL "velocity = 1, 0\n");
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "has no clamp"), warnings);
}

static void test_bodies_that_stand(void)
{
#define RUBBER "density = 1000\nyoung = 1 MPa\npoisson = 0.3\n"
#define BED "[wall bed]\nshape = box -0.1, -0.02, 0.3, 0\n"
#define LOW "[solid low]\nshape = box 0, 0, 0.05, 0.05\n" RUBBER
#define HIGH "[solid high]\nshape = box 0.02, 0.05, 0.06, 0.1\n" RUBBER
    read(HEAD HIGH LOW BED);
    TEST_ASSERT_EQUAL_STRING("", warnings);
    read(HEAD LOW HIGH);
    expect("start.cfg:4: [solid low] has no clamp, and gravity acts on it, so it falls");
    expect("start.cfg:9: [solid high] has no clamp, and gravity acts on it, so it falls");
    /* Bonded to a clamped body, on either side of the bond. */
    read(HEAD LOW "clamp = box 0, 0, 0.05, 0.01\n" HIGH "joined = low\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
    read(HEAD LOW HIGH "joined = low\nclamp = box 0.02, 0.09, 0.06, 0.1\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
    read(HEAD LOW HIGH "joined = low\n");
    expect("[solid low] has no clamp, and gravity acts on it, so it falls");
    /* Water pushes what only stands. */
    read(HEAD LOW BED
         "[fluid water]\nsound_speed = 10\nsurface = 0.05\nshape = box 0.1, 0, 0.3, 0.05\n");
    expect(
        "[solid low] has no clamp, and it only stands on what is below it, so fluid may move it");
    /* Without contact there is nothing to stand on. */
    read(HEAD LOW BED "[contact any]\nenabled = off\n");
    expect("[solid low] has no clamp, and gravity acts on it, so it falls");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_fluid_a_little_beside_its_wall);
    RUN_TEST(test_points_far_from_rigid_bodies);
    RUN_TEST(test_fluid_without_the_pressure_of_its_weight);
    RUN_TEST(test_a_body_force_that_drives_a_periodic_flow);
    RUN_TEST(test_a_motion_near_the_speed_of_sound);
    RUN_TEST(test_an_inflow_above_the_surface);
    RUN_TEST(test_probes_inside_a_wall);
    RUN_TEST(test_the_moment_on_a_wall_that_turns);
    RUN_TEST(test_a_body_that_is_thrown);
    RUN_TEST(test_bodies_that_stand);
    return UNITY_END();
}
