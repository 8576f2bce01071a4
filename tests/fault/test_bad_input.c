/* SPDX-License-Identifier: MIT
 * The reader under hostile input: damaged text and failing memory. Nothing may crash, leak or hang;
 * a failure always leaves a sentence. */
#include "case/scene.h"
#include "geometry/scene_points.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

/* Every kind of section, value and shape, and few particles. */
static const char good[] =
    "title = \"a case # of everything\"\ndp = 0.002\nend_time = 2*T\ngravity = 0, -g\n"
    "integrator = verlet\n[constants]\ng = 9.81 m/s^2\nH = 0.02 m\nT = sqrt(H/g)\n"
    "[numerics]\ncfl = 0.15\n[fluid w]\nshape = box 0, 0, 0.02, H\nminus = circle 0, 0.02, 0.005\n"
    "max_speed = 2*sqrt(g*H)\nsurface = H\nvelocity = x*1 s^-1, -y*1 s^-1*min(1, 2)\n"
    "[fluid v]\nlike = w\nshape = polygon 0.03, 0; 0.05, 0; 0.05, 0.02\n"
    "[wall tank]\nshape = polyline thickness -0.006: 0, 0.03; 0, 0; 0.06, 0; 0.06, 0.03\n"
    "[wall paddle]\nshape = box 0.02, 0, 0.03, 0.03\nmotion = go\n"
    "[motion go]\ny = t^2*(1 - 0.5*t)\nstart = 0.01 s\nstop = 1 s\n"
    "[solid gate]\nshape = box 0.07, 0, 0.08, 0.04\nclamp = box 0.07, 0.03, 0.08, 0.04\n"
    "density = 1.1 g/cm^3\nyoung = 7.8 MPa\npoisson = 40 %\nvelocity = 0, max(x, 0)*1 s^-1\n"
    "[output]\nprobe_interval = 1 ms\n[probe M1]\nbody = gate\npoint = 0.075, 0\n"
    "[probe P]\nquantity = pressure\npoint = 0.01, 0.01\n";

static uint64_t state;

static unsigned pick(unsigned below)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (unsigned)((state >> 33) % below);
}

void setUp(void) { state = 20240229; }

void tearDown(void) { arena_fail_after(-1); }

static enum err try(const char *text, int n_sets, const char *const *sets)
{
    struct scene scene;
    struct diag d = {0};
    const enum err err = scene_load_text(&scene, text, "x.cfg", n_sets, sets, &d);
    if (err) {
        TEST_ASSERT_EQUAL_INT(err, d.code);
        TEST_ASSERT_TRUE_MESSAGE(strlen(d.text) > 10, text);
        TEST_ASSERT_NULL(scene.arena.blocks);
    } else {
        scene_free(&scene);
    }
    return err;
}

static void test_the_text_itself_is_good(void)
{
    struct scene scene;
    struct diag d = {0};
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, scene_load_text(&scene, good, "x.cfg", 0, NULL, &d),
                                  d.text);
    scene_free(&scene);
}

static void test_every_allocation_fails_once(void)
{
    static const char *const sets[] = {"numerics.cfl=0.2", "gate.young=1 MPa"};
    long n = 0;
    for (;; n++) {
        TEST_ASSERT_TRUE(n < 10000);
        arena_fail_after(n);
        const enum err err = try(good, 2, sets);
        arena_fail_after(-1);
        if (!err) break;
        TEST_ASSERT_EQUAL_INT(ERR_MEMORY, err);
    }
    TEST_ASSERT_TRUE(n > 50);
}

static void test_every_beginning(void)
{
    char text[sizeof good];
    for (size_t n = 0; n < sizeof good; n++) {
        memcpy(text, good, n);
        text[n] = '\0';
        try(text, 0, NULL);
    }
}

static void test_damaged_bytes(void)
{
    static const char odd[] = "()=[]#,;:^*/+-.eE\"xy \t\r\n%0\x7f\xff";
    char text[2 * sizeof good];
    for (int round = 0; round < 4000; round++) {
        memcpy(text, good, sizeof good);
        for (unsigned k = pick(4) + 1; k > 0; k--) {
            const size_t length = strlen(text), at = pick((unsigned)length);
            switch (pick(3)) {
            case 0: text[at] = (char)(pick(255) + 1); break;
            case 1: text[at] = odd[pick(sizeof odd - 1)]; break;
            default: memmove(text + at, text + at + 1, length - at); break;
            }
        }
        try(text, 0, NULL);
    }
}

static void test_shuffled_lines_and_words(void)
{
    static const char *const words[] = {"dp",
                                        "=",
                                        "1",
                                        "mm",
                                        "[solid a]",
                                        "\n",
                                        "shape",
                                        "box",
                                        ",",
                                        "(",
                                        ")",
                                        "^",
                                        "sin",
                                        "1e308",
                                        "nan",
                                        "inf",
                                        "-",
                                        "young",
                                        "kg",
                                        "/",
                                        "x",
                                        "y",
                                        "[wall",
                                        "b]",
                                        "circle",
                                        "like",
                                        "polyline",
                                        "min",
                                        ";",
                                        ":",
                                        "\"",
                                        "#",
                                        "%",
                                        "[constants]\n",
                                        "a",
                                        "b",
                                        "velocity",
                                        "2",
                                        "0",
                                        "\n\n",
                                        "end_time = 1\n"};
    char text[1000];
    for (int round = 0; round < 3000; round++) {
        size_t n = 0;
        for (unsigned k = pick(60); k > 0; k--)
            n += (size_t)snprintf(text + n, sizeof text - n, "%s ", words[pick(COUNT_OF(words))]);
        text[n] = '\0';
        try(text, 0, NULL);
        const char *const set = text;
        try(good, 1, &set);
    }
}

static void test_too_much_of_everything(void)
{
    static char text[1 << 20];
    static const char *const lines[] = {"\n",          "a = 1\n",  "[output]\n",
                                        "[solid a]\n", "(",        "dp = (",
                                        "-",           "dp = 1\n", "[constants]\n",
                                        "x",           "\"",       "[",
                                        "#",           "1,"};
    for (size_t k = 0; k < COUNT_OF(lines); k++) {
        size_t n = 0;
        for (const size_t length = strlen(lines[k]); n + length < sizeof text; n += length)
            memcpy(text + n, lines[k], length);
        text[n] = '\0';
        TEST_ASSERT_EQUAL_INT(ERR_INPUT, try(text, 0, NULL));
    }
    size_t n = 0;
    for (int k = 0; k < 100; k++)
        n += (size_t)snprintf(text + n, sizeof text - n, "[wall w%d]\n", k);
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, try(text, 0, NULL));
    n = (size_t)snprintf(text, sizeof text, "dp = c0\n[constants]\n");
    for (int k = 0; k < 600; k++)
        n += (size_t)snprintf(text + n, sizeof text - n, "c%d = c%d\n", k, k + 1);
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, try(text, 0, NULL));
}

static void test_huge_numbers_in_every_place(void)
{
    static const char *const numbers[] = {"1e308", "-1e308", "1e-308", "0", "1e15", "-1e9", "1e9"};
    char text[sizeof good + 16];
    for (size_t at = 1; at < sizeof good - 1; at++) {
        if (good[at] < '0' || good[at] > '9' || strchr(".0123456789", good[at - 1])) continue;
        const size_t length = strspn(good + at, ".0123456789");
        for (size_t k = 0; k < COUNT_OF(numbers); k++) {
            snprintf(text, sizeof text, "%.*s%s%s", (int)at, good, numbers[k], good + at + length);
            try(text, 0, NULL);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_text_itself_is_good);
    RUN_TEST(test_every_allocation_fails_once);
    RUN_TEST(test_every_beginning);
    RUN_TEST(test_damaged_bytes);
    RUN_TEST(test_shuffled_lines_and_words);
    RUN_TEST(test_too_much_of_everything);
    RUN_TEST(test_huge_numbers_in_every_place);
    return UNITY_END();
}
