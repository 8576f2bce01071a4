/* SPDX-License-Identifier: MIT
 * Scenes from a text, with what is warned of as they are read. One in each test program. */
#ifndef SPHFSI_TESTS_WARNED_H
#define SPHFSI_TESTS_WARNED_H

#include "check/check.h"
#include "geometry/scene_points.h"
#include "unity.h"

#include <stdio.h>
#include <string.h>

static struct scene scene;
static char warnings[4096]; /* a line each */

static void note(void *context, const char *text)
{
    (void)context;
    const size_t n = strlen(warnings);
    snprintf(warnings + n, sizeof warnings - n, "%s\n", text);
}

/* Reads a case that is not refused, as from a file of this name. */
static void read_as(const char *name, const char *text)
{
    struct diag diag = {.warn = note};
    scene_free(&scene);
    warnings[0] = '\0';
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, scene_load_text(&scene, text, name, 0, NULL, &diag),
                                  diag.text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, check_scene(&scene, &diag), diag.text);
}

#endif
