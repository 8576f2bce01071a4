/* SPDX-License-Identifier: MIT
 * Scenes that are hardly meant are warned of, and sound ones are not. */
#include "particles/particles.h"
#include "rig.h"
#include "warned.h"

#include <stdio.h>
#include <string.h>

static void read(const char *text) { read_as("doubts.cfg", text); }

void setUp(void) {}

void tearDown(void) { scene_free(&scene); }

#define HEAD "dp = 5 mm\nend_time = 1 s\ngravity = 0, -9.81\n"
#define WATER "[fluid water]\nshape = box 0, 0, 0.1, 0.05\nsound_speed = 10\nsurface = 0.05\n"
#define SIDES \
    "[wall left]\nshape = box -0.02, 0, 0, 0.1\n[wall right]\nshape = box 0.1, 0, 0.12, 0.1\n"
#define FLOOR "[wall floor]\nshape = box -0.02, -0.02, 0.12, 0\n"
#define POST "density = 1000\nyoung = 1 MPa\npoisson = 0.3\n"

static void test_a_sound_tank_gets_no_warning(void)
{
    read(HEAD WATER SIDES FLOOR);
    TEST_ASSERT_EQUAL_STRING("", warnings);
}

/* Beside another clamp a hinge of one particle does not add to the part that the other holds. */
static void test_a_hinge_is_one_particle(void)
{
    read(HEAD "[solid bar]\nshape = box 0, 0, 0.02, 0.1\n" POST
              "clamp = box 0, 0, 0.02, 0.02\nclamp = circle 0.01, 0.09, 0.71*dp\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
    read(HEAD "[solid bar]\nshape = box 0, 0, 0.02, 0.1\n" POST
              "clamp = circle 0.0075, 0.0875, 0.6*dp\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
}

/* A beam ends at the face that holds it; further it would move in the wall. */
static void test_a_beam_in_a_wall(void)
{
#define BEAM(from)                                                        \
    HEAD WATER SIDES FLOOR BEAM_AT from "; 0.05, 0.08\nclamp = 0.05, 0\n" \
                                        "thickness = 1 mm\n" POST
#define BEAM_AT "[beam plate]\nshape = polyline: 0.05, "
    read(BEAM("0"));
    TEST_ASSERT_EQUAL_STRING("", warnings);
    rig_refuses(BEAM("-0.01"), "[beam plate] lies in [wall floor]");
}

static void test_a_tank_without_a_floor(void)
{
    /* All but the nine of each outer column that stand above the foot of a side. */
    read(HEAD WATER SIDES);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "182 of 200 fluid particles"), warnings);
    TEST_ASSERT_NOT_NULL(strstr(warnings, "doubts.cfg:4: "));
    /* Gravity along x: the right side holds the water, nothing else is needed. */
    read("dp = 5 mm\nend_time = 1 s\ngravity = 9.81, 0\n"
         "[fluid water]\nshape = box 0, 0, 0.1, 0.05\nsound_speed = 10\npressure = 9810*x\n" SIDES);
    TEST_ASSERT_EQUAL_STRING("", warnings);
    /* The same against x, read first, so that nothing is left of another direction. */
    static const char *const sides[] = {
        "gravity = -9.81, 0\n[wall a]\nshape = box -0.02, 0, 0, 0.1\n",
        "gravity = 9.81, 0\n[wall a]\nshape = box 0.1, 0, 0.12, 0.1\n"};
    for (int k = 0; k < 4; k++) {
        char text[512];
        snprintf(text, sizeof text,
                 "dp = 5 mm\nend_time = 1 s\n%s[fluid water]\nshape = box 0, 0, 0.1, 0.05\n"
                 "sound_speed = 10\npressure = 9810*%s\n",
                 sides[k % 2], k % 2 ? "x" : "(0.1 - x)");
        read(text);
        TEST_ASSERT_EQUAL_STRING("", warnings);
    }
    /* A hole in the floor: what stands above it, but for its two edges. */
    read(HEAD WATER SIDES
         "[wall floor]\nshape = box -0.02, -0.02, 0.03, 0\nshape = box 0.06, -0.02, 0.12, 0\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "40 of 200 fluid particles"), warnings);
}

static void test_surface_against_gravity_and_below_the_water(void)
{
    read("dp = 5 mm\nend_time = 1 s\ngravity = 0, 9.81\n" WATER SIDES FLOOR
         "[wall lid]\nshape = box -0.02, 0.05, 0.12, 0.07\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(warnings, "a `surface`, but gravity points upwards, by 9.81 m/s^2 at t = 0"),
        warnings);
    /* A tank is shaken by more than g, about -g. */
    read("dp = 5 mm\nend_time = 1 s\ngravity = 0, -9.81 + 20*sin(50*t)\n" WATER SIDES FLOOR);
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "upward"), warnings);
    read(HEAD "[fluid water]\nshape = box 0, 0, 0.1, 0.05\nsound_speed = 10\nsurface = 0.03\n" SIDES
             FLOOR);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "80 particles begin with a pressure below zero"),
                                 warnings);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "reaches up to y = 0.05 m"), warnings);
}

static void test_a_surface_above_the_water(void)
{
#define DEEP "[fluid water]\nshape = box 0, 0, 0.1, 0.05\nsound_speed = 40\nsurface = 0.2\n"
    read(HEAD DEEP SIDES FLOOR);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "ends at y = 0.05 m, below its `surface "
                                                  "= 0.2 m`"),
                                 warnings);
    TEST_ASSERT_NOT_NULL(strstr(warnings, "begins with 1.47e+03 Pa")); /* 1000*9.81*0.15 */
    /* Under a lid the water may be under pressure; under water of another section, too. */
    read(HEAD DEEP SIDES FLOOR "[wall lid]\nshape = box -0.02, 0.05, 0.12, 0.07\n");
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "free surface"), warnings);
    read(HEAD "[fluid water]\nshape = box 0, 0, 0.1, 0.05\nsound_speed = 40\nsurface = 0.1\n"
              "[fluid top]\nshape = box 0, 0.05, 0.1, 0.1\nsound_speed = 40\nsurface = 0.1\n" SIDES
                  FLOOR);
    TEST_ASSERT_EQUAL_STRING("", warnings);
    /* Two heights in one section. */
    read(HEAD "[fluid water]\nshape = box 0, 0, 0.05, 0.05\nshape = box 0.05, 0, 0.1, 0.02\n"
              "sound_speed = 10\nsurface = 0.05\n" SIDES FLOOR);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "ends at y = 0.02 m"), warnings);
}

static void test_a_density_of_one(void)
{
    read(HEAD WATER "density = 1\n" SIDES FLOOR);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "has a density of 1 kg/m^3"), warnings);
}

static void test_a_body_without_its_units(void)
{
#define BODY                                                                           \
    "[solid post]\nshape = box 0.05, 0, 0.07, 0.05\nclamp = box 0.05, 0, 0.07, 0.01\n" \
    "poisson = 0.3\n"
#define BESIDE "[fluid water]\nshape = box 0, 0, 0.04, 0.05\nsound_speed = 10\nsurface = 0.05\n"
    read(HEAD BESIDE SIDES FLOOR BODY "density = 1.1\nyoung = 1 MPa\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "[solid post] has a density of 1.1 kg/m^3"),
                                 warnings);
    TEST_ASSERT_NOT_NULL(strstr(warnings, "doubts.cfg:14: "));
    /* 9.81*0.045*1000 = 441 Pa of water, 486 Pa of the body's weight, between the centres. */
    read(HEAD BESIDE SIDES FLOOR BODY "density = 1100\nyoung = 5\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "too soft for its own weight of 486 Pa, which is "
                                                  "97 times its `young` = 5 Pa"),
                                 warnings);
    read(HEAD BESIDE SIDES FLOOR BODY "density = 900\nyoung = 4000\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "too soft for the pressure of the water of 441 "
                                                  "Pa"),
                                 warnings);
    read(HEAD BESIDE SIDES FLOOR BODY "density = 900\nyoung = 5000\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
    read("dp = 5 mm\nend_time = 1 s\n" BODY "density = 1100\nyoung = 5\n"); /* no weight */
    TEST_ASSERT_EQUAL_STRING("", warnings);
}

static void test_a_body_that_nothing_holds(void)
{
    static const char post[] = "[solid post]\nshape = box 0, 0, 0.02, 0.1\n" POST;
    char text[1024];
    snprintf(text, sizeof text, "%s%s", HEAD, post);
    read(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "doubts.cfg:4: [solid post] has no clamp, and "
                                                  "gravity acts on it"),
                                 warnings);
    snprintf(text, sizeof text, "%s%sgravity = off\n", HEAD, post);
    read(text);
    TEST_ASSERT_EQUAL_STRING("", warnings);
}

static void test_a_speed_of_sound_that_is_too_low(void)
{
    /* 9.81*0.045/1.5^2 = 0.196 between the centres of the first and the last row. */
    read(HEAD
         "[fluid water]\nshape = box 0, 0, 0.1, 0.05\nsound_speed = 1.5\nsurface = 0.05\n" SIDES
             FLOOR);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "compressed by 20 % under its own weight"),
                                 warnings);
    TEST_ASSERT_NOT_NULL(strstr(warnings, "`max_speed` of 0.664 m/s"));
}

static void test_a_clamp_that_covers_the_body(void)
{
    static const char post[] = HEAD "[solid post]\nshape = box 0, 0, 0.02, 0.1\n" POST;
    char text[1024];
    snprintf(text, sizeof text, "%sclamp = box 0, 0, 0.02, 0.1\n", post);
    read(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(warnings, "`clamp` holds all 80 particles of [solid post], so it cannot deform"),
        warnings);
    snprintf(text, sizeof text, "%sclamp = box 0, 0, 0.02, 0.02\n", post);
    read(text);
    TEST_ASSERT_EQUAL_STRING("", warnings);
}

static void test_a_clamp_and_a_wall_that_move_differently(void)
{
    static const char scene_text[] =
        HEAD "[wall floor]\nshape = box -0.05, -0.02, 0.07, 0\nmotion = shake\n"
             "[motion shake]\nx = 0.01*sin(2*pi*t)\n"
             "[solid post]\nshape = box 0, 0, 0.02, 0.1\nclamp = box 0, 0, 0.02, 0.02\n" POST;
    char text[1024];
    read(scene_text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "`clamp_motion = shake` moves both"), warnings);
    snprintf(text, sizeof text, "%sclamp_motion = shake\n", scene_text);
    read(text);
    TEST_ASSERT_EQUAL_STRING("", warnings);
    /* The clamp moves alone, and both move in different ways. */
    read(HEAD "[wall floor]\nshape = box -0.05, -0.02, 0.07, 0\n"
              "[motion shake]\nx = 0.01*sin(2*pi*t)\n"
              "[solid post]\nshape = box 0, 0, 0.02, 0.1\nclamp = box 0, 0, 0.02, 0.02\n"
              "clamp_motion = shake\n" POST);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings,
                                        "which is at rest, so the two will overlap or part; "
                                        "`motion = shake` moves both"),
                                 warnings);
    snprintf(text, sizeof text, "%sclamp_motion = sway\n[motion sway]\nx = 0.1*t\n", scene_text);
    read(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "has the motion sway but touches [wall floor], "
                                                  "which moves differently"),
                                 warnings);
    /* A wall that does not touch the clamp may move alone. */
    read(HEAD "[wall lid]\nshape = box -0.05, 0.2, 0.07, 0.22\nmotion = shake\n"
              "[motion shake]\nx = 0.01*sin(2*pi*t)\n"
              "[solid post]\nshape = box 0, 0, 0.02, 0.1\nclamp = box 0, 0, 0.02, 0.02\n" POST);
    TEST_ASSERT_EQUAL_STRING("", warnings);
}

#define PROBE "[probe P]\nquantity = pressure\npoint = "

static void test_a_pressure_probe_in_a_wall(void)
{
    read(HEAD WATER SIDES FLOOR PROBE "0.05, -0.01\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "lies inside a wall or solid"), warnings);
    TEST_ASSERT_NOT_NULL(strstr(warnings, "doubts.cfg:14: [probe P] point = 0.05, -0.01"));
    /* The common corner of two walls is inside; a point on a face is not. */
    read(HEAD WATER SIDES FLOOR PROBE "-0.01, 0\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "lies inside a wall or solid"), warnings);
    read(HEAD WATER SIDES FLOOR PROBE "0.05, 0\n"
                                      "[probe Q]\nquantity = pressure\npoint = 0, 0.02\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
}

static void test_a_gap_of_one_particle(void)
{
    read(HEAD
         "[fluid water]\nshape = box 0, 0, 0.04, 0.05\nsound_speed = 10\nsurface = 0.05\n" SIDES
             FLOOR "[wall post]\nshape = box 0.05, 0.005, 0.07, 0.05\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(warnings, "doubts.cfg:15: the gap between [wall floor] and [wall "
                         "post] at (0.05059, 0.002497) m is 0.005 m wide, one "
                         "particle: the flow through it is 0.2 to 0.8 of the exact "
                         "flow, and energy may be gained; use dp = 0.0025 m or less"),
        warnings);
    TEST_ASSERT_NULL(strchr(strchr(warnings, '\n') + 1, '\n')); /* one warning */
    read(HEAD
         "[fluid water]\nshape = box 0, 0, 0.04, 0.05\nsound_speed = 10\nsurface = 0.05\n" SIDES
             FLOOR "[wall post]\nshape = box 0.05, 0.01, 0.07, 0.05\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
    /* A polygon and a body. */
    read(HEAD
         "[fluid water]\nshape = box 0, 0, 0.04, 0.05\nsound_speed = 10\nsurface = 0.05\n" SIDES
             FLOOR
         "[wall post]\nshape = polygon 0.05, 0.005; 0.07, 0.005; 0.07, 0.05; 0.05, 0.05\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "between [wall floor] and [wall post] at ("),
                                 warnings);
    read(HEAD
         "[fluid water]\nshape = box 0, 0, 0.04, 0.05\nsound_speed = 10\nsurface = 0.05\n" SIDES
             FLOOR "[wall post]\nshape = polygon 0.05, 0; 0.07, 0; 0.07, 0.05; 0.05, 0.05\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
}

static void test_a_gap_within_one_wall(void)
{
#define SHORT "[fluid water]\nshape = box 0, 0, 0.04, 0.05\nsound_speed = 10\nsurface = 0.05\n"
#define TANK "[wall tank]\nshape = polyline thickness -20 mm: 0, 0.1; 0, 0; 0.1, 0; 0.1, 0.1\n"
    read(HEAD SHORT TANK "shape = box 0.05, 0.005, 0.07, 0.08\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "the gap in [wall tank] at ("), warnings);
    TEST_ASSERT_NULL(strchr(strchr(warnings, '\n') + 1, '\n'));
    read(HEAD SHORT TANK "shape = box 0.05, 0.01, 0.07, 0.08\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
    /* A slot that leads nowhere is no opening. */
    read(HEAD SHORT TANK "shape = box 0.05, 0, 0.07, 0.08\nminus = box 0.06, 0.06, 0.065, 0.08\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
    /* One that is cut through a wall of boxes. */
    read(HEAD SHORT SIDES FLOOR "[wall post]\nshape = box 0.05, 0, 0.07, 0.08\n"
                                "minus = box 0.05, 0.01, 0.07, 0.015\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "the gap in [wall post] at ("), warnings);
    /* The tip of a V. */
    read(HEAD "[fluid water]\nshape = polygon 0, 0; 0.05, 0.1; -0.05, 0.1\nsound_speed = 10\n"
              "surface = 0.1\n[wall v]\nshape = polygon -0.1, -0.03; 0.1, -0.03; 0.1, 0.15; "
              "-0.1, 0.15\nminus = polygon 0, 0; 0.075, 0.15; -0.075, 0.15\n");
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "the gap"), warnings);
}

static void test_a_gap_that_sampling_closes(void)
{
    read(HEAD SHORT TANK "[wall post]\nshape = polygon 0.05, 0.002; 0.07, 0.002; 0.07, 0.08; "
                         "0.05, 0.08\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(warnings, "the gap between [wall tank] and [wall post] at (0.05059, 0.0009974) m is "
                         "0.002 m wide, and closed by sampling, so no fluid passes; use dp = "
                         "0.001 m or less"),
        warnings);
    /* Between shapes of one section. */
    read(HEAD SHORT TANK "shape = polygon 0.05, 0.002; 0.07, 0.002; 0.07, 0.08; 0.05, 0.08\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(warnings, "doubts.cfg:10: the gap in [wall tank] at "
                         "(0.05059, 0.0009974) m is 0.002 m wide, and closed by sampling"),
        warnings);
    TEST_ASSERT_NULL(strstr(strstr(warnings, ": the gap") + 1, ": the gap")); /* one warning */
    /* Shapes that overlap, that share an edge, or that touch a third one only. */
    read(HEAD SHORT TANK "shape = polygon 0.05, -0.01; 0.07, -0.01; 0.07, 0.08; 0.05, 0.08\n"
                         "shape = polygon 0.07, 0; 0.09, 0; 0.07, 0.04\n"
                         "shape = circle 0.06, 0.08, 0.01\nshape = box 0.07, 0.042, 0.09, 0.06\n");
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "the gap"), warnings);
    /* Two circles and the floor touch as drawn, at a point. */
    read(HEAD SHORT TANK "[solid a]\nshape = circle 0.06, 0.01, 0.01\n" POST
                         "[solid b]\nshape = circle 0.08, 0.01, 0.01\n" POST);
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "the gap"), warnings);
    /* Under a body whose lattice is fitted, and which the tank holds elsewhere. */
    read(HEAD SHORT TANK "shape = box 0.05, 0.08, 0.1, 0.1\n"
                         "[solid gate]\nshape = box 0.05, 0.002, 0.07, 0.08\n"
                         "clamp = box 0.05, 0.06, 0.07, 0.08\ndensity = 1100\nyoung = 5 MPa\n"
                         "poisson = 0.4\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings,
                                        "the gap between [solid gate] and [wall tank] at"),
                                 warnings);
    /* Between two bodies. */
    read(HEAD SHORT TANK
         "[solid a]\nshape = polygon 0.04, 0; 0.06, 0; 0.06, 0.04; 0.04, 0.04\n" POST
         "[solid b]\nshape = polygon 0.062, 0; 0.08, 0; 0.08, 0.04; 0.062, 0.04\n" POST);
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "the gap"), warnings); /* it ends at the floor */
    read(HEAD SHORT TANK
         "[solid a]\nshape = polygon 0.04, 0.02; 0.06, 0.02; 0.06, 0.06; 0.04, 0.06\n" POST
         "[solid b]\nshape = polygon 0.062, 0.02; 0.08, 0.02; 0.08, 0.06; 0.062, 0.06\n" POST);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "the gap between [solid a] and [solid b] at"),
                                 warnings);
}

static void test_an_opening_that_sampling_closes(void)
{
    read(HEAD WATER SIDES FLOOR "[wall lid]\nshape = box 0, 0.06, 0.1, 0.08\n"
                                "minus = box 0.051, 0.06, 0.052, 0.08\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "`minus` removes no particle of [wall lid]"),
                                 warnings);
    TEST_ASSERT_NOT_NULL(strstr(warnings, "doubts.cfg:16: "));
    read(HEAD WATER SIDES FLOOR "[wall lid]\nshape = box 0, 0.06, 0.1, 0.08\n"
                                "minus = box 0.05, 0.06, 0.06, 0.08\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
}

static void test_flow_past_a_body_that_sticks(void)
{
#define STREAM(slip, shift)                                                                        \
    "dp = 5 mm\nend_time = 1 s\n[fluid water]\nshape = box 0, 0, 0.1, 0.05\nsound_speed = 10\n"    \
    "laminar_viscosity = 1e-3\n" shift                                                             \
    "[wall plates]\nshape = box -0.05, -0.02, 0.15, 0\nshape = box -0.05, 0.05, 0.15, 0.07\n" slip \
    "[inflow in]\nfrom = 0, 0.05\nto = 0, 0\nspeed = 0.1\n"                                        \
    "[outflow out]\nfrom = 0.1, 0\nto = 0.1, 0.05\npressure = 0\n"
    read(STREAM("slip = none\n", ""));
    TEST_ASSERT_EQUAL_DOUBLE(10, scene.fluid[0].shifting);
    TEST_ASSERT_EQUAL_INT(SHIFTING_LARGEST, scene.fluid[0].shifting_speed);
    read(STREAM("slip = none\n", "[numerics]\ncfl = 0.8\n"));
    TEST_ASSERT_EQUAL_DOUBLE(5 / 0.8, scene.fluid[0].shifting);
    read(STREAM("slip = none\n", "shifting = 0\n"));
    TEST_ASSERT_EQUAL_DOUBLE(0, scene.fluid[0].shifting);
    read(STREAM("", ""));
    TEST_ASSERT_EQUAL_DOUBLE(0, scene.fluid[0].shifting);
    /* A free surface: the water ends below the upper plate. */
    read(STREAM("slip = none\n", "minus = box 0, 0.03, 0.1, 0.05\n"));
    TEST_ASSERT_EQUAL_DOUBLE(0, scene.fluid[0].shifting);
}

static void test_shifting_where_nothing_gives_way(void)
{
#define CHANNEL                                                                               \
    "dp = 5 mm\nend_time = 1 s\ngravity = 1, 0\n[fluid water]\nshape = box 0, 0, 0.1, 0.05\n" \
    "sound_speed = 10\nshifting = 2\n[wall floor]\nshape = box 0, -0.02, 0.1, 0\n"            \
    "[domain]\nlower = 0, -0.03\nupper = 0.1, 0.1\nperiodic = x\n"
    read(CHANNEL "[wall roof]\nshape = box 0, 0.05, 0.1, 0.07\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "its mean pressure drifts with `shifting`, by "
                                                  "about 1 % of rho c0^2 = 1e+05 Pa"),
                                 warnings);
    read(CHANNEL); /* a free surface */
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, "drifts"), warnings);
}

#define OPEN_CHANNEL                                                   \
    "dp = 1 cm\nend_time = 4\n[fluid w]\nshape = box 0, 0, 0.4, 0.2\n" \
    "sound_speed = 2\ndensity_diffusion = 0.1\n"
#define SIDE_WALLS "[wall t]\nshape = box -0.2, -0.04, 0.6, 0\nshape = box -0.2, 0.2, 0.6, 0.24\n"
#define IN "[inflow i]\nfrom = 0, 0.2\nto = 0, 0\nspeed = 0.1\n"
#define OUT(how) "[outflow o]\nfrom = 0.4, 0\nto = 0.4, 0.2\n" how "\n"

/* Beside the run: the density of a closed channel between two inflows deviates by 10 % after 56 ms.
 */
static void test_velocities_that_do_not_balance(void)
{
    read(OPEN_CHANNEL IN OUT("pressure = 0") SIDE_WALLS);
    TEST_ASSERT_EQUAL_STRING("", warnings);
    read(OPEN_CHANNEL IN OUT("speed = 0.1") SIDE_WALLS);
    TEST_ASSERT_EQUAL_STRING("", warnings);
    read(OPEN_CHANNEL IN OUT("speed = -0.1*cos(pi*t)") SIDE_WALLS);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(warnings, "[outflow o] is one of the open boundaries whose velocities "
                         "let 0.00"),
        warnings);
    read(OPEN_CHANNEL IN "[inflow o]\nfrom = 0.4, 0\nto = 0.4, 0.2\nspeed = 0.1\n" SIDE_WALLS);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "m^2 more in than out by t = 0.03"), warnings);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "until a guard stops the run"), warnings);
    read(OPEN_CHANNEL "[outflow i]\nfrom = 0, 0.2\nto = 0, 0\nspeed = 0.1\n" OUT("speed = 0.1")
             SIDE_WALLS);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "more out than in"), warnings);
    /* An open tank fills. */
    read(OPEN_CHANNEL IN "[wall t]\nshape = polyline thickness -0.04: -0.2, 0; 0.4, 0; 0.4, 0.5\n"
                         "shape = box -0.2, 0.2, 0, 0.24\n");
    TEST_ASSERT_EQUAL_STRING("", warnings);
}

static void test_lines_that_end_in_the_fluid(void)
{
    static const char periodic[] = "[domain]\nlower = -0.2, 0\nupper = 0.6, 0.2\nperiodic = y\n";
    char text[1024];
    /* A line over the whole period has no end. */
    snprintf(text, sizeof text, "%s%s", OPEN_CHANNEL IN OUT("pressure = 0"), periodic);
    read(text);
    TEST_ASSERT_EQUAL_STRING("", warnings);
    snprintf(text, sizeof text, "%s%s",
             OPEN_CHANNEL IN "[outflow o]\nfrom = 0.4, 0\nto = 0.4, 0.15\npressure = 0\n",
             periodic);
    read(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings,
                                        "[outflow o] ends inside the fluid at (0.4, 0) m"),
                                 warnings);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "ends inside the fluid at (0.4, 0.15) m"),
                                 warnings);
    TEST_ASSERT_NULL(strstr(warnings, "[inflow i]"));
    /* Without walls the same. */
    read(OPEN_CHANNEL IN OUT("pressure = 0"));
    TEST_ASSERT_EQUAL_STRING("", warnings);
    read(OPEN_CHANNEL IN "[outflow o]\nfrom = 0.4, 0\nto = 0.4, 0.15\npressure = 0\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "ends inside the fluid at (0.4, 0.15) m"),
                                 warnings);
}

static void test_walls_that_end_at_a_line(void)
{
    /* To -0.2 m and 0.4 m: the inflow is at 0, the outflow at 0.4 m. */
    read(OPEN_CHANNEL IN OUT("pressure = 0") "[wall w]\nshape = box -0.2, -0.04, 0.4, 0\n"
                                             "shape = box -0.2, 0.2, 0.6, 0.24\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings,
                                        "[outflow o] leaks beside its buffer at (0.4, 0) m"),
                                 warnings);
    TEST_ASSERT_NULL(strstr(warnings, "[inflow i]"));
    TEST_ASSERT_NULL(strstr(warnings, "(0.4, 0.2)"));
}

static void test_absorption_without_effect(void)
{
    read(OPEN_CHANNEL IN OUT("pressure = 0\nabsorb = 0.2") SIDE_WALLS);
    TEST_ASSERT_EQUAL_STRING("", warnings);
    read(OPEN_CHANNEL IN OUT("pressure = 0\nabsorb = 1e-9") SIDE_WALLS);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "absorb = 1e-09 s lets only "
                                                  "waves shorter than c0 absorb/4 = 5e-10 m "
                                                  "pass"),
                                 warnings);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, "doubts.cfg:15: "), warnings);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_sound_tank_gets_no_warning);
    RUN_TEST(test_a_hinge_is_one_particle);
    RUN_TEST(test_a_beam_in_a_wall);
    RUN_TEST(test_a_tank_without_a_floor);
    RUN_TEST(test_surface_against_gravity_and_below_the_water);
    RUN_TEST(test_a_surface_above_the_water);
    RUN_TEST(test_a_density_of_one);
    RUN_TEST(test_a_body_without_its_units);
    RUN_TEST(test_a_body_that_nothing_holds);
    RUN_TEST(test_a_speed_of_sound_that_is_too_low);
    RUN_TEST(test_a_clamp_that_covers_the_body);
    RUN_TEST(test_velocities_that_do_not_balance);
    RUN_TEST(test_lines_that_end_in_the_fluid);
    RUN_TEST(test_walls_that_end_at_a_line);
    RUN_TEST(test_absorption_without_effect);
    RUN_TEST(test_a_clamp_and_a_wall_that_move_differently);
    RUN_TEST(test_a_pressure_probe_in_a_wall);
    RUN_TEST(test_a_gap_of_one_particle);
    RUN_TEST(test_a_gap_within_one_wall);
    RUN_TEST(test_a_gap_that_sampling_closes);
    RUN_TEST(test_an_opening_that_sampling_closes);
    RUN_TEST(test_flow_past_a_body_that_sticks);
    RUN_TEST(test_shifting_where_nothing_gives_way);
    return UNITY_END();
}
