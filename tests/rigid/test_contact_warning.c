/* SPDX-License-Identifier: MIT
 * A solid that a rigid body touches is pushed and does not push back: this is warned of, unless
 * the case says that the two have no contact. */
#include "warned.h"

#define BOTH                                                                             \
    "dp = 1 cm\nend_time = 1\n[solid s]\nshape = box 0, 0, 0.06, 0.06\ndensity = 1000\n" \
    "young = 1e6\npoisson = 0.3\n[rigid r]\nshape = box 0.2, 0, 0.26, 0.06\ndensity = 500\n"

void setUp(void) {}
void tearDown(void) { scene_free(&scene); }

static void test_contact_with_a_rigid_body_is_warned_of(void)
{
    static const char said[] = "contact of [rigid r] with [solid s] pushes the solid only";
    read_as("both.cfg", BOTH);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warnings, said), warnings);
    read_as("both.cfg", BOTH "[contact c]\nbetween = s, r\nenabled = off\n");
    TEST_ASSERT_NULL_MESSAGE(strstr(warnings, said), warnings);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_contact_with_a_rigid_body_is_warned_of);
    return UNITY_END();
}
