/* SPDX-License-Identifier: MIT
 * Sections that overlap are refused whatever their lattices, and those that touch are not. */
#include "geometry/scene_points.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct scene scene;
static struct diag diag;
static const double dp = 0.01;

void setUp(void) { diag = (struct diag){.code = ERR_OK}; }
void tearDown(void) {}

static enum err read(const char *text)
{
    setUp();
    const enum err e = scene_load_text(&scene, text, "o.cfg", 0, NULL, &diag);
    if (!e) scene_free(&scene);
    return e;
}

#define TOP "dp = 10 mm\nend_time = 0.01\ngravity = 0, -9.81\n"
#define WATER "[fluid water]\nshape = box -1, 0, 1.2, 0.2\nsurface = 0.2\nmax_speed = 2.5\n"
#define MATERIAL "density = 700\nyoung = 20 MPa\npoisson = 0.3\n"

/* Two lattices half a spacing apart along both axes: no point is nearer than 0.707 dp to one of the
 * other. */
static void test_a_body_in_the_water(void)
{
    static const struct {
        const char *text, *message;
    } refused[] = {
        {TOP WATER "[solid wheel]\nshape = box -0.025, 0.105, 0.025, 0.535\n"
                   "clamp = circle 0, 0.32, 6 mm\n" MATERIAL,
         "o.cfg:4: 36 particles of [fluid water] lie in [solid wheel], the first at (-0.015, "
         "0.115) m: move one of the shapes, or subtract the overlap with `minus`"},
        /* Thinner than the water's spacing: none of its particles lies in it. */
        {TOP WATER "[solid foil]\ndp = 10/3*mm\nshape = box 0.0065, 0.1, 0.0135, 0.15\n" MATERIAL,
         "o.cfg:8: 30 particles of [solid foil] lie in [fluid water]"},
        {TOP "[wall w]\nshape = box -0.1, 0, 0.1, 0.1\n[solid s]\nshape = box -0.025, 0.015, "
             "0.025, 0.145\nclamp = box -1, 0.105, 1, 1\n" MATERIAL,
         "particles of [wall w] lie in [solid s], the first at (-0.015, 0.025) m: only the clamped "
         "part of a solid may lie in a wall"},
    };
    for (size_t k = 0; k < COUNT_OF(refused); k++) {
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_INPUT, read(refused[k].text), refused[k].message);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, refused[k].message), diag.text);
    }
}

/* --- random scenes, and an independent count of places in both shapes --- */

static uint64_t state = 1;

static double uniform(double low, double high)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(state >> 11) / 9007199254740992.0;
}

static int choose(int n) { return (int)uniform(0, n); }

/* A disc, or a rectangle at an angle. */
struct patch {
    bool disc;
    double x, y, a, b, angle;
};

static bool holds(const struct patch *p, double x, double y, double margin)
{
    const double c = cos(p->angle), s = sin(p->angle), dx = x - p->x, dy = y - p->y;
    if (p->disc) return hypot(dx, dy) < p->a + margin;
    return fabs(c * dx + s * dy) < p->a + margin && fabs(c * dy - s * dx) < p->b + margin;
}

static struct patch random_patch(void)
{
    const bool upright = choose(2), even = choose(2);
    struct patch p = {choose(3) == 0,      uniform(-0.1, 0.1),  uniform(-0.1, 0.1),
                      uniform(0.03, 0.09), uniform(0.03, 0.09), upright ? 0 : uniform(-1.5, 1.5)};
    if (!even) return p;
    double *const all[] = {&p.x, &p.y, &p.a, &p.b}; /* edges on lattice lines or half-way */
    for (int k = 0; k < 4; k++) *all[k] = 0.5 * dp * round(*all[k] / (0.5 * dp));
    return p;
}

/* The same patch as a box or circle, a polygon, or a band. */
static void write_patch(char *to, size_t size, const char *key, const struct patch *p)
{
    const double c = cos(p->angle), s = sin(p->angle);
    const int form = choose(3);
    double x[4], y[4];
    for (int k = 0; k < 4; k++) {
        const double u = k == 0 || k == 3 ? -p->a : p->a, v = k < 2 ? -p->b : p->b;
        x[k] = p->x + c * u - s * v;
        y[k] = p->y + s * u + c * v;
    }
    to += strlen(to);
    if (p->disc)
        snprintf(to, size, "%s = circle %.17g, %.17g, %.17g\n", key, p->x, p->y, p->a);
    else if (form == 0 && p->angle == 0)
        snprintf(to, size, "%s = box %.17g, %.17g, %.17g, %.17g\n", key, x[0], y[0], x[2], y[2]);
    else if (form == 1)
        snprintf(to, size, "%s = polyline thickness %.17g: %.17g, %.17g; %.17g, %.17g\n", key,
                 2 * p->b, x[0], y[0], x[1], y[1]);
    else
        snprintf(to, size, "%s = polygon %.17g, %.17g; %.17g, %.17g; %.17g, %.17g; %.17g, %.17g\n",
                 key, x[0], y[0], x[1], y[1], x[2], y[2], x[3], y[3]);
}

static void write_section(char *to, size_t size, int kind, const char *name)
{
    static const char *const heads[] = {"[fluid %s]\nsound_speed = 20\n", "[wall %s]\n",
                                        "[solid %s]\n" MATERIAL, "[solid %s]\ndp = 5 mm\n" MATERIAL,
                                        "[solid %s]\ndp = 4 mm\nlattice_angle = 0.3\n" MATERIAL};
    to += strlen(to);
    snprintf(to, size, heads[kind], name);
}

/* The number of places on a fine grid that are in both patches, and further than a margin from
 * their edges; outside is a negative margin. */
static long count_common(const struct patch *a, const struct patch *b, double margin)
{
    enum { N = 300 };
    long common = 0;
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            const double x = -0.25 + 0.5 * (i + 0.5) / N, y = -0.25 + 0.5 * (j + 0.5) / N;
            common += holds(a, x, y, -margin) && holds(b, x, y, -margin);
        }
    return common;
}

/* There is a particle on any lattice where a place is 0.8 dp deep in both. */

static void test_random_scenes(void)
{
    enum { SCENES = 600 };
    long n[3] = {0, 0, 0};
    for (int k = 0; k < SCENES; k++) {
        char text[4096] = "dp = 10 mm\nend_time = 0.01\n";
        const struct patch a = random_patch(), b = random_patch();
        const int kind[2] = {choose(5), choose(5)};
        const bool cut = choose(3) == 0;
        if (kind[0] == 1 && kind[1] == 1) continue; /* walls form a union */
        if (choose(4) == 0) strcat(text, "scheme = paper\n");
        const bool apart = count_common(&a, &b, -0.2 * dp) == 0,
                   deep = count_common(&a, &b, 0.8 * dp) > 0;
        write_section(text, 512, kind[0], "a");
        write_patch(text, 512, "shape", &a);
        if (cut) write_patch(text, 512, "minus", &b);
        write_section(text, 512, kind[1], "b");
        write_patch(text, 512, "shape", &b);
        const enum err e = read(text);
        const bool refused = e && strstr(diag.text, " lie in [");
        if (e && !refused) continue; /* nothing is left of `a` after its `minus` */
        TEST_ASSERT_FALSE_MESSAGE(refused && (cut || apart), text);
        TEST_ASSERT_FALSE_MESSAGE(!refused && !cut && deep, text);
        n[cut ? 0 : apart ? 1 : 2] += cut || apart || deep;
    }
    for (int k = 0; k < 3; k++) TEST_ASSERT_TRUE(n[k] > SCENES / 10);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_body_in_the_water);
    RUN_TEST(test_random_scenes);
    return UNITY_END();
}
