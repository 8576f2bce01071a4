/* SPDX-License-Identifier: MIT
 * Walls that are drawn as lines without thickness. */
#include "geometry/scene_points.h"
#include "particles/particles.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct scene scene;
static struct diag diag;

void setUp(void) { diag = (struct diag){.code = ERR_OK}; }
void tearDown(void) { scene_free(&scene); }

#define TOP "dp = 10 mm\nend_time = 1\n"
#define WATER "[fluid w]\nsound_speed = 20\nshape = box 0, 0, 0.2, 0.1\n"
#define BODY "[solid s]\nshape = box 1, 1, 1.1, 1.1\ndensity = 1000\nyoung = 1e6\npoisson = 0.3\n"

static enum err read(const char *text)
{
    scene_free(&scene);
    setUp();
    return scene_load_text(&scene, text, "l.cfg", 0, NULL, &diag);
}

static int by_place(const void *a, const void *b)
{
    const double *const p = a, *const q = b;
    if (fabs(p[0] - q[0]) > 1e-9) return p[0] < q[0] ? -1 : 1;
    return (p[1] > q[1] + 1e-9) - (p[1] < q[1] - 1e-9);
}

/* The particles of all walls, sorted. */
static int64_t walls(const char *text, double (*at)[2])
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, read(text), diag.text);
    const struct scene_points *const p = &scene.points[KIND_WALL];
    TEST_ASSERT_TRUE(p->n < 5000);
    for (int64_t k = 0; k < p->n; k++) at[k][0] = p->x[k], at[k][1] = p->y[k];
    qsort(at, (size_t)p->n, sizeof *at, by_place);
    return p->n;
}

static void must_equal(const char *line, const char *band)
{
    static double a[5000][2], b[5000][2];
    const int64_t n = walls(line, a);
    TEST_ASSERT_EQUAL_INT64_MESSAGE(n, walls(band, b), line);
    for (int64_t k = 0; k < n; k++)
        for (int c = 0; c < 2; c++) TEST_ASSERT_TRUE_MESSAGE(fabs(a[k][c] - b[k][c]) < 1e-9, line);
}

#define TANK "0, 0.2; 0, 0; 0.4, 0; 0.4, 0.2\n"

/* As thick as the kernel reaches, whatever its h. */
static void test_a_line_is_a_band(void)
{
    must_equal(TOP WATER "[wall t]\nshape = polyline: " TANK,
               TOP WATER "[wall t]\nshape = polyline thickness -40 mm: " TANK);
    must_equal(TOP WATER BODY "[wall t]\nshape = polyline: " TANK,
               TOP WATER BODY "[wall t]\nshape = polyline thickness -30 mm: " TANK);
    must_equal(TOP WATER BODY "[numerics]\nh_over_dp = 1.6\n[wall t]\nshape = polyline: " TANK,
               TOP WATER "[wall t]\nshape = polyline thickness -40 mm: " TANK);
    must_equal("scheme = paper\n" TOP WATER "[wall t]\nshape = polyline: " TANK,
               TOP WATER "[wall t]\nshape = polyline thickness -30 mm: " TANK);
}

/* Water on one side decides; without any it is on the left. */
static void test_which_side_is_dry(void)
{
    must_equal(TOP WATER "[wall t]\nshape = polyline: 0.4, 0.2; 0.4, 0; 0, 0; 0, 0.2\n",
               TOP WATER "[wall t]\nshape = polyline thickness -40 mm: " TANK);
    must_equal(TOP WATER "[wall t]\nshape = polyline: 1, 0; 1, 0.1\n",
               TOP WATER "[wall t]\nshape = box 1, 0, 1.04, 0.1\n");
    must_equal(TOP WATER "[wall t]\nshape = polyline: 1, 0.1; 1, 0\n",
               TOP WATER "[wall t]\nshape = box 0.96, 0, 1, 0.1\n");
}

#define POST "0.3, 0; 0.32, 0; 0.32, 0.06; 0.3, 0.06; 0.3, 0\n"
#define ROOM "-0.1, -0.1; 0.5, -0.1; 0.5, 0.4; -0.1, 0.4; -0.1, -0.1\n"

static void test_closed_lines(void)
{
    must_equal(TOP WATER "[wall t]\nshape = polyline: " POST,
               TOP WATER "[wall t]\nshape = box 0.3, 0, 0.32, 0.06\n");
    must_equal(TOP "[fluid w]\nsound_speed = 20\nshape = box -1, 0, 1, 0.06\n"
                   "minus = box 0.3, 0, 0.32, 0.06\n[wall t]\nshape = polyline: " POST,
               TOP WATER "[wall t]\nshape = box 0.3, 0, 0.32, 0.06\n");
    must_equal(TOP WATER
               "[wall t]\nshape = polyline: " ROOM, /* around water that it does not touch */
               TOP WATER "[wall t]\nshape = box -0.14, -0.14, 0.54, 0.44\n"
                         "minus = box -0.1, -0.1, 0.5, 0.4\n");
}

/* As if they were one line. */
static void test_lines_that_meet(void)
{
    must_equal(TOP WATER "[wall t]\nshape = polyline: 0, 0.2; 0, 0; 0.4, 0\n"
                         "[wall end]\nshape = polyline: 0.4, 0; 0.4, 0.2\n",
               TOP WATER "[wall t]\nshape = polyline: " TANK);
    must_equal(TOP WATER "[wall t]\nshape = polyline: 0, 0; 0, 0.2\n" /* wet: any order */
                         "shape = polyline: 0, 0; 0.4, 0\nshape = polyline: 0.4, 0; 0.4, 0.2\n",
               TOP WATER "[wall t]\nshape = polyline: " TANK);
}

static void test_an_arc(void)
{
    static double at[5000][2];
    const double inner = 0.2, outer = 0.24, dp = 0.01;
    int64_t n = walls(TOP "[fluid w]\nsound_speed = 20\nshape = circle 0, 0, 0.2\n"
                          "[wall drum]\nshape = arc: 0, 0, 0.2, 0, 360 deg\n",
                      at);
    for (int64_t k = 0; k < n; k++) {
        const double r = hypot(at[k][0], at[k][1]);
        TEST_ASSERT_TRUE(r > inner + 0.45 * dp && r < outer - 0.45 * dp);
    }
    const double area = 3.14159265 * (outer * outer - inner * inner);
    TEST_ASSERT_TRUE(fabs((double)n * dp * dp / area - 1) < 0.02);
    /* A bowl with upright sides has the area of its parts. */
    n = walls(TOP "[fluid w]\nsound_speed = 20\nshape = circle 0, 0, 0.2\n"
                  "minus = box -1, 0, 1, 1\n[wall bowl]\nshape = polyline: -0.2, 0.1; -0.2, 0\n"
                  "shape = arc: 0, 0, 0.2, 180 deg, 360 deg\nshape = polyline: 0.2, 0; 0.2, 0.1\n",
              at);
    TEST_ASSERT_TRUE(fabs((double)n * dp * dp / (0.5 * area + 2 * 0.1 * 0.04) - 1) < 0.02);
    must_equal(TOP WATER "[wall a]\nshape = arc thickness 40 mm: 2, 0, 0.3, 90 deg, 0\n",
               TOP WATER "[wall a]\nshape = arc: 2, 0, 0.3, 0, pi/2\n");
}

static void test_what_is_refused(void)
{
    static const struct {
        const char *text, *message;
    } refused[] = {
        {TOP WATER "[wall t]\nshape = polyline: 0, 0.2; 0, 0; 0.4, 0\n"
                   "[wall end]\nshape = polyline: 0.4, 0.2; 0.4, 0\n",
         "l.cfg:9: this line of a wall meets the one in line 7 at (0.4, 0) m, but their layers are "
         "on different sides; reverse the points of the line without fluid beside it"},
        {TOP "[fluid w]\nsound_speed = 20\nshape = polyline: 0, 0; 1, 0\n",
         "`thickness T` may be left out in a `shape` of a [wall]"},
        {TOP WATER "[wall t]\nshape = box 0, 0, 1, 1\nminus = polyline: 0, 0; 1, 0\n",
         "`thickness T` may be left out in a `shape` of a [wall]"},
        {TOP WATER "[wall t]\nshape = arc: 0, 0, 1\n",
         "write `arc: X, Y, R, A, B`: centre, radius and two angles"},
        {TOP WATER "[wall t]\nshape = arc: 0, 0, 1, 0, 400 deg\n",
         "the angles differ by at most 360 degrees"},
        {TOP WATER "[wall t]\nshape = arc: 0, 0, 1, 0, 4 m\n",
         "a length (m) where a pure number is expected"},
        {TOP WATER "[wall t]\nshape = polyline: 1, 0; 1.01, 0; 1.01, -0.1\n",
         "segment 1 of the polyline is too short for a thickness of 0.04 m: the joints at its ends "
         "cross; draw the wall as a `polygon` or `box`"},
    };
    for (size_t k = 0; k < COUNT_OF(refused); k++) {
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_INPUT, read(refused[k].text), refused[k].message);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, refused[k].message), diag.text);
    }
}

/* The effective case has the lines as they were drawn. */
static void test_they_are_written_as_lines(void)
{
    static char text[60000];
    static double a[5000][2], b[5000][2];
    const int64_t n = walls(TOP WATER "[wall t]\nshape = polyline: " TANK "shape = polyline: " POST
                                      "[wall a]\nshape = arc: 2, 0, 0.3, 0, pi/2\n",
                            a);
    char path[] = "/tmp/sphfsi_lines_XXXXXX";
    const int file = mkstemp(path);
    TEST_ASSERT_TRUE(file >= 0);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, scene_write(&scene, path, &diag), diag.text);
    FILE *const f = fopen(path, "r");
    TEST_ASSERT_NOT_NULL(f);
    text[fread(text, 1, sizeof text - 1, f)] = '\0';
    fclose(f);
    remove(path);
    TEST_ASSERT_NOT_NULL(strstr(text, "shape = polyline: 0.3, 0; 0.32, 0; 0.32, 0.06; 0.3, 0.06; "
                                      "0.3, 0\n"));
    TEST_ASSERT_EQUAL_INT64(n, walls(text, b));
    TEST_ASSERT_EQUAL_MEMORY(a, b, (size_t)n * sizeof *a);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_line_is_a_band);
    RUN_TEST(test_which_side_is_dry);
    RUN_TEST(test_closed_lines);
    RUN_TEST(test_lines_that_meet);
    RUN_TEST(test_an_arc);
    RUN_TEST(test_what_is_refused);
    RUN_TEST(test_they_are_written_as_lines);
    return UNITY_END();
}
